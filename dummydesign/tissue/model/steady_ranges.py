"""The range of steady force over depth that a dummy is compared with."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.parameters import Parameters

STEADY_PARTS_N = {"below_5N": (0.5, 5.0), "above_5N": (5.0, 15.0)}
"""Parts of the steady-state range that are reported separately; below 5 N there are no measurements. [N]"""


def steady_force_range(subjects: tuple[Parameters, ...], depth_mm: ArrayLike) -> tuple[NDArray, NDArray]:
    """Steady-state range gamma1 x^3 over depth: lowest and highest subject, shapes of ``depth_mm``. [N]"""
    force = law_named(subjects[0].law).steady_forces(subjects, depth_mm)
    return force.min(axis=0), force.max(axis=0)


def steady_depth_range(subjects: tuple[Parameters, ...], force_N: ArrayLike) -> tuple[NDArray, NDArray]:
    """Steady-state range over force: depth of the stiffest and of the softest subject. [mm]"""
    depth = law_named(subjects[0].law).steady_depths(subjects, force_N)
    return depth.min(axis=0), depth.max(axis=0)


def steady_inside(subjects: tuple[Parameters, ...], force_N: ArrayLike, depth_mm: ArrayLike) -> dict[str, NDArray]:
    """Fraction of a steady-state curve in the range, below 5 N, above 5 N and over both.

    Parameters
    ----------
    subjects : tuple of Parameters
        They span the range; at least one.
    force_N : array_like, shape (n,)
        Rising steady forces; the part of 0.5 to 15 N that they cover is judged. [N]
    depth_mm : array_like, shape (..., n)
        Depth of each curve at those forces; NaN where it is out of reach (counts as out of range). [mm]

    Returns
    -------
    dict of ndarray, shape (...)
        ``inside_fraction``, ``below_5N_fraction``, ``above_5N_fraction``, even in force; NaN for a part
        without a single force in it.
    """
    forces, depth = np.asarray(force_N, float), np.asarray(depth_mm, float)
    low, high = steady_depth_range(subjects, forces)
    inside = (depth >= low - 1e-9) & (depth <= high + 1e-9)
    result = {}
    whole = (forces >= STEADY_PARTS_N["below_5N"][0]) & (forces <= STEADY_PARTS_N["above_5N"][1])
    parts = {"inside_fraction": whole}
    for name, (start, stop) in STEADY_PARTS_N.items():
        parts[f"{name}_fraction"] = (forces >= start) & (forces <= stop)
    for name, chosen in parts.items():
        count = np.full(depth.shape[:-1], np.nan)
        result[name] = inside[..., chosen].mean(axis=-1) if chosen.any() else count
    return result
