# SPDX-License-Identifier: MIT
"""Kalthoff and Winkler: a notched plate of steel, hit at its edge, parts along 65 to 75 degrees.

Half of the plate, with a plane of symmetry, as a thin slab without end along z. 70.5 degrees is also the angle between close-packed planes of the
packing, so the packing is turned into several directions, some are made uneven by weak patches, and some are of many grains. Controls have no
impact. Inputs: Borden et al. (2012) as PhAST's case B2 has them. A packing of central forces has a Poisson's ratio of 0.26 where steel has 0.30.
Its modulus is that of the input in the mean over directions; its fracture energy is that of the input on {111} planes, and up to 29 % more on others."""
import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from study import Study, check, main

MODULUS, DENSITY, ENERGY = 190e9, 8000.0, 22130.0
SIDE, NOTCH, HEIGHT, SPEED, DURATION = 0.1, 0.05, 0.025, 16.5, 90e-6
CONTRAST = 0.6  # of the energies of tough and weak patches, over their mean
# A law that ends at REACH times the strain of its peak. Displacements are a number of times the true ones, the fracture energy as often squared: linear
# fracture is the same then. Without grains that number is LITTLE. With grains the peak is at the strain PEAK, so that bonds bridge what boundaries misfit.
PEAK, REACH, LITTLE = 0.1, 2.3, 4.0
CLOSEST = 0.55  # of grains: 97 % of the crystal's density at 10 pitches
SEEDS = (1, 2, 3, 4, 5)
KINDS = ((1.6e-3, "random", 8, SEEDS), (1.6e-3, "z", 8, SEEDS), (0.8e-3, "random", 8, SEEDS[:3]))
HILL = 1.9091  # modulus over c, Hill's mean of C11 = 2c, C12 = C44 = c, with c = k/(sqrt 2 pitch)
# Normal of the slab, then the crystal direction along x. Turns about [001] repeat after 90 degrees, about [1-10] after 180.
TURNS = {f"[001] turned by {angle:g}": ([0, 0, 1], [1, 0, 0], [0, 1, 0], angle) for angle in (0, 22.5, 45)} | {
    f"[1-10] turned by {angle:g}": ([1, -1, 0], [1, 1, 0], [0, 0, 1], angle) for angle in (0, 20, 35.26, 54.74, 90, 125.26, 150)
}


def turned(a, b, angle):
    """Crystal directions along x and y: a turned towards b by an angle in degrees."""
    a, b = np.array(a) / np.linalg.norm(a), np.array(b) / np.linalg.norm(b)
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return [(c * a + s * b).tolist(), (c * b - s * a).tolist()]


def box(low, high):
    text = lambda ends: "[" + ", ".join(f"{end!r}" for end in ends) + "] m"
    return {"shape": "box", "min": text(low), "max": text(high)}


def spring(pitch):
    """N/m, of a bond whose packing has the modulus in Hill's mean."""
    return math.sqrt(2) * pitch * MODULUS / HILL


def short_tail(h):
    """Distances in pitches and forces in stiffness times pitch: the cubic of the presets up to the peak at 1 + h, a cosine to zero at REACH h.
    Beside `viscous` of the same fracture energy its peak is 2.3 times as high."""
    push, s, t = np.linspace(1, 0.1, 10), np.linspace(0.1, 1, 10), np.linspace(0, 1, 14)[1:]
    r = np.concatenate([1 - push / 2, [1], 1 + h * s, 1 + h * (1 + (REACH - 1) * t)])
    f = np.concatenate([(push - push**3 / 3) / 2, [0], -h * (s - s**3 / 3), -h / 3 * (1 + np.cos(np.pi * t))])
    f[-1] = 0
    return r, f


def energy_of(points):
    """J over stiffness pitch^2, as a function of the distance in pitches."""
    law = PchipInterpolator(*points)
    whole, end = law.antiderivative(), points[0][-1]
    return lambda r: whole(end) - whole(np.clip(r, 0.5, end))


def viscous_stretch(pitch):
    """At which bonds of `viscous` end that take ENERGY on {111} planes; its law over its range goes as the range squared."""
    whole = CubicHermiteSpline([1, 1.03, math.sqrt(2)], [0, -0.02, 0], [-1, 0, 0]).antiderivative()
    return (math.sqrt(2) - 1) * math.sqrt(ENERGY / (-2 * math.sqrt(3) * spring(pitch) * float(whole(math.sqrt(2)))))


