"""What the sliders of the design page ask: one pad against the tissue, with what is read from files kept at hand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dummydesign.core.datafiles import find
from dummydesign.core.errors import InputError
from dummydesign.design.own_test.checks import beyond_people, refused_kinds
from dummydesign.design.own_test.punch import PROFILE, read_punch
from dummydesign.design.own_test.slab_law import table_alone, why_solved
from dummydesign.design.request import Request
from dummydesign.design.search.slabs import THICKNESS_MM
from dummydesign.design.sweep.one_pad import OnePad, law_of_shape, one_pad, with_castings
from dummydesign.geometry.shapes import PadShape, Slab, read_shape
from dummydesign.geometry.standard import PUNCH
from dummydesign.studio.lengths import first_shape
from dummydesign.studio.state import State, absolute

if TYPE_CHECKING:
    from dummydesign.design.inputs import Inputs
    from dummydesign.design.scoring.verdict import Verdict

NO_SLIDER = "it is solved by finite elements, which takes minutes"


class NotTabulated(InputError):
    """The pad can be made, but no table holds its force: finite elements have to solve it."""


@dataclass(frozen=True)
class Asked:
    """What is chosen above the sliders; names, or paths from the project folder on."""

    tissue: str
    aim: str
    resin: str
    calibration: str = ""
    punch: str = PUNCH

    @classmethod
    def of(cls, state: State) -> Asked:
        """Without the pad."""
        return cls(**state.question)


@lru_cache(maxsize=8)
def inputs_of(root: Path, asked: Asked, stamp: tuple[tuple[str, int, int], ...]) -> Inputs:
    """Read tissue, resin and calibration; ``stamp`` are the times of the files, so that changed ones are read anew.

    Parameters
    ----------
    root : Path
        The project folder.
    asked : Asked
    stamp : tuple of (str, int, int)
        From :func:`stamp_of`.
    """
    from dummydesign.design.inputs import resolve

    calibration = str(root / asked.calibration) if asked.calibration else None
    request = Request(absolute(root, asked.tissue), asked.aim, absolute(root, asked.resin), shape="slab", verify=False,
                      calibration=calibration, punch=_punch(root, asked.punch))  # fmt: skip
    punch = read_punch(request.punch)
    if punch.profile_mm is not None:
        raise NotTabulated(f"{why_solved(request, punch, THICKNESS_MM[0])}: {NO_SLIDER}")
    return resolve(request, None if calibration else table_alone(request, punch))


def stamp_of(root: Path, asked: Asked) -> tuple[tuple[str, int, int], ...]:
    """Path, time and size of the files behind what is chosen, those of the library too; names of nothing are left out.

    Parameters
    ----------
    root : Path
        The project folder.
    asked : Asked
    """
    paths = [root / asked.calibration] if asked.calibration else []
    if asked.punch.startswith(PROFILE):
        paths.append(root / asked.punch.removeprefix(PROFILE))
    for kind, what, name in (("tissues", "tissue", asked.tissue), ("resins", "resin", asked.resin)):
        try:
            paths.append(find(f"materials/{kind}", what, absolute(root, name)).path)
        except InputError:
            continue
    stamps = [(path, path.stat()) for path in paths if path.is_file()]
    return tuple((str(path), stat.st_mtime_ns, stat.st_size) for path, stat in stamps)


def _punch(root: Path, text: str) -> str:
    return f"{PROFILE}{root / text.removeprefix(PROFILE)}" if text.startswith(PROFILE) else text


def shape_of(text: str) -> PadShape:
    """The shape of a text such as ``crowned:20,2,9``; ``slab`` without lengths."""
    return Slab() if text.strip().lower() == "slab" else read_shape(text.strip())


def evaluate_pad(inputs: Inputs, shape: PadShape, thickness_mm: float, ratio: float) -> OnePad:
    """Press one pad.

    Parameters
    ----------
    inputs : Inputs
    shape : PadShape
    thickness_mm, ratio : float
        The pad. [mm, resin's ratio]

    Raises
    ------
    NotTabulated
        When finite elements have to solve it.
    InputError
        When the pad cannot be made, or pads of its shape are not designed under this punch.
    """
    request, space = inputs.request, inputs.space
    refused = refused_kinds(request, inputs.punch).get(shape.name)
    if refused:
        raise InputError(refused)
    if not request.calibration and (why := why_solved(request, inputs.punch, thickness_mm)):
        raise NotTabulated(f"{why}: {NO_SLIDER}")
    space.resin.check_ratio(ratio)
    shape.check(thickness_mm, *request.pad_mm)
    try:
        law = law_of_shape(inputs.slab_law, shape, thickness_mm, request.pad_mm, space.correct)
    except InputError as problem:
        raise NotTabulated(f"{str(problem).partition('; use --fidelity')[0]}: {NO_SLIDER}") from None
    if float(law.depth_limit_mm(np.array([thickness_mm]), space.radius_mm)[0]) <= 0.0:
        raise NotTabulated(f"the proportions of this {shape.name} pad are not in the tables: {NO_SLIDER}")
    return one_pad(law, space, thickness_mm, ratio)


def first_pad(inputs: Inputs, kind: str, thickness_mm: float, ratio: float, near: PadShape | None = None) -> PadShape:
    """Return a shape of a kind that can be pressed at a thickness, the nearest to another one where it is given.

    One that the tables hold is taken; where they hold none, one that can be made and solved.

    Parameters
    ----------
    inputs : Inputs
    kind : str
        Such as ``crowned``.
    thickness_mm, ratio : float
        The pad. [mm, resin's ratio]
    near : PadShape, optional

    Raises
    ------
    InputError
        When no pad of this kind can be made at this thickness.
    """
    if kind == Slab.name:
        return Slab()

    def solvable(shape: PadShape) -> bool:
        try:
            evaluate_pad(inputs, shape, thickness_mm, ratio)
        except InputError:
            return False
        return True

    radius_mm = inputs.punch.radius_mm
    shape = first_shape(kind, thickness_mm, radius_mm, solvable, near)
    shape = shape or first_shape(kind, thickness_mm, radius_mm, lambda shape: True, near)
    if shape is None:
        raise InputError(f"no {kind} pad {thickness_mm:g} mm thick can be made: choose another thickness or shape")
    return shape


def verdict_with_castings(inputs: Inputs, shape: PadShape, pad: OnePad) -> Verdict:
    """The verdict with what castings of the pad may turn out as, by the same tolerances as ``suggest``.

    Parameters
    ----------
    inputs : Inputs
    shape : PadShape
    pad : OnePad
    """
    from dummydesign.design.mould import tolerances_of

    tolerances = tolerances_of(inputs.space.resin, pad.candidate, inputs.request, shape)
    beyond = beyond_people(inputs.request, inputs.tissue)
    return with_castings(pad, inputs.space, inputs.castings, tolerances, beyond)


def solved_by_predict(state: State) -> bool:
    """Whether ``predict`` solves the pad of a state: a shape outside its table, under a flat punch on a glued base."""
    punch = read_punch(state.punch)
    return state.shape.partition(":")[0] != Slab.name and punch.profile_mm is None
