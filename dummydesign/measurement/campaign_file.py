"""Read and write a campaign folder: campaign.toml and one trace file per trial."""

from __future__ import annotations

import shlex
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, errors_within, unknown_name
from dummydesign.core.toml_schema import TomlTable
from dummydesign.core.user_library import toml_table
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import ball_profile, read_profile
from dummydesign.geometry.shape_registry import read_shape, shape_kinds
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.measurement.campaign import Campaign, PadSpec, PunchSpec, Trial, check_edge, held_force
from dummydesign.measurement.pad_record import Records, pad_with_record, trial_with_record
from dummydesign.measurement.ramp_detection import ramp_of
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import read_trace

FILE = "campaign.toml"
TRIAL_NUMBERS = {
    "thickness_mm": (0.5, 200.0),
    "thickness_sd_mm": (0.0, 10.0),
    "design_thickness_mm": (0.5, 200.0),
    "witness_kPa": (0.5, 5000.0),
    "witness_sd_kPa": (0.0, 2500.0),
    "weighed_ratio": (0.0, 1000.0),
    "weighed_ratio_sd": (0.0, 100.0),
    "velocity_mm_s": (0.001, 5000.0),
    "hold_s": (0.0, 1e5),
    "target_force_N": (0.0, 2000.0),
    "rest_s": (0.0, 1e9),
    "temperature_C": (-20.0, 80.0),
    "age_days": (0.0, 36500.0),
    "target_depth_mm": (0.0, 200.0),
}
TRIAL_REQUIRED = ("thickness_mm", "velocity_mm_s")
PUNCHES = ("square", "round", "ball", "profile", "plate")
PUNCH_KEYS = {"punch", "side_mm", "diameter_mm", "contact", "edge_radius_mm"}
_TRIAL_KEYS = {"file", "repeat", "sequence", "shape", "unload", "record", *TRIAL_NUMBERS}


def read_campaign_toml(folder: Path) -> TomlTable:
    """Read the campaign file of a folder, unchecked."""
    try:
        text = (folder / FILE).read_text(encoding="utf-8-sig")
        return TomlTable(tomllib.loads(text), folder / FILE, text)
    except FileNotFoundError:
        raise InputError(
            f"campaign folder '{folder}' has no {FILE}; 'dummydesign campaign new' makes one",
            "file_not_found",
            "campaign",
        ) from None
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError(f"{FILE}: cannot be read as UTF-8 text: {problem}", "file_unreadable", "campaign") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{FILE}: not valid TOML: {problem}", "malformed", "campaign") from None


ODD, ODD_SHARE = ("inconsistent", "implausible_unit"), 0.1
"""Faults of a trace for which it is left out, and the share of presses up to which: more is a fault of the campaign."""


