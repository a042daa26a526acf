#include "rbvi/mesh/serial.hpp"

#include "rbvi/core/error.hpp"

#include <petscdmplex.h>

#include <fstream>
#include <memory>

namespace rbvi {

namespace {

/// From the two first lines of the file. Throws bad_input.
bool is_binary(const std::string &file) {
  std::ifstream in(file);
  if (!in) throw bad_input("cannot open mesh file '" + file + "'");
  std::string line;
  double version = 0;
  int type = -1;
  in >> line >> version >> type;
  if (!in || line != "$MeshFormat" || type < 0 || type > 1)
    throw bad_input("'" + file + "' is not a Gmsh mesh: it does not begin with $MeshFormat");
  return type == 1;
}

struct DestroyOptions {
  void operator()(PetscOptions options) const { (void)PetscOptionsDestroy(&options); }
};

/// Labels by physical name; what the user's options say of Gmsh files does not reach the reader.
Handle<DM> open_gmsh(const std::string &file, bool binary) {
  PetscOptions raw = nullptr;
  RBVI_CALL(PetscOptionsCreate(&raw));
  const std::unique_ptr<std::remove_pointer_t<PetscOptions>, DestroyOptions> options(raw);
  RBVI_CALL(PetscOptionsSetValue(raw, "-dm_plex_gmsh_use_regions", "1"));
  RBVI_CALL(PetscOptionsSetValue(raw, "-dm_plex_gmsh_periodic", "0"));

  Handle<PetscViewer> viewer;
  RBVI_CALL(PetscViewerCreate(PETSC_COMM_SELF, viewer.put()));
  RBVI_CALL(PetscObjectSetOptions(reinterpret_cast<PetscObject>(viewer.get()), raw));
  RBVI_CALL(PetscViewerSetType(viewer.get(), binary ? PETSCVIEWERBINARY : PETSCVIEWERASCII));
  RBVI_CALL(PetscViewerFileSetMode(viewer.get(), FILE_MODE_READ));
  RBVI_CALL(PetscViewerFileSetName(viewer.get(), file.c_str()));
  Handle<DM> dm;
  RBVI_CALL(DMPlexCreateGmsh(PETSC_COMM_SELF, viewer.get(), PETSC_TRUE, dm.put()));
  return dm;
}

/// Elements of higher order have coordinates elsewhere than at the vertices.
bool is_straight(DM dm) {
  PetscSection section = nullptr;
  PetscInt dim = 0, begin = 0, end = 0, size = 0;
  RBVI_CALL(DMGetCoordinateDim(dm, &dim));
  RBVI_CALL(DMPlexGetDepthStratum(dm, 0, &begin, &end));
  RBVI_CALL(DMGetCoordinateSection(dm, &section));
  RBVI_CALL(PetscSectionGetStorageSize(section, &size));
  PetscInt at_vertices = 0;
  for (PetscInt vertex = begin; vertex < end; ++vertex) {
    PetscInt count = 0;
    RBVI_CALL(PetscSectionGetDof(section, vertex, &count));
    at_vertices += count;
  }
  return at_vertices == dim * (end - begin) && at_vertices == size;
}

void check_cells(DM dm, const std::string &file, const Scene &scene) {
  PetscInt dim = 0, begin = 0, end = 0;
  RBVI_CALL(DMGetDimension(dm, &dim));
  RBVI_CALL(DMPlexGetHeightStratum(dm, 0, &begin, &end));
  if (end == begin) throw bad_input("mesh file '" + file + "' holds no cells");
  if (dim != scene.dim)
    throw bad_input("mesh file '" + file + "' is of dimension " + std::to_string(dim) + ": scene " +
                    scene.name + " needs " + std::to_string(scene.dim));
  const DMPolytopeType wanted = dim == 2 ? DM_POLYTOPE_TRIANGLE : DM_POLYTOPE_TETRAHEDRON;
  for (PetscInt cell = begin; cell < end; ++cell) {
    DMPolytopeType type = DM_POLYTOPE_UNKNOWN;
    RBVI_CALL(DMPlexGetCellType(dm, cell, &type));
    if (type != wanted)
      throw bad_input("mesh file '" + file + "' has cells that are not " +
                      (dim == 2 ? "triangles" : "tetrahedra") + ": mesh without recombination");
  }
  if (!is_straight(dm))
    throw bad_input("mesh file '" + file +
                    "' has elements of order 2 or more: write it with Mesh.ElementOrder = 1");
}

/// "(it has: a, b)".
std::string names_in(DM dm) {
  std::string names;
  PetscInt count = 0;
  RBVI_CALL(DMGetNumLabels(dm, &count));
  for (PetscInt i = 0; i < count; ++i) {
    const char *name = nullptr;
    RBVI_CALL(DMGetLabelName(dm, i, &name));
    const std::string text(name);
    if (text != "depth" && text != "celltype" && !text.ends_with(" Sets"))
      names += (names.empty() ? "" : ", ") + text;
  }
  return "(it has: " + (names.empty() ? "none" : names) + ")";
}

} // namespace

SerialMesh read_gmsh(const std::string &file, const Scene &scene) {
  const bool binary = is_binary(file);
  Handle<DM> dm;
  try {
    dm = open_gmsh(file, binary);
  } catch (const Error &error) {
    throw bad_input("mesh file '" + file + "' cannot be read: " + error.what());
  }
  check_cells(dm.get(), file, scene);
  SerialMesh mesh = from_plex(dm.get(), scene.mesh);
  for (const std::string &name : scene.mesh.regions)
    if (!mesh.region.contains(name))
      throw bad_input("mesh file '" + file + "' has no physical region '" + name + "' of cells " +
                      names_in(dm.get()));
  for (const std::string &name : scene.mesh.boundaries)
    if (!mesh.boundary.contains(name))
      throw bad_input("mesh file '" + file + "' has no physical boundary '" + name +
                      "' of facets " + names_in(dm.get()));
  return mesh;
}

} // namespace rbvi
