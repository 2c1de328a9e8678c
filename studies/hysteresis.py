# SPDX-License-Identifier: MIT
"""Hysteresis: a specimen of acetal loaded and unloaded, with a law that was set on one monotonic curve.

The specimen of scenes/acetal.toml, on a coarser packing, goes to growing strains and each time back to no stress (Strand, Tourlomousis,
Gershenfeld, section 5). Of each loop: the energy that is lost, and the strain that stays. What is lost has three causes. Damping takes a part
that is proportional to speed, waves from the grip's turns one that grows with its square; particles that change their neighbours take the
same at any speed, also at rest at each load step. The sweeps tell the three apart."""
import numpy as np

import cuboct
from study import ROOT, Study, check, main

STRAINS = (0.01, 0.04, 0.08, 0.12, 0.16, 0.2)  # between the grips
SPEEDS = (4.0, 2.0, 1.0)  # m/s
DAMPINGS = (0.1, 0.5)


def coarser(scene, factor):
    """The same material on a packing `factor` times as wide: lengths of the law grow with it, forces with its square."""
    numbers = lambda text: (np.array(eval_list(text)), text[text.index("]") + 1 :])
    for key, power in (("r", 1), ("force", 2)):
        values, unit = numbers(scene["law"][key])
        scene["law"][key] = "[" + ", ".join(f"{v * factor**power:.10g}" for v in values) + "]" + unit
    for table, key in (("packing", "pitch"), ("law", "core")):
        value, unit = scene[table][key].split()
        scene[table][key] = f"{float(value) * factor:.10g} {unit}"


def eval_list(text):
    return [float(part) for part in text[1 : text.index("]")].split(",")]


def specimen(factor):
    scene = cuboct.Scene.load(ROOT / "scenes/acetal.toml")
    coarser(scene, factor)
    for probe in scene["probe"]:
        probe.pop("datasheet", None)
    return scene


def cycled(scene, strains, speed, damping, static_steps=0):
    """Loads to each strain of the gauge, and back until the grip pulls no more."""
    scene = scene.copy()
    scene["damping"] = {"ratio": damping}
    move = lambda v: [{"name": "pulled", "velocity": f"[{v!r}, 0, 0] m/s"}]
    length = 0.0254  # m, between the grips
    scene["stage"] = []
    for k, strain in enumerate(strains, 1):
        # Longer than the strain takes: the stage ends where the probe says. Waves from the grip's turn do not end the way back.
        longest, turn = 1.5 * strain * length / speed, 0.1 * strain * length / speed
        for name, velocity, until in (
            (f"load-{k}", speed, {"probe": "grip.strain", "above": strain}),
            (f"back-{k}", -speed, {"probe": "grip.stress", "below": "0 Pa", "after": f"{turn!r} s"}),
        ):
            stage = {"name": name, "constraint": move(velocity), "duration": f"{longest!r} s", "until": until, "frame_every": 0}
            if static_steps:
                stage["static"] = {"load_steps": max(20, int(static_steps * strain * 2.5)), "tolerance": 1e-3, "evaluations": 1000000}
            else:
                stage["probe_every"] = 20
            scene["stage"].append(stage)
    del scene["run"]["frame_every"], scene["run"]["probe_every"]
    return scene


def loops(case):
    """Of each loop: largest strain, strain and stress on the way there and back."""
    found = []
    for load, back in zip(case.stages[::2], case.stages[1::2]):
        strain = np.concatenate([stage.curve("grip.strain")[1] for stage in (load, back)])
        stress = np.concatenate([stage.curve("grip.stress")[1] for stage in (load, back)])
        found.append((strain, stress))
    return found


def lost(strain, stress):
    """J/m^3: the integral of the stress over the strain, there and back."""
    return float(np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(strain)))


def run():
    study = Study("hysteresis", __doc__)
    strains = STRAINS[1::3] if study.small else STRAINS
    speeds, dampings = ((4.0,), (0.5,)) if study.small else (SPEEDS, DAMPINGS)
    base = specimen(1.8 if study.small else 1.4)
    scenes = {f"{v:g} m/s, damping {d:g}": cycled(base, strains, v, d) for v in speeds for d in dampings}
    cases = study.run({"at rest": cycled(base, strains, 1.0, 0.5, 1000), **scenes})
    rows = []
    energy = {}
    for name, case in cases.items():
        for k, (strain, stress) in enumerate(loops(case)):
            energy[name, k] = lost(strain, stress)
            stored = 0.5 * stress.max() ** 2 / 3e9
            rows.append((name, f"{100 * strains[k]:g} %", f"{stress.max() / 1e6:.1f}", f"{100 * strain[-1]:.3f}", f"{energy[name, k] / 1e3:.1f}", f"{energy[name, k] / stored:.3f}"))
    study.table("hysteresis-loops", ("run", "loop to", "largest stress, MPa", "strain that stays, %", "energy lost, kJ/m³", "over σ²/2E"), rows)
    study.end()


main(run)
