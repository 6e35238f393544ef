"""The calls that make a mould and keep what was cast in it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping
from os import fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Result, question
from dummydesign.core.errors import InputError, NoAnswerError, unknown_name
from dummydesign.core.files import FilePath
from dummydesign.core.parsing import LENGTH, WIDTH, read_number

if TYPE_CHECKING:
    from dummydesign.mold.model.spec import MouldSpec
    from dummydesign.mold.puck.ring import PuckSpec

SUMMED_UP = ("shape", "thickness_mm", "ratio", "resin", "preset")
"""Inputs that the list of past answers shows."""


def make_mould(
    thickness_mm: float | str | None = None,
    *,
    length_mm: float | str = 150.0,
    width_mm: float | str = 120.0,
    shape: str = "slab",
    preset: str = "open",
    resin: str | None = None,
    ratio: float = 15.0,
    count: int = 1,
    base_ratio: float | None = None,
    face_sheet_mm: float | None = None,
    out: FilePath | None = None,
    replace: bool = False,
    puck: str | None = None,
    paper: str = "A4",
    machine: str | None = None,
    silicone: str | None = None,
) -> Result:
    """Make the silicone mould of a pad: STEP files, printable master and frame, pour sheet, all checked.

    Parameters
    ----------
    thickness_mm : MM
        Thickness of the pad, 3 to 30 mm; required. [mm]

        But for pucks.
    puck : DxH[,DxH..]
        Witness pucks instead of a pad, diameter x height in mm: printed rings.

        With one pour sheet with the protocol of the test. Takes a preset of printed moulds.
    count : N
        Cavities in one mould (default 1).

        Side by side, as many as the machines hold.
    length_mm : MM
        Length of the pad (default 150). [mm]
    width_mm : MM
        Width of the pad (default 120). [mm]
    shape : NAME[:P,..]
        Of the pad: a shape of the package, or ``puck``.
    preset : NAME|FILE
        Mould preset: ``open`` (default), ``lidded``, ``printed`` or a TOML file.
    machine : NAME|FILE
        Printer, vacuum chamber and oven the mould must fit (default: the preset's).
    silicone : NAME|FILE
        Silicone of the mould (default: the preset's).
    resin : NAME|FILE
        Resin to weigh (default the paper's polyurethane).
    ratio : R
        Mixing ratio of the resin (default 15).
    base_ratio : R
        Ratio of a layered pad's base (default: from its modulus ratio).
    face_sheet_mm : MM
        Thickness of a glass sheet that forms the tested face. [mm]

        The preset's by default, 0 for none.
    paper : A4|A3
        Paper of pour sheet and drawings (default A4).
    out : DIR
        Folder for the files (default mould_tMM).

        The next free number when it holds another answer.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).

    Returns
    -------
    Result
        The same as ``dummydesign mold --json`` prints for the same question.

    Raises
    ------
    InputError
        For sizes, names or files that are not allowed.
    NoAnswerError
        Without CAD, or when the mould fails a check; what there is of the answer stands in the error's ``result``.

    Examples
    --------
    CadQuery needs about a minute.

    >>> import dummydesign
    >>> made = dummydesign.make_mould(8, length_mm=60, width_mm=50, out="mould")  # doctest: +SKIP
    >>> {check["verdict"] for check in made.to_dict()["checks"]}  # doctest: +SKIP
    {'pass'}
    """
    from dummydesign.mold.files.drawing_sheet import PAPERS
    from dummydesign.mold.model.preset import mould_spec
    from dummydesign.mold.model.spec import read_kind, read_thickness

    if paper not in PAPERS:
        raise unknown_name("paper", paper, PAPERS)
    if puck is not None:
        if thickness_mm is not None:
            message = "a puck has its height in --puck 50x30; leave thickness_mm out"
            raise InputError(message, "conflict", "thickness_mm")
        pads_only = {
            "length": str(length_mm) not in ("150", "150.0"),
            "width": str(width_mm) not in ("120", "120.0"),
            "shape": shape != "slab",
            "count": count != 1,
            "base_ratio": base_ratio is not None,
            "face_sheet": face_sheet_mm is not None,
            "machine": machine is not None,
            "silicone": silicone is not None,
        }
        if given := [f"--{name.replace('_', '-')}" for name, is_given in pads_only.items() if is_given]:
            message = f"--puck {puck} makes rings of pucks, no pad; leave {', '.join(given)} out"
            raise InputError(message, "conflict", "puck", puck)
        return _make_pucks(puck, preset, resin, ratio, out, replace, paper)
    if thickness_mm is None:
        message = "--thickness is missing: the thickness of the pad in mm, 3 to 30"
        raise InputError(message, "missing", "thickness")
    kind, parameters = read_kind(shape)
    thickness_mm = read_thickness(thickness_mm)
    length_mm, width_mm = read_number(length_mm, LENGTH), read_number(width_mm, WIDTH)

    settings: dict[str, Any] = {
        "preset": preset,
        "resin": resin,
        "ratio": ratio,
        "base_ratio": base_ratio,
        "face_sheet_mm": face_sheet_mm,
        "machines": machine,
        "silicone": silicone,
    }
    spec = mould_spec(thickness_mm, length_mm, width_mm, kind=kind, parameters=parameters, count=count, **settings)
    return _make_one(spec, resin, preset, out, replace, paper)


def _make_one(
    spec: MouldSpec, resin: str | None, preset: str, out: FilePath | None, replace: bool, paper: str
) -> Result:
    from dummydesign.mold.client import make_mold

    folder = Path(out) if out else Path(f"mould_{spec.tag}")
    inputs = {
        "thickness_mm": spec.pad.thickness_mm,
        "length_mm": spec.pad.length_mm,
        "width_mm": spec.pad.width_mm,
        "shape": spec.pad.name,
        "preset": spec.preset,
        "resin": spec.pour.resin,
        "ratio": spec.pour.ratio,
        "ratio_meaning": spec.pour.ratio_meaning,
        "paper": paper,
        "out": str(folder),
    }
    if spec.base is not None:
        inputs |= {"base_ratio": spec.base.pour.ratio, "modulus_ratio_of_base": spec.base.modulus_ratio}
    if spec.count > 1:
        inputs["count"] = spec.count
    if spec.box.face_sheet_mm:
        inputs["face_sheet_mm"] = spec.box.face_sheet_mm
    mould, result = _made(make_mold, spec, folder, inputs, resin, preset, replace)
    # Memory differs from run to run; the same question shall get the same answer but for seconds.
    del result["memory_MB"]
    return Result(mould, result, "make_mould")


def _make_pucks(
    puck: str, preset: str, resin: str | None, ratio: float, out: FilePath | None, replace: bool, paper: str
) -> Result:
    from dummydesign.mold.client import make_puck_rings
    from dummydesign.mold.puck.ring import PRINTED, puck_spec, read_pucks

    rings = read_pucks(puck)
    # the default of pads is a silicone mould
    spec = puck_spec(rings, PRINTED if preset == "open" else preset, resin, ratio)
    folder = Path(out) if out else Path(f"puck_{spec.tag}")
    inputs = {
        "puck": [
            {"diameter_mm": ring.diameter_mm, "height_mm": ring.height_mm, "count": ring.count} for ring in spec.rings
        ],
        "preset": spec.preset,
        "resin": spec.pour.resin,
        "ratio": spec.pour.ratio,
        "ratio_meaning": spec.pour.ratio_meaning,
        "paper": paper,
    }
    return Result(*_made(make_puck_rings, spec, folder, inputs, resin, spec.preset, replace), "make_mould")


def _made(
    make: Callable[..., Any],
    spec: MouldSpec | PuckSpec,
    folder: Path,
    inputs: dict[str, Any],
    resin: str | None,
    preset: str,
    replace: bool,
) -> tuple[Any, dict[str, Any]]:
    """What is made by a specification into a folder of its own, and the answer."""
    from dummydesign.core.outputs import new_folder

    asked = question("mold", {**inputs, "specification": spec.hash}, resin=resin, preset=preset)
    with new_folder(folder, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, "sources": list(spec.sources)}
        try:
            made = make(spec, output.work, paper=inputs["paper"])
            made = dataclasses.replace(made, files=output.settled(made.files))
        except NoAnswerError as reason:
            result = output.settled({**head, **reason.result})
            raise NoAnswerError(reason.code, output.settled(str(reason)), result, reason.quantity) from None
        output.extra["hash"] = spec.hash
        output.extra["summary"] = {name: inputs[name] for name in SUMMED_UP if name in inputs}
        result = output.answer({**head, **made.to_dict(), "spec": spec.to_dict()})
    return made, result


def record_pad(
    folder: FilePath,
    thicknesses_mm: Iterable[float] | Mapping[str, float],
    mass_g: float,
    *,
    modulus_kPa: float | None = None,
    level_deg: float | None = None,
    bubbles: int | None = None,
    gauge_mm: float | None = None,
    note: str = "",
    replace: bool = False,
    modulus_error_kPa: float | None = None,
    weighed_g: Mapping[str, float] | None = None,
    scale_g: float | None = None,
) -> Result:
    """Keep what was really poured in the folder of its mould, and say which limits the pad misses.

    Parameters
    ----------
    folder : DIR
        Folder that mold wrote.
    thicknesses_mm : --thickness NAME=MM,..
        At the gauge points of the pour sheet; of a flat pad also five or more numbers. [mm]

        In Python a mapping, ``{"tip": 4.51, "shoulder": 2.49, ...}``, or a list.
    mass_g : --mass G
        Of the trimmed pad. [g]
    modulus_kPa : KPA
        Of the witness puck, from resins add-compression. [kPa]
    modulus_error_kPa : KPA
        Standard error of that modulus. [kPa]
    weighed_g : NAME=G,..
        Masses of the liquids that were weighed in. [g]

        In Python a mapping, ``{"polyol": 174.1, "isocyanate": 26.1}``.
    scale_g : G
        Limit of the scale's error (default 0.1). [g]
    level_deg : DEG
        As read when the mould was filled. [deg]
    bubbles : N
        Over 1 mm, under the punch.
    gauge_mm : MM
        Standard error of the gauge on a gel (default 0.05). [mm]
    note : TEXT
        Anything else.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).

        Here the first record, instead of the next free number.

    Returns
    -------
    Result
        The same as ``dummydesign mold record --json`` prints; the command ends with status 1 unless ``accepted``.

    Raises
    ------
    InputError
        For a folder that is not a mould's, or values that this pad cannot have.
    """
    from datetime import date

    from dummydesign._version import __version__
    from dummydesign.core.manifest import add_record
    from dummydesign.measurement.pad_record import STEM
    from dummydesign.mold.pour.record import GAUGE_MM, SCALE_G, Measured, read_points, read_spec
    from dummydesign.mold.pour.record import record_pad as judged

    named = thicknesses_mm if isinstance(thicknesses_mm, Mapping) else {}
    values = named.values() if isinstance(thicknesses_mm, Mapping) else thicknesses_mm
    places = tuple(float(one) for one in values)
    gauge = GAUGE_MM if gauge_mm is None else gauge_mm
    spec = read_spec(fspath(folder))
    measured = Measured(
        places,
        mass_g,
        modulus_kPa,
        level_deg,
        bubbles,
        gauge,
        note,
        tuple(named),
        modulus_error_kPa,
        dict(weighed_g or {}),
        SCALE_G if scale_g is None else scale_g,
    )
    judgement = judged(measured, spec, read_points(fspath(folder)))
    content = {**judgement.to_dict(), "gauge_mm": gauge, "version": __version__, "date": date.today().isoformat()}
    path = add_record(Path(folder), STEM, content, ignored=("date", "version"), replace=replace)
    inputs: dict[str, Any] = {
        "folder": str(folder),
        "thicknesses_mm": dict(named) or list(places),
        "mass_g": mass_g,
        "modulus_kPa": modulus_kPa,
        "level_deg": level_deg,
        "bubbles": bubbles,
        "gauge_mm": gauge,
        "note": note,
        "modulus_error_kPa": modulus_error_kPa,
        "weighed_g": None if weighed_g is None else dict(weighed_g),
        "scale_g": scale_g,
    }
    warnings = [{"code": "limit_missed", "message": text} for text in judgement.missed]
    plain = {key: value for key, value in judgement.to_dict().items() if key not in ("schema", *inputs)}
    result = {"inputs": inputs, **plain, "files": {"record": str(path)}, "warnings": warnings, "sources": []}
    return Result(judgement, result, "record_pad")
