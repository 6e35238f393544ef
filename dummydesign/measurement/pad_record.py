"""What was really poured: the record of a cast pad, written by ``dummydesign mold record`` and read by campaigns."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_lines import CampaignLines

SCHEMA = "dummydesign.pad/1"
STEM = "record"


@dataclass(frozen=True)
class PadRecord:
    """A cast pad as measured beside what was designed.

    ``thickness_mm`` is the thickness as the pad's force law means it: the mean of a flat pad's ``thicknesses_mm``, the
    reading at the tip of any other. ``thickness_sd_mm`` is the standard error of the thickness at a place between those
    gauged, :func:`thickness_error`. ``points`` are the names of the gauge points, empty for a plain list.
    ``young_kPa`` is the witness's modulus, None where none was tested.
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

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values, with the schema first."""
        return {"schema": SCHEMA, **asdict(self)}

    def warnings(self) -> list[dict[str, str]]:
        """Which limits the pad missed and what that makes of the force; empty for one that was accepted."""
        if not self.missed:
            return []
        change = self.force_percent
        force = "" if change is None else f"; its force at a given depth is {change:+.1f} % off the designed pad's"
        message = f"{self.title} missed {', '.join(self.missed)}{force}"
        return [{"code": "pad_not_accepted", "message": message}]

    @property
    def title(self) -> str:
        """The pad in a few words."""
        return f"pad of {self.thickness_mm:.3g} +- {self.thickness_sd_mm:.2g} mm (mould {self.specification})"


def thickness_error(thicknesses_mm: tuple[float, ...], gauge_mm: float) -> float:
    """Standard error of the thickness at a place of the pad that was not gauged. [mm]

    ``s sqrt(1 + 1/n)`` of n places with sample standard deviation s, together with the gauge's own error.

    Parameters
    ----------
    thicknesses_mm : tuple of float, at least two
        Readings. [mm]
    gauge_mm : float
        Standard error of the gauge on a soft pad. [mm]
    """
    n = len(thicknesses_mm)
    mean = sum(thicknesses_mm) / n
    spread = sum((one - mean) ** 2 for one in thicknesses_mm) / (n - 1)
    return math.sqrt(spread * (1 + 1 / n) + gauge_mm**2)


def read_record(path: str | Path) -> PadRecord:
    """Read the record of a pad.

    Raises
    ------
    InputError
        When the file cannot be read, is no record, or lacks a value.
    """
    path = Path(path)
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise InputError(f"pad record '{path}' cannot be read: {problem}") from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise InputError(f"'{path}' is not a pad's record; 'dummydesign mold record' writes one")
    try:
        record = PadRecord(
            str(data["specification"]), str(data["shape"]), _length(data, "length_mm"), _length(data, "width_mm"),
            str(data["resin"]), float(data["ratio"]), _length(data, "design_thickness_mm"),
            tuple(float(one) for one in data["thicknesses_mm"]), _length(data, "thickness_mm"),
            float(data["thickness_sd_mm"]), _length(data, "mass_g"), _optional(data, "design_young_kPa"),
            _optional(data, "young_kPa"), _optional(data, "level_deg"), data.get("bubbles"), bool(data["accepted"]),
            _optional(data, "force_percent"), tuple(str(one) for one in data["missed"]), str(data.get("note", "")),
            tuple(data.get("limits", ())), tuple(str(one) for one in data.get("points", ())),
        )  # fmt: skip
    except (KeyError, TypeError, ValueError) as problem:
        raise InputError(f"pad record '{path}' is damaged at {problem}; record the pad again") from None
    if not (record.thicknesses_mm and 0 <= record.thickness_sd_mm < record.thickness_mm):
        raise InputError(f"pad record '{path}' is damaged: thickness {record.thickness_mm:g} mm with an error of "
                         f"{record.thickness_sd_mm:g} mm; record the pad again")  # fmt: skip
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


def pad_with_record(table: dict[str, Any], record: PadRecord, where: str) -> dict[str, Any]:
    """The table of a campaign's pad with what it leaves out taken from the record.

    Parameters
    ----------
    table : dict
        ``[pad]`` of the campaign.
    record : PadRecord
        The pad as it was cast.
    where : str
        File and line, for messages.

    Raises
    ------
    InputError
        When the table says otherwise than the record.
    """
    puck = record.shape == "puck"
    known: dict[str, Any] = {"shape": "cylinder" if puck else record.shape}
    known |= {"diameter_mm": record.length_mm} if puck else {"length_mm": record.length_mm, "width_mm": record.width_mm}
    for key, value in known.items():
        if key in table and table[key] != value:
            raise InputError(f"{where}: {key} = {table[key]!r}, but the record is of a pad with {value!r}; remove one")
    if "young_kPa_nominal" not in table and "resin" not in table:
        young = record.young_kPa or record.design_young_kPa
        known |= {"resin": record.resin, "ratio": record.ratio}
        known |= {} if young is None else {"young_kPa_nominal": young}
    return {**table, **known}


def trial_with_record(block: dict[str, Any], record: PadRecord, where: str) -> dict[str, Any]:
    """The table of a trial with thickness and its error as the record has them.

    Parameters
    ----------
    block : dict
        ``[[trial]]`` of the campaign.
    record : PadRecord
        The pad as it was cast.
    where : str
        File and line, for messages.

    Raises
    ------
    InputError
        When the trial names the thickness or the shape of another pad.
    """
    said, wanted = block.get("thickness_mm"), (record.thickness_mm, record.design_thickness_mm)
    if said is not None and not (isinstance(said, int | float) and any(abs(said / one - 1) <= NEAR for one in wanted)):
        raise InputError(
            f"{where}: thickness_mm = {said!r}, but the record is of a pad of {wanted[0]:.4g} mm (designed "
            f"{wanted[1]:g}); name the record of this pad"
        )
    if "shape" in block and block["shape"] != record.shape:
        raise InputError(f"{where}: shape = {block['shape']!r}, but the record is of shape {record.shape!r}")
    own = {} if record.shape in ("slab", "puck") else {"shape": record.shape}
    return {**block, **own, "thickness_mm": record.thickness_mm, "thickness_sd_mm": record.thickness_sd_mm}


class Records:
    """The records that a campaign names, each read once; paths are those from the campaign's folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.read: dict[Path, PadRecord] = {}

    def of(self, table: dict[str, Any], where: str) -> PadRecord | None:
        """The record that a table names with ``record``; None when it names none."""
        name = table.get("record")
        if name is None:
            return None
        if not isinstance(name, str) or not name.strip():
            raise InputError(f"{where}: record = {name!r} must be the path of a pad's record")
        path = self.folder / name
        if path not in self.read:
            try:
                self.read[path] = read_record(path)
            except InputError as problem:
                raise InputError(f"{where}: {problem}") from None
        return self.read[path]

    def trial(self, block: Any, pad: PadRecord | None, place: CampaignLines, index: int) -> Any:
        """A trial's table with its own record's values, else with those of the campaign's pad.

        Parameters
        ----------
        block : dict
            ``[[trial]]`` of the campaign; what is no table is left as it is.
        pad : PadRecord, optional
            The record that ``[pad]`` names.
        place : CampaignLines
            Finds lines for messages.
        index : int
            Number of the trial, from 0.
        """
        if not isinstance(block, dict):
            return block
        where = place.trial(index, "record")
        record = self.of(block, where) or pad
        return block if record is None else trial_with_record(block, record, where)

    def warnings(self) -> list[dict[str, str]]:
        """One of each pad that missed a limit of acceptance."""
        return [warning for record in self.read.values() for warning in record.warnings()]
