"""What was really poured: the record of a cast pad, written by ``dummydesign mold record`` and read by campaigns."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, errors_within
from dummydesign.core.files import reading
from dummydesign.core.toml_schema import TomlTable

SCHEMA = "dummydesign.pad/1"
STEM = "record"


@dataclass(frozen=True)
class PadRecord:
    """A cast pad as measured beside what was designed.

    ``thickness_mm`` is the thickness as the pad's force law means it: the mean of a flat pad's ``thicknesses_mm``, the
    reading at the tip of any other. ``thickness_sd_mm`` is the standard error of the thickness at a place between those
    gauged, :func:`thickness_error`. ``points`` are the names of the gauge points, empty for a plain list.
    ``young_kPa`` is the witness's modulus, None where none was tested, ``young_sd_kPa`` its standard error, None where
    it was not given. ``weighed_ratio`` is the ratio that the weighed masses make, with its standard error.
    ``cast_shape`` is the shape with the height of the crown that was gauged, empty where it may be the designed one;
    ``force_sd_percent`` is what the gauge's error leaves of ``force_percent``, None of a pad without a crown.
    ``missed`` are the limits of acceptance that the pad fails, in words.
    """

    specification: str
    shape: str
    length_mm: float
    width_mm: float
    resin: str
    ratio: float
    design_thickness_mm: float
    thicknesses_mm: tuple[float, ...]
    thickness_mm: float
    thickness_sd_mm: float
    mass_g: float
    design_young_kPa: float | None = None
    young_kPa: float | None = None
    level_deg: float | None = None
    bubbles: int | None = None
    accepted: bool = True
    force_percent: float | None = None
    missed: tuple[str, ...] = ()
    note: str = ""
    limits: tuple[dict[str, Any], ...] = field(default=(), compare=False)
    points: tuple[str, ...] = ()
    young_sd_kPa: float | None = None
    weighed_ratio: float | None = None
    weighed_ratio_sd: float | None = None
    cast_shape: str = ""
    force_sd_percent: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values, with the schema first."""
        return {"schema": SCHEMA, **asdict(self)}

    def warnings(self) -> list[dict[str, str]]:
        """Which limits the pad missed and what that makes of the force; empty for one that was accepted."""
        if not self.missed:
            return []
        change = self.force_percent
        force = "" if change is None else f"; its force at a given depth is {change:+.1f} % off the designed pad's"
        return [{"code": "pad_not_accepted", "message": f"{self.title} missed {', '.join(self.missed)}{force}"}]

    @property
    def title(self) -> str:
        """The pad in a few words."""
        return f"pad of {self.thickness_mm:.3g} +- {self.thickness_sd_mm:.2g} mm (mould {self.specification})"


def thickness_error(thicknesses_mm: tuple[float, ...], gauge_mm: float) -> float:
    """Standard error of the thickness at a place of the pad that was not gauged. [mm]

    ``s sqrt(1 + 1/n)`` of n places with sample standard deviation s, together with the gauge's own error.
    """
    n = len(thicknesses_mm)
    mean = sum(thicknesses_mm) / n
    spread = sum((one - mean) ** 2 for one in thicknesses_mm) / (n - 1)
    return math.sqrt(spread * (1 + 1 / n) + gauge_mm**2)


def read_record(path: str | Path) -> PadRecord:
    """Read the record of a pad."""
    path = Path(path)
    with reading("pad record", path, "record"):
        text = path.read_text(encoding="utf-8")
    try:
        data = json.loads(text)
    except ValueError as problem:
        raise InputError(f"pad record '{path}' cannot be read: {problem}", "file_unreadable", "record") from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise InputError(
            f"'{path}' is not a pad's record; 'dummydesign mold record' writes one", "file_unreadable", "record"
        )
    try:
        record = PadRecord(
            str(data["specification"]),
            str(data["shape"]),
            _length(data, "length_mm"),
            _length(data, "width_mm"),
            str(data["resin"]),
            float(data["ratio"]),
            _length(data, "design_thickness_mm"),
            tuple(float(one) for one in data["thicknesses_mm"]),
            _length(data, "thickness_mm"),
            float(data["thickness_sd_mm"]),
            _length(data, "mass_g"),
            _optional(data, "design_young_kPa"),
            _optional(data, "young_kPa"),
            _optional(data, "level_deg"),
            data.get("bubbles"),
            bool(data["accepted"]),
            _optional(data, "force_percent"),
            tuple(str(one) for one in data["missed"]),
            str(data.get("note", "")),
            tuple(data.get("limits", ())),
            tuple(str(one) for one in data.get("points", ())),
            _optional(data, "young_sd_kPa"),
            _optional(data, "weighed_ratio"),
            _optional(data, "weighed_ratio_sd"),
            str(data.get("cast_shape", "")),
            _optional(data, "force_sd_percent"),
        )
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(
            f"pad record '{path}' is damaged at {problem}; record the pad again", "malformed", "record"
        ) from None
    if not (record.thicknesses_mm and 0 <= record.thickness_sd_mm < record.thickness_mm):
        sizes = f"thickness {record.thickness_mm:g} mm with an error of {record.thickness_sd_mm:g} mm"
        raise InputError(
            f"pad record '{path}' is damaged: {sizes}; record the pad again",
            "inconsistent",
            "record.thickness_sd_mm",
            record.thickness_sd_mm,
        )
    return record


