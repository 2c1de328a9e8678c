# SPDX-License-Identifier: MIT
"""Hysteresis: specimens of acetal loaded and unloaded, with laws that were made for a monotonic test.

The specimen of scenes/acetal.toml, on a coarser packing, goes to growing strains and each time back to no stress (Strand, Tourlomousis,
Gershenfeld, section 5). Of each loop: the energy that is lost, and the strain that stays. What is lost has three causes. Damping takes a part
that is proportional to speed, waves from the grip's turns one that grows with its square; particles that change their neighbours take the
same at any speed, also at rest at each load step. The sweeps tell the three apart. A second specimen has the law that `cuboct fit` found for the
yield of acetal: a law with a plateau, on the coupon that it was fitted on."""
import numpy as np

import cuboct
from study import ROOT, Study, check, main

STRAINS = (0.01, 0.04, 0.08, 0.12, 0.16)  # between the grips
SPEEDS = (4.0, 2.0, 1.0)  # m/s
DAMPINGS = (0.1, 0.5)
FITTED_STRAINS = (0.02, 0.05, 0.1, 0.15)  # between the gauge marks; the law was fitted up to 0.2
FITTED_SPEEDS = (4.0, 1.0)

AREA = 11.88e-6  # m^2, of the scene's probes: of its own packing


def coarser(scene, factor):
    """The same material on a packing `factor` times as wide: lengths of the law grow with it, forces with its square."""
    for key, power in (("r", 1), ("force", 2)):
        values, unit = scene["law"][key].lstrip("[").split("]")
        scene["law"][key] = "[" + ", ".join(f"{float(v) * factor**power:.10g}" for v in values.split(",")) + "]" + unit
    for table, key in (("packing", "pitch"), ("law", "core")):
        value, unit = scene[table][key].split()
        scene[table][key] = f"{float(value) * factor:.10g} {unit}"


def specimen(factor):
    scene = cuboct.Scene.load(ROOT / "scenes/acetal.toml")
    coarser(scene, factor)
    for probe in scene["probe"]:
        probe.pop("datasheet", None)
    return scene


def fitted():
    """The coupon of scenes/studies/fit_coupon.toml with the law of its fit."""
    scene = cuboct.Scene.load(ROOT / "scenes/studies/acetal_fitted.toml")
    scene["run"].pop("static")
    return scene


def cycled(scene, strains, speed, damping, static_steps=0, probe="grip"):
    """Loads to each strain that the probe reads, and back until it reads no stress."""
    scene = scene.copy()
    scene["damping"] = {"ratio": damping}
    move = lambda v: [{"name": "pulled", "velocity": f"[{v!r}, 0, 0] m/s"}]
    length = 0.0254  # m, between the grips
    scene["stage"] = []
    for k, strain in enumerate(strains, 1):
        # Longer than the strain takes: the stage ends where the probe says. Waves from the grip's turn do not end the way back.
        longest, turn = 1.5 * strain * length / speed, 0.1 * strain * length / speed
        for name, velocity, until in (
            (f"load-{k}", speed, {"probe": f"{probe}.strain", "above": strain}),
            (f"back-{k}", -speed, {"probe": f"{probe}.stress", "below": "0 Pa", "after": f"{turn!r} s"}),
        ):
            stage = {"name": name, "constraint": move(velocity), "duration": f"{longest!r} s", "until": until, "frame_every": 0}
            if static_steps:
                stage["static"] = {"load_steps": max(20, int(static_steps * strain * 2.5)), "tolerance": 1e-3, "evaluations": 1000000}
            else:
                stage["probe_every"] = 20
            scene["stage"].append(stage)
    for key in ("frame_every", "probe_every"):
        scene["run"].pop(key, None)
    scene["reach"] = {"margin": "6 mm"}  # particles tear off at large strains
    return scene


def section(case, pitch):
    """m^2: what the particles of the narrow part fill, 8 mm of it."""
    _, _, x = next(case.stages[0].frames())
    return np.count_nonzero(np.abs(x[:, 0]) < 4e-3) * pitch**3 / np.sqrt(2) / 8e-3


def loops(case, scale, probe="grip"):
    """Of each loop: strain and stress on the way there and back."""
    found = []
    for load, back in zip(case.stages[::2], case.stages[1::2]):
        strain = np.concatenate([stage.curve(f"{probe}.strain")[1] for stage in (load, back)])
        stress = np.concatenate([stage.curve(f"{probe}.stress")[1] for stage in (load, back)])
        found.append((strain, scale * stress))
    return found


def lost(strain, stress):
    """J/m^3: the integral of the stress over the strain, there and back."""
    return float(np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(strain)))


