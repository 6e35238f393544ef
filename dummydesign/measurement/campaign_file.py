"""Reader of a campaign folder: ``campaign.toml`` and one trace file per trial, read and checked."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.geometry.punch_profile import ball_profile, read_profile
from dummydesign.geometry.shapes import PadShape, Slab, read_shape, shape_kinds
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.measurement.campaign import Campaign, PadSpec, PunchSpec, Trial
from dummydesign.measurement.campaign_checks import check_against_declared, check_edge, check_set
from dummydesign.measurement.campaign_lines import CampaignLines
from dummydesign.measurement.pad_record import PadRecord, Records, pad_with_record
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import read_trace

FILE = "campaign.toml"
TRIAL_NUMBERS = {
    "thickness_mm": (0.5, 200.0),
    "thickness_sd_mm": (0.0, 10.0),
    "velocity_mm_s": (0.001, 5000.0),
    "hold_s": (0.0, 1e5),
    "target_force_N": (0.0, 2000.0),
    "rest_s": (0.0, 1e9),
    "temperature_C": (-20.0, 80.0),
    "age_days": (0.0, 36500.0),
    "target_depth_mm": (0.0, 200.0),
}
TRIAL_REQUIRED = ("thickness_mm", "velocity_mm_s")
PUNCH_KEYS = {"punch", "side_mm", "diameter_mm", "contact", "edge_radius_mm"}
_TRIAL_KEYS = {"file", "repeat", "sequence", "shape", "unload", "record", *TRIAL_NUMBERS}


def read_campaign(folder: str | Path) -> Campaign:
    """Read and check a campaign folder.

    Parameters
    ----------
    folder : path
        Holds ``campaign.toml`` and the trace files named in it.

    Returns
    -------
    Campaign

    Raises
    ------
    InputError
        With file and line: missing files or keys, unknown names, numbers out of range, files outside the
        folder, traces that are unsorted or in another unit (seen by magnitude, also against the declared
        speed, force and thickness), fewer than two trials.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(f"campaign folder '{folder}' does not exist")
    path = folder / FILE
    try:
        text = path.read_text(encoding="utf-8-sig")
        data = tomllib.loads(text)
    except FileNotFoundError:
        raise InputError(f"campaign folder '{folder}' has no {FILE}") from None
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"{FILE}: cannot be read as UTF-8 text: {problem}") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{FILE}: not valid TOML: {problem}") from None
    place = CampaignLines(FILE, text)
    if data.get("schema") != 1:
        raise InputError(f"{FILE}: schema = {data.get('schema')!r}; this version reads schema = 1")
    records = Records(folder)
    own = records.of(_section(data, "pad"), place.section("pad", "record"))
    pad, punch = _pad(data, place, own), _punch(data, place, folder)
    if (pad.shape == "cylinder") != (punch.shape == "plate"):
        raise InputError(
            f"{place.section('punch', 'shape')}: punch '{punch.shape}' with pad shape '{pad.shape}'; "
            "a cylinder is pressed by a plate, any other pad by a square, round, ball or profile punch"
        )
    lowpass, resolution = _sensor(data, place)
    blocks = data.get("trial")
    if not isinstance(blocks, list) or not blocks:
        raise InputError(f"{FILE}: has no [[trial]]")
    if len(blocks) < 2:
        raise InputError(
            f"{place.trial(0)}: a single trial; a modulus and two relaxation arms need at least two trials "
            "(two depths or speeds), and repeats to know the noise"
        )
    warnings: list[dict[str, str]] = []
    blocks = [records.trial(block, own, place, i) for i, block in enumerate(blocks)]
    trials = tuple(_trial(block, i, place, folder, pad, punch) for i, block in enumerate(blocks))
    check_edge(pad, punch, [trial.geometry for trial in trials], f"{place.section('punch', 'edge_radius_mm')}: ")
    check_set(trials, blocks, place, warnings)
    warnings += records.warnings()
    return Campaign(
        str(data.get("name", folder.name)), folder, pad, punch, lowpass, resolution, trials, tuple(warnings),
        tuple(records.read),
    )  # fmt: skip


