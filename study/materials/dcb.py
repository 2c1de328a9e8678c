# SPDX-License-Identifier: MIT
"""Delamination: a double cantilever beam of fibre composite, opened at its pins, beside NASA's benchmark.

Load over crack length of the unidirectional laminate of Krueger (NASA/TM-2008-215123): T300/1076, GIc = 170.3 J/m^2. Planes of particles along
the fibre hold together by strong bonds, neighbouring planes by weak ones: their ratio makes E11/G13, and the stiffness of all makes E11. The
bonds of the middle plane have a law of their own, whose energy per area is GIc. The beam is a slice, periodic across its width, opened at rest at
each load step; it is shorter than the specimen, whose end beyond the crack carries no load."""
import numpy as np

from study import Study, check, main

# Krueger (2008), table of the critical path, digitised by eye to +-1 N: crack length in mm, load in N, half the opening in mm.
CRACK = np.array([30, 31, 32, 33, 34, 35, 40], float)
LOAD = np.array([60.7, 58.8, 57.3, 55.6, 54.2, 52.5, 46.7])
OPENING = np.array([0.750, 0.794, 0.842, 0.890, 0.942, 1.001, 1.274])
E11, G13, GIC = 139.4e9, 4.6e9, 170.3  # Pa, Pa, J/m^2
WIDTH, ARM = 25.0, 1.5  # mm
NOTCH, END = 26.0, 50.0  # mm, of the first crack and of the beam, from the pins: by 30 mm the crack has its whole zone of falling bonds
# The interface's law in pitches beyond rest: where it peaks, and where it ends.
PEAK, RANGE = 0.004, 0.03


def materials(strong, planes, pitch, notch):
    """Planes A, B, A, ...; U and W are those on both sides of the middle, U0 and W0 where the crack is at first."""
    gap = pitch / np.sqrt(2)
    slab = lambda k, x=None: {
        "shape": "box",
        "min": f"[{-10.0 if x is None else x[0]!r}, -100.0, {k * gap!r}] mm",
        "max": f"[{1000.0 if x is None else x[1]!r}, 100.0, {(k + 1) * gap!r}] mm",
    }
    odd = {"shape": "union", "of": [slab(k) for k in range(-planes, planes) if k % 2]}
    found = [{"name": "A", "strength": strong}, {"name": "B", "strength": strong, "region": odd}]
    if planes:
        for name, k, x in (("U", 0, None), ("W", -1, None), ("U0", 0, (-10.0, notch)), ("W0", -1, (-10.0, notch))):
            found.append({"name": name, "strength": strong, "region": slab(k, x)})
    return found


def law(stiffness):
    return {"kind": "elastic", "stiffness": f"{stiffness!r} N/m"}


def moduli(study, strong):
    """E along x and G across the planes over stiffness/pitch, of planes without end."""
    name = f"strength {strong:.6g}"
    scene = {
        "density": "1.6 g/cm^3",
        "packing": {"pitch": "1 mm", "axes": [[1, 1, 0], [-1, 1, 0]]},
        "box": {"periodic": "xyz", "cells": [2, 2, 2]},
        "law": law(1000.0),
        "material": [{"name": "A", "strength": strong}, {"name": "B", "strength": strong, "region": {"shape": "union", "of": [
            {"shape": "box", "min": f"[-100, -100, {(k + 0.5) / np.sqrt(2)!r}] mm", "max": f"[100, 100, {(k + 1.5) / np.sqrt(2)!r}] mm"} for k in (0, 2)]}}],
        "bond": [{"between": ["A", "B"], "strength": 1.0}],
        "run": {"steps": 1},
    }  # fmt: skip
    found = study.elastic({name: scene})[name]
    unit = 1000.0 / 1e-3
    along = {entry["name"]: entry["youngs"] for entry in found["directions"]}
    return along["x"] / unit, found["constants"][4][4] / unit, along["z"] / unit


def fitted(study):
    """Strength of the planes' own bonds over those between planes, by bisection; Pa per stiffness/pitch."""
    low, high = 1.0, 400.0
    for _ in range(12):
        strong = round(float(np.sqrt(low * high)), 4)
        e, g, across = moduli(study, strong)
        low, high = (strong, high) if e / g < E11 / G13 else (low, strong)
    return strong, E11 / e, e / g, across * E11 / e