def scale_of(pitch, h):
    """How many times the true displacements are those at which {111} planes of this law take ENERGY times as much squared."""
    return math.sqrt(2 * math.sqrt(3) * float(energy_of(short_tail(h))(1.0)) * -1 * spring(pitch) / ENERGY)


def spline(pitch, h):
    r, f = short_tail(h)
    text = lambda values, unit: "[" + ", ".join(f"{v:.12g}" for v in values) + "] " + unit
    return {"kind": "spline", "core": f"{0.5 * pitch!r} m", "r": text(r * pitch, "m"), "force": text(f * spring(pitch) * pitch, "N")}


def short(pitch, h, turn="[001] turned by 0", grains=None, speed=SPEED, uneven=0):
    """The plate with the short law. Of one crystal, or of `grains`: (size in pitches, seed, texture)."""
    scene = plate(pitch, turn, speed=speed * scale_of(pitch, h), uneven=uneven)
    scene["law"] = spline(pitch, h * math.sqrt(1 + CONTRAST) if uneven else h)
    for bond in scene.get("bond", []):
        bond["law"] = spline(pitch, h * math.sqrt(1 - CONTRAST))
    # Faces of the notch that come nearer than bonds reach would join again.
    scene["geometry"]["minus"] = [box([-1, HEIGHT - 1.5 * pitch, -1], [NOTCH, HEIGHT + 1.5 * pitch, 1])]
    del scene["probe"]  # it would take boundaries that part for the crack
    if grains:
        size, seed, texture = grains
        scene["title"] = f"Kalthoff and Winkler, grains of {size} pitches"
        scene["packing"]["grains"] = {"size": f"{size * pitch!r} m", "seed": seed, "texture": texture, "closest": CLOSEST}
        if texture == "random":
            del scene["packing"]["axes"]
            scene["box"]["size"] = f"[{SIDE}, {SIDE}, {5 * pitch!r}] m"
    return scene


def relaxed(scene, pitch):
    """At rest before the impact. Its weight tells how much may stay unbalanced: of a particle some 10^-5 of the largest force of a bond."""
    still = scene | {"constraint": [scene["constraint"][0]]}
    still["gravity"] = f"[0, {-48 / pitch!r}, 0] m/s^2"
    return still | {"run": {"steps": 1, "dt_safety": 0.5, "static": {"load_steps": 1, "tolerance": 0.5, "evaluations": 200000}}}


def plate(pitch, turn, speed=SPEED, uneven=0):
    normal, a, b, angle = TURNS[turn]
    period = pitch * (math.sqrt(2) if normal == [0, 0, 1] else 1)
    thick = math.ceil(4.3 * pitch / period) * period
    deep = 1.5 * pitch
    slot = box([-1, HEIGHT - 0.75 * pitch, -1], [NOTCH, HEIGHT + 0.75 * pitch, 1])
    around = box([0.02, 0.005, -1], [SIDE - 0.005, SIDE - 0.005, 1])
    scene = {
        "title": f"Kalthoff and Winkler, {turn}",
        "density": f"{DENSITY} kg/m^3",
        "packing": {"pitch": f"{pitch!r} m", "axes": turned(a, b, angle)},
        "box": {"periodic": "z", "size": f"[{SIDE}, {SIDE}, {thick!r}] m"},
        "geometry": {"shape": "difference", "from": box([0, 0, -1], [SIDE, SIDE, 1]), "minus": [slot]},
        "law": {"kind": "viscous", "stiffness": f"{spring(pitch)!r} N/m", "fracture_energy": f"{ENERGY!r} J/m^2"},
        "damping": {"ratio": 1.0},
        "constraint": [
            {"name": "middle", "kind": "held", "axes": "y", "region": box([-1, -1, -1], [1, 0.8 * pitch, 1])},
            {"name": "hit", "kind": "moved", "axes": "x", "velocity": f"[{speed}, 0, 0] m/s", "region": box([-1, -1, -1], [deep, HEIGHT - pitch, 1])},
        ],
        "probe": [{"name": "crack", "kind": "crack", "axis": "y", "start": f"{HEIGHT} m", "region": around}],
        "run": {"dt_safety": 0.5, "duration": f"{DURATION} s", "frame_every": round(0.0388 / pitch), "probe_every": 10},
    }
    if uneven:
        generator = np.random.default_rng(uneven)
        radius = 1.5 * pitch
        count = round(math.log(2) * SIDE**2 / (math.pi * radius**2))  # they cover half of the plate
        patch = lambda at: {"shape": "cylinder", "radius": f"{radius!r} m", "length": "1 m", "centre": f"[{at[0]!r}, {at[1]!r}, 0] m"}
        places = generator.uniform(0, SIDE, (count, 2)).tolist()
        scene["material"] = [{"name": "tough"}, {"name": "weak", "region": {"shape": "union", "of": [patch(at) for at in places]}}]
        scene["law"]["fracture_energy"] = f"{(1 + CONTRAST) * ENERGY!r} J/m^2"
        scene["bond"] = [{"between": ["weak", "weak"], "law": scene["law"] | {"fracture_energy": f"{(1 - CONTRAST) * ENERGY!r} J/m^2"}}]
    return scene


