"""The library goes into the wheel: that of RBVI_LIBRARY, else of the folder build of rbvi."""

import os
import re
import shutil
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


class WithLibrary(build_py):
    def run(self):
        super().run()
        library = Path(os.environ.get("RBVI_LIBRARY", ROOT / "build/librbvi.so.1"))
        if not library.exists():
            raise SystemExit(f"{library} is not there: build rbvi, or set RBVI_LIBRARY")
        shutil.copyfile(library, Path(self.build_lib) / "rbvi/librbvi.so.1")


class OfThisPlatform(Distribution):
    def has_ext_modules(self):
        return True


VERSION = re.search(r"project\(rbvi VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())
setup(version=VERSION.group(1), packages=["rbvi"], cmdclass={"build_py": WithLibrary},
      distclass=OfThisPlatform)