def _number(table: dict[str, Any], key: str, where: str, low: float, high: float, hint: str = "") -> float | None:
    """Read an optional number within its range."""
    if key not in table:
        return None
    value = table[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{where}: {key} = {value!r} is not a number")
    if not low <= value <= high:
        raise InputError(f"{where}: {key} = {value:g} is outside the allowed range {low:g} to {high:g}{hint}")
    return float(value)


def _choice(table: dict[str, Any], key: str, where: str, known: tuple[str, ...], default: str) -> str:
    value = str(table.get(key, default))
    if value in known or (FRICTION in known and Interface.names_friction(value)):
        return value
    raise InputError(f"{where}: {unknown_name(key, value, known)}")


def _section(data: dict[str, Any], name: str) -> dict[str, Any]:
    table = data.get(name, {})
    if not isinstance(table, dict):
        several = "; a campaign has one, make a campaign of each" if isinstance(table, list) else ""
        raise InputError(f"{FILE}: [{name}] must be a table{several}")
    return table


def geometry_of(text: str, where: str) -> PadShape:
    """The shape of a pad on a base as typed; its lengths are checked where the thickness is known.

    ``where`` begins the message of an InputError.
    """
    kinds = shape_kinds()
    name = text.partition(":")[0].lower()
    if name not in kinds:
        raise InputError(f"{where}: {unknown_name('shape', text, ('cylinder', *kinds))}")
    if name != Slab.name and ":" not in text:
        wanted = ",".join(f"{one}=.." for one in kinds[name].needed())
        raise InputError(f"{where}: shape = '{text}' has no lengths; give shape = \"{name}:{wanted}\"")
    try:
        return read_shape(text)
    except InputError as problem:
        raise InputError(f"{where}: {problem}") from None


def _pad(data: dict[str, Any], place: CampaignLines, record: PadRecord | None) -> PadSpec:
    table = _section(data, "pad")
    if record is not None:
        table = pad_with_record(table, record, place.section("pad", "record"))

    def number(key: str, low: float, high: float, hint: str = "") -> float | None:
        return _number(table, key, place.section("pad", key), low, high, hint)

    young = number("young_kPa_nominal", 0.5, 5000.0, "; the unit is kPa: give 25 kPa as 25.0 (not 0.025 or 25000)")
    resin = table.get("resin")
    if young is None and resin is None:
        raise InputError(f"{place.section('pad')}: [pad] needs young_kPa_nominal, or resin and ratio")
    where = place.section("pad", "shape")
    text = str(table.get("shape", Slab.name))
    shape = text if text == "cylinder" else "slab"
    geometry = geometry_of(text, where) if shape == "slab" else Slab()
    diameter = number("diameter_mm", 2.0, 500.0)
    if shape == "cylinder" and diameter is None:
        raise InputError(f"{place.section('pad')}: a cylinder needs diameter_mm")
    base = _choice(table, "base", place.section("pad", "base"), (*BASES, FRICTION), "bonded")
    return PadSpec(
        young, None if resin is None else str(resin), number("ratio", 0.0, 1000.0), shape,
        number("length_mm", 5.0, 2000.0), number("width_mm", 5.0, 2000.0), diameter, base, geometry,
    )  # fmt: skip


def _punch(data: dict[str, Any], place: CampaignLines, folder: Path) -> PunchSpec:
    table = _section(data, "punch")
    where = place.section("punch", "shape")
    shape = _choice(table, "shape", where, ("square", "round", "ball", "profile", "plate"), "square")
    side = _number(table, "side_mm", place.section("punch", "side_mm"), 1.0, 200.0)
    diameter = _number(table, "diameter_mm", place.section("punch", "diameter_mm"), 1.0, 200.0)
    if shape == "square" and side is None:
        raise InputError(f"{where}: a square punch needs side_mm")
    if shape in ("round", "ball") and diameter is None:
        raise InputError(f"{where}: a {shape}{' punch' if shape == 'round' else ''} needs diameter_mm")
    profile = ball_profile(diameter) if shape == "ball" and diameter else None
    if shape == "profile":
        place_of_file = place.section("punch", "file")
        profile = read_profile(folder / _inside(table.get("file"), "a profile needs file", place_of_file, folder))
    contact = _choice(
        table, "contact", place.section("punch", "contact"), (*CONDITIONS, FRICTION), "bonded"
    )
    edge = _number(table, "edge_radius_mm", place.section("punch", "edge_radius_mm"), 0.0, 100.0)
    return PunchSpec(shape, side, diameter, contact, profile, edge or 0.0)


def _sensor(data: dict[str, Any], place: CampaignLines) -> tuple[Lowpass | None, float]:
    table = _section(data, "sensor")
    where = place.section("sensor", "lowpass_hz")
    cutoff = _number(table, "lowpass_hz", where, 0.1, 1e5)
    resolution = _number(table, "force_resolution_N", place.section("sensor", "force_resolution_N"), 0.0, 10.0)
    if cutoff is None:
        return None, resolution or 0.0
    try:
        lowpass = Lowpass(cutoff, int(table.get("lowpass_order", 2)), int(table.get("lowpass_passes", 1)))
    except (InputError, ValueError, TypeError) as problem:
        raise InputError(f"{where}: {problem}") from None
    return lowpass, resolution or 0.0


def _whole(block: dict[str, Any], key: str, where: str, default: int) -> int:
    value = block.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"{where}: {key} = {value!r} must be a whole number from 1")
    return value


