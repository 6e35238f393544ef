"""Shapes of pads: one description for the finite-element model, the mould, the command line and the design.

A pad stands on a rigid base plane and has its full thickness at its highest point, over the origin. Its
tested face lies ``drop_mm(x, y)`` below that point; a rigid bone fills the pad from the base up to
``bone_mm(x, y)``. Both are heights over the plane, so the gel is never undercut. A layered pad has two
moduli, one above the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields
from typing import ClassVar

import numpy as np

from dummydesign.core.errors import InputError, out_of_range, unknown_name

Array = np.ndarray

# Castability, workshop judgement (docs/mould.md): what a printed master can show and a gel survives.
SMALLEST_TIP_MM = 1.0
SMALLEST_HEIGHT_MM = 0.3
THINNEST_GEL_MM = 1.5
THINNEST_COVER_MM = 2.0
STEEPEST_TOP_DEG = 70.0
STEEPEST_BONE_DEG = 60.0
RIM_FREE_MM = 8.0
# Pockets deeper than this share of their diameter keep their air.
DEEPEST_POCKET = 0.3
MODULUS_RATIO = (0.05, 20.0)


@dataclass(frozen=True)
class Conic:
    """A cap with a conic profile: apex radius R, height c, foot radius b; a sphere, a paraboloid, a rounded cone.

    sag(r) = r^2 / (R (1 + sqrt(1 - e r^2 / R^2))) with e = (2 R c - b^2) / c^2, so that sag(b) = c. e = 1 is a
    sphere, 0 a paraboloid, below 0 a hyperboloid that comes near to a cone.
    """

    radius_mm: float
    height_mm: float
    foot_mm: float

    @property
    def factor(self) -> float:
        """The e of the profile: 1 for a sphere, 0 a paraboloid, below 0 a hyperboloid."""
        return (2.0 * self.radius_mm * self.height_mm - self.foot_mm**2) / self.height_mm**2

    def sag_mm(self, r_mm: Array) -> Array:
        """Drop below the apex at a radius; held at ``height_mm`` beyond the foot."""
        r = np.minimum(np.abs(np.asarray(r_mm, dtype=float)), self.foot_mm)
        root = np.sqrt(np.maximum(1.0 - self.factor * (r / self.radius_mm) ** 2, 0.0))
        # Exactly the height from the foot on: rounding must not leave a bone of -1e-15 mm there.
        return np.where(r < self.foot_mm, r**2 / (self.radius_mm * (1.0 + root)), self.height_mm)

    @property
    def foot_slope_deg(self) -> float:
        """Slope of the profile where it meets the flat."""
        root = 1.0 - self.factor * (self.foot_mm / self.radius_mm) ** 2
        # sag'(b) = b / (R sqrt(root)); where the root's branch ends the profile is vertical.
        return float(np.degrees(np.arctan2(self.foot_mm, self.radius_mm * np.sqrt(max(root, 0.0)))))

    def check(self, what: str, steepest_deg: float) -> None:
        """Refuse what is no cap or too steep.

        Raises
        ------
        InputError
            Naming the quantity, its value and what is allowed.
        """
        if not all(np.isfinite(value) for value in (self.radius_mm, self.height_mm, self.foot_mm)):
            raise InputError(f"{what}: radius, height and foot must be finite numbers")
        if self.radius_mm < SMALLEST_TIP_MM:
            raise InputError(f"{what} radius = {self.radius_mm:g} mm is below {SMALLEST_TIP_MM:g} mm, the sharpest tip")
        if self.height_mm < SMALLEST_HEIGHT_MM:
            raise InputError(f"{what} height = {self.height_mm:g} mm is below {SMALLEST_HEIGHT_MM:g} mm")
        # On the lower half of an ellipse: past it the profile would turn inwards.
        if self.foot_mm <= 0.0 or self.factor * self.height_mm > self.radius_mm * (1.0 - 1e-9):
            raise InputError(
                f"{what}: radius {self.radius_mm:g}, height {self.height_mm:g} and foot {self.foot_mm:g} mm "
                "make no cap that widens downwards; take a lower height or a wider foot"
            )
        if self.foot_slope_deg > steepest_deg:
            raise InputError(
                f"{what} slope at its foot = {self.foot_slope_deg:.0f} deg is above {steepest_deg:g} deg; "
                "take a lower height, a larger radius or a wider foot"
            )


def sphere_foot_mm(radius_mm: float, height_mm: float) -> float:
    """Foot radius of a spherical cap, sqrt(2 R c - c^2); 0 when the cap is higher than the sphere."""
    return float(np.sqrt(max(2.0 * radius_mm * height_mm - height_mm**2, 0.0)))


@dataclass(frozen=True)
class Shape:
    """What all shapes have in common; on its own a flat slab without parameters."""

    name: ClassVar[str] = "slab"

    @property
    def axisymmetric(self) -> bool:
        """Whether the shape is round about its highest point."""
        return True

    @property
    def flat_top(self) -> bool:
        """Whether the punch touches the whole face at once."""
        return True

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the tested face lies below the highest point. [mm]"""
        return np.zeros(np.broadcast(x_mm, y_mm).shape)

    def bone_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far a rigid bone reaches above the base. [mm]"""
        return np.zeros(np.broadcast(x_mm, y_mm).shape)

    def layers(self) -> tuple[float, float] | None:
        """Thickness of the upper layer [mm] and modulus of the lower over that of the upper; None for one resin."""
        return None

    def lines_mm(self) -> tuple[float, ...]:
        """Radii at which a height field has a kink, for meshes of round shapes."""
        return ()

    @property
    def parameters(self) -> tuple[tuple[str, float], ...]:
        """Names and values of the parameters, as typed."""
        return tuple((item.name.removesuffix("_mm"), float(getattr(self, item.name))) for item in fields(self))

    def check(self, thickness_mm: float, length_mm: float = 150.0, width_mm: float = 120.0) -> None:
        """Refuse a shape that does not fit its pad or cannot be cast.

        Raises
        ------
        InputError
            Naming the quantity, its value and what is allowed.
        """

    def __str__(self) -> str:
        # All digits, and nothing that is its default: what is printed is read back as the same shape.
        named = dict(zip((item.name for item in fields(self)), self.parameters))
        listed = ",".join(f"{name}={_digits(value)}" for key, (name, value) in named.items() if not self._implied(key))
        return f"{self.name}:{listed}" if listed else self.name

    def _implied(self, key: str) -> bool:
        """Whether a parameter has the value that it takes when it is not typed."""
        value = getattr(self, key)
        return value == type(self).__dataclass_fields__[key].default


@dataclass(frozen=True)
class Slab(Shape):
    """A flat slab."""


@dataclass(frozen=True)
class _Capped(Shape):
    """What crowns and bones share: a conic profile, round or along the whole length."""

    radius_mm: float
    height_mm: float
    foot_mm: float = 0.0

    def __post_init__(self) -> None:
        if not self.foot_mm:
            object.__setattr__(self, "foot_mm", sphere_foot_mm(self.radius_mm, self.height_mm))

    def _implied(self, key: str) -> bool:
        """The foot of a sphere need not be typed."""
        sphere = key == "foot_mm" and self.foot_mm == sphere_foot_mm(self.radius_mm, self.height_mm)
        return sphere or super()._implied(key)

    @property
    def along(self) -> bool:
        """Whether the profile runs along the whole length instead of round."""
        return False

    @property
    def axisymmetric(self) -> bool:
        """Round unless it runs along the length."""
        return not self.along

    @property
    def conic(self) -> Conic:
        """The profile."""
        return Conic(self.radius_mm, self.height_mm, self.foot_mm)

    def lines_mm(self) -> tuple[float, ...]:
        """The foot."""
        return (self.foot_mm,)

    def _sag_mm(self, x_mm: Array, y_mm: Array) -> Array:
        across = np.hypot(0.0 * np.asarray(x_mm), y_mm) if self.along else np.hypot(x_mm, y_mm)
        return self.conic.sag_mm(across)


@dataclass(frozen=True)
class Crowned(_Capped):
    """A conic top over a flat pad: apex radius, height of the crown, foot radius (0: that of a sphere).

    With ``ridge`` = 1 the profile is a cylinder's: it runs along the whole length and varies across the width.
    """

    name: ClassVar[str] = "crowned"
    ridge: float = 0.0

    @property
    def along(self) -> bool:
        """A ridge runs along the length."""
        return bool(self.ridge)

    @property
    def flat_top(self) -> bool:
        """A crown is touched gradually."""
        return False

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the crown has fallen."""
        return self._sag_mm(x_mm, y_mm)

    def check(self, thickness_mm: float, length_mm: float = 150.0, width_mm: float = 120.0) -> None:
        """Refuse tips, slopes and rests that cannot be cast."""
        _flag("ridge", self.ridge)
        self.conic.check("crown", STEEPEST_TOP_DEG)
        _left("crown", self.height_mm, thickness_mm, THINNEST_GEL_MM)
        _inside("crown", self.foot_mm, width_mm if self.ridge else min(length_mm, width_mm))


