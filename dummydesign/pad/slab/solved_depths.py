"""Depths at which a slab under a filleted punch is solved, and the curve through them."""

from __future__ import annotations

from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.pad.slab.problem import PadCurve
from dummydesign.pad.solve.continuation import Path, cost

Array = np.ndarray

# Load steps end at multiples of this depth over the thickness, halves and less of it at first.
LATTICE, HALVINGS = 0.02, 5


def curve_through(
    nodes: Array, found: dict[str, Any], depths: Array, thickness_mm: float, unit_MPa: float
) -> PadCurve:
    """The curve at wanted depths from F / d at solved ones: ln of it by monotone cubics over the root of the depth.

    Parameters
    ----------
    nodes : ndarray, shape (m,)
        Depths that were to be solved, rising, in thicknesses; below the first F / d is that at the first.
    found : dict
        ``stiffness``, F / d over mu h, and ``error``, relative, at the nodes that were reached; ``solver``; ``stop``.
    depths : ndarray, shape (n,)
        Wanted ones, rising, in thicknesses.
    thickness_mm : float
        Thickness. [mm]
    unit_MPa : float
        Stress that the stiffness is in. [MPa]

    Returns
    -------
    PadCurve
        At the depths within those that were reached; ``notes`` says why if some are missing.

    Raises
    ------
    NoAnswerError
        When none was reached.
    """
    count = len(found["stiffness"])
    reached = nodes[count - 1] if count else 0.0
    kept = depths[depths <= reached * (1.0 + 1e-9)]
    if not len(kept):
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {found['stop']}")
    notes: tuple[str, ...] = ()
    if len(kept) < len(depths):
        notes = (f"solved to d/h = {reached:.3f} of {depths[-1]:.3f}: {found['stop']}",)
    from scipy.interpolate import PchipInterpolator

    at, where = np.sqrt(nodes[:count]), np.sqrt(np.maximum(kept, nodes[0]))
    log = np.log(found["stiffness"])
    stiffness = np.exp(PchipInterpolator(at, log)(where) if count > 1 else log[0])
    force = stiffness * kept * unit_MPa * thickness_mm**2
    return PadCurve(kept * thickness_mm, force, np.interp(where, at, found["error"]) * force, found["solver"], notes)


def of_two_meshes(coarse: Path, fine: Path, nodes: Array, least_error: float) -> dict[str, Any]:
    """F / d at the first of the nodes from two meshes: the finer one's, carried on by the one that got further.

    Parameters
    ----------
    coarse, fine : Path
        Through the first of the nodes.
    nodes : ndarray, shape (m,)
        Depths, in thicknesses.
    least_error : float
        Relative error that is stated beside the largest step between the meshes so far, which counts twice where only
        one of them got to.

    Returns
    -------
    dict
        ``stiffness``, ``error``, ``solver`` and ``stop``, as :func:`curve_through` takes them.
    """
    both = min(len(coarse.force), len(fine.force))
    further = fine if len(fine.force) > both else coarse
    count = len(further.force)
    step = np.zeros(count)
    step[:both] = np.log(fine.force[:both] / coarse.force[:both])
    largest = np.maximum.accumulate(np.abs(step))
    force = further.force.copy()
    force[:both] = fine.force[:both]
    if both and further is coarse:
        force[both:] *= np.exp(step[both - 1])
    error = least_error + np.where(np.arange(count) < both, 1.0, 2.0) * largest
    return {
        "stiffness": force / nodes[:count], "error": error, "solver": cost([coarse, fine]), "stop": further.stop
    }  # fmt: skip


def lattice_depths(deepest: float) -> Array:
    """Depths that are solved: multiples of the lattice up to the deepest wanted one, and halvings of the first.

    Parameters
    ----------
    deepest : float
        In thicknesses.
    """
    count = int(np.ceil(min(deepest, MAX_DEPTH_OVER_THICKNESS) / LATTICE - 1e-9))
    return LATTICE * np.concatenate([0.5 ** np.arange(HALVINGS, 0, -1), np.arange(1, count + 1)])
