"""Silicones, plastics, machines and printed surfaces, read from data files."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

from dummydesign.core.errors import out_of_range
from dummydesign.core.toml_schema import REQUIRED, TomlTable, read_table
from dummydesign.core.user_library import Entry, find

T = TypeVar("T")
PLAIN_GAP_MM = 0.1
"""Gap per side of printed parts where the machines file says nothing of the fit (judgement). [mm]"""


@dataclass(frozen=True)
class Silicone:
    """The product the mould is cast from."""

    name: str
    density_g_per_cm3: float
    young_MPa: float
    shrinkage_percent: float
    expansion_per_K: float
    pot_life_min: float
    cure_time_h: float


@dataclass(frozen=True)
class PrintFit:
    """How a print comes out: gap that two printed parts need on each side, how far the first layer spreads, shrinkage.

    Print files of rigid parts are enlarged by the shrinkage; 0 leaves it to the slicer.
    """

    gap_per_side_mm: float
    elephant_foot_mm: float
    shrinkage_percent: float


@dataclass(frozen=True)
class Machines:
    """What the parts must fit, how finely can be weighed, the printer's layer (0 where not said) and its fit.

    ``bed_diameter_mm`` is that of a round bed, whose sides are it too; 0 for a rectangular one.
    """

    name: str
    balance_resolution_g: float
    bed_x_mm: float
    bed_y_mm: float
    printer_height_mm: float
    bed_margin_mm: float
    chamber_diameter_mm: float
    chamber_height_mm: float
    shelf_x_mm: float
    shelf_y_mm: float
    oven_height_mm: float
    layer_mm: float = 0.0
    fit: PrintFit | None = None
    bed_diameter_mm: float = 0.0

    @property
    def bed_mm(self) -> tuple[float, ...]:
        """Length and width of the printer's bed within its margin, of a round one its diameter. [mm]"""
        sides = (self.bed_diameter_mm,) if self.bed_diameter_mm else (self.bed_x_mm, self.bed_y_mm)
        return tuple(side - 2 * self.bed_margin_mm for side in sides)

    @property
    def gap_mm(self) -> float:
        """Gap on each side between two printed parts that go together. [mm]"""
        return PLAIN_GAP_MM if self.fit is None else self.fit.gap_per_side_mm

    @property
    def elephant_foot_mm(self) -> float:
        """How far the first layer of a print spreads. [mm]"""
        return 0.0 if self.fit is None else self.fit.elephant_foot_mm

    @property
    def print_scale(self) -> float:
        """Size of a print file over that of the part: 1 / (1 - shrinkage of the print)."""
        return 1.0 if self.fit is None else 1.0 / (1.0 - self.fit.shrinkage_percent / 100)


@dataclass(frozen=True)
class Plastic:
    """What the printed parts are made of; expansion and modulus are needed where a pad is cast in it."""

    name: str
    service_temperature_C: float
    density_g_per_cm3: float
    expansion_per_K: float | None = None
    young_MPa: float | None = None


def read_numbers(kind: type[T], table: TomlTable, /, **given: Any) -> T:
    """Make a dataclass of a table: fields that are not given are numbers; those with a default may be left out."""
    wanted = [item for item in fields(kind) if item.name not in given]  # type: ignore[arg-type]
    table.only(item.name for item in wanted)
    numbers = {
        item.name: table.number(item.name, REQUIRED if item.default is MISSING else item.default) for item in wanted
    }
    return kind(**given, **numbers)


def read_quantities(table: TomlTable, keys: Iterable[str], product: str = "") -> tuple[dict[str, Any], list[str]]:
    """Read quantities; return their values and a line for each: what, how much, how sure, from where."""
    quantities = {key: table.quantity(key) for key in keys}
    sources = [
        f"{product}{key} = {one.value:g} ({one.low:g} to {one.high:g}, {one.kind}): {one.source}"
        for key, one in quantities.items()
    ]
    return {key: one.value for key, one in quantities.items()}, sources


# What a print may be off by; more is a printer to repair, or another unit.
_FIT = {"gap_per_side_mm": 1.0, "elephant_foot_mm": 1.0, "shrinkage_percent": 3.0}


def _names(kind: type) -> list[str]:
    return [item.name for item in fields(kind) if item.name != "name"]


