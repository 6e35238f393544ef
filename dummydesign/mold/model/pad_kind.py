"""The kinds of pads a mould can be made for: all shapes, and the puck, a plain cylinder."""

from __future__ import annotations

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.geometry.shapes import make_shape, read_shape, shape_kinds

PUCK = "puck"


def read_kind(text: str) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Read a shape as typed into name and parameters; a ``puck`` takes none.

    Raises
    ------
    InputError
        For unknown names, missing parameters or what is not a number.
    """
    name, _, rest = text.partition(":")
    if name.lower() == PUCK:
        return canonical_kind(PUCK, (("0", 0.0),) if rest else ())
    _check_known(name)
    shape = read_shape(text)
    return shape.name, shape.parameters


def _check_known(kind: str) -> None:
    """Refuse an unknown shape; the puck is among the known names."""
    if kind.lower() not in shape_kinds():
        raise unknown_name("shape", kind, [*shape_kinds(), PUCK])


def canonical_kind(
    kind: str, parameters: tuple[tuple[str, float], ...]
) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Name in small letters and every parameter by its name, so that equal shapes are stored alike."""
    if kind.lower() == PUCK:
        if parameters:
            raise InputError("shape puck takes no parameters; its diameter is given by --length and --width")
        return PUCK, ()
    _check_known(kind)
    shape = make_shape(kind, parameters)
    return shape.name, shape.parameters
