"""What a puck contradicts: pairs of numbers that must agree, each with the standard deviation of their difference."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import YOUNG
from dummydesign.measurement.trace import UNITS
from dummydesign.resin.model.resin import SURPRISE, Point, PuckPoint, Resin, log_spread
from dummydesign.resin.puck_test.loading_fit import TABLE_ERROR, PuckFit
from dummydesign.resin.puck_test.plates import ALPHA_RANGE
from dummydesign.resin.update import spread_between, without_points

VOLUME_SPREAD = 0.02
"""Standard deviation of ln volume by diameter and height: 0.2 mm of either and the meniscus, assumed."""
SLIP_FITS = 0.5
"""How near, in ln, a slip has to bring a modulus to the resin's where that is known better than this."""
AT_BOUND = 0.1
"""How near a bound of its range an exponent counts as ended there."""
WEIGHED, MASS_RANGE = "mass_g weighed and by size and density", (0.5, 2.0)
"""Name of that pair, and the masses over the expected one that are read: beyond, a digit or a unit is wrong."""
HEIGHTS = np.array([1.1, 1.2])
"""Heights over the typed one that are tried where the law misfits."""
SLIPS = {
    **{f"the force is in {unit}": size for unit, size in UNITS["force"].items() if unit != "N"},
    "the force is ten times too small": 10.0,
    "the force is ten times too large": 0.1,
    "--diameter is the radius": 0.25,
}
"""Mistakes by what they multiply the modulus with when put right."""


@dataclass(frozen=True)
class Pair:
    """Two numbers of one thing, the standard deviation of ln of their ratio, and what to check where they differ.

    ``what`` says of what, with the unit.
    """

    what: str
    a: float
    b: float
    spread: float
    check: str

    @property
    def deviations(self) -> float:
        """By how many standard deviations ``a`` lies above ``b``."""
        return math.log(self.a / self.b) / self.spread

    @property
    def far(self) -> bool:
        """Whether the two contradict each other."""
        return abs(self.deviations) > SURPRISE

    def to_dict(self) -> dict[str, Any]:
        """Return what it is and the two numbers."""
        return {"what": self.what, "a": self.a, "b": self.b}


def pairs_of(resin: Resin, point: Point, mass_g: float | None = None) -> list[Pair]:
    """The table: puck and resin, or a puck of the same ratio that agrees; other pucks; mass and density times volume.

    Parameters
    ----------
    resin : Resin
        With the other points that it has.
    point : Point
        This puck.
    mass_g : float or None
        Of the puck. [g]
    """
    young = point.young_kPa.value
    known = without_points(resin).modulus_kPa(point.ratio)
    law = Pair(
        f"young_kPa of this puck and of {resin.name} at ratio {point.ratio:g}",
        young,
        known.value,
        math.hypot(point.spread, log_spread(known)),
        "check diameter, height, ratio and the unit of the force",
    )
    pucks = [
        Pair(
            f"young_kPa of this puck and of {other.puck.file if other.puck else other.young_kPa.source}",
            young,
            other.young_kPa.value,
            spread_between(point, other),
            "one is of another mix, size or unit; measure again or give its own ratio",
        )
        for other in resin.points
        if resin.same_ratio(point, other)
    ]
    # the law says less of the batch than a puck of it that agrees
    agreeing = [one for one in pucks if not one.far]
    pairs = [*(agreeing or [law]), *(one for one in pucks if one.far)]
    if mass_g is not None and point.puck is not None:
        density = resin.property("density_g_per_cm3", point.ratio)
        pairs.append(
            Pair(
                WEIGHED,
                mass_g,
                mass_by_size_g(density.value, point.puck),
                math.hypot(VOLUME_SPREAD, log_spread(density)),
                "check diameter and height; voids make a puck lighter",
            )
        )
    return pairs


def mass_by_size_g(density_g_per_cm3: float, puck: PuckPoint) -> float:
    """Density times volume of a puck."""
    return density_g_per_cm3 * 0.25e-3 * math.pi * puck.diameter_mm**2 * puck.height_mm


def size_not_weighed(young_kPa: float, density_g_per_cm3: float, puck: PuckPoint) -> dict[str, str]:
    """What to do where nothing confirms the typed size, with both numbers."""
    return {
        "code": "size_not_weighed",
        "message": f"the size is not confirmed. A height typed 10 % low reads about {young_kPa / 1.1:.3g} kPa for "
        f"{young_kPa:.3g}. A puck of {puck.diameter_mm:g} x {puck.height_mm:g} mm weighs "
        f"{mass_by_size_g(density_g_per_cm3, puck):.1f} g: weigh it, then type this again with --mass and --replace",
    }