def interface(stiffness, pitch):
    """A straight rise to a peak and a straight fall: the area is the energy of a bond, of which a (001) plane has four per pitch^2."""
    bond = GIC * (pitch * 1e-3) ** 2 / 4
    force = 2 * bond / (RANGE * pitch * 1e-3)  # N at the peak
    core = 0.5
    r = [core - 0.01, 0.9, 1.0 - PEAK, 1.0, *(1 + PEAK * np.array([0.5, 1.0])), *(1 + PEAK + (RANGE - PEAK) * np.linspace(0.05, 1, 20)), 1.2, np.sqrt(2)]
    def at(x):
        if x <= 1 + PEAK:
            return (1 - x) / PEAK * force if x > 0.9 else 0.1 / PEAK * force
        return -force * max(0.0, (1 + RANGE - x) / (RANGE - PEAK))
    text = lambda values, unit: "[" + ", ".join(f"{v:.12g}" for v in values) + "] " + unit
    return {"kind": "spline", "r": text(np.array(r) * pitch, "mm"), "force": text([at(x) for x in r], "N"), "core": f"{core * pitch!r} mm"}, force


def pitch_of(planes):
    """mm. Planes at a distance g have the second moment g^3 (n^3 - n)/12 per width: that of the arm, ARM^3/12."""
    return float(np.sqrt(2) * ARM / np.cbrt(planes**3 - planes))


def beam(strong, scale, planes, opened, steps, notch=NOTCH):
    """Opened to `opened` mm of half the distance of the pins. `planes` of each arm."""
    pitch = pitch_of(planes)
    cells = int(END / (2 * pitch))
    stiffness = scale * pitch * 1e-3
    bonds = [{"between": pair, "strength": 1.0} for pair in (["A", "B"], ["U", "B"], ["U0", "B"], ["W", "A"], ["W0", "A"])]
    bonds.append({"between": ["U", "W"], "law": interface(stiffness, pitch)[0]})
    bonds += [{"between": pair, "contact": True} for pair in (["U0", "W0"], ["U0", "W"], ["U", "W0"])]
    end = lambda side: {"shape": "box", "min": f"[-10, -100, {0.0 if side > 0 else -10.0!r}] mm", "max": f"[{0.25 * pitch!r}, 100, {10.0 if side > 0 else 0.0!r}] mm"}
    pin = lambda name, side: {"name": name, "kind": "moved", "axes": "z", "region": end(side), "velocity": f"[0, 0, {0.1 * side!r}] m/s"}
    return {
        "title": "Double cantilever beam",
        "density": "1.6 g/cm^3",
        "packing": {"pitch": f"{pitch!r} mm", "axes": [[1, 1, 0], [-1, 1, 0]], "offset": f"[0, 0, {pitch / np.sqrt(8)!r}] mm"},
        "box": {"periodic": "y", "cells": [cells, 3, planes], "origin": f"[0, 0, {-planes * pitch / np.sqrt(2)!r}] mm"},
        "law": law(stiffness),
        "material": materials(strong, planes, pitch, notch),
        "bond": bonds,
        "constraint": [pin("upper", 1), pin("lower", -1), {"name": "end", "kind": "held", "axes": "x", "region": {"shape": "box", "min": f"[{2 * (cells - 1) * pitch!r}, -100, -100] mm", "max": "[1000, 100, 100] mm"}}],
        "probe": [{"name": "load", "kind": "force", "region": end(1), "axis": "z"}, {"name": "pin", "kind": "displacement", "region": end(1), "axis": "z"}],
        "run": {"duration": f"{opened * 1e-3 / 0.1!r} s", "dt_safety": 0.5, "static": {"load_steps": steps, "tolerance": 1e-3, "evaluations": 10000000}, "frame_every": 1},
    }  # fmt: skip


