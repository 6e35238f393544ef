"""What share of castings stays inside the steady-state range, given weighing, thickness and the resin's doubt."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import FORCE_LAW, MODULUS, RELAXATION, PadCastings, Tolerances
from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.targets import Targets


@dataclass(frozen=True)
class PourYield:
    """Share of castings inside the steady-state range.

    Attributes
    ----------
    yield_fraction : float
        Share that stays inside at every force where the nominal pad is inside, with every uncertainty;
        0 when the nominal pad is inside nowhere.
    judged_at_N : tuple of float
        These forces, out of those of the test.
    making_only_fraction : float
        The same if resin and force law were known exactly: weighing and thickness alone.
    by_force : dict
        {force: fraction in range at this force}, every uncertainty.
    by_force_making_only : dict
        {force: share}, weighing and thickness alone.
    young_spread_percent : float
        Spread of the modulus from weighing alone (one standard deviation).
    """

    yield_fraction: float
    judged_at_N: tuple[float, ...]
    making_only_fraction: float
    by_force: dict[str, float]
    by_force_making_only: dict[str, float]
    young_spread_percent: float
    pours: int
    tolerances: Tolerances

    def to_dict(self) -> dict[str, Any]:
        """Return the shares and what they were computed for."""
        return asdict(self)


def pour_yield(cast: PadCastings) -> PourYield:
    """Share of the castings of a pad whose steady depths at the slowest speed lie among the subjects'.

    Parameters
    ----------
    cast : PadCastings
    """
    targets, best = cast.space.targets, cast.candidate
    known = (MODULUS, RELAXATION, FORCE_LAW)
    inside, making = (_inside(found, targets) for found in (cast.every, cast.pressed(known)))
    nominal = _inside(best.evaluation, targets)[best.index]
    forces = targets.protocol.forces_N
    return PourYield(
        _stays(inside, nominal),
        tuple(float(force) for force in np.array(forces)[nominal]),
        _stays(making, nominal),
        _by_force(inside, forces),
        _by_force(making, forces),
        100.0 * float(np.std(np.log(cast.pours(known).young_MPa))),
        cast.castings.n,
        cast.tolerances,
    )


def _inside(found: Evaluation, targets: Targets) -> NDArray:
    """Whether each pad is inside the steady-state range at each force of the slowest speed, shape (pads, forces)."""
    forces = np.array(targets.protocol.forces_N)
    depth = found.depth_mm[:, : len(forces)]
    stiff, soft = targets.depth_range_mm(forces)
    with np.errstate(invalid="ignore"):
        return np.asarray((depth >= stiff) & (depth <= soft))


def _stays(inside: NDArray, nominal: NDArray) -> float:
    """Share of pours inside wherever the nominal pad is."""
    return float(inside[:, nominal].all(axis=-1).mean()) if nominal.any() else 0.0


def _by_force(inside: NDArray, forces_N: tuple[float, ...]) -> dict[str, float]:
    return {f"{force:g}": float(share) for force, share in zip(forces_N, inside.mean(axis=0))}
