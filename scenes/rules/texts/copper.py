#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes copper.eam.alloy: a setfl file of a closed form.

G. J. Ackland, G. Tichy, V. Vitek and M. W. Finnis, Phil. Mag. A 56 (1987) 735, table 1, copper: with x = r/a,
  pair(r) = sum of a_k (r_k - x)^3 where x < r_k,   density(r) = sum of A_k (R_k - x)^3 where x < R_k,
in eV and eV^2, and the embedding energy is -sqrt(density). a is the lattice constant, 3.615 angstrom.

python3 copper.py > copper.eam.alloy
"""
import math

LATTICE = 3.615  # angstrom
PAIR = [(29.059214, 1.2247449), (-140.05681, 1.1547054), (130.07331, 1.1180065), (-17.48135, 1.0), (31.82546, 0.8660254),
        (71.58749, 0.7071068)]
DENSITY = [(9.806694, 1.2247449), (16.774638, 1.0)]
CUTOFF = 1.2247449 * LATTICE

DENSITIES, DISTANCES = 1000, 800
DENSITY_STEP = 0.1             # eV^2; a crystal at rest has 22
# The table goes on behind the cutoff, where the third neighbours are: LAMMPS's slopes at the end of a table are of fewer points.
DISTANCE_STEP = CUTOFF / (DISTANCES - 6)


def cubics(terms, r):
    return sum(a * (end - r / LATTICE) ** 3 for a, end in terms if r / LATTICE < end)


def lines(values):
    return ["  ".join(f"{value:.10e}" for value in values[k:k + 5]) for k in range(0, len(values), 5)]


def main():
    distances = [k * DISTANCE_STEP for k in range(DISTANCES)]
    print("Copper by closed form, UNITS: metal")
    print("Ackland, Tichy, Vitek and Finnis, Phil. Mag. A 56 (1987) 735")
    print("made by copper.py of cuboct")
    print("1 Cu")
    print(f"{DENSITIES} {DENSITY_STEP} {DISTANCES} {DISTANCE_STEP:.15g} {CUTOFF:.15g}")
    print(f"29 63.546 {LATTICE} fcc")
    print("\n".join(lines([0.0 - math.sqrt(k * DENSITY_STEP) for k in range(DENSITIES)])))
    print("\n".join(lines([cubics(DENSITY, r) for r in distances])))
    print("\n".join(lines([r * cubics(PAIR, r) for r in distances])))


main()
