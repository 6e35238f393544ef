"""Which way position and force count: compression is made positive by what the recording does, not by its words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes, Settings, question

_BOTH_WAYS = 0.4
"""Share of the larger swing of the force above which the smaller one leaves open which of them is pressing."""


@dataclass(frozen=True)
class Signs:
    """Factors that make compression positive, and the force at rest as the file counts it."""

    displacement: float
    force: float
    rest_force_N: float


def middle_of_three(values: NDArray) -> NDArray:
    """Median of each value and its two neighbours: single spikes disappear, edges stay."""
    if len(values) < 3:
        return values.copy()
    a, b, c = values[:-2], values[1:-1], values[2:]
    inner = np.maximum(np.minimum(a, b), np.minimum(np.maximum(a, b), c))
    return np.concatenate([values[:1], inner, values[-1:]])


def noise_of(force: NDArray) -> float:
    """Sample noise by second differences, which a smooth force does not have. [N]"""
    if len(force) < 5:
        return 0.0
    second = np.abs(force[2:] - 2.0 * force[1:-1] + force[:-2])
    return float(np.median(second) / 0.6745 / np.sqrt(6.0))


def find_signs(file: str, x: NDArray, force: NDArray, settings: Settings, tare_N: float | None, notes: Notes) -> Signs:
    """Find which way both columns count.

    The recording begins at rest; the force that goes farthest from there is that of pressing, and the position
    goes into the pad while this force rises.

    Parameters
    ----------
    file : str
        Name for messages.
    x, force : ndarray, shape (n,)
        As the file counts them. [mm, N]
    settings : Settings
        Signs that the user settled.
    tare_N : float, optional
        Reading at no force, where the user gave it. [N]
    notes : Notes
        Receives the decisions.

    Raises
    ------
    InputError
        When nothing is pressed.
    QuestionError
        When the force swings both ways, begins loaded, or the position goes both ways.
    """
    smooth = middle_of_three(force)
    moved = np.abs(x - x[0]) > 0.01 * float(np.ptp(x))
    few = int(np.clip(np.argmax(moved) if moved.any() else 0, 1, 50))
    rest = float(np.median(force[:few])) if tare_N is None else tare_N
    up, down = float(smooth.max() - rest), float(rest - smooth.min())
    swing = max(up, down)
    if swing <= 0 or swing < 8.0 * noise_of(force):
        raise InputError(
            f"{file}: nothing is pressed: the force stays within {swing:.3g} N of {rest:.4g} N; "
            "is this the force column, and the right file? (--columns force=NAME)"
        )
    if settings.flip is not None:
        way, push = (-1.0 if name in settings.flip else 1.0 for name in ("displacement", "force"))
        signs = Signs(way, push, rest)
        _check_given(file, x, smooth, signs)
        for name in ("displacement", "force"):
            notes.decide(f"{name} sign", "flipped" if name in settings.flip else "as written", "given by --flip")
        return signs
    if min(up, down) > _BOTH_WAYS * swing:
        doubt = f"from {rest:.3g} N the force goes {up:.3g} N up and {down:.3g} N down; either may be pressing"
        raise question(file, doubt, "--flip force where pressing is negative, --flip none where it is positive")
    sign = 1.0 if up >= down else -1.0
    _refuse_loaded_start(file, smooth, rest, sign, swing, tare_N)
    load = sign * (smooth - rest)
    way = _way(file, x, load)
    notes.decide("force sign", _word(sign), f"pressing moves it by {sign * swing:+.3g} N from its reading at rest")
    notes.decide("displacement sign", _word(way), f"it {'rises' if way > 0 else 'falls'} while the force rises")
    return Signs(way, sign, rest)


def _word(sign: float) -> str:
    return "as written" if sign > 0 else "flipped"


def _way(file: str, x: NDArray, load: NDArray) -> float:
    """Sign of the position: its change while the load goes from a twentieth to half of its largest."""
    peak = int(np.argmax(load))
    half = int(np.argmax(load >= 0.5 * load[peak]))
    low = np.nonzero(load[: half + 1] <= 0.05 * load[peak])[0]
    start = int(low[-1]) if low.size else 0
    rise = float(x[half] - x[start])
    deep, out = x[load >= 0.5 * load[peak]], x[load <= 0.1 * load[peak]]
    overall = float(np.median(deep) - np.median(out)) if out.size else rise
    if float(np.ptp(x)) <= 0:
        raise InputError(f"{file}: the displacement never moves; name its column by --columns displacement=NAME")
    if rise == 0 or rise * overall < 0 or abs(rise) < 1e-3 * float(np.ptp(x)):
        doubt = f"while the force rises the position moves by {rise:+.3g} mm, over the whole press by {overall:+.3g} mm"
        raise question(file, doubt, "--flip displacement where it falls while pressing, --flip none where it rises")
    return 1.0 if rise > 0 else -1.0


def _refuse_loaded_start(
    file: str, smooth: NDArray, rest: float, sign: float, swing: float, tare_N: float | None
) -> None:
    """A recording that begins pressed and ends free looks like a press of the other sign on a large offset."""
    other = rest + sign * swing
    if tare_N is None and abs(rest) > 0.5 * swing and abs(other) < 0.25 * abs(rest):
        raise question(
            file,
            f"the force is {rest:.3g} N at the start and near zero later: either the file begins pressed (then record "
            "from before contact), or this is an offset",
            f"--tare {rest:.4g} where it is an offset",
        )


def _check_given(file: str, x: NDArray, smooth: NDArray, signs: Signs) -> None:
    load = signs.force * (smooth - signs.rest_force_N)
    if load.max() < -load.min():
        raise InputError(f"{file}: with --flip as given the force falls while pressing; turn --flip force round")
    if _way(file, x, load) * signs.displacement < 0:
        raise InputError(
            f"{file}: with --flip as given the punch moves out while the force rises; turn --flip displacement round"
        )
