"""Figures of the loop's report: evidence with its threshold, residuals pad by pad, presses condition by condition."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.answer import named
from dummydesign.loop.result import LoopResult
from dummydesign.report.figures.layers import Band, Bars, Dots, Label, Line
from dummydesign.report.figures.plot import Plot
from dummydesign.report.press_figures import STYLES, log_start, unique

MOST_BARS = 12
FITTED_FROM = 2.0
"""Score from which an effect is fitted together with the base."""


def ranking_plots(data: dict[str, Any]) -> list[Plot]:
    """Score of every effect that was tested, and evidence of those that were fitted, with their thresholds.

    Parameters
    ----------
    data : dict
        The JSON of ``loop``.
    """
    return [*_screening(data), *_evidence(data)]


def _screening(data: dict[str, Any]) -> list[Plot]:
    rows = sorted(data["screening"], key=lambda row: -abs(row["z"]))[:MOST_BARS]
    if not rows:
        return []
    labels, z = [named(row["name"]) for row in rows], np.array([row["z"] for row in rows])
    words = "; ".join(f"{label} {value:.1f}" for label, value in zip(labels, z))
    top = float(len(rows))
    layers = (
        Bars("score", labels, np.minimum(z, 0.0), np.maximum(z, 0.0)),
        Line(f"fitted from {FITTED_FROM:g} on", [-FITTED_FROM, -FITTED_FROM, np.nan, FITTED_FROM, FITTED_FROM],
             [0.0, top, np.nan, 0.0, top], "aim"),
    )  # fmt: skip
    return [
        Plot("screening", "Score of each effect at the base model", f"Score of each effect: {words}.",
             "score [standard deviations]", "", "z", "none", layers, y_range=(0.0, top),
             note=f"the {len(rows)} largest of {len(data['screening'])}; one fit step, each effect alone")
    ]  # fmt: skip


def _evidence(data: dict[str, Any]) -> list[Plot]:
    """Evidence where several effects were fitted; the square root keeps the small ones in sight."""
    rows = data["ranking"][:MOST_BARS]
    if len(rows) < 2:
        return []
    labels = [named(row["name"]) for row in rows]
    gain = np.array([max(row["evidence"], 0.0) for row in rows])
    words = "; ".join(f"{label} {value:.0f}" for label, value in zip(labels, gain))
    needed, top = data["threshold"], float(len(rows))
    layers = (
        Bars("evidence", labels, np.zeros(len(rows)), np.sqrt(gain)),
        Line(f"needed: {needed:.0f}", [needed**0.5] * 2, [0.0, top], "aim"),
    )
    alt = f"Evidence of each effect alone: {words}; {needed:.0f} are needed."
    return [
        Plot("evidence", "Evidence of each effect alone", alt, "root of evidence [-]", "", "root_of_evidence", "none",
             layers, x_range=(0.0, 1.05 * max(float(np.sqrt(gain.max())), needed**0.5)), y_range=(0.0, top),
             note="evidence: drop of minus twice the log likelihood against the base model")
    ]  # fmt: skip


def trial_plot(result: LoopResult, data: dict[str, Any]) -> Plot:
    """Rms residual of each trial before and after, with the noise floor."""
    rows = data["residual"]["by_trial"]
    place = np.arange(1, len(rows) + 1, dtype=float)

    def column(key: str) -> NDArray:
        return np.array([np.nan if row[key] is None else row[key] for row in rows])

    floor = data["after"]["error"]["noise_floor_N"]
    layers = (
        Dots("base", place, column("base_rmse_N"), "aim"),
        Dots("corrected", place, column("rmse_N")),
        Dots("corrected, its condition left out", place, column("heldout_rmse_N"), "other"),
        Line("noise floor", place[[0, -1]], [floor, floor], "other"),
    )
    worst = max(rows, key=lambda row: row["rmse_N"])
    alt = (
        f"Rms residual of each of {len(rows)} trials before and after; the worst after is {worst['file']} with "
        f"{worst['rmse_N']:.3g} N, it was {worst['base_rmse_N']:.3g} N; the noise floor is {floor:.3g} N."
    )
    return Plot("by-trial", "Rms residual of each trial", alt, "trial [number in the campaign]", "rms residual [N]",
                "trial", "rmse_N", layers, note="in the order of campaign.toml")  # fmt: skip


def _groups(result: LoopResult) -> Iterator[tuple[str, NDArray]]:
    """Name and rows of each condition, by thickness, speed and depth."""
    presses = result.presses
    groups = [np.nonzero(presses.cell == cell)[0] for cell in np.unique(presses.cell)]
    groups.sort(key=lambda rows: (presses.thickness_mm[rows[0]], presses.trials[rows[0]].velocity_mm_s,
                                  presses.depth_mm[rows[0]]))  # fmt: skip
    for rows in groups:
        trial = presses.trials[rows[0]]
        force = trial.target_force_N
        level = f"{force:g} N" if force is not None else f"{presses.depth_mm[rows[0]]:.2g} mm deep"
        yield f"{trial.thickness_mm:g} mm, {trial.velocity_mm_s:g} mm/s, {level}", rows


def _times(result: LoopResult, row: int) -> tuple[NDArray, NDArray]:
    """Bins that are used and lie after contact, and their times since contact. [s]"""
    presses = result.presses
    middle = 0.5 * (presses.bins.start[row] + presses.bins.end[row]) - presses.contact_s[row]
    shown = presses.used[row] & (middle > 0)
    return shown, middle[shown]


def residual_plots(result: LoopResult) -> list[Plot]:
    """One figure a pad, all at one scale: what the base model and the corrected one leave of every trial."""
    presses, floor = result.presses, 3.0 * result.after.fit.sizes.floor_N
    stages = (("base", result.base, "aim"), ("corrected", result.after, "main"))
    if result.base is result.after:
        stages = stages[1:]
    left = {name: np.where(presses.used, presses.force_N - stage.fit.forces, 0.0) for name, stage, _ in stages}
    times = [_times(result, row) for row in range(len(presses.trials))]
    reach = max(1.5 * floor, *(float(np.abs(values).max()) for values in left.values()))
    ends = (max(min(float(time[0]) for _, time in times), 1e-3), max(float(time[-1]) for _, time in times))
    plots = []
    for number, (shape, thickness) in enumerate(presses.pads):
        rows = np.nonzero(presses.pad == number)[0]
        layers: list[Band | Line | Label] = [
            Band("three noise floors", np.array(ends), np.full(2, -floor), np.full(2, floor))
        ]
        words = []
        for name, _, style in stages:
            curves = [Line(name, times[row][1], left[name][row][times[row][0]], style) for row in rows]
            most = max(curves, key=lambda curve: float(np.max(np.abs(curve.y))))
            at = int(np.argmax(np.abs(most.y)))
            layers += [*curves, Label(name, float(most.x[at]), float(most.y[at]), style)]
            words.append(f"{name} at most {abs(float(most.y[at])):.3g} N")
        pad = f"{thickness:g} mm{' ' + shape if shape else ''}"
        plots.append(
            Plot(f"residual-pad-{number + 1}", f"Residual on the {pad} pad", f"{pad}: {'; '.join(words)}.",
                 "time since contact [s]", "measured - modelled [N]", "time_s", "residual_N", tuple(layers),
                 log_x=True, x_range=ends, y_range=(-1.05 * reach, 1.05 * reach))
        )  # fmt: skip
    return plots


def press_plots(result: LoopResult) -> Iterator[Plot]:
    """Force over time of each condition: measured, base and corrected."""
    presses, names = result.presses, set()
    base, after = (stage.fit.forces for stage in (result.base, result.after))
    for label, rows in _groups(result):
        layers: list[Dots | Line] = []
        ends, rises, rms = [], [], []
        for number, row in enumerate(rows):
            shown, time = _times(result, row)
            own = "" if len(rows) == 1 else f", {presses.trials[row].file}"
            layers.append(Dots(f"measured{own}", time, presses.force_N[row][shown],
                               "other" if len(rows) == 1 else STYLES[number % len(STYLES)]))  # fmt: skip
            layers.append(Line(f"base{own}", time, base[row][shown], "aim"))
            layers.append(Line(f"corrected{own}", time, after[row][shown], STYLES[number % len(STYLES)]))
            ends.append(float(time[-1]))
            rises.append(float(presses.stop_s[row] - presses.contact_s[row]))
            rms.append((result.base.errors.by_trial_N[row], result.after.errors.by_trial_N[row]))
        before, left = (float(np.sqrt(np.mean(np.square(column)))) for column in zip(*rms))
        peak = float(presses.force_N[rows].max())
        alt = (
            f"Force over time on a logarithmic axis, {label}: peak {peak:.3g} N, rms residual {before:.3g} N before "
            f"and {left:.3g} N after."
        )
        name = unique("press-" + label.replace(" mm/s", "mm-s").replace(", ", "-").replace(" ", ""), names)
        yield Plot(name, f"{label}: {1e3 * before:.0f} to {1e3 * left:.0f} mN", alt, "time since contact [s]",
                   "force [N]", "time_s", "force_N", tuple(layers), log_x=True,
                   x_range=(log_start(min(rises)), max(ends)))  # fmt: skip
