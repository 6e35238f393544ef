"""The flat slab."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from dummydesign.geometry.shapes.base import PadShape


@dataclass(frozen=True)
class Slab(PadShape):
    """A flat slab of one resin."""

    name: ClassVar[str] = "slab"
    order: ClassVar[int] = 0
    usage: ClassVar[str] = "slab (default)"

    @property
    def plain(self) -> bool:
        """This is the flat slab."""
        return True

    @property
    def title(self) -> str:
        """A slab is called so."""
        return self.name
