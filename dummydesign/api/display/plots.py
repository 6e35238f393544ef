"""Plots of answers, by matplotlib."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dummydesign.core.errors import InputError

LABELS = {"depth_mm": "depth in mm", "time_s": "time in s"}


def force_curve(call: str, result: Mapping[str, Any], axes: Any = None) -> Any:
    """Draw a force with its interval over depth or time.

    Parameters
    ----------
    call : str
        Name of the call, for the message.
    result : mapping
        With ``force_N``, its low and high, and ``depth_mm`` or ``time_s``.
    axes : matplotlib.axes.Axes, optional
        New ones without it.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        When there is no such curve in the result.
    """
    along = next((name for name in ("time_s", "depth_mm") if isinstance(result.get(name), list)), None)
    if along is None or "force_low_N" not in result:
        raise InputError(f"plot draws force curves, which {call} has none of; use to_frame")
    if axes is None:
        from matplotlib.figure import Figure

        axes = Figure(figsize=(6.0, 3.8), layout="constrained").subplots()
    at = result[along]
    axes.fill_between(at, result["force_low_N"], result["force_high_N"], color="#1f4e79", alpha=0.2, linewidth=0)
    axes.plot(at, result["force_N"], color="#1f4e79")
    axes.set(xlabel=LABELS[along], ylabel="force in N")
    return axes
