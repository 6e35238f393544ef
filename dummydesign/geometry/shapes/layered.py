"""Two resins, one on the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dummydesign.core.errors import out_of_range
from dummydesign.geometry.dimensions import MODULUS_RATIO, PAD_LENGTH_MM, PAD_WIDTH_MM, THINNEST_GEL_MM
from dummydesign.geometry.pad_shape import Array, PadBlock, PadShape, Similarity, grid, stack

# Upper layers that are tried, over the thickness, and moduli of the lower over that of the upper.
TOP_SHARES = np.linspace(0.2, 0.8, 7)
MODULUS_RATIOS = np.array([0.1, 0.2, 0.4, 0.7, 1.5, 2.5, 5.0, 10.0])


@dataclass(frozen=True)
class Layered(PadShape):
    """Two resins: an upper layer (the tested face) on a lower one, with their moduli's ratio, lower over upper."""

    name: ClassVar[str] = "layered"
    order: ClassVar[int] = 3
    open_mould_only: ClassVar[str] = "a layered pad is poured twice and its spacer needs an open mould"
    required_warnings: ClassVar[frozenset[str]] = frozenset({"layer_bond"})
    similarity: ClassVar[Similarity | None] = Similarity(
        ("thickness over punch radius", "upper layer over thickness", "modulus ratio"),
        (True, False, True),
        over_tip=False,
    )
    top_mm: float
    modulus_ratio: float

    def layers(self) -> tuple[float, float] | None:
        """Thickness of the upper layer and the ratio of moduli."""
        return self.top_mm, self.modulus_ratio

    def least_gel_mm(self, block: PadBlock) -> float:
        """The thinner layer."""
        return min(self.top_mm, block.thickness_mm - self.top_mm)

    def check(self, thickness_mm: float, length_mm: float = PAD_LENGTH_MM, width_mm: float = PAD_WIDTH_MM) -> None:
        """Refuse layers that are too thin to pour and moduli no pair of resins has."""
        most = thickness_mm - THINNEST_GEL_MM
        if not THINNEST_GEL_MM <= self.top_mm <= most:
            raise out_of_range("top in mm", f"{self.top_mm:g}", THINNEST_GEL_MM, f"{most:g}", "both layers are poured")
        if not MODULUS_RATIO[0] <= self.modulus_ratio <= MODULUS_RATIO[1]:
            raise out_of_range("modulus_ratio", f"{self.modulus_ratio:g}", *MODULUS_RATIO)

    def mark(self, block: PadBlock, scale: float) -> str:
        """Both layers, the upper one in the cold cavity as well."""
        return (
            f"upper layer {self.top_mm:g} mm (cavity {scale * self.top_mm:.3f}), base "
            f"{block.thickness_mm - self.top_mm:g} mm of {self.modulus_ratio:g} times its modulus"
        )

    @classmethod
    def candidates(cls, thickness_mm: Array, radius_mm: float) -> tuple[Array, dict[str, Array]]:
        """Layers and pairs of moduli."""
        h, share, ratio = grid(thickness_mm, TOP_SHARES, MODULUS_RATIOS)
        return h, {"top": np.round(share * h, 1), "modulus_ratio": ratio}

    @classmethod
    def in_proportion(cls, k: Array) -> dict[str, Array]:
        """The upper layer goes with the thickness."""
        return {"top": k}

    @classmethod
    def numbers(cls, parameters: Mapping[str, Array], thickness_mm: Array, radius_mm: Array) -> Array:
        """h / a, upper layer over h and the ratio of moduli."""
        return stack(thickness_mm / radius_mm, parameters["top"] / thickness_mm, parameters["modulus_ratio"])
