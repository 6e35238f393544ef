"""Lengths of a kind of shape at a thickness: where they begin, and between which ends sliders move them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.shapes import PadShape, shape_kind

MOST_TRIED = 400
"""Candidates that are tried before a kind is given up at a thickness."""


@dataclass(frozen=True)
class Length:
    """A parameter that a slider moves, with its ends and its step; in mm unless it is a ratio."""

    name: str
    low: float
    high: float
    step: float

    @property
    def unit(self) -> str:
        """What stands behind the number."""
        return "" if "ratio" in self.name else "mm"


def lengths_of(kind: str, thickness_mm: float, radius_mm: float) -> tuple[Length, ...]:
    """Return the lengths of a kind that can be moved at a thickness; none for a slab.

    Parameters
    ----------
    kind : str
        Such as ``crowned``.
    thickness_mm, radius_mm : float
        Of the pad, and of the circle of the punch's area. [mm]
    """
    made = shape_kind(kind)
    _, columns = made.candidates(np.array([thickness_mm]), radius_mm)
    rows = zip(*columns.values())
    usable = np.array([_can_be_made(made.of(dict(zip(columns, map(float, row)))), thickness_mm) for row in rows], bool)
    found = []
    for name, column in columns.items():
        kept = column[usable]
        if (made.sliders and name not in made.sliders) or not len(kept) or not kept.max() > kept.min():
            continue
        found.append(Length(name, float(kept.min()), float(kept.max()), 10.0 ** -made.digits(name)))
    return tuple(found)


def first_shape(
    kind: str, thickness_mm: float, radius_mm: float, solvable: Callable[[PadShape], bool], near: PadShape | None = None
) -> PadShape | None:
    """Return a shape of a kind that can be pressed at a thickness; None when there is none.

    Parameters
    ----------
    kind : str
        Such as ``crowned``.
    thickness_mm, radius_mm : float
        As for :func:`lengths_of`. [mm]
    solvable : callable
        Whether a shape can be pressed at this thickness.
    near : PadShape, optional
        The nearest to this one is taken; by default the one in the middle of all.
    """
    made = shape_kind(kind)
    _, columns = made.candidates(np.array([thickness_mm]), radius_mm)
    rows = np.column_stack([column for column in columns.values()]) if columns else np.zeros((1, 0))
    spread = np.where(np.ptp(rows, axis=0) > 0.0, np.ptp(rows, axis=0), 1.0) if len(rows) else 1.0
    known = dict(near.parameters) if near is not None and near.name == kind else {}
    middle = np.array([known.get(name, float(np.median(column))) for name, column in columns.items()])
    order = np.argsort((((rows - middle) / spread) ** 2).sum(axis=1), kind="stable")
    for row in rows[order[:MOST_TRIED]]:
        shape = made.of(dict(zip(columns, map(float, row))))
        if _can_be_made(shape, thickness_mm) and solvable(shape):
            return shape
    return None


def _can_be_made(shape: PadShape, thickness_mm: float) -> bool:
    try:
        shape.check(thickness_mm)
    except InputError:
        return False
    return True
