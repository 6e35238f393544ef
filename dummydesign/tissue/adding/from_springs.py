"""Tissues that are one spring constant with its spread, as standards give for body regions: one, or a table of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, errors_within, out_of_range, quantity_name, unknown_name
from dummydesign.core.files import write_text
from dummydesign.core.parsing import QuantitySpec, read_number
from dummydesign.core.quantity import KINDS, Quantity
from dummydesign.tissue.adding.from_traces import reserve, tissue_folder
from dummydesign.tissue.adding.observations import read_rows
from dummydesign.tissue.model.laws import SPRING
from dummydesign.tissue.model.maxwell_law import Parameters
from dummydesign.tissue.model.tissue import Subject, Tissue
from dummydesign.tissue.model.tissue_file import tissue_toml

STIFFNESS = QuantitySpec("stiffness in N/mm", "N/mm", (0.05, 1000.0))
SPREAD = QuantitySpec("spread in N/mm", "N/mm", (0.0, 1000.0))
NAME = "k_N_per_mm"
COLUMNS = ("region", "stiffness_N_per_mm", "spread_N_per_mm", "source")
REGIONS = (
    "forehead",
    "face",
    "neck",
    "back",
    "chest",
    "abdomen",
    "pelvis",
    "upper-arm",
    "lower-arm",
    "hand",
    "thigh",
    "lower-leg",
)
"""Rows of the template; a user names his own."""


def add_spring(
    name: str,
    stiffness: float | str,
    spread: float | str | None,
    source: str,
    kind: str = "digitised",
    replace_own: bool = False,
) -> dict[str, Any]:
    """Make a tissue of one spring constant and keep it in the user's folder."""
    tissue = spring_tissue(name, stiffness, spread, source, kind)
    inputs = {
        "action": "add-spring",
        "name": name,
        "stiffness_N_per_mm": stiffness,
        "spread_N_per_mm": spread,
        "source": source,
        "kind": kind,
    }
    path, warnings = _keep(tissue, replace_own)
    return {"inputs": inputs, **tissue.to_dict(), "warnings": warnings, "files": {"tissue": str(path)}}


def spring_tissue(name: str, stiffness: float | str, spread: float | str | None, source: str, kind: str) -> Tissue:
    """The tissue of a spring constant: its softest, middle and stiffest person, or one without a spread."""
    if not source.strip():
        message = f"tissue '{name}' has no source; say where its spring constant was read"
        raise InputError(message, "no_source", "source")
    if kind not in KINDS:
        raise unknown_name("kind", kind, KINDS)
    value = read_number(stiffness, STIFFNESS)
    if not STIFFNESS.usual[0] <= value <= STIFFNESS.usual[1]:
        raise out_of_range("stiffness in N/mm", f"{value:g}", *STIFFNESS.usual)
    width = _width(value, spread)
    if not 0.0 <= width < value:
        raise out_of_range("spread in N/mm", f"{width:g}", 0, f"below the stiffness, {value:g}")
    people = {"softest": value - width, "middle": value, "stiffest": value + width} if width else {"one": value}
    subjects = tuple(
        Subject(who, Parameters("spring", k, (), ()), {NAME: Quantity(k, k, k, kind, f"{source} ({who})")})
        for who, k in people.items()
    )
    title, notes = f"spring constant of {value:g} N/mm", (f"{SPRING.notice_of(name)[1]}.",)
    return Tissue(name, title, "spring", subjects, (source,), notes, "user")


def write_template(path: str) -> dict[str, Any]:
    """Write the table that a user fills from a copy of a standard; it holds no number."""
    if Path(path).exists():
        raise InputError(f"file '{path}' exists; give another name", "file_exists", "template", path)
    write_text(Path(path), "\n".join([",".join(COLUMNS), *(f"{region},,," for region in REGIONS), ""]))
    return {"inputs": {"action": "template", "path": path}, "regions": list(REGIONS), "files": {"template": path}}


def add_regions(table: str, replace_own: bool = False) -> dict[str, Any]:
    """Make a tissue of every filled row of a template; nothing is kept when one row is wrong."""
    path = Path(table)
    made: list[Tissue] = []
    for row in read_rows(path, "regions", COLUMNS):
        region, stiffness, spread, source = (row.text(column) for column in COLUMNS)
        if not stiffness:
            continue
        with errors_within(f"{path.name}:{row.line}"):
            tissue_folder(region)
            if region.lower() in {one.name.lower() for one in made}:
                raise InputError(f"region '{region}' is listed twice", "duplicate", "region", region)
            made.append(spring_tissue(region, stiffness, spread or None, source, "digitised"))
    if not made:
        message = f"{path.name}: no row has a stiffness_N_per_mm; fill the regions that you need"
        raise InputError(message, "missing", "stiffness_N_per_mm")
    for tissue in made:
        reserve(tissue.name, replace_own)
    kept = [_keep(tissue, replace_own) for tissue in made]
    return {
        "inputs": {"action": "add-regions", "table": table},
        "added": [{"name": one.name, NAME: [p.gamma1_N_per_mm3 for p in one.parameter_sets]} for one in made],
        "warnings": [warning for _, warnings in kept for warning in warnings],
        "files": {one.name: str(file) for one, (file, _) in zip(made, kept)},
    }


def _keep(tissue: Tissue, replace_own: bool) -> tuple[Path, list[dict[str, str]]]:
    path, hidden = reserve(tissue.name, replace_own)
    return write_text(path, tissue_toml(tissue)), tissue.warnings + hidden


def _width(value: float, spread: float | str | None) -> float:
    if spread is None:
        return 0.0
    if isinstance(spread, str) and spread.strip().endswith("%"):
        try:
            return 0.01 * float(spread.strip()[:-1]) * value
        except ValueError:
            message = f"spread = '{spread}' is not a number of percent"
            raise InputError(message, "not_a_number", quantity_name(SPREAD.quantity), spread) from None
    return read_number(spread, SPREAD)
