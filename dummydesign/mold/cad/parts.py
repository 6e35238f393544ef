"""The parts of a mould, what each is made of, and the tools they were cut with. CAD child only."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from dummydesign.mold.cad.solids import drafted_prism, single_solid
from dummydesign.mold.model.layout import Layout
from dummydesign.mold.model.spec import MouldSpec

CORE_MM = 1.0
"""How far the core of a mould reaches beyond its openings and its height."""


COLOURS = {
    "resin": (0.93, 0.62, 0.50),
    "resin_base": (0.62, 0.36, 0.45),
    "silicone": (0.36, 0.62, 0.74),
    "rigid": (0.72, 0.73, 0.75),
    "glass": (0.62, 0.80, 0.72),
}


@dataclass(frozen=True)
class PartMaterial:
    """What a part is made of: its kind; name, words and density that STEP files carry; words of a title block."""

    kind: str
    name: str
    description: str
    density_g_per_cm3: float
    drawn: str = ""

    @property
    def colour(self) -> tuple[float, float, float]:
        """Colour in STEP files and pictures."""
        return COLOURS[self.kind]


def material_of(spec: MouldSpec, kind: str) -> PartMaterial:
    """What parts of a kind are made of by the specification."""
    if kind == "rigid":
        drawn = spec.plastic.name.upper() if spec.plastic else "rigid plastic"
        return PartMaterial(kind, "printed rigid polymer", "PETG or ASA, density as printed solid", 1.27, drawn)
    if kind == "glass":
        words = "cut to size, density of float glass"
        return PartMaterial(kind, "glass or acrylic sheet", words, 2.5, "float glass or acrylic")
    if kind == "silicone" and spec.silicone is not None:
        name, density = spec.silicone.name, spec.silicone.density_g_per_cm3
        return PartMaterial(kind, name, "mould silicone", density, f"silicone {name}")
    if kind == "resin_base" and spec.base is not None:
        pour = spec.base.pour
        return PartMaterial(kind, f"{pour.resin} base", f"ratio {pour.ratio:.4g}", pour.density_g_per_cm3)
    if kind == "resin":
        name, words = spec.pour.resin, f"ratio {spec.pour.ratio:g}"
        return PartMaterial(kind, name, words, spec.pour.density_g_per_cm3, f"{name}, {words}")
    raise KeyError(kind)


@dataclass(frozen=True)
class Part:
    """One part: its solid in its own frame, what it is made of and where it goes in the assembly."""

    name: str
    solid: Any
    material: PartMaterial
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def is_printed(self) -> bool:
        """Whether it comes from the printer."""
        return self.material.kind == "rigid"

    @cached_property
    def volume_mm3(self) -> float:
        """Volume of the solid."""
        return float(self.solid.Volume())

    @cached_property
    def area_mm2(self) -> float:
        """Surface of the solid."""
        return float(self.solid.Area())

    @cached_property
    def centroid_mm(self) -> tuple[float, float, float]:
        """Its middle of volume."""
        return self.solid.Center().toTuple()


@dataclass
class Parts:
    """All parts of a mould and the tools they were cut with, for the checks.

    ``with_bone`` is the pad with its bone, when it has one; ``whole`` the parts of a
    printed mould in one.
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
        moves = [(point.x_mm - first.x_mm, point.y_mm - first.y_mm, 0.0) for point in self.plan.places]
        return [self.cavity.translate(move) if any(move) else self.cavity for move in moves]

    def add(self, name: str, solid: Any, material: str, offset_mm: tuple[float, float, float] = (0, 0, 0)) -> None:
        """Add one part."""
        self.parts[name] = Part(name, solid, material_of(self.spec, material), offset_mm)

    def solid(self, name: str) -> Any:
        """Solid of a part in its own frame."""
        return self.parts[name].solid
