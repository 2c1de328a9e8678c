# SPDX-License-Identifier: MIT
"""Anisotropy: fibres of one law make a block stiffer along one axis, or as stiff along two.

A block of 1 cm is pulled along X, [001] of the packing, and along Y, [110]. One law alone makes it half as stiff again along Y. Strong fibres
along Y raise that ratio, others along X take it away (Strand, Tourlomousis, Gershenfeld, section 6). The same layouts repeated without end give
the moduli by lattice sums; then all layouts of a cell are searched for those that reach a ratio with the least strong material."""
import itertools

import numpy as np

from study import Study, check, main

# Periods of the fibres in pitches: four cells of the crystal along x, [001], three along z, [-110] (and as many along y for those along x).
CELL = {"x": np.sqrt(2), "y": 2.0, "z": 2.0}
PLANES = {"x": 2, "y": 4, "z": 4}  # planes of sites per cell
CELLS = {"x": 4, "y": 3, "z": 3}
PACKING = [[0, 0, 1], [1, 1, 0]]
CASES = {"one law": None, "fibres along y": ("y", 20.0, 0.5), "fibres along x": ("x", 3.53, 0.82)}
REDUCED = 1e-3  # m, the pitch of repeated cells: no modulus depends on it


def law(pitch):
    return {
        "density": "1 g/cm^3",
        "packing": {"pitch": f"{pitch!r} m", "axes": PACKING},
        "law": {"kind": "ductile", "youngs_modulus": "1 GPa", "direction": "x"},
    }


def period(axis, pitch):
    return CELLS[axis] * CELL[axis] * pitch


def block_between(axes, lower, upper, pitch):
    """A box shape between fractions of the period along two axes, without end along the third; its faces lie between planes of sites."""
    ends = {axis: (-1.0, 1.0) for axis in "xyz"}
    for axis, a, b in zip(axes, lower, upper):
        shift = -0.5 * CELL[axis] / PLANES[axis] * pitch
        ends[axis] = (a * period(axis, pitch) + shift, b * period(axis, pitch) + shift)
    text = lambda k: "[" + ", ".join(f"{ends[axis][k]!r}" for axis in "xyz") + "] m"
    return {"shape": "box", "min": text(0), "max": text(1)}


def materials(shapes, strong, weak):
    return [
        {"name": "matrix", "strength": weak},
        {"name": "fibre", "strength": strong, "region": {"shape": "union", "of": shapes}},
    ]


def repeated(axes, shapes, strong, weak):
    """The layout without end: one period across the fibres, one cell along them."""
    counts = [CELLS[axis] if axis in axes else 1 for axis in "xyz"]
    scene = law(REDUCED) | {"box": {"periodic": "xyz", "cells": counts}, "run": {"steps": 1}}
    if shapes:
        scene["material"] = materials(shapes, strong, weak)
    return scene


def across(fibre):
    return [axis for axis in "xyz" if axis != fibre]


def fibres(case, pitch, periods):
    """The fibres of a block: half of each period across, so a quarter of the volume."""
    along = case[0]
    a, b = across(along)
    places = itertools.product(range(periods), range(periods))
    return [block_between((a, b), (m + 0.25, n + 0.25), (m + 0.75, n + 0.75), pitch) for m, n in places]


def pulled(case, axis, periods, dynamic=False):
    """The block pulled to 4 % along an axis, free to draw in; statically in doubles, or in motion in the fixed rule."""
    pitch = 0.01 / (periods * CELLS["z"] * CELL["z"])  # z spans 1 cm
    length = {a: periods * period("z" if a == "y" else a, pitch) for a in "xyz"}
    # Half a spacing of planes off the faces on both sides: the volume is that of the particles.
    lower = {a: -0.5 * CELL[a] / PLANES[a] * pitch for a in "xyz"}
    text = lambda ends: "[" + ", ".join(f"{ends[a]!r}" for a in "xyz") + "] m"
    upper = {a: lower[a] + length[a] for a in "xyz"}
    grip = CELL[axis] / PLANES[axis] * pitch  # a plane alone, free to draw in: the strain is that of the whole length
    sign = {"+": f"{axis}", "-": f"-{axis}"}
    at = lambda value: "[" + ", ".join(f"{value!r}" if a == axis else "0" for a in "xyz") + "] m"
    half = lambda value, side: {"shape": "half_space", "point": at(value), "normal": sign[side]}
    # A whole number of periods apart: the strain between marks is then the mean one, whatever it is within a period.
    apart = periods // 2 / periods
    mark = lambda share: {
        "shape": "intersection",
        "of": [half(lower[axis] + (share - 0.25 / periods) * length[axis], "-"), half(lower[axis] + (share + 0.25 / periods) * length[axis], "+"), "block"],
    }
    area = np.prod([length[a] for a in "xyz" if a != axis])
    strain, speed = 0.04, 0.2  # m/s, 1/5000 of the speed of sound
    scene = law(pitch) | {
        "title": f"Block pulled along {axis}",
        "geometry": "block",
        "damping": {"ratio": 0.5},
        "regions": {
            "block": {"shape": "box", "min": text(lower), "max": text(upper)},
            "left": half(lower[axis] + grip, "+"),
            "right": half(upper[axis] - grip, "-"),
            "lower_mark": mark(0.5 - apart / 2),
            "upper_mark": mark(0.5 + apart / 2),
        },
        "constraint": [
            {"name": "held", "kind": "held", "region": "left", "axes": axis},
            {"name": "pulled", "kind": "moved", "region": "right", "axes": axis, "velocity": at(speed).replace(" m", " m/s")},
        ],
        "probe": [
            {"name": "pull", "kind": "stress_strain", "axis": axis, "lower": "lower_mark", "upper": "upper_mark", "grip": "right", "area": f"{area!r} m^2"}
        ],
        "run": {"duration": f"{strain * (length[axis] - 2 * grip) / speed!r} s", "dt_safety": 0.5},
    }
    if not dynamic:
        scene["run"]["static"] = {"load_steps": 40, "tolerance": 1e-3}
    if case:
        scene["material"] = materials(fibres(case, pitch, periods), case[1], case[2])
    return scene


