"""A campaign as the text of ``campaign.toml``."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.geometry.interface import BASES, CONDITIONS, FRICTION, Interface
from dummydesign.measurement.campaign_file import geometry_of
from dummydesign.measurement.sensor import Lowpass


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
        """``pad``, ``punch`` and ``sensor`` as the file holds them.

        Raises
        ------
        InputError
            Where one of them has another form.
        """
        if self.young_kPa is None and (self.resin is None or self.ratio is None):
            raise InputError("say what the pads are: --young KPA, or --resin NAME with --ratio R")
        pad: dict[str, Any] = {}
        if self.young_kPa is not None:
            pad["young_kPa_nominal"] = self.young_kPa
        if self.resin is not None:
            pad["resin"] = self.resin
        if self.ratio is not None:
            pad["ratio"] = self.ratio
        kind, _, size = self.pad.partition(":")
        cylinder = kind == "cylinder"
        if cylinder:
            pad |= {"shape": "cylinder", "diameter_mm": _sizes(size, 1, "pad", self.pad, "cylinder:50")[0]}
        else:
            length, width = _sizes(self.pad.removeprefix("slab:"), 2, "pad", self.pad, "150x120")
            pad |= {"length_mm": length, "width_mm": width}
        _interface("base", self.base, BASES)
        _interface("contact", self.contact, CONDITIONS)
        pad["base"] = self.base
        if not cylinder and self.shape != "slab":
            pad["shape"] = str(geometry_of(self.shape, "shape"))
        sensor: dict[str, Any] = {"force_resolution_N": self.force_resolution_N}
        if self.lowpass is not None:
            low = self.lowpass.to_dict()
            sensor |= {"lowpass_hz": low["cutoff_hz"], "lowpass_order": low["order"], "lowpass_passes": low["passes"]}
        return {"pad": pad, "punch": self._punch(cylinder), "sensor": sensor}

    def _punch(self, cylinder: bool) -> dict[str, Any]:
        shape, _, size = ("plate" if cylinder and self.punch == "square:14" else self.punch).partition(":")
        if shape not in ("square", "round", "ball", "profile", "plate") or (shape == "plate") != cylinder:
            message = "a pad is pressed by square:SIDE, round:DIAMETER, ball:DIAMETER or profile:FILE, a puck by plate"
            raise InputError(f"punch '{self.punch}': {message}")
        if cylinder and self.shape != "slab":
            raise InputError(f"shape {self.shape} with a cylinder: a puck has a diameter only")
        punch: dict[str, Any] = {"shape": shape}
        if shape == "profile":
            if not size:
                raise InputError(f"punch '{self.punch}': give the file, profile:FILE with columns r_mm,z_mm")
            punch["file"] = Path(size).name
        elif shape != "plate":
            form = f"{shape}:14"
            punch["side_mm" if shape == "square" else "diameter_mm"] = _sizes(size, 1, "punch", self.punch, form)[0]
        punch["contact"] = self.contact
        if self.edge_radius_mm:
            punch["edge_radius_mm"] = self.edge_radius_mm
        return punch


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

    Returns
    -------
    str
        TOML.
    """
    lines = [f"# {text}" for text in comments]
    lines += ["schema = 1", f"name = {json.dumps(set_up.name, ensure_ascii=False)}"]
    for table, entries in set_up.tables().items():
        lines += ["", f"[{table}]", *(f"{key} = {_value(value)}" for key, value in entries.items())]
    for trial in trials:
        lines += ["", "[[trial]]"]
        for key, value in trial.items():
            lines.append(f"# {key} =" if value is None else f"{key} = {_value(value)}")
    return "\n".join(lines) + "\n"


def _interface(what: str, name: str, known: tuple[str, ...]) -> None:
    if name not in known and not Interface.names_friction(name):
        raise InputError(f"{what} '{name}' is not one of {', '.join((*known, FRICTION))}")


def _sizes(text: str, count: int, what: str, given: str, form: str) -> list[float]:
    try:
        sizes = [float(part) for part in text.lower().split("x")]
    except ValueError:
        sizes = []
    if len(sizes) != count or not all(1.0 <= size <= 2000.0 for size in sizes):
        raise InputError(f"{what} '{given}' must have the form {form}, in mm")
    return sizes


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
