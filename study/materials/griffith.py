# SPDX-License-Identifier: MIT
"""Griffith: cracks of known energy release rate and of known stress intensity start where the law's surface energy says.

A strip between two grips, cut half through along its middle, is pulled apart. Far ahead of the crack it is stretched evenly, far behind it is
slack: each length that the crack gains releases what that length of an uncracked strip holds (Rice, J. Appl. Mech. 35 (1968) 379). That is
exact for any packing and any law, and does not depend on the crack's length. A plate with a crack in its middle is the second check, by the
stress intensity of the handbook and the packing's own constants (Stroh). Both are at rest at each load step; the strip also breaks in motion.
Lengths are in pitches, forces in stiffness times pitch: all figures are ratios."""
import math

import numpy as np

from study import Study, check, main

SPACING = math.sqrt(2 / 3)  # of {111} planes
THICK = 5  # along z, which repeats after 1
GRIP = 2  # planes that are held at each end
SPEED, DT = 0.01, 0.1  # of the pulled grip at rest: a scale of time alone
CUT = 0.1  # where the cut of a strip ends
ALONG = math.sqrt(3)  # period along [11-2]
FORWARD, BACKWARD = [[1, 1, -2], [1, 1, 1]], [[-1, -1, 2], [1, 1, 1]]  # the way that the crack runs, the normal of its plane
LAWS = ("viscous", "brittle", "ductile", "elastic")


def box(low, high):
    return {"shape": "box", "min": low, "max": high}


def cut(scene, low, high):
    """Parts the body along y = 0 for x between the two: the planes on both sides only touch."""
    face = 0.75 * SPACING
    scene["material"] = [
        {"name": "whole"},
        {"name": "above", "region": box([low, 0, -9], [high, face, 9])},
        {"name": "below", "region": box([low, -face, -9], [high, 0, 9])},
    ]
    scene["bond"] = [{"between": ["above", "below"], "contact": True}]


def body(kind, axes, planes, length, imposed):
    """A slab of so many planes, without end along z, pulled at its outer planes; y = 0 lies between two planes of sites."""
    high = planes / 2 * SPACING
    inner = high - GRIP * SPACING
    half_space = lambda y, normal: {"shape": "half_space", "point": [0, y, 0], "normal": normal}
    return {
        "units": "reduced",
        "mass": 1,
        "packing": {"pitch": 1, "axes": axes, "offset": [0, SPACING / 2, 0]},
        "law": {"kind": kind, "stiffness": 1.0},
        "box": {"periodic": "z", "origin": [-length / 2, -high, 0], "size": [length, 2 * high, THICK]},
        "constraint": [
            {"name": "held", "kind": "held", "region": half_space(-inner, "y"), "axes": imposed},
            {"name": "pulled", "kind": "moved", "region": half_space(inner, "-y"), "axes": imposed, "velocity": [0, SPEED, 0]},
        ],
        "probe": [
            {"name": "grip", "kind": "force", "region": half_space(inner, "-y"), "axis": "y"},
            {"name": "opening", "kind": "displacement", "region": half_space(inner, "-y"), "axis": "y"},
            {"name": "crack", "kind": "crack", "region": box([-length, -inner, -9], [length, inner, 9]), "axis": "x"},
        ],
    }


def strip(kind, axes, planes, aspect, cracked=True):
    """The scene, and the length and height of what is between the grips."""
    height = (planes - 2 * GRIP + 1) * SPACING
    length = round(aspect * height / ALONG) * ALONG
    scene = body(kind, axes, planes, length, "xyz")
    if cracked:
        cut(scene, -length, CUT)
        scene["probe"][2]["start"] = CUT
    return scene, length, height


def steps(opening):
    return max(1, round(opening / (SPEED * DT)))


def loaded(scene, opening, load_steps):
    scene["run"] = {"dt": DT, "steps": steps(opening), "static": {"load_steps": load_steps}}
    return scene


def until_it_runs(scene, expected, length):
    """At rest: to 0.8 of the expected opening in four steps, then on by 1 % until the crack is so long."""
    scene["run"] = {"dt": DT}
    scene["stage"] = [
        {"name": "load", "steps": steps(0.8 * expected), "static": {"load_steps": max(4, math.ceil(4 * expected))}},
        {"name": "on", "steps": 100 * steps(0.01 * expected), "static": {"load_steps": 100}, "until": {"probe": "crack.length", "above": length}},
    ]
    return scene


