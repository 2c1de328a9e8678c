# SPDX-License-Identifier: MIT
"""A chiral metamaterial: a cell that twists when it is pressed, of an elastic, a brittle and a viscous law.

Each side face of the cell is a ring whose four arms run as tangents to the corners. Pressed, the arms turn the rings, and the rings turn the cell
(Frenzel, Kadic, Wegener 2017; Strand, Tourlomousis, Gershenfeld, figures 2 to 4). Its top plate is moved down and is free to turn. Of the
elastic cell: degrees of twist per percent of strain, by pitch; its mirror image turns as far the other way, and one with straight arms not at all."""
import numpy as np

from study import Study, main

SIDE, WIDTH, RING = 10.0, 1.6, 2.6  # mm: of the cell, of its struts, middle of the ring
HEIGHT = SIDE + 2 * WIDTH  # with both plates


def face(hand):
    """The ring and its arms in the face x = SIDE/2; `hand`: +1, -1, or 0 for straight arms."""
    x, corner = SIDE / 2 - WIDTH / 2, SIDE / 2 - WIDTH / 2
    reach = np.sqrt(2) * corner
    turn = hand * np.arccos(RING / reach)  # of the tangent's point from the way to the corner
    cylinder = lambda radius: {"shape": "cylinder", "axis": "x", "radius": f"{radius!r} mm", "length": f"{WIDTH!r} mm", "centre": f"[{x!r}, 0, 0] mm"}
    parts = [{"shape": "difference", "from": cylinder(RING + WIDTH / 2), "minus": [cylinder(RING - WIDTH / 2)]}]
    for k in range(4):
        to = np.pi / 4 + k * np.pi / 2
        near = RING * np.array([np.cos(to + turn), np.sin(to + turn)])
        far = reach * np.array([np.cos(to), np.sin(to)])
        parts.append({"shape": "capsule", "from": f"[{x!r}, {near[0]!r}, {near[1]!r}] mm", "to": f"[{x!r}, {far[0]!r}, {far[1]!r}] mm", "radius": f"{WIDTH / 2!r} mm"})
    return {"shape": "union", "of": parts}


def cell(pitch, hand=1, law="elastic", strain=0.002, motion=False):
    """The cell between two plates, pressed by `strain` of its height: at rest, or in motion."""
    box = lambda low, high: {"shape": "box", "min": f"[{-SIDE / 2!r}, {-SIDE / 2!r}, {low!r}] mm", "max": f"[{SIDE / 2!r}, {SIDE / 2!r}, {high!r}] mm"}
    top = HEIGHT / 2
    speed = 1.0  # m/s
    corner = lambda name, sx, sy: {
        "name": name, "kind": "displacement",
        "region": {"shape": "intersection", "of": ["material", {"shape": "box", "min": f"[{sx * 4 - 0.6!r}, {sy * 4 - 0.6!r}, {top - WIDTH!r}] mm", "max": f"[{sx * 4 + 0.6!r}, {sy * 4 + 0.6!r}, {top!r}] mm"}]},
    }  # fmt: skip
    scene = {
        "title": f"Chiral cell, {law}",
        "density": "1.2 g/cm^3",
        "packing": {"pitch": f"{pitch!r} mm", "offset": f"[{pitch / 3!r}, {pitch / 3!r}, {pitch / 3!r}] mm"},
        "geometry": "material",
        "regions": {
            "face": face(hand),
            "material": {
                "shape": "union",
                "of": [*({"region": "face", "rotate": {"axis": "z", "angle": f"{90 * k} deg"}} for k in range(4)), box(SIDE / 2 - WIDTH / 2, top), box(-top, -SIDE / 2 + WIDTH / 2)],
            },
            "pressed": box(top - WIDTH, top),
            "standing": box(-top, -top + WIDTH),
        },
        "law": {"kind": law, "youngs_modulus": "1 GPa", "direction": "z"},
        "damping": {"ratio": 0.3},
        "constraint": [
            {"name": "standing", "kind": "held", "region": "standing"},
            {"name": "pressed", "kind": "moved", "axes": "z", "region": "pressed", "velocity": f"[0, 0, {-speed!r}] m/s"},
        ],
        "probe": [
            *(corner(name, *place) for name, place in (("east", (1, 0)), ("north", (0, 1)), ("west", (-1, 0)), ("south", (0, -1)))),
            {"name": "plate", "kind": "displacement", "region": "pressed", "axis": "z"},
            {"name": "load", "kind": "force", "region": "standing", "axis": "z"},
        ],
        "run": {"duration": f"{strain * SIDE * 1e-3 / speed!r} s", "dt_safety": 0.5},
    }
    if motion:
        scene["run"]["frame_every"] = 0
    else:
        scene["run"]["static"] = {"load_steps": 2, "tolerance": 1e-3, "evaluations": 1000000}
    return scene


