"""The liquids of a recipe and what follows when they are mixed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from dummydesign.core.quantity import Quantity

MIXED = ("density_g_per_cm3", "viscosity_Pa_s")
"""Properties that follow from the components when the file does not give them for the mixture."""


@dataclass(frozen=True)
class Component:
    """One liquid of a recipe and how much of it to weigh."""

    name: str
    mass_g: float

    def to_dict(self) -> dict[str, Any]:
        """Return name and mass."""
        return {"name": self.name, "mass_g": self.mass_g}


@dataclass(frozen=True)
class Liquid:
    """A component in the can: parts by weight (None: the ratio itself), density, viscosity."""

    name: str
    parts: float | None
    density_g_per_cm3: Quantity
    viscosity_Pa_s: Quantity


def mixed(name: str, liquids: Sequence[Liquid], parts: Sequence[float]) -> Quantity:
    """Density (added volumes) or viscosity (Arrhenius: mean of the logarithms by weight) of a mixture.

    Parameters
    ----------
    name : str
        One of :data:`MIXED`.
    liquids : sequence of Liquid
        The components.
    parts : sequence of float
        Parts by weight of each.
    """
    whole = sum(parts)
    shares = [part / whole for part in parts]
    quantities = [getattr(liquid, name) for liquid in liquids]

    def at(end: str) -> float:
        values = [getattr(quantity, end) for quantity in quantities]
        if name == "density_g_per_cm3":
            return 1.0 / sum(share / value for share, value in zip(shares, values))
        return math.exp(sum(share * math.log(value) for share, value in zip(shares, values)))

    kind = "assumed" if any(quantity.kind == "assumed" for quantity in quantities) else "inferred"
    rule = "added volumes" if name == "density_g_per_cm3" else "mean of logarithms by weight"
    source = f"{rule} of the components: " + "; ".join(dict.fromkeys(q.source for q in quantities))
    return Quantity(at("value"), at("low"), at("high"), kind, source)
