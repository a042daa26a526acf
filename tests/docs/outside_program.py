#!/usr/bin/env python3
"""outside_program.py BUILD README CMAKE: the program of "A scene in C++" is built and right.

Installs BUILD into a prefix of its own, writes the files of the page (each begins with its name),
builds them by find_package, makes a model of few parameters and answers one from it.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

MOST_LINES = 40  # of the program with its scene


def run(*command, status=0):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != status:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n"
                 f"{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def files_of(page):
    """Name -> text of the blocks that begin with their name."""
    blocks = re.findall(r"^```(?:cpp|cmake)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    return {re.match(r"(?://|#) ([\w.]+):", block).group(1): block for block in blocks}


def force(text):
    return float(re.search(r"^normal_force +(\S+)", text, re.MULTILINE).group(1))


def main(build, page, cmake):
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        prefix = work / "prefix"
        run(cmake, "--install", build, "--prefix", prefix)
        for package in prefix.rglob("cmake/rbvi/*.cmake"):
            for private in ["-march", "-W", "EIGEN_NO_DEBUG", "rbvi_flags", str(build)]:
                if private in package.read_text(encoding="utf-8"):
                    sys.exit(f"{package.name} hands on {private}")
        files = files_of(Path(page).read_text(encoding="utf-8"))
        lines = sum(files[name].count("\n") for name in ["tilted_plane.hpp", "offline.cpp"])
        if lines > MOST_LINES:
            sys.exit(f"the program has {lines} lines, more than {MOST_LINES}")
        for name, text in files.items():
            (work / name).write_text(text, encoding="utf-8")
        own = work / "own"
        run(cmake, "-S", work, "-B", own, f"-DCMAKE_PREFIX_PATH={prefix}")
        run(cmake, "--build", own, "--parallel", 2)
        # The component online alone looks for neither MPI nor PETSc.
        online = work / "online"
        online.mkdir()
        text = "".join(line for line in files["CMakeLists.txt"].splitlines(True)
                       if "offline" not in line)
        text = text.replace("REQUIRED)", "REQUIRED COMPONENTS online)")
        (online / "CMakeLists.txt").write_text(text.replace("query.cpp", "../query.cpp"),
                                               encoding="utf-8")
        run(cmake, "-S", online, "-B", online / "build", f"-DCMAKE_PREFIX_PATH={prefix}",
            "-DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON")
        listed = run(own / "offline", "list")
        if "tilted_plane" not in listed or "rigid_disk" in listed:
            sys.exit(f"other scenes than those of the program:\n{listed}")
        scene = ["-scene", "tilted_plane", "-out", work / "run"]
        run(own / "offline", "offline", *scene, "-train", "grid:3,3")
        run(own / "offline", "verify", *scene, "-valid", "random:2:1", "-verify_stability", "no")
        model = work / "run/model.h5"
        exact = force(run(own / "offline", "solve", *scene, "-mu", "0.7,0.1"))
        reduced = force(run(own / "query", model))
        if not abs(reduced - exact) <= 1e-3 * exact:  # nine training parameters
            sys.exit(f"normal_force is {exact}, by the model {reduced}")
        # Its scene is a program's: no other program answers its model.
        refusal = run(prefix / "bin/rbvi-online", model, status=2)
        if "unknown scene 'tilted_plane'" not in refusal:
            sys.exit(f"rbvi-online says: {refusal}")
    print(f"a program of {lines} lines has its own scene: normal_force {exact:.6g}, "
          f"by the model {reduced:.6g}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], sys.argv[3])
