"""A rigid bone under a flat top."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry import dimensions as limits
from dummydesign.geometry.conic import FOOT_SHARES, ConicProfile, wall_slope
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import Array, PadBlock, Similarity, grid, stack

# Heights of bones that are tried, over the thickness.
BONE_SHARES = np.linspace(0.2, 0.7, 6)
# How far a tabulated bone's radius may lie from that of the sphere with its height and foot.
SPHERE_WITHIN = 0.05


@dataclass(frozen=True)
class Boned(ConicProfile):
    """A rigid conic dome on the base, under a flat top: apex radius, height, foot radius (0: that of a sphere).

    With ``bar`` = 1 it is a bar with that profile along the whole length.
    """

    name: ClassVar[str] = "boned"
    order: ClassVar[int] = 4
    closed_form: ClassVar[str] = ", less the bone by the conic's integral"
    open_mould_only: ClassVar[str] = "the bone of a boned pad hangs from a plate on an open mould"
    required_warnings: ClassVar[frozenset[str]] = frozenset({"bone_air"})
    similarity: ClassVar[Similarity | None] = Similarity(
        ("thickness over punch radius", "bone height over thickness", "foot over punch radius"),
        (True, False, True),
        over_tip=False,
    )
    sliders: ClassVar[tuple[str, ...]] = ("height", "foot")

    bar: float = 0.0

    def with_length(self, name: str, value: float) -> Self:
        """The dome stays spherical: its radius follows height and foot."""
        changed = super().with_length(name, value)
        sphere = (changed.foot_mm**2 + changed.height_mm**2) / (2.0 * changed.height_mm)
        return replace(changed, radius_mm=round(sphere, 2)) if name in self.sliders else changed

    @property
    def along(self) -> bool:
        """A bar runs along the length."""
        return bool(self.bar)

    def bone_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the bone reaches above the base."""
        return self.height_mm - self.sag_mm(self.across_mm(x_mm, y_mm))

    def ends(self, block: PadBlock) -> tuple[float, float]:
        """The bar ends a little before the drafted walls."""
        slope = wall_slope(block)
        return block.length_mm / 2 + slope * (block.thickness_mm - self.height_mm) - limits.BAR_END_GAP_MM, slope

    def bone_volume_mm3(self, block: PadBlock) -> float:
        """Volume of dome or bar."""
        return self.volume_mm3(block)

    def check(self, thickness_mm: float, length_mm: float = PAD_LENGTH_MM, width_mm: float = PAD_WIDTH_MM) -> None:
        """Refuse bones that are too steep for the mesh and covers too thin to last."""
        limits.check_flag("bar", self.bar)
        self.check_cap("bone", limits.STEEPEST_BONE_DEG)
        limits.check_left("bone", self.height_mm, thickness_mm, limits.THINNEST_COVER_MM)
        limits.check_inside("bone", self.foot_mm, width_mm if self.bar else min(length_mm, width_mm))

    def mark(self, block: PadBlock, scale: float) -> str:
        """Tip, height, foot and the gel over it."""
        what = "bar along the length" if self.bar else "dome"
        return (
            f"bone, a {what}: tip radius {self.radius_mm:g} mm, height {self.height_mm:g} mm, foot at "
            f"{self.foot_mm:.4g} mm; {self.least_gel_mm(block):g} mm of gel over it"
        )

    def casting_notes(self, block: PadBlock) -> tuple[tuple[str, str], ...]:
        """A bar ends before the walls."""
        if not self.bar:
            return ()
        gap = f"the bar ends {limits.BAR_END_GAP_MM:g} mm before the walls"
        return (("bar_ends", f"{gap}: a film of gel covers its ends"),)

    @classmethod
    def gel_mm(cls, thickness_mm: Array, parameters: Mapping[str, Array]) -> Array:
        """Gel over the bone's highest point. [mm]"""
        return np.asarray(thickness_mm, float) - parameters["height"]

    @classmethod
    def candidates(cls, thickness_mm: Array, radius_mm: float) -> tuple[Array, dict[str, Array]]:
        """Spherical domes of a height and a foot."""
        h, share, foot = grid(thickness_mm, BONE_SHARES, FOOT_SHARES)
        height, foot = np.round(share * h, 1), np.round(foot * radius_mm, 1)
        return h, {"radius": np.round((foot**2 + height**2) / (2.0 * height), 1), "height": height, "foot": foot}

    @classmethod
    def numbers(cls, parameters: Mapping[str, Array], thickness_mm: Array, radius_mm: Array) -> Array:
        """h / a, c / h and b / a."""
        return stack(thickness_mm / radius_mm, parameters["height"] / thickness_mm, parameters["foot"] / radius_mm)

    def check_tabulated(self) -> None:
        """The table is of spherical domes."""
        sphere = (self.foot_mm**2 + self.height_mm**2) / (2.0 * self.height_mm)
        if abs(self.radius_mm / sphere - 1.0) > SPHERE_WITHIN:
            table = f"that of a sphere with its height and foot, as in the table; use --fidelity {self.fidelity}"
            message = f"bone radius = {self.radius_mm:g} mm is not near {sphere:.4g} mm, {table}"
            raise InputError(message, "not_tabulated", "bone_radius_mm", self.radius_mm)