def yielded(study):
    """Loops of the fitted law, of which those at rest are given back."""
    scene, strains = fitted(), FITTED_STRAINS[::2] if study.small else FITTED_STRAINS
    scenes = {} if study.small else {f"fitted, {v:g} m/s": cycled(scene, strains, v, 0.5, probe="tension") for v in FITTED_SPEEDS}
    cases = study.run({"fitted, at rest": cycled(scene, strains, 1.0, 0.5, 1000, probe="tension"), **scenes})
    found = {name: loops(case, 1, "tension") for name, case in cases.items()}
    study.table("hysteresis-fitted", HEAD, [row(name, strain, loop) for name in cases for strain, loop in zip(strains, found[name])])
    # No particle of this specimen changes its neighbours, so that all is given back, however far the curve has bent over.
    for strain, loop in zip(strains, found["fitted, at rest"]):
        share, stays = lost(*loop) / (0.5 * loop[1].max() ** 2 / 3e9), loop[0][-1]
        if abs(share) > 0.01 or abs(stays) > 2e-3:
            raise SystemExit(f"fitted law, loop at rest to {100 * strain:g} %: {share:.3f} of σ²/2E are lost and {100 * stays:.3f} % of strain stay, 0 and 0 are expected")
    return found["fitted, at rest"]


def row(name, strain, loop):
    way, stress = loop
    stored = 0.5 * stress.max() ** 2 / 3e9
    return (name, f"{100 * strain:g} %", f"{stress.max() / 1e6:.1f}", f"{100 * way[-1]:.3f}", f"{lost(*loop) / 1e3:.1f}", f"{lost(*loop) / stored:.3f}")


HEAD = ("run", "loop to", "largest stress, MPa", "strain that stays, %", "energy lost, kJ/m³", "over σ²/2E")


def run():
    study = Study("hysteresis", __doc__)
    strains = STRAINS[1::3] if study.small else STRAINS
    speeds, dampings = ((4.0,), (0.5,)) if study.small else (SPEEDS, DAMPINGS)
    base = specimen(2.2 if study.small else 1.4)
    scenes = {f"{v:g} m/s, damping {d:g}": cycled(base, strains, v, d) for v in speeds for d in dampings}
    cases = study.run({"at rest": cycled(base, strains, 1.0, 0.5, 1000), **scenes})
    pitch = 1e-3 * float(base["packing"]["pitch"].split()[0])
    found = {name: loops(case, AREA / section(case, pitch)) for name, case in cases.items()}
    energy = {(name, k): lost(*loop) for name in cases for k, loop in enumerate(found[name])}
    study.table("hysteresis-loops", HEAD, [row(name, strains[k], loop) for name in cases for k, loop in enumerate(found[name])])
    # At rest: the law alone goes there and back on one curve; once particles have changed their neighbours, it does not.
    for k, sign in ((0, -1), (len(strains) - 1, 1)):
        strain, stress = found["at rest"][k]
        share, stays = energy["at rest", k] / (0.5 * stress.max() ** 2 / 3e9), strain[-1]
        if sign * (share - 0.01) <= 0 or sign * (stays - 1e-4) <= 0:
            raise SystemExit(f"loop at rest to {100 * strains[k]:g} %: {share:.3f} of σ²/2E are lost and {100 * stays:.3f} % of strain stay, {'more' if sign > 0 else 'less'} than 0.01 and 0.01 % are expected")
    check("strength at rest", max(stress.max() for _, stress in found["at rest"]), 72e6, 0.15)  # for which the law was set
    plateau = yielded(study)
    with study.figure("hysteresis_loops", 3, (12, 3.8)) as (left, right, third):
        for strain, stress in plateau:
            third.plot(100 * strain, stress / 1e6, lw=0.8, color="C1")
        third.set(title="fitted law, at rest", xlabel="strain between the marks, %", ylabel="stress, MPa")
        for strain, stress in found["at rest"]:
            left.plot(100 * strain, stress / 1e6, lw=0.8, color="C0")
        left.set(title="at rest at each load step", xlabel="strain between the grips, %", ylabel="stress, MPa")
        if speeds[0] != speeds[-1]:
            for d in dampings:
                for k in (0, 2):
                    right.plot(speeds, [energy[f"{v:g} m/s, damping {d:g}", k] / 1e3 for v in speeds], "o-", label=f"to {100 * strains[k]:g} %, damping {d:g}")
            right.axhline(energy["at rest", 2] / 1e3, lw=0.8, color="k", label=f"to {100 * strains[2]:g} %, at rest")
            right.set(title="energy lost", xlabel="speed of the grip, m/s", ylabel="kJ/m³", yscale="log", xlim=(0, None))
            right.legend()
    study.end()


if __name__ == "__main__":
    main(run)
