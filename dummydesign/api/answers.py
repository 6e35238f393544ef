"""What the calls for scripts return: values as attributes, tables, plots, datasets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from copy import deepcopy
from dataclasses import dataclass, field
from os import fspath
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import FilePath
from dummydesign.core.serialise import Serialised, parameter_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.core.manifest import Question
    from dummydesign.core.outputs import Output
    from dummydesign.design.assessment.decision import Choice
    from dummydesign.design.assessment.pad_castings import Shares
    from dummydesign.design.scoring.verdict import Verdict
    from dummydesign.design.search.slabs import DesignCandidate
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.design.sweep.spec import Study
    from dummydesign.tissue.fitting.fit import TissueFit


COMMAND = {
    "import_traces": "import",
    "make_mould": "mold",
    "record_pad": "mold",
    "close_loop": "loop",
    **dict.fromkeys(("plan_campaign", "check_campaign", "campaign_from_files"), "campaign"),
}
"""Commands of calls that have another name."""
# A repr names so many values and is never longer than this.
SHOWN, LONGEST = 12, 900


class Values:
    """An answer in values. Subclasses have ``call``, the name of the call, and ``values()``, the whole answer."""

    call = "answer"

    def values(self) -> Mapping[str, Any]:
        """The whole answer, not copied."""
        raise NotImplementedError

    def __repr__(self) -> str:
        parts = [f"{name}={_short(value)}" for name, value in self.values().items() if name != "inputs"]
        more = [] if len(parts) <= SHOWN else [f"and {len(parts) - SHOWN} more"]
        text = f"{self.call}({', '.join(parts[:SHOWN] + more)})"
        return text if len(text) <= LONGEST else text[: LONGEST - 4] + "...)"

    def _repr_html_(self) -> str:
        """The first screen of the command."""
        from html import escape

        from dummydesign.cli.entry import screen_of

        command = COMMAND.get(self.call, self.call.replace("_", "-"))
        return f"<pre>{escape(screen_of(command, self.to_dict()))}</pre>"

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
        return _frame_of(self.records())

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
        lists = [
            value
            for name, value in known.items()
            if isinstance(value, list | tuple)
            and name != "warnings"
            and len(value) > 0
            and all(isinstance(one, Mapping) for one in value)
        ]
        if not lists:
            raise InputError(f"{self.call} has no table; use to_dict", "nothing_found", "table")
        return [dict(one) for one in max(lists, key=len)]


def _frame_of(records: Sequence[dict[str, Any]]) -> Any:
    """Make a pandas DataFrame; nested values become columns such as ``depth_mm_at_N.10``."""
    try:
        from pandas import json_normalize
    except ImportError:
        message = "to_frame needs pandas, which is not installed; pip install pandas, or use to_dict"
        raise InputError(message, "program_missing", "pandas") from None
    return json_normalize(list(records))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_column(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(_is_number(one) for one in value)


def _attribute(value: Any) -> Any:
    import numpy as np

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


VARIED = ("thickness_mm", "ratio", "shape", "punch", "edge_radius_mm", "condition", "base")
INNER = {"_at_N": "force_N", "peak_over_steady": "velocity_mm_s"}
"""Values that hold one number a force or a speed, by how their names end, and the dimension of that number."""


def dataset_of(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Make a Dataset of rows; combinations that were not worked out are NaN.

    Parameters
    ----------
    rows : sequence of mapping
        As ``whatif`` gives them.

    Returns
    -------
    xarray.Dataset
        Dimensions thickness_mm, ratio, shape, punch, edge_radius_mm, condition, base, and force_N or velocity_mm_s
        where a value depends on it; parts of the score are ``score_total`` and so on, ``limit`` is text.

    Raises
    ------
    InputError
        When xarray is not installed.
    """
    import numpy as np

    try:
        import xarray
    except ImportError:
        message = "to_xarray needs xarray, which is not installed; pip install xarray, or use to_dict"
        raise InputError(message, "program_missing", "xarray") from None
    axes = {name: list(dict.fromkeys(row[name] for row in rows)) for name in VARIED}
    for name in ("thickness_mm", "ratio"):
        axes[name].sort()
    shape = tuple(len(values) for values in axes.values())
    index = {name: {value: k for k, value in enumerate(values)} for name, values in axes.items()}
    variables: dict[str, tuple[tuple[str, ...], np.ndarray]] = {}
    inner: dict[str, list[float]] = {}
    for row in rows:
        at = tuple(index[name][row[name]] for name in VARIED)
        for name, value in _flat(row).items():
            if isinstance(value, Mapping):
                along = next(axis for ending, axis in INNER.items() if name.endswith(ending))
                inner.setdefault(along, [float(key) for key in value])
                if name not in variables:
                    variables[name] = ((*VARIED, along), np.full((*shape, len(value)), np.nan))
                variables[name][1][at] = np.array(list(value.values()), dtype=float)
            elif name == "limit":
                variables.setdefault(name, (VARIED, np.full(shape, "", dtype=object)))[1][at] = value or ""
            else:
                variables.setdefault(name, (VARIED, np.full(shape, np.nan)))[1][at] = np.nan if value is None else value
    return xarray.Dataset(variables, coords={**axes, **inner})


