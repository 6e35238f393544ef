"""Solve the recommended design again by finite elements and say how far the table was off."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from dummydesign.design.finalists.elements_law import ElementsLaw
    from dummydesign.pad.pad import Pad


@dataclass(frozen=True)
class Verification:
    """Elastic forces of the table and of the finite-element solve at the same depths.

    ``max_difference_percent`` is None when the solve was not made; ``notes`` then say why.
    """

    fidelity: str
    max_difference_percent: float | None
    depth_mm: tuple[float, ...] = ()
    table_force_N: tuple[float, ...] = ()
    solved_force_N: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return all fields as plain values."""
        return {key: list(value) if isinstance(value, tuple) else value for key, value in asdict(self).items()}


def not_verified(reason: str) -> Verification:
    """Make the record of a verification that was not made."""
    return Verification("table", None, notes=(reason,))


def of_shape(law: ElementsLaw, young_MPa: float, radius_mm: float) -> Verification:
    """The record of a shape that was designed on its own elements: what the table gave, what was solved.

    Parameters
    ----------
    law : ElementsLaw
        The shape's table corrected by its own finite elements.
    young_MPa, radius_mm : float
        Modulus of the design, and radius of the circle of the punch's area. [MPa, mm]

    Returns
    -------
    Verification
    """
    table = np.asarray(law.table.force(law.depth_mm, law.thickness_mm, young_MPa, radius_mm), float)
    solved = table * np.exp(law.log_factor)
    notes = ("the design is based on the finite-element solution, not on the table", *([law.end] if law.end else []))
    depths = tuple(law.depth_mm.tolist())
    off = 100.0 * law.largest_difference
    fidelity = law.table.shape.fidelity
    return Verification(fidelity, off, depths, tuple(table.tolist()), tuple(solved.tolist()), notes)


def verify_design(
    thickness_mm: float,
    young_MPa: float,
    radius_mm: float,
    depth_mm: ArrayLike,
    table_force_N: ArrayLike,
    own: Pad | None = None,
) -> Verification:
    """Solve the elastic curve of one slab and compare it with the table.

    Parameters
    ----------
    thickness_mm, young_MPa, radius_mm : float
        Slab and round punch, both glued. [mm, MPa, mm]
    depth_mm, table_force_N : array_like, shape (n,)
        Depths, and what the table gives there. [mm, N]
    own : Pad, optional
        A slab that is pressed in another way: its punch, edge, base and size.

    Returns
    -------
    Verification
        With the largest relative difference over the depths that could be solved; without one, and with
        the reason, when none could.
    """
    from dummydesign.core.errors import NoAnswerError
    from dummydesign.pad.slab.sharp_edge import solve_curve

    order = np.argsort(np.asarray(depth_mm, float))
    depth, table = (np.asarray(values, float)[order] for values in (depth_mm, table_force_N))
    try:
        if own is None:
            solved = solve_curve(thickness_mm, radius_mm, young_MPa, depth.tolist())
        else:
            from dummydesign.pad.elastic import solve_points

            solved = solve_points(own, depth)
    except NoAnswerError as problem:
        return not_verified(str(problem))
    same = np.interp(solved.depth_mm, depth, table)
    difference = 100.0 * float(np.max(np.abs(solved.force_N / same - 1.0)))
    return Verification(
        "axisymmetric",
        difference,
        tuple(solved.depth_mm.tolist()),
        tuple(same.tolist()),
        tuple(solved.force_N.tolist()),
        tuple(solved.notes),
    )