def modulus(case):
    (_, strain), (_, stress) = case.curve("pull.strain"), case.curve("pull.stress")
    window = strain <= 0.01
    return float(np.polyfit(strain[window], stress[window], 2)[1])  # where the curve begins


def layouts(count):
    """Layouts of count x count fields, one of each set that shifts and mirrors carry into one another; all and none left out."""
    seen, found = set(), []
    for bits in itertools.product((0, 1), repeat=count * count):
        field = np.array(bits, dtype=np.uint8).reshape(count, count)
        if field.all() or not field.any() or field.tobytes() in seen:
            continue
        found.append(field)
        for mirror in (field, field[::-1], field[:, ::-1], field[::-1, ::-1]):
            seen.update(np.roll(mirror, shift, (0, 1)).tobytes() for shift in np.ndindex(count, count))
    return found


def cell_of(field, along, strong):
    a, b = across(along)
    n = len(field)
    shapes = [block_between((a, b), (i / n, j / n), ((i + 1) / n, (j + 1) / n), REDUCED) for i, j in zip(*np.nonzero(field))]
    return repeated((a, b), shapes, strong, 1.0)


def ratio(elastic):
    along = {entry["name"]: entry["youngs"] for entry in elastic["directions"]}
    return along["y"] / along["x"]


def front(points):
    """Of (share, ratio, ...): the layouts that no other beats with less strong material. Above 1.5 more is better, below it less."""
    found = []
    for better in (max, min):
        best = None
        for share in sorted({point[0] for point in points}):
            point = better((p for p in points if p[0] == share), key=lambda p: p[1])
            if best is None or better(point[1], best) != best:
                best = point[1]
                found.append(point)
    return found


def moduli_of_three(study):
    ends = {}
    for name, case in CASES.items():
        axes = across(case[0]) if case else ("x", "z")
        ends[name] = repeated(axes, fibres(case, REDUCED, 1) if case else [], *(case[1:] if case else (1, 1)))
    sums = study.elastic(ends)
    periods = (2,) if study.small else (2, 3, 4)
    scenes = {f"{name}, {axis}, {n}": pulled(case, axis, n) for name, case in CASES.items() for axis in "xy" for n in periods}
    runs = study.run(scenes)
    moved = study.run({f"{name}, {axis}, moved": pulled(case, axis, periods[0], dynamic=True) for name, case in CASES.items() for axis in "xy"}) if not study.small else {}
    rows = []
    for name, found in sums.items():
        exact = {entry["name"]: entry["youngs"] for entry in found["directions"]}
        e = {(axis, n): modulus(runs[f"{name}, {axis}, {n}"]) for axis in "xy" for n in periods}
        for axis in "xy":
            # Faces change a share b/n + c/n^2 of n periods: three sizes give the block without faces.
            bulk = 8 * e[axis, 4] - 9 * e[axis, 3] + 2 * e[axis, 2] if 4 in periods else e[axis, 2]
            dynamic = f'{modulus(moved[f"{name}, {axis}, moved"]) / 1e9:.3f}' if moved else "–"
            rows.append((name, axis, f"{exact[axis] / 1e9:.3f}", *(f"{e[axis, n] / 1e9:.3f}" for n in periods), dynamic, f"{bulk / 1e9:.3f}", f"{100 * (bulk / exact[axis] - 1):+.1f} %"))
            check(f"{name}, modulus along {axis}", bulk, exact[axis], 0.15 if study.small else 0.03)
        rows.append((name, "y over x", f'{exact["y"] / exact["x"]:.3f}', *(f'{e["y", n] / e["x", n]:.3f}' for n in periods), "", "", ""))
    study.table("anisotropy-block", ("layout", "modulus along", "without end, GPa", *(f"block of {n * n} fibres, GPa" for n in periods), f"the same of {periods[0] ** 2}, in motion, GPa", "block without faces, GPa", "its difference"), rows)
    with study.figure("anisotropy_block", 3, (9, 3.2)) as axes:
        for place, name in zip(axes, CASES):
            for axis in "xy":
                run = runs[f"{name}, {axis}, {periods[-1]}"]
                strain, stress = run.curve("pull.strain")[1], run.curve("pull.stress")[1]
                end = strain.argmax() + 1  # where a plane at a grip tears the gauge goes back
                place.plot(100 * strain[:end], stress[:end] / 1e6, label=f"along {axis}")
            place.set(title=name, xlabel="strain, %", ylabel="stress, MPa")
            place.legend()
    return sums


