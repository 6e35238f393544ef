"""The flat slab."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from dummydesign.geometry.pad_shape import PadShape


@dataclass(frozen=True)
class Slab(PadShape):
    """A flat slab of one resin."""

    name: ClassVar[str] = "slab"
    order: ClassVar[int] = 0

    plain: ClassVar[bool] = True

    @property
    def title(self) -> str:
        """A slab is called so."""
        return self.name
