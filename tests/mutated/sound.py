# SPDX-License-Identifier: MIT
"""Small sound inputs, before they are spoilt: scenes, studies, fits."""
SMALL_SCENE = """title = "Grips"
units = "reduced"
mass = 1.0
[packing]
pitch = 1.0
offset = [0.3, 0.3, 0.3]
[box]
cells = [2, 1, 1]
[law]
kind = "elastic"
stiffness = 1.0
[damping]
ratio = 0.1
[[constraint]]
name = "left"
kind = "held"
region = { shape = "half_space", point = [0.4, 0, 0], normal = [1, 0, 0] }
[[constraint]]
name = "right"
kind = "moved"
velocity = [0.03, -0.01, 0.0]
region = { shape = "half_space", point = [2.4, 0, 0], normal = [-1, 0, 0] }
[[probe]]
name = "grip"
kind = "force"
region = { shape = "half_space", point = [0.4, 0, 0], normal = [1, 0, 0] }
[run]
dt = 0.14
steps = 24
probe_every = 6
frame_every = 6
[reach]
margin = 0.05
""".encode()

STUDY = b"""title = "Small"
units = "reduced"
scene = "scene.toml"
samples = 4
[truth]
tolerance = 1e-2
rungs = 4
[[figure]]
kind = "mean"
name = "potential"
curve = "energy.potential"
[[sweep]]
arithmetic = ["fixed", "float64"]
[[sweep]]
index_bits = [5, 6]
set.damping.ratio = 0.1
[search]
strength_bits = [16, 20]
index_bits = [5, 7]
"""

MACHINES = b"""title = "Small machines"
units = "reduced"
scene = "scene.toml"
steps = 5
constraints = ["power <= 100 W", "fits ecp5-85"]
minimise = ["time", "energy", "area"]
[[machines]]
clock = ["100 MHz", "1 GHz"]
filter_lanes = [1, 2]
force_pipes = 1
brick = [[1, 1, 1], [2, 1, 1]]
[[machines]]
technology = "ice40"
clock = "50 MHz"
link_bits = ["record", 8]
"""

BAR = b"""density = "1.41 g/cm^3"
[packing]
pitch = "1 mm"
axes = [[1, 1, 0], [-1, 1, 0]]
[geometry]
region = "bar"
[regions]
bar = { shape = "box", size = "[8, 2.9, 3] mm" }
left = { shape = "half_space", point = "[-2.9, 0, 0] mm", normal = "x" }
right = { shape = "half_space", point = "[2.9, 0, 0] mm", normal = "-x" }
[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = "x"
[[constraint]]
name = "fixed"
kind = "held"
region = "left"
[[constraint]]
name = "pulled"
kind = "moved"
velocity = "[0.25, 0, 0] m/s"
region = "right"
[[probe]]
name = "tension"
kind = "stress_strain"
axis = "x"
lower = "left"
upper = "right"
grip = "right"
area = "9.192 mm^2"
[run]
duration = "0.3 ms"
static = { load_steps = 3, evaluations = 200 }
"""

FIT = b"""title = "Small fit"
scene = "bar.toml"
reach = 1.4142135
[target]
file = "curve.csv"
strain_column = "strain"
stress_unit = "MPa"
to = 0.03
[search]
samples = 5
generations = 1
seed = 3
[bounds]
stiffness = [0.8, 1.2]
pull_1 = [0.5, 1.5]
"""
CURVE = b"# made by hand\nstrain,stress (MPa)\n" + b"".join(b"%g,%g\n" % (k / 200, 15 * k - 0.2 * k * k) for k in range(9))

POTENTIAL_FIT = b"""title = "Small potential"
[fit]
kind = "tersoff"
starts = 2
evaluations = 60
from = "si_erhart_albe"
tried = 1
enough = 10
[target]
edge = "5.429 angstrom"
energy = "-4.63 eV"
B = "99 GPa"
Cprime = "51 GPa"
C11 = "167 GPa"
C12 = "65 GPa"
C44_clamped = "106 GPa"
C44 = "81 GPa"
[weights]
slope = 2
[potential]
element = "Si"
R = "2.85 angstrom"
D = "0.15 angstrom"
[stability]
mass = "28.0855 u"
cells = 3
temperature = "300 K"
time = "0.02 ps"
[bounds]
c = [1, 1e6]
"""

