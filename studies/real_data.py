"""Real presses of other laboratories: ``python -m studies.real_data MEAT_DIR ADHESIVE_DIR``.

The measurements are not part of this repository. MEAT_DIR is the folder ``indentation/experiments`` of Iaquinta,
perineal_indentation (GPL-3.0): indentation of two cuts of beef (FF faux filet, RDG rond de gite), with rise and hold.
ADHESIVE_DIR is the folder ``cyclic-shear-relaxation-test/exp-data`` of Zhao, Viscoelastic-fitting (MIT): an optically
clear adhesive sheared in steps. Writes ``docs/data/real-data.csv`` and the tables of ``docs/real-data.md``.

Every group (a piece of meat on one day; the four rates of the adhesive) is fitted without the presses that are then
predicted. The errors are rms over a press's rise and hold, relative to its largest force.
"""

from __future__ import annotations

import argparse
import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.decisions import Settings
from dummydesign.measurement.importing.read import Imported, import_files
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.fit import fit_traces
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.model.maxwell_law import law_named
from studies.marked_page import MarkedPage

REPOSITORY = Path(__file__).resolve().parents[1]
ROWS = Path("docs", "data", "real-data.csv")
PAGE = MarkedPage(Path("docs", "real-data.md"), "<!-- errors -->", "<!-- end of errors -->")
FEWEST = 4
"""Presses of a group: fewer are not parted into fitted and predicted ones."""
RATES = ("0d1", "1", "2", "5")
SWAPPED = "0d1"
"""The file of the adhesive in which displacement stands before force."""
FIELDS = (
    "source",
    "group",
    "press",
    "depth_mm",
    "velocity_mm_s",
    "peak_N",
    "elements",
    "error_spring",
    "error_law",
    "error_law_scaled",
    "scale",
    "error_law_shifted",
    "shift_mm",
    "error_linear",
)


@dataclass(frozen=True)
class Law:
    """The law of soft tissue, as fitted to some presses."""

    elements: int
    gamma1: float
    gamma: tuple[float, ...]
    damper: tuple[float, ...]

    def force_N(self, trace: Trace, shift_mm: float = 0.0) -> np.ndarray:
        """Force along the measured motion of a press whose surface lies deeper than its zero says. [N]"""
        motion = Motion(trace.time_s, np.maximum(trace.displacement_mm - shift_mm, 0.0))
        return np.asarray(law_named("ode").force(motion, self.gamma1, np.array(self.gamma), np.array(self.damper)))


def fitted(traces: Sequence[Trace]) -> Law:
    """Fit 3, 5 or 7 elements, as ``fit`` chooses, with parameters shared by all presses."""
    fit = fit_traces(traces, mode="joint", intervals=False)
    problem, optimum = fit.problems[0]
    gamma1, gamma, damper = problem.split(optimum.solution.parameters, optimum.arms)
    values = (tuple(np.exp(part).ravel().tolist()) for part in (gamma, damper[0]))
    return Law(fit.result["elements"], float(np.exp(gamma1)), *values)


def spring_N_per_mm3(traces: Sequence[Trace]) -> float:
    """The spring of the law alone, by least squares: the base, which knows no relaxation."""
    cube = np.concatenate([np.maximum(trace.displacement_mm, 0.0) ** 3 for trace in traces])
    force = np.concatenate([trace.force_N for trace in traces])
    return float(cube @ force / (cube @ cube))


@dataclass(frozen=True)
class Linear:
    """A linear spring and two linear Maxwell branches, which the tissue law has not: a check of its form."""

    spring: float
    branches: tuple[float, float]
    tau_s: tuple[float, float]

    def force_N(self, trace: Trace) -> np.ndarray:
        """Force along the measured motion, exact between samples that are joined by straight lines. [N]"""
        step, way = np.diff(trace.time_s), np.diff(trace.displacement_mm)
        force = self.spring * trace.displacement_mm
        for stiffness, tau in zip(self.branches, self.tau_s):
            kept = np.exp(-step / tau)
            gained = stiffness * way / step * tau * (1.0 - kept)
            branch = np.zeros(len(force))
            for at in range(len(step)):
                branch[at + 1] = kept[at] * branch[at] + gained[at]
            force = force + branch
        return force


