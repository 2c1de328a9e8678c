# SPDX-License-Identifier: MIT
"""What is wrong is told as an exception, with its place."""
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from support import PROGRAMS, command, failure, main, scene_file

import cuboct

MESHED = """density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "mesh"
file = "cube.stl"
unit = "mm"
[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = "x"
[run]
dt = "auto"
steps = 2
"""


def cube(edge):
    """In STL: of each face the two triangles, seen from outside."""
    lines = ["solid cube"]
    for axis in range(3):
        for side in (0, 1):
            ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
            if not side:
                ring.reverse()
            corners = []
            for u, v in ring:
                corner = [0, 0, 0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side * edge, u * edge, v * edge
                corners.append(corner)
            for three in ((0, 1, 2), (0, 2, 3)):
                lines += ["facet normal 0 0 0", "outer loop"]
                lines += ["vertex {} {} {}".format(*corners[k]) for k in three]
                lines += ["endloop", "endfacet"]
    return "\n".join(lines + ["endsolid cube\n"])


class Errors(unittest.TestCase):
    def refused(self, call, *arguments, **named):
        with self.assertRaises(cuboct.InputError) as caught:
            call(*arguments, **named)
        return caught.exception

    def test_a_place_in_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.toml")
            with open(scene_file("lj_block.toml"), encoding="utf-8") as file:
                text = file.read()
            with open(path, "w", encoding="utf-8") as file:
                file.write(text + "fram_every = 3\n")
            error = self.refused(cuboct.Simulation, path)
            line = text.count("\n") + 1
            self.assertEqual((error.file, error.line, error.column), (path, line, 1))
            self.assertEqual(error.message, "unknown key 'fram_every'")
            self.assertEqual(error.hint, "did you mean 'frame_every'?")
            self.assertIsNone(error.key)
            self.assertEqual(
                str(error),
                f"{path}:{line}:1: unknown key 'fram_every'\n"
                f"  {line} | fram_every = 3\n     | ^\n  hint: did you mean 'frame_every'?",
            )

    def test_a_key_of_a_dict(self):
        scene = cuboct.Scene.like("tension")
        scene["constraint"][1]["velocity"] = "[4, 0, 0] mm"
        for call in (scene.check, lambda: cuboct.Simulation(scene), lambda: cuboct.run(scene, "golden")):
            error = self.refused(call)
            self.assertEqual(error.key, "constraint[1].velocity")
            self.assertEqual(scene.toml().splitlines()[error.line - 1], 'velocity = "[4, 0, 0] mm"')
            self.assertTrue(str(error).startswith("scene, constraint[1].velocity: "), str(error))
        error = self.refused(cuboct.run, scene_file("lj_block.toml"), arch={"name": "small", "node": {"filter_lanes": 0}})
        self.assertEqual((error.file, error.key), ("arch", "node.filter_lanes"))

    def test_texts_of_other_encodings(self):
        with open(scene_file("lj_block.toml"), encoding="utf-8") as file:
            text = 'title = "Würfel"\n' + re.sub(r"^title.*\n", "", file.read(), flags=re.MULTILINE)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.toml")

            def write(encoding):
                with open(path, "w", encoding=encoding) as file:
                    file.write(text)

            write("utf-8")
            plain = cuboct.run(path, steps=2)
            write("utf-8-sig")  # a mark that some editors leave
            self.assertEqual(cuboct.Scene.load(path)["title"], "Würfel")
            self.assertEqual(cuboct.run(path, steps=2).hash, plain.hash)
            self.assertEqual(cuboct.Scene.parse("\ufeff" + text).toml(), text)
            self.assertIn("Würfel", command("check", path))
            for encoding, message in (
                ("utf-16", "{}: this file is in UTF-16\n  hint: save it as UTF-8"),
                ("utf-16-le", "{}:1:2: the byte 0x00 is not UTF-8 text\n   1 | t\\x00i"),
                ("latin-1", '{}:1:11: the byte 0xfc is not UTF-8 text\n   1 | title = "W\\xfcrfel"\n     |           ^\n'
                 "  hint: save the file as UTF-8: it may be in Latin-1 now"),
            ):  # fmt: skip
                write(encoding)
                for call in (cuboct.run, cuboct.Scene.load):
                    self.assertTrue(str(self.refused(call, path)).startswith(message.format(path)), encoding)
                code, told = failure("run", path, "--steps", "1")
                self.assertTrue(told.startswith(message.format(path)), told)
                self.assertEqual(code, 2)
        self.assertIn("is no character", self.refused(cuboct.Scene.parse, 'title = "\ud800"').message)
        self.assertIn("is no character", self.refused(cuboct.run, cuboct.Scene(title="\ud800")).message)

    @unittest.skipUnless(os.path.exists(os.path.join(PROGRAMS, "cuboct-mesh.so")), "built without meshes")
    def test_paths_in_a_scene_count_from_its_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.toml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(MESHED)
            with open(os.path.join(folder, "cube.stl"), "w", encoding="utf-8") as file:
                file.write(cube(10))
            plain = cuboct.Scene.load(path)
            changed = cuboct.Scene.load(path)
            changed["run"]["steps"] = 3
            # Of a cube of 10 mm, in planes of 1/sqrt(2) mm every other site: (15^3 + 1)/2.
            for scene in (plain, changed, cuboct.Scene(changed)):
                self.assertEqual(scene.check()["particles"], 1688)
            changed.save(os.path.join(folder, "b.toml"))
            self.assertIn("1688", command("check", os.path.join(folder, "b.toml")).replace(" ", ""))
            # The reader of meshes lies beside the module, whatever else is in PATH.
            done = subprocess.run(
                [sys.executable, "-c", f"import cuboct; print(cuboct.run({path!r}).engine)"],
                env={**os.environ, "PATH": "/usr/bin"}, capture_output=True, text=True,
            )  # fmt: skip
            self.assertEqual((done.stdout, done.stderr), ("lattice\n", ""))
            cuboct.set_program_directory(folder)
            self.assertEqual(plain.check()["particles"], 1688)
            os.remove(os.path.join(folder, "cube.stl"))
            self.assertEqual(self.refused(changed.check).key, "geometry.file")

    def test_a_module_that_reads_no_meshes(self):
        package = os.path.dirname(cuboct.__file__)
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "cuboct"))
            for name in os.listdir(package):
                if name.endswith(".py"):
                    shutil.copy(os.path.join(package, name), os.path.join(folder, "cuboct"))
                elif name.startswith("_cuboct") and name.endswith(".so"):
                    os.symlink(os.path.join(package, name), os.path.join(folder, "cuboct", name))
            for name, text in (("a.toml", MESHED), ("cube.stl", cube(10))):
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write(text)
            lines = "import cuboct\ntry: cuboct.run('a.toml')\nexcept cuboct.InputError as error: print(error)"
            told = subprocess.run(
                [sys.executable, "-c", lines], cwd=folder, env={**os.environ, "PATH": "/usr/bin", "PYTHONPATH": folder},
                check=True, capture_output=True, text=True,
            ).stdout  # fmt: skip
            self.assertIn("\n  hint: ", told)
            self.assertNotIn("\\n", told)

    def test_a_value_given_on_the_way(self):
        scene = cuboct.Scene.like("tension")
        scene["packing"]["pitch"] = "1.2 mm"
        simulation = cuboct.Simulation(scene)
        error = self.refused(simulation.set_velocity, "pulled", [1e-9, 0, 0])
        self.assertEqual(error.key, "constraint[1].velocity")
        self.assertTrue(error.message.startswith("set_velocity('pulled', [1e-09, 0, 0]): "), error.message)
        self.assertNotIn("[4, 0, 0]", str(error))
        self.assertIsNone(error.file)
        error = self.refused(simulation.set_gravity, [0, 0, -1e-9])
        self.assertEqual(error.key, "gravity")
        self.assertTrue(error.message.startswith("set_gravity([0, 0, -1e-09]): "), error.message)
        self.assertEqual(self.refused(simulation.set_velocity, "puled", [1, 0, 0]).hint, "did you mean 'pulled'?")

    def test_toml_that_is_none(self):
        error = self.refused(cuboct.Scene.parse, "a = \nb = 2\n")
        self.assertEqual((error.file, error.line), ("scene", 1))
        self.assertIn("cannot read this file", str(self.refused(cuboct.Scene.load, "/nowhere.toml")))

    def test_values_that_toml_has_not(self):
        error = self.refused(cuboct.Scene(run={"steps": None}).toml)
        self.assertIn("run.steps is of type NoneType", str(error))
        self.refused(cuboct.Scene({3: 4}).toml)
        self.refused(cuboct.Simulation, 17)

    def test_names(self):
        block = scene_file("lj_block.toml")
        self.assertEqual(str(self.refused(cuboct.Simulation, block, "latice")),
                         "unknown engine 'latice'\n  hint: did you mean 'lattice'?")  # fmt: skip
        self.assertEqual(self.refused(cuboct.Scene.like, "tensoin").hint, "did you mean 'tension'?")
        self.assertEqual(
            self.refused(cuboct.run, block, "reference", integrator="verlt").hint, "did you mean 'verlet'?"
        )
        self.assertEqual(self.refused(cuboct.Simulation(block).picture, "sped").hint, "did you mean 'speed'?")

    def test_numbers(self):
        block = scene_file("lj_block.toml")
        simulation = cuboct.Simulation(block)
        for wrong in (-1, 2.5, "3", True, None, 2**63):
            self.refused(simulation.step, wrong)
        self.refused(cuboct.run, block, steps=-1)
        self.refused(cuboct.run, block, threads=0)
        for engine in ("reference", "lattice"):
            for of in (cuboct.run, cuboct.Simulation):
                self.assertIn("threads 1000000: this machine has", self.refused(of, block, engine, threads=10**6).message)
        self.refused(cuboct.run, block, hash_every=0)
        self.refused(simulation.picture, limit=float("nan"))
        self.refused(simulation.picture, width=3)
        self.assertEqual(simulation.steps, 0)

    def test_engines_of_a_crosscheck(self):
        block = scene_file("lj_block.toml")
        for wrong in (["golden"], ["golden", "golden"], ["golden", "reference"], "golden"):
            self.refused(cuboct.crosscheck, block, wrong, steps=1)

    def test_a_program_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            cuboct.set_program_directory(folder)
            block = scene_file("lj_block.toml")
            simulation = cuboct.Simulation(block, "systemc")
            for call in (lambda: cuboct.run(block, "systemc", steps=1), lambda: simulation.step(1)):
                self.assertEqual(
                    self.refused(call).message,
                    "the systemc engine is not built: no program cuboct-systemc beside cuboct",
                )
            self.assertEqual(simulation.steps, 0)