def _flat(row: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a row without what was varied; parts of the score by names of their own."""
    parts = {f"score_{part}": value for part, value in (row.get("score") or {}).items()}
    whole = {name: value for name, value in row.items() if name not in (*VARIED, "score")} | parts
    return {
        name: value for name, value in whole.items() if name == "limit" or not isinstance(value, str | list | tuple)
    }


IGNORED_INPUTS = ("out", "workers", "scheduler", "replace", "save_profile")
"""Inputs that an answer does not depend on."""


def question(
    command: str,
    inputs: Mapping[str, Any],
    *,
    tissue: str | None = None,
    resin: str | None = None,
    preset: str | None = None,
    files: Iterable[FilePath | None] = (),
    named: Mapping[str, FilePath] | None = None,
) -> Question:
    """Make the question of a call.

    Parameters
    ----------
    command : str
        Name of the command, as it is typed.
    inputs : mapping
        All values used, as the answer names them.
    tissue, resin, preset : str, optional
        Names of the library or paths.
    files : iterable of path
        Other files that are read; None is left out.
    named : mapping, optional
        Files by what they are, such as those of weights and limits.
    """
    from dummydesign.core.manifest import Question
    from dummydesign.core.user_library import find

    library = (
        ("materials/tissues", "tissue", tissue),
        ("materials/resins", "resin", resin),
        ("molds", "mould preset", preset),
    )
    read: dict[str, FilePath] = {
        f"{what} {name}": find(kind, what, name).path for kind, what, name in library if name is not None
    } | dict(named or {})
    read |= {fspath(path): path for path in files if path is not None}
    return Question(command, {key: value for key, value in inputs.items() if key not in IGNORED_INPUTS}, read)


def answer_folder(out: FilePath | None, asked: Question, replace: bool) -> AbstractContextManager[Output | None]:
    """Open the folder of an answer; None where nothing is to be written.

    Parameters
    ----------
    out : path, optional
        The requested folder.
    asked : Question
    replace : bool
        Take the place of another answer.
    """
    from dummydesign.core.outputs import new_folder

    return nullcontext() if out is None else new_folder(out, asked, replace=replace)


class Result(Values):
    """What a call found: ``outcome`` with all its objects, ``result`` the whole answer in values.

    Every key of the answer is an attribute: an object of the outcome where it has one of that name, such as the
    verdict, a list of numbers as an array, else the plain value.
    """

    def __init__(self, outcome: Any, result: dict[str, Any], call: str = "") -> None:
        self.outcome, self.result, self.call = outcome, result, call or self.call
        for name, value in result.items():
            if not hasattr(type(self), name):
                typed = getattr(outcome, name, None)
                setattr(self, name, typed if isinstance(typed, Serialised) else _attribute(value))

    def values(self) -> Mapping[str, Any]:
        """The whole answer, not copied."""
        return self.result

    @property
    def files(self) -> Any:
        """What was written, {role: path}; of an import a row a recording."""
        return deepcopy(self.result.get("files", {}))

    def plot(self, axes: Any = None) -> Any:
        """Draw the force with its interval over depth or time, for an answer of ``predict``; return the axes.

        Raises
        ------
        InputError
            For an answer that holds no force curve.
        """
        known = self.result
        along = next((name for name in ("time_s", "depth_mm") if isinstance(known.get(name), list)), None)
        if along is None or "force_low_N" not in known:
            message = f"plot draws force curves, which {self.call} has none of; use to_frame"
            raise InputError(message, "nothing_found", "force_N")
        if axes is None:
            from matplotlib.figure import Figure

            axes = Figure(figsize=(6.0, 3.8), layout="constrained").subplots()
        at = known[along]
        axes.fill_between(at, known["force_low_N"], known["force_high_N"], color="#1f4e79", alpha=0.2, linewidth=0)
        axes.plot(at, known["force_N"], color="#1f4e79")
        axes.set(xlabel={"depth_mm": "depth in mm", "time_s": "time in s"}[along], ylabel="force in N")
        return axes


class Answer(Result):
    """What ``suggest`` found. ``outcome`` is the search with all its objects, ``result`` the whole answer in values."""

    outcome: Suggestion
    verdict: Verdict
    shares: Shares
    choice: Choice
    call = "suggest"

    @property
    def design(self) -> DesignCandidate:
        """The recommended design: thickness, ratio, shape, readings, scores."""
        return self.outcome.best

    def to_frame(self) -> Any:
        """Return recommendation and alternatives as a DataFrame, one row a design (needs pandas)."""
        designs = (self.result["recommendation"], *self.result["alternatives"])
        keys = ("thickness_mm", "ratio", "young_kPa", "scores")
        return _frame_of([{key: design[key] for key in keys} for design in designs])


class Predicted(Result):
    """What ``predict`` found: the force with its interval over ``depth_mm``, or over ``time_s`` of one press."""

    force_N: NDArray
    force_low_N: NDArray
    force_high_N: NDArray
    depth_mm: NDArray
    time_s: NDArray
    displacement_mm: NDArray
    peak_force_N: float
    steady_force_N: float
    verdict: Verdict
    call = "predict"


class Fitted(Result):
    """What ``fit`` found. ``outcome`` is the fit with all its objects, ``result`` the whole answer in values."""

    outcome: TissueFit
    call = "fit"

    def to_frame(self) -> Any:
        """Return the parameters with their intervals as a DataFrame, one row a parameter (needs pandas)."""
        rows = parameter_rows(self.result["parameters"])
        return _frame_of([{"parameter": label, **one} for label, one in rows])


@dataclass(frozen=True, repr=False, eq=False)
class Rows(Values):
    """What ``whatif`` found: one row a design, in the study's order; ``inputs`` are all values used."""

    study: Study
    rows: tuple[dict[str, Any], ...]
    seconds: float
    inputs: dict[str, Any] = field(default_factory=dict)
    warnings: tuple[dict[str, str], ...] = ()
    sources: tuple[str, ...] = ()
    files: dict[str, str] = field(default_factory=dict)
    call: str = field(default="whatif", init=False)

    def values(self) -> Mapping[str, Any]:
        """The whole answer as plain values."""
        return {
            "inputs": dict(self.inputs),
            "warnings": [dict(item) for item in self.warnings],
            "sources": list(self.sources),
            "rows": self.records(),
            "seconds": self.seconds,
            "files": dict(self.files),
        }

    def records(self) -> list[dict[str, Any]]:
        """One row a design."""
        return [dict(row) for row in self.rows]

    def to_xarray(self) -> Any:
        """Return an xarray Dataset over what was varied, see :func:`dummydesign.api.answers.dataset_of`."""
        return dataset_of(self.rows)
