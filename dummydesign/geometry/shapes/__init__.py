"""Shapes of pads: one description for the finite-element model, the mould, the command line and the design.

One module a shape; :func:`shape_kinds` finds them. See :class:`PadShape` for what each must answer.
"""

from dummydesign.geometry.pad_block import PadBlock
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import (
    make_shape,
    part_of,
    read_shape,
    registered,
    shape_kind,
    shape_kinds,
)
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.geometry.similarity import Similarity

__all__ = [
    "PadBlock", "PadShape", "Similarity", "Slab", "make_shape", "part_of", "read_shape", "registered",
    "shape_kind", "shape_kinds",
]  # fmt: skip