@dataclass(frozen=True)
class Bumped(Shape):
    """Spherical caps of one radius on a square lattice, the lower the farther from the middle.

    The cap at lattice place (i, j) has height ``height`` - ``grade`` (i^2 + j^2); places run to ``rings`` on
    every side, and caps lower than 0.3 mm are left out.
    """

    name: ClassVar[str] = "bumped"
    pitch_mm: float
    radius_mm: float
    height_mm: float
    grade_mm: float = 0.0
    rings: float = 1.0

    @property
    def axisymmetric(self) -> bool:
        """A lattice is not round."""
        return False

    @property
    def flat_top(self) -> bool:
        """Caps are touched one after another."""
        return False

    def caps_mm(self) -> tuple[tuple[float, float, float], ...]:
        """Places and heights (x, y, height) of the caps, the highest first."""
        rings = int(self.rings)
        found = []
        for i in range(-rings, rings + 1):
            for j in range(-rings, rings + 1):
                height = self.height_mm - self.grade_mm * (i * i + j * j)
                if height >= SMALLEST_HEIGHT_MM - 1e-9:
                    found.append((i * self.pitch_mm, j * self.pitch_mm, height))
        return tuple(sorted(found, key=lambda cap: (-cap[2], cap)))

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the caps, or the flat between them, lie below the highest tip."""
        x, y = np.broadcast_arrays(np.asarray(x_mm, dtype=float), np.asarray(y_mm, dtype=float))
        drop = np.full(x.shape, self.height_mm)
        for at_x, at_y, height in self.caps_mm():
            cap = Conic(self.radius_mm, height, sphere_foot_mm(self.radius_mm, height))
            drop = np.minimum(drop, self.height_mm - height + cap.sag_mm(np.hypot(x - at_x, y - at_y)))
        return drop

    def check(self, thickness_mm: float, length_mm: float = 150.0, width_mm: float = 120.0) -> None:
        """Refuse caps that overlap, keep air or leave the pad."""
        foot = sphere_foot_mm(self.radius_mm, self.height_mm)
        Conic(self.radius_mm, self.height_mm, foot).check("cap", STEEPEST_TOP_DEG)
        if self.height_mm > 2.0 * DEEPEST_POCKET * foot:
            raise InputError(
                f"cap height = {self.height_mm:g} mm is above {2.0 * DEEPEST_POCKET * foot:.3g} mm, "
                f"{DEEPEST_POCKET:g} of its diameter: its pocket in the mould keeps its air"
            )
        if not self.pitch_mm >= 2.0 * foot:
            raise InputError(f"pitch = {self.pitch_mm:g} mm is below {2.0 * foot:.3g} mm: caps overlap")
        if not (np.isfinite(self.grade_mm) and self.grade_mm >= 0.0):
            raise InputError(f"grade = {self.grade_mm:g} mm is below 0: the middle cap must be the highest")
        if not 0 <= self.rings <= 10 or self.rings != int(self.rings):
            raise InputError(f"rings = {self.rings:g} is not a whole number from 0 to 10")
        _left("cap", self.height_mm, thickness_mm, THINNEST_GEL_MM)
        _inside("field of caps", self.rings * self.pitch_mm + foot, min(length_mm, width_mm))


@dataclass(frozen=True)
class Layered(Shape):
    """Two resins: an upper layer (the tested face) on a lower one, with their moduli's ratio, lower over upper."""

    name: ClassVar[str] = "layered"
    top_mm: float
    modulus_ratio: float

    def layers(self) -> tuple[float, float] | None:
        """Thickness of the upper layer and the ratio of moduli."""
        return self.top_mm, self.modulus_ratio

    def check(self, thickness_mm: float, length_mm: float = 150.0, width_mm: float = 120.0) -> None:
        """Refuse layers that are too thin to pour and moduli no pair of resins has."""
        most = thickness_mm - THINNEST_GEL_MM
        if not THINNEST_GEL_MM <= self.top_mm <= most:
            raise out_of_range("top in mm", f"{self.top_mm:g}", THINNEST_GEL_MM, f"{most:g}", "both layers are poured")
        if not MODULUS_RATIO[0] <= self.modulus_ratio <= MODULUS_RATIO[1]:
            raise out_of_range("modulus_ratio", f"{self.modulus_ratio:g}", *MODULUS_RATIO)


