"""A user's limits of force and pressure, and how contacts stand beside them.

The form is that of ISO/TS 15066:2016, annex A. The limits themselves are user data with their source; none are
built in.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity, line_of, read_quantity
from dummydesign.design.assessment.safety import Contact

N_PER_CM2 = 100.0


@dataclass(frozen=True)
class Limits:
    """A user's limits at one site, each with source: force [N] and pressure [N/cm2], and the transient factor."""

    name: str
    force_N: Quantity
    pressure_N_per_cm2: Quantity
    transient_factor: Quantity

    def to_dict(self) -> dict[str, Any]:
        """Return all numbers with interval, kind and source."""
        return asdict(self)


def read_limits(path: str | Path) -> Limits:
    """Read a limits file: ``name`` and the three numbers, each with value, low, high, kind, source.

    Raises
    ------
    InputError
        When the file cannot be read, a number lacks its source, or a name is not known.
    """
    from dummydesign.core.datafiles import read_toml

    path = Path(path)
    table, text = read_toml(path)
    names = ("force_N", "pressure_N_per_cm2", "transient_factor")
    for key in table:
        if key not in ("schema", "name", *names):
            known = ", ".join(("name", *names))
            raise InputError(f"{path.name}:{line_of(text, key)}: unknown key '{key}'; known are {known}")
    return Limits(str(table.get("name", path.stem)), *(read_quantity(table, name, path, text) for name in names))


def against_limits(contact: Contact, area_mm2: float, limits: Limits) -> list[dict[str, Any]]:
    """Compare contacts with limits: one row a criterion, with the largest value over the bodies.

    Pressure is the mean over the punch, F / A.

    Parameters
    ----------
    contact : Contact
        Forces of one or several bodies.
    area_mm2 : float
        Area of the punch. [mm2]
    limits : Limits
        Largest force and pressure of the body region, and the factor for transient contact.

    Returns
    -------
    list of dict
    """
    rows = []
    for criterion, limit, factor in (
        ("force_N", limits.force_N.value, 1.0),
        ("mean_pressure_N_per_cm2", limits.pressure_N_per_cm2.value, N_PER_CM2 / area_mm2),
    ):
        for kind, values, scale in (
            ("quasi-static", contact.held_force_N, 1.0),
            ("transient", contact.peak_force_N, limits.transient_factor.value),
        ):
            known = values[np.isfinite(values)]
            value = float(known.max()) * factor if len(known) else None
            allowed = limit * scale
            within = None if value is None else value <= allowed
            rows.append({"criterion": criterion, "contact": kind, "value": value, "limit": allowed, "within": within})
    return rows
