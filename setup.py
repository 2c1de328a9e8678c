# SPDX-License-Identifier: MIT
# `pip install .`: the Python package, with a module that CMake builds. What it makes on the way goes to build-pip.
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
BUILD = ROOT / "build-pip"


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        cmake = BUILD / "cmake"
        left_out = [f"-DCUBOCT_{part}=OFF" for part in ("CUDA", "MPI", "SYNTH", "SYSTEMC", "TESTS")]
        subprocess.run(
            ["cmake", "-S", ROOT, "-B", cmake, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCUBOCT_PYTHON=ON",
             f"-DPython_EXECUTABLE={sys.executable}", *left_out],
            check=True,
        )  # fmt: skip
        subprocess.run(["cmake", "--build", cmake, "--target", "_cuboct"], check=True)
        built = next((cmake / "python/cuboct").glob("_cuboct*.so"))
        self.copy_file(str(built), self.get_ext_fullpath(extension.name))


BUILD.mkdir(exist_ok=True)
version = re.search(r"project\(cuboct VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
setup(
    version=version,
    ext_modules=[Extension("cuboct._cuboct", [])],
    cmdclass={"build_ext": CMakeBuild},
    options={"build": {"build_base": str(BUILD)}, "egg_info": {"egg_base": str(BUILD)}},
)
