"""How near a pad comes to a tissue from the first newton on: misfit, shares and exponents of its steady curve."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.request import PAPER
from dummydesign.design.scoring.presses import steady_depth
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.slabs import Candidate

MISFIT_N = PAPER.misfit_N
"""Forces of the tissue over which the misfit is taken in the paper's test, even in the logarithm. [N]"""


@dataclass(frozen=True)
class LowForce:
    """One design against the tissue from a tenth of the lowest force of the test to its highest: 0.5 to 15 N.

    Attributes
    ----------
    misfit_rms_ln_force : float or None
        Root mean square of ln F(pad) - ln F(aim) at the depths where the aim carries these forces steady,
        even in ln F; None when the pad's depth limit comes first.
    share_below_5N, share_above_5N : float
        Share of the steady curve inside the subjects' range below and over the forces of the test, 0.5 to 5 and 5 to
        15 N.
    exponent_at_N : dict
        Local exponent d ln F / d ln x of the relaxed pad; None out of reach.
    depth_over_thickness : float or None
        At the highest steady force, slowest ramp.
    """

    misfit_rms_ln_force: float | None
    share_below_5N: float
    share_above_5N: float
    exponent_at_N: dict[str, float | None]
    depth_over_thickness: float | None

    def to_dict(self) -> dict[str, Any]:
        """Return all fields as plain values."""
        return asdict(self)


def low_force(candidate: Candidate, targets: Targets) -> LowForce:
    """Compare a design with the aim and the subjects' range over 0.5 to 15 N."""
    index, evaluation = candidate.index, candidate.evaluation
    slabs = evaluation.slabs.take(np.array([index]))
    protocol, sampling = targets.protocol, targets.sampling.coarse
    area = np.array(protocol.exponent_at_N) / slabs.young_MPa[0]
    depth = slabs.curves.depth_at(slabs.slab, area[None])
    exponent = (slabs.curves.slope_at(slabs.slab, depth) * depth / area)[0]
    deepest = float(steady_depth(slabs, protocol.forces_N[-1], protocol.slow_mm_s, sampling)[0])
    wide = steady_depth(slabs, protocol.wide_N, protocol.slow_mm_s, sampling)[0]
    return LowForce(
        misfit(wide, protocol.wide_N, targets.aim_depth_mm(protocol.misfit_N), protocol.misfit_N),
        float(evaluation.low_force_range[index]),
        float(evaluation.steady_state_range[index]),
        {f"{force:g}": _known(value) for force, value in zip(protocol.exponent_at_N, exponent)},
        _known(deepest / candidate.thickness_mm),
    )


def misfit(
    depth_mm: NDArray, force_N: NDArray, aim_depth_mm: NDArray, aim_N: NDArray = MISFIT_N
) -> float | None:
    """Root mean square of ln F(pad) - ln F(aim) over the aim's forces.

    Parameters
    ----------
    depth_mm, force_N : ndarray, shape (n,)
        Steady curve of the pad; NaN depths are out of its reach. [mm, N]
    aim_depth_mm, aim_N : ndarray, shape (m,)
        Depths and steady forces of the aim, by default those of the paper's test. [mm, N]

    Returns
    -------
    float or None
        None when the curve does not cover all depths.
    """
    known = np.isfinite(depth_mm)
    if known.sum() < 2 or depth_mm[known].max() < aim_depth_mm.max() * (1.0 - 1e-9):
        return None
    away = np.log(force_at(aim_depth_mm, depth_mm, force_N) / aim_N)
    return float(np.sqrt(np.mean(away**2)))


def steady_force(candidate: Candidate, depth_mm: NDArray) -> NDArray:
    """Steady force of a design at depths, through its steady curve; NaN beyond it. [N]"""
    slabs = candidate.evaluation.slabs.take(np.array([candidate.index]))
    protocol, sampling = candidate.evaluation.protocol, candidate.evaluation.sampling.coarse
    wide = steady_depth(slabs, protocol.wide_N, protocol.slow_mm_s, sampling)[0]
    return force_at(depth_mm, wide, protocol.wide_N)


def force_at(at_mm: NDArray, depth_mm: NDArray, force_N: NDArray) -> NDArray:
    """Force at depths on a curve, straight in ln F over ln depth; NaN beyond the curve's deepest point. [N]

    Parameters
    ----------
    at_mm : ndarray, shape (m,)
        Depths wanted, above 0. [mm]
    depth_mm, force_N : ndarray, shape (n,)
        The curve, rising; NaN depths are out of its reach. [mm, N]
    """
    known = np.isfinite(depth_mm)
    curve = np.log(depth_mm[known]), np.log(force_N[known])
    # A little slack: the aim's deepest point may be the curve's own.
    held = np.minimum(at_mm, depth_mm[known].max() * (1.0 + 1e-9))
    force = np.exp(np.interp(np.log(held), *curve))
    return np.where(at_mm <= held, force, np.nan)


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