def trial_tables(top: TomlTable) -> list[TomlTable]:
    """Return the table of each trial of a campaign file."""
    trials = top.data.get("trial")
    if not isinstance(trials, list) or not trials or not all(isinstance(trial, dict) for trial in trials):
        raise InputError(f"{FILE}: has no [[trial]]", "missing", "campaign.trials")
    return top.tables("trial")


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
        speed, force and thickness; up to a tenth of them are left out with a warning), fewer than two trials.
    """
    folder = Path(folder)
    if folder.is_file():
        raise InputError(
            f"campaign '{folder}' is a file; give its folder: {shlex.quote(str(folder.parent))}",
            "file_not_found",
            "campaign",
            str(folder),
        )
    if not folder.is_dir():
        raise InputError(f"campaign folder '{folder}' does not exist", "file_not_found", "campaign")
    top = read_campaign_toml(folder)
    if top.data.get("schema") != 1:
        raise top.fault("schema", "is not known; this version reads schema = 1", "unsupported", 1)
    for name in ("pad", "punch", "sensor"):
        if isinstance(top.data.get(name), list):
            raise InputError(
                f"{top.where(name)}: a campaign has one [{name}]; make a campaign of each", "malformed", name
            )
    records = Records(folder)
    pad_table, punch_table, sensor = (top.table(name, required=False) for name in ("pad", "punch", "sensor"))
    own = records.of(pad_table)
    pad = _read_pad(pad_table if own is None else pad_with_record(pad_table, own))
    punch = _read_punch(punch_table, folder)
    if (pad.shape == "cylinder") != (punch.shape == "plate"):
        words = f"with pad shape '{pad.shape}'; a plate presses a cylinder, any other punch any other pad"
        raise punch_table.fault("shape", words, "conflict")
    lowpass, resolution = _read_sensor(sensor)
    tables = trial_tables(top)
    if len(tables) < 2:
        raise InputError(
            f"{tables[0].where()}: a single trial; a modulus and two relaxation arms need at least two "
            "trials (two depths or speeds), and repeats to know the noise",
            "not_enough_data",
            "campaign.trials",
            1,
        )
    measured = [records.of(table) or own for table in tables]
    tables = [trial_with_record(table, one) if one else table for table, one in zip(tables, measured)]
    tables, read_as = read_otherwise(top, tables)
    trials, kept, odd = [], [], []
    for index, table in enumerate(tables, 1):
        try:
            trials.append(_read_trial(table, index, folder, pad, punch, lowpass))
            kept.append(table)
        except InputError as problem:
            odd.append(problem)
            if problem.code not in ODD or len(odd) > ODD_SHARE * len(tables):
                raise odd[0] from None
    left_out = [{"code": "press_left_out", "message": f"left out: {problem}"} for problem in odd]
    check_edge(pad, punch, [trial.geometry for trial in trials], f"{punch_table.where('edge_radius_mm')}: ")
    warnings = (*left_out, *no_ratio(pad.ratio), *_check_set(trials, kept), *records.warnings(), *read_as)
    name = str(top.data.get("name", folder.name))
    return Campaign(name, folder, pad, punch, lowpass, resolution, tuple(trials), warnings, tuple(records.read))


OWN_KEYS = {"lowpass_hz": (0.1, 1e5), "zero_N": (-100.0, 100.0)}
"""What a press may have of its own beside the sheet: the cut-off of its sensor, and a reading that is its zero."""
PAD_KEYS = (
    "thickness_mm",
    "thickness_sd_mm",
    "design_thickness_mm",
    "shape",
    "witness_kPa",
    "witness_sd_kPa",
    "weighed_ratio",
    "weighed_ratio_sd",
)
"""What of a trial belongs to its pad."""
READ_AS_KEYS = ("thickness_mm", "velocity_mm_s", *OWN_KEYS, "confirmed")
_READ_AS = ("files", "pad_of", "exchanged", *READ_AS_KEYS)


def read_otherwise(top: TomlTable, tables: list[TomlTable]) -> tuple[list[TomlTable], list[dict[str, str]]]:
    """The trials as the tables ``[[read_as]]`` read them, and a warning for each table."""
    by_file = {str(table.data.get("file")): table for table in tables}
    given = top.tables("read_as") if "read_as" in top.data else []
    warnings = []
    for own in given:
        keys = {key: value for key, value in own.only(_READ_AS).data.items() if key != "files"}
        if not keys:
            raise own.fault("files", f"needs what is read otherwise: {', '.join(_READ_AS[1:])}", "unknown_key")
        listed = own.data.get("files")
        files = listed if isinstance(listed, list) else [listed]
        names = [*files, *([keys["pad_of"]] if "pad_of" in keys else [])]
        for name in names:
            if name not in by_file:
                raise unknown_name("file", str(name), tuple(by_file), quantity="read_as").within(own.where("files"))
        chosen = [by_file[str(name)] for name in files]
        changes = {key: value for key, value in keys.items() if key in READ_AS_KEYS}
        if "exchanged" in keys:
            if len(chosen) != 2:
                raise own.fault("exchanged", "needs two files", "malformed", len(chosen))
            one, two = (table.data for table in chosen)
            one["file"], two["file"] = two["file"], one["file"]
            changes = {"confirmed": True, **changes}
        if "pad_of" in keys:
            changes |= {key: by_file[keys["pad_of"]].data.get(key) for key in PAD_KEYS}
        for table in chosen:
            table.data.update(changes)
            for key in [key for key, value in table.data.items() if value is None]:
                del table.data[key]
        words = ", ".join(f"{key} = {value}" for key, value in keys.items())
        warnings.append({"code": "read_as", "message": f"as campaign.toml asks, {', '.join(names)}: {words}"})
    return tables, warnings


def geometry_of(text: str, where: str) -> PadShape:
    """The shape of a pad on a base as typed; its lengths are checked where the thickness is known.

    ``where`` begins the message of an InputError.
    """
    kinds = shape_kinds()
    name = text.partition(":")[0].lower()
    if name not in kinds:
        raise unknown_name("shape", text, ("cylinder", *kinds)).within(where)
    if name != Slab.name and ":" not in text:
        wanted = ",".join(f"{one}=.." for one in kinds[name].needed())
        raise InputError(
            f"{where}: shape = '{text}' has no lengths; give shape = \"{name}:{wanted}\"", "missing", "shape", text
        )
    with errors_within(where):
        return read_shape(text)


def _read_pad(table: TomlTable) -> PadSpec:
    young = table.number("young_kPa_nominal", None, low=0.5, high=5000.0)
    resin = table.data.get("resin")
    if young is None and resin is None:
        raise table.fault("young_kPa_nominal", "is missing: give it, or resin and ratio", "missing")
    text = str(table.data.get("shape", Slab.name))
    shape = text if text == "cylinder" else "slab"
    geometry = geometry_of(text, table.where("shape")) if shape == "slab" else Slab()
    diameter = table.number("diameter_mm", None, low=2.0, high=500.0)
    if shape == "cylinder" and diameter is None:
        raise table.fault("diameter_mm", "is missing: a cylinder needs it", "missing")
    base = _read_interface(table, "base", (*BASES, FRICTION))
    ratio = table.number("ratio", None, low=0.0, high=1000.0)
    length, width = (table.number(key, None, low=5.0, high=2000.0) for key in ("length_mm", "width_mm"))
    return PadSpec(young, None if resin is None else str(resin), ratio, shape, length, width, diameter, base, geometry)


def _read_interface(table: TomlTable, key: str, known: tuple[str, ...]) -> str:
    value = str(table.data.get(key, "bonded"))
    if value not in known and not Interface.names_friction(value):
        raise unknown_name(key, value, known, quantity=f"{table.name}.{key}").within(table.where(key))
    return value


def _read_punch(table: TomlTable, folder: Path) -> PunchSpec:
    shape = table.string("shape", "square", PUNCHES)
    side, diameter = (table.number(key, None, low=1.0, high=200.0) for key in ("side_mm", "diameter_mm"))
    needed = {"square": "side_mm", "round": "diameter_mm", "ball": "diameter_mm"}.get(shape)
    if needed and needed not in table:
        raise table.fault(needed, f"is missing: the punch is {shape}", "missing")
    profile = ball_profile(diameter) if shape == "ball" else None
    if shape == "profile":
        profile = read_profile(folder / _read_file_name(table, folder))
    contact = _read_interface(table, "contact", (*CONDITIONS, FRICTION))
    return PunchSpec(shape, side, diameter, contact, profile, table.number("edge_radius_mm", 0.0, low=0.0, high=100.0))


def _read_sensor(table: TomlTable) -> tuple[Lowpass | None, float]:
    cutoff = table.number("lowpass_hz", None, low=0.1, high=1e5)
    resolution = table.number("force_resolution_N", 0.0, low=0.0, high=10.0)
    if cutoff is None:
        return None, resolution
    order, passes = table.count("lowpass_order", 2), table.count("lowpass_passes", 1)
    with errors_within(table.where("lowpass_hz")):
        return Lowpass(cutoff, order, passes), resolution


def _read_trial(
    table: TomlTable, number: int, folder: Path, pad: PadSpec, punch: PunchSpec, lowpass: Lowpass | None
) -> Trial:
    if of_punch := [key for key in table.data if key in PUNCH_KEYS]:
        words = "in a trial: a campaign has one [punch]; join campaigns by 'dummydesign loop --prior'"
        raise table.fault(of_punch[0], words, "not_applicable")
    table.only((*sorted(_TRIAL_KEYS), *OWN_KEYS, "confirmed"))
    numbers = {key: table.number(key, None, low=low, high=high) for key, (low, high) in TRIAL_NUMBERS.items()}
    for key in TRIAL_REQUIRED:
        table.number(key)
    geometry = _trial_geometry(table, pad, punch)
    name = _read_file_name(table, folder)
    if not (folder / name).is_file():
        raise table.fault(
            "file", "does not exist in the campaign folder: put it there, or take its [[trial]] out", "file_not_found"
        )
    trace = read_trace(folder / name, numbers["velocity_mm_s"])
    declared: dict[str, Any] = {key: value for key, value in numbers.items() if key != "target_depth_mm"}
    repeat, sequence = table.count("repeat", 1), table.count("sequence", number)
    own = {key: table.number(key, None, low=low, high=high) for key, (low, high) in OWN_KEYS.items()}
    if own["zero_N"]:
        trace = replace(trace, force_N=trace.force_N - own["zero_N"])
    if own["lowpass_hz"]:
        usual = lowpass or Lowpass(own["lowpass_hz"])
        declared["lowpass"] = Lowpass(own["lowpass_hz"], usual.order, usual.passes)
    declared["confirmed"] = table.data.get("confirmed", False) is True
    trial = Trial(file=name, repeat=repeat, sequence=sequence, trace=trace, geometry=geometry, **declared)
    _check_against_declared(trial, table)
    return trial


def _check_against_declared(trial: Trial, table: TomlTable) -> None:
    """Refuse magnitudes that can only be another unit, seen against the thickness, speed and force in its table."""
    trace, ramp = trial.trace, ramp_of(trial.trace)
    deepest = float(trace.displacement_mm.max())
    if deepest >= 0.95 * trial.thickness_mm:
        raise InputError(
            f"{table.where('thickness_mm')}: {trial.file} presses {deepest:g} mm into a pad of "
            f"{trial.thickness_mm:g} mm; is displacement_mm or thickness_mm in another unit, or was it another pad?",
            "inconsistent",
            "trial.thickness_mm",
            trial.thickness_mm,
        )
    if trial.target_force_N:
        held = held_force(trace, ramp)
        share = held / trial.target_force_N
        if share > 100 or share < 0.01:
            unit = "millinewtons: --units force=mN" if share > 100 else "kilonewtons: --units force=kN"
            raise InputError(
                f"{trial.file}: force_N is {held:g} in the hold, the target at "
                f"{table.where('target_force_N')} is {trial.target_force_N:g} N; it looks like {unit} of "
                "'dummydesign import' reads them",
                "implausible_unit",
                "force_N",
                held,
            )
    if not 0.02 < ramp.velocity_mm_s / trial.velocity_mm_s < 20.0:
        raise InputError(
            f"{table.where('velocity_mm_s')}: velocity_mm_s = {trial.velocity_mm_s:g}, but {trial.file} "
            f"moves at {ramp.velocity_mm_s:.4g} mm/s; is the speed in m/s, or the time of the trace in "
            "another unit (--units time=ms of 'dummydesign import' reads milliseconds)?",
            "inconsistent",
            "trial.velocity_mm_s",
            trial.velocity_mm_s,
        )


def _trial_geometry(table: TomlTable, pad: PadSpec, punch: PunchSpec) -> PadShape:
    """The shape of a trial's pad, its own or that of [pad], fitting its thickness."""
    where, geometry = table.where("shape"), pad.geometry
    if "shape" in table:
        if pad.shape == "cylinder":
            raise table.fault("shape", "in a campaign of pucks, which have diameter_mm only", "not_applicable")
        geometry = geometry_of(str(table.data["shape"]), where)
    if geometry.plain:
        return geometry
    if punch.profile_mm is not None:
        raise InputError(
            f"{where}: shape {geometry} is pressed by a flat punch, not by a {punch.shape}",
            "conflict",
            "trial.shape",
            str(geometry),
        )
    with errors_within(where):
        geometry.check(table.data["thickness_mm"], pad.length_mm or PAD_LENGTH_MM, pad.width_mm or PAD_WIDTH_MM)
    return geometry


