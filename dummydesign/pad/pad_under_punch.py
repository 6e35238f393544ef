"""What is pressed: a pad with the punch on it, or a puck between plates. Lengths, modulus, relaxation, interfaces."""

from __future__ import annotations

from dataclasses import dataclass

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import positive
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS, PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.material.hyperelastic import HyperelasticLaw, Yeoh
from dummydesign.pad.material.relaxation import PronyTerm

SLAB = Slab()


class _Elastic:
    """What pads and pucks say of their material."""

    law: HyperelasticLaw | None
    young_MPa: float
    poisson: float

    @property
    def shape(self) -> HyperelasticLaw:
        """The hyperelastic law with unit shear modulus."""
        if self.law is None:
            return Yeoh(1.0)
        nearly = self.law.scaled(1.0 / self.law.shear_MPa)
        # Once more: the first division may miss 1 by rounding, and 1 is wanted exactly.
        return nearly.scaled(1.0 / nearly.shear_MPa)

    @property
    def shear_MPa(self) -> float:
        """Long-term shear modulus, E / (2 (1 + nu))."""
        return self.young_MPa / (2.0 * (1.0 + self.poisson))


@dataclass(frozen=True)
class Pad(_Elastic):
    """A pad (a flat slab unless said), its material and the round punch of equal area on it.

    ``young_MPa`` is the long-term modulus; ``prony`` is relative to it. ``law`` is the shape of the
    hyperelastic law (its moduli are scaled), neo-Hookean without it. ``sides_mm`` are the sides of a
    rectangular punch, ``radius_mm`` is then that of the circle of its area.
    ``slab_mm`` are length and width of the slab. ``profile_mm`` holds the radii and heights of a shaped punch.
    ``geometry`` is the pad's own shape; depth is then counted from its highest point, and the modulus is that of
    the resin at the tested face.
    ``edge_radius_mm`` is the fillet of the punch's edge; 0 is sharp, with sides that never touch.
    """

    thickness_mm: float
    young_MPa: float
    radius_mm: float
    prony: tuple[PronyTerm, ...] = ()
    base: str = "bonded"
    condition: str = "bonded"
    poisson: float = 0.5
    extent_mm: float | None = None
    law: HyperelasticLaw | None = None
    sides_mm: tuple[float, float] | None = None
    slab_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM)
    profile_mm: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    geometry: PadShape = SLAB
    edge_radius_mm: float = 0.0

    def __post_init__(self) -> None:
        for name in ("thickness_mm", "young_MPa", "radius_mm"):
            positive(name, getattr(self, name))
        self._check_edge()
        self.geometry.check(self.thickness_mm, *self.slab_mm)
        if self.geometry != SLAB and self.profile_mm is not None:
            message = f"shape {self.geometry} is pressed by a flat punch, not by a profile or plates"
            raise InputError(message, "unsupported", "punch", "profile", "flat")

    def _check_edge(self) -> None:
        """Refuse a fillet that is too large, or that goes with something it is not solved for."""
        if self.edge_radius_mm == 0.0:
            return
        half = min(self.sides_mm) / 2.0 if self.sides_mm else self.radius_mm
        most = LARGEST_EDGE_RADIUS * half
        if not 0.0 <= self.edge_radius_mm <= most * (1.0 + 1e-9):
            raise out_of_range(
                "edge_radius_mm", self.edge_radius_mm, 0, f"{most:.4g}", f"{LARGEST_EDGE_RADIUS:g} of the half-width"
            )
        # A face that slides or rubs round the fillet is followed on slabs only.
        slides = self.geometry == SLAB and Interface.find(self.condition, CONDITIONS) is not None
        other = {
            "punch": "profile" if self.profile_mm else "",
            "shape": "" if self.geometry.axisymmetric else str(self.geometry),
            "condition": "" if slides or self.condition == "bonded" else self.condition,
            "base": "" if self.base in BASES else self.base,
        }
        for name, value in other.items():
            if value:
                raise InputError(
                    f"edge_radius_mm = {self.edge_radius_mm:g} with {name} = {value} is not solved; a fillet goes with "
                    "a flat punch that is glued, on a slab or a round shaped pad whose base is bonded or sliding, or "
                    "that slides or rubs (frictionless, friction:MU) on such a slab; edge radius 0 is the sharp edge",
                    "unsupported",
                    "edge_radius_mm",
                    self.edge_radius_mm,
                )


@dataclass(frozen=True)
class Puck(_Elastic):
    """A cylinder compressed between two plates; depth is how much nearer the plates come.

    ``thickness_mm`` is its height; ``young_MPa``, ``prony`` and ``law`` are as of :class:`Pad`. ``plates`` says how
    they hold both faces: ``frictionless``, ``bonded`` or ``friction:MU``.
    """

    thickness_mm: float
    young_MPa: float
    diameter_mm: float
    prony: tuple[PronyTerm, ...] = ()
    plates: str = "frictionless"
    poisson: float = 0.5
    law: HyperelasticLaw | None = None

    @property
    def radius_mm(self) -> float:
        """Half the diameter. [mm]"""
        return 0.5 * self.diameter_mm

    def __post_init__(self) -> None:
        for name in ("thickness_mm", "young_MPa", "diameter_mm"):
            positive(name, getattr(self, name))
