"""From which pads the response table of each kind of shape is made: one module a shape with ``DESIGN``."""

from __future__ import annotations

from dummydesign.geometry.shape_registry import part_of, shape_kinds
from studies.tables.designs.base import Design

ROLE = "DESIGN"


def designs() -> dict[str, Design]:
    """The designs by the name of their shape."""
    every = {name: part_of(name, ROLE, __name__) for name in shape_kinds()}
    return {name: design for name, design in every.items() if design is not None}