class Opened:
    """The bonds of a case, of this stretch, that are twice as far stretched in the last state: `pairs` of particles, and the `middles` (x, y) that
    they had at first. `crack` says which are one crack with the notch; `start` is the time in s of the first state in which something there reaches 2 mm above it."""

    def __init__(self, case, pitch, stretch):
        states = list(case.frames())
        begin, end = states[0][2], states[-1][2]
        pairs = cKDTree(begin).query_pairs((1 + stretch) * pitch, output_type="ndarray")  # those across the periodic faces are left out
        middles = 0.5 * (begin[pairs[:, 0]] + begin[pairs[:, 1]])[:, :2]
        is_open = lambda x: np.linalg.norm(x[pairs[:, 1]] - x[pairs[:, 0]], axis=1) > (1 + 2 * stretch) * pitch
        now = is_open(end)
        self.pairs, self.middles = pairs[now], middles[now]
        self.crack = from_notch(self.middles, pitch)[1]
        self.start = math.nan
        for time, _, x in states:
            there = middles[is_open(x)]
            if (there[from_notch(there, pitch)[0], 1] > HEIGHT + 2e-3).any():
                self.start = time
                break


def clusters(points, pairs):
    return connected_components(coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2), directed=False)[1]


def from_notch(middles, pitch):
    """By middle, whether it holds together without a gap of three pitches with some that come within four pitches of the notch's end; and whether it is of
    the crack, the most that do so with each other."""
    near = np.linalg.norm(middles - [NOTCH, HEIGHT], axis=1) < 4 * pitch
    if not near.any():
        return near, near
    cluster = clusters(middles, cKDTree(middles).query_pairs(3 * pitch, output_type="ndarray"))
    return np.isin(cluster, cluster[near]), cluster == max(set(cluster[near]), key=np.bincount(cluster).__getitem__)


def crystals(x, pitch):
    """By particle, a number of the grain: pairs of one crystal are a pitch apart to the last digits."""
    pairs = cKDTree(x).query_pairs(1.001 * pitch, output_type="ndarray")
    length = np.linalg.norm(x[pairs[:, 1]] - x[pairs[:, 0]], axis=1)
    return clusters(x, pairs[np.abs(length / pitch - 1) < 1e-6])


def path(crack):
    """Of a crack's bonds above the notch: the angle of the line from the notch's end to the farthest, that of the line of least squares through the
    notch's end, both in degrees, and the largest height in m. No crack where they reach less than 10 mm."""
    away = crack - [NOTCH, HEIGHT]
    away = away[away[:, 1] > 0]
    far = np.linalg.norm(away, axis=1)
    if not len(away) or far.max() < 0.01:
        return math.nan, math.nan, max([0.0, *away[:, 1]])
    tip = away[far.argmax()]
    _, vectors = np.linalg.eigh(away.T @ away)
    along = vectors[:, 1] * np.sign(vectors[1, 1])
    return *(math.degrees(math.atan2(v[1], v[0])) for v in (tip, along)), away[:, 1].max()


def started(case, pitch):
    """s, when the crack that the probe sees is longer than a pitch."""
    time, length = case.curve("crack.length")
    at = np.argmax(length > pitch)
    return time[at] if length[at] > pitch else math.nan


def text(value, digits=1):
    return "–" if math.isnan(value) else f"{value:.{digits}f}"


