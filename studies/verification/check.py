"""One verified number: what is expected and from where, what was found, and the tolerance."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One verified number; ``tolerance`` is relative unless ``absolute``, ``one_sided`` asks for at least expected."""

    group: str
    name: str
    expected: float
    computed: float
    tolerance: float
    source: str
    absolute: bool = False
    one_sided: bool = False

    @property
    def deviation(self) -> float:
        """Difference to what is expected, relative unless absolute."""
        difference = self.computed - self.expected
        return difference if self.absolute else difference / self.expected

    @property
    def passed(self) -> bool:
        """Whether the deviation is within the tolerance."""
        if self.one_sided:
            return self.deviation >= -self.tolerance
        return abs(self.deviation) <= self.tolerance
