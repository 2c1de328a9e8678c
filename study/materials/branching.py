# SPDX-License-Identifier: MIT
"""Branching: a crack in a plate of soda-lime glass runs, and splits in two.

A plate of 100 x 40 mm with a cut from its left edge to the centre (Bobaru and Zhang 2015; the inputs of PDMATLAB2D and CabanaPD). A traction of 2 MPa
pulls at its long edges from the start, as published. Or it is drawn apart at these edges at rest, then cut: each length of crack may take the energy G
that the strip has stored above and below. Plane stress: one (111) layer of particles, isotropic, with a Poisson's ratio of 1/3. Glass breaks at strains of 1e-4. Linear elastic fracture is the same when displacements and the
root of the fracture energy grow alike, here SCALE-fold, so that bonds break at strains of a percent and numbers need no more digits."""
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from study import Study, main

E, RHO, GC, POISSON = 72e9, 2440.0, 3.8, 1 / 3  # Pa, kg/m^3, J/m^2
SCALE = 20.0
LONG, HIGH = 100.0, 40.0  # mm
EDGE = 1.5  # mm, of the grips
TRACTION, PULLED, FIRM = 2e6, 43.0, 1.0  # Pa, us, mm from the edges where nothing breaks
# Directions of the crack from the close-packed rows, degrees, and the packing's axes along x and y; z is [111].
ROWS = {0: [[1, -1, 0], [1, 1, -2]], 14: [[4, -3, -1], [2, 5, -7]], 19: [[3, -2, -1], [1, 4, -5]], 30: [[1, 1, -2], [-1, 1, 0]]}
THICK = np.sqrt(2 / 3)  # of a layer, in pitches


def rayleigh():
    """m/s: Viktorov's fit to Rayleigh's equation, with the Poisson's ratio of plane strain that has the waves of this plane stress."""
    nu = POISSON / (1 + POISSON)
    return np.sqrt(E / (2 * (1 + POISSON)) / RHO) * (0.862 + 1.14 * nu) / (1 + nu)


def strain_for(share):
    """Of the strip, wide against its height, that stores `share` times the fracture energy per length of crack."""
    return SCALE * np.sqrt(2 * share * GC * (1 - POISSON**2) / (E * (HIGH - 2 * EDGE) * 1e-3))


def law(pitch):
    """A bond's law, the strain of its peak, and its stiffness: the cubic of the presets up to the peak, a cosine to zero at 2.3 times that strain.

    Stiffness k = E pitch/sqrt 2 makes the modulus of a layer. The energy of a bond is 0.85 h^2 k pitch^2, and a cut along the rows goes through two
    bonds per pitch: GC = 2 * 0.85 h^2 k / THICK."""
    k = E * pitch / np.sqrt(2)
    h = float(np.sqrt(GC * SCALE**2 * THICK / (1.7 * k)))
    s = np.concatenate([np.linspace(0.1, 1, 10), np.linspace(1.1, 2.3, 13)])
    force = np.where(s <= 1, -h * (s - s**3 / 3), -h / 3 * (1 + np.cos(np.pi * (s - 1) / 1.3)))
    r = np.concatenate([[0.59, 0.8, 1 - h, 1 - h / 2, 1], 1 + h * s, [1.2, 1.4]])
    f = np.concatenate([[0.4, 0.2, h, h / 2, 0], force, [0, 0]])
    text = lambda values, unit: "[" + ", ".join(f"{v:.12g}" for v in values) + "] " + unit
    return {"kind": "spline", "core": f"{0.6 * pitch!r} m", "r": text(r * pitch, "m"), "force": text(f * k * pitch, "N")}, h, k


