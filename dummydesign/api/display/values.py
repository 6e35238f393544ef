"""What all answers of the calls for scripts can do: values as attributes, a short repr, HTML, tables, plots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from html import escape
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError

# A repr names so many values and is never longer than this.
SHOWN, LONGEST = 12, 900


class Values:
    """An answer in values: ``answer.force_N`` is ``answer.to_dict()["force_N"]``, a list of numbers as an array.

    Subclasses have ``call``, the name of the call, and ``values()``, the whole answer as plain values.
    """

    @property
    def call(self) -> str:
        """Name of the call."""
        return "answer"

    def values(self) -> Mapping[str, Any]:
        """The whole answer, not copied."""
        raise NotImplementedError

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        known = self.values()
        if name in known:
            return _as_array(known[name])
        raise AttributeError(f"{self.call} has no '{name}'; it has {', '.join(sorted(known))}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.values()})

    def __repr__(self) -> str:
        parts = [f"{name}={_short(value)}" for name, value in self.values().items() if name != "inputs"]
        more = [] if len(parts) <= SHOWN else [f"and {len(parts) - SHOWN} more"]
        text = f"{self.call}({', '.join(parts[:SHOWN] + more)})"
        return text if len(text) <= LONGEST else text[: LONGEST - 4] + "...)"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(str(name))}</th><td style='text-align:left'>"
            f"{escape(_short(value, 90))}</td></tr>"
            for name, value in self.values().items()
        )
        return f"<table><caption>{escape(self.call)}</caption>{rows}</table>"

    def to_dict(self) -> dict[str, Any]:
        """Return the answer of the command with ``--json``, without its ``schema`` and ``version``."""
        return deepcopy(dict(self.values()))

    def to_frame(self) -> Any:
        """Return the answer's table as a DataFrame (needs pandas): its columns of equal length, or its records.

        Raises
        ------
        InputError
            When pandas is not installed, or nothing in the answer is a table.
        """
        return frame_of(self.records())

    def records(self) -> list[dict[str, Any]]:
        """Rows of the answer's table as plain values.

        Raises
        ------
        InputError
            When nothing in the answer is a table.
        """
        known = self.values()
        columns = {name: value for name, value in known.items() if _is_column(value)}
        if columns:
            length = max(len(value) for value in columns.values())
            same = {name: value for name, value in columns.items() if len(value) == length}
            return [dict(zip(same, row)) for row in zip(*same.values())]
        lists = {name: value for name, value in known.items() if _is_records(value) and name != "warnings"}
        if not lists:
            raise InputError(f"{self.call} has no table; use to_dict")
        return [dict(one) for one in max(lists.values(), key=len)]


def frame_of(records: Sequence[dict[str, Any]]) -> Any:
    """Make a pandas DataFrame; nested values become columns such as ``depth_mm_at_N.10``.

    Raises
    ------
    InputError
        When pandas is not installed.
    """
    try:
        from pandas import json_normalize
    except ImportError:
        raise InputError("to_frame needs pandas, which is not installed; pip install pandas, or use to_dict") from None
    return json_normalize(list(records))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_column(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(_is_number(one) for one in value)


def _is_records(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(isinstance(one, Mapping) for one in value)


def _as_array(value: Any) -> Any:
    return np.asarray(value, dtype=float) if _is_column(value) else deepcopy(value)


def _short(value: Any, longest: int = 60) -> str:
    if _is_number(value):
        return f"{value:.4g}"
    if _is_column(value):
        low, high = min(value), max(value)
        return f"[{len(value)} from {low:.4g} to {high:.4g}]" if len(value) > 1 else f"[{low:.4g}]"
    if isinstance(value, Mapping):
        text = "{" + ", ".join(str(key) for key in value) + "}"
    elif isinstance(value, list | tuple):
        text = f"[{len(value)}]"
    else:
        text = repr(value)
    return text if len(text) <= longest else text[: longest - 3] + "..."
