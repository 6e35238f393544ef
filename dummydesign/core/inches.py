"""Inches and pounds-force in tables: names of columns, and the size of each unit in that of the package."""

from __future__ import annotations

from dummydesign.core.parsing import UNITS, one_of

SYSTEMS = ("mm", "in")
"""Units of tables and sheets: millimetre and newton, or inch and pound-force."""
TWINS = {
    "_mm_s": ("_in_s", UNITS["mm/s"]["in/s"]),
    "_mm": ("_in", UNITS["mm"]["in"]),
    "_N": ("_lbf", UNITS["N"]["lbf"]),
}
"""Ending of a name, that of its twin, and the size of the twin's unit in the name's."""


def check_units(units: str) -> None:
    """Refuse another system of units."""
    one_of("units", units, SYSTEMS)


def twin_of(name: str, units: str = "in") -> tuple[str, float]:
    """Name of a column in a system of units, and the size of its unit in that of the package.

    Examples
    --------
    >>> twin_of("displacement_mm"), twin_of("time_s"), twin_of("force_N", "mm")
    (('displacement_in', 25.4), ('time_s', 1.0), ('force_N', 1.0))
    """
    for ending, (other, size) in TWINS.items() if units == "in" else ():
        if name.endswith(ending):
            return name.removesuffix(ending) + other, size
    return name, 1.0


def columns_in(names: tuple[str, ...], header: list[str]) -> tuple[list[int | None], list[float]]:
    """Place of each name in a header (None where it is absent), itself before its twin in inches, and its size."""
    places: list[int | None] = []
    sizes = []
    for name in names:
        twin, size = (name, 1.0) if name in header else twin_of(name)
        places.append(header.index(twin) if twin in header else None)
        sizes.append(size)
    return places, sizes