def plate(pitch_mm, rows, share, cut, time=30.0):
    """Drawn to its strain at rest, or from there on with the cut."""
    bond, _, k = law(pitch_mm * 1e-3)
    depth, reach = HIGH / 2, 2 * pitch_mm
    box = lambda x0, y0, x1, y1, z=1.0: {"shape": "box", "min": f"[{x0!r}, {y0!r}, {-z!r}] mm", "max": f"[{x1!r}, {y1!r}, {z!r}] mm"}
    travel = strain_for(share) * (depth - EDGE)  # mm, of each grip
    speed, steps = travel / 10.0, int(np.ceil(travel / (0.15 * pitch_mm)))  # mm/us: there in 10 us
    grip = lambda name, s: {"name": name, "kind": "moved", "axes": "y", "region": name, "velocity": f"[0, {0.0 if cut else s * speed * 1e3!r}, 0] m/s"}
    strong = {"kind": "elastic", "stiffness": f"{k!r} N/m"}  # the same stiffness without an end: nothing breaks before the cut
    bonds = [{"between": ["edge", "edge"], "law": strong}, {"between": ["above", "below"], "contact": True}] if cut else []
    return {
        "title": f"Glass plate, pitch {pitch_mm:g} mm, rows at {rows} degrees",
        "density": f"{RHO!r} kg/m^3",
        "packing": {"pitch": f"{pitch_mm!r} mm", "axes": ROWS[rows], "offset": f"[0, {pitch_mm / 4!r}, 0] mm"},
        "geometry": box(0.0, -depth, LONG, depth, 0.5 * pitch_mm),
        "regions": {"top": box(-1.0, depth - EDGE, LONG + 1, depth + 1), "bottom": box(-1.0, -depth - 1, LONG + 1, -depth + EDGE)},
        "law": bond if cut else strong,
        "material": [
            {"name": "glass"},
            {"name": "edge", "region": {"shape": "union", "of": [box(-1.0, depth - 2 * EDGE, LONG + 1, depth + 1), box(-1.0, -depth - 1, LONG + 1, -depth + 2 * EDGE)]}},
            {"name": "above", "region": box(-1.0, 0.0, LONG / 2, reach)},
            {"name": "below", "region": box(-1.0, -reach, LONG / 2, -1e-6)},
        ],
        **({"bond": bonds} if bonds else {}),
        "constraint": [grip("top", 1), grip("bottom", -1)],
        "run": {"duration": f"{time!r} us", "dt_safety": 0.5, "frame_every": 0} if cut else {"duration": "10 us", "static": {"load_steps": steps, "tolerance": 1e-3, "evaluations": 1000000}},
        "reach": {"margin": "2 mm"},
    }  # fmt: skip


def pulled(pitch_mm, rows):
    """The cut plate under the traction, which grows as displacements do. It pulls at what lies within a pitch of the edges."""
    scene = plate(pitch_mm, rows, 0.0, True, PULLED)
    depth = HIGH / 2
    outer = lambda y, normal: {"shape": "half_space", "point": f"[0, {y!r}, 0] mm", "normal": normal}
    area = LONG * THICK * pitch_mm
    pull = lambda name, s: {"name": name, "kind": "pulled", "traction": f"[0, {s * SCALE * TRACTION!r}, 0] Pa", "area": f"{area!r} mm^2", "region": name}
    scene["title"] = f"Glass plate under a traction, pitch {pitch_mm:g} mm, rows at {rows} degrees"
    scene["regions"] = {"top": outer(depth - pitch_mm, "-y"), "bottom": outer(-depth + pitch_mm, "y")}
    firm = {"shape": "union", "of": [outer(depth - FIRM, "-y"), outer(-depth + FIRM, "y")]}
    scene["material"][1]["region"] = firm
    scene["constraint"] = [pull("top", 1), pull("bottom", -1)]
    return scene