def boundaries(study):
    """What parts the boundaries of a relaxed cube of grains, over the energy of {111}, by law."""
    edge, size = 16.0, 8.0
    viscous = lambda s: ([0.5, 1, 1 + 0.03 * s, 1 + (math.sqrt(2) - 1) * s], [1 / 3, 0, -0.02 * s, 0], [0, -1, 0, 0])
    laws = {}
    for name, s in (("viscous, bonds reach 14 %", 0.329), ("viscous, 41 %", 0.9999)):
        points = viscous(s)
        whole = CubicHermiteSpline(*points).antiderivative()
        energy = lambda r, whole=whole, end=points[0][-1]: whole(end) - whole(np.clip(r, 0.5, end))
        laws[name] = ({"kind": "viscous", "stiffness": 1.0, "fracture_energy": float(-2 * math.sqrt(3) * energy(1.0))}, energy)
    for h in (0.0231, 0.05, 0.1, 0.15):
        r, f = short_tail(h)
        laws[f"short tail, {100 * REACH * h:.0f} %"] = ({"kind": "spline", "core": 0.5, "r": r.tolist(), "force": f.tolist()}, energy_of((r, f)))
    rows = []
    for name, (law, energy) in laws.items():
        found = []
        for seed in (1, 2):
            cube = lambda closest: {
                "units": "reduced", "mass": 1.0, "law": law, "box": {"periodic": "xyz", "size": [edge] * 3},
                "packing": {"pitch": 1.0, "grains": {"size": size, "seed": seed, "closest": closest}}, "run": {"steps": 1}}  # fmt: skip
            packed = study.run({f"cube {closest} {seed}": cube(closest) | {"law": {"kind": "elastic", "stiffness": 1.0}} for closest in (0.3, CLOSEST)}, "--engine", "reference", "--no-watch", "--steps", "0")
            still = study.run({f"cube {seed}, {name}".replace("%", ""): cube(CLOSEST) | {"run": {"steps": 1, "static": {"load_steps": 1}}}}, "--no-watch")
            lengths = lambda x, pairs: np.linalg.norm((d := x[pairs[:, 1]] - x[pairs[:, 0]]) - edge * np.round(d / edge), axis=1)
            near = lambda x, far: cKDTree(np.mod(x, edge), boxsize=edge).query_pairs(far, output_type="ndarray")
            ours = lambda x: (pairs := near(x, 1.001))[np.abs(lengths(x, pairs) - 1) < 1e-6]
            full, begin = (next(case.frames())[2] for case in packed.values())
            end = list(list(still.values())[0].frames())[-1][2]
            # A plane of any direction cuts 3 sqrt 2 bonds per pitch^2 in the mean; a boundary ends as many of both its grains.
            area = (12 * math.sqrt(2) * edge**3 - 2 * len(ours(full))) / (2 * 3 * math.sqrt(2))
            grain = clusters(begin, ours(begin))
            pairs = near(end, math.sqrt(2))
            across = pairs[grain[pairs[:, 0]] != grain[pairs[:, 1]]]
            found.append(float(energy(lengths(end, across)).sum() / area / (2 * math.sqrt(3) * energy(1.0))))
        scale = math.sqrt(-2 * math.sqrt(3) * float(energy(1.0)) * spring(1.6e-3) / ENERGY)
        rows.append((name, f"{scale:.1f}", f"{found[0]:.2f}", f"{found[1]:.2f}"))
    study.table("kalthoff-boundaries", ("law", "displacements, over the true ones", "energy of boundaries over that of {111}", "other seed"), rows)


def crystals_of_short_law(study, pitch, ways):
    """Single crystals, with the displacements of LITTLE and with those of grains."""
    rows, strains = [], (PEAK * LITTLE / scale_of(pitch, PEAK), PEAK)
    for turn in TURNS:
        row = [turn]
        for h in strains:
            name = f"{turn}, short, {scale_of(pitch, h):.3g} times".replace("[", "").replace("]", "")
            case = study.run({name: short(pitch, h, turn)}, "--engine", "reference", "--no-watch")[name]
            opened = Opened(case, pitch, REACH * h)
            tip, fit, height = path(opened.middles[opened.crack])
            row += [text(tip), text(fit), text(1e6 * opened.start, 0), text(1e3 * height)]
            ways[f"{turn}, {scale_of(pitch, h):.3g} times"] = opened, None
        rows.append(row)
    head = [f"{what}, {scale_of(pitch, h):.3g} times" for h in strains for what in ("to the tip", "least squares", "start, µs", "height, mm")]
    study.table("kalthoff-short", ("packing", *head), rows)


