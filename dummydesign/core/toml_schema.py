"""Read the tables of a TOML file key by key; every fault names file, line and key."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import FIELDS, KINDS, Quantity, has_line, line_of
from dummydesign.core.user_library import read_toml

REQUIRED: Any = object()
"""Default of a key that must be there."""


@dataclass(frozen=True)
class TomlTable:
    """A table of a file: ``name`` is its dotted name, ``keys`` are what its line is searched by."""

    data: dict[str, Any]
    path: Path
    text: str
    name: str = ""
    keys: tuple[str, ...] = field(default=(), repr=False)

    def __contains__(self, key: str) -> bool:
        return key in self.data

    def where(self, key: str = "") -> str:
        """File and line of a key, of the table itself without one."""
        header = f"[{self._dotted(key)}"
        last = [header if has_line(self.text, header) else key] if key in self.data else []
        return f"{self.path.name}:{line_of(self.text, *self.keys, *last)}"

    def fault(self, key: str, words: str, code: str, allowed: object = None) -> InputError:
        """Make the error of a key: ``words`` follow its name and value."""
        value = f"'{key}' = {self.data[key]!r} " if key in self.data else f"'{key}' "
        message = f"{self.where(key)}: {value}{words}"
        return InputError(message, code, self._dotted(key), self.data.get(key), allowed)

    def only(self, keys: Iterable[str]) -> TomlTable:
        """Refuse keys that nothing reads; return the table."""
        known = list(keys)
        for key in self.data:
            if key not in known:
                raise unknown_name("key", key, known, "unknown_key", self._dotted(key)).within(self.where(key))
        return self

    def get(self, key: str, kind: type | tuple[type, ...], words: str, default: Any = REQUIRED) -> Any:
        """Return a value of a type; ``words`` name what is needed. A bool is no number."""
        if key not in self.data:
            if default is REQUIRED:
                raise self.fault(key, "is missing", "missing")
            return default
        value = self.data[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise self.fault(key, f"must be {words}", "not_a_number" if "number" in words else "malformed")
        return value

    def number(
        self,
        key: str,
        default: Any = REQUIRED,
        *,
        above: float | None = None,
        low: float = -math.inf,
        high: float = math.inf,
    ) -> Any:
        """Return a finite number: ``above`` is left out of the range, ``low`` and ``high`` belong to it."""
        value = self.get(key, (int, float), "a finite number", default)
        if key not in self.data:
            return value
        if not math.isfinite(value):
            raise self.fault(key, "must be a finite number", "not_a_number")
        if above is not None and value <= above:
            raise self.fault(key, f"must be above {above:g}", "out_of_range", (above, None))
        if not low <= value <= high:
            raise self.fault(key, f"is outside the allowed range {low:g} to {high:g}", "out_of_range", (low, high))
        return float(value)

    def count(self, key: str, default: int) -> int:
        """Return a whole number from 1."""
        value = self.data.get(key, default)
        if type(value) is not int or value < 1:
            raise self.fault(key, "must be a whole number from 1", "out_of_range")
        return value

    def string(self, key: str, default: Any = REQUIRED, choices: Collection[str] = ()) -> Any:
        """Return a text that is not empty, one of the choices where there are any."""
        value = self.get(key, str, "a text", default)
        if key not in self.data:
            return value
        if not value.strip():
            raise self.fault(key, "is empty", "no_source" if key == "source" else "missing")
        if choices and value not in choices:
            raise unknown_name(key, value, choices, quantity=self._dotted(key)).within(self.where(key))
        return value

    def numbers(self, key: str, default: Any = REQUIRED) -> Any:
        """Return a list of finite numbers as a tuple."""
        values = self.get(key, list, "a list of finite numbers", default)
        if key in self.data and not all(type(one) in (int, float) and math.isfinite(one) for one in values):
            raise self.fault(key, "must be a list of finite numbers", "not_a_number")
        return tuple(float(one) for one in values) if key in self.data else values

    def strings(self, key: str, default: Any = REQUIRED) -> Any:
        """Return a list of texts as a tuple."""
        values = self.get(key, list, "a list of texts", default)
        if key in self.data and not all(isinstance(one, str) for one in values):
            raise self.fault(key, "must be a list of texts", "malformed")
        return tuple(values)

    def quantity(self, key: str, kinds: tuple[str, ...] = KINDS) -> Quantity:
        """Return a number with interval, kind and source; refuse one that lacks any of them."""

        def wrong(code: str, message: str, quantity: str = key) -> InputError:
            return InputError(f"{self.where(key)}: '{key}' {message}", code, quantity)

        if key not in self.data:
            message = f"{self.path.name}: '{key}' is missing; it needs value, low, high, kind and source"
            raise InputError(message, "missing", key)
        entry = self.data[key]
        if not isinstance(entry, dict):
            raise wrong("malformed", f"= {entry!r} is a bare number; give value, low, high, kind and source")
        if unknown := sorted(set(entry) - FIELDS):
            words = f"has unknown key '{unknown[0]}'; known are {', '.join(sorted(FIELDS))}"
            raise wrong("unknown_key", words, f"{key}.{unknown[0]}")
        if missing := sorted(FIELDS - set(entry)):
            raise wrong("missing", f"lacks {', '.join(missing)}", f"{key}.{missing[0]}")
        if (kind := entry["kind"]) not in kinds:
            raise wrong("unknown_name", f"has kind '{kind}'; known kinds are {', '.join(kinds)}", f"{key}.kind")
        if not str(entry["source"]).strip():
            raise wrong("no_source", "has an empty source; say where the number was read", f"{key}.source")
        try:
            value, low, high = (float(entry[name]) for name in ("value", "low", "high"))
        except (TypeError, ValueError):
            raise wrong("not_a_number", "needs numbers for value, low and high") from None
        if not all(math.isfinite(number) for number in (value, low, high)) or not low <= value <= high:
            raise wrong("inconsistent", f"needs finite low <= value <= high, given {low}, {value}, {high}")
        return Quantity(value, low, high, str(entry["kind"]), str(entry["source"]))

    def table(self, key: str, required: bool = True) -> TomlTable:
        """Return a table inside this one; an empty one where it may be left out."""
        data = self.get(key, dict, "a table", REQUIRED if required else {})
        return TomlTable(data, self.path, self.text, self._dotted(key), (*self.keys, f"[{self._dotted(key)}"))

    def tables(self, key: str, required: bool = True) -> list[TomlTable]:
        """Return the tables of a list ``[[key]]``."""
        items = self.get(key, list, "a list of tables", REQUIRED if required else [])
        if not all(isinstance(one, dict) for one in items) or (required and not items):
            raise self.fault(key, f"must be one or more [[{self._dotted(key)}]]", "malformed" if items else "missing")
        head, name = f"[[{self._dotted(key)}]]", self._dotted(key)
        lines = self.text.split("\n")
        starts = [at for at, line in enumerate(lines) if line.strip().startswith(head)]
        # the lines before each table are left blank, so that line numbers stay
        texts = ["\n" * at + "\n".join(lines[at:end]) for at, end in zip(starts, [*starts[1:], len(lines)])]
        texts += [self.text] * (len(items) - len(texts))
        return [TomlTable(one, self.path, text, name, (head,)) for one, text in zip(items, texts)]

    def _dotted(self, key: str) -> str:
        return f"{self.name}.{key}" if self.name else key


def read_table(path: Path, keys: Iterable[str] = (), schema: int | None = 1) -> TomlTable:
    """Read a TOML file as a table, refusing unknown keys (where keys are given) and another schema.

    Raises
    ------
    InputError
        With the file, and the line where there is one.
    """
    data, text = read_toml(path)
    top = TomlTable(data, path, text)
    if schema is not None and data.get("schema") != schema:
        raise top.fault("schema", f"is not known; this version reads schema = {schema}", "unsupported", schema)
    if keys:
        top.only(keys)
    return top
