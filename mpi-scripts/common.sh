# Sourced by check and quickstart: packages of Debian 12, the environment of Open MPI, the build.

cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(g++ clang-16 libclang-rt-16-dev cmake ninja-build pkg-config petsc-dev slepc-dev libopenmpi-dev openmpi-bin libmetis-dev
  libhdf5-dev libhdf5-openmpi-dev libeigen3-dev libopenblas-dev libyaml-cpp-dev libgtest-dev
  libmuparser-dev python3-numpy python3-scipy python3-matplotlib python3-h5py python3-jsonschema
  python3-yaml
  gmsh) # meshes the cases bolted_flange, bracket, joint and seal, whose tests are left out without it

# Root in a container and more ranks than cores are both refused by Open MPI unless it is told.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
export OMPI_MCA_btl_vader_single_copy_mechanism=none
# One BLAS thread per rank; nproc would count those from then on.
cores=$(env -u OMP_NUM_THREADS nproc)
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

say() { printf '== %s\n' "$*"; }

install_missing() {
  if ! command -v dpkg-query >/dev/null; then
    say "not a Debian system: the packages of the README are taken to be there"
    return
  fi
  local missing=() package
  for package in "${packages[@]}"; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
      missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  local as_root=(env DEBIAN_FRONTEND=noninteractive)
  if ((EUID != 0)); then
    command -v sudo >/dev/null || {
      echo "missing, and neither root nor sudo to install them: ${missing[*]}" >&2
      exit 1
    }
    as_root=(sudo "${as_root[@]}")
  fi
  say "installing with apt-get: ${missing[*]}"
  "${as_root[@]}" apt-get -qq update
  "${as_root[@]}" apt-get -qq install -y --no-install-recommends "${missing[@]}" >/dev/null
}

# build TARGET...
build() {
  say "building in build/ (Release) with $cores cores: $*"
  local chosen=() # a folder that is there keeps its generator and its compiler
  if [[ ! -e build/CMakeCache.txt ]]; then
    chosen=(-G Ninja)
    # Four times faster to compile than g++ 12; CXX and CC choose another one.
    [[ -n ${CXX:-} ]] || ! command -v clang++-16 >/dev/null ||
      chosen+=(-DCMAKE_CXX_COMPILER=clang++-16 -DCMAKE_C_COMPILER=clang-16)
  fi
  cmake -S . -B build "${chosen[@]}" -DCMAKE_BUILD_TYPE=Release >/dev/null
  cmake --build build --parallel "$cores" --target "$@"
}