def of(values):
    """Mean and standard deviation of those that are numbers."""
    values = [value for value in values if not math.isnan(value)]
    return f"{np.mean(values):.0f} ± {np.std(values, ddof=1):.0f}" if len(values) > 1 else "–"


def uneven_crystals_of_short_law(study, pitch, turns, seeds, ways):
    """Rows of a table: what the seeds of each turn say, then what all turns about [001] say together."""
    h = PEAK * LITTLE / scale_of(pitch, PEAK)
    head = f"{1e3 * pitch:g} mm, "
    names = {(turn, seed): f"{head}{turn}, uneven {seed}" for turn in turns for seed in seeds}
    file = lambda name: name.replace("[", "").replace("]", "")
    runs = study.run({file(name): short(pitch, h, turn, uneven=seed) for (turn, seed), name in names.items()}, "--engine", "reference", "--no-watch")
    rows, all_of_001 = [], []
    for turn in turns:
        found = []
        for seed in seeds:
            opened = Opened(runs[file(names[turn, seed])], pitch, REACH * h * math.sqrt(1 + CONTRAST))
            tip, fit, height = path(opened.middles[opened.crack])
            found.append((tip, fit, 1e6 * opened.start, 1e3 * height))
            if turn.startswith("[001]"):
                ways[names[turn, seed].replace("uneven", "seed")] = opened, None
        all_of_001 += found if turn.startswith("[001]") else []
        rows.append((head + turn, found))
    rows.append((head + "all of [001]", all_of_001))
    return [
        (name, f"{sum(not math.isnan(v[0]) for v in found)} of {len(found)}", *(of(v) for v in zip(*found)), " ".join(text(v[1], 0) for v in found[: len(seeds)]) if "all" not in name else "")
        for name, found in rows
    ]


def grains(study, kinds, ways):
    """The plate of many grains. Of each kind: pitch, how they turn, size in pitches, seeds."""
    rows, means = [], []
    for pitch, texture, size, seeds in kinds:
        found = []
        what = f"{1e3 * pitch:g} mm, {size}, {'any way' if texture == 'random' else 'columns'}"
        for seed in seeds:
            name = f"grains, {what}, {seed}"
            scene = short(pitch, PEAK, grains=(size, seed, texture))
            packed = study.run({f"{name}, packed": relaxed(scene, pitch) | {"run": {"steps": 1, "dt_safety": 0.5}}}, "--engine", "reference", "--no-watch", "--steps", "0")
            still = relaxed(scene, pitch)
            study.run({f"{name}, relaxed": still}, "--no-watch")
            scene["title"] += f", relaxed under {still['gravity']}"  # so that another relaxation makes another case
            case = study.run({name: scene | {"start": {"from": f"{name}, relaxed"}}}, "--engine", "reference", "--no-watch")[name]
            rest = f"{name}, no impact"
            quiet = study.run({rest: scene | {"constraint": short(pitch, PEAK, speed=0.0)["constraint"]} | {"start": {"from": f"{name}, relaxed"}}}, "--engine", "reference", "--no-watch")[rest]
            opened, alone = Opened(case, pitch, REACH * PEAK), len(Opened(quiet, pitch, REACH * PEAK).pairs)
            check(f"{name}: 1 and the open bonds without impact over those with it", 1 + alone / len(opened.pairs), 1, 0.005)
            grain = crystals(next(list(packed.values())[0].frames())[2], pitch)
            between = grain[opened.pairs[:, 0]] != grain[opened.pairs[:, 1]]
            tip, fit, height = path(opened.middles[opened.crack])
            ways[f"{what}, seed {seed}"] = opened, between
            found.append((tip, fit, 1e6 * opened.start, 1e3 * height, 100 * between[opened.crack].mean() if opened.crack.any() else math.nan))
            rows.append((what, f"{seed}", f"{alone}", f"{len(opened.pairs)}", f"{opened.crack.sum()}", *(text(v, 0) for v in found[-1])))
            print(*rows[-1], flush=True)
        with_crack = sum(not math.isnan(v[0]) for v in found)
        means.append((what, f"{with_crack} of {len(found)}", *(of(v) for v in zip(*found))))
    head = ("pitch, grains' size in pitches, turned", "seed", "open bonds without impact", "with it", "of the crack", "to the tip", "least squares", "start, µs", "height, mm", "between grains, %")
    study.table("kalthoff-grains", head, rows)
    head = ("pitch, grains' size in pitches, turned", "with a crack", "to the tip", "least squares", "start, µs", "height, mm", "between grains, %")
    study.table("kalthoff-means", head, means)


