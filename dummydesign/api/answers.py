"""What the calls for scripts return: the same objects that the commands print, with tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dummydesign.api.display.values import Values, frame_of

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.design.sweep.spec import Study
    from dummydesign.tissue.fitting.fit import Fit


@dataclass(frozen=True, repr=False)
class Result(Values):
    """What a call found: ``found`` with all its objects, ``result`` the whole answer in values."""

    found: Any
    result: dict[str, Any]
    name: str = "answer"

    @property
    def call(self) -> str:
        """Name of the call."""
        return self.name

    def values(self) -> Mapping[str, Any]:
        """The whole answer, not copied."""
        return self.result

    @property
    def files(self) -> dict[str, Any]:
        """What was written, {role: path}."""
        return dict(self.result.get("files", {}))

    def plot(self, axes: Any = None) -> Any:
        """Draw the force with its interval over depth or time, for an answer of ``predict``; return the axes.

        Raises
        ------
        InputError
            For an answer that holds no force curve.
        """
        from dummydesign.api.display.plots import force_curve

        return force_curve(self.call, self.result, axes)


@dataclass(frozen=True, repr=False)
class Answer(Result):
    """What ``suggest`` found. ``found`` is the search with all its objects, ``result`` the whole answer in values."""

    found: Suggestion
    name: str = "suggest"

    def to_frame(self) -> Any:
        """Return recommendation and alternatives as a DataFrame, one row a design (needs pandas)."""
        designs = (self.result["recommendation"], *self.result["alternatives"])
        keys = ("thickness_mm", "ratio", "young_kPa", "scores")
        return frame_of([{key: design[key] for key in keys} for design in designs])


@dataclass(frozen=True, repr=False)
class Fitted(Result):
    """What ``fit`` found. ``found`` is the fit with all its objects, ``result`` the whole answer in values."""

    found: Fit
    name: str = "fit"

    def to_frame(self) -> Any:
        """Return the parameters with their intervals as a DataFrame, one row a parameter (needs pandas)."""
        records = []
        for name, entry in self.found.to_dict()["parameters"].items():
            parts = {name: entry} if "value" in entry else {f"{name} at {v} mm/s": e for v, e in entry.items()}
            records += [{"parameter": label, **one} for label, one in parts.items()]
        return frame_of(records)


@dataclass(frozen=True, repr=False)
class Rows(Values):
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

    @property
    def call(self) -> str:
        """Name of the call."""
        return "whatif"

    def values(self) -> Mapping[str, Any]:
        """The whole answer as plain values."""
        return {
            "inputs": dict(self.inputs),
            "warnings": [dict(item) for item in self.warnings],
            "sources": list(self.sources),
            "rows": [dict(row) for row in self.rows],
            "seconds": self.seconds,
            "resumed_rows": self.resumed_rows,
            "files": dict(self.files),
        }

    def records(self) -> list[dict[str, Any]]:
        """One row a design."""
        return [dict(row) for row in self.rows]

    def to_xarray(self) -> Any:
        """Return an xarray Dataset over what was varied, see :func:`dummydesign.api.display.datasets.dataset_of`."""
        from dummydesign.api.display.datasets import dataset_of

        return dataset_of(self.rows)
