"""Solve the recommended design again, and how far off its centre it may be pressed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.serialise import Serialised
from dummydesign.design.request import PAPER
from dummydesign.geometry.dimensions import PAD_EXTENT_MM

if TYPE_CHECKING:
    from dummydesign.design.search.finalists import ElementsLaw
    from dummydesign.design.search.slabs import DesignCandidate
    from dummydesign.geometry.pad_shape import PadShape
    from dummydesign.pad.axisymmetric.shaped_problem import Touch
    from dummydesign.pad.specimen import Pad


@dataclass(frozen=True)
class Verification(Serialised):
    """Elastic forces of the table and of the finite-element solve at the same depths.

    ``max_difference_percent`` is None when the solve was not made; ``notes`` then say why.
    """

    fidelity: str
    max_difference_percent: float | None
    depth_mm: tuple[float, ...] = ()
    table_force_N: tuple[float, ...] = ()
    solved_force_N: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()


def not_verified(reason: str) -> Verification:
    """Make the record of a verification that was not made."""
    return Verification("table", None, notes=(reason,))


def of_shape(law: ElementsLaw, young_MPa: float, radius_mm: float) -> Verification:
    """The record of a shape that was designed on its own elements: what the table gave, what was solved."""
    table = np.asarray(law.table.force(law.depth_mm, law.thickness_mm, young_MPa, radius_mm), float)
    depth, force, solved = (tuple(values.tolist()) for values in (law.depth_mm, table, table * np.exp(law.log_factor)))
    notes = ("the design is based on the finite-element solution, not on the table", *([law.end] if law.end else []))
    largest = float(np.max(np.abs(np.expm1(law.log_factor))))
    return Verification(law.table.shape.fidelity, 100.0 * largest, depth, force, solved, notes)


def verify_design(
    thickness_mm: float, young_MPa: float, radius_mm: float, depth_mm: ArrayLike, table_force_N: ArrayLike,
    own: Pad | None = None,
) -> Verification:  # fmt: skip
    """Solve the elastic curve of one slab, without the table, and compare the two."""
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
    from dummydesign.pad.specimen import Pad

    order = np.argsort(np.asarray(depth_mm, float))
    depth, table = (np.asarray(values, float)[order] for values in (depth_mm, table_force_N))
    try:
        if own is None:
            solved = solve_curve(Pad(thickness_mm, young_MPa, radius_mm), depth.tolist(), independent=True)
        else:
            from dummydesign.pad.elastic_force import solve_points

            solved = solve_points(own, depth, independent=True)
    except NoAnswerError as problem:
        return not_verified(str(problem))
    same = np.interp(solved.depth_mm, depth, table)
    difference = 100.0 * float(np.max(np.abs(solved.force_N / same - 1.0)))
    depths, expected, forces = (tuple(values.tolist()) for values in (solved.depth_mm, same, solved.force_N))
    return Verification("axisymmetric", difference, depths, expected, forces, tuple(solved.notes))


# The largest loss of force of the crowns solved in space is 2 % at 1 mm off centre (docs/shapes.md).
LOSS_PERCENT = 1.0
DEPTH_SHARES = np.linspace(0.05, 1.0, 12)


@dataclass(frozen=True)
class CentringTolerance(Serialised):
    """Contact radius at each steady force, and the way the punch may be moved until its side meets the contact."""

    force_N: tuple[float, ...]
    contact_radius_mm: tuple[float | None, ...]
    margin_mm: tuple[float | None, ...]

    @property
    def text(self) -> str:
        """The margins as a sentence."""
        free = [f"{m:.1f} mm at {f:g} N" for f, m in zip(self.force_N, self.margin_mm) if m is not None and m >= 0.05]
        wide = [f"{f:g}" for f, m in zip(self.force_N, self.margin_mm) if m is not None and m < 0.05]
        parts = [f"nothing changes within {', '.join(free)}"] if free else []
        if wide:
            parts.append(
                f"at {', '.join(wide)} N the force falls by at most {LOSS_PERCENT:g} % per 0.5 mm, up to 1 mm off "
                "centre (crowns solved in space, docs/shapes.md)"
            )
        return f"placement on the crown: {'; '.join(parts)}"


def centring_tolerance(
    best: DesignCandidate, shape: PadShape, radius_mm: float, half_side_mm: float,
    forces_N: tuple[float, ...] = (1.0, *PAPER.forces_N), extent_mm: float = PAD_EXTENT_MM, touch: Touch | None = None,
) -> CentringTolerance | None:  # fmt: skip
    """Solve the contact of a round crowned pad; None for flat tops, shapes that are not round, or a failed solve."""
    from dummydesign.pad.specimen import Pad

    if shape.flat_top or not shape.axisymmetric:
        return None
    slabs = best.evaluation.slabs.take(np.array([best.index]))
    depth = slabs.curves.depth_at(slabs.slab, np.array([forces_N]) / slabs.young_MPa[0])[0]
    if not np.isfinite(depth).any():
        return None
    try:
        if touch is None:
            from dummydesign.pad.axisymmetric.shaped_problem import contact_radius

            wanted = np.nanmax(depth) * DEPTH_SHARES
            pad = Pad(best.thickness_mm, 1.0, radius_mm, geometry=shape, extent_mm=extent_mm)
            touch = contact_radius(pad, wanted)
    except NoAnswerError:
        return None
    radius = touch.radius_at(depth)
    margin = np.maximum(half_side_mm - radius, 0.0)
    values = (tuple(float(v) if np.isfinite(v) else None for v in row) for row in (radius, margin))
    return CentringTolerance(forces_N, *values)