def search(study):
    count = 2 if study.small else 3
    strengths = (4.0, 16.0) if study.small else (2.0, 4.0, 8.0, 16.0, 32.0)
    fields = layouts(count)
    points = [(field, along, strong) for field in fields for along in "xy" for strong in strengths]
    name = lambda field, along, strong: f"search-{''.join(map(str, field.ravel()))}-{along}-{strong:g}"
    found = study.elastic({name(*point): cell_of(*point) for point in points})
    known = [(float(field.mean()), ratio(found[name(field, along, strong)]), field, along, strong) for field, along, strong in points]
    best = {strong: front([p for p in known if p[4] == strong]) for strong in strengths}
    with study.figure("anisotropy_front") as axes:
        axes.scatter([p[0] for p in known], [p[1] for p in known], s=6, color="0.7", label="all layouts")
        for strong in strengths:
            for side, sign in (("above", 1), ("below", -1)):
                ends = sorted(p[:2] for p in best[strong] if sign * (p[1] - 1.5) > 0)
                line = axes.plot(*zip(*ends), "o-", ms=3, label=f"strength {strong:g}" if sign > 0 else None, color=line[0].get_color() if sign < 0 else None)
        axes.axhline(1.5, lw=0.8, color="k")
        axes.set(xlabel="share of strong material", ylabel="modulus along y over that along x", yscale="log")
        axes.legend()
    # For each target: every layout with the strength that reaches it, found by bisection in its logarithm; the least strong material wins.
    rows = []
    for target in (1.0,) if study.small else (0.75, 1.0, 2.0, 3.0, 6.0):
        reached = []
        for field in fields:
            for along in "xy":
                ratios = [ratio(found[name(field, along, strong)]) for strong in strengths]
                for k in range(len(strengths) - 1):
                    if (ratios[k] - target) * (ratios[k + 1] - target) <= 0:
                        reached.append((float(field.mean()), along, field, strengths[k : k + 2]))
                        break
        if not reached:
            rows.append((f"{target:g}", "–", "no layout", "–", "–"))
            continue
        share, along, field, (low, high) = min(reached, key=lambda r: (r[0], r[1], r[2].tobytes()))
        rising = ratio(found[name(field, along, high)]) > ratio(found[name(field, along, low)])
        for k in range(6 if study.small else 10):
            middle = float(np.sqrt(low * high))
            got = ratio(study.elastic({f"target-{target:g}-{k}": cell_of(field, along, middle)})[f"target-{target:g}-{k}"])
            low, high = (middle, high) if (got < target) == rising else (low, middle)
        picture = " / ".join("".join("#" if f else "." for f in row) for row in field)
        rows.append((f"{target:g}", f"{share:.3f}", f"along {along}: {picture}", f"{middle:.3f}", f"{got:.4f}"))
        check(f"ratio {target:g}", got, target, 0.02 if study.small else 1e-3)
    study.table("anisotropy-targets", ("target ratio", "share of strong material", "layout across the fibres", "its strength over the matrix's", "ratio reached"), rows)


def run():
    study = Study("anisotropy", __doc__)
    sums = moduli_of_three(study)
    one, along_y, along_x = (ratio(sums[name]) for name in CASES)
    check("one law: E[110] / E[001]", one, 1.5, 0.01)  # (sqrt 2) / (2 sqrt 2 / 3), bonds between nearest neighbours
    if not along_x < one < along_y:
        raise SystemExit(f"ratios {along_x:.3f}, {one:.3f}, {along_y:.3f} do not rise from fibres along x to fibres along y")
    search(study)
    study.end()


if __name__ == "__main__":
    main(run)