def fitted_linear(traces: Sequence[Trace]) -> Linear:
    """Fit the linear branches by least squares in logarithms, each press relative to its largest force."""
    from scipy.optimize import least_squares

    def made(logs: np.ndarray) -> Linear:
        spring, one, two, fast, slow = np.exp(logs).tolist()
        return Linear(spring, (one, two), (fast, slow))

    def residual(logs: np.ndarray) -> np.ndarray:
        law = made(logs)
        return np.concatenate([(law.force_N(one) - one.force_N) / one.force_N.max() for one in traces])

    stiffness = max(float(one.force_N.max() / one.displacement_mm.max()) for one in traces)
    start = np.log([0.4 * stiffness, 0.5 * stiffness, 0.3 * stiffness, 3.0, 60.0])
    return made(least_squares(residual, start).x)


def errors(trace: Trace, spring: float, law: Law, linear: Linear) -> tuple[float, ...]:
    """Errors of the spring and the law; of the law with a factor, and with a zero, fitted to this press; of the linear.

    In the order of ``FIELDS``, with the factor and the zero [mm] behind their errors.
    """
    from scipy.optimize import minimize_scalar

    held = trace.time_s <= reduce_trace(trace).ramp.hold_end_s
    force, peak = trace.force_N[held], float(trace.force_N[held].max())
    predicted = law.force_N(trace)[held]
    scale = float(predicted @ force / max(predicted @ predicted, 1e-300))

    def error(model: np.ndarray) -> float:
        return float(np.sqrt(np.mean((model - force) ** 2)) / peak)

    deepest = float(trace.displacement_mm.max())
    moved = minimize_scalar(
        lambda shift: error(law.force_N(trace, shift)[held]), bounds=(-0.5 * deepest, 0.5 * deepest), method="bounded"
    )
    base = error(spring * np.maximum(trace.displacement_mm[held], 0.0) ** 3)
    return (
        base,
        error(predicted),
        error(scale * predicted),
        scale,
        float(moved.fun),
        float(moved.x),
        error(linear.force_N(trace)[held]),
    )


def predicted_rows(source: str, group: str, traces: Sequence[Trace], folds: int) -> list[dict[str, object]]:
    """Fit all presses but those of one fold, and predict these; every press is predicted once."""
    rows = []
    for fold in range(folds):
        kept = [trace for at, trace in enumerate(traces) if at % folds != fold]
        law, spring, linear = fitted(kept), spring_N_per_mm3(kept), fitted_linear(kept)
        for trace in traces[fold::folds]:
            reduced = reduce_trace(trace)
            values = reduced.ramp.depth_mm, reduced.velocity_mm_s, float(trace.force_N.max())
            results = law.elements, *errors(trace, spring, law, linear)
            rows.append(dict(zip(FIELDS, (source, group, trace.name, *values, *results), strict=True)))
    return rows


def meat_presses(folder: Path) -> tuple[dict[str, list[Trace]], list[Imported], int]:
    """Presses of the indentation workbooks by day and piece, all tests read, and those that ask for the tare."""
    groups: dict[str, list[Trace]] = {}
    every: list[Imported] = []
    asked = 0
    for path in sorted(folder.glob("zwick/raw_data/23*/*_force.xlsx")):
        read, _ = import_files([path], Settings(tare="first"))
        every += read
        asked += _asking(path)
        for one in read:
            piece = re.search(r"(RDG|FF)\d", one.sheet.upper())
            if piece is None:
                continue  # an average that the machine adds
            traces = [Trace(one.sheet, press.time_s, press.displacement_mm, press.force_N) for press in one.presses]
            groups.setdefault(f"{path.parent.name} {piece[0]}", []).extend(traces)
    return groups, every, asked


