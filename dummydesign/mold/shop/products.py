"""Silicones, plastics and machines: data files that a preset names; no CAD."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import find, read_toml
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.quantity import read_quantity
from dummydesign.mold.shop.items import Machines, Plastic, PrintFit, Silicone
from dummydesign.mold.shop.tables import known_keys, named_source, number

_SILICONE = ("density_g_per_cm3", "young_MPa", "shrinkage_percent", "expansion_per_K", "pot_life_min", "cure_time_h")
_PLASTIC = ("service_temperature_C", "density_g_per_cm3")
_CAST_IN = ("expansion_per_K", "young_MPa")
_MACHINES = {
    "printer": ("bed_x_mm", "bed_y_mm", "height_mm", "margin_mm"),
    "vacuum_chamber": ("diameter_mm", "height_mm"),
    "oven": ("shelf_x_mm", "shelf_y_mm", "height_mm"),
}
# What a print may be off by; more is a printer to repair, or another unit.
_FIT = {"gap_per_side_mm": 1.0, "elephant_foot_mm": 1.0, "shrinkage_percent": 3.0}


def _beside(name: str, path: Path, kind: str, what: str) -> Any:
    """Find a data file named in a preset: beside the preset, else in the library."""
    near = path.parent / name
    return find(kind, what, str(near) if name.endswith(".toml") and near.is_file() else name)


def read_silicone(name: str, preset: Path) -> tuple[Silicone, list[str]]:
    """Read a silicone product by name or file; return it and where its numbers come from."""
    entry = _beside(name, preset, "molds/silicones", "silicone")
    data, text = read_toml(entry.path)
    known_keys(data, {"schema", "name", "title", *_SILICONE}, entry.path, text)
    numbers = {key: read_quantity(data, key, entry.path, text) for key in _SILICONE}
    sources = [named_source(f"silicone {key}", quantity) for key, quantity in numbers.items()]
    return Silicone(entry.name, **{key: quantity.value for key, quantity in numbers.items()}), sources


def read_plastic(name: str, preset: Path) -> tuple[Plastic, list[str]]:
    """Read the plastic of the printed parts by name or file; return it and where its numbers come from."""
    entry = _beside(name, preset, "molds/plastics", "plastic")
    data, text = read_toml(entry.path)
    known_keys(data, {"schema", "name", "title", *_PLASTIC, *_CAST_IN}, entry.path, text)
    asked = (*_PLASTIC, *_CAST_IN) if set(_CAST_IN) & set(data) else _PLASTIC
    numbers = {key: read_quantity(data, key, entry.path, text) for key in asked}
    sources = [named_source(f"plastic {key}", quantity) for key, quantity in numbers.items()]
    return Plastic(entry.name, **{key: quantity.value for key, quantity in numbers.items()}), sources


def read_machines(name: str, preset: Path) -> tuple[Machines, list[str]]:
    """Read what the parts must fit and how a print comes out, by name or file; and where its numbers come from."""
    entry = _beside(name, preset, "molds/machines", "machines")
    data, text = read_toml(entry.path)
    known_keys(data, {"schema", "name", "title", "balance_resolution_g", "print_fit", *_MACHINES}, entry.path, text)
    numbers = []
    for table, keys in _MACHINES.items():
        part = data.get(table)
        more = {"layer_mm"} if table == "printer" else set()
        if not isinstance(part, dict) or set(part) - more != set(keys):
            raise InputError(f"{entry.path.name}: table [{table}] needs exactly {', '.join(keys)}")
        numbers += [number(part[key], key, entry.path, text, f"[{table}]") for key in keys]
    if "balance_resolution_g" not in data:
        raise InputError(f"{entry.path.name}: 'balance_resolution_g' is missing")
    resolution = number(data["balance_resolution_g"], "balance_resolution_g", entry.path, text)
    layer = number(data["printer"].get("layer_mm", 0.0), "layer_mm", entry.path, text, "[printer]")
    if not 0 <= layer <= 1:
        raise out_of_range(f"{entry.path.name}: layer_mm", f"{layer:g}", 0, 1)
    fit, sources = _read_fit(data, entry.path, text)
    return Machines(entry.name, resolution, *numbers, layer_mm=layer, fit=fit), sources


def _read_fit(data: dict[str, Any], path: Path, text: str) -> tuple[PrintFit | None, list[str]]:
    """How a print comes out, None where the machines file does not say."""
    if "print_fit" not in data:
        return None, []
    table = data["print_fit"]
    if not isinstance(table, dict):
        raise InputError(f"{path.name}: 'print_fit' must be a table")
    known_keys(table, set(_FIT), path, text)
    found = {key: read_quantity(table, key, path, text) for key in _FIT}
    for key, most in _FIT.items():
        if not 0 <= found[key].value <= most:
            raise out_of_range(f"{path.name}: {key}", f"{found[key].value:g}", 0, f"{most:g}")
    sources = [named_source(f"print {key}", quantity) for key, quantity in found.items()]
    return PrintFit(**{key: quantity.value for key, quantity in found.items()}), sources
