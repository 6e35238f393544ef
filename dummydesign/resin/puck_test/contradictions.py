"""What a puck contradicts: pairs of numbers that must agree, each with the standard deviation of their difference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.parsing import YOUNG
from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import Serialised
from dummydesign.measurement.plausible import UNITS
from dummydesign.resin.model.resin import Point, Resin
from dummydesign.resin.puck_test.loading_fit import REPEAT
from dummydesign.resin.puck_test.plates import ALPHA_RANGE
from dummydesign.resin.update.modulus import correlation, without_points

SURPRISE = 3.0
"""Standard deviations of ln of their ratio from which on two numbers contradict each other."""
VOLUME_SPREAD = 0.02
"""Standard deviation of ln volume by diameter and height: 0.2 mm of either and the meniscus, assumed."""
SLIP_FITS = 0.5
"""How near, in ln, a slip has to bring a modulus to the resin's where that is known better than this."""
AT_BOUND = 0.1
"""How near a bound of its range an exponent counts as ended there."""
SLIPS = {
    **{f"the force is in {unit}": size for unit, size in UNITS["force"].items() if unit != "N"},
    "the force is ten times too small": 10.0,
    "the force is ten times too large": 0.1,
    "--diameter is the radius": 0.25,
}
"""Mistakes by what they multiply the modulus with when put right."""


@dataclass(frozen=True)
class Contradiction(Serialised):
    """Two numbers that contradict each other; ``what`` says of what, with the unit."""

    what: str
    a: float
    b: float


@dataclass(frozen=True)
class Pair:
    """Two numbers of one thing, the standard deviation of ln of their ratio, and what to check where they differ."""

    what: str
    a: float
    b: float
    spread: float
    check: str

    @property
    def deviations(self) -> float:
        """By how many standard deviations ``a`` lies above ``b``."""
        return math.log(self.a / self.b) / self.spread


def pairs_of(
    resin: Resin, point: Point, presses: Sequence[tuple[str, float]], mass_g: float | None, density: Quantity
) -> list[Pair]:
    """The table: puck and resin, puck and pucks of the same ratio, press and press, mass and density times volume.

    Parameters
    ----------
    resin : Resin
        With the other points that it has.
    point : Point
        This puck.
    presses : sequence of (str, float)
        Name of each press, and ln of its force over that of the fit of all.
    mass_g : float or None
        Of the puck. [g]
    density : Quantity
        Of the cured resin. [g/cm3]
    """
    young, puck = point.young_kPa.value, point.puck
    known = without_points(resin).modulus_kPa(point.ratio)
    prior = Point(point.ratio, known)
    pairs = [
        Pair(
            f"young_kPa of this puck and of {resin.name} at ratio {point.ratio:g}",
            young,
            known.value,
            math.hypot(point.spread, prior.spread),
            "check diameter, height, ratio and the unit of the force",
        )
    ]
    for other in resin.points:
        if math.isclose(other.ratio, point.ratio, abs_tol=0.5 * resin.ratio_step):
            own = np.array([point.spread, -other.spread])
            spread = math.sqrt(own @ correlation([point, other]) @ own)
            where = other.puck.file if other.puck else other.young_kPa.source
            what = f"young_kPa of this puck and of {where}"
            check = "one is of another mix, size or unit; measure again or give its own ratio"
            pairs.append(Pair(what, young, other.young_kPa.value, spread, check))
    for (first, one), (second, two) in combinations(presses, 2):
        what = f"young_kPa by {first} and {second}"
        moduli = young * math.exp(one), young * math.exp(two)
        check = "the files are of two pucks, or the puck slipped; add each puck by itself"
        pairs.append(Pair(what, *moduli, math.sqrt(2.0) * REPEAT, check))
    if mass_g is not None and puck is not None:
        volume_cm3 = 0.25e-3 * math.pi * puck.diameter_mm**2 * puck.height_mm
        spread = math.hypot(VOLUME_SPREAD, Point(point.ratio, density).spread)
        check = "check diameter and height; voids make a puck lighter"
        pairs.append(Pair("mass_g weighed and by size and density", mass_g, density.value * volume_cm3, spread, check))
    return pairs


def check_slips(pair: Pair) -> None:
    """Refuse a modulus that is far from the resin's where a usual mistake explains it, or that no resin has."""
    low, high = YOUNG.usual
    far = abs(pair.deviations) > SURPRISE
    near = max(SURPRISE * pair.spread, SLIP_FITS)
    misses = sorted((abs(math.log(pair.a * size / pair.b)), words) for words, size in SLIPS.items())
    slips = [words for miss, words in misses[:2] if miss <= near]
    if low <= pair.a <= high and not (far and slips):
        return
    cause = " or ".join(slips) or pair.check
    raise InputError(
        f"the puck says {pair.a:.3g} kPa, the resin {pair.b:.3g} kPa ({abs(pair.deviations):.1f} standard deviations "
        f"apart): probably {cause}, or the ratio is another. Put it right; if all is right, begin with a resin of "
        "its hardness (resins add-hardness --resin BASE)",
        "implausible_unit",
        "force_N",
        pair.a,
        (low, high),
    )


def warnings_of(pairs: Sequence[Pair], alpha: float) -> tuple[tuple[Contradiction, ...], tuple[dict[str, str], ...]]:
    """Pairs that contradict each other and a warning each, the largest first, and one of an exponent at its bound."""
    far = sorted((one for one in pairs if abs(one.deviations) > SURPRISE), key=lambda one: -abs(one.deviations))
    said = [
        f"{one.what}: {one.a:.3g} and {one.b:.3g}, {abs(one.deviations):.1f} standard deviations apart; {one.check}"
        for one in far
    ]
    warnings = [{"code": "contradiction", "message": text} for text in said]
    if min(abs(alpha - end) for end in ALPHA_RANGE) < AT_BOUND:
        message = f"the Ogden exponent ended at the bound of its range, {alpha:.3g}; check diameter and height"
        warnings.append({"code": "exponent_at_bound", "message": message})
    return tuple(Contradiction(one.what, one.a, one.b) for one in far), tuple(warnings)