def joined(case, *names):
    """Curves of all stages, one after the other; the first reading of a later stage is the last of the one before."""
    parts = [[stage.curve(name)[1][k > 0 :] for name in names] for k, stage in enumerate(case.stages or [case])]
    return [np.concatenate(values) for values in zip(*parts)]


def guess(constants, energy, height):
    """Opening at which a linear strip holds so much per area: clamped along x and z, its modulus is C22."""
    return math.sqrt(2 * energy * height / constants[1][1])


class Strips:
    """What an uncracked strip of the law holds per area, by opening: the difference of two lengths, so that ends do not count."""

    def __init__(self, study, cases, energies, constants):
        scenes, self.area, self.cases = {}, {}, cases
        for kind, axes, planes in cases:
            ends = []
            for aspect in (2, 3):
                scene, length, height = strip(kind, axes, planes, aspect, cracked=False)
                scenes[f"whole-{kind}-{name_of(axes)}-{planes}-{aspect}"] = loaded(scene, 1.3 * guess(constants[kind, name_of(axes)], energies[kind], height), 26)
                ends.append(length)
            self.area[kind, name_of(axes), planes] = (ends[1] - ends[0]) * THICK
        self.runs = study.run(scenes)

    def released(self, kind, axes, planes):
        short, long = (self.runs[f"whole-{kind}-{name_of(axes)}-{planes}-{aspect}"] for aspect in (2, 3))
        opening, held = joined(long, "opening.along", "energy.potential")
        less = joined(short, "energy.potential")[0]
        release = ((held - held[0]) - (less - less[0])) / self.area[kind, name_of(axes), planes]
        rising = np.argmax(np.append(np.diff(release) <= 0, True)) + 1  # beyond, a long strip breaks at its grips
        return opening[:rising], release[:rising]

    def griffith(self, kind, axes, planes, energy):
        opening, release = self.released(kind, axes, planes)
        if release[-1] < energy:
            raise SystemExit(f"strip of {planes} planes, {kind}: it breaks before it holds {energy:.4g} per area")
        return float(np.interp(energy, release, opening))


def name_of(axes):
    return "".join(map(str, axes[0])) + "-" + "".join(map(str, axes[1]))


def started(case, length):
    """Openings, and the place among them of the first reading at which the crack is so long; none where it never is."""
    opening, crack = joined(case, "opening.along", "crack.length")
    at = int(np.argmax(crack >= length))
    return opening, (at if crack[at] >= length else None)


def work(case):
    opening, force = joined(case, "opening.along", "grip.force")
    return np.concatenate([[0.0], np.cumsum(-0.5 * (force[1:] + force[:-1]) * np.diff(opening))])


def strips(study, energies, constants):
    sizes = (20,) if study.small else (20, 28, 40)
    cases = [("viscous", FORWARD, planes) for planes in sizes]
    if not study.small:
        cases += [("viscous", BACKWARD, sizes[0]), *((kind, FORWARD, sizes[0]) for kind in LAWS[1:])]
    whole = Strips(study, cases, energies, constants)
    scenes, limit, griffith = {}, {}, {}
    for kind, axes, planes in cases:
        name = f"strip-{kind}-{name_of(axes)}-{planes}"
        scene, length, _ = strip(kind, axes, planes, 3)
        griffith[name] = whole.griffith(kind, axes, planes, energies[kind])
        limit[name] = length / 6
        scenes[name] = until_it_runs(scene, griffith[name], limit[name])
    runs = study.run(scenes)
    rows = []
    for (kind, axes, planes), name in zip(cases, scenes):
        run = runs[name]
        opening, at = started(run, limit[name])
        moved = started(run, 1.0)[1]
        if (at is None or moved is None) and kind == "viscous":
            raise SystemExit(f"{name}: no crack of {limit[name]:.4g} up to an opening of {opening[-1]:.4g}")
        if at is None or moved is None:
            rows.append((kind, name_of(axes), str(planes), f"{griffith[name]:.4f}", "–", f"none up to {opening[-1] / griffith[name]:.3f}", "–", "–", "–"))
            continue
        done, (held, crack, energy) = work(run), joined(run, "energy.potential", "crack.length", "crack.energy")
        residual = abs(done[moved - 1] - (held[moved - 1] - held[0])) / done[moved - 1]
        release = np.interp(opening[at], *whole.released(kind, axes, planes))
        flat = crack[-1] * THICK * energies[kind]
        figures = (opening[moved] / griffith[name], opening[at] / griffith[name], release / energies[kind], 1e3 * residual, energy[-1] / flat)
        rows.append((kind, name_of(axes), str(planes), f"{griffith[name]:.4f}", *(f"{value:.3f}" for value in figures)))
        if kind == "viscous":
            check(f"strip of {planes} planes, {name_of(axes)}: opening at which the crack runs, over Griffith's", opening[at], griffith[name], 0.15)
            check(f"strip of {planes} planes: work of the grip beside the energy held", 1 + residual, 1, 0.03)
    study.table("griffith-strips", ("law", "crack along, plane", "planes", "opening by Griffith", "first move, over it", "run, over it", "G over 2γ", "work less energy held, ‰", "crack energy over a flat plane's"), rows)
    return whole, griffith


