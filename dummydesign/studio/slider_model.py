"""What the sliders of the design page ask: lengths of a shape, and one pad against the tissue."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError, accepts
from dummydesign.core.user_library import find
from dummydesign.design.pad_evaluator import NotTabulated, PadEvaluator
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.test_conditions import table_alone, why_solved
from dummydesign.geometry.dimensions import THICKNESS_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import PROFILE
from dummydesign.geometry.shape_registry import read_shape, shape_kind
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.studio.state import NO_TISSUE, State, absolute, punch_of

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
    """Return the lengths of a kind that can be moved at a thickness; none for a slab."""
    made = shape_kind(kind)
    _, columns = made.candidates(np.array([thickness_mm]), radius_mm)
    shapes = (made.of(dict(zip(columns, map(float, row)))) for row in zip(*columns.values()))
    usable = np.array([accepts(shape.check, thickness_mm) for shape in shapes], bool)
    lengths = []
    for name, column in columns.items():
        kept = column[usable]
        if (not made.sliders or name in made.sliders) and len(kept) and kept.max() > kept.min():
            lengths.append(Length(name, float(kept.min()), float(kept.max()), 10.0 ** -made.digits(name)))
    return tuple(lengths)


def first_shape(
    kind: str, thickness_mm: float, radius_mm: float, solvable: Callable[[PadShape], bool], near: PadShape | None = None
) -> PadShape | None:
    """Return a shape of a kind that can be pressed at a thickness; None when there is none."""
    made = shape_kind(kind)
    _, columns = made.candidates(np.array([thickness_mm]), radius_mm)
    rows = np.column_stack(list(columns.values())) if columns else np.zeros((1, 0))
    spread = np.where(np.ptp(rows, axis=0) > 0.0, np.ptp(rows, axis=0), 1.0) if len(rows) else 1.0
    known = dict(near.parameters) if near is not None and near.name == kind else {}
    middle = np.array([known.get(name, float(np.median(column))) for name, column in columns.items()])
    order = np.argsort((((rows - middle) / spread) ** 2).sum(axis=1), kind="stable")
    for row in rows[order[:MOST_TRIED]]:
        shape = made.of(dict(zip(columns, map(float, row))))
        if accepts(shape.check, thickness_mm) and solvable(shape):
            return shape
    return None


def evaluator_of(root: Path, state: State) -> PadEvaluator:
    """Return what presses the pads of a state; its files are read once as long as they stay the same."""
    return _evaluator(root, State(**state.question), stamp_of(root, state))


@lru_cache(maxsize=8)
def _evaluator(root: Path, question: State, stamp: object) -> PadEvaluator:
    if not question.tissue:
        raise InputError(NO_TISSUE, "missing", "tissue")
    calibration = str(root / question.calibration) if question.calibration else None
    punch = punch_of(root, question.punch)
    request = Request(
        absolute(root, question.tissue),
        question.aim,
        absolute(root, question.resin),
        shape="slab",
        verify=False,
        calibration=calibration,
        punch=punch.text,
    )
    if punch.profile_mm is not None:
        raise NotTabulated(why_solved(request, punch, THICKNESS_MM[0]), "punch")
    return PadEvaluator(read_problem(request, None if calibration else table_alone(request, punch)))


def stamp_of(root: Path, state: State) -> tuple[tuple[str, int, int], ...]:
    """Path, time and size of the files behind what is chosen, the library's too; names of nothing are left out."""
    paths = [root / state.calibration] if state.calibration else []
    if state.punch.startswith(PROFILE):
        paths.append(root / state.punch.removeprefix(PROFILE))
    for what, name in (("tissue", state.tissue), ("resin", state.resin)):
        with suppress(InputError):
            paths.append(find(f"materials/{what}s", what, absolute(root, name)).path)
    there = {str(path): path.stat() for path in paths if path.is_file()}
    return tuple((path, stat.st_mtime_ns, stat.st_size) for path, stat in there.items())


def first_pad(root: Path, state: State, kind: str) -> PadShape:
    """Return the shape of a kind nearest to the chosen one that the tables hold at its thickness; else one to solve."""
    if kind == Slab.name:
        return Slab()
    evaluator = evaluator_of(root, state)
    near = read_shape(state.shape) if state.shape.startswith(f"{kind}:") else None

    def tabulated(shape: PadShape) -> bool:
        return accepts(evaluator.evaluate, shape, state.thickness_mm, state.ratio)

    radius_mm = evaluator.problem.punch.radius_mm
    for solvable in (tabulated, lambda shape: True):
        if (shape := first_shape(kind, state.thickness_mm, radius_mm, solvable, near)) is not None:
            return shape
    message = f"no {kind} pad {state.thickness_mm:g} mm thick can be made: choose another thickness or shape"
    raise InputError(message, "cannot_be_made", "thickness_mm", state.thickness_mm)
