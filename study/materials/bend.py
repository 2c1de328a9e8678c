# SPDX-License-Identifier: MIT
"""Bend: a notched beam of concrete in three-point bending, beside the band of the measured curves.

Gregoire et al. (2013), half-notched beam of depth 50 mm, as pypd digitised it: load over the opening of the notch's mouth (CMOD). The law has
Young's modulus, tensile strength and fracture energy alone, none of them fitted to the curve: a bond is linear up to its peak and then softens as
Petersson's (1981) two straight lines, or as one line, or as an exponential. The beam is one (111) layer of particles, at rest at each load step.
A layer is isotropic plane stress with a Poisson's ratio of 1/3. The notch parts bonds and has no width. Supports and load point are single particles."""
import numpy as np
from scipy.spatial import cKDTree

from study import Study, check, main

E, FT, GF = 37e9, 3.9e6, 143.2  # Pa, Pa, J/m^2
LENGTH, DEPTH, WIDTH, NOTCH, MIDDLE = 175.0, 50.0, 50.0, 25.0, 87.5  # mm
SUPPORTS, GAUGE = (25.0, 150.0), (77.5, 97.5)  # mm
# CMOD in mm, lowest and highest load in N; range of the peaks and of where they are.
BAND = np.array([
    (0.002, 161.2, 193.9), (0.004, 296.7, 349.3), (0.006, 436.0, 499.2), (0.008, 577.2, 637.9), (0.010, 679.0, 746.6), (0.012, 771.9, 836.6),
    (0.015, 893.6, 959.5), (0.020, 890.9, 1104.2), (0.025, 831.5, 1095.8), (0.030, 789.2, 1018.9), (0.040, 714.1, 976.2), (0.050, 636.8, 896.7),
    (0.060, 548.7, 830.0), (0.080, 432.3, 690.5), (0.100, 379.9, 644.0), (0.120, 328.7, 597.6), (0.150, 256.4, 527.8), (0.180, 208.8, 458.0),
    (0.200, 169.6, 411.5)])  # fmt: skip
PEAKS, PEAKS_AT = (932.8, 1113.9), (0.018, 0.023)
# Travel of the load point in mm at the end of each stage, and its load steps.
STAGES = ((0.024, 30), (0.15, 42), (0.5, 14))
END = 1.25  # pitches: where the law ends


def pitch_of(turn, planes):
    """mm: so many spacings of sites along the depth, exactly where rows lie along the crack or across it."""
    return DEPTH / (planes * (np.sqrt(3) / 2 if turn == 30 else 1))


def layer(turn, pitch):
    """Axes of the packing along x and y, one site, and all sites in mm. Rows lie at `turn` degrees from the crack, which runs along y.

    Rows along the crack or across it stand so that the notch's plane is half way between columns: of the N bonds per depth that cross it, half are cut."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    across, row = np.array([1, 1, -2]) / np.sqrt(6), np.array([-1, 1, 0]) / np.sqrt(2)
    axes = [(c * across + s * row).tolist(), (c * row - s * across).tolist()]
    site = np.array([MIDDLE + pitch / 4, pitch * np.sqrt(3) / 4] if turn == 30 else [MIDDLE + pitch * np.sqrt(3) / 4, pitch / 4])
    along = np.array([s, c]) if turn != 30 else np.array([1.0, 0.0])
    other = np.array([along[1], -along[0]]) * np.sqrt(3) / 2 + along / 2
    n = int(2 * LENGTH / pitch)
    i, j = np.meshgrid(np.arange(-n, n), np.arange(-n, n))
    sites = site + pitch * (i.reshape(-1, 1) * along + j.reshape(-1, 1) * other)
    inside = (sites[:, 0] >= 0) & (sites[:, 0] <= LENGTH) & (sites[:, 1] >= 0) & (sites[:, 1] <= DEPTH)
    return axes, site, sites[inside]


def bond(turn, pitch):
    """Of a bond, from the plane that parts: its stiffness in N/m, largest force in N and energy in J. `pitch` in m.

    Thickness t = sqrt(2/3) pitch per layer. Stiffness k = E pitch/sqrt 2 gives the layer the modulus E. A straight cut goes through 2/(sqrt 3 pitch)
    |sin b| bonds per length, of those at the angle b from it; there are three such angles. An opening w stretches them by w |sin b|, and their force f
    adds f |sin b| to the pull across. Openings are a hundred times what bonds stretch before their peak F, so all are at it together: the sum of sin^2
    is 3/2, and the plane's strength sqrt 3 F/(pitch t), in all directions. Its energy is that of its bonds, whose number depends on the direction."""
    b = np.radians(turn + np.array([0.0, 60.0, 120.0]))
    thick = np.sqrt(2 / 3) * pitch
    k = E * pitch / np.sqrt(2)
    peak = FT * pitch * thick / np.sqrt(3)
    return k, peak, GF * thick / (2 / (np.sqrt(3) * pitch) * np.sum(np.abs(np.sin(b))))


