"""Whether a recording is a press at all: one explanation of the force by the displacement, from rest to the hold's end.

A body that is pressed and relaxes cannot push harder while nothing moves, cannot push before it is touched. So its
force is a sum of elastic forces that rise with depth, each relaxing by exponentials, none of them negative:

    F(t) = level + drift t + sum w_ij int r_j(t - s) dg_i(d(s)),  d(t) = x(t - delay) - contact,  w_ij >= 0,

with g_i powers of depth, max(d - d_i, 0) or levelling off and r_j constant or exp(-t / tau_j), and of arms d^2 e,
e' = d' - e d^2 / tau_j, as the published law of tissue has them, by non-negative least squares [1]. The way back is
left out: there contact is lost, at times that depend on the depth.

A delay shows as a force that goes on while nothing moves: it is sought in all presses, in which a sum without one
misses much more.

References
----------
.. [1] C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, SIAM (1995), chapter 23.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.measurement.importing.contact import FILTER_DELAY_S, ContactEstimate, find_contact
from dummydesign.measurement.importing.sign_convention import Span
from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.ramp_detection import Summary, last_ramp, summarise

POWERS = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.5, 9.0, 13.0])
TOUCHES = np.linspace(0.2, 0.9, 8)
"""Shares of the depth at which more of a body may begin to carry: the slab beside a low crown, another layer."""
LEVELS = np.array([2.0, 4.0, 8.0])
"""Of 1 - exp(-level * share of the depth): foams give way."""
TIMES_S = np.geomspace(0.004, 40.0, 9)
SAMPLES = 260
"""Samples that are kept, even along the curve of displacement and force over time."""
LAW_ERROR = 0.005
"""Share of the force that these functions may miss of a press, and the least force it is taken of, over the largest."""
LEAST = 0.1
SLOW_S = 0.1
"""Ramps that last less are judged in the hold alone: there a load cell's filter, of 5 to 20 ms, is seen. [s]"""
UNJUDGED = 10.0  # times as much may be missed of a part that is not judged
LIMIT = 6.0
"""Misfit (root mean square over noise and law error) of a part of a press beyond which it is not explained."""
DELAYED = "force_delayed"
PARTS = ("before contact", "in the rise", "after the stop", "in the hold")
SETTLES_S = 0.3
DELAYS_S, STRIDES_S, LONGEST_S = np.linspace(-0.04, 0.04, 9), (*[1e-2] * 4, 5e-3, 2e-3, 1e-3, 1e-3), 0.08
"""Delays that are looked at, steps by which the best one is approached, and the longest one. [s]"""
DELAY_ERROR_S, NAMED_S = 2e-3, FILTER_DELAY_S + 10e-3
"""How far a delay that is found may be off at least, of drawn presses of tissue, balls and flat punches; the longest
one that a filter may make, which has no warning. [s]"""
FEWEST = 5  # samples of a part that is judged
SEEN, BETTER, SURE = 25.0, 0.4, 16.0
"""Sum of squares by which a delay must explain more than none to be one, also as a share of what it misses, and by
which those outside its interval explain less, over that of a sample: what these functions miss is no noise."""


@dataclass(frozen=True)
class Judgement:
    """Whether a press is explained within its noise; else where it is worst, by how many times its noise it is missed
    there. ``delay_s`` is the delay of the force that explains it better (0: none); a short one may be a filter's."""

    explains: bool
    where: str = ""
    misfit: float = 0.0
    delay_s: float = 0.0

    @property
    def by(self) -> str:
        """The option that would explain it; empty without one."""
        return f"--delay {self.delay_s:.3g}" if self.delay_s and not self.explains else ""

    @property
    def code(self) -> str:
        """Code of the warning."""
        return DELAYED if self.delay_s else "not_explained"

    @property
    def message(self) -> str:
        """What a user must know of it."""
        if not self.delay_s:
            text = f"the displacement does not explain the force {self.where}: no pad and no skin presses so"
            return f"{text}; plot both over time: a position in steps, a slower source, a drift, a loose contact?"
        late = "later" if self.delay_s > 0 else "earlier"
        return (
            f"the force is about {1e3 * abs(self.delay_s):.0f} ms {late} than the displacement: contact allows "
            f"for it, but forces stand at the wrong depths; import with {self.by}, or declare the load cell's filter "
            "with --lowpass where the trace is used"
        )

    def to_dict(self) -> dict[str, Any]:
        """As ``judged`` in JSON."""
        return {"explains": self.explains, "where": self.where, "by": self.by}


def judge_press(
    time: NDArray, x: NDArray, force: NDArray, summary: Summary, step_N: float, delay_s: float
) -> Judgement:
    """Judge one press.

    Parameters
    ----------
    time, x, force : ndarray, shape (n,)
        From rest, zero at contact, compression positive. [s, mm, N]
    summary : Summary
        Its ramp and hold.
    step_N : float
        Step of the digits of the force. [N]
    delay_s : float
        Delay of the force, of :func:`find_delay`. [s]
    """
    kept, size = _errors(time, x, force, summary, step_N)
    t, stop = time[kept], summary.stop_time_s
    part = np.where(t > stop + SETTLES_S, 3, np.where(t > stop, 2, np.where(x[kept] > 0.0, 1, 0)))
    judged = [k for k in range(len(PARTS)) if summary.depth_mm >= SLOW_S * summary.velocity_mm_s or k == 3]
    left = _left(time, x, force, kept, size * np.where(np.isin(part, judged), 1.0, UNJUDGED))
    misfits = [np.sqrt(np.mean(left[part == k] ** 2)) if np.sum(part == k) >= FEWEST else 0.0 for k in judged]
    worst = int(np.argmax(misfits))
    if misfits[worst] <= LIMIT and abs(delay_s) <= NAMED_S:
        return Judgement(True, delay_s=delay_s)
    return Judgement(False, PARTS[judged[worst]], float(misfits[worst]), delay_s)


