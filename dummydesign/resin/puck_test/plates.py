"""What is declared of the plates of a puck test: lubricated, bonded, a friction coefficient, or nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity, value_at
from dummydesign.core.toml_schema import read_table
from dummydesign.core.user_library import data_folder
from dummydesign.pad.tables.puck import friction_of, grip, uniaxial
from dummydesign.resin.model.resin import Interval

LUBRICATED, BONDED = "lubricated", "bonded"
LARGEST = 5.0
QUANTILES = (0.5, 0.025, 0.975)
ALPHA_RANGE = (1.0, 6.0)
"""Exponents of the Ogden law that are fitted."""
POINTS, REACH = 9, 2.4
"""Frictions at which a declared prior is profiled, and how many standard deviations to either side they reach."""


@dataclass(frozen=True)
class Plates:
    """A declaration; ``friction`` is its prior, None where nothing was declared, infinite when bonded.

    A number counts as exact, and so do bonded faces.
    """

    name: str = ""
    friction: Quantity | None = None

    @property
    def words(self) -> str:
        """The declaration as a source states it."""
        if self.friction is None:
            return "plate friction left open"
        return f"plates declared {self.name}" if self.name in (LUBRICATED, BONDED) else f"plate friction {self.name}"

    def nodes(self, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Grips at which a fit profiles the friction, rising, and what the prior adds to chi square at each.

        Even in grip over ``free`` without a declaration, even in normal deviates of a declared interval.
        """
        if self.friction is None:
            return free, np.zeros(len(free))
        if not self.friction.low < self.friction.high:
            return np.array([float(grip(self.friction.value))]), np.zeros(1)
        away = np.linspace(-REACH, REACH, POINTS)
        # log-normal to either side, of an assumed one too
        return grip(value_at(replace(self.friction, kind="inferred"), away)), away**2


OPEN = Plates()


@dataclass(frozen=True)
class OverFriction:
    """What a puck says with its plates' friction integrated out: medians and 95 % intervals."""

    young_kPa: Interval
    friction: Interval
    alpha: Interval


STEP, SEEN_STRAIN = 0.1, 0.01
"""Of an exponent, for its effect on a curve; least compression that shows it."""


def _exponent_error(alpha: np.ndarray, misfit: np.ndarray, strains: np.ndarray) -> np.ndarray:
    """Standard deviation of exponents (n,) that a misfit of ln F may make which grows along the compression."""
    bends = [np.std(np.log(uniaxial(a + STEP, strains) / uniaxial(a - STEP, strains))) / (2.0 * STEP) for a in alpha]
    return misfit / np.array(bends)


def over_friction(
    grips: np.ndarray,
    chi_square: np.ndarray,
    log_young: np.ndarray,
    alpha: np.ndarray,
    misfit: np.ndarray,
    strains: np.ndarray,
) -> OverFriction:
    """Integrate what was fitted at each friction over the frictions.

    How the law misfits along the compression is not known: a misfit may be all of the exponent.

    Parameters
    ----------
    grips, chi_square : ndarray, shape (n,)
        The nodes of :meth:`Plates.nodes`, and chi square of curves and prior there.
    log_young, alpha : ndarray, shape (2, n)
        Value and standard deviation at each; modulus in kPa.
    misfit : ndarray, shape (n,)
        Root mean square of ln of the fitted over the measured force.
    strains : ndarray, shape (m,)
        Compressions over the height that were fitted.
    """
    spread = np.hypot(alpha[1], _exponent_error(alpha[0], misfit, strains[strains > SEEN_STRAIN]))
    density = np.exp(-0.5 * (chi_square - chi_square.min()))
    weights = density * np.where((np.arange(len(grips)) % max(len(grips) - 1, 1) == 0) & (len(grips) > 1), 0.5, 1.0)
    share = np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]))]
    frictions = np.interp(QUANTILES, share / share[-1], grips) if len(grips) > 1 else grips.repeat(3)
    return OverFriction(
        Interval(*np.exp(_mixed(weights, *log_young)).tolist()),
        Interval(*map(friction_of, frictions.tolist())),
        Interval(*np.clip(_mixed(weights, alpha[0], spread), *ALPHA_RANGE).tolist()),
    )


def _mixed(weights: np.ndarray, centre: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Median and 95 % interval of a mixture of normal distributions."""
    from scipy.special import ndtr

    at = np.linspace(np.min(centre - 5.0 * spread), np.max(centre + 5.0 * spread), 4001)
    share = weights @ ndtr((at - centre[:, None]) / spread[:, None]) / weights.sum()
    return np.interp(QUANTILES, share, at)


def read_plates(text: str | float | None) -> Plates:
    """Read ``lubricated``, ``bonded`` or a friction coefficient; None leaves the friction open."""
    if text is None:
        return OPEN
    name = str(text).strip().lower()
    if name == LUBRICATED:
        top = read_table(data_folder() / "materials" / "plates.toml", ("schema", LUBRICATED))
        return Plates(name, top.table(LUBRICATED).quantity("friction"))
    if name == BONDED:
        return Plates(name, Quantity(math.inf, math.inf, math.inf, "assumed", "declared"))
    try:
        value = float(name)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= LARGEST:
        raise InputError(
            f"friction = {text} is not allowed; give lubricated, bonded or a friction coefficient from 0 to "
            f"{LARGEST:g}",
            "out_of_range" if math.isfinite(value) else "unknown_name",
            "friction",
            text,
            [LUBRICATED, BONDED, (0.0, LARGEST)],
        )
    return Plates(f"{value:g}", Quantity(value, value, value, "assumed", "declared"))
