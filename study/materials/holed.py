# SPDX-License-Identifier: MIT
"""Holed plate: a notched plate with a hole, pulled by two pins; the crack turns into the hole, and starts anew behind it.

The plate of 65 x 120 mm after Ambati et al. (2015), with the inputs that PhAST and COMSOL use: cement mortar, plane stress, pins that are glued to
their holes and turn freely, or are welded. The published loads belong to a thickness of 1 mm: a crack of 10 mm needs some 0.5 kN by the handbook. The
published displacement is that of one pin from the other. One (111) layer of particles at rest, isotropic, with a Poisson's ratio of 1/3 where the mortar
has 0.22; the law `viscous` with the fracture energy. Loads are for a thickness of 1 mm."""
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from study import Study, check, main

E, GC, POISSON = 6e9, 2280.0, 1 / 3
WIDE, HIGH, NOTCH, LEVEL = 65.0, 120.0, 10.0, 65.0  # mm
HOLE, RADIUS = (36.5, 51.0), 10.0
PINS, PIN, FIRM = ((20.0, 100.0), (20.0, 20.0)), 5.0, 8.0
FIRST, SECOND = (0.63, 0.33), (0.15, 1.7)  # kN, mm of the pins' distance
ROWS = {0: [[1, -1, 0], [1, 1, -2]], 14: [[4, -3, -1], [2, 5, -7]], 19: [[3, -2, -1], [1, 4, -5]], 30: [[1, 1, -2], [-1, 1, 0]]}
STIFF = 4.0  # of a pin, over the mortar: the published ones are rigid
TAIL = 2.3  # where a bond ends, over the strain of its peak
# Distance that the pins gained, mm, at the end of each stage, and its load steps.
STAGES = ((0.24, 8), (0.52, 28), (2.2, 42))
SHORT = ((0.24, 6), (0.42, 18))


def peak(pitch, tail):
    """Strain of a bond's peak, and its stiffness in N/m.

    Stiffness k = E pitch/sqrt 2 makes the modulus of a layer. A bond that rises by a cubic to its peak at the strain h, and falls by a cosine to zero at
    tail times h, has the energy (5/12 + (tail - 1)/3) h^2 k pitch^2. A cut along the rows goes through two bonds per pitch, and sqrt(2/3) pitch of thickness."""
    k = E * pitch / np.sqrt(2)
    return float(np.sqrt(GC * np.sqrt(2 / 3) / (2 * (5 / 12 + (tail - 1) / 3) * k))), k


def law(pitch, tail):
    h, k = peak(pitch, tail)
    s = np.concatenate([np.linspace(0.1, 1, 10), 1 + (tail - 1) * np.linspace(0.05, 1, 20)])
    force = np.where(s <= 1, -h * (s - s**3 / 3), -h / 3 * (1 + np.cos(np.pi * (s - 1) / (tail - 1))))
    end = max(1.2, 1 + 1.1 * h * tail)
    r = np.concatenate([[0.59, 0.8, 1 - h, 1 - h / 2, 1], 1 + h * s, [end, end + 0.05]])
    f = np.concatenate([[0.4, 0.2, h, h / 2, 0], force, [0, 0]])
    text = lambda values, unit: "[" + ", ".join(f"{v:.12g}" for v in values) + "] " + unit
    return {"kind": "spline", "core": f"{0.6 * pitch!r} m", "r": text(r * pitch, "m"), "force": text(f * k * pitch, "N")}, {"kind": "elastic", "stiffness": f"{k!r} N/m"}


def on_line(pitch, rows, at):
    """The site on the upright diameter of a pin that is nearest to its middle. One site is the middle of the lower pin."""
    axes = [np.array(axis) / np.linalg.norm(axis) for axis in ROWS[rows]]
    one, two = (pitch * np.array([np.dot(d, axis) for axis in axes]) / np.sqrt(2) for d in ([1, -1, 0], [1, 0, -1]))
    n = int(3 * HIGH / pitch)
    i, j = (k.reshape(-1, 1) for k in np.meshgrid(np.arange(-n, n), np.arange(-n, n)))
    sites = np.array(PINS[1]) + i * one + j * two
    sites = sites[np.abs(sites[:, 0] - at[0]) < 0.2 * pitch]
    return sites[np.abs(sites[:, 1] - at[1]).argmin()].tolist()


