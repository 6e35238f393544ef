"""The interface of two faces: bonded, sliding without friction, or Coulomb friction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from dummydesign.core.errors import InputError

BASES = ("bonded", "sliding")
"""What holds a pad's base that stays on its plate; with ``friction:MU`` it merely rests there and may lift off."""
CONDITIONS = ("bonded", "frictionless")
"""How a punch holds the face it presses, besides ``friction:MU``."""
FACES = ("frictionless", "bonded")
"""The same in the order of the messages."""
FRICTION = "friction:MU"
LARGEST_FRICTION = 5.0


@dataclass(frozen=True)
class Interface:
    """One interface as it is typed: a name, or ``friction`` with its coefficient."""

    name: str
    coulomb: float | None = None

    @staticmethod
    def find(text: str, known: Sequence[str]) -> Interface | None:
        """The interface of a text: one of the ``known`` names or ``friction:MU`` with MU from 0 to 5; else None."""
        if text in known:
            return Interface(text)
        try:
            value = float(text.removeprefix("friction:")) if Interface.names_friction(text) else math.nan
        except ValueError:
            return None
        return Interface("friction", value) if 0.0 <= value <= LARGEST_FRICTION else None

    @staticmethod
    def parse(text: str, quantity: str, known: Sequence[str]) -> Interface:
        """Read an interface.

        Examples
        --------
        >>> Interface.parse("friction:0.3", "base", BASES).coulomb
        0.3
        >>> Interface.parse("sliding", "base", BASES).bonded
        False
        """
        interface = Interface.find(text, known)
        if interface is None:
            raise InputError(
                f"{quantity} '{text}' is not {', '.join(known)} or {FRICTION} with MU from 0 to {LARGEST_FRICTION:g}",
                "unknown_name",
                quantity,
                text,
                (*known, FRICTION),
            )
        return interface

    @staticmethod
    def names_friction(text: str) -> bool:
        """Whether a text begins as ``friction:MU`` does, its coefficient right or not."""
        return text.startswith("friction:")

    @property
    def bonded(self) -> bool:
        """Whether it is glued."""
        return self.name == "bonded"

    @property
    def friction(self) -> float:
        """Coefficient of friction: 0 where it slides freely, infinite where it is glued."""
        if self.bonded:
            return math.inf
        return 0.0 if self.coulomb is None else self.coulomb

    def __str__(self) -> str:
        return self.name if self.coulomb is None else f"friction:{self.coulomb:g}"
