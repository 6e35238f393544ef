"""Plain values of an answer as its JSON has them, and frozen dataclasses to plain data and back."""

from __future__ import annotations

import math
import os
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, ClassVar, get_args, get_type_hints

from dummydesign._version import __version__


def to_plain(value: Any) -> Any:
    """Return a value as JSON has it: dataclasses by their fields, arrays as lists, what is not finite as None."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if is_dataclass(value) and not isinstance(value, type):
        return {item.name: to_plain(getattr(value, item.name)) for item in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): to_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [to_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return to_plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return os.fspath(value) if isinstance(value, os.PathLike) else value


# Answers whose fields changed their meaning.
VERSIONS = {"suggest": 2, "loop": 2}


def json_text(command: str, result: Mapping[str, Any]) -> str:
    """Return the JSON of an answer: schema, version, inputs, warnings and sources first."""
    import json

    head = {"schema": f"dummydesign.{command}/{VERSIONS.get(command, 1)}", "version": __version__}
    for key, empty in (("inputs", {}), ("warnings", []), ("sources", [])):
        head[key] = result.get(key, empty)
    return json.dumps(to_plain({**head, **result}), indent=1, allow_nan=False)


def parameter_rows(parameters: Mapping[str, Any]) -> list[tuple[str, Mapping[str, Any]]]:
    """Label and entry of each parameter; dampers of several speeds one by one."""
    rows: list[tuple[str, Mapping[str, Any]]] = []
    for name, entry in parameters.items():
        several = {name: entry} if "value" in entry else {f"{name} at {v} mm/s": one for v, one in entry.items()}
        rows += several.items()
    return rows


def _frozen(value: Any) -> Any:
    return tuple(_frozen(item) for item in value) if isinstance(value, list) else value


def rebuild(kind: Any, data: Any) -> Any:
    """Fill dataclass ``kind`` from plain data, following its type hints into nested ones; lists become tuples."""
    hints = get_type_hints(kind)
    values = {}
    for item in fields(kind):
        if item.name not in data:
            continue
        hint, value = hints[item.name], data[item.name]
        if isinstance(hint, types.UnionType):
            hint = next(part for part in get_args(hint) if part is not type(None))
        nested = is_dataclass(hint) and isinstance(value, dict)
        values[item.name] = rebuild(hint, value) if nested else _frozen(value)
    return kind(**values)


class Serialised:
    """A dataclass whose ``to_dict`` gives its fields by name, then the properties named in ``also``."""

    also: ClassVar[tuple[str, ...]] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the values of this answer as plain data."""
        names = [*(item.name for item in fields(self)), *self.also]  # type: ignore[arg-type]
        return {name: to_plain(getattr(self, name)) for name in names}


def percent_below_limit(share: float, limit: float | None) -> str:
    """Write a share in per cent; one below a limit is not rounded up to it."""
    if limit is not None and share < limit <= 0.01 * round(100.0 * share):
        return f"{math.floor(1000.0 * share) / 10.0:.1f} %"
    return f"{round(100.0 * share)} %"