def plate(pitch, rows, turning=True, tail=TAIL, stages=STAGES, notch=NOTCH, breaks=True):
    bond, firm = law(pitch * 1e-3, tail)
    if not breaks:
        bond = firm
    box = lambda x0, y0, x1, y1: {"shape": "box", "min": f"[{x0!r}, {y0!r}, {-0.5 * pitch!r}] mm", "max": f"[{x1!r}, {y1!r}, {0.5 * pitch!r}] mm"}
    disc = lambda at, radius: {"shape": "cylinder", "radius": f"{radius!r} mm", "length": f"{2 * pitch!r} mm", "centre": f"[{at[0]!r}, {at[1]!r}, 0] mm"}
    speed = {1: "[0, 0.5, 0] mm/s", -1: "[0, -0.5, 0] mm/s"}
    constraints, probes = [{"name": "plane", "kind": "held", "axes": "z", "region": box(-1.0, -1.0, WIDE + 1, HIGH + 1)}], []
    for name, at, side in (("upper", PINS[0], 1), ("lower", PINS[1], -1)):
        # A pin that turns: what lies on its upright diameter goes up or down, one particle in its middle does not go aside. All else follows.
        line = {"shape": "intersection", "of": [disc(at, PIN), box(at[0] - 0.2 * pitch, 0.0, at[0] + 0.2 * pitch, HIGH)]}
        middle = on_line(pitch, rows, at)
        middle = box(middle[0] - 0.3 * pitch, middle[1] - 0.3 * pitch, middle[0] + 0.3 * pitch, middle[1] + 0.3 * pitch)
        if turning:
            constraints.append({"name": f"{name} line", "kind": "moved", "axes": "yz", "velocity": speed[side], "region": line})
        constraints.append({"name": name, "kind": "moved", "axes": "xyz", "velocity": speed[side], "region": middle if turning else disc(at, PIN)})
        probes.append({"name": name, "kind": "force", "axis": "y", "region": disc(at, PIN)})
        probes.append({"name": f"{name} pin", "kind": "displacement", "axis": "y", "region": line})
    before, parts = 0.0, []
    for k, (travel, steps) in enumerate(stages):
        parts.append({"name": f"s{k}", "duration": f"{(travel - before)!r} s", "static": {"load_steps": steps, "tolerance": 3e-3, "evaluations": 1000000}, "frame_every": 0})
        before = travel
    return {
        "title": f"Plate with a notch and a hole, pitch {pitch:g} mm, rows at {rows} degrees",
        "density": "2400 kg/m^3",
        "packing": {"pitch": f"{pitch!r} mm", "axes": ROWS[rows], "offset": f"[{PINS[1][0]!r}, {PINS[1][1]!r}, 0] mm"},
        "geometry": {"shape": "difference", "from": box(0.0, 0.0, WIDE, HIGH), "minus": [disc(HOLE, RADIUS)]},
        "law": bond,
        "material": [
            {"name": "mortar"},
            {"name": "firm", "region": {"shape": "union", "of": [disc(at, FIRM) for at in PINS]}},
            {"name": "pin", "region": {"shape": "union", "of": [disc(at, PIN) for at in PINS]}},
            {"name": "above", "region": box(-1.0, LEVEL, notch, LEVEL + 2 * pitch)},
            {"name": "below", "region": box(-1.0, LEVEL - 2 * pitch, notch, LEVEL - 1e-6)},
        ],
        "bond": [{"between": pair, "law": firm} for pair in (["firm", "firm"], ["firm", "pin"])]
        + [{"between": ["pin", "pin"], "law": firm, "strength": STIFF}, {"between": ["above", "below"], "contact": True}],
        "constraint": constraints,
        "probe": probes,
        "run": {"dt_safety": 0.5, "duration": "1 s"},
        "stage": parts,
    }  # fmt: skip


