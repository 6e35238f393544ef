"""Files of a comparison: tables as CSV, the curves in their ranges as a picture, and the report."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.files import write_bytes, write_text
from dummydesign.report.compare import write_compare_report
from dummydesign.tissue.comparison.compare import Comparison
from dummydesign.tissue.model.ranges import interpolate_rows
from dummydesign.tissue.model.tissue import Tissue


def write_comparison(
    found: Comparison, tissue: Tissue, folder: Path, verdict: dict[str, Any] | None = None
) -> dict[str, str]:
    """Write parametric.csv, steady_state.csv, force_variation.csv, ranges.png, compare.json and the report.

    Parameters
    ----------
    found : Comparison
        What was compared.
    tissue : Tissue
        With whom.
    folder : Path
        Where the files go.
    verdict : dict, optional
        First on the page.

    Returns
    -------
    dict
        Paths of the files by role.
    """
    files = {
        "parametric": write_text(folder / "parametric.csv", _parametric(found)),
        "steady_state": write_text(folder / "steady_state.csv", _steady(found)),
        "force_variation": write_text(folder / "force_variation.csv", _force_variation(found)),
        "picture": write_bytes(folder / "ranges.png", _picture(found, tissue)),
        "json": write_text(folder / "compare.json", json.dumps({"verdict": verdict, **found.result}, indent=1) + "\n"),
    }
    report = write_compare_report(folder, found, tissue, tissue.sources, verdict)
    return {role: str(path) for role, path in files.items()} | report


def _parametric(found: Comparison) -> str:
    keys = ("value", "low", "high", "band_low", "band_high", "inside")
    lines = ["parameter," + ",".join(keys)]
    for name, row in found.result["parametric"].items():
        lines.append(name + "".join("," if row[key] is None else f",{row[key]}" for key in keys))
    return "\n".join(lines) + "\n"


def _steady(found: Comparison) -> str:
    low, high = found.range_mm
    lines = ["force_N,depth_mm,range_low_mm,range_high_mm"]
    for force, depth, least, most in zip(found.grid_N, found.steady, low, high):
        lines.append(f"{force:.4g},{'' if np.isnan(depth) else f'{depth:.5g}'},{least:.5g},{most:.5g}")
    return "\n".join(lines) + "\n"


def _force_variation(found: Comparison) -> str:
    lines = ["file,time_s,force_N,range_low_N,range_high_N"]
    for trace, band in found.presses:
        time = trace.trace.time_s[trace.inside] - trace.ramp.contact_time_s
        force = trace.trace.force_N[trace.inside]
        at = band.time_s[:: max(len(band.time_s) // 300, 1)]
        seen = interpolate_rows(at[None], time[None], force[None])[0]
        low, high = np.interp(at, band.time_s, band.low_N), np.interp(at, band.time_s, band.high_N)
        for row in zip(at, seen, low, high):
            lines.append(trace.trace.name + "".join(f",{number:.6g}" for number in row))
    return "\n".join(lines) + "\n"


def _picture(found: Comparison, tissue: Tissue) -> bytes:
    """PNG: the steady-state range with the dummy's points, and F(t) in its range per condition."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    shown: dict[tuple[float, int], tuple] = {}
    for trace, band in found.presses:
        shown.setdefault((band.velocity_mm_s, round(band.steady_force_N)), (trace, band))
    count = len(shown) + 1
    columns = min(count, 4)
    figure = Figure(figsize=(3.6 * columns, 3.2 * -(-count // columns)), layout="constrained")
    axes = np.ravel(figure.subplots(-(-count // columns), columns, squeeze=False))
    low, high = found.range_mm
    axes[0].fill_betweenx(found.grid_N, low, high, color="0.85", label=tissue.name)
    axes[0].plot(found.steady, found.grid_N, lw=1.2, label="dummy")
    axes[0].plot(found.points[:, 0], found.points[:, 1], "o", ms=4, label="measured")
    axes[0].set(xlabel="depth [mm]", ylabel="steady force [N]", title="steady state")
    axes[0].legend(fontsize=7)
    for place, (trace, band) in zip(axes[1:], shown.values()):
        time = trace.trace.time_s[trace.inside] - trace.ramp.contact_time_s
        place.fill_between(np.maximum(band.time_s, 1e-4), band.low_N, band.high_N, color="0.85")
        place.semilogx(np.maximum(time, 1e-4), trace.trace.force_N[trace.inside], lw=1.0)
        place.set(
            xlabel="time since contact [s]", ylabel="force [N]", xlim=(0.1 * trace.ramp.rise_time_s, time[-1]),
            title=f"{band.velocity_mm_s:g} mm/s, {band.steady_force_N:.1f} N",
        )  # fmt: skip
    for place in axes[count:]:
        place.set_visible(False)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=110)
    return stream.getvalue()
