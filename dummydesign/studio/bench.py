"""What the sliders of the design page ask: one pad against the tissue, with what is read from files kept at hand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from dummydesign.design.inputs import Inputs
    from dummydesign.design.scoring.verdict import Verdict

LENGTHS = {"crowned": "20,2,9", "bumped": "5,2.91,1.24,0.34", "layered": "3,3", "boned": "10,2,9"}
"""Lengths that a kind of shape begins with on the page, until a search found better ones."""
NO_SLIDER = "it is solved by finite elements, which a slider cannot wait for; the search below does"


@dataclass(frozen=True)
class Asked:
    """What is chosen above the sliders; names, or paths from the project folder on."""

    tissue: str
    aim: str
    resin: str
    calibration: str = ""
    punch: str = PUNCH


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
    request = Request(_path(root, asked.tissue), asked.aim, _path(root, asked.resin), shape="slab", verify=False,
                      calibration=calibration, punch=_punch(root, asked.punch))  # fmt: skip
    punch = read_punch(request.punch)
    if punch.profile_mm is not None:
        raise InputError(f"{why_solved(request, punch, THICKNESS_MM[0])}: {NO_SLIDER}")
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
            paths.append(find(f"materials/{kind}", what, _path(root, name)).path)
        except InputError:
            continue
    stamps = [(path, path.stat()) for path in paths if path.is_file()]
    return tuple((str(path), stat.st_mtime_ns, stat.st_size) for path, stat in stamps)


def _path(root: Path, name: str) -> str:
    return str(root / name) if name.endswith(".toml") else name


def _punch(root: Path, text: str) -> str:
    return f"{PROFILE}{root / text.removeprefix(PROFILE)}" if text.startswith(PROFILE) else text


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
        When the pad cannot be made, or pads of its shape are not designed under this punch.
    """
    request, space = inputs.request, inputs.space
    refused = refused_kinds(request, inputs.punch).get(shape.name)
    if refused:
        raise InputError(refused)
    if not request.calibration and (why := why_solved(request, inputs.punch, thickness_mm)):
        raise InputError(f"{why}: {NO_SLIDER}")
    space.resin.check_ratio(ratio)
    law = law_of_shape(inputs.slab_law, shape, thickness_mm, request.pad_mm, space.correct)
    return one_pad(law, space, thickness_mm, ratio)


def settled(inputs: Inputs, shape: PadShape, pad: OnePad) -> Verdict:
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
