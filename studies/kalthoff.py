# SPDX-License-Identifier: MIT
"""Kalthoff and Winkler: a notched plate of steel, hit at its edge, parts along 65 to 75 degrees.

Half of the plate, with a plane of symmetry, as a thin slab without end along z. 70.5 degrees is also the angle between close-packed planes of the
packing, so the packing is turned into several directions, and some are made uneven by weak patches. A control has no impact. Inputs: Borden et
al. (2012) as PhAST's case B2 has them. A packing of central forces has a Poisson's ratio of 0.26 where steel has 0.30. Its modulus is that of
the input in the mean over directions; its fracture energy is that of the input on {111} planes, and up to 29 % more on others."""
import math

import numpy as np
from scipy.spatial import cKDTree

from study import Study, check, main

MODULUS, DENSITY, ENERGY = 190e9, 8000.0, 22130.0
SIDE, NOTCH, HEIGHT, SPEED, DURATION = 0.1, 0.05, 0.025, 16.5, 90e-6
CONTRAST = 0.6  # of the energies of tough and weak patches, over their mean
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


def plate(pitch, turn, speed=SPEED, uneven=0):
    normal, a, b, angle = TURNS[turn]
    period = pitch * (math.sqrt(2) if normal == [0, 0, 1] else 1)
    thick = math.ceil(4.3 * pitch / period) * period
    deep = 1.5 * pitch
    stiffness = math.sqrt(2) * pitch * MODULUS / HILL
    slot = box([-1, HEIGHT - 0.75 * pitch, -1], [NOTCH, HEIGHT + 0.75 * pitch, 1])
    around = box([0.02, 0.005, -1], [SIDE - 0.005, SIDE - 0.005, 1])
    scene = {
        "title": f"Kalthoff and Winkler, {turn}",
        "density": f"{DENSITY} kg/m^3",
        "packing": {"pitch": f"{pitch!r} m", "axes": turned(a, b, angle)},
        "box": {"periodic": "z", "size": f"[{SIDE}, {SIDE}, {thick!r}] m"},
        "geometry": {"shape": "difference", "from": box([0, 0, -1], [SIDE, SIDE, 1]), "minus": [slot]},
        "law": {"kind": "viscous", "stiffness": f"{stiffness!r} N/m", "fracture_energy": f"{ENERGY!r} J/m^2"},
        "damping": {"ratio": 1.0},
        "constraint": [
            {"name": "middle", "kind": "held", "axes": "y", "region": box([-1, -1, -1], [1, 0.8 * pitch, 1])},
            {"name": "hit", "kind": "moved", "axes": "x", "velocity": f"[{speed}, 0, 0] m/s", "region": box([-1, -1, -1], [deep, HEIGHT - pitch, 1])},
        ],
        "probe": [{"name": "crack", "kind": "crack", "axis": "y", "start": f"{HEIGHT} m", "region": around}],
        "run": {"dt_safety": 0.5, "duration": f"{DURATION} s", "frame_every": 0, "probe_every": 10},
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


def broken(case, pitch):
    """Middles (x, y) at the start of bonds that are broken in the last frame."""
    frames = list(case.frames())
    begin, end = frames[0][2], frames[-1][2]
    pairs = cKDTree(begin).query_pairs(1.2 * pitch, output_type="ndarray")  # those across the periodic faces are left out
    reach = np.linalg.norm(end[pairs[:, 1]] - end[pairs[:, 0]], axis=1) / np.linalg.norm(begin[pairs[:, 1]] - begin[pairs[:, 0]], axis=1)
    gone = pairs[(reach > 1.15) & (reach < 50)]
    return 0.5 * (begin[gone[:, 0]] + begin[gone[:, 1]])[:, :2]


def path(middles):
    """Of the crack from the notch: its angle from the notch's line by least squares through the tip, and the quartiles of that of its bonds."""
    away = middles - [NOTCH, HEIGHT]
    far = np.linalg.norm(away, axis=1)
    away = away[(away[:, 1] > 0) & (far > 0.004) & (far < 0.05) & (away[:, 0] > -0.03)]
    if len(away) < 30:
        return None
    angles = np.degrees(np.arctan2(away[:, 1], away[:, 0]))
    values, vectors = np.linalg.eigh(away.T @ away)
    along = vectors[:, 1] * np.sign(vectors[1, 1])
    return math.degrees(math.atan2(along[1], along[0])), *np.percentile(angles, (25, 50, 75))


def started(case, pitch):
    time, length = case.curve("crack.length")
    at = np.argmax(length > pitch)
    return time[at] if length[at] > pitch else math.nan


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
        ways[name] = middles = broken(case, pitch)
        found = path(middles)
        angle, quartiles = (f"{found[0]:.1f}", f"{found[1]:.1f} to {found[3]:.1f}") if found else ("–", "–")
        length = case.curve("crack.length")[1][-1]
        rows.append((name, f"{bonds:.0f}", angle, quartiles, f"{1e6 * started(case, pitch):.1f}".replace("nan", "–"), f"{1e3 * length:.1f}", f"{case.value('particles')}", f"{case.value('host_time'):.0f}"))
    first = list(runs.values())[0]
    check("start of the crack, s", started(first, pitch), 27.9e-6, 0.25)
    gained = max(0, *(ways[turns[0]][:, 1] - HEIGHT))
    if gained < 0.01:
        raise SystemExit(f"{turns[0]}: the crack gains {1e3 * gained:.1f} mm of height, less than 10")
    study.table("kalthoff", ("packing", "broken bonds", "angle, degrees", "quartiles", "start, µs", "height gained, mm", "particles", "host time, s"), rows, "two cores, shared")
    with study.figure("kalthoff", 1, (9, 9)) as axes:
        figure = axes.figure
        axes.remove()
        columns = 4
        for k, (name, middles) in enumerate(ways.items()):
            place = figure.add_subplot(math.ceil(len(ways) / columns), columns, k + 1)
            place.plot(1e3 * middles[:, 0], 1e3 * middles[:, 1], ".k", ms=1, rasterized=True)
            place.plot([0, 50], [25, 25], "b", lw=1)
            place.plot([50, 50 + 75 / math.tan(math.radians(70))], [25, 100], "r--", lw=0.7)
            place.set(title=name, xlim=(0, 100), ylim=(0, 100), aspect="equal")
            place.title.set_fontsize(7)
    study.end()


if __name__ == "__main__":
    main(run)
