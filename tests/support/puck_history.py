"""Presses of pucks by other means than the package's: closed form between frictionless plates, plain sums in time."""

import numpy as np


def ramps(levels, height_mm, velocity_mm_s, hold_s, step_s=0.05):
    """Times and displacements of ramps and holds at compressions ``levels``; begins 0.1 mm above the puck."""
    knots = [(-0.5, -0.1), (0.0, 0.0)]
    for level in levels:
        stop = knots[-1][0] + (level * height_mm - knots[-1][1]) / velocity_mm_s
        knots += [(stop, level * height_mm), (stop + hold_s, level * height_mm)]
    time = np.arange(-0.5, knots[-1][0], step_s)
    return time, np.interp(time, *np.array(knots).T)


def frictionless(compression, diameter_mm, alpha):
    """Force of a one-term Ogden puck of 1 kPa between frictionless plates. [N]"""
    stretch = 1.0 - np.maximum(compression, 0.0)
    stress = 2.0 / (3.0 * alpha) * (stretch ** (-0.5 * alpha - 1.0) - stretch ** (alpha - 1.0))
    return 0.25e-3 * np.pi * diameter_mm**2 * stress


def relaxed(time, elastic, arms):
    """Hereditary integral, summed over the whole history at every time, kernel at the middle of each step."""
    rise, middle = np.diff(elastic), 0.5 * (time[1:] + time[:-1])
    age = np.maximum(time[:, None] - middle, 0.0)
    passed = time[:, None] > middle
    kernel = 1.0 + sum(beta * np.exp(-age / tau) for tau, beta in arms)
    return np.where(passed, kernel, 0.0) @ rise
