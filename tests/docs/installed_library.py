#!/usr/bin/env python3
"""installed_library.py BUILD SOURCE MODELS CMAKE: librbvi and the package of Python, installed.

Installs BUILD into a prefix of its own; compiles cases/from_c.c by pkg-config and by find_package in
empty folders; its answer has the digits of rbvi-online's, also where the model is gone; the library
shows rbvi.h alone and needs nothing beyond the C++ library; the package of Python finds it.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

NEEDED = ("libstdc++.so", "libm.so", "libgcc_s.so", "libc.so", "ld-linux", "linux-vdso", "libpthread")


def run(*command, **how):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **how)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n"
                 f"{done.stdout}{done.stderr}")
    return done.stdout


def numbers(text):
    return {name: float(value) for name, value in re.findall(r"^(\w+) +(\S+)", text, re.MULTILINE)
            if re.match(r"-?[\d.]+(e[-+]\d+)?$|nan$", value)}


def check_library(library):
    for symbol in run("nm", "-D", "--defined-only", library).split("\n"):
        name = symbol.split()[-1] if symbol else "rbvi_"
        if not name.startswith("rbvi_"):
            sys.exit(f"{library.name} shows {name}")
    for line in run("ldd", library).splitlines():
        if not any(name in line for name in NEEDED):
            sys.exit(f"{library.name} needs {line.strip()}")


def main(build, source, models, cmake):
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        prefix = work / "prefix"
        run(cmake, "--install", build, "--prefix", prefix)
        library = next(prefix.rglob("librbvi.so.1"))
        check_library(library)
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


if __name__ == "__main__":
    main(*sys.argv[1:])
