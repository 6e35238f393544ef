"""Frozen dataclasses as plain data and back, without a word about which ones."""

from __future__ import annotations

import types
from dataclasses import fields, is_dataclass
from typing import Any, get_args, get_type_hints


def plain_data(value: Any) -> Any:
    """Nested dictionaries and lists of what ``asdict`` gives: tuples become lists."""
    if isinstance(value, dict):
        return {key: plain_data(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [plain_data(item) for item in value]
    return value


def _frozen(value: Any) -> Any:
    return tuple(_frozen(item) for item in value) if isinstance(value, list) else value


def rebuild(kind: Any, data: Any) -> Any:
    """Fill dataclass ``kind`` from plain data, following its type hints into nested ones; lists become tuples."""
    hints = get_type_hints(kind)
    found = {}
    for item in fields(kind):
        if item.name not in data:
            continue
        hint, value = hints[item.name], data[item.name]
        if isinstance(hint, types.UnionType):
            hint = next(part for part in get_args(hint) if part is not type(None))
        nested = is_dataclass(hint) and isinstance(value, dict)
        found[item.name] = rebuild(hint, value) if nested else _frozen(value)
    return kind(**found)
