# SPDX-License-Identifier: MIT
"""The kinds of input: a sound one, the file of it that is spoilt, and the commands that read it."""
import dataclasses
import random

import meshes
import mutate
from shop import KEPT
from sound import (BAR, CURVE, FIT, GMSH, LEARN, LONG_RUN, MACHINES, MESH_SCENE, MULTISCALE, POTENTIAL_FIT, SMALL_SCENE, STUDIES, STUDY,
                   TERSOFF_SCENE, WAVE)
from stores import rehashed, spoilt_database, spoilt_heads


@dataclasses.dataclass
class Case:
    kind: str
    number: int
    files: dict               # path in the working directory: bytes
    command: list             # of cuboct
    ways: list                # that spoilt it, and the file
    placed: bool = False      # a refusal has a place: the input is a text that is read line by line
    program: str = "cuboct"


# Scenes of the tree whose check takes little; `run` has a few steps of each.
SCENES = """scenes/cracked_glass scenes/graphene scenes/hot_cluster scenes/lj_block scenes/sheet scenes/two_types scenes/undamped_block
scenes/boards/grips scenes/templates/beam scenes/templates/crack scenes/templates/drop scenes/templates/gas scenes/templates/impact
scenes/templates/metal scenes/templates/release scenes/templates/sheet scenes/templates/tension scenes/accuracy/cantilever
scenes/accuracy/gas scenes/accuracy/lj_copper scenes/accuracy/rotation scenes/accuracy/sheet scenes/accuracy/two_materials
scenes/accuracy/vibration scenes/failures/constraint_work scenes/failures/creep scenes/failures/damping scenes/failures/far_origin
scenes/failures/force_jump scenes/failures/full_node scenes/failures/heating scenes/failures/order_of_sums scenes/failures/resolution
scenes/failures/stiff_hold scenes/failures/time_step scenes/failures/tunnelling scenes/failures/velocity scenes/studies/pitch_bar
scenes/studies/fit_bar_scene scenes/studies/ringing_block scenes/validation/crystal tests/synth/lone tests/synth/sheet tests/board/thrown
tests/gpu/lps/cracked_glass
""".split()
ARCHS = """scenes/archs/board scenes/archs/default scenes/archs/ecp5 scenes/archs/everything scenes/archs/ice40_serial scenes/archs/icebreaker
scenes/archs/small scenes/archs/solid tests/board/one_node tests/synth/narrow tests/study/formats""".split()
TECHNOLOGIES = ["cmos45", "cmos7", "ecp5", "ice40", "osu018"]

RUN = ["run", "in/scene.toml", "--steps", "2", "--quiet", "--out", "out"]
SCENE_COMMANDS = [
    (10, ["check", "in/scene.toml"]), (2, ["check", "in/scene.toml", "--json"]), (1, ["check", "in/scene.toml", "--machine"]), (8, RUN),
    (1, RUN + ["--json"]), (2, RUN + ["--engine", "reference"]), (1, RUN + ["--engine", "golden", "--frames", "lammps"]),
    (1, RUN + ["--frames", "xyz.gz", "--si"]), (2, ["energy", "in/scene.toml", "--steps", "2"]),
    (2, ["boards", "in/scene.toml", "--nodes", "2", "--steps", "2"]), (2, ["emit", "in/scene.toml", "--out", "out", "--vector-steps", "2"]),
    (1, ["emit", "in/scene.toml", "--out", "out", "--vector-steps", "1", "--bus", "axi4lite"]), (1, ["elastic", "in/scene.toml"]),
    (2, ["crosscheck", "in/scene.toml", "--engines", "golden,lattice", "--steps", "2", "--out", "out"])]


def chosen(rng, weighted):
    return rng.choices([item for _, item in weighted], [weight for weight, _ in weighted])[0]