def _asking(path: Path) -> int:
    """Sheets of a workbook that are not read without an answer."""
    try:
        import_files([path])
    except InputError as question:
        more = re.search(r"and (\d+) of", str(question))
        return 1 + (int(more[1]) if more else 0)
    return 0


def adhesive_presses(folder: Path) -> list[Trace]:
    """First step of the staircase of each rate, from its beginning to the end of its hold."""
    traces = []
    for rate in RATES:
        order = {"time": "1", "force": "3" if rate == SWAPPED else "2", "displacement": "2" if rate == SWAPPED else "3"}
        units = {"time": "s", "force": "N", "displacement": "mm"}
        path = folder / f"shear_relaxation_{rate}.xlsx"
        press = import_files([path], Settings(columns=order, units=units, tare="none"))[0][0].presses[0]
        first = press.displacement_mm < 1.05 * 0.26
        end = len(first) if first.all() else int(np.argmin(first))
        traces.append(Trace(rate, press.time_s[:end], press.displacement_mm[:end], press.force_N[:end]))
    return traces


def usable(traces: Iterable[Trace]) -> list[Trace]:
    """The presses that a fit accepts."""
    kept = []
    for trace in traces:
        try:
            reduce_trace(trace)
        except InputError:
            continue
        kept.append(trace)
    return kept


def table(rows: Sequence[dict[str, object]]) -> str:
    """One line a source: medians over its presses, in percent of the largest force; in brackets those of its days."""
    lines = [
        "| source | presses | elements | spring alone | law | own factor | own zero | linear branches | factor |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    names = "error_spring", "error_law", "error_law_scaled", "error_law_shifted", "error_linear"
    for source in dict.fromkeys(str(row["source"]) for row in rows):
        mine = [row for row in rows if row["source"] == source]
        days = list(dict.fromkeys(_day(row) for row in mine))
        cells = []
        for key in names:
            each = [_percent([row for row in mine if _day(row) == day], key) for day in days]
            span = f" ({min(each):.0f} to {max(each):.0f})" if len(days) > 1 else ""
            cells.append(f"{_percent(mine, key):.0f} %{span}")
        count = ", ".join(sorted({str(row["elements"]) for row in mine}))
        factors = [float(str(row["scale"])) for row in mine]
        factor = f"{min(factors):.2f} to {max(factors):.2f}"
        lines.append(f"| {source} | {len(mine)} | {count} | {' | '.join(cells)} | {factor} |")
    return "\n".join(lines)


def _percent(rows: Sequence[dict[str, object]], key: str) -> float:
    """Median of a share, in percent."""
    return 100 * float(np.median([float(str(row[key])) for row in rows]))


def _day(row: dict[str, object]) -> str:
    """Group without the piece of meat: ``230327 FF1`` is of 230327."""
    return re.sub(r" (RDG|FF)\d$", "", str(row["group"]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Read, fit, predict; write the rows and the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meat", type=Path, metavar="MEAT_DIR")
    parser.add_argument("adhesive", type=Path, metavar="ADHESIVE_DIR")
    options = parser.parse_args(arguments)
    PAGE.read(REPOSITORY)
    groups, every, asked = meat_presses(options.meat)
    rows = []
    for group, traces in sorted(groups.items()):
        kept = usable(traces)
        print(f"{group}: {len(kept)} of {len(traces)} presses", flush=True)
        if len(kept) >= FEWEST:
            rows += predicted_rows("beef", group, kept, folds=2)
    adhesive = predicted_rows("adhesive", "first step", adhesive_presses(options.adhesive), folds=len(RATES))
    print(f"{len(every)} sheets read, {asked} of them after a question")
    shown = [{k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows + adhesive]
    with (REPOSITORY / ROWS).open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(shown)
    PAGE.write(REPOSITORY, table(shown) + "\n")


if __name__ == "__main__":
    main()