def picture(study, name, ways, columns, kind):
    with study.figure(name, 1, (2.3 * columns, 2.4 * math.ceil(len(ways) / columns)), kind) as axes:
        figure = axes.figure
        axes.remove()
        for k, (title, (opened, between)) in enumerate(ways.items()):
            place = figure.add_subplot(math.ceil(len(ways) / columns), columns, k + 1)
            crack, boundary = opened.crack, np.zeros(len(opened.crack), bool) if between is None else between
            for which, colour, size in ((~crack, "0.7", 0.7), (crack & boundary, "tab:blue", 1), (crack & ~boundary, "k", 1)):
                place.plot(*(1e3 * opened.middles[which]).T, ".", color=colour, ms=size, rasterized=True)
            place.plot([0, 50], [25, 25], "tab:green", lw=1)
            place.plot([50, 50 + 75 / math.tan(math.radians(70))], [25, 100], "r--", lw=0.7)
            place.set(title=title, xlim=(0, 100), ylim=(0, 100), aspect="equal")
            place.title.set_fontsize(7)


def run():
    study = Study("kalthoff", __doc__)
    pitch = 2e-3 if study.small else 1.6e-3
    turns = list(TURNS)[:1] if study.small else list(TURNS)
    scenes = {turn: plate(pitch, turn) for turn in turns}
    if not study.small:
        scenes |= {f"{turn}, uneven {seed}": plate(pitch, turn, uneven=seed) for turn in (turns[0], turns[1], turns[3]) for seed in (1, 2)}
    scenes["no impact"] = plate(pitch, turns[0], speed=0.0)
    runs = study.run({name.replace("[", "").replace("]", ""): scene for name, scene in scenes.items()}, "--engine", "reference")
    rows, ways = [], {}
    for name, case in zip(scenes, runs.values()):
        bonds = case.curve("crack.broken")[1][-1]
        if name == "no impact":
            check("without impact: broken bonds and one", bonds + 1, 1, 0)
            rows.append((name, "0", "–", "–", "–", "–", f"{case.value('particles')}", f"{case.value('host_time'):.0f}"))
            continue
        opened = Opened(case, pitch, viscous_stretch(pitch))
        tip, fit, height = path(opened.middles[opened.crack])
        ways[name] = opened, None
        rows.append((name, f"{bonds:.0f}", text(tip), text(fit), text(1e6 * started(case, pitch)), text(1e3 * height), f"{case.value('particles')}", f"{case.value('host_time'):.0f}"))
    first = list(runs.values())[0]
    check("start of the crack, s", started(first, pitch), 27.9e-6, 0.25)
    opened, _ = ways[turns[0]]
    gained = path(opened.middles[opened.crack])[2]
    if gained < 0.01:
        raise SystemExit(f"{turns[0]}: the crack gains {1e3 * gained:.1f} mm of height, less than 10")
    study.table("kalthoff", ("packing", "broken bonds", "to the tip", "least squares", "start, µs", "height, mm", "particles", "host time, s"), rows, "two cores, shared")
    picture(study, "kalthoff", ways, 4, "svg")
    if not study.small:
        boundaries(study)
        single, uneven, many = {}, {}, {}
        crystals_of_short_law(study, pitch, single)
        picture(study, "kalthoff_short", single, 4, "png")
        rows = uneven_crystals_of_short_law(study, pitch, list(TURNS), SEEDS, uneven)
        picture(study, "kalthoff_uneven", uneven, len(SEEDS), "png")
        rows += uneven_crystals_of_short_law(study, pitch / 2, [turn for turn in TURNS if turn.startswith("[001]")], SEEDS[:3], {})
        head = ("pitch, packing", "with a crack", "to the tip", "least squares", "start, µs", "height, mm", "least squares, seed by seed")
        study.table("kalthoff-uneven", head, rows)
        grains(study, KINDS, many)
        picture(study, "kalthoff_grains", many, len(SEEDS), "png")
    study.end()


if __name__ == "__main__":
    main(run)