def _read_file_name(table: TomlTable, folder: Path) -> str:
    """Read ``file``, a plain file name inside the campaign folder."""
    name = table.data.get("file")
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{table.where('file')}: 'file' is missing", "missing", f"{table.name}.file")
    outside = "/" in name or "\\" in name or name in (".", "..") or Path(name).is_absolute() or "\0" in name
    if outside or not (folder / name).resolve().is_relative_to(folder.resolve()):
        raise table.fault("file", "leaves the campaign folder; give a plain file name inside it", "not_allowed")
    return name


def no_ratio(ratio: float | None) -> tuple[dict[str, str], ...]:
    """Warn of a campaign whose modulus leads to no recipe."""
    if ratio is not None:
        return ()
    message = (
        "the campaign has no mixing ratio, so 'suggest' cannot use its calibration: give --resin and --ratio, "
        f"or write ratio into [pad] of {FILE}"
    )
    return ({"code": "no_ratio", "message": message},)


def _check_set(trials: Sequence[Trial], tables: Sequence[TomlTable]) -> list[dict[str, str]]:
    """Refuse files and sequence numbers that are used twice; return what is missing for some tests."""
    for key in ("file", "sequence"):
        seen: dict[Any, int] = {}
        for index, (trial, table) in enumerate(zip(trials, tables)):
            value = getattr(trial, key)
            if value in seen and key in table:
                raise table.fault(key, f"is already used by trial {seen[value] + 1}", "duplicate")
            seen[value] = index
    warnings = []
    if not any("sequence" in table for table in tables):
        message = "no sequence is given: the order of the file is taken as the order of the trials"
        warnings.append({"code": "no_sequence", "message": message})
    for key in ("temperature_C", "age_days", "rest_s"):
        if any(getattr(trial, key) is None for trial in trials):
            message = f"{key} is not given for every trial: effects that need it cannot be tested"
            warnings.append({"code": f"no_{key}", "message": message})
    return warnings


