"""What a campaign knows of its model: joint estimate, covariance, and how pads scatter about the material.

Laplace's approximation around the joint optimum. The law error of each pad is a random effect: level, slope and
curvature are normal with sizes that were estimated, integrated out here, so that the covariance of the modulus holds
that only a few pads were pressed. A pad that was not pressed has a law error of its own (:attr:`Posterior.pads`).
Covariance and pads are scaled so that 1.96 standard deviations are 95 % intervals of Student's t, as the sizes are
estimates themselves (:mod:`dummydesign.loop.judging.uncertainty`).

References
----------
Tierney and Kadane, J. Am. Stat. Assoc. 81 (1986) 82 (Laplace's approximation); Laird and Ware, Biometrics 38
(1982) 963 (random effects).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.problem import BASE
from dummydesign.loop.fitting.size_likelihood import NORMAL_95
from dummydesign.loop.judging.uncertainty import pad_spreads, widened
from dummydesign.loop.model.parameters import NAMES

PADS = ("level", "slope", "curve")


@dataclass(frozen=True)
class Posterior:
    """Normal distribution of the parameters of a model.

    Attributes
    ----------
    names : tuple of str, length n
        ``log NAME`` for base parameters and times of effects, else ``effect.parameter`` in its own unit.
    mean : ndarray, shape (n,)
    covariance : ndarray, shape (n, n)
    pads : tuple of float
        Standard deviation from pad to pad of the law's level, slope and curvature at d/h = 0.4.
    """

    names: tuple[str, ...]
    mean: NDArray
    covariance: NDArray
    pads: tuple[float, float, float]

    def spread(self, name: str) -> float:
        """Standard deviation of one parameter."""
        place = self.names.index(name)
        return float(np.sqrt(self.covariance[place, place]))

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of one parameter, in its unit where the logarithm was kept."""
        middle, half = self.mean[self.names.index(name)], NORMAL_95 * self.spread(name)
        low, high = middle - half, middle + half
        return (float(np.exp(low)), float(np.exp(high))) if name.startswith("log ") else (float(low), float(high))

    @property
    def young_spread(self) -> float:
        """Standard deviation of the logarithm of the long-term modulus of the material."""
        return self.spread(f"log {NAMES[0]}")

    @property
    def new_pad_spread(self) -> float:
        """The same as a pad shows it that was not pressed, with its own level."""
        return float(np.hypot(self.young_spread, self.pads[0]))

    def to_dict(self) -> dict[str, Any]:
        """Plain values, with the 95 % intervals spelt out."""
        return {
            "names": list(self.names), "mean": self.mean.tolist(), "covariance": self.covariance.tolist(),
            "intervals_95": {name.removeprefix("log "): list(self.interval(name)) for name in self.names},
            "pad_to_pad": dict(zip(PADS, self.pads)),
        }  # fmt: skip


def posterior_of(fit: Fit, lack_ratio: float | None = None) -> Posterior:
    """Posterior of the base and effect parameters of a fit, law errors and contact shifts integrated out.

    Parameters
    ----------
    fit : Fit
    lack_ratio : float, optional
        Lack of fit; above one it widens the covariance.
    """
    names, mean, unit = [f"log {name}" for name in NAMES], list(fit.vector[:BASE]), [1.0] * BASE
    mean[0] += float(np.log(1e3))  # MPa to kPa
    for one in fit.active:
        for parameter in one.effect.parameters:
            value = one.values[parameter.name]
            names.append(f"{'log ' if parameter.log else ''}{one.effect.name}.{parameter.name}")
            mean.append(float(np.log(value)) if parameter.log else value)
            unit.append(1.0 if parameter.log else parameter.typical)
    scale = np.array(unit)
    own = widened(fit, lack_ratio)[: len(names), : len(names)] * np.outer(scale, scale)
    return Posterior(tuple(names), np.array(mean), own, pad_spreads(fit))