MULTISCALE = b"""title = "Small body"
[material]
potential = "si_multiscale"
edge = "5.43 angstrom"
mass = "28.0855 u"
cells = 1
[mesh]
cubes = [2, 1, 1]
size = "[2, 1, 1] um"
repeats = "x"
[grains]
seed = 1
cubes = 1
[samples]
strain_tolerance = 1e-4
[stretch]
axis = "x"
strains = [0.001, 0.002]
"""
WAVE = b"""[material]
file = "silicon.tersoff"
edge = "5.43 angstrom"
mass = "28.0855 u"
cells = 1
[mesh]
cubes = [16, 2, 2]
size = "[16, 2, 2] um"
repeats = "yz"
[grains]
orientation = { along = [1, 1, 0], up = [0, 0, 1] }
[samples]
strain_tolerance = 1e-4
[wave]
along = "x"
polarisation = "x"
peak = "20 MPa"
reference = "8290 m/s"
snapshots = "[0.5, 1] ns"
"""
GMSH = MULTISCALE.replace(b'cubes = [2, 1, 1]\nsize = "[2, 1, 1] um"', b'file = "body.msh"\nunit = "um"').replace(b"cubes = 1\n", b"")

LEARN = b"""title = "Small sheet"
[sheet]
potential = "c_1989"
mass = "2e-26 kg"
cells = [12, 7]
[grid]
points = 6
[static]
strain = 0.005
force = "1e-5 eV/angstrom"
waves = 1
disc = [{ force = "x", centres = "y", radius = "10 angstrom" }]
[kernel]
horizons = [2]
degrees = [3]
seeds = 1
evaluations = 30
"""

TERSOFF_SCENE = b"""mass = "28.0855 u"
[crystal]
lattice = "diamond"
edge = "5.432 angstrom"
[box]
cells = [3, 3, 3]
periodic = "xyz"
[rule]
kind = "tersoff"
file = "silicon.tersoff"
element = "Si"
[[velocity]]
temperature = "300 K"
seed = 1
[run]
dt = "1 fs"
steps = 2
"""

MESH_SCENE = b"""density = "1 g/cm^3"
[packing]
pitch = "0.5 mm"
[geometry]
shape = "mesh"
file = "%s"
unit = "mm"
[law]
kind = "elastic"
stiffness = "1 kN/m"
[run]
dt = "auto"
steps = 3
"""

# Of 256 particles, with checkpoints.
LONG_RUN = ["run", "in/scene.toml", "--steps", "90", "--frame-every", "3", "--checkpoint-every", "30 steps", "--quiet", "--out", "out"]

# A study's files and the command that takes them.
STUDIES = {
    "explore": ({"in/study.toml": STUDY, "in/scene.toml": SMALL_SCENE}, ["explore", "in/study.toml", "--no-speed", "--jobs", "1", "--out", "out"]),
    "search": ({"in/study.toml": STUDY, "in/scene.toml": SMALL_SCENE}, ["explore", "in/study.toml", "--error", "5%", "--jobs", "1", "--out", "out"]),
    "machines": ({"in/study.toml": MACHINES, "in/scene.toml": SMALL_SCENE}, ["explore", "in/study.toml", "--jobs", "1", "--out", "out"]),
    "fit": ({"in/fit.toml": FIT, "in/bar.toml": BAR, "in/curve.csv": CURVE}, ["fit", "in/fit.toml", "--jobs", "1", "--out", "out"]),
    "potential_fit": ({"in/fit.toml": POTENTIAL_FIT}, ["fit", "in/fit.toml", "--jobs", "1", "--out", "out"]),
    "multiscale": ({"in/study.toml": MULTISCALE}, ["multiscale", "in/study.toml", "--threads", "1", "--out", "out"]),
    "learn": ({"in/study.toml": LEARN}, ["learn", "in/study.toml", "--jobs", "1", "--out", "out"]),
    "pitch": ({"in/scene.toml": BAR}, ["pitch", "in/scene.toml", "--error", "20%", "--particles", "400", "--threads", "1", "--out", "out"]),
}