def softening(shape):
    """Openings over G/F and forces over F, of unit area: G the energy, F the peak."""
    if shape == "Petersson":
        return np.concatenate([np.linspace(0, 0.8, 17), np.linspace(0.8, 3.6, 29)[1:]]), np.concatenate([np.linspace(1, 1 / 3, 17), np.linspace(1 / 3, 0, 29)[1:]])
    if shape == "straight":
        return np.linspace(0, 2, 41), np.linspace(1, 0, 41)
    w = 6 * np.linspace(0, 1, 41) ** 1.5
    f = (np.exp(-w) - np.exp(-6)) / (1 - np.exp(-6))
    return w / np.trapz(f, w), f


def law(turn, pitch_mm, shape):
    pitch = pitch_mm * 1e-3
    k, peak, energy = bond(turn, pitch)
    w, f = softening(shape)
    # A bond's length beyond the pitch is its opening and what its force stretches it elastically.
    rest = peak / k
    rise = np.array([0.25, 0.5, 0.75, 0.9, 0.97])
    falling = w[1:] * energy / peak + f[1:] * rest
    if falling[-1] > 0.9 * (END - 1) * pitch:
        raise SystemExit(f"a pitch of {pitch_mm:.3g} mm is too fine: bonds open by {falling[-1] / pitch:.2f} pitches before they part")
    beyond = np.concatenate([rise * rest, [rest], falling, [0.95 * (END - 1) * pitch, (END - 1) * pitch]])
    force = np.concatenate([rise, [1.0], f[1:], [0, 0]]) * peak
    near = np.array([0.41, 0.4, 0.2, 0.1, 0.01]) * pitch
    small = np.array([4.0, 1.0, 0.25]) * rest
    r = np.concatenate([pitch - near, pitch - small, [pitch], pitch + beyond])
    f = np.concatenate([k * near, k * small, [0.0], -force])
    text = lambda values, unit: "[" + ", ".join(f"{v:.15g}" for v in values) + "] " + unit
    return {"kind": "spline", "core": f"{0.6 * pitch!r} m", "r": text(r, "m"), "force": text(f, "N")}