def moving(study, griffith):
    """At rest to 0.9 of Griffith's opening, then in slow motion, without damping and with it: where the work of the grip goes."""
    planes, speed = 20, 0.0005
    expected = griffith[f"strip-viscous-{name_of(FORWARD)}-{planes}"]
    scenes, dampings = {}, (0.0, 0.5)
    for damping in dampings:
        scene, length, _ = strip("viscous", FORWARD, planes, 3)
        scene["run"] = {"dt": DT}
        on = {"name": "on", "duration": 0.3 * expected / speed, "constraint": [{"name": "pulled", "velocity": [0, speed, 0]}], "probe_every": 20, "until": {"probe": "crack.length", "above": length / 6}}
        scene["stage"] = [{"name": "load", "steps": steps(0.9 * expected), "static": {"load_steps": 20}}, on]
        if damping:
            scene["damping"] = {"ratio": damping}
        scenes[f"moving-{damping:g}"] = scene
    rows, runs = [], study.run(scenes, "--engine", "reference")
    for damping, run in zip(dampings, runs.values()):
        opening, at = started(run, length / 6)
        if at is None:
            raise SystemExit(f"strip in motion, damping {damping:g}: no crack of {length / 6:.4g} up to an opening of {opening[-1]:.4g}")
        moved = started(run, 1.0)[1]
        done = work(run)[-1]
        held, kinetic, crack = joined(run, "energy.potential", "energy.kinetic", "crack.energy")
        parts = [held[-1] - held[0] - crack[-1], kinetic[-1], crack[-1]]
        parts.append(done - sum(parts))
        rows.append((f"{damping:g}", *(f"{opening[k] / expected:.3f}" for k in (moved, at)), f"{done:.3f}", *(f"{100 * part / done:.2f}" for part in parts)))
        check(f"strip in motion, damping {damping:g}: opening at which the crack runs, over Griffith's", opening[at], expected, 0.15)
        if not damping:
            check("strip in motion: elastic, kinetic and crack energy over the work of the grip", done - parts[-1], done, 0.005)
    study.table("griffith-motion", ("damping ratio", "first move, over Griffith's opening", "run, over it", "work of the grip", "elastic, %", "kinetic, %", "crack, %", "rest: damping and error, %"), rows)
    return runs


def stroh(constants):
    """1/2 (L^-1)_22 of G = K_I^2 times that, for a crack along x in the plane y = 0 (T. C. T. Ting, Anisotropic Elasticity (1996), 5.3, 11.2)."""
    place = {(0, 0): 0, (1, 1): 1, (2, 2): 2, (1, 2): 3, (0, 2): 4, (0, 1): 5}
    c = lambda i, j, k, l: constants[place[min(i, j), max(i, j)]][place[min(k, l), max(k, l)]]
    matrix = lambda j, l: np.array([[c(i, j, k, l) for k in range(3)] for i in range(3)])
    q, r, t = matrix(0, 0), matrix(0, 1), matrix(1, 1)
    inverse = np.linalg.inv(t)
    values, vectors = np.linalg.eig(np.block([[-inverse @ r.T, inverse], [r @ inverse @ r.T - q, -r @ inverse]]))
    up = vectors[:, values.imag > 0]
    a, b = up[:3], up[3:]
    b = b / np.sqrt(2 * np.sum(a * b, axis=0))
    return 0.5 * np.linalg.inv((-2j * b @ b.T).real)[1, 1]