@dataclass(frozen=True)
class SetUp:
    """Pad, punch and sensor of a campaign.

    ``young_kPa``, or ``resin`` and ``ratio``; ``pad`` is ``150x120`` or ``cylinder:50``; ``shape`` that of a pad on a
    base, as typed; ``punch`` is ``square:14``, ``round:16``, ``ball:12``, ``profile:FILE`` or ``plate``;
    ``edge_radius_mm`` is the fillet of its edge; ``base`` and ``contact`` as in the campaign format. ``shapes`` are
    those of the pads by their thickness [mm], where they differ; they stand in each trial.
    """

    name: str
    young_kPa: float | None = None
    resin: str | None = None
    ratio: float | None = None
    pad: str = "150x120"
    punch: str = "square:14"
    base: str = "bonded"
    contact: str = "bonded"
    lowpass: Lowpass | None = None
    force_resolution_N: float = 0.01
    shape: str = "slab"
    edge_radius_mm: float = 0.0
    shapes: tuple[tuple[float, str], ...] = ()

    def shape_of(self, thickness_mm: float) -> str:
        """The shape of the pad of this thickness."""
        return dict(self.shapes).get(thickness_mm, self.shape)

    @property
    def profile(self) -> Path | None:
        """File of the punch's profile, to be copied into the campaign; None for other punches."""
        kind, _, name = self.punch.partition(":")
        return Path(name) if kind == "profile" else None

    def tables(self) -> dict[str, dict[str, Any]]:
        """``pad``, ``punch`` and ``sensor`` as the file holds them."""
        if self.young_kPa is None and (self.resin is None or self.ratio is None):
            raise InputError("say what the pads are: --young KPA, or --resin NAME with --ratio R", "missing", "young")
        material = {"young_kPa_nominal": self.young_kPa, "resin": self.resin, "ratio": self.ratio}
        pad: dict[str, Any] = {key: value for key, value in material.items() if value is not None}
        kind, _, size = self.pad.partition(":")
        if cylinder := kind == "cylinder":
            pad |= {"shape": "cylinder", "diameter_mm": _sizes(size, 1, "pad", self.pad, "cylinder:50")[0]}
        else:
            length, width = _sizes(self.pad.removeprefix("slab:"), 2, "pad", self.pad, "150x120")
            pad |= {"length_mm": length, "width_mm": width}
        for key, name, known in (("base", self.base, BASES), ("contact", self.contact, CONDITIONS)):
            if name not in known and not Interface.names_friction(name):
                raise InputError(
                    f"{key} '{name}' is not one of {', '.join((*known, FRICTION))}",
                    "unknown_name",
                    key,
                    name,
                    (*known, FRICTION),
                )
        pad["base"] = self.base
        if not cylinder and self.shape != "slab":
            pad["shape"] = str(geometry_of(self.shape, "shape"))
        sensor: dict[str, Any] = {"force_resolution_N": self.force_resolution_N}
        if self.lowpass is not None:
            low = self.lowpass
            sensor |= {"lowpass_hz": low.cutoff_hz, "lowpass_order": low.order, "lowpass_passes": low.passes}
        return {"pad": pad, "punch": self._punch(cylinder), "sensor": sensor}

    def _punch(self, cylinder: bool) -> dict[str, Any]:
        shape, _, size = ("plate" if cylinder and self.punch == "square:14" else self.punch).partition(":")
        if shape not in PUNCHES or (shape == "plate") != cylinder:
            message = "a pad is pressed by square:SIDE, round:DIAMETER, ball:DIAMETER or profile:FILE, a puck by plate"
            raise InputError(f"punch '{self.punch}': {message}", "malformed", "punch", self.punch)
        if cylinder and self.shape != "slab":
            raise InputError(
                f"shape {self.shape} with a cylinder: a puck has a diameter only", "conflict", "shape", self.shape
            )
        if shape == "profile" and not size:
            raise InputError(
                f"punch '{self.punch}': give the file, profile:FILE with columns r_mm,z_mm",
                "missing",
                "punch",
                self.punch,
            )
        punch: dict[str, Any] = {"shape": shape}
        if shape == "profile":
            punch["file"] = Path(size).name
        elif shape != "plate":
            key = "side_mm" if shape == "square" else "diameter_mm"
            punch[key] = _sizes(size, 1, "punch", self.punch, f"{shape}:14")[0]
        punch["contact"] = self.contact
        return punch | ({"edge_radius_mm": self.edge_radius_mm} if self.edge_radius_mm else {})


def campaign_toml(set_up: SetUp, trials: Iterable[Mapping[str, Any]], comments: Iterable[str] = ()) -> str:
    """Write a campaign file; a trial's value of None becomes a commented line to fill in.

    Parameters
    ----------
    set_up : SetUp
        Name, pad, punch and sensor.
    trials : iterable of mapping
        Keys and values of each trial.
    comments : iterable of str
        Lines at the top of the file.
    """
    content = {"schema": 1, "name": set_up.name, **set_up.tables()}
    if listed := [dict(trial) for trial in trials]:
        content["trial"] = listed
    return "".join(f"# {text}\n" for text in comments) + toml_table(content)


def _sizes(text: str, count: int, what: str, given: str, form: str) -> list[float]:
    try:
        sizes = [float(part) for part in text.lower().split("x")]
    except ValueError:
        sizes = []
    if len(sizes) != count or not all(1.0 <= size <= 2000.0 for size in sizes):
        raise InputError(f"{what} '{given}' must have the form {form}, in mm", "malformed", what, given)
    return sizes
