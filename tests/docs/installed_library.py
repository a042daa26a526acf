#!/usr/bin/env python3
"""installed_library.py BUILD SOURCE MODELS CMAKE: librbvi, that of units and the package of Python, installed.

Installs BUILD into a prefix of its own; compiles cases/from_c.c by pkg-config and by find_package in
empty folders; its answer has the digits of rbvi-online's, also where the model is gone; the library
shows rbvi.h alone and needs nothing beyond the C++ library, as that of units, which shows the functions
of FMI alone and which rbvi-online finds; the package of Python finds librbvi; rbvi-figures draws a run.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

NEEDED = ("libstdc++.so", "libm.so", "libgcc_s.so", "libc.so", "ld-linux", "linux-vdso", "libpthread")
FMI = {"fmi2" + name for name in """
    GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance SetupExperiment EnterInitializationMode
    ExitInitializationMode Terminate Reset GetReal GetInteger GetBoolean GetString SetReal SetInteger SetBoolean
    SetString GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate DeSerializeFMUstate
    GetDirectionalDerivative SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep GetStatus
    GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus""".split()}


def run(*command, **how):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **how)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n"
                 f"{done.stdout}{done.stderr}")
    return done.stdout


def numbers(text):
    return {name: float(value) for name, value in re.findall(r"^(\w+) +(\S+)", text, re.MULTILINE)
            if re.match(r"-?[\d.]+(e[-+]\d+)?$|nan$", value)}


def check_library(library, shown):
    """All that a library shows begins so, and of others it needs what is versioned: that of C and C++."""
    for symbol in run("nm", "-D", library).splitlines():
        kind, name = symbol.split()[-2:]
        if kind not in "Uvw" and not name.startswith(shown):
            sys.exit(f"{library.name} shows {name}")
        if kind == "U" and "@" not in name:
            sys.exit(f"{library.name} lacks {name}")
    for line in run("ldd", library).splitlines():
        if not any(name in line for name in NEEDED):
            sys.exit(f"{library.name} needs {line.strip()}")


def main(build, source, models, cmake):
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        prefix = work / "prefix"
        run(cmake, "--install", build, "--prefix", prefix)
        library = next(prefix.rglob("librbvi.so.1"))
        check_library(library, "rbvi_")
        units = next(prefix.rglob("librbvi_fmu.so"))
        check_library(units, "fmi2")
        functions = set(re.findall(r"\bfmi2\w+", run("nm", "-D", "--defined-only", units)))
        if functions != FMI:
            sys.exit(f"{units.name} has not the functions of FMI alone: {sorted(functions ^ FMI)}")
        pkgconfig = next(prefix.rglob("rbvi.pc")).parent
        own = {**os.environ, "PKG_CONFIG_PATH": str(pkgconfig), "LD_LIBRARY_PATH": str(library.parent)}
        (work / "from_c.c").write_bytes((Path(source) / "cases/from_c.c").read_bytes())
        # As it was configured, the file says where the library is to go: here it is elsewhere.
        flags = run("pkg-config", f"--define-variable=prefix={prefix}", "--cflags", "--libs", "rbvi",
                    env=own).split()
        run("cc", "-std=c11", "-Wall", "-Wextra", "-pedantic", "-Werror", "from_c.c", "-o", "from_c",
            *flags, cwd=work)
        online = prefix / "bin/rbvi-online"
        run(online, Path(models) / "disk_condensed/model.h5", "--pack", work / "model.rbvi")
        run(online, work / "model.rbvi", "--fmu", work / "model.fmu")
        with zipfile.ZipFile(work / "model.fmu") as unit:
            if not any(unit.read(name) == units.read_bytes() for name in unit.namelist()):
                sys.exit(f"the unit has another library than {units.name}")
        moved = units.rename(work / units.name)
        refused = subprocess.run([online, work / "model.rbvi", "--fmu", work / "none.fmu"], text=True,
                                 capture_output=True, check=False)
        moved.rename(units)
        if refused.returncode != 1 or "build the target rbvi_fmu\n" not in refused.stderr:
            sys.exit(f"without {units.name}: {refused}")
        answer = numbers(run(work / "from_c", "model.rbvi", cwd=work, env=own))
        mu = ",".join(repr(answer[one]) for one in ("radius", "core_stiffness"))
        told = work / "told.csv"
        run(online, work / "model.rbvi", "--mu", mu, "--out", told, "--precision", "17")
        header, row = told.read_text(encoding="utf-8").splitlines()[:2]
        compared = 0
        for column, value in zip(header.split(","), row.split(",")):
            if column in answer and value and column != "seconds":
                compared += 1
                if float(value) != answer[column]:
                    sys.exit(f"{column} is {answer[column]!r} in C, {value} by rbvi-online")
        if compared < 10:
            sys.exit(f"{compared} columns were compared")
        project = work / "project"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.22)\nproject(own C)\n"
            "find_package(rbvi REQUIRED COMPONENTS c)\nadd_executable(from_c ../from_c.c)\n"
            "target_link_libraries(from_c rbvi::c)\n", encoding="utf-8")
        run(cmake, "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
        run(cmake, "--build", project / "build")
        (work / "model.rbvi").rename(work / "moved.rbvi")
        run(project / "build/from_c", work / "moved.rbvi")
        package = prefix / "lib/python3/dist-packages"
        text = run("/usr/bin/python3", "-c", "import rbvi; print(rbvi.Model('moved.rbvi'))", cwd=work,
                   env={**os.environ, "PYTHONPATH": str(package)})
        if "radius" not in text:
            sys.exit(text)
        shutil.copytree(Path(models) / "disk_condensed", work / "run")
        run(prefix / "bin/rbvi-figures", work / "run")
        if not (work / "run/figures/outputs.png").is_file():
            sys.exit("rbvi-figures draws no outputs")
        run(prefix / "bin/rbvi-figures", work / "run", "--map", "normal_force", "radius", "core_stiffness")
        run(prefix / "bin/rbvi-figures", work / "run", "--sobol", "normal_force")
        if not all((work / f"run/figures/{name}.png").is_file() for name in ("map_normal_force", "sobol")):
            sys.exit("rbvi-figures draws no answers")


if __name__ == "__main__":
    main(*sys.argv[1:])
