# SPDX-License-Identifier: MIT
"""Pitch: the stiffness of a lug from CAD, on packings from coarse to fine.

A lug with a pin's hole, as an STL file of triangles, is held at its tail and pulled at the far half of its hole. Results must not hinge on the
pitch once it is small against the features (Strand, Tourlomousis, Gershenfeld, section 2.2), here against the wall beside the hole. Finer
packings have less surface: the stiffness is fitted by its limit and a term that is proportional to the pitch."""
import math

import numpy as np

from study import Study, check, main

HOLE, OUTER, TAIL, THICK = 3.0, 6.0, 14.0, 4.0  # mm: radii of hole and head, from the hole to the tail's end, thickness
WALL = OUTER - HOLE
SIDES = 180


def outline(angle):
    """Distance of the outer edge from the hole's axis: a half circle, and a tail of the same width to -x."""
    c, s = math.cos(angle), math.sin(angle)
    if c >= 0:
        return OUTER
    return min(TAIL / -c, OUTER / abs(s) if s else math.inf)


def stl(path):
    """The lug's surface, its triangles with their outer side by the right hand, in mm."""
    corner = math.pi - math.atan2(OUTER, TAIL)
    angles = sorted({2 * math.pi * k / SIDES for k in range(SIDES)} | {corner, 2 * math.pi - corner})
    point = lambda radius, angle, z: (radius * math.cos(angle), radius * math.sin(angle), z)
    lines = ["solid lug"]

    def quad(a, b, c, d):
        for triangle in ((a, b, c), (a, c, d)):
            lines.append("facet normal 0 0 0\nouter loop")
            lines.extend(f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in triangle)
            lines.append("endloop\nendfacet")

    low, high = -THICK / 2, THICK / 2
    for a, b in zip(angles, angles[1:] + angles[:1]):
        inner = [(point(HOLE, t, low), point(HOLE, t, high)) for t in (a, b)]
        outer = [(point(outline(t), t, low), point(outline(t), t, high)) for t in (a, b)]
        quad(outer[0][0], outer[1][0], outer[1][1], outer[0][1])
        quad(inner[1][0], inner[0][0], inner[0][1], inner[1][1])
        quad(inner[0][1], outer[0][1], outer[1][1], inner[1][1])
        quad(outer[0][0], inner[0][0], inner[1][0], outer[1][0])
    path.write_text("\n".join([*lines, "endsolid lug", ""]))


def pulled(pitch):
    box = lambda low, high: {"shape": "box", "min": f"[{low!r}, -20, -20] mm", "max": f"[{high!r}, 20, 20] mm"}
    return {
        "title": f"Lug, pitch {pitch:g} mm",
        "density": "1.2 g/cm^3",
        "packing": {"pitch": f"{pitch!r} mm", "axes": [[1, 1, 0], [-1, 1, 0]], "offset": f"[{pitch / 3!r}, {pitch / 3!r}, {pitch / 3!r}] mm"},
        "geometry": {"shape": "mesh", "file": "../lug.stl", "unit": "mm"},
        "law": {"kind": "elastic", "youngs_modulus": "1 GPa", "direction": "x"},
        "regions": {
            "tail": box(-20.0, -TAIL + 3.0),
            # What the pin touches: the wall to a third of its width, on the far side.
            "pin": {"shape": "intersection", "of": [{"shape": "cylinder", "radius": f"{HOLE + WALL / 3!r} mm", "length": "20 mm"}, box(0.0, 20.0)]},
        },
        "constraint": [
            {"name": "tail", "kind": "held", "region": "tail"},
            {"name": "pin", "kind": "moved", "region": "pin", "velocity": "[1, 0, 0] m/s"},
        ],
        "probe": [
            {"name": "load", "kind": "force", "region": "tail", "axis": "x"},
            {"name": "pin", "kind": "displacement", "region": "pin", "axis": "x"},
        ],
        "run": {"duration": "10 us", "static": {"load_steps": 1, "tolerance": 1e-4, "evaluations": 1000000}},
    }


def run():
    study = Study("pitch", __doc__)
    stl(study.out / "lug.stl")
    pitches = (1.0, 0.8) if study.small else (1.2, 1.0, 0.8, 0.6, 0.5, 0.4, 0.3, 0.25)
    cases = study.run({f"pitch {p:g} mm": pulled(p) for p in pitches})
    stiffness = {p: case.curve("load.force")[1][-1] / case.curve("pin.along")[1][-1] for p, case in zip(pitches, cases.values())}
    fine = [p for p in pitches if p <= WALL / 4]
    slope, limit = np.polyfit(fine or pitches, [stiffness[p] for p in fine or pitches], 1)
    study.table(
        "pitch-lug",
        ("pitch, mm", "particles", "pitches across the wall", "stiffness, kN/mm", "off the limit"),
        [
            (f"{p:g}", f'{case.value("particles"):,}', f"{WALL / p:.1f}", f"{stiffness[p] / 1e6:.4f}", f"{100 * (stiffness[p] / limit - 1):+.1f} %")
            for p, case in zip(pitches, cases.values())
        ],
    )
    if study.small:
        limit = 2.57e6  # N/m, of the whole study
    for p in pitches:
        if WALL / p >= (3 if study.small else 5):
            check(f"stiffness at a pitch of {p:g} mm", stiffness[p], limit, 0.1 if study.small else 0.05)
    print(f"limit {limit / 1e6:.4f} kN/mm, {100 * slope / limit:+.1f} % per mm of pitch")
    with study.figure("pitch_lug") as axes:
        axes.plot([p / WALL for p in pitches], [stiffness[p] / 1e6 for p in pitches], "o")
        ends = np.array([0, max(pitches)])
        axes.plot(ends / WALL, (limit + slope * ends) / 1e6, lw=0.8, color="k")
        axes.set(xlabel="pitch over the wall beside the hole", ylabel="stiffness, kN/mm", xlim=(0, None))
    study.end()


if __name__ == "__main__":
    main(run)