def plates(study, energies, constants):
    """Plates with a crack in the middle: the stress at which it runs beside that of K_I = s sqrt(pi a sec(pi a/W))."""
    compliance = stroh(constants["viscous", name_of(FORWARD)])
    scenes, expected, halves = {}, {}, (6, 10, 16)
    for half in halves:
        width, planes = round(6 * half / ALONG) * ALONG, 2 * round(3 * half / SPACING)
        scene = body("viscous", FORWARD, planes, width, "y")
        cut(scene, -half, half)
        stress = math.sqrt(energies["viscous"] / (compliance * math.pi * half / math.cos(math.pi * half / width)))
        opening = 1.1 * stress * planes * SPACING / constants["viscous", name_of(FORWARD)][1][1]
        scenes[f"plate-{half}"], expected[half] = until_it_runs(scene, opening, half / 2), (stress, width)
    rows, runs = [], study.run(scenes)
    for half, run in zip(halves, runs.values()):
        at = started(run, half / 2)[1]
        if at is None:
            raise SystemExit(f"plate with a half crack of {half}: no crack of {half / 2:.4g}")
        stress, width = expected[half]
        found = float(np.max(-joined(run, "grip.force")[0][: at + 1])) / (width * THICK)
        rows.append((str(half), f"{stress:.5f}", f"{found:.5f}", f"{found / stress:.3f}"))
    study.table("griffith-plates", ("half crack, pitches", "stress by K", "stress when it runs", "over it"), rows)
    check("plate: stress at which the longest crack runs, over Griffith's", found, stress, 0.15)


def picture(study, whole, runs, energy, expected):
    with study.figure("griffith_start", 2, (9, 3.4)) as (left, right):
        opening, release = whole.released("viscous", FORWARD, 20)
        left.plot(opening, release, "k")
        left.axhline(energy, color="r", lw=0.8, label="2γ")
        left.legend()
        right.axvline(expected, color="r", lw=0.8, label="by Griffith")
        left.set(xlabel="opening, pitches", ylabel="energy held per area", title="uncracked strip, 20 planes")
        for name, run in runs.items():
            opening, force, crack, energy = joined(run, "opening.along", "grip.force", "crack.length", "crack.energy")
            right.plot(opening, crack, label=f"damping {name.split('-')[1]}")
        right.set(xlabel="opening, pitches", ylabel="crack length, pitches", title="in motion", xlim=(0.9 * expected, None))
        right.legend()


def run():
    study = Study("griffith", __doc__)
    kinds = ("viscous",) if study.small else LAWS
    found = study.elastic({f"law-{kind}-{name_of(axes)}": body(kind, axes, 8, 4 * ALONG, "xyz") | {"run": {"steps": 1}} for kind in kinds for axes in (FORWARD, BACKWARD)})
    get = lambda kind, axes: found[f"law-{kind}-{name_of(axes)}"]
    energies = {kind: next(c["energy"] for c in get(kind, FORWARD)["cleavage"] if c["plane"] == "{111}") for kind in kinds}
    constants = {(kind, name_of(axes)): get(kind, axes)["constants"] for kind in kinds for axes in (FORWARD, BACKWARD)}
    check("energy of {111} of the law viscous, over stiffness", energies["viscous"], 2 * math.sqrt(3) * 0.0042, 0.01)
    planes = [(c["plane"], c["energy"] / energies[kind]) for kind in kinds[:1] for c in get(kind, FORWARD)["cleavage"]]
    study.table("griffith-planes", ("plane", "energy of cleavage over that of {111}"), [(name, f"{value:.4f}") for name, value in planes])
    whole, griffith = strips(study, energies, constants)
    runs = moving(study, griffith)
    if not study.small:
        plates(study, energies, constants)
    picture(study, whole, runs, energies["viscous"], griffith[f"strip-viscous-{name_of(FORWARD)}-20"])
    study.end()


if __name__ == "__main__":
    main(run)