def other_height(fit: PuckFit, height_mm: float, fitted: Callable[[float], PuckFit]) -> list[Pair]:
    """The typed height and the one that the curves fit best, where they differ; nothing where the law fits.

    A height typed too small makes the curve one of no elastic law; one typed too large hardly shows.
    """
    if fit.misfit <= SURPRISE * TABLE_ERROR:
        return []
    tried = [(fit, height_mm)]
    for one in (height_mm * HEIGHTS).tolist():
        # no table for such a puck, or the presses are too shallow for it
        with suppress(InputError):
            tried.append((fitted(one), one))
    best, height = min(tried, key=lambda pair: pair[0].misfit)
    if best is fit:
        return []
    gain = ((fit.misfit**2 - best.misfit**2) / (TABLE_ERROR**2 + best.misfit**2)) ** 0.5
    check = f"measure the puck; {height:.3g} mm makes {best.known.young_kPa.value:.3g} kPa"
    return [
        Pair(
            "height_mm typed and by the course of the force",
            height_mm,
            height,
            math.log(height / height_mm) / gain,
            check,
        )
    ]


def odd_press(names: Sequence[str], young_kPa: float, levels: np.ndarray, covariance: np.ndarray) -> list[Pair]:
    """The press that differs most from the mean of the others at equal strain; nothing of a single press.

    Parameters
    ----------
    names : sequence of str
        Of the presses of one puck.
    young_kPa : float
        By all of them.
    levels, covariance : ndarray, shapes (presses,) and (presses, presses)
        ln of each press's force over the fit of all, and its covariance with the scatter from press to press.
    """
    count = len(names)
    if count < 2:
        return []
    less = np.eye(count) - (1.0 - np.eye(count)) / (count - 1)
    away = less @ levels
    spreads = np.sqrt(np.diag(less @ covariance @ less.T))
    at = int(np.argmax(np.abs(away) / spreads))
    one, mean = young_kPa * np.exp(away[at] * np.array([1.0 - 1.0 / count, -1.0 / count]))
    rest = " and ".join(name for name in names if name != names[at])
    return [
        Pair(
            f"young_kPa by {names[at]} and by {rest}",
            float(one),
            float(mean),
            float(spreads[at]),
            "the files are of two pucks, or the puck slipped; add each puck by itself",
        )
    ]


def check_slips(pairs: Sequence[Pair]) -> None:
    """Refuse a modulus that is far from the resin's where a usual mistake explains it, or that no resin has; and a mass
    that no puck of the typed size has."""
    for one in pairs:
        least, most = (one.b * share for share in MASS_RANGE)
        if one.what == WEIGHED and not least <= one.a <= most:
            raise out_of_range("mass_g", one.a, round(least, 1), round(most, 1), "check mass, diameter and height")
    pair, (low, high) = pairs[0], YOUNG.usual
    near = max(SURPRISE * pair.spread, SLIP_FITS)
    misses = sorted((abs(math.log(pair.a * size / pair.b)), words) for words, size in SLIPS.items())
    slips = [words for miss, words in misses[:2] if miss <= near]
    if low <= pair.a <= high and not (pair.far and slips):
        return
    raise InputError(
        f"the puck says {pair.a:.3g} kPa, the resin {pair.b:.3g} kPa ({abs(pair.deviations):.1f} standard deviations "
        f"apart): probably {' or '.join(slips) or pair.check}, or the ratio is "
        "another. Put it right; if all is right, begin with a resin of its hardness (resins add-hardness --resin BASE)",
        "implausible_unit",
        "force_N",
        pair.a,
        (low, high),
    )


def warnings_of(pairs: Sequence[Pair], alpha: float) -> tuple[tuple[Pair, ...], tuple[dict[str, str], ...]]:
    """Pairs that contradict each other and a warning each, the largest first, and one of an exponent at its bound where
    no mass confirms the size."""
    far = sorted((one for one in pairs if one.far), key=lambda one: -abs(one.deviations))
    warnings = [
        {
            "code": "contradiction",
            "message": f"{one.what}: {one.a:.3g} and {one.b:.3g}, {abs(one.deviations):.1f} standard deviations apart; "
            f"{one.check}",
        }
        for one in far
    ]
    weighed = any(one.what == WEIGHED and not one.far for one in pairs)
    if min(abs(alpha - end) for end in ALPHA_RANGE) < AT_BOUND and not weighed:
        warnings.append(
            {
                "code": "exponent_at_bound",
                "message": f"the Ogden exponent ended at the bound of its range, {alpha:.3g}; check diameter and "
                "height",
            }
        )
    return tuple(far), tuple(warnings)
