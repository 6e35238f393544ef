"""Whether a law follows a person's curves, by what a design is judged by: peaks, steady forces and energies.

What the fitted law misses of them is compared with what the same person's presses differ by when they are repeated.
Without repeats that is what 0.02 mm of depth (95 %) and the noise make of them, and in no case less than the tolerances
of the verdict, 1 % of the steady force and 2 % of the energy. A law that is right misses by about as much as repeats
differ; one that misses by more than twice as much (root mean square over the presses) is not taken: with three presses
or more, chance alone does that less than once in a hundred.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import work_mJ
from dummydesign.tissue.fitting.groups import condition_groups
from dummydesign.tissue.fitting.residuals import fitted_force
from dummydesign.tissue.model.held_press import DEPTH_MM, SHARES
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE

if TYPE_CHECKING:
    from dummydesign.tissue.fitting.fit import Fit
    from dummydesign.tissue.fitting.reduction import ReducedTrace
    from dummydesign.tissue.model.measured_curves import MeasuredPerson

PEAK, STEADY, ENERGY = range(3)
ENERGY_TOLERANCE = 0.02
"""Share of an energy within which the verdict does not tell two apart."""
FOLLOWS = 2.0
"""Misfit over the scatter of repeats up to which a law follows the curves."""


@dataclass(frozen=True)
class Misfit:
    """What a law misses of one person's peaks, steady forces and energies, and what repeats differ by; rms in percent.

    ``repeats`` is whether presses were repeated; else the scatter is that of depth and noise.
    """

    subject: str
    misfit_percent: float
    scatter_percent: float
    repeats: bool
    ratio: float

    @property
    def follows(self) -> bool:
        """Whether the law is taken."""
        return self.ratio <= FOLLOWS

    @property
    def words(self) -> str:
        """Both numbers."""
        by = "repeats scatter by" if self.repeats else "depth and noise make"
        return f"{self.subject} by {self.misfit_percent:.1f} % ({by} {self.scatter_percent:.1f} %)"

    def to_dict(self) -> dict[str, Any]:
        """Return all fields and whether the law follows."""
        return {**asdict(self), "follows": self.follows}


def misfit_of(subject: str, fit: Fit, person: MeasuredPerson) -> Misfit:
    """Hold a fitted law against peaks, steady forces and energies of the presses it was fitted to.

    Parameters
    ----------
    subject : str
        Name of the person.
    fit : Fit
    person : MeasuredPerson
        The same presses, smoothed; for the slope of force over depth.
    """
    traces, missed = [], []
    for problem, optimum in fit.problems:
        for index, trace in enumerate(problem.traces):
            traces.append(trace)
            missed.append(np.log(_of_model(trace, fitted_force(problem, optimum, index)) / _measured(trace)))
    measured = np.array([_measured(trace) for trace in traces])
    noise = float(fit.result["noise_floor_N"] or 0.0) / measured
    noise[:, ENERGY] = 0.0
    depth = np.array([trace.ramp.depth_mm for trace in traces])
    exponent = np.array([[n, n, n + 1.0] for n in (_exponent(person, one) for one in depth)])
    expected = np.hypot(exponent * (0.5 * DEPTH_MM / depth)[:, None], noise)
    scatter = _of_repeats(traces)
    if scatter is not None:
        expected = np.full_like(expected, scatter)
    least = np.broadcast_to((STEADY_TOLERANCE, STEADY_TOLERANCE, ENERGY_TOLERANCE), expected.shape).copy()
    least[:, PEAK] *= measured[:, STEADY] / measured[:, PEAK]
    expected, off = np.maximum(expected, least), np.array(missed)
    return Misfit(subject, 100.0 * _rms(off), 100.0 * _rms(expected), scatter is not None, _rms(off / expected))


def _measured(trace: ReducedTrace) -> NDArray:
    """Peak, steady force and energy of a press, smoothed as curves are. [N, N, mJ]"""
    from dummydesign.tissue.population.without_law.curve_people import held_press

    press = held_press(trace, trace.velocity_mm_s)
    return np.array([max(press.rise_N.max(), press.hold_N.max()), trace.steady_force_N, work_mJ(
        SHARES * press.depth_mm, press.rise_N)])  # fmt: skip


def _of_model(trace: ReducedTrace, force_N: NDArray) -> NDArray:
    """The same of a model's force at the nodes of the press."""
    time, x = trace.motion.time_s, trace.motion.displacement_mm
    hold = trace.ramp.hold_end_s - trace.ramp.stop_time_s
    late, rise = time >= trace.ramp.hold_end_s - 0.05 * hold, time <= trace.ramp.stop_time_s
    return np.array([force_N.max(), force_N[late].mean(), work_mJ(x[rise], force_N[rise])])


def _of_repeats(traces: Sequence[ReducedTrace]) -> float | None:
    """Standard deviation of repeats' peaks, steady forces and energies over their mean, pooled; None without."""
    squares, count = 0.0, 0
    for _, _, group in condition_groups(traces):
        if len(group) < 2:
            continue
        values = np.log([_measured(trace) for trace in group])
        squares += float(((values - values.mean(axis=0)) ** 2).sum())
        count += 3 * (len(group) - 1)
    return float(np.sqrt(squares / count)) if count else None


def _exponent(person: MeasuredPerson, depth_mm: float) -> float:
    force = person.steady_N(depth_mm * np.array([0.9, 1.1]), np.inf)
    return float(np.log(force[1] / force[0]) / np.log(1.1 / 0.9))


def _rms(values: NDArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