class Faults(unittest.TestCase):
    """A lone particle that leaves the lattice."""

    scene = {
        "mass": "1 mg",
        "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
        "particle": [{"position": "[0, 0, 0] mm", "velocity": "[2, 1, 0.5] m/s"}],
        "run": {"dt": "10 us", "steps": 100000},
    }

    def test_a_step_that_cannot_be_done(self):
        ends = []
        for engine in ("golden", "lattice"):
            simulation = cuboct.Simulation(self.scene, engine, probe_every=0)
            with self.assertRaises(cuboct.RunError) as caught:
                simulation.run()
            error = caught.exception
            self.assertEqual(error.step, simulation.steps)
            self.assertGreater(error.step, 10)
            self.assertIn("left the lattice along x", str(error))
            self.assertIn("reach", error.advice)
            last = simulation.hash
            with self.assertRaises(cuboct.RunError):  # again, and again whole
                simulation.step()
            self.assertEqual(simulation.hash, last)
            with self.assertRaises(cuboct.RunError) as caught:
                cuboct.run(self.scene, engine)
            self.assertEqual(caught.exception.run.steps, simulation.steps)
            self.assertEqual(caught.exception.advice, error.advice)
            ends.append((error.step, last))
        self.assertEqual(*ends)


class Descriptors(unittest.TestCase):
    def test_closed_ones_are_no_file_of_ours(self):
        code = "import os, cuboct; assert all(os.path.samestat(os.fstat(k), os.stat('/dev/null')) for k in range(3))"
        command = f"exec {shlex.quote(sys.executable)} -c {shlex.quote(code)} <&- >&- 2>&-"
        self.assertEqual(subprocess.run(["bash", "-c", command], check=False).returncode, 0)


main()
