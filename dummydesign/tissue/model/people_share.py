"""What n subjects say of people: expected share below a reading, its interval, and a bound above a share of people.

Readings of people are taken as log-normal. Mean m and standard deviation s of ln reading of n subjects leave those of
all people open: mu = m - s N / (c sqrt n) and sigma = s / c, with N normal and c^2 chi-square over its n - 1 degrees of
freedom. The share of people below x is then Phi(z), z = (c (ln x - m) / s + N / sqrt n). Its mean is the Student-t
predictive of one more person, its quantiles are the exact confidence limits (noncentral t).

References
----------
Hahn and Meeker, Statistical Intervals (1991), chapters 4 and 12 (normal tolerance bounds; noncentral t);
ISO 16269-6:2014 (tables of the factors).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.measurement.motion import DECELERATION_MM_S2
from dummydesign.tissue.model.maxwell_law import SETTLED_S, Parameters, law_named, stack
from dummydesign.tissue.model.posterior import STEADY_N

SAFE_SIDE = "safe-side"
"""Aim at the safe side of all subjects."""
AIM = "people"
"""How an aim at a share of people begins: ``people:95``."""
CONFIDENCE, LEVEL = 0.95, 0.90
"""Confidence of a bound, and level of the interval of a share."""
PERCENT = 1.0, 99.9
"""Smallest and largest share that can be aimed at. [%]"""
LARGE_FACTOR = 3.0
"""Standard deviations from which on a bound says more of the number of subjects than of people."""
NODES, NODES_OF_MANY = 200, 48
"""Even quantiles of N and of c, for one group of subjects and for each of many."""
SMALLEST = 1e-9
"""Smallest standard deviation of ln reading."""


def share_of_aim(aim: str) -> float | None:
    """Read the share of people that an aim is at, 0 to 1; None for another aim.

    Parameters
    ----------
    aim : str
        As it is typed: ``people:95``, ``people:95%``.

    Raises
    ------
    InputError
        For a percentage that is none, or outside 1 to 99.9.
    """
    name, _, typed = aim.partition(":")
    if name.strip().lower() != AIM:
        return None
    low, high = PERCENT
    try:
        percent = float(typed.strip().removesuffix("%"))
    except ValueError:
        message = f"aim = '{aim}' has no percentage of people; give {low:g} to {high:g}, such as people:95"
        raise InputError(message, "not_a_number", "aim", aim) from None
    if not low <= percent <= high:
        raise out_of_range("aim: percentage of people", f"{percent:g}", f"{low:g}", high, "such as people:95", "aim")
    return percent / 100.0


def is_share(aim: str) -> bool:
    """Whether an aim is at a share of people."""
    return aim.partition(":")[0].strip().lower() == AIM


def is_strict(aim: str) -> bool:
    """Whether a pad of this aim may read no lower than any subject, or than the bound of a share of people."""
    return aim.lower() == SAFE_SIDE or is_share(aim)


@lru_cache(maxsize=64)
def tolerance_factor(subjects: int, share: float, confidence: float = CONFIDENCE) -> float:
    """Return k: m + k s of n subjects is above a share of all people with a confidence.

    Parameters
    ----------
    subjects : int
        At least 2.
    share, confidence : float
        Between 0 and 1.

    Returns
    -------
    float
        k = T(confidence; n - 1, sqrt(n) z) / sqrt(n) by the noncentral t distribution, z the quantile of the share.

    Examples
    --------
    >>> [round(tolerance_factor(n, 0.95), 2) for n in (5, 15, 40)]
    [4.2, 2.57, 2.13]
    """
    from scipy.special import nctdtrit, ndtri

    root = math.sqrt(subjects)
    return float(nctdtrit(subjects - 1, root * ndtri(share), confidence)) / root


@dataclass(frozen=True, eq=False)
class Population:
    """People of one kind as n subjects show them, in one or several readings.

    ``mean`` and ``spread`` are those of ln reading in each of d groups of n subjects that the data allow, equally
    likely, shape (d, ...); one group where the subjects are known.
    """

    mean: NDArray
    spread: NDArray
    subjects: int

    @classmethod
    def of(cls, readings: ArrayLike, own: ArrayLike = 0.0, common: ArrayLike = 0.0) -> Population:
        """Describe people by the readings of subjects.

        Parameters
        ----------
        readings : array_like, shape (n, ...)
            Of each subject, above 0.
        own, common : array_like, shape (...)
            Standard deviation of ln reading by what is not known of each subject, and by what is not known of all of
            them alike. Errors of their own are part of the spread of the subjects, which is never taken as smaller; a
            common error moves the mean.

        Raises
        ------
        InputError
            For fewer than two subjects.
        """
        from scipy.special import ndtri

        mean, spread, count = _moments(np.log(np.asarray(readings, float))[None])
        shift = np.asarray(common, float)
        spread = np.maximum(spread, np.asarray(own, float))
        if shift.any():
            deviates = ndtri((np.arange(NODES_OF_MANY) + 0.5) / NODES_OF_MANY)
            mean = mean + deviates.reshape(-1, *(1,) * (mean.ndim - 1)) * shift
        return cls(mean, np.broadcast_to(spread, mean.shape), count)

    @classmethod
    def of_groups(cls, readings: ArrayLike) -> Population:
        """Describe people by groups of subjects that the data allow, readings of shape (d, n, ...)."""
        return cls(*_moments(np.log(np.asarray(readings, float))))

    def expected_below(self, reading: ArrayLike) -> NDArray:
        """Return the expected share of people at most at a reading, of the shape of the readings.

        It is the probability that one more person is there: T((ln x - m) / (s sqrt(1 + 1 / n)); n - 1).
        """
        from scipy.special import stdtr

        away = (np.log(np.asarray(reading, float)) - self.mean) / self.spread
        return np.asarray(stdtr(self.subjects - 1, away / math.sqrt(1.0 + 1.0 / self.subjects)).mean(axis=0))

    def interval_below(self, reading: ArrayLike, level: float = LEVEL) -> tuple[NDArray, NDArray]:
        """Return the interval of the true share of people at most at a reading, each of the shape of the readings."""
        from scipy.special import ndtr

        away = (np.log(np.asarray(reading, float)) - self.mean) / self.spread
        normal, scale = self._deviates
        low, high = _quantiles(lambda one: one * scale + normal, (away,), (0.5 - level / 2, 0.5 + level / 2))
        return ndtr(low), ndtr(high)

    def bound(self, share: float, confidence: float = CONFIDENCE) -> NDArray:
        """Return the reading that is above a share of people with a confidence, of the shape of the readings."""
        from scipy.special import ndtri

        if len(self.mean) == 1:
            return np.exp(self.mean[0] + tolerance_factor(self.subjects, share, confidence) * self.spread[0])
        normal, scale = self._deviates
        factor = (float(ndtri(share)) + normal) / scale
        (bound,) = _quantiles(lambda mean, spread: mean + spread * factor, (self.mean, self.spread), (confidence,))
        return np.exp(bound)

    @property
    def _deviates(self) -> tuple[NDArray, NDArray]:
        """Even quantiles of N / sqrt(n) and of c, to broadcast as (groups, N, c)."""
        from scipy.special import gammaincinv, ndtri

        nodes = NODES if len(self.mean) == 1 else NODES_OF_MANY
        even = (np.arange(nodes) + 0.5) / nodes
        free = self.subjects - 1
        scale = np.sqrt(2.0 * gammaincinv(0.5 * free, even) / free)
        return (ndtri(even) / math.sqrt(self.subjects))[:, None], scale


def _moments(values: NDArray) -> tuple[NDArray, NDArray, int]:
    """Mean and standard deviation over the subjects, second axis, and their number; fewer than two are refused."""
    count = values.shape[1]
    if count < 2:
        message = "one subject does not show how people differ; add others ('dummydesign tissues add')"
        raise InputError(message, "not_enough_data", "subjects", count)
    return values.mean(axis=1), np.maximum(values.std(axis=1, ddof=1), SMALLEST), count


def _quantiles(value: Callable[..., NDArray], groups: Sequence[NDArray], shares: Sequence[float]) -> NDArray:
    """Quantiles over all groups and deviates of a value of each reading, shape (shares, ...); NaN where it is none."""
    shape = groups[0].shape[1:]
    columns = [one.reshape(len(one), -1) for one in groups]
    rows = []
    for at in range(columns[0].shape[1]):
        values = value(*(column[:, at, None, None] for column in columns))
        known = np.isfinite(values).all()
        rows.append(np.quantile(values, shares, method="hazen") if known else np.full(len(shares), np.nan))
    return np.array(rows).T.reshape(len(shares), *shape)


STEPS = 24
"""Halvings of the interval of the arms' factor."""
LOG_FACTOR = -7.0, 7.0
"""Smallest and largest ln of the factor on the arms."""