@dataclass(frozen=True)
class Boned(_Capped):
    """A rigid conic dome on the base, under a flat top: apex radius, height, foot radius (0: that of a sphere).

    With ``bar`` = 1 it is a bar with that profile along the whole length.
    """

    name: ClassVar[str] = "boned"
    bar: float = 0.0

    @property
    def along(self) -> bool:
        """A bar runs along the length."""
        return bool(self.bar)

    def bone_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the bone reaches above the base."""
        return self.height_mm - self._sag_mm(x_mm, y_mm)

    def check(self, thickness_mm: float, length_mm: float = 150.0, width_mm: float = 120.0) -> None:
        """Refuse bones that are too steep for the mesh and covers too thin to last."""
        _flag("bar", self.bar)
        self.conic.check("bone", STEEPEST_BONE_DEG)
        _left("bone", self.height_mm, thickness_mm, THINNEST_COVER_MM)
        _inside("bone", self.foot_mm, width_mm if self.bar else min(length_mm, width_mm))


SHAPES: dict[str, type[Shape]] = {kind.name: kind for kind in (Slab, Crowned, Bumped, Layered, Boned)}


def make_shape(kind: str, parameters: Sequence[tuple[str, float]] = ()) -> Shape:
    """Make a shape from its name (any case) and parameters, by name or, under the names "0", "1", ..., by place.

    Raises
    ------
    InputError
        For unknown or missing names; values are judged by :meth:`Shape.check`.
    """
    if kind.lower() not in SHAPES:
        raise unknown_name("shape", kind, SHAPES)
    cls = SHAPES[kind.lower()]
    names = [item.name for item in fields(cls)]
    typed = [name.removesuffix("_mm") for name in names]
    given: dict[str, float] = {}
    for key, value in parameters:
        if key.isdigit() and int(key) < len(names):
            key = typed[int(key)]
        elif not typed:
            raise InputError(f"shape {cls.name} takes no parameters")
        elif key.isdigit():
            raise InputError(f"shape {cls.name} takes at most {len(names)} parameters ({', '.join(typed)})")
        if key.removesuffix("_mm") not in typed:
            raise unknown_name(f"parameter of shape {cls.name}", key, typed)
        name = names[typed.index(key.removesuffix("_mm"))]
        if name in given:
            raise InputError(f"shape {cls.name}: parameter {key} is given twice")
        if not np.isfinite(value):
            raise InputError(f"shape {cls.name}: {key} = {value} is not a finite number")
        given[name] = float(value)
    missing = [
        short for name, short, item in zip(names, typed, fields(cls))
        if name not in given and item.default is MISSING
    ]  # fmt: skip
    if missing:
        raise InputError(f"shape {cls.name} needs {', '.join(missing)}; write {cls.name}:{'=..,'.join(typed)}=..")
    return cls(**given)


def read_shape(text: str) -> Shape:
    """Read ``NAME``, ``NAME:KEY=VALUE,...`` or ``NAME:VALUE,...``.

    Raises
    ------
    InputError
        For unknown names, missing parameters or what is not a number.
    """
    name, _, rest = text.partition(":")
    parameters = []
    for index, item in enumerate(filter(None, rest.split(","))):
        key, equals, value = item.rpartition("=")
        try:
            parameters.append((key.strip() if equals else str(index), float(value)))
        except ValueError:
            raise InputError(f"shape parameter '{item}' is not a number; write NAME:VALUE or NAME:KEY=VALUE") from None
    return make_shape(name, parameters)


def _digits(value: float) -> str:
    """Shortest text that is read back as the same number."""
    return repr(float(value)).removesuffix(".0")


def _flag(name: str, value: float) -> None:
    if value not in (0.0, 1.0):
        raise InputError(f"{name} = {value:g} is not 0 or 1")


def _left(what: str, height_mm: float, thickness_mm: float, least_mm: float) -> None:
    if not thickness_mm - height_mm >= least_mm - 1e-9:
        raise InputError(
            f"{what} height = {height_mm:g} mm leaves {thickness_mm - height_mm:.3g} mm of a pad of "
            f"{thickness_mm:g} mm; at least {least_mm:g} mm must stay"
        )


def _inside(what: str, reach_mm: float, across_mm: float) -> None:
    if reach_mm > 0.5 * across_mm - RIM_FREE_MM:
        raise InputError(
            f"{what} reaches {reach_mm:.3g} mm from the middle; a pad {across_mm:g} mm across allows "
            f"{0.5 * across_mm - RIM_FREE_MM:g} mm"
        )