class Plate:
    """What a case shows: loads for 1 mm of thickness in kN, distances of the pins and places in mm."""

    def __init__(self, case, pitch, tail=TAIL):
        self.pitch, self.case, self.tail = pitch, case, tail
        joined = lambda name: np.concatenate([stage.curve(name)[1][k > 0 :] for k, stage in enumerate(case.stages)])
        self.load = -1e-3 * joined("upper.force") / (np.sqrt(2 / 3) * pitch)
        self.apart = 1e3 * (joined("upper pin.along") - joined("lower pin.along"))
        self.start = next(case.stages[0].frames())[2][:, :2] * 1e3
        self.pairs = cKDTree(self.start).query_pairs(1.2 * pitch, output_type="ndarray")
        middle = 0.5 * (self.start[self.pairs[:, 0]] + self.start[self.pairs[:, 1]])
        notch = (np.abs(middle[:, 1] - LEVEL) < pitch) & (middle[:, 0] < NOTCH)
        self.pairs, self.middle = self.pairs[~notch], middle[~notch]
        self.particles = case.stages[0].value("particles")
        self.evaluations = sum(stage.value("force_evaluations") for stage in case.stages)

    def ends(self):
        """Positions in mm at the end of each stage."""
        for stage in self.case.stages:
            *_, (_, _, x) = stage.frames()
            yield x[:, :2] * 1e3

    def broken(self, x):
        """Middles of the bonds that are longer than the law reaches."""
        limit = self.pitch * (1 + self.tail * peak(self.pitch * 1e-3, self.tail)[0])
        return self.middle[np.linalg.norm(x[self.pairs[:, 0]] - x[self.pairs[:, 1]], axis=1) > limit]

    def path(self, x):
        """Of the crack from the notch: where it ends, and its bonds."""
        middle = self.broken(x)
        tip = np.array([NOTCH, LEVEL])
        if not len(middle) or np.linalg.norm(middle - tip, axis=1).min() > 5 * self.pitch:
            return tip, middle[:0]
        near = cKDTree(middle).query_pairs(2.5 * self.pitch, output_type="ndarray")
        joined = coo_array((np.ones(len(near)), near.T), shape=(len(middle),) * 2)
        _, cluster = connected_components(joined, directed=False)
        own = middle[cluster == cluster[np.linalg.norm(middle - tip, axis=1).argmin()]]
        return own[np.argmax(own[:, 0])], own

    def first(self):
        """Load and distance of the pins at the first peak: where the load falls by a tenth at once."""
        at = int(np.argmax(self.load[1:] < 0.9 * self.load[:-1]))
        return self.load[at], self.apart[at]

    def late(self):
        """The largest load beyond 0.8 mm, when no bond of the first crack is left, and where; None where the run ends before."""
        far = np.flatnonzero(self.apart > 0.8)
        if not len(far):
            return None
        at = far[self.load[far].argmax()]
        return self.load[at], self.apart[at]

    def into_hole(self):
        """Of the first crack: how far it ends from the hole, how far it rises above the notch on its way, and where it meets the hole, mm."""
        *_, end = list(self.ends())[:2]
        tip, own = self.path(end)
        if not len(own):
            return np.inf, 0.0, tip
        away = np.linalg.norm(own - HOLE, axis=1)
        return max(0.0, away.min() - RADIUS), max(0.0, own[:, 1].max() - LEVEL), own[away.argmin()]

    def strain(self, x):
        """Largest principal strain of each particle, from how its neighbours moved (least squares)."""
        d0 = self.start[self.pairs[:, 1]] - self.start[self.pairs[:, 0]]
        d = x[self.pairs[:, 1]] - x[self.pairs[:, 0]]
        whole = np.linalg.norm(d, axis=1) < 1.1 * self.pitch
        a, b = np.zeros((len(x), 2, 2)), np.zeros((len(x), 2, 2))
        for side in (0, 1):
            np.add.at(a, self.pairs[whole, side], d0[whole, :, None] * d0[whole, None, :])
            np.add.at(b, self.pairs[whole, side], d[whole, :, None] * d0[whole, None, :])
        good = np.linalg.det(a) > 0.1 * self.pitch**4
        f = np.tile(np.eye(2), (len(x), 1, 1))
        f[good] = b[good] @ np.linalg.inv(a[good])
        return np.linalg.eigvalsh(0.5 * (np.swapaxes(f, 1, 2) @ f - np.eye(2)))[:, 1]


def griffith(study):
    """kN and mm at which the notch as a straight crack releases GC, for pins that turn and welded ones.

    Two notches that differ by 2 d, of a plate that does not break, with the pins a distance apart: G = -dU/da. Loads grow with its root. Rows along the
    notch make the difference exactly 2 d of the lattice's bonds."""
    pitch, apart, d = (1.6, 0.05, 1.6) if study.small else (1.0, 0.05, 1.0)
    points = [(turning, side) for turning in (True, False) for side in (-1, 1)]
    scenes = {f"notch of {NOTCH + side * d:g} mm, {'turning' if turning else 'welded'}": plate(pitch, 0, turning, TAIL, ((apart, 1),), NOTCH + side * d, False) for turning, side in points}
    found = {}
    for point, case in zip(points, study.run(scenes).values()):
        held = case.stages[0].curve("energy.potential")[1]
        one = Plate(case, pitch)
        found[point] = held[-1] - held[0], one.load[-1], one.apart[-1]
    loads = {}
    for turning in (True, False):
        (short, before, reach), (long, behind, _) = found[turning, -1], found[turning, 1]
        released = (short - long) / (2 * d * 1e-3 * np.sqrt(2 / 3) * pitch * 1e-3)
        loads[turning] = np.sqrt(GC / released) * 0.5 * (before + behind), np.sqrt(GC / released) * reach
    study.table("holed-griffith", ("pins", "load, kN", "distance of the pins, mm", "kN per mm"), [("turn" if t else "welded", f"{p:.3f}", f"{u:.3f}", f"{p / u:.3f}") for t, (p, u) in loads.items()])
    return loads


