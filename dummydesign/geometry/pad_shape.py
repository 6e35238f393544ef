"""The contract of pad shapes: heights, volumes, limits, words, its mould, its design box. No solver, no CAD.

A pad stands on a rigid base plane and has its full thickness at its highest point, over the origin. Its
tested face lies ``drop_mm(x, y)`` below that point; a rigid bone fills the pad from the base up to
``bone_mm(x, y)``. Both are heights over the plane, so the gel is never undercut. A layered pad has two
moduli, one above the other.

A shape is a subclass of :class:`PadShape` in the module of its name in ``geometry/shapes``; what a member's default
says of a flat slab need not be said again. CONTRIBUTING.md has the recipe.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import ClassVar, Protocol, Self

import numpy as np

from dummydesign.geometry.dimensions import GAUGE_FOOT_MM, PAD_LENGTH_MM, PAD_WIDTH_MM


class PadBlock(Protocol):
    """The block a shape is cut into: what its volumes and words depend on beside its own lengths."""

    @property
    def thickness_mm(self) -> float:
        """Thickness at the highest point. [mm]"""

    @property
    def length_mm(self) -> float:
        """Length of the tested face's flat. [mm]"""

    @property
    def width_mm(self) -> float:
        """Width of the tested face's flat. [mm]"""

    @property
    def draft_deg(self) -> float:
        """How far the walls lean outwards, towards the free face. [deg]"""


Array = np.ndarray


@dataclass(frozen=True)
class Similarity:
    """Which dimensionless numbers the force of a kind of shape is a function of, for response tables.

    Attributes
    ----------
    names : tuple of str
        The numbers, in words; the first is thickness over punch radius.
    logarithms : tuple of bool
        Which of them enter a table by their logarithm.
    over_tip : bool
        Whether the force is divided by Hertz's force of the highest tip, else by that of the slab of the upper resin.
    """

    names: tuple[str, ...]
    logarithms: tuple[bool, ...]
    over_tip: bool


def grid(*axes: Array) -> list[Array]:
    """Return all combinations of values, one flat array an axis."""
    return [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]


def stack(*numbers: Array) -> Array:
    """Return the numbers of a response table as the columns of one array."""
    return np.stack(np.broadcast_arrays(*numbers), axis=-1)


