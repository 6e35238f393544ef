"""The block that a shape is cut into."""

from __future__ import annotations

from typing import Protocol


class PadBlock(Protocol):
    """The block a shape is cut into: what its volumes and words depend on beside its own lengths."""

    @property
    def thickness_mm(self) -> float:
        """Thickness at the highest point. [mm]"""
        ...

    @property
    def length_mm(self) -> float:
        """Length of the tested face's flat. [mm]"""
        ...

    @property
    def width_mm(self) -> float:
        """Width of the tested face's flat. [mm]"""
        ...

    @property
    def draft_deg(self) -> float:
        """How far the walls lean outwards, towards the free face. [deg]"""
        ...
