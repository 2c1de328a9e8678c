# SPDX-License-Identifier: MIT
# `pip install .`: the Python package, with a module that CMake builds in build-pip, or in the build directory that
# the variable CUBOCT_BUILD names, as it is configured.
import os
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
GIVEN = os.environ.get("CUBOCT_BUILD")
BUILD = Path(GIVEN).resolve() if GIVEN else ROOT / "build-pip"
OWN = BUILD / "pip"  # of setuptools


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        if not GIVEN:
            left_out = [f"-DCUBOCT_{part}=OFF" for part in ("CUDA", "MPI", "SYNTH", "SYSTEMC", "TESTS")]
            subprocess.run(
                ["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCUBOCT_PYTHON=ON",
                 f"-DPython_EXECUTABLE={sys.executable}", *left_out],
                check=True,
            )  # fmt: skip
        subprocess.run(["cmake", "--build", BUILD, "--target", "_cuboct", "kept_rules"], check=True)
        built = next((BUILD / "python/cuboct").glob("_cuboct*.so"))
        place = Path(self.get_ext_fullpath(extension.name))
        self.copy_file(str(built), str(place))
        for part in ("cuboct-mesh.so", "cuboct-read-mesh", "cuboct-read-trace"):  # what the module looks for beside itself
            if (BUILD / part).exists():
                self.copy_file(str(BUILD / part), str(place.with_name(part)))
        for code in (BUILD / "rules").glob("*.so"):
            place.with_name("rules").mkdir(exist_ok=True)
            self.copy_file(str(code), str(place.with_name("rules") / code.name))


OWN.mkdir(parents=True, exist_ok=True)
version = re.search(r"project\(cuboct VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
setup(
    version=version,
    ext_modules=[Extension("cuboct._cuboct", [])],
    cmdclass={"build_ext": CMakeBuild},
    options={"build": {"build_base": str(OWN)}, "egg_info": {"egg_base": str(OWN)}},
)