class Beam:
    """A scene, and where its supports, its load point and its gauge marks are."""

    def __init__(self, turn, planes, shape="Petersson", stages=STAGES):
        self.turn, self.pitch, self.shape = turn, pitch_of(turn, planes), shape
        self.axes, self.site, self.sites = layer(turn, self.pitch)
        self.name = f"{self.pitch:.2f} mm, rows at {turn}, {shape}"
        face = lambda x, y: self.sites[np.argmin(np.abs(self.sites[:, 0] - x) + 3 * np.maximum(0, np.abs(self.sites[:, 1] - y) - 0.55 * self.pitch))].tolist()
        self.supports, self.load, self.marks = [face(x, 0.0) for x in SUPPORTS], face(MIDDLE, DEPTH), [face(x, 0.0) for x in GAUGE]
        # The moment at the notch by the places of the particles, over that by those of the supports: loads are given for the same moment.
        left, right = self.load[0] - self.supports[0][0], self.supports[1][0] - self.load[0]
        self.moment = left * right / (left + right) / ((SUPPORTS[1] - SUPPORTS[0]) / 4)
        self.scale = self.moment * WIDTH / (np.sqrt(2 / 3) * self.pitch)
        self.stages = stages

    def scene(self):
        p = self.pitch
        box = lambda x0, y0, x1, y1, z=1.0: {"shape": "box", "min": f"[{x0!r}, {y0!r}, {-z * p!r}] mm", "max": f"[{x1!r}, {y1!r}, {z * p!r}] mm"}
        point = lambda at, radius: {"shape": "sphere", "centre": f"[{at[0]!r}, {at[1]!r}, 0] mm", "radius": f"{radius!r} mm"}
        firm = {"kind": "elastic", "stiffness": f"{bond(self.turn, p * 1e-3)[0]!r} N/m"}  # the same stiffness without an end
        one = lambda at: point(at, 0.3 * p)
        before, stages = 0.0, []
        for k, (travel, steps) in enumerate(self.stages):
            stages.append({"name": f"s{k}", "duration": f"{(travel - before)!r} s", "static": {"load_steps": steps, "tolerance": 2e-3, "evaluations": 1000000}, "frame_every": 0})
            before = travel
        return {
            "title": f"Notched beam, {self.name}",
            "density": "2346 kg/m^3",
            "packing": {"pitch": f"{p!r} mm", "axes": self.axes, "offset": f"[{float(self.site[0])!r}, {float(self.site[1])!r}, 0] mm"},
            "geometry": box(0.0, 0.0, LENGTH, DEPTH, 0.5),
            "law": law(self.turn, p, self.shape),
            "material": [
                {"name": "concrete"},
                {"name": "left", "region": box(MIDDLE - 2 * p, -1.0, MIDDLE, NOTCH)},
                {"name": "right", "region": box(MIDDLE, -1.0, MIDDLE + 2 * p, NOTCH)},
                {"name": "firm", "region": {"shape": "union", "of": [point(at, 3.1 * p) for at in (*self.supports, self.load)]}},
            ],
            "bond": [{"between": ["firm", "firm"], "law": firm}, {"between": ["left", "right"], "contact": True}],
            "constraint": [
                # A layer under compression would buckle or turn out of its plane; later constraints take their particles from this one.
                {"name": "plane", "kind": "held", "axes": "z", "region": box(-1.0, -1.0, LENGTH + 1, DEPTH + 1)},
                {"name": "hinge", "kind": "held", "axes": "xyz", "region": one(self.supports[0])},
                {"name": "roller", "kind": "held", "axes": "yz", "region": one(self.supports[1])},
                {"name": "load", "kind": "moved", "axes": "yz", "velocity": "[0, -1, 0] mm/s", "region": one(self.load)},
            ],
            "probe": [
                {"name": "load", "kind": "force", "axis": "y", "region": one(self.load)},
                {"name": "travel", "kind": "displacement", "axis": "y", "region": one(self.load)},
                {"name": "left", "kind": "displacement", "axis": "x", "region": one(self.marks[0])},
                {"name": "right", "kind": "displacement", "axis": "x", "region": one(self.marks[1])},
            ],
            "run": {"dt_safety": 0.5, "duration": "1 s"},
            "stage": stages,
        }  # fmt: skip

    def curves(self, case):
        """Load in N for the measured width, CMOD and travel of the load point in mm, of all load steps."""
        joined = lambda name: np.concatenate([stage.curve(name)[1][k > 0 :] for k, stage in enumerate(case.stages)])
        return self.scale * joined("load.force"), 1e3 * (joined("right.along") - joined("left.along")), -1e3 * joined("travel.along")

    def opened(self, case):
        """Middles in mm of the bonds that have spent half of their energy or more at the end."""
        start = next(case.stages[0].frames())[2][:, :2]
        *_, (_, _, end) = case.stages[-1].frames()
        pairs = cKDTree(start).query_pairs(1.2e-3 * self.pitch, output_type="ndarray")
        middle = 0.5e3 * (start[pairs[:, 0]] + start[pairs[:, 1]])
        _, peak, energy = bond(self.turn, self.pitch * 1e-3)
        longer = np.linalg.norm(end[pairs[:, 0], :2] - end[pairs[:, 1], :2], axis=1) - self.pitch * 1e-3
        notch = (np.abs(middle[:, 0] - MIDDLE) < self.pitch) & (middle[:, 1] < NOTCH)
        return middle[~notch & (longer > 0.72 * energy / peak)]