def _trial(
    block: dict[str, Any], index: int, place: CampaignLines, folder: Path, pad: PadSpec, punch: PunchSpec
) -> Trial:
    unknown = sorted(set(block) - _TRIAL_KEYS)
    if PUNCH_KEYS & set(unknown):
        key = next(key for key in unknown if key in PUNCH_KEYS)
        raise InputError(
            f"{place.trial(index, key)}: {key} in a trial: a campaign has one punch, that of [punch]; make a campaign "
            "of each, and join them with 'dummydesign loop --prior'"
        )
    if unknown:
        raise InputError(f"{place.trial(index, unknown[0])}: {unknown_name('key', unknown[0], _TRIAL_KEYS)}")
    numbers: dict[str, Any] = {}
    for key, (low, high) in TRIAL_NUMBERS.items():
        hint = "; the unit is mm: 0.015 m is 15" if key == "thickness_mm" else ""
        numbers[key] = _number(block, key, place.trial(index, key), low, high, hint)
    for key in TRIAL_REQUIRED:
        if numbers[key] is None:
            raise InputError(f"{place.trial(index)}: trial {index + 1} lacks {key}")
    geometry = _trial_geometry(block, index, place, pad, punch, float(numbers["thickness_mm"] or 0.0))
    name = _file_name(block, index, place, folder)
    trace = read_trace(folder / name, numbers["velocity_mm_s"])
    trial = Trial(
        name, **{k: numbers[k] for k in ("thickness_mm", "velocity_mm_s", "hold_s", "target_force_N")},
        repeat=_whole(block, "repeat", place.trial(index, "repeat"), 1),
        sequence=_whole(block, "sequence", place.trial(index, "sequence"), index + 1),
        rest_s=numbers["rest_s"], temperature_C=numbers["temperature_C"], age_days=numbers["age_days"], trace=trace,
        geometry=geometry, thickness_sd_mm=numbers["thickness_sd_mm"],
    )  # fmt: skip
    check_against_declared(trial, index, place)
    return trial


def _trial_geometry(
    block: dict[str, Any], index: int, place: CampaignLines, pad: PadSpec, punch: PunchSpec, thickness_mm: float
) -> PadShape:
    """The shape of a trial's pad, its own or that of [pad], fitting its thickness."""
    where = place.trial(index, "shape")
    geometry = pad.geometry
    if "shape" in block:
        if pad.shape == "cylinder":
            raise InputError(f"{where}: shape = {block['shape']!r} in a campaign of pucks, which have diameter_mm only")
        geometry = geometry_of(str(block["shape"]), where)
    if geometry.plain:
        return geometry
    if punch.profile_mm is not None:
        raise InputError(f"{where}: shape {geometry} is pressed by a flat punch, not by a {punch.shape}")
    try:
        geometry.check(thickness_mm, pad.length_mm or PAD_LENGTH_MM, pad.width_mm or PAD_WIDTH_MM)
    except InputError as problem:
        raise InputError(f"{where}: {problem}") from None
    return geometry


def _file_name(block: dict[str, Any], index: int, place: CampaignLines, folder: Path) -> str:
    where = place.trial(index, "file")
    name = _inside(block.get("file"), f"trial {index + 1} lacks file", where, folder)
    if not (folder / name).is_file():
        raise InputError(f"{where}: trace file '{name}' does not exist in the campaign folder")
    return name


def _inside(name: Any, lacking: str, where: str, folder: Path) -> str:
    """A plain file name inside the campaign folder."""
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{where}: {lacking}")
    outside = "/" in name or "\\" in name or name in (".", "..") or Path(name).is_absolute() or "\0" in name
    if outside or not (folder / name).resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{where}: file = '{name}' leaves the campaign folder; give a plain file name inside it")
    return name
