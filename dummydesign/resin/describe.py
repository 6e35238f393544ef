"""Explain a resin: its curve with interval, its numbers with sources, a plot with anchor and band."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.files import csv_text, write_bytes, write_text
from dummydesign.core.serialise import to_plain
from dummydesign.resin.model.hardness import Hardness, expected_hardness
from dummydesign.resin.model.resin import Resin

ROWS, CURVE = 9, 61
SCATTER = "moduli of one Shore value differ by a factor of two"


def explain(resin: Resin) -> dict[str, Any]:
    """Return the resin's file, its curve over the ratio, its numbers by name, and warnings."""
    return {
        "name": resin.name,
        "origin": resin.origin,
        "resin": resin.to_dict(),
        "curve": [{**row, "hardness": expected_hardness(resin, row["ratio"]).to_dict()} for row in _curve(resin, ROWS)],
        "numbers": to_plain(
            {
                **resin.numbers,
                **{f"beta_at_{arm.tau_s.value:g}_s": arm.beta for arm in resin.arms},
                "softness_exponent": resin.softness_exponent,
                **{name: resin.property(name, resin.relaxation_ratio_ref) for name in resin.property_names()},
            }
        ),
        "warnings": resin_warnings(resin),
    }


def _curve(resin: Resin, rows: int) -> list[dict[str, Any]]:
    """Ratios with modulus and interval, sensitivity and Prony terms relative to the long-term modulus."""
    return [
        {
            "ratio": ratio,
            "young_kPa": resin.modulus_kPa(ratio).to_dict(),
            "d_ln_young_per_percent_ratio": 0.01 * resin.log_slope(ratio),
            "prony": to_plain(resin.prony(ratio)),
        }
        for ratio in np.linspace(
            resin.ratio_min, resin.ratio_max, rows if resin.ratio_min < resin.ratio_max else 1
        ).tolist()
    ]


def hardness_text(curve: list[dict[str, Any]]) -> str:
    """The reading that a durometer should show at the lowest, the central and the highest ratio."""
    rows = curve[:: max((len(curve) - 1) // 2, 1)]
    text = "; ".join(f"{Hardness(**row['hardness']).text} at ratio {row['ratio']:g}" for row in rows)
    return f"{text}. A rough check of a batch without a press: {SCATTER}"


def resin_warnings(resin: Resin) -> list[dict[str, str]]:
    """Say what of the resin is not measured, and which points contradict each other."""
    warnings = [{"code": "contradictory_points", "message": text} for text in resin.contradictions]
    if doubtful := resin.uncertain():
        message = f"{len(doubtful)} numbers of resin {resin.name} are inferred or assumed: {', '.join(doubtful)}"
        warnings.append({"code": "not_measured", "message": message})
    return warnings


def write_plot(resin: Resin, folder: Path) -> dict[str, str]:
    """Write modulus and relaxation against the ratio as SVG with the data as CSV; return {role: path}."""
    rows = _curve(resin, CURVE)
    ratios = [row["ratio"] for row in rows]
    young = np.array([[row["young_kPa"][end] for end in ("low", "value", "high")] for row in rows])
    beta = np.array([[term["beta"] for term in row["prony"]] for row in rows])
    names = [f"beta_at_{arm.tau_s.value:g}_s" for arm in resin.arms]
    head = ["ratio", "young_low_kPa", "young_kPa", "young_high_kPa", *names]
    cells = ([f"{value:.6g}" for value in (r, *y, *b)] for r, y, b in zip(ratios, young, beta))
    stem = f"resin-{resin.name}"
    return {
        "plot": str(write_bytes(folder / f"{stem}.svg", _draw(resin, ratios, young, beta, names))),
        "data": str(write_text(folder / f"{stem}.csv", csv_text(head, cells))),
    }


def _draw(resin: Resin, ratios: list[float], young: np.ndarray, beta: np.ndarray, names: list[str]) -> bytes:
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 6.4), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True)
    top.fill_between(ratios, young[:, 0], young[:, 2], alpha=0.25, label="95 % interval")
    top.plot(ratios, young[:, 1], label=f"law {resin.law.name}")
    for point in resin.points:
        q = point.young_kPa
        error = [[q.value - q.low], [q.high - q.value]]
        top.errorbar(point.ratio, q.value, yerr=error, fmt="o", color="black", label=f"point, {q.kind}")
    if {"ratio_ref", "young_ref_kPa"} <= set(resin.numbers):
        at, anchor = (resin.numbers[name] for name in ("ratio_ref", "young_ref_kPa"))
        top.plot(at.value, anchor.value, "ks", label=f"reference, {anchor.kind}")
    top.set(yscale="log", ylabel="long-term Young's modulus, kPa", title=resin.title)
    for column, name in zip(beta.T, names):
        bottom.plot(ratios, column, label=name.replace("_", " "))
    bottom.set(yscale="log", xlabel=resin.ratio_meaning, ylabel="strength over long-term modulus")
    for axes in (top, bottom):
        axes.grid(alpha=0.3)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize="small")
    stream = io.BytesIO()
    # the names inside an SVG are random without it
    with rc_context({"svg.hashsalt": "resin"}):
        figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()
