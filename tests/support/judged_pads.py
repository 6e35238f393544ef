"""Subjects in six presses and pads beside them, by the factors by which they are away."""

import numpy as np

from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import (
    CLASSES,
    Ranges,
    Readings,
    classes,
    deviations,
    outside,
    reads_of,
)

FORCES = np.array([5.0, 10.0, 15.0, 5.0, 10.0, 15.0])
SPEEDS = np.repeat([10.0, 250.0], 3)
STEADY_N = np.linspace(5.0, 15.0, 41)


def ranges(subjects=5, width=1.3):
    middle = np.cbrt(STEADY_N / 2.0)
    return Ranges(
        FORCES,
        SPEEDS,
        1.6 * FORCES,
        1.6 * width * FORCES,
        FORCES**1.3,
        width * FORCES**1.3,
        STEADY_N,
        middle / width**0.3,
        middle * width**0.3,
        subjects,
    )


def pad(peak=1.0, energy=1.0, depth=1.0, width=1.3):
    """A pad in the middle of the ranges, peaks, energies and depths times the given factors."""
    middle = np.sqrt(width)
    return Readings(peak * 1.6 * middle * FORCES, energy * middle * FORCES**1.3, depth * np.cbrt(STEADY_N / 2.0))


def away(shortfall=None, over=None):
    """A pad in the middle, with one peak that much below the lowest subject and another above the highest."""
    readings, band = pad(), ranges()
    if shortfall is not None:
        readings.peak_N[1] = band.peak_low_N[1] / shortfall
    if over is not None:
        readings.peak_N[4] = band.peak_high_N[4] * over
    return readings


def stacked(pads):
    return Readings(*(np.stack([getattr(one, name) for one in pads]) for name in vars(pads[0])))


SIDES = {
    "stands_for": {},
    "with_correction": {"shortfall": 1.15},
    "reads_low": {"shortfall": 1.21},
    "over": {"over": 1.26},
}


def cast(counts):
    """Castings of each class, in the order of the classes."""
    lost = away()
    lost.peak_N[3] = np.nan
    kinds = [lost if name == "out_of_reach" else away(**SIDES[name]) for name in CLASSES]
    return [one for one, count in zip(kinds, counts) for _ in range(count)]


def judged(band, readings):
    """Of each of n pads its class and how it reads."""
    found = deviations(band, readings)
    kinds = classes(found, verdict_limits())
    reads = (reads_of(*outside(found, at)) for at in range(len(kinds)))
    return [(CLASSES[kind], how) for kind, how in zip(kinds, reads)]