def share_parameters(
    groups: Sequence[Sequence[Parameters]],
    subjects: Sequence[Parameters],
    velocities_mm_s: tuple[float, ...],
    share: float,
) -> Parameters:
    """Return one set of parameters at the bound of a share of people.

    gamma1 is the bound of the subjects' gamma1. The arms have the geometric means of the subjects' gamma_i / gamma1
    and of their times at 10 N, the strengths times the one factor with which the peaks at 10 N reach the bound of the
    subjects' peaks at the slowest and the fastest speed.

    Parameters
    ----------
    groups : sequence of sequences of Parameters
        Groups of people that the data allow, at least one.
    subjects : sequence of Parameters
        Two or more, of one law.
    velocities_mm_s : tuple of float
        Speeds at which all have dampers.
    share : float
        Of people, between 0 and 1.

    Raises
    ------
    InputError
        For one subject.
    """
    name = subjects[0].law
    law = law_named(name)
    gamma1 = float(Population.of_groups([[one.gamma1_N_per_mm3 for one in group] for group in groups]).bound(share))
    if not velocities_mm_s:
        return Parameters(name, gamma1, (), ())
    depth_mm = float(law.root(STEADY_N / gamma1))
    arms = {speed: _middle_arms(subjects, speed) for speed in velocities_mm_s}

    def at(log_factor: float) -> Parameters:
        strengths = gamma1 * np.exp(log_factor) * next(iter(arms.values()))[0]
        dampers = tuple(
            (speed, tuple((times * strengths * depth_mm**2).tolist())) for speed, (_, times) in arms.items()
        )
        return Parameters(name, gamma1, tuple(strengths.tolist()), dampers)

    speeds = (velocities_mm_s[0], velocities_mm_s[-1])
    everyone = [one for group in groups for one in group]
    shape = len(groups), len(groups[0])
    wanted = [float(Population.of_groups(_peaks(everyone, speed).reshape(shape)).bound(share)) for speed in speeds]
    low, high = LOG_FACTOR
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        enough = all(_peaks([at(middle)], speed)[0] >= peak for speed, peak in zip(speeds, wanted))
        low, high = (low, middle) if enough else (middle, high)
    return at(high)


def _middle_arms(subjects: Sequence[Parameters], velocity_mm_s: float) -> tuple[NDArray, NDArray]:
    """Geometric means over the subjects of gamma_i / gamma1, and of the arms' times at 10 N. [s]"""
    gamma1, gamma, damper = stack(subjects, velocity_mm_s)
    area = law_named(subjects[0].law).root(STEADY_N / gamma1)[:, None] ** 2
    return tuple(np.exp(np.log(one).mean(axis=0)) for one in (gamma / gamma1[:, None], damper / (gamma * area)))


def _peaks(subjects: Sequence[Parameters], velocity_mm_s: float) -> NDArray:
    """Peaks of presses to 10 N at the end of a settled hold, shape (subjects,). [N]"""
    press = law_named(subjects[0].law).press
    _, force, _ = press(subjects, STEADY_N, velocity_mm_s, SETTLED_S, DECELERATION_MM_S2)
    return np.asarray(force.max(axis=-1))
