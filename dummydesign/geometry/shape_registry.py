"""Which shapes there are: the modules of ``geometry/shapes``, found by name, and shapes that others register."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_names import shape_names

_REGISTERED: dict[str, type[PadShape]] = {}
_PARTS: dict[tuple[str, str], Any] = {}


def shape_kinds() -> dict[str, type[PadShape]]:
    """All shapes by name, in the order of lists."""
    known = [*_members(), *_REGISTERED.values()]
    return {kind.name: kind for kind in sorted(known, key=lambda kind: (kind.order, kind.name))}


def shape_kind(name: str) -> type[PadShape]:
    """The shape of a name, in any case of letters.

    Raises
    ------
    InputError
        For an unknown name.
    """
    kinds = shape_kinds()
    if name.lower() not in kinds:
        raise unknown_name("shape", name, kinds)
    return kinds[name.lower()]


def part_of(name: str, role: str, package: str) -> Any:
    """What another room knows of a shape: attribute ``role`` of the module ``package.name``; None without one.

    So a room that must not be imported here (solids, say) keeps its part of a shape in a module of the shape's name.

    Parameters
    ----------
    name : str
        Name of the shape.
    role : str
        Name of the attribute, such as ``SOLIDS``.
    package : str
        Package of the room's modules.
    """
    if (name, role) in _PARTS:
        return _PARTS[name, role]
    module = f"{package}.{name}"
    return getattr(importlib.import_module(module), role) if find_spec(module) else None


@contextmanager
def registered(kind: type[PadShape], **parts: Any) -> Iterator[type[PadShape]]:
    """Let a shape from elsewhere be known for a while, with the parts of other rooms by their role (``SOLIDS=...``).

    Raises
    ------
    InputError
        When the name is taken.
    """
    if kind.name in shape_kinds():
        raise InputError(f"shape {kind.name} is there already")
    _REGISTERED[kind.name] = kind
    _PARTS.update({(kind.name, role): part for role, part in parts.items()})
    try:
        yield kind
    finally:
        del _REGISTERED[kind.name]
        for role in parts:
            del _PARTS[kind.name, role]


def make_shape(kind: str, parameters: Sequence[tuple[str, float]] = ()) -> PadShape:
    """Make a shape from its name (any case) and parameters, by name or, under the names "0", "1", ..., by place.

    Raises
    ------
    InputError
        For unknown or missing names; values are judged by :meth:`PadShape.check`.
    """
    cls = shape_kind(kind)
    names = cls.parameter_names()
    given: dict[str, float] = {}
    for key, value in parameters:
        if key.isdigit() and int(key) < len(names):
            key = names[int(key)]
        elif not names:
            raise InputError(f"shape {cls.name} takes no parameters")
        elif key.isdigit():
            raise InputError(f"shape {cls.name} takes at most {len(names)} parameters ({', '.join(names)})")
        name = key.removesuffix("_mm")
        if name not in names:
            raise unknown_name(f"parameter of shape {cls.name}", key, names)
        if name in given:
            raise InputError(f"shape {cls.name}: parameter {key} is given twice")
        if not np.isfinite(value):
            raise InputError(f"shape {cls.name}: {key} = {value} is not a finite number")
        given[name] = float(value)
    missing = [name for name in cls.needed() if name not in given]
    if missing:
        raise InputError(f"shape {cls.name} needs {', '.join(missing)}; write {cls.name}:{'=..,'.join(names)}=..")
    return cls.of(given)


def read_shape(text: str) -> PadShape:
    """Read ``NAME``, ``NAME:KEY=VALUE,...`` or ``NAME:VALUE,...``.

    Parameters
    ----------
    text : str
        A shape as it is typed.

    Returns
    -------
    PadShape

    Raises
    ------
    InputError
        For unknown names, missing parameters or what is not a number.

    Examples
    --------
    >>> crown = read_shape("crowned:20,2")
    >>> print(crown)
    crowned:radius=20,height=2
    >>> round(float(crown.drop_mm(5.0, 0.0)), 3)  # 20 - sqrt(20^2 - 5^2)
    0.635
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


@lru_cache(maxsize=1)
def _members() -> tuple[type[PadShape], ...]:
    """The shapes of the package: in the module of its name, the one whose ``name`` it is."""
    found = []
    for name in shape_names():
        module = importlib.import_module(f"{__package__}.shapes.{name}")
        kinds = (value for value in vars(module).values() if isinstance(value, type) and issubclass(value, PadShape))
        found.append(next(kind for kind in kinds if kind.name == name))
    return tuple(found)