class Crack:
    """Bonds that broke, by the frame in which they first were: middles in mm."""

    def __init__(self, still, case, pitch_mm):
        pitch = pitch_mm * 1e-3
        start = next(still.frames())[2][:, :2]
        pairs = cKDTree(start).query_pairs(1.2 * pitch, output_type="ndarray")
        middle = 0.5e3 * (start[pairs[:, 0]] + start[pairs[:, 1]])
        cut = (np.abs(middle[:, 1]) < pitch_mm) & (middle[:, 0] < LONG / 2)
        grips = np.abs(middle[:, 1]) > HIGH / 2 - 2 * EDGE
        pairs, middle = pairs[~cut & ~grips], middle[~cut & ~grips]
        limit = pitch * (1 + 2.3 * law(pitch)[1])
        self.times, self.when = [], np.full(len(pairs), np.inf)
        for k, (time, _, x) in enumerate(case.frames()):
            self.times.append(time)
            longer = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) > limit
            self.when[longer & np.isinf(self.when)] = k
        broken = np.isfinite(self.when)
        self.middle, self.when = middle[broken], self.when[broken].astype(int)
        self.tip = np.array([self.end(k, 2.5 * pitch_mm) for k in range(len(self.times))])

    def end(self, frame, reach):
        """mm: the rightmost bond of the crack from the cut. Others, as at the plate's free edges, are no part of it."""
        middle = self.middle[self.when <= frame]
        first = np.linalg.norm(middle - [LONG / 2, 0], axis=1)
        if not len(middle) or first.min() > 2 * reach:
            return LONG / 2
        near = cKDTree(middle).query_pairs(reach, output_type="ndarray")
        joined = coo_array((np.ones(len(near)), near.T), shape=(len(middle),) * 2)
        _, cluster = connected_components(joined, directed=False)
        return max(LONG / 2, middle[cluster == cluster[first.argmin()], 0].max())

    def start(self):
        """s: the first frame in which the crack has grown by 1 mm; nan where it never does."""
        grown = np.flatnonzero(self.tip > LONG / 2 + 1)
        return self.times[grown[0]] if len(grown) else np.nan

    def stop(self):
        """The frame from which the tip stands still for 3 us, as where it meets an edge that does not break; the last one where it never does."""
        for k in np.flatnonzero(self.tip > LONG / 2 + 5):
            later = np.searchsorted(self.times, self.times[k] + 3e-6)
            if later < len(self.times) and self.tip[later] == self.tip[k]:
                return k
        return len(self.times) - 1

    def speed(self, last=None):
        """m/s along the cut, between 55 and 90 mm or as far as it ran, up to a frame; 0 where it did not run."""
        window = (self.tip > LONG / 2 + 5) & (self.tip < LONG - 10)
        if last is not None:
            window[last + 1 :] = False
        if np.count_nonzero(window) < 3:
            return 0.0
        return 1e-3 * float(np.polyfit(np.array(self.times)[window], self.tip[window], 1)[0])

    def branch(self):
        """mm from the cut's end to where two cracks, 2 mm apart or more, run side by side for 4 mm; None where they never do."""
        side = 0
        for x in np.arange(LONG / 2, LONG, 1.0):
            y = np.sort(self.middle[(self.middle[:, 0] >= x) & (self.middle[:, 0] < x + 1), 1])
            side = side + 1 if len(y) > 1 and np.diff(y).max() > 2 else 0
            if side == 4:
                return x - 3 - LONG / 2
        return None


def under_traction(study):
    """The published load: when the crack starts, how fast it runs, whether it branches."""
    points = [(0.8, 0)] if study.small else [(0.4, rows) for rows in ROWS] + [(0.25, 0), (0.25, 30)]
    scenes = {}
    for pitch, rows in points:
        scenes[f"{pitch:g} mm, rows at {rows}, traction"] = scene = pulled(pitch, rows)
        scene["run"]["frame_every"] = int(8 / pitch)
    cases = study.run(scenes, "--engine", "reference")
    rows, cracks = [], {}
    for point, (name, case) in zip(points, cases.items()):
        crack = cracks[point] = Crack(case, case, point[0])
        start, speed, branch = crack.start(), crack.speed(crack.stop()) / rayleigh(), crack.branch()
        rows.append((f"{point[0]:g}", f"{case.value('particles'):,}", f"{point[1]}", f"{1e6 * start:.1f}", f"{speed:.2f}", f"{branch:.0f}" if branch is not None else "–", f"{1e6 * crack.times[crack.stop()]:.0f}", f"{crack.tip[-1] - LONG / 2:.0f}", f"{len(crack.when)}"))
    study.table("branching-traction", ("pitch, mm", "particles", "rows at, degrees", "start, µs", "speed / Rayleigh's", "branches after, mm", "runs until, µs", "crack at the end, mm", "bonds broken"), rows)
    with study.figure("branching_traction", 2, (9, 3.2), "png") as (left, right):
        for k, (point, crack) in enumerate(cracks.items()):
            label = f"{point[0]:g} mm, {point[1]}°"
            if point[0] == points[0][0]:
                left.plot(*crack.middle.T, ".", ms=1.5, color=f"C{k}", label=f"{point[1]}°")
            right.plot(1e6 * np.array(crack.times), crack.tip - LONG / 2, color=f"C{k}", lw=0.9, label=label)
        left.set(xlim=(45, LONG), ylim=(-HIGH / 2, HIGH / 2), aspect="equal", xlabel="mm")
        left.legend(markerscale=6, fontsize=7, loc="upper left")
        right.plot([15, 15 + 40e3 / rayleigh()], [0, 40], "k:", lw=0.8, label="Rayleigh's speed")
        right.set(xlabel="time, µs", ylabel="crack, mm", ylim=(-1, 52))
        right.legend(fontsize=7)
    for (pitch, rows), crack in cracks.items():
        what = f"{pitch:g} mm, rows at {rows}, traction"
        # The wave of the load meets the cut at 3.5 us, and has come back from the far edge at 10.5 us.
        if not 3.5e-6 < crack.start() < 15e-6:
            raise SystemExit(f"{what}: the crack starts at {1e6 * crack.start():.1f} us")
        speed = crack.speed(crack.stop()) / rayleigh()
        if not 0.35 < speed < 1.0:
            raise SystemExit(f"{what}: the crack runs at {speed:.2f} of Rayleigh's speed")
        if crack.branch() is None:
            raise SystemExit(f"{what}: the crack does not branch")


