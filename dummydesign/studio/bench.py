"""What the sliders of the design page ask: one pad against the tissue, with what is read from files kept at hand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from dummydesign.core.errors import InputError
from dummydesign.design.sweep.one_pad import OnePad, law_of_shape, one_pad, with_castings
from dummydesign.geometry.shapes import PadShape, Slab, read_shape

if TYPE_CHECKING:
    from dummydesign.design.inputs import Inputs
    from dummydesign.design.scoring.verdict import Verdict

LENGTHS = {"crowned": "20,2,9", "bumped": "5,2.91,1.24,0.34", "layered": "3,3", "boned": "10,2,9"}
"""Lengths that a kind of shape begins with on the page, until a search found better ones."""


@dataclass(frozen=True)
class Asked:
    """What is chosen above the sliders; names, or paths from the project folder on."""

    tissue: str
    aim: str
    resin: str
    calibration: str = ""


@lru_cache(maxsize=8)
def inputs_of(root: Path, asked: Asked, stamp: tuple[float, ...]) -> Inputs:
    """Read tissue, resin and calibration; ``stamp`` are the times of the files, so that changed ones are read anew.

    Parameters
    ----------
    root : Path
        The project folder.
    asked : Asked
    stamp : tuple of float
        From :func:`stamp_of`.
    """
    from dummydesign.design.inputs import resolve
    from dummydesign.design.request import Request

    calibration = str(root / asked.calibration) if asked.calibration else None
    return resolve(
        Request(_path(root, asked.tissue), asked.aim, _path(root, asked.resin), shape="slab", verify=False,
                calibration=calibration)
    )  # fmt: skip


def stamp_of(root: Path, asked: Asked) -> tuple[float, ...]:
    """Times of the files that stand behind what is chosen; 0 for names of the library."""
    found = []
    for name in (asked.tissue, asked.resin, asked.calibration):
        path = root / name
        found.append(path.stat().st_mtime if name and path.is_file() else 0.0)
    return tuple(found)


def _path(root: Path, name: str) -> str:
    return str(root / name) if name.endswith(".toml") else name


def shape_of(text: str) -> PadShape:
    """The shape of a text such as ``crowned:20,2,9``; ``slab`` without lengths."""
    return Slab() if text.strip().lower() == "slab" else read_shape(text.strip())


def look(inputs: Inputs, shape: PadShape, thickness_mm: float, ratio: float) -> OnePad:
    """Press one pad.

    Parameters
    ----------
    inputs : Inputs
    shape : PadShape
    thickness_mm, ratio : float
        The pad. [mm, resin's ratio]

    Raises
    ------
    InputError
        When the pad cannot be made, or a calibration is of slabs only.
    """
    if inputs.request.calibration and not shape.plain:
        raise InputError("a calibration is of flat slabs: choose the shape slab, or no calibration")
    inputs.space.resin.check_ratio(ratio)
    law = law_of_shape(inputs.slab_law, shape, thickness_mm, inputs.request.pad_mm)
    return one_pad(law, inputs.space, thickness_mm, ratio)


def settled(inputs: Inputs, shape: PadShape, pad: OnePad) -> Verdict:
    """The verdict with what castings of the pad may turn out as, by the same tolerances as ``suggest``.

    Parameters
    ----------
    inputs : Inputs
    shape : PadShape
    pad : OnePad
    """
    from dummydesign.design.assessment.pour_yield import Tolerances
    from dummydesign.design.mould import pour_recipe

    recipe = pour_recipe(inputs.space.resin, pad.candidate, inputs.request, shape)
    poured = sum(mass for name, mass in recipe if not name.endswith("(base)"))
    request = inputs.request
    return with_castings(pad, inputs.space, Tolerances(poured, request.weighing_g, request.thickness_tolerance_mm))