ROWS = [(k, 1.1 * (k % 3), 1.1 * (k // 3 % 3), 1.1 * (k // 9), 0.1 * (k % 5) - 0.2) for k in range(27)]
XYZ = ('2\nany\nA 0 0 0\nA 1 0 0\n27\nLattice="9 0 0 0 9 0 0 0 9" Origin="0 0 0" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3 pbc="T F F" Time=2\n' +
       "".join("A %.3f %.3f %.3f %d %.2f 0 0\n" % (x, y, z, k, v) for k, x, y, z, v in ROWS)).encode()
LAMMPS_DATA = ("LAMMPS data file\n\n27 atoms\n1 atom types\n\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\nMasses\n\n1 1\n\nPair Coeffs # lj/cut\n\n1 1 1\n\n"
               "Atoms # atomic\n\n" + "".join("%d 1 %.3f %.3f %.3f 0 0 0\n" % (k + 1, x, y, z) for k, x, y, z, v in ROWS) +
               "\nVelocities\n\n" + "".join("%d %.2f 0 0\n" % (k + 1, v) for k, x, y, z, v in ROWS)).encode()
FILED_SCENE = b'''units = "reduced"
mass = 1
[particles]
file = "%s"
units = { length = 1, velocity = 1 }
[law]
kind = "lj"
epsilon = 1
sigma = 1
cutoff = 2.5
[run]
dt = 0.001
steps = 2
'''

class Kinds:
    def __init__(self, root, shop):
        self.root, self.shop = root, shop
        self.texts = {}

    def source(self, name):
        if name not in self.texts:
            with open(f"{self.root}/{name}", "rb") as file:
                self.texts[name] = file.read()
        return self.texts[name]

    def case(self, seed, kind, number):
        """The input of this seed, kind and number; no other one matters to it."""
        made = getattr(self, kind)(random.Random(f"{seed} {kind} {number}"))
        made.kind, made.number = kind, number
        return made

    # Each method: a Case whose file is spoilt.
    def toml(self, rng, data, others, files, path, command, **more):
        ways = mutate.TOML | {"splice": mutate.spliced(rng.choice(others))}
        return self.spoilt(rng, data, ways, files, path, command, placed=True, **more)

    def spoilt(self, rng, data, ways, files, path, command, placed=False, **more):
        changed, taken = mutate.spoil(data, rng, ways)
        return Case("", 0, files | {path: changed}, list(command), taken + [path], placed, **more)

    def scene(self, rng):
        names = [name + ".toml" for name in SCENES]
        name = rng.choice(names)
        files = {"in/silicon.tersoff": self.source("scenes/studies/silicon.tersoff"),
                 "in/rules/texts/glass.toml": self.source("scenes/rules/texts/glass.toml")}
        return self.toml(rng, self.source(name), [self.source(n) for n in names], files, "in/scene.toml", chosen(rng, SCENE_COMMANDS))

    def arch(self, rng):
        names = [name + ".toml" for name in ARCHS]
        command = chosen(rng, SCENE_COMMANDS) + ["--arch", "in/arch.toml"]
        if command[0] == "elastic":
            command = ["energy", "in/scene.toml", "--beside", "in/arch.toml", "--steps", "2"]
        scene = rng.choice([SMALL_SCENE, self.source("scenes/undamped_block.toml")])
        return self.toml(rng, self.source(rng.choice(names)), [self.source(n) for n in names], {"in/scene.toml": scene}, "in/arch.toml", command)

    def study(self, rng):
        command = chosen(rng, [(6, ["explore", "in/study.toml", "--no-speed", "--jobs", "1", "--out", "out"]),
                               (2, ["explore", "in/study.toml", "--error", "5%", "--jobs", "1", "--out", "out"]), (1, ["check", "in/study.toml"]),
                               (1, ["run", "in/study.toml", "--out", "out"])])
        if rng.random() < 0.2:  # its scene
            return self.toml(rng, SMALL_SCENE, [STUDY], {"in/study.toml": STUDY}, "in/scene.toml", command)
        others = [self.source(f"scenes/studies/{n}.toml") for n in ("block", "coupon", "ringing", "brittle_strength")]
        return self.toml(rng, STUDY, others, {"in/scene.toml": SMALL_SCENE}, "in/study.toml", command)

    def machines(self, rng):
        others = [self.source(f"scenes/studies/{n}.toml") for n in ("machines_coupon", "machines_error", "machines_lj", "fpga_widths")]
        command = chosen(rng, [(4, ["explore", "in/study.toml", "--jobs", "1", "--out", "out"]),
                               (1, ["explore", "in/study.toml", "--jobs", "1", "--out", "out", "--json"])])
        return self.toml(rng, MACHINES, others, {"in/scene.toml": SMALL_SCENE}, "in/study.toml", command)

    def fit(self, rng):
        files = {"in/bar.toml": BAR, "in/curve.csv": CURVE, "in/fit.toml": FIT}
        command = ["fit", "in/fit.toml", "--jobs", "1", "--out", "out"]
        pick = rng.random()
        if pick < 0.35:
            return self.spoilt(rng, CURVE, mutate.TEXT, files, "in/curve.csv", command, placed=True)
        if pick < 0.45:
            return self.toml(rng, BAR, [FIT], files, "in/bar.toml", command)
        return self.toml(rng, FIT, [self.source("scenes/studies/fit_coupon.toml")], files, "in/fit.toml", command)

    def potential_fit(self, rng):
        return self.toml(rng, POTENTIAL_FIT, [self.source("scenes/studies/silicon_fit.toml"), FIT], {}, "in/fit.toml",
                         ["fit", "in/fit.toml", "--jobs", "1", "--out", "out"])

    def multiscale(self, rng):
        files = {"in/silicon.tersoff": self.source("scenes/studies/silicon.tersoff"), "in/body.msh": meshes.gmsh(2)}
        others = [self.source(f"scenes/studies/silicon_{n}.toml") for n in ("cost", "rod", "pair", "shear")]
        command = chosen(rng, [(4, []), (1, ["--json"]), (1, ["--technology", "cmos45"])])
        return self.toml(rng, rng.choice([MULTISCALE, MULTISCALE, WAVE, GMSH]), others, files, "in/study.toml",
                         ["multiscale", "in/study.toml", "--threads", "1", "--out", "out"] + command)

    def gmsh(self, rng):
        return self.spoilt(rng, meshes.gmsh(rng.choice([2, 4])), mutate.TEXT, {"in/study.toml": GMSH}, "in/body.msh",
                           ["multiscale", "in/study.toml", "--threads", "1", "--out", "out"], placed=True)

    def learn(self, rng):
        return self.toml(rng, LEARN, [self.source("scenes/studies/graphene.toml")], {}, "in/study.toml",
                         ["learn", "in/study.toml", "--jobs", "1", "--out", "out"])

    def pitch(self, rng):
        command = ["pitch", "in/scene.toml", "--error", "20%", "--particles", "400", "--threads", "1", "--out", "out"]
        return self.toml(rng, BAR, [self.source("scenes/studies/pitch_bar.toml")], {}, "in/scene.toml",
                         command + rng.choice([[], ["--json"], ["--figure", "final", "--curve", "tension.stress"]]))

    def technology(self, rng):
        name = rng.choice(TECHNOLOGIES)
        others = [self.source(f"technologies/{n}.toml") for n in TECHNOLOGIES]
        files = {"in/scene.toml": SMALL_SCENE}
        if rng.random() < 0.15:
            return self.toml(rng, self.source("technologies/boards.toml"), others, files, "in/links.toml",
                             ["boards", "in/scene.toml", "--nodes", "1", "--steps", "2", "--links", "in/links.toml"])
        command = rng.choice([["energy", "in/scene.toml", "--steps", "2", "--technology", "./in/t.toml"],
                              ["energy", "in/scene.toml", "--steps", "2", "--technology", "cmos45,./in/t.toml", "--json"],
                              ["multiscale", "in/study.toml", "--out", "out", "--threads", "1", "--technology", "./in/t.toml"]])
        return self.toml(rng, self.source(f"technologies/{name}.toml"), others, files | {"in/study.toml": MULTISCALE}, "in/t.toml", command)

    def mesh(self, rng):
        name = rng.choice(list(meshes.ALL))
        data, text = meshes.ALL[name]
        files = {"in/scene.toml": MESH_SCENE % name.encode()}
        command = chosen(rng, [(3, ["check", "in/scene.toml"]), (1, RUN)])
        if name.endswith("3mf") and rng.random() < 0.6:  # the model within, and packed again
            model, taken = mutate.spoil(meshes.model_3mf(), rng, mutate.TEXT)
            return Case("", 0, files | {"in/" + name: meshes.packed_3mf(model)}, command, taken + [name])
        return self.spoilt(rng, data, mutate.TEXT if text and rng.random() < 0.8 else mutate.BYTES, files, "in/" + name, command)

    def particles(self, rng):
        command = chosen(rng, [(3, ["check", "in/scene.toml"]), (1, RUN)])
        name, data = rng.choice([("a.xyz", XYZ), ("a.data", LAMMPS_DATA)])
        scene = FILED_SCENE % name.encode()
        if rng.random() < 0.2:
            return self.toml(rng, scene, [SMALL_SCENE], {"in/" + name: data}, "in/scene.toml", command)
        # A reader finds the particle's place, engines find faults of the scene in the scene.
        return self.spoilt(rng, data, mutate.TEXT if rng.random() < 0.8 else mutate.BYTES, {"in/scene.toml": scene}, "in/" + name, command)

    def potential(self, rng):
        data = self.source("scenes/studies/silicon.tersoff")
        if rng.random() < 0.7:
            return self.spoilt(rng, data, mutate.TEXT, {"in/scene.toml": TERSOFF_SCENE}, "in/silicon.tersoff", chosen(
                rng, [(3, ["check", "in/scene.toml"]), (2, RUN), (1, ["elastic", "in/scene.toml"])]), placed=True)
        return self.spoilt(rng, data, mutate.TEXT, {"in/study.toml": WAVE}, "in/silicon.tersoff",
                           ["multiscale", "in/study.toml", "--threads", "1", "--out", "out"], placed=True)

    def from_shop(self, rng, item, place, names, binary, files, commands, text_ways=mutate.TEXT):
        """A directory that a command made, with one of its files spoilt."""
        held = self.shop[item]
        path = rng.choice([n for n in names if n in held])
        ways = mutate.BYTES if path.endswith(binary) else text_ways
        made = {f"{place}/{name}": data for name, data in held.items()}
        return self.spoilt(rng, held[path], ways, files | made, f"{place}/{path}", rng.choice(commands))

    def run_directory(self, rng):
        """What `run --out` left, read by others."""
        start = SMALL_SCENE + b"[start]\nfrom = \"run\"\n"
        case = self.from_shop(
            rng, "run", "in/run", ["trace.h5"] * 6 + ["rasters.h5"] * 3 + ["run.toml", "summary.json", "plan.txt", "frames.xyz"], (".h5",),
            {"in/scene.toml": SMALL_SCENE, "in/start.toml": start},
            [["report", "in/run", "--out", "out.html"], ["picture", "in/run", "--out", "out.png"], ["run", "in/scene.toml", "--steps", "2", "--quiet", "--from", "in/run", "--out", "out"],
             ["check", "in/scene.toml", "--from", "in/run"], ["picture", "in/run", "--out", "out.png", "--field", "speed", "--steps", "0,24"]])
        spoilt = case.ways[-1]
        if spoilt.endswith(".h5") and rng.random() < 0.6:
            case.files[spoilt] = spoilt_heads(self.shop["run"][spoilt.removeprefix("in/run/")], rng)
            case.ways = ["heads", spoilt]
        return case

    def checkpoint(self, rng):
        """A run that was cut, and goes on. A third of the checkpoints have words changed and their hash made anew."""
        case = self.from_shop(rng, "cut", "out", ["checkpoint"] * 4 + ["checkpoint.journal"] * 2 + ["run.toml"], ("checkpoint", "journal"),
                              {"in/scene.toml": self.source("scenes/lj_block.toml")}, [LONG_RUN + ["--frames", "none", "--resume"]])
        if case.ways[-1] == "out/checkpoint" and rng.random() < 0.6:
            case.files["out/checkpoint"] = rehashed(self.shop["cut"]["checkpoint"], rng)
            case.ways = ["word and hash", "out/checkpoint"]
        return case

    def results(self, rng):
        """Directories of studies, and the same command again."""
        which = rng.choice(["explore"] * 3 + ["search", "machines", "fit", "potential_fit", "multiscale", "learn", "pitch"])
        inputs, command = STUDIES[which]
        if which == "explore" and rng.random() < 0.4:
            command = command[:-1] + ["other", "--add", "in/results.db"]
            command = [word if word != "other" else "out" for word in command]
            data, taken = spoilt_database(self.shop[which]["results.db"], rng)
            return Case("", 0, inputs | {"in/results.db": data}, command, taken + ["in/results.db"])
        held = self.shop[which]
        if KEPT[which].endswith(".db"):
            data, taken = spoilt_database(held[KEPT[which]], rng)
            return Case("", 0, inputs | {f"out/{n}": d for n, d in held.items()} | {"out/" + KEPT[which]: data}, command, taken + [KEPT[which]])
        return self.from_shop(rng, which, "out", [KEPT[which]], ("progress",), inputs, [command], mutate.TEXT)

    def liberty(self, rng):
        """Cells of a library; the netlist of one small block."""
        held = {f"out/{n}": d for n, d in self.shop["project"].items()}
        return self.spoilt(rng, self.shop["liberty"]["cells.lib"], mutate.TEXT, held, "in/cells.lib",
                           ["synth", "out", "--target", "asic", "--unit", "filter", "--liberty", "in/cells.lib", "--quiet"])

    def project(self, rng):
        held = self.shop["project"]
        names = ["project.json"] * 6 + [n for n in held if n.endswith((".sv", ".svh"))]
        return self.from_shop(rng, "project", "out", names, ("?",), {}, [
            ["synth", "out", "--target", "up5k", "--unit", unit, "--no-place", "--quiet"] for unit in ("filter", "fifo", "nothing")])

    def line(self, rng):
        """The command line alone."""
        files = {"in/scene.toml": SMALL_SCENE, "in/study.toml": STUDY, "in/fit.toml": FIT, "in/bar.toml": BAR, "in/curve.csv": CURVE}
        files |= {f"in/run/{n}": d for n, d in self.shop["run"].items()}
        program, words = "cuboct", list(rng.choice(LINES))
        if rng.random() < 0.2:
            program, words = rng.choice(self.shop["programs"]), list(rng.choice(ENGINE_LINES))
        taken = [change_words(words, rng) for _ in range(rng.choice([1, 1, 2, 3]))]
        return Case("", 0, files, words, taken, program=program)


LINES = [
    ["check", "in/scene.toml", "--json"], ["check", "in/scene.toml", "--machine", "--stage", "a"], RUN + ["--engine", "golden", "--frame-every", "1"],
    RUN + ["--threads", "1", "--hash-every", "1", "--cycles"], RUN + ["--engine", "reference", "--precision", "float", "--integrator", "verlet"],
    RUN + ["--raster", "32", "--no-states", "--frames", "none"], RUN + ["--checkpoint-every", "1 steps", "--frames", "vtp,lammps"],
    RUN + ["--stall-rate", "0.1", "--stall-seed", "3", "--engine", "systemc"], RUN + ["--devices", "0", "--engine", "gpu"],
    RUN + ["--port", "/dev/null", "--engine", "fpga", "--port-timeout", "0.01"], RUN + ["--from", "in/run", "--force"],
    ["crosscheck", "in/scene.toml", "--engines", "golden,lattice", "--steps", "2", "--out", "out"],
    ["emit", "in/scene.toml", "--out", "out", "--vector-steps", "2", "--board", "ulx3s", "--unchecked", "--baud", "115200"],
    ["energy", "in/scene.toml", "--technology", "cmos45,ice40", "--clock", "1 GHz", "--steps", "2", "--link", "lvds"],
    ["boards", "in/scene.toml", "--nodes", "1", "--box", "1,1,1", "--steps", "2", "--most", "8", "--clock", "100 MHz"],
    ["elastic", "--law", "kind = 'elastic', stiffness = '1 MN/m'", "--pitch", "1 mm", "--density", "1 g/cm^3", "--layers", "3"],
    ["elastic", "in/scene.toml", "--strain", "1e-4", "--relaxed", "--json", "--polar", "out.svg"],
    ["explore", "in/study.toml", "--no-speed", "--jobs", "1", "--out", "out", "--figure", "potential", "--error", "5%"],
    ["fit", "in/fit.toml", "--jobs", "1", "--out", "out", "--json"], ["pitch", "in/bar.toml", "--error", "20%", "--particles", "400", "--out", "out"],
    ["stability", "in/scene.toml", "--resolution", "0.2", "--strain", "0.01", "--axis", "x"],
    ["picture", "in/run", "--out", "out.png", "--field", "speed", "--steps", "0,24", "--limit", "1", "--width", "300"],
    ["report", "in/run", "--out", "out.html"], ["new", "out", "--like", "gas"], ["new", "--list"], ["--version"],
    ["synth", "in/run", "--target", "asic", "--unit", "node", "--seed", "1", "--freq", "12", "--activity", "0.1"],
    ["learn", "in/study.toml", "--out", "out"], ["multiscale", "in/study.toml", "--out", "out", "--clock", "1 GHz", "--fraction", "22"]]

# Of the programs of engines, which people also start by hand.
ENGINE_LINES = [["in/scene.toml", "--steps", "2", "--out", "out.h5"], ["in/scene.toml", "--steps", "2", "--frames", "0,1,2", "--energies", "--watch", "--out", "out.h5"],
                ["in/scene.toml", "--from", "in/run", "--steps", "1", "--hash-every", "1", "--out", "out.h5"]]

WORDS = ["", " ", "-", "--", "0", "-1", "1", "nan", "inf", "1e308", "99999999999999999999", "-99999999999999999999", "1e-320", "0x10", "1.5", "5%", "-5%", "1000%",
         "x", "x,y", ",", ",,,", "/dev/null", "/", ".", "..", "in", "in/scene.toml", "missing/deep/path", "x" * 3000, "a\nb", "\x1b[2J", "\u202e", "\u00e4", "\udcff",
         "--help", "--json", "--out", "--steps", "--jsn", "--out=", "--threads=2", "-q", "-z", "1 parsec", "1 GHz GHz", "{}", "[", "'", '"', "$(id)", "%s%n", "xyz", "all",
         "golden,golden", "golden,lattice,reference", "gpu", "rtl", "4294967296", "18446744073709551615", "18446744073709551616", "1,1,1", "0,0,0", "1000000"]


def change_words(words, rng):
    at = rng.randrange(len(words))
    way = rng.choice(["replaced", "replaced", "replaced", "added", "gone", "twice", "swapped", "cut"])
    if way == "replaced":
        words[at] = rng.choice(WORDS)
    elif way == "added":
        words.insert(at, rng.choice(WORDS))
    elif way == "gone" and len(words) > 1:
        del words[at]
    elif way == "twice":
        words.insert(at, words[at])
    elif way == "swapped":
        other = rng.randrange(len(words))
        words[at], words[other] = words[other], words[at]
    else:
        words[at] = words[at][:rng.randrange(len(words[at]) + 1)]
    return "word " + way


# How many of 3,500 inputs are of each kind. Those of yosys take seconds each.
SHARES = {"scene": 1000, "arch": 300, "study": 250, "machines": 120, "fit": 200, "potential_fit": 100, "multiscale": 170, "gmsh": 100, "learn": 90,
          "pitch": 60, "technology": 180, "mesh": 200, "particles": 120, "potential": 70, "run_directory": 160, "checkpoint": 120, "results": 130, "liberty": 15, "project": 15,
          "line": 100}
