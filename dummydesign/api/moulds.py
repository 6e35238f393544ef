"""The calls that make a mould and keep what was cast in it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from os import fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Result, question
from dummydesign.core.errors import InputError, NoAnswerError, unknown_name
from dummydesign.core.files import FilePath
from dummydesign.core.parsing import LENGTH, WIDTH, read_number

if TYPE_CHECKING:
    from dummydesign.mold.model.spec import MouldSpec


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
    thickness_mm : float or str
        Thickness of the pad, needed but for pucks. [mm]
    length_mm, width_mm : float
        Size of the pad. [mm]
    shape : str
        ``slab``, ``crowned``, ``puck``, ..., with its lengths.
    preset : str
        ``open``, ``lidded``, ``printed`` (no silicone) or a TOML file.
    resin : str, optional
        Name or file of the resin to weigh; the paper's polyurethane by default.
    ratio, base_ratio : float
        Mixing ratio, and that of a layered pad's base (by default from its modulus ratio).
    count : int
        Cavities side by side in one mould, as many as the machines hold.
    face_sheet_mm : float, optional
        Thickness of a sheet of glass let into the master as the tested face; the preset's by default, 0 for none. [mm]
    out : path, optional
        Folder of the files, ``mould_tMM`` by default; the next free number when it holds another answer.
    replace : bool
        Take the place of the other answer instead.
    puck : str, optional
        Witness pucks instead of a pad, ``"50x30"`` (diameter x height) or several, comma-separated: the printed rings
        they are cast in, one pour sheet with the protocol of the test. Takes a preset of printed moulds. [mm]
    paper : str
        Of pour sheet and drawings: ``A4`` or ``A3``.
    machine, silicone : str, optional
        Machines that the mould must fit, and its silicone, names or files; those of the preset by default.

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
    from dummydesign.core.outputs import new_folder
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
    asked = question("mold", {**inputs, "specification": spec.hash}, resin=resin, preset=preset)
    with new_folder(folder, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, "sources": list(spec.sources)}
        try:
            made = make_mold(spec, output.work, paper=paper)
            mould = dataclasses.replace(made, files=output.settled(made.files))
        except NoAnswerError as reason:
            result = output.settled({**head, **reason.result})
            raise NoAnswerError(reason.code, output.settled(str(reason)), result, reason.quantity) from None
        output.extra["hash"] = spec.hash
        output.extra["summary"] = {name: inputs[name] for name in ("shape", "thickness_mm", "ratio", "resin", "preset")}
        result = output.answer({**head, **mould.to_dict(), "spec": spec.to_dict()})
    # Memory differs from run to run; the same question shall get the same answer but for seconds.
    del result["memory_MB"]
    return Result(mould, result, "make_mould")


def _make_pucks(
    puck: str, preset: str, resin: str | None, ratio: float, out: FilePath | None, replace: bool, paper: str
) -> Result:
    from dummydesign.core.outputs import new_folder
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
    asked = question("mold", {**inputs, "specification": spec.hash}, resin=resin, preset=spec.preset)
    with new_folder(folder, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, "sources": list(spec.sources)}
        try:
            made = make_puck_rings(spec, output.work, paper=paper)
            rings_made = dataclasses.replace(made, files=output.settled(made.files))
        except NoAnswerError as reason:
            result = output.settled({**head, **reason.result})
            raise NoAnswerError(reason.code, output.settled(str(reason)), result, reason.quantity) from None
        output.extra["hash"] = spec.hash
        output.extra["summary"] = {name: inputs[name] for name in ("ratio", "resin", "preset")}
        result = output.answer({**head, **rings_made.to_dict(), "spec": spec.to_dict()})
    return Result(rings_made, result, "make_mould")


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
    folder : path
        What ``mold`` or ``suggest`` wrote.
    thicknesses_mm : iterable of float, or mapping of str to float
        By the names of the pour sheet's gauge points, ``{"tip": 4.51, "shoulder": 2.49, ...}``; of a flat pad also
        without names at five places or more. [mm]
    mass_g : float
        Of the trimmed pad. [g]
    modulus_kPa : float, optional
        Modulus of the witness puck, from ``resins add-compression``. [kPa]
    level_deg : float, optional
        As read when the mould was filled. [deg]
    bubbles : int, optional
        Over 1 mm, under the punch.
    gauge_mm : float, optional
        Standard error of the thickness gauge on a gel, 0.05 by default. [mm]
    note : str
        Anything else, kept with the record.
    replace : bool
        Take the place of the first record instead of the next free number.
    modulus_error_kPa : float, optional
        Standard error of the witness's modulus. [kPa]
    weighed_g : mapping of str to float, optional
        Masses of the liquids that were weighed in, ``{"polyol": 174.1, "isocyanate": 26.1}``. [g]
    scale_g : float, optional
        Limit of the scale's error, 0.1 by default. [g]

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
