"""What the calls for scripts return: the same objects that the commands print, with tables."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.design.sweep.spec import Study
    from dummydesign.tissue.fitting.fit import Fit


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


@dataclass(frozen=True)
class Answer:
    """What ``suggest`` found. ``found`` is the search with all its objects, ``result`` the whole answer in values."""

    found: Suggestion
    result: dict[str, Any]

    @property
    def files(self) -> dict[str, str]:
        """What was written, {role: path}."""
        return dict(self.result["files"])

    def to_dict(self) -> dict[str, Any]:
        """Return the answer of ``dummydesign suggest --json``, without its ``schema`` and ``version``."""
        return deepcopy(self.result)

    def to_frame(self) -> Any:
        """Return recommendation and alternatives as a DataFrame, one row a design (needs pandas)."""
        designs = (self.result["recommendation"], *self.result["alternatives"])
        keys = ("thickness_mm", "ratio", "young_kPa", "scores")
        return frame_of([{key: design[key] for key in keys} for design in designs])


@dataclass(frozen=True)
class Rows:
    """What ``whatif`` found: one row a design, in the study's order.

    ``inputs`` are all values used, ``resumed_rows`` the number of rows that were there before.
    """

    study: Study
    rows: tuple[dict[str, Any], ...]
    seconds: float
    inputs: dict[str, Any] = field(default_factory=dict)
    warnings: tuple[dict[str, str], ...] = ()
    sources: tuple[str, ...] = ()
    resumed_rows: int = 0
    files: dict[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the answer of ``dummydesign whatif --json``, without its ``schema`` and ``version``."""
        return {
            "inputs": dict(self.inputs),
            "warnings": [dict(item) for item in self.warnings],
            "sources": list(self.sources),
            "rows": [dict(row) for row in self.rows],
            "seconds": self.seconds,
            "resumed_rows": self.resumed_rows,
            "files": dict(self.files),
        }

    def to_frame(self) -> Any:
        """Return the rows as a DataFrame, one row a design (needs pandas)."""
        return frame_of(self.rows)


@dataclass(frozen=True)
class Fitted:
    """What ``fit`` found. ``found`` is the fit with all its objects, ``result`` the whole answer in values."""

    found: Fit
    result: dict[str, Any]

    @property
    def files(self) -> dict[str, str]:
        """What was written, {role: path}."""
        return dict(self.result["files"])

    def to_dict(self) -> dict[str, Any]:
        """Return the answer of ``dummydesign fit --json``, without its ``schema`` and ``version``."""
        return deepcopy(self.result)

    def to_frame(self) -> Any:
        """Return the parameters with their intervals as a DataFrame, one row a parameter (needs pandas)."""
        records = []
        for name, entry in self.found.to_dict()["parameters"].items():
            parts = {name: entry} if "value" in entry else {f"{name} at {v} mm/s": e for v, e in entry.items()}
            records += [{"parameter": label, **one} for label, one in parts.items()]
        return frame_of(records)


@dataclass(frozen=True)
class Result:
    """What another call found: ``found`` with all its objects, ``result`` the whole answer in values."""

    found: Any
    result: dict[str, Any]

    @property
    def files(self) -> dict[str, str]:
        """What was written, {role: path}."""
        return dict(self.result.get("files", {}))

    def to_dict(self) -> dict[str, Any]:
        """Return the answer of the command with ``--json``, without its ``schema`` and ``version``."""
        return deepcopy(self.result)
