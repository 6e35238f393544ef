"""Tissues that are one spring constant with its spread, as standards give for body regions: one, or a table of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.core.checks import Purpose, read_number
from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.core.files import write_text
from dummydesign.core.own_files import make_room
from dummydesign.core.quantity import KINDS, Quantity
from dummydesign.tissue.model.laws.spring import spring_words
from dummydesign.tissue.model.parameters import Parameters
from dummydesign.tissue.model.tissue import Subject, Tissue
from dummydesign.tissue.model.tissue_file import KIND, tissue_toml
from dummydesign.tissue.population.cells import read_cells
from dummydesign.tissue.population.from_traces import tissue_folder

STIFFNESS = Purpose("stiffness in N/mm", "N/mm", (0.05, 1000.0))
SPREAD = Purpose("spread in N/mm", "N/mm", (0.0, 1000.0))
NAME = "k_N_per_mm"
COLUMNS = ("region", "stiffness_N_per_mm", "spread_N_per_mm", "source")
REGIONS = (
    "forehead", "face", "neck", "back", "chest", "abdomen", "pelvis", "upper-arm", "lower-arm", "hand", "thigh",
    "lower-leg",
)  # fmt: skip
"""Rows of the template; a user names his own."""


def add_spring(
    name: str,
    stiffness: float | str,
    spread: float | str | None,
    source: str,
    kind: str = "digitised",
    replace_own: bool = False,
) -> dict[str, Any]:
    """Make a tissue of one spring constant and keep it in the user's folder.

    Parameters
    ----------
    name : str
        Of the tissue.
    stiffness : float or str
        Spring constant, such as ``35`` or ``"35000N/m"``. [N/mm]
    spread : float or str, optional
        Plus and minus, to the softest and the stiffest person, in N/mm or percent (``"20%"``). Without it there is one
        subject, who makes no range.
    source : str
        Where the numbers were read.
    kind : str
        What kind of number it is.
    replace_own : bool
        Take the place of a tissue of the user with this name.

    Raises
    ------
    InputError
        For numbers that are no spring constant, a spread as large as it, or no source.
    """
    tissue = spring_tissue(name, stiffness, spread, source, kind)
    inputs = {"action": "add-spring", "name": name, "stiffness_N_per_mm": stiffness, "spread_N_per_mm": spread,
              "source": source, "kind": kind}  # fmt: skip
    path, warnings = _keep(tissue, replace_own)
    return {"inputs": inputs, **tissue.to_dict(), "warnings": warnings, "files": {"tissue": str(path)}}


def spring_tissue(name: str, stiffness: float | str, spread: float | str | None, source: str, kind: str) -> Tissue:
    """The tissue of a spring constant: its softest, middle and stiffest person, or one without a spread.

    Parameters
    ----------
    name : str
        Of the tissue.
    stiffness, spread, source, kind
        As for :func:`add_spring`.

    Raises
    ------
    InputError
        As :func:`add_spring`.
    """
    if not source.strip():
        raise InputError(f"tissue '{name}' has no source; say where its spring constant was read")
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
    notes = (spring_words(name) + ".",)
    return Tissue(name, f"spring constant of {value:g} N/mm", "spring", subjects, (source,), notes, "user")


def write_template(path: str) -> dict[str, Any]:
    """Write the table that a user fills from a copy of a standard; it holds no number.

    Raises
    ------
    InputError
        When there is a file of this name.
    """
    place = Path(path)
    if place.exists():
        raise InputError(f"file '{path}' exists; give another name")
    rows = "".join(f"{region},,,\n" for region in REGIONS)
    write_text(place, ",".join(COLUMNS) + "\n" + rows)
    return {"inputs": {"action": "template", "path": path}, "regions": list(REGIONS), "files": {"template": path}}


def add_regions(table: str, replace_own: bool = False) -> dict[str, Any]:
    """Make a tissue of every filled row of a template; nothing is kept when one row is wrong.

    Parameters
    ----------
    table : str
        CSV with ``region,stiffness_N_per_mm,spread_N_per_mm,source``; rows without a stiffness are left out.
    replace_own : bool
        Take the place of tissues of the user with these names.

    Raises
    ------
    InputError
        With file and line.
    """
    path = Path(table)
    header, rows = read_cells(path, "regions", skip_space=True)
    missing = [column for column in COLUMNS if column not in header]
    if missing:
        raise InputError(f"{path.name}:1: column '{missing[0]}' is missing; the header must be {','.join(COLUMNS)}")
    made: list[Tissue] = []
    for line, row in rows:
        cells = {column: (row.get(column) or "").strip() for column in COLUMNS}
        if not cells["stiffness_N_per_mm"]:
            continue
        try:
            tissue_folder(cells["region"])
            if cells["region"].lower() in {one.name.lower() for one in made}:
                raise InputError(f"region '{cells['region']}' comes twice")
            made.append(spring_tissue(cells["region"], cells["stiffness_N_per_mm"], cells["spread_N_per_mm"] or None,
                                      cells["source"], "digitised"))  # fmt: skip
        except InputError as problem:
            raise InputError(f"{path.name}:{line}: {problem}") from None
    if not made:
        raise InputError(f"{path.name}: no row has a stiffness_N_per_mm; fill the regions that you need")
    for tissue in made:
        make_room(KIND, "tissue", tissue.name, replace_own)
    kept = [_keep(tissue, replace_own) for tissue in made]
    return {
        "inputs": {"action": "add-regions", "table": table},
        "added": [{"name": one.name, **{NAME: [s.parameters.gamma1_N_per_mm3 for s in one.subjects]}} for one in made],
        "warnings": [warning for _, said in kept for warning in said],
        "files": {one.name: str(place) for one, (place, _) in zip(made, kept)},
    }


def _keep(tissue: Tissue, replace_own: bool) -> tuple[Path, list[dict[str, str]]]:
    folder = tissue_folder(tissue.name)
    said = [{"code": "spring_tissue", "message": spring_words(tissue.name)}]
    said += make_room(KIND, "tissue", tissue.name, replace_own)
    return write_text(folder / f"{tissue.name}.toml", tissue_toml(tissue)), said


def _width(value: float, spread: float | str | None) -> float:
    if spread is None:
        return 0.0
    if isinstance(spread, str) and spread.strip().endswith("%"):
        try:
            return 0.01 * float(spread.strip()[:-1]) * value
        except ValueError:
            raise InputError(f"spread = '{spread}' is not a number of percent") from None
    return read_number(spread, SPREAD)