def run():
    study = Study("branching", __doc__)
    under_traction(study)
    if study.small:
        points = [(0.8, 0, share) for share in (0.8, 2.0, 8.0)]
    else:
        points = [(0.4, rows, share) for rows in ROWS for share in (0.8, 1.5, 2.0, 4.0, 8.0)] + [(0.25, rows, share) for rows in (0, 30) for share in (2.0, 8.0)]
        points.append((0.15, 0, 4.0))
    name = lambda pitch, rows, share: f"{pitch:g} mm, rows at {rows}, {share:g}"
    still = study.run({name(*point): plate(*point, False) for point in points})
    cut = {}
    for point in points:
        # Some 25 frames: a step is half of sqrt(2/3) times the pitch over the speed of waves along a row, near enough.
        cut[point] = plate(*point, True) | {"start": {"from": name(*point)}}
        cut[point]["run"]["frame_every"] = int(48 / point[0])
    runs = study.run({f"{name(*point)}, cut": scene for point, scene in cut.items()}, "--engine", "reference")
    cracks = {point: Crack(still[name(*point)], run, point[0]) for point, run in zip(points, runs.values())}
    particles = {point: run.value("particles") for point, run in zip(points, runs.values())}
    rows = []
    for point in points:
        pitch, angle, share = point
        crack = cracks[point]
        speed, branch = crack.speed() / rayleigh(), crack.branch()
        rows.append((f"{pitch:g}", f"{particles[point]:,}", f"{angle}", f"{share:g}", f"{speed:.2f}" if speed else "–", f"{max(0, 1 - 1 / share):.2f}", f"{branch:.0f}" if branch is not None else "–", f"{len(crack.when)}"))
        if share < 1 and crack.tip[-1] > LONG / 2 + 1:
            raise SystemExit(f"{name(*point)}: the crack ran {crack.tip[-1] - LONG / 2:.1f} mm though the strip stores less than the fracture energy")
        # Freund's limit is that of a straight crack that spends Gc. One that branches spends more; at 8 Gc one may run along rows, shear them and pass it.
        limit = 1 - 1 / share
        if share >= 2 and not 0.4 * limit < speed < (limit + 0.1 if share < 8 else np.inf):
            raise SystemExit(f"{name(*point)}: the crack runs at {speed:.2f} of Rayleigh's speed, where {limit:.2f} is the limit")
        if share == 8 and branch is None:
            raise SystemExit(f"{name(*point)}: the crack does not branch")
        if share <= 1.5 and branch is not None:
            raise SystemExit(f"{name(*point)}: the crack branches")
    study.table("branching", ("pitch, mm", "particles", "rows at, degrees", "G / Gc", "speed / Rayleigh's", "1 − Gc/G", "branches after, mm", "bonds broken"), rows)
    shown = [p for p in points if p[2] in ((2.0, 8.0) if study.small else (2.0, 4.0, 8.0)) and (study.small or p[0] == 0.4)]
    across = len({p[2] for p in shown})
    with study.figure("branching", across, (3.6 * across, 2.2 * 1.2), "png") as axes:
        for place, share in zip(np.atleast_1d(axes), sorted({p[2] for p in shown})):
            for k, point in enumerate(p for p in shown if p[2] == share):
                place.plot(*cracks[point].middle.T, ".", ms=1, color=f"C{k}", label=f"{point[1]}°")
            place.set(title=f"G = {share:g} Gc", xlim=(45, LONG), ylim=(-HIGH / 2, HIGH / 2), aspect="equal", xlabel="mm")
            place.legend(markerscale=6, fontsize=7, loc="upper left")
    study.end()


if __name__ == "__main__":
    main(run)