def _length(data: dict[str, Any], key: str) -> float:
    value = float(data[key])
    if not (math.isfinite(value) and value > 0):
        raise ValueError(f"{key} = {value}")
    return value


def _optional(data: dict[str, Any], key: str) -> float | None:
    return None if data.get(key) is None else float(data[key])


NEAR = 0.1
"""A thickness that is declared beside a record is as designed or as measured to this share, else of another pad."""


def pad_with_record(table: TomlTable, record: PadRecord) -> TomlTable:
    """Fill the table of a campaign's pad with what it leaves out, from the record."""
    puck, data = record.shape == "puck", table.data
    slab = {"shape": record.shape, "length_mm": record.length_mm, "width_mm": record.width_mm}
    known: dict[str, Any] = {"shape": "cylinder", "diameter_mm": record.length_mm} if puck else slab
    for key, value in known.items():
        if key in data and data[key] != value:
            message = f"{table.where('record')}: {key} = {data[key]!r}, but the record is of a pad with {value!r}"
            raise InputError(f"{message}; remove one", "inconsistent", f"pad.{key}", data[key], value)
    if "young_kPa_nominal" not in data and "resin" not in data:
        young = record.young_kPa or record.design_young_kPa
        known |= {"resin": record.resin, "ratio": record.ratio}
        known |= {} if young is None else {"young_kPa_nominal": young}
    return replace(table, data={**data, **known})


def trial_with_record(table: TomlTable, record: PadRecord) -> TomlTable:
    """Fill the table of a trial with thickness and its error as the record has them."""
    given, where = table.data.get("thickness_mm"), table.where("record")
    near = [record.thickness_mm, record.design_thickness_mm]
    if given is not None and not (
        isinstance(given, int | float) and any(abs(given / thickness - 1) <= NEAR for thickness in near)
    ):
        raise InputError(
            f"{where}: thickness_mm = {given!r}, but the record is of a pad of {near[0]:.4g} mm (designed "
            f"{near[1]:g}); name the record of this pad",
            "inconsistent",
            "trial.thickness_mm",
            given,
        )
    shape = table.data.get("shape", record.shape)
    if shape != record.shape:
        raise InputError(
            f"{where}: shape = {shape!r}, but the record is of shape {record.shape!r}",
            "inconsistent",
            "trial.shape",
            shape,
            record.shape,
        )
    own = {} if record.shape in ("slab", "puck") else {"shape": record.cast_shape or record.shape}
    measured: dict[str, Any] = {
        key: getattr(record, key) for key in ("thickness_mm", "thickness_sd_mm", "design_thickness_mm")
    }
    batch = {
        "witness_kPa": record.young_kPa,
        "witness_sd_kPa": record.young_sd_kPa,
        "weighed_ratio": record.weighed_ratio,
        "weighed_ratio_sd": record.weighed_ratio_sd,
    }
    if not record.shape.startswith("layered"):
        # a witness of two resins is of one of them
        measured |= {key: value for key, value in batch.items() if value is not None}
    return replace(table, data={**table.data, **own, **measured})


class Records:
    """The records that a campaign names, each read once; paths are those from the campaign's folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.read: dict[Path, PadRecord] = {}

    def of(self, table: TomlTable) -> PadRecord | None:
        """Return the record that a table names with ``record``; None when it names none."""
        name = table.data.get("record")
        if name is None:
            return None
        if not isinstance(name, str) or not name.strip():
            raise InputError(
                f"{table.where('record')}: record = {name!r} must be the path of a pad's record",
                "malformed",
                "record",
                name,
            )
        path = self.folder / name
        if path not in self.read:
            with errors_within(table.where("record")):
                self.read[path] = read_record(path)
        return self.read[path]

    def warnings(self) -> list[dict[str, str]]:
        """Return one warning of each pad that missed a limit of acceptance."""
        return [warning for record in self.read.values() for warning in record.warnings()]