def run():
    study = Study("holed", __doc__)
    loads = griffith(study)
    if study.small:
        points = [(1.6, 0, True, TAIL, SHORT), (1.6, 30, True, TAIL, SHORT)]
    else:
        points = [(1.0, rows, True, TAIL, STAGES if rows in (0, 30) else SHORT) for rows in ROWS]
        points += [(1.0, 0, False, TAIL, SHORT), (1.0, 30, False, TAIL, SHORT), (1.0, 0, True, 13.7, SHORT), (1.6, 0, True, TAIL, SHORT), (0.7, 0, True, TAIL, SHORT)]
    name = lambda point: f"{point[0]:g} mm, rows at {point[1]}, {'turning' if point[2] else 'welded'}, tail {point[3]:g}"
    cases = study.run({name(point): plate(*point) for point in points})
    found = {point[:4]: Plate(case, point[0], point[3]) for point, case in zip(points, cases.values())}
    rows = []
    for point, one in found.items():
        pitch, turn, turning, tail = point
        load, apart = one.first()
        late = one.late()
        gap, rise, meets = one.into_hole()
        rows.append((f"{pitch:g}", f"{turn}", "turn" if turning else "welded", f"{tail:g}", f"{one.particles:,}", f"{load:.3f}", f"{apart:.3f}", f"{load / loads[turning][0]:.3f}", f"{gap:.1f}", f"{meets[0]:.0f}, {meets[1]:.0f}", f"{rise:.0f}", *((f"{late[0]:.3f}", f"{late[1]:.2f}") if late else ("–", "–")), f"{one.evaluations / 1000:.0f}"))
        if turning and tail == TAIL:
            check(f"{name((*point, 0))}: first peak, kN, over the published one", load, FIRST[0], 0.1)
            check(f"{name((*point, 0))}: distance of the pins there, mm, over the published one", apart, FIRST[1], 0.15)
            check(f"{name((*point, 0))}: first peak, kN, over Griffith's", load, loads[turning][0], 0.2)
            if gap > 1.5 * pitch:
                raise SystemExit(f"{name((*point, 0))}: the crack ends {gap:.1f} mm from the hole")
    study.table("holed", ("pitch, mm", "rows at, degrees", "pins", "tail", "particles", "first peak, kN", "at, mm", "over Griffith's", "crack ends from the hole, mm", "at x, y", "rises on its way, mm", "largest load beyond 0.8 mm, kN", "at, mm", "1000 force evaluations"), rows)
    pictures(study, found)
    study.end()


def pictures(study, found):
    with study.figure("holed_load", 2, (9, 3.6)) as (left, right):
        for (pitch, turn, turning, tail), one in found.items():
            left.plot(one.apart, one.load, lw=0.9, label=f"{pitch:g} mm, {turn}°" + ("" if turning else ", welded") + (f", tail {tail:g}" if tail != TAIL else ""))
            if one.apart[-1] > 1:
                right.plot(one.apart, one.load, lw=0.9, label=f"{pitch:g} mm, {turn}°")
        for place in (left, right):
            place.errorbar(*FIRST[::-1], xerr=0.15 * FIRST[1], yerr=0.1 * FIRST[0], fmt="ks", ms=3, mfc="none", capsize=2)
            place.set(xlabel="distance that the pins gained, mm", ylabel="load for 1 mm of thickness, kN")
        right.errorbar(*SECOND[::-1], xerr=0.2 * SECOND[1], yerr=0.2 * SECOND[0], fmt="ks", ms=3, mfc="none", capsize=2, label="published")
        left.set(xlim=(0, 0.55))
        left.legend(fontsize=6)
        right.legend(fontsize=7)
    shown = [(key, one) for key, one in found.items() if key[2] and key[3] == TAIL and (study.small or key[0] == 1.0)]
    with study.figure("holed_path", len(shown) + 1, (2.1 * len(shown) + 2.6, 4.2), "png") as axes:
        for place, (key, one) in zip(axes[1:], shown):
            *_, end = one.ends()
            place.plot(*one.start.T, ",", color="0.75")
            place.plot(*one.broken(end).T, ".r", ms=2)
            place.plot([0, NOTCH], [LEVEL, LEVEL], "k", lw=1)
            place.set(title=f"{key[0]:g} mm, rows at {key[1]}°", xlim=(0, WIDE), ylim=(20, 100), aspect="equal", xlabel="mm")
            place.title.set_fontsize(8)
        x = next(shown[0][1].ends())
        points = axes[0].scatter(*x.T, c=1e3 * shown[0][1].strain(x), s=0.5 * shown[0][1].pitch ** 2, cmap="viridis", vmin=0, vmax=8, rasterized=True)
        axes[0].figure.colorbar(points, ax=axes[0], shrink=0.7, label="largest principal strain, ‰")
        axes[0].set(title="before it cracks", aspect="equal", xlabel="mm")
        axes[0].title.set_fontsize(8)


if __name__ == "__main__":
    main(run)