def _errors(time: NDArray, x: NDArray, force: NDArray, summary: Summary, step_N: float) -> tuple[NDArray, NDArray]:
    """Samples that are looked at, and the error of the force there. [N]"""
    kept = _thinned(time, x, force, max(summary.hold_end_s, summary.stop_time_s))
    law = LAW_ERROR * np.maximum(np.abs(force[kept]), LEAST * float(force.max()))
    size = np.hypot(law, np.hypot(noise_of(force), step_N / np.sqrt(12.0)))
    return kept, size * np.where(time[kept] >= time[last_ramp(x)], 1.0, UNJUDGED)


def find_delay(
    time: NDArray, x: NDArray, force: NDArray, summary: Summary, step_N: float = 0.0
) -> tuple[float, float, float]:
    """The delay of the force that explains a press best, 0 if not much better than none, and its interval. [s]

    The contact that the force shows is carried along with it. Arguments are those of :func:`judge_press`.
    """
    kept, size = _errors(time, x, force, summary, step_N)

    @cache
    def missed(delay_s: float) -> float:
        """Sum of squares that is missed with a delay."""
        depth = np.interp(time - delay_s, time, x) + summary.velocity_mm_s * delay_s
        return float(np.sum(_left(time, depth, force, kept, size) ** 2)) if depth[kept].max() > 0.0 else np.inf

    # where a punch rings there are nearest ones, each a period from the next
    tried = dict.fromkeys(DELAYS_S.round(6).tolist())
    for stride in STRIDES_S:
        best = min(tried, key=lambda one: (missed(one), abs(one)))
        tried |= dict.fromkeys((round(best - stride, 6), round(best + stride, 6)))
    best = min(tried, key=lambda one: (missed(one), abs(one)))
    scale = max(missed(best) / len(kept), 1.0)
    likely = [one for one in tried if missed(one) - missed(best) < SURE * scale]
    # an average is no delay
    seen = abs(best) < LONGEST_S and missed(0.0) - missed(best) > max(SEEN, BETTER * missed(best))
    return best if seen else 0.0, min(likely) - DELAY_ERROR_S * seen, max(likely) + DELAY_ERROR_S * seen


def contact_of(time: NDArray, x: NDArray, load: NDArray, span: Span, tare_N: float | None = None) -> ContactEstimate:
    """Contact of one press, as :func:`find_contact` finds it from the displacement by which the force was caused."""
    contact, part = find_contact(time, x, load, span, tare_N), slice(span.start, span.stop)
    press = time[part] - time[span.start], x[part] - contact.position_mm, load[part] - contact.baseline.level_N
    try:
        summary = summarise("", *press)
        delay, early, late = find_delay(*press, summary, contact.baseline.step_N)
    except InputError:
        return contact  # no ramp from there; whoever uses the press says what it lacks
    if abs(delay) <= NAMED_S and summary.depth_mm < SLOW_S * summary.velocity_mm_s:
        return contact  # a quick rise does not tell a short delay from the force's own law
    if delay:
        contact = find_contact(time, np.interp(time - delay, time, x), load, span, tare_N)
    speed = max(contact.velocity_mm_s, 0.0)
    return replace(
        contact,
        low_mm=contact.low_mm - speed * max(late - delay, 0.0),
        high_mm=contact.high_mm - speed * min(early - delay, 0.0),
        delay_s=delay,
    )


def _thinned(time: NDArray, x: NDArray, force: NDArray, end_s: float) -> NDArray:
    """Samples up to a time, closest where most happens."""
    count = max(int(np.searchsorted(time, end_s, side="right")), 3)
    steps = [np.diff(values[:count]) / max(float(np.ptp(values[:count])), 1e-12) for values in (time, x, force)]
    way = np.r_[0.0, np.cumsum(np.sqrt(np.sum(np.square(steps), axis=0)))]
    return np.unique(np.searchsorted(way, np.linspace(0.0, way[-1], SAMPLES)).clip(0, count - 1))


def _left(time: NDArray, depth: NDArray, force: NDArray, kept: NDArray, size: NDArray) -> NDArray:
    """What the nearest force that a body can have misses of some samples, over their errors."""
    from scipy.optimize import nnls

    time, depth, force = time[kept], depth[kept], force[kept]
    share = np.maximum(depth, 0.0) / depth.max()
    elastic = np.concatenate(
        [share ** POWERS[:, None], np.maximum(share - TOUCHES[:, None], 0.0), -np.expm1(-LEVELS[:, None] * share)]
    )
    step = np.maximum(np.diff(time, prepend=time[0]), 1e-9) / TIMES_S[:, None]

    def relaxed(elastic: NDArray, step: NDArray) -> NDArray:
        """Loads that decay, loaded evenly within each step."""
        kept = np.exp(-step)
        return linear_recurrence(kept, (1.0 - kept) / step * np.diff(elastic, prepend=0.0))

    fading = relaxed(elastic, step[:, None]).reshape(-1, len(time))
    middle = 0.5 * (share + np.r_[share[0], share[:-1]])
    tissue = share**2 * relaxed(share, step * np.maximum(middle**2, 1e-6))
    even = np.stack([np.ones_like(time), (time - time[0]) / max(float(np.ptp(time)), 1e-9)])
    columns = np.concatenate([elastic, fading, tissue, even, -even]).T
    weights, _ = nnls(columns / size[:, None], force / size, maxiter=50 * columns.shape[1])
    return (force - columns @ weights) / size