def run():
    study = Study("bend", __doc__)
    if study.small:
        beams = [Beam(0, 20, stages=((0.024, 16), (0.15, 16), (0.5, 8)))]
    else:
        beams = [Beam(0, n) for n in (14, 20, 30, 40)] + [Beam(30, n) for n in (16, 24, 34, 46)] + [Beam(15, n) for n in (20, 30)]
        beams += [Beam(0, 30, shape) for shape in ("straight", "exponential")]
    cases = study.run({beam.name: beam.scene() for beam in beams})
    rows, curves = [], {}
    for beam, case in zip(beams, cases.values()):
        load, mouth, travel = curves[beam.name] = beam.curves(case)
        top = load.argmax()
        last = np.searchsorted(BAND[:, 0], mouth[-1], side="right")
        at = np.interp(BAND[:last, 0], mouth, load)
        within = np.count_nonzero((at >= BAND[:last, 1]) & (at <= BAND[:last, 2]))
        work = np.trapz(load, travel) * 1e-3 / beam.moment  # J
        spent = work / (GF * (DEPTH - NOTCH) * WIDTH * 1e-6)
        slope = at[0] / BAND[0, 1:].mean()
        evaluations = sum(stage.value("force_evaluations") for stage in case.stages)
        rows.append((f"{beam.turn}", f"{beam.pitch:.2f}", beam.shape, f"{case.stages[0].value('particles'):,}", f"{slope:.3f}", f"{load[top]:.0f}", f"{mouth[top]:.4f}", f"{within} of {last}", f"{spent:.3f}", f"{evaluations / 1000:.0f}"))
        check(f"{beam.name}: load at the first point of the band, over its middle", slope, 1, 0.15)
        if beam.shape == "Petersson" and beam.pitch < 3:
            check(f"{beam.name}: peak, N, beside the highest of the measured ones", load[top], PEAKS[1], 0.15)
            check(f"{beam.name}: work beside the fracture energy of the ligament", spent, 1, 0.15)
    study.table("bend", ("rows at, degrees", "pitch, mm", "softening", "particles", "first slope, over measured", "peak, N", "CMOD there, mm", "in the band", "work over Gf ligament", "1000 force evaluations"), rows)
    # Work up to the band's last point: the measured loads over the travel that the finest beam has at these openings.
    finest = min(beams, key=lambda beam: beam.pitch)
    load, mouth, travel = curves[finest.name]
    at, whole = np.concatenate([[0.0], BAND[:, 0]]), GF * (DEPTH - NOTCH) * WIDTH * 1e-6
    work = lambda loads: np.trapz(np.concatenate([[0.0], loads]), np.interp(at, mouth, travel)) * 1e-3 / whole
    shown = [("lowest measured", work(BAND[:, 1])), ("highest measured", work(BAND[:, 2])), (f"computed, {finest.pitch:.2f} mm", work(np.interp(at[1:], mouth, load)))]
    study.table("bend-work", ("load", f"work up to a CMOD of {at[-1]:g} mm, over Gf ligament"), [(name, f"{value:.3f}") for name, value in shown])
    with study.figure("bend", 3, (12, 3.8)) as axes:
        groups = (("rows along the crack", lambda b: b.turn == 0 and b.shape == "Petersson"), ("rows at 15 and 30 degrees", lambda b: b.turn > 0), ("three softenings", lambda b: b.turn == 0 and abs(b.pitch - pitch_of(0, 30)) < 1e-9))
        for place, (title, belongs) in zip(axes, groups):
            place.fill_between(BAND[:, 0], BAND[:, 1], BAND[:, 2], color="0.85", label="measured")
            for beam in filter(belongs, beams):
                load, mouth, _ = curves[beam.name]
                place.plot(mouth, load, lw=0.9, label=f"{beam.shape}" if belongs is groups[2][1] else f"{beam.pitch:.2f} mm" + (f", {beam.turn}°" if beam.turn else ""))
            place.set(title=title, xlabel="CMOD, mm", ylabel="load, N", xlim=(0, 0.21), ylim=(0, 1400))
            place.legend(fontsize=7)
    last = {beam.turn: (beam, case) for beam, case in zip(beams, cases.values()) if beam.shape == "Petersson"}
    with study.figure("bend_crack", len(last), (2.6 * len(last), 3.4), "png") as axes:
        for place, (turn, (beam, case)) in zip(np.atleast_1d(axes), last.items()):
            place.plot(*beam.sites.T, ",", color="0.7")
            place.plot([MIDDLE, MIDDLE], [0, NOTCH], "k", lw=1)
            place.plot(*beam.opened(case).T, ".r", ms=2)
            place.set(title=f"rows at {turn}°, {beam.pitch:.2f} mm", xlim=(MIDDLE - 15, MIDDLE + 15), ylim=(0, DEPTH), aspect="equal", xlabel="mm")
    study.end()


if __name__ == "__main__":
    main(run)