def twist(case):
    """Degrees about z, of the mean of four points 4 mm from the axis, over percent of strain, at the end."""
    around = [case.curve(name)[1][-1] for name in ("east.y", "north.x", "west.y", "south.x")]
    angle = np.degrees((around[0] - around[1] - around[2] + around[3]) / 4 / 4e-3)
    return angle / (100 * case.curve("plate.along")[1][-1] / (SIDE * 1e-3))


def draw(study, cases):
    """The cells seen from a corner, particles by how far they have moved."""
    with study.figure("chiral_cells", len(cases), (3.4 * len(cases), 3.9), "png") as axes:
        axes = np.atleast_1d(axes)
        for place, (name, case) in zip(axes, cases.items()):
            frames = [x for _, _, x in case.frames()]
            first, last = frames[0], frames[-1]
            moved = 1e3 * np.linalg.norm(last - first, axis=1)
            a, b = np.radians(35), np.radians(20)
            right = last @ [np.cos(a), np.sin(a), 0]
            depth = last @ [-np.sin(a) * np.cos(b), np.cos(a) * np.cos(b), -np.sin(b)]
            up = last @ [-np.sin(a) * np.sin(b), np.cos(a) * np.sin(b), np.cos(b)]
            order = np.argsort(-depth)
            shown = place.scatter(1e3 * right[order], 1e3 * up[order], c=moved[order], s=2, lw=0, cmap="viridis", vmin=0)
            place.set(title=name, aspect="equal", xticks=[], yticks=[])
            place.grid(False)
            place.figure.colorbar(shown, ax=place, shrink=0.6, label="moved, mm")


def run():
    study = Study("chiral", __doc__)
    pitches = (0.6,) if study.small else (0.5, 0.4, 0.32, 0.25)
    coarse = pitches[0]
    scenes = {f"pitch {p:g} mm": cell(p) for p in pitches}
    scenes |= {"mirrored": cell(coarse, -1), "straight arms": cell(coarse, 0)}
    cases = study.run(scenes)
    twists = {name: twist(case) for name, case in cases.items()}
    stiffness = lambda case: case.curve("load.force")[1][-1] / (1e3 * case.curve("plate.along")[1][-1])
    study.table(
        "chiral-twist",
        ("cell", "particles", "twist, degrees per % of strain", "stiffness, N/mm"),
        [(name, f'{case.value("particles"):,}', f"{twists[name]:+.3f}", f"{stiffness(case):.0f}") for name, case in cases.items()],
    )
    straight, hand, mirror = twists["straight arms"], twists[f"pitch {coarse:g} mm"], twists["mirrored"]
    if not (abs(hand) > 0.2 and abs(hand + mirror) < 0.02 * abs(hand) and abs(straight) < 0.02 * abs(hand)):
        raise SystemExit(f"twists {hand:+.4f}, mirrored {mirror:+.4f}, straight {straight:+.4f}: no chiral cell")
    if not study.small:
        laws = study.run({law: cell(0.4, 1, law, 0.01, motion=True) for law in ("elastic", "brittle", "viscous")})
        draw(study, laws)
    study.end()


if __name__ == "__main__":
    main(run)