def crack_lengths(case, pitch):
    """mm, of each load step: where the middle plane has opened so far that half of the bonds' energy is spent, from the pins."""
    frames = [x for _, _, x in case.frames()]
    first = frames[0]
    gap = pitch * 1e-3 / np.sqrt(2)
    upper, lower = (np.flatnonzero(np.abs(first[:, 2] - side * gap / 2) < 0.1 * gap) for side in (1, -1))
    # A bond across leans by 45 degrees: an opening w makes it longer by w/sqrt 2. The fall from the peak ends at RANGE.
    spent = np.sqrt(2) * (RANGE - (RANGE - PEAK) * np.sqrt(0.5 * RANGE / (RANGE - PEAK))) * pitch * 1e-3
    grid = np.arange(0, END * 1e-3, pitch * 1e-3 / 4)

    def profile(x, ids):
        """Mean height of the columns of a plane, at the grid's places."""
        places, column = np.unique(np.round(first[ids, 0] / (pitch * 1e-3 / 2)), return_inverse=True)
        return np.interp(grid, places * pitch * 1e-3 / 2, np.bincount(column, x[ids, 2]) / np.bincount(column))

    found = []
    for x in frames:
        opening = profile(x, upper) - profile(x, lower) - gap
        closed = np.flatnonzero(opening < spent)
        # From the end: the first place that is open, and where between it and the next the line crosses.
        open_at = np.flatnonzero(opening >= spent)
        if not len(open_at) or not len(closed):
            found.append(0.0 if not len(open_at) else END)
            continue
        k = open_at.max()
        share = (opening[k] - spent) / (opening[k] - opening[k + 1]) if k + 1 < len(grid) else 0.0
        found.append(1e3 * (grid[k] + share * (grid[1] - grid[0])))
    return np.array(found)


def run():
    study = Study("dcb", __doc__)
    strong, scale, ratio, across = fitted(study)
    print(f"bonds within planes {strong:.4g} times those between: E11 {E11 / 1e9:.4g} GPa, E11/G13 {ratio:.4g} ({E11 / G13:.4g}), E33 {across / 1e9:.3g} GPa (10.16)\n")
    sizes = (2,) if study.small else (2, 3, 4)
    opened, steps = (1.2, 12) if study.small else (1.4, 28)
    cases = study.run({f"{n} planes an arm": beam(strong, scale, n, opened, steps) for n in sizes})
    rows, paths = [], {}
    for n, case in zip(sizes, cases.values()):
        width = 6 * pitch_of(n)  # mm: three cells of two pitches
        load, opening = -case.curve("load.force")[1] / width * WIDTH, 1e3 * case.curve("pin.along")[1]
        crack = crack_lengths(case, pitch_of(n))
        paths[n] = crack, load, opening
        peak = load.argmax()
        if not (0 < peak < len(load) - 3 and load[-1] < 0.95 * load[peak]):
            raise SystemExit(f"{n} planes: the load does not rise and fall: {load[peak]:.1f} N at most, {load[-1]:.1f} N at last")
        grown = slice(peak, None)
        for a, reference, half in zip(CRACK, LOAD, OPENING):
            if not crack[peak] <= a <= crack[-1]:
                continue
            at, wide = np.interp(a, crack[grown], load[grown]), np.interp(a, crack[grown], opening[grown])
            rows.append((f"{n}", f'{case.value("particles"):,}', f"{a:g}", f"{at:.1f}", f"{reference:g}", f"{100 * (at / reference - 1):+.1f} %", f"{wide:.3f}", f"{half:g}", f"{100 * (wide / half - 1):+.1f} %"))
            check(f"{n} planes an arm, load at a crack of {a:g} mm", at, reference, 0.1)
        if not study.small and not (crack[peak] <= CRACK[0] and crack[-1] >= CRACK[-1]):
            raise SystemExit(f"{n} planes: cracks from {crack[peak]:.1f} to {crack[-1]:.1f} mm do not span {CRACK[0]:g} to {CRACK[-1]:g} mm")
    study.table("dcb-path", ("planes an arm", "particles", "crack, mm", "load, N", "Krueger", "difference", "half the opening, mm", "Krueger", "difference"), rows)
    with study.figure("dcb_path", 2, (9, 3.6)) as (left, right):
        for n, (crack, load, opening) in paths.items():
            left.plot(opening, load, ".-", lw=0.8, label=f"{n} planes an arm")
            right.plot(crack[load.argmax():], load[load.argmax():], ".-", lw=0.8)
        left.plot(OPENING, LOAD, "ks", ms=4, mfc="none", label="Krueger, critical path")
        right.plot(CRACK, LOAD, "ks", ms=4, mfc="none")
        left.set(xlabel="half the opening, mm", ylabel="load, N")
        right.set(xlabel="crack length, mm", ylabel="load, N")
        left.legend()
    study.end()


if __name__ == "__main__":
    main(run)