@dataclass(frozen=True)
class PadShape:
    """The contract of a shape; every default is that of a flat slab. Parameters are floats, lengths end in ``_mm``.

    Examples
    --------
    >>> @dataclass(frozen=True)
    ... class Cone(PadShape):
    ...     name = "cone"
    ...     slope: float = 0.1
    ...     def drop_mm(self, x_mm, y_mm):
    ...         return self.slope * np.hypot(x_mm, y_mm)
    >>> print(Cone(0.2), Cone.parameter_names(), round(float(Cone(0.2).drop_mm(3.0, 4.0)), 6))
    cone:slope=0.2 ('slope',) 1.0
    """

    name: ClassVar[str] = ""
    order: ClassVar[int] = 100
    """Rank in lists of shapes; equal ones by name."""
    plain: ClassVar[bool] = False
    """Whether this is the flat slab of one resin."""
    flat_top: ClassVar[bool] = True
    """Whether the punch touches the whole face at once."""
    crowned: ClassVar[bool] = False
    """Whether ``height`` over the flat and ``radius`` of the tip may be changed alone, in the force law too."""
    similarity: ClassVar[Similarity | None] = None
    """Numbers of the kind's response table; None without one."""
    closed_form: ClassVar[str] = ""
    """What is added to the drafted slab's closed form of volume, in words."""
    open_mould_only: ClassVar[str] = ""
    """Why no lid can close the mould of this shape; empty when one can."""
    required_warnings: ClassVar[frozenset[str]] = frozenset()
    """Codes of the warnings without which no mould of this shape goes out."""

    sliders: ClassVar[tuple[str, ...]] = ()
    """Parameters that are moved one by one; all that its candidates vary when it is empty."""

    # Outline and profile.

    @property
    def axisymmetric(self) -> bool:
        """Whether the shape is round about its highest point."""
        return True

    @property
    def fidelity(self) -> str:
        """The finite elements that solve it: ``axisymmetric``, or ``3d`` when it is not round."""
        return "axisymmetric" if self.axisymmetric else "3d"

    @property
    def first_exponent(self) -> float:
        """d ln F / d ln d at first touch: 1 of a flat, 1.5 of a rounded tip."""
        return 1.0 if self.flat_top else 1.5

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the tested face lies below the highest point. [mm]"""
        return np.zeros(np.broadcast(x_mm, y_mm).shape)

    def bone_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far a rigid bone reaches above the base. [mm]"""
        return np.zeros(np.broadcast(x_mm, y_mm).shape)

    def layers(self) -> tuple[float, float] | None:
        """Thickness of the upper layer [mm] and modulus of the lower over that of the upper; None for one resin."""
        return None

    @property
    def places_mm(self) -> tuple[tuple[float, float], ...]:
        """Where the shape stands about the pad's middle; several of a pad that is pressed at several sites. [mm]"""
        return ((0.0, 0.0),)

    def lines_mm(self) -> tuple[float, ...]:
        """Radii, or distances across, at which a height field has a kink, for meshes and drawings."""
        return ()

    # Volumes.

    def face_height_mm(self, block: PadBlock) -> float:
        """Height of the tested face's flat above its highest point. [mm]"""
        return float(self.drop_mm(np.array(block.length_mm / 2), np.array(block.width_mm / 2)))

    def least_gel_mm(self, block: PadBlock) -> float:
        """Thinnest gel of the pad: beside a crown, over a bone, or a layer. [mm]"""
        return block.thickness_mm - max(self.bone_height_mm, self.face_height_mm(block))

    def top_volume_mm3(self, block: PadBlock) -> float:
        """What stands above the flat of the tested face, in closed form. [mm3]"""
        return 0.0

    def bone_volume_mm3(self, block: PadBlock) -> float:
        """What a rigid bone displaces in the pad, in closed form. [mm3]"""
        return 0.0

    # The mould.

    @property
    def relief_mm(self) -> float:
        """How high the tested face stands over its flat; 0 of a flat face. [mm]"""
        return 0.0

    @property
    def tip_radius_mm(self) -> float | None:
        """Radius of curvature of the highest tip; None when it has none. [mm]"""
        return None

    @property
    def bone_height_mm(self) -> float:
        """Height of the rigid bone at its highest; 0 without one. [mm]"""
        return float(self.bone_mm(np.array(0.0), np.array(0.0)))

    @classmethod
    def gel_mm(cls, thickness_mm: Array, parameters: Mapping[str, Array]) -> Array:
        """Gel under the middle of the punch at rest: the thickness, less a rigid bone. Shape (M,). [mm]

        Parameters
        ----------
        thickness_mm : ndarray, shape (M,)
            Of M pads. [mm]
        parameters : mapping
            By their typed names, arrays of shape (M,).
        """
        thickness = np.asarray(thickness_mm, float)
        if cls.bone_mm is PadShape.bone_mm:
            return thickness
        rows = ({name: value[row] for name, value in parameters.items()} for row in range(len(thickness)))
        return thickness - np.array([cls.of(row).bone_height_mm for row in rows])

    @property
    def steepest_deg(self) -> float:
        """Largest slope of the curved face, tested face or bone. [deg]"""
        return 0.0

    @property
    def runs_out(self) -> bool:
        """Whether the profile goes on into the end walls, as a ridge or a bar does."""
        return False

    @property
    def sharp_edge(self) -> str:
        """Why the edge around the tested face cannot be rounded, as ``a ridge must be 0: ...``; empty when it can."""
        return ""

    # The cast pad.

    def gauge_places(self) -> dict[str, tuple[tuple[float, float], ...]]:
        """Places by name where the thickness is gauged besides tips (or middle) and corners, from the middle. [mm]

        Of each the first is taken that has room on a flat.
        """
        if not (self.relief_mm and self.lines_mm()):
            return {}
        reach = max(self.lines_mm()) + GAUGE_FOOT_MM
        x, y = max(self.places_mm)
        turns = (np.pi / 2,) if self.runs_out else (0.0, np.pi / 2, np.pi / 4)
        return {"shoulder": tuple((x + reach * float(np.cos(one)), y + reach * float(np.sin(one))) for one in turns)}

    # Limits.

    def check(self, thickness_mm: float, length_mm: float = PAD_LENGTH_MM, width_mm: float = PAD_WIDTH_MM) -> None:
        """Refuse a shape that does not fit its pad or cannot be cast.

        Parameters
        ----------
        thickness_mm, length_mm, width_mm : float
            The finished pad. [mm]

        Raises
        ------
        InputError
            Naming the quantity, its value and what is allowed.
        """

    # Words.

    @property
    def title(self) -> str:
        """What the pad is called in a sentence."""
        return f"{self.name} pad"

    def mark(self, block: PadBlock, scale: float) -> str:
        """One line for drawing and pour sheet, empty for a slab; ``scale`` is the cold cavity's over the pad's."""
        return ""

    def casting_notes(self, block: PadBlock) -> tuple[tuple[str, str], ...]:
        """Further warnings of the mould as (code, message), beyond those of relief, bone and layers."""
        return ()

    # Parameters as they are typed.

    @classmethod
    def parameter_names(cls) -> tuple[str, ...]:
        """Names of the parameters as typed, in their order."""
        return tuple(item.name.removesuffix("_mm") for item in fields(cls))

    @classmethod
    def needed(cls) -> tuple[str, ...]:
        """Names of the parameters without a default."""
        return tuple(item.name.removesuffix("_mm") for item in fields(cls) if item.default is MISSING)

    @classmethod
    def of(cls, parameters: Mapping[str, float]) -> Self:
        """The shape with parameters by their typed names."""
        long = {item.name.removesuffix("_mm"): item.name for item in fields(cls)}
        return cls(**{long[name]: float(value) for name, value in parameters.items()})

    @property
    def parameters(self) -> tuple[tuple[str, float], ...]:
        """Names and values of the parameters, as typed."""
        return tuple((item.name.removesuffix("_mm"), float(getattr(self, item.name))) for item in fields(self))

    def __str__(self) -> str:
        # All digits, and nothing that is its default: what is printed is read back as the same shape.
        named = dict(zip((item.name for item in fields(self)), self.parameters))
        listed = ",".join(f"{name}={_digits(value)}" for key, (name, value) in named.items() if not self._implied(key))
        return f"{self.name}:{listed}" if listed else self.name

    def _implied(self, key: str) -> bool:
        """Whether a parameter has the value that it takes when it is not typed."""
        value = getattr(self, key)
        return value == type(self).__dataclass_fields__[key].default

    # The design box: what a search tries, and the numbers of a response table.

    @classmethod
    def candidates(cls, thickness_mm: Array, radius_mm: float) -> tuple[Array, dict[str, Array]]:
        """Pads in practical steps that a search tries: thicknesses and parameters by name, all of shape (M,).

        Parameters
        ----------
        thickness_mm : ndarray, shape (n,)
            Thicknesses that may be taken. [mm]
        radius_mm : float
            Radius of the circle of the punch's area. [mm]
        """
        none = np.zeros(0)
        return none, dict.fromkeys(cls.parameter_names(), none)

    def with_length(self, name: str, value: float) -> Self:
        """Return the shape with one parameter changed; those that the shape's table ties to it follow."""
        return self.of({**dict(self.parameters), name: value})

    @classmethod
    def in_proportion(cls, k: Array) -> dict[str, Array]:
        """Factors of the parameters that change when the thickness changes by ``k``; the others stay."""
        return {}

    @classmethod
    def numbers(cls, parameters: Mapping[str, Array], thickness_mm: Array, radius_mm: Array) -> Array:
        """The numbers that ``similarity`` names, shape (n, k).

        Parameters
        ----------
        parameters : mapping
            By their typed names, broadcast with the rest.
        thickness_mm, radius_mm : ndarray, shape (n,)
            Of pad and punch. [mm]
        """
        raise NotImplementedError(f"{cls.name} has no response table")

    @property
    def tabulated(self) -> bool:
        """Whether the kind's response table may hold this shape."""
        return self.similarity is not None and self.axisymmetric

    def check_tabulated(self) -> None:
        """Refuse a shape of other proportions than those that the kind's table is made for.

        Raises
        ------
        InputError
            Naming what the table holds.
        """

    @classmethod
    def digits(cls, name: str) -> int:
        """Decimals in which a parameter is drawn and cast: tenths of a millimetre, ratios in hundredths."""
        return 2 if name.endswith("ratio") else 1

    def rounded(self) -> Self:
        """The shape as it is drawn and cast."""
        return self.of({name: round(value, self.digits(name)) for name, value in self.parameters})


def _digits(value: float) -> str:
    """Shortest text that is read back as the same number."""
    return repr(float(value)).removesuffix(".0")
