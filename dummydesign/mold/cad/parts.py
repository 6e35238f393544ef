"""The parts of a mould and what they were cut with. CAD child only."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from dummydesign.mold.cad.solids import drafted_prism, single_solid
from dummydesign.mold.model.layout import Layout
from dummydesign.mold.model.spec import MouldSpec

CORE_MM = 1.0
"""How far the core of a mould reaches beyond its openings and its height."""


@dataclass(frozen=True)
class Part:
    """One part: its solid in its own frame, what it is made of and where it goes in the assembly."""

    name: str
    solid: Any
    material: str
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @cached_property
    def volume_mm3(self) -> float:
        """Volume of the solid."""
        return float(self.solid.Volume())


@dataclass
class Parts:
    """All parts of a mould and the tools they were cut with, for the checks.

    ``with_bone`` is the pad with its bone, when it has one; ``whole`` the parts of a printed mould in one.
    """

    spec: MouldSpec
    plan: Layout
    pad_nominal: Any
    parts: dict[str, Part] = field(default_factory=dict)
    tools: dict[str, list[Any]] = field(default_factory=dict)
    hull: Any = None
    with_bone: Any = None
    whole: Any = None
    _core: tuple[Any, Any] = (None, None)

    @property
    def cavity(self) -> Any:
        """What fills the mould up to the fill plane: the pad, and its bone when it has one."""
        return self.solid("pad") if self.with_bone is None else self.with_bone

    @property
    def mould(self) -> Any:
        """The mould that the pad is cast in, a printed one as if it had no joint."""
        return self.solid("mould") if self.whole is None else self.whole

    @property
    def core(self) -> Any:
        """The mould around its cavities: all that a pad meets on its way out, without the label's many faces."""
        if self._core[0] is not self.mould:
            spec, plan = self.spec, self.plan
            high = plan.height_mm + 2 * CORE_MM
            room = drafted_prism(plan.openings.grown(CORE_MM), high, 0.0, -spec.body.floor_mm - CORE_MM)
            self._core = self.mould, single_solid(self.mould.intersect(room))
        return self._core[1]

    @property
    def cavities(self) -> list[Any]:
        """What fills each cavity of the mould; :attr:`cavity` is the first of them."""
        first = self.plan.places[0]
        moves = [(place.x_mm - first.x_mm, place.y_mm - first.y_mm, 0.0) for place in self.plan.places]
        return [self.cavity.translate(move) if any(move) else self.cavity for move in moves]

    def add(self, name: str, solid: Any, material: str, offset_mm: tuple[float, float, float] = (0, 0, 0)) -> None:
        """Add one part."""
        self.parts[name] = Part(name, solid, material, offset_mm)

    def solid(self, name: str) -> Any:
        """Solid of a part in its own frame."""
        return self.parts[name].solid
