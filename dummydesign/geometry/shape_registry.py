"""Which shapes there are: the modules of ``geometry/shapes``, found by name, and shapes that others register."""

from __future__ import annotations

import importlib
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError, unknown_name

if TYPE_CHECKING:
    from dummydesign.geometry.pad_shape import PadShape

DEFAULT = "slab"
_FOLDER = Path(__file__).with_name("shapes")


def shape_names() -> tuple[str, ...]:
    """Names of the package's shapes, the slab first; a module of ``geometry/shapes`` is a shape of its name."""
    names = {path.stem for path in _FOLDER.glob("[!_]*.py")}
    return DEFAULT, *sorted(names - {DEFAULT})


def shape_help(default: str) -> str:
    """The shapes as help texts list them."""
    return ", ".join(f"{name} (default)" if name == default else name for name in shape_names())


def shape_meanings() -> dict[str, str]:
    """What each shape is: the first line of its module, without loading it."""
    meanings = {}
    for name in shape_names():
        text = (_FOLDER / f"{name}.py").read_text(encoding="utf-8")
        line = text.partition('"""')[2].splitlines()[0].removesuffix('"""').rstrip(".")
        meanings[name] = line[0].lower() + line[1:]
    return meanings


_REGISTERED: dict[str, type[PadShape]] = {}
_PARTS: dict[tuple[str, str], Any] = {}


def shape_kinds() -> dict[str, type[PadShape]]:
    """All shapes by name, in the order of lists."""
    known = [*_members(), *_REGISTERED.values()]
    return {kind.name: kind for kind in sorted(known, key=lambda kind: (kind.order, kind.name))}


def shape_kind(name: str) -> type[PadShape]:
    """The shape of a name, in any case of letters."""
    kinds = shape_kinds()
    if name.lower() not in kinds:
        raise unknown_name("shape", name, kinds)
    return kinds[name.lower()]


def part_of(name: str, role: str, package: str) -> Any:
    """What another room knows of a shape: attribute ``role`` of the module ``package.name``; None without one.

    So a room that must not be imported here (solids, say) keeps its part of a shape in a module of the shape's name.
    """
    if (name, role) in _PARTS:
        return _PARTS[name, role]
    from importlib.util import find_spec

    module = f"{package}.{name}"
    return getattr(importlib.import_module(module), role) if find_spec(module) else None


@contextmanager
def registered(kind: type[PadShape], **parts: Any) -> Iterator[type[PadShape]]:
    """Let a shape from elsewhere be known for a while, with the parts of other rooms by their role (``SOLIDS=...``)."""
    if kind.name in shape_kinds():
        raise InputError(f"shape {kind.name} is there already", "file_exists", "shape", kind.name)
    _REGISTERED[kind.name] = kind
    _PARTS.update({(kind.name, role): part for role, part in parts.items()})
    try:
        yield kind
    finally:
        del _REGISTERED[kind.name]
        for role in parts:
            del _PARTS[kind.name, role]


def make_shape(kind: str, parameters: Sequence[tuple[str, float]] = ()) -> PadShape:
    """Make a shape from its name (any case) and parameters, by name or, under the names "0", "1", ..., by place."""
    cls = shape_kind(kind)
    names = cls.parameter_names()
    given: dict[str, float] = {}
    for key, value in parameters:
        if key.isdigit() and int(key) < len(names):
            key = names[int(key)]
        name = key.removesuffix("_mm")
        if not names or key.isdigit():
            takes = f"at most {len(names)} parameters ({', '.join(names)})" if names else "no parameters"
            raise InputError(f"shape {cls.name} takes {takes}", "unknown_key", "shape_parameter", key, names or None)
        if name not in names:
            raise unknown_name(f"parameter of shape {cls.name}", key, names, "unknown_key", "shape_parameter")
        if name in given:
            raise InputError(f"shape {cls.name}: parameter {key} is given twice", "duplicate", f"shape.{name}")
        if not math.isfinite(value):
            message = f"shape {cls.name}: {key} = {value} is not a finite number"
            raise InputError(message, "out_of_range", f"shape.{name}", value)
        given[name] = float(value)
    missing = [name for name in cls.needed() if name not in given]
    if missing:
        message = f"shape {cls.name} needs {', '.join(missing)}; write {cls.name}:{'=..,'.join(names)}=.."
        raise InputError(message, "missing", f"shape.{missing[0]}")
    return cls.of(given)


def read_shape(text: str) -> PadShape:
    """Read ``NAME``, ``NAME:KEY=VALUE,...`` or ``NAME:VALUE,...``.

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
            message = f"shape parameter '{item}' is not a number; write NAME:VALUE or NAME:KEY=VALUE"
            raise InputError(message, "not_a_number", "shape_parameter", item) from None
    return make_shape(name, parameters)


@lru_cache(maxsize=1)
def _members() -> tuple[type[PadShape], ...]:
    """The shapes of the package: in the module of its name, the one whose ``name`` it is."""
    from dummydesign.geometry.pad_shape import PadShape

    members = []
    for name in shape_names():
        module = importlib.import_module(f"{__package__}.shapes.{name}")
        kinds = (value for value in vars(module).values() if isinstance(value, type) and issubclass(value, PadShape))
        members.append(next(kind for kind in kinds if kind.name == name))
    return tuple(members)
