# SPDX-License-Identifier: MIT
"""The frequency of the strongest oscillation of a curve, and two theories that it is compared with."""
import numpy as np


def frequency(time, value):
    """Angular frequency by least squares of a + b t + c cos(w t) + d sin(w t), and the share of the variance it leaves.

    The search starts at the peak of the Fourier transform and ends when w is known to 1e-9 of itself.
    """
    span = time[-1] - time[0]
    spectrum = np.abs(np.fft.rfft((value - value.mean()) * np.hanning(len(value))))
    peak = 2 * np.pi * (np.argmax(spectrum[1:]) + 1) / span

    def left(w):
        basis = np.column_stack([np.ones_like(time), time - time.mean(), np.cos(w * time), np.sin(w * time)])
        rest = value - basis @ np.linalg.lstsq(basis, value, rcond=None)[0]
        return rest @ rest

    low, high = peak - 2 * np.pi / span, peak + 2 * np.pi / span
    grid = np.linspace(low, high, 41)
    best = int(np.argmin([left(w) for w in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, 40)]
    golden = (np.sqrt(5) - 1) / 2
    while high - low > 1e-9 * peak:
        a, b = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, b) if left(a) < left(b) else (a, high)
    w = (low + high) / 2
    return w, left(w) / ((value - value.mean()) @ (value - value.mean()))


def without_time_step(w, dt):
    """The frequency of the equations of motion behind that of their leapfrog steps: sin(w dt/2) = w0 dt/2."""
    return 2 / dt * np.sin(w * dt / 2)


def free_beam(length, ei, mass_per_length, shear=np.inf, rotary=0.0):
    """First bending frequency (rad) of a free beam by Ritz's method in Legendre polynomials up to degree 16.

    ei: bending stiffness; shear: kappa G A; rotary: density times second moment. shear = inf, rotary = 0: Euler and
    Bernoulli's beam; both given: S. P. Timoshenko, Phil. Mag. 41 (1921) 744. Free ends are natural conditions.
    """
    from numpy.polynomial import legendre as leg

    n = 17
    x, weight = leg.leggauss(64)
    values = np.array([leg.legval(x, np.eye(n)[k]) for k in range(n)])
    slopes = np.array([leg.legval(x, leg.legder(np.eye(n)[k])) for k in range(n)]) * 2 / length
    curves = np.array([leg.legval(x, leg.legder(np.eye(n)[k], 2)) for k in range(n)]) * (2 / length) ** 2
    weight = weight * length / 2

    def gram(a, b):
        return (a * weight) @ b.T

    if np.isinf(shear):
        stiffness, mass = ei * gram(curves, curves), mass_per_length * gram(values, values)
    else:
        stiffness = np.block([[shear * gram(slopes, slopes), -shear * gram(slopes, values)],
                              [-shear * gram(values, slopes), shear * gram(values, values) + ei * gram(slopes, slopes)]])
        zero = np.zeros((n, n))
        mass = np.block([[mass_per_length * gram(values, values), zero], [zero, rotary * gram(values, values)]])
    half = np.linalg.inv(np.linalg.cholesky(mass))
    squares = np.linalg.eigvalsh(half @ stiffness @ half.T)
    bound = 1e-6 * ei / (mass_per_length * length**4) * 22.37**2  # above the two rigid motions' rounding
    return float(np.sqrt(min(s for s in squares if s > bound)))