def product_file(name: str, preset: Path, what: str) -> Entry:
    """Find a data file named in a preset: beside the preset, else in the library."""
    near = preset.parent / name
    return find(f"molds/{what}s", what, str(near) if name.endswith(".toml") and near.is_file() else name)


def _found(name: str, preset: Path, what: str, keys: Iterable[str]) -> tuple[str, TomlTable]:
    """Find and read a data file named in a preset."""
    entry = product_file(name, preset, what)
    return entry.name, read_table(entry.path, ("schema", "name", "title", *keys), None)


def read_product(kind: type[T], name: str, preset: Path) -> tuple[T, list[str]]:
    """Read a silicone or the plastic of the printed parts by name or file; and where its numbers come from.

    Fields with a default go together: all of them or none.
    """
    what = kind.__name__.lower()
    name, table = _found(name, preset, what, _names(kind))
    optional = [item.name for item in fields(kind) if item.default is not MISSING]  # type: ignore[arg-type]
    given = any(key in table for key in optional)
    keys = [key for key in _names(kind) if given or key not in optional]
    numbers, sources = read_quantities(table, keys, f"{what} ")
    return kind(name, **numbers), sources  # type: ignore[call-arg]


def read_machines(name: str, preset: Path) -> tuple[Machines, list[str]]:
    """Read what the parts must fit and how a print comes out, by name or file; and where its numbers come from."""
    keys = ("balance_resolution_g", "print_fit", "printer", "vacuum_chamber", "oven")
    name, top = _found(name, preset, "machine", keys)
    printer, chamber, oven = (top.table(key) for key in keys[2:])
    is_round = "bed_diameter_mm" in printer
    sides = ("bed_diameter_mm",) * 2 if is_round else ("bed_x_mm", "bed_y_mm")
    printer.only((*sides, "height_mm", "margin_mm", "layer_mm", *([] if is_round else ["bed_diameter_mm"])))
    chamber.only(("diameter_mm", "height_mm"))
    oven.only(("shelf_x_mm", "shelf_y_mm", "height_mm"))
    _check_between_0_and(1.0, "layer_mm", layer := printer.number("layer_mm", 0.0), printer)
    fit, sources = _read_fit(top.table("print_fit")) if "print_fit" in top else (None, [])
    machines = Machines(
        name,
        balance_resolution_g=top.number("balance_resolution_g"),
        bed_x_mm=printer.number(sides[0], above=0.0),
        bed_y_mm=printer.number(sides[1], above=0.0),
        printer_height_mm=printer.number("height_mm"),
        bed_margin_mm=printer.number("margin_mm"),
        layer_mm=layer,
        chamber_diameter_mm=chamber.number("diameter_mm"),
        chamber_height_mm=chamber.number("height_mm"),
        shelf_x_mm=oven.number("shelf_x_mm"),
        shelf_y_mm=oven.number("shelf_y_mm"),
        oven_height_mm=oven.number("height_mm"),
        fit=fit,
        bed_diameter_mm=printer.number("bed_diameter_mm", 0.0),
    )
    return machines, sources


def _check_between_0_and(most: float, key: str, value: float, table: TomlTable) -> None:
    if not 0 <= value <= most:
        raise out_of_range(key, f"{value:g}", 0, f"{most:g}").within(table.where(key))


def _read_fit(table: TomlTable) -> tuple[PrintFit, list[str]]:
    """Read how a print comes out."""
    fit, sources = read_quantity_table(PrintFit, table, "print ")
    for key, most in _FIT.items():
        _check_between_0_and(most, key, getattr(fit, key), table)
    return fit, sources


def read_quantity_table(kind: type[T], table: TomlTable, product: str) -> tuple[T, list[str]]:
    """Make a dataclass of a table of quantities; return it and where its numbers come from."""
    table.only(_names(kind))
    numbers, sources = read_quantities(table, _names(kind), product)
    return kind(**numbers), sources


@dataclass(frozen=True)
class Surface:
    """Remaining depth of the layers' valleys, and the draft: ``least_draft_deg`` and so much more per depth."""

    depth_mm: float
    least_draft_deg: float
    draft_deg_per_mm: float

    @property
    def draft_needed_deg(self) -> float:
        """Draft with which a rigid wall lets go of a part that has filled its valleys. [deg]"""
        return self.least_draft_deg + self.draft_deg_per_mm * self.depth_mm
