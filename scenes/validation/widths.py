# SPDX-License-Identifier: MIT
"""What each format adds to the fluctuation of the energy: docs/measured/validation.md, section 1.

    python3 scenes/validation/widths.py BUILD OUT [JOBS]

takes one format at a time from wide.toml, prints the table and writes OUT/widths.dat. The first 5 units of time, in which
the crystal melts, do not count.
"""
import os
import re
import sys

from nve import fluctuation
from runs import HERE, Curves, cuboct, in_parallel

DT, MELT, LENGTH, N = 0.001, 5.0, 20.0, 864
FOLLOWING = dict.fromkeys(("velocity_bits", "sum_bits", "relative_velocity_frac", "relative_velocity_bits",
                           "displacement_bits"), '"auto"')
KINDS = (
    ("wide", {}),
    ("23 value bits", {"strength_bits": 23}),
    ("4096 parabolas, 17 bits between", {"index_bits": 12, "fraction_bits": 17}),
    ("12 bits between entries", {"fraction_bits": 12}),
    ("512 lines, 17 bits between", {"degree": 1, "index_bits": 9, "fraction_bits": 17}),
    ("D 16", {"difference_frac": 16}),
    ("P 20, D 20, 14 guard bits", {"position_frac": 20, "difference_frac": 20, "guard": 14, **FOLLOWING}),
    ("P 20, D 20, 8 guard bits", {"position_frac": 20, "difference_frac": 20, "guard": 8, **FOLLOWING}),
)


def arch_of(out, changes):
    """wide.toml with some of its widths replaced."""
    text = open(os.path.join(HERE, "wide.toml"), encoding="utf-8").read()
    for key, value in changes.items():
        text, count = re.subn(rf"(?m)^{key} = .*", f"{key} = {value}", text)
        assert count == 1, key
    os.makedirs(out, exist_ok=True)
    path = os.path.join(os.path.abspath(out), "arch.toml")
    with open(path, "w", encoding="utf-8") as arch:
        arch.write(text)
    return path


def row(build, out, name, changes):
    place = os.path.join(out, re.sub(r"\W+", "_", name))
    run = cuboct(build, "melt_864.toml", place, {"dt": DT, "duration": MELT + LENGTH, "probe_every": round(0.1 / DT)},
                 arch=arch_of(place, changes))
    curves = Curves(run)
    _, about_line, drift = fluctuation(curves.step * DT, curves["energy.total"] / N, MELT)
    return f"{name};{about_line:.2e};{drift:+.1e}"


def main():
    build, out = sys.argv[1], sys.argv[2]
    jobs = int(sys.argv[3]) if len(sys.argv) > 3 else os.cpu_count()
    rows = in_parallel(jobs, [lambda kind=kind: row(build, out, *kind) for kind in KINDS])
    with open(f"{out}/widths.dat", "w", encoding="utf-8") as table:
        print("# One format at a time taken from wide.toml; 864 atoms, dt 0.001, 20 units of time after 5 of melting.\n"
              "# rms about a straight line and drift per unit of time, epsilon per atom", *rows, sep="\n", file=table)
    print(*rows, sep="\n")


if __name__ == "__main__":
    main()
