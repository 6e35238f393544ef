"""What to measure first: what the castings gain by each group that is known, and two ratios to pour meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.design.assessment.pad_castings import PadCastings
from dummydesign.design.scoring.castings import FORCE_LAW, MAKING, MODULUS, RELAXATION, RESIN, TISSUE, Pours
from dummydesign.design.scoring.verdict import (
    CLASSES,
    STANDS_FOR,
    WITH_CORRECTION,
    Readings,
    classes,
    deviations,
    ranges_of,
)
from dummydesign.design.scoring.windows import readings_along
from dummydesign.mold.pour.plan import WITNESS_MM
from dummydesign.mold.puck.protocol import BATCH, command, trace_names

# Castings, the first of an answer's, that are judged for every tissue that is drawn.
POURS = 120
# Least gain of usable castings for which something is measured: twice the standard error of a share.
GAIN = 0.03
# Steps of the ratio that are tried for two pads, castings of each, and the share below which none is proposed.
NEAR_RATIOS, ROUGH, LEAST = 10, 120, 0.01
NAMES = {
    MODULUS: "the modulus",
    RELAXATION: "the relaxation",
    MAKING: "weighing and thickness",
    FORCE_LAW: "the pad's force law",
    TISSUE: "the tissue",
}
CROWN = "weighing, thickness and the crown's height"
# How what is no resin is measured.
HOW = {
    MAKING: (
        "weigh a larger batch or use a finer balance (--balance), and gauge the thickness of the cast pad "
        "(--thickness-tolerance)"
    ),
    FORCE_LAW: "cast the pad, press it by a campaign and calibrate",
    TISSUE: "press the people themselves, or use published traces of them",
}


def batch_name(resin: str) -> str:
    """Name to give a batch that is measured of a resin: not the resin's own."""
    return BATCH if resin != BATCH else f"{BATCH}-2"


@dataclass(frozen=True)
class MeasureFirst(Serialised):
    """What to measure first, and what it is worth."""

    group: str | None
    acceptable_now: float
    acceptable_means: str
    acceptable_if_known: dict[str, float]
    acceptable_over_tissues: float | None
    protocol: str
    command: str
    text: str
    ratios: tuple[float, float] | None = None
    each_fraction: tuple[float, float] | None = None
    either_fraction: float | None = None


def measure_first(cast: PadCastings) -> MeasureFirst:
    """Compare the castings of a pad with all unknown and with one group known.

    A group that is known has its deviates at the centre. The tissue is no part of the castings, which are judged
    against its subjects as stated; it comes first where no group of the castings helps and its own doubt costs most.
    What a group is worth is found on the castings that were requested; see :func:`share_if_known`.
    """
    few, targets = cast.few, cast.space.targets
    ranges, limits = ranges_of(targets), targets.limits

    def judged(readings: Readings) -> NDArray:
        return classes(deviations(ranges, readings), limits)

    known = {group: judged(few.readings((group,))) for group in (MODULUS, RELAXATION, MAKING, FORCE_LAW)}
    both = judged(few.readings(RESIN))
    means = STANDS_FOR if ranges.strict or (both == 0).mean() > 0.5 else "usable"
    worst = CLASSES.index(STANDS_FOR if means == STANDS_FOR else WITH_CORRECTION)
    fit = judged(few.readings()) <= worst
    now = float((judged(cast.readings()) <= worst).mean())

    listed = {group: share_if_known(kinds <= worst, fit, now) for group, kinds in known.items()}
    batch_known = cast.space.resin.measured
    gains = {group: of_group - now for group, of_group in listed.items() if not (batch_known and group in RESIN)}
    listed["modulus+relaxation"] = resin = share_if_known(both <= worst, fit, now)
    if not batch_known and resin - now >= GAIN and max(gains.values()) < GAIN:
        gains[max(sorted(RESIN), key=lambda group: gains[group])] = resin - now  # only both together help
    over_tissues = _over_tissues(few, fit, now, worst)
    listed[TISSUE] = now
    group = max(gains, key=lambda name: gains[name])
    if gains[group] < GAIN:
        group, gains[TISSUE] = TISSUE, 0.0 if over_tissues is None else now - over_tissues
    shares = now, means, listed, over_tissues
    if gains[group] < GAIN or len(targets.tissue.subjects) < 2:
        return MeasureFirst(None, *shares, "", "", "")
    words = "need no correction" if means == STANDS_FOR else "are usable"
    if group == TISSUE:
        text = f"measure people: for other people that the data allow {100 * (over_tissues or 0.0):.0f} % of castings"
        return MeasureFirst(group, *shares, *_how(group, cast), f"{text} {words}")
    then = f"{100 * (now + gains[group]):.0f} % of castings {words}"
    crowned = group == MAKING and cast.tolerances.crown is not None
    text = f"measure {CROWN if crowned else NAMES[group]}: then {then} (now {100 * now:.0f} %)"
    pair = _two_ratios(few, worst) if group in RESIN else (None, None, None)
    return MeasureFirst(group, *shares, *_how(group, cast), text, *pair)


def share_if_known(known: NDArray, fit: NDArray, now: float) -> float:
    """Share of acceptable castings with a group known, from the first of them with and without, and the share of all.

    The regression estimate of a mean with a control variate: what the first castings differ from all counts as far as
    both states go together (Cochran, Sampling Techniques, 1977, 7.3).
    """
    spread = float(fit.var())
    slope = float(np.cov(known, fit, bias=True)[0, 1]) / spread if spread > 0.0 else 0.0
    return float(np.clip(known.mean() + slope * (now - fit.mean()), 0.0, 1.0))


def _over_tissues(cast: PadCastings, fit: NDArray, now: float, worst: int) -> float | None:
    """Share of castings that are acceptable for the tissues that the data allow; None where none can be drawn."""
    targets = cast.space.targets
    if not targets.drawn:
        return None
    whole = cast.readings()
    first = Readings(*(getattr(whole, name)[:POURS] for name in ("peak_N", "energy_mJ", "depth_mm")))
    others = [classes(deviations(ranges_of(one), first), one.limits) <= worst for one in targets.drawn]
    # the first castings alone are judged for other tissues: what they lose there is taken off the share of all
    lost = float(fit[:POURS].mean() - np.mean(others))
    return min(max(now - lost, 0.0), 1.0)


def _how(group: str, cast: PadCastings) -> tuple[str, str]:
    """How a group is measured, and what to type then."""
    resin, ratio = cast.space.resin.name, cast.candidate.ratio
    if group in RESIN:
        diameter, height = WITNESS_MM
        protocol = (
            f"cast a puck ({diameter:g} mm diameter, {height:g} mm high) at ratio {ratio:g}; press it: ramp, then 10 s "
            "hold; this measures modulus and relaxation with one puck in two minutes"
        )
        size = f"{diameter:g}", f"{height:g}"
        return protocol, command(trace_names("x".join(size)), *size, ratio, resin, batch_name(resin))
    crowned = group == MAKING and cast.tolerances.crown is not None
    return HOW[group] + (", at its tip and beside the crown" if crowned else ""), ""


Pair = tuple[float, float]


def _two_ratios(cast: PadCastings, worst: int) -> tuple[Pair, Pair, float] | tuple[None, None, None]:
    """Two ratios of which at least one is usable for most castings, found on a few castings; both shares on all."""
    ratios = cast.space.ratio
    here = int(np.argmin(np.abs(ratios - cast.candidate.ratio)))
    ratios = ratios[max(here - NEAR_RATIOS, 0) : here + NEAR_RATIOS + 1]
    if len(ratios) < 2:
        return None, None, None
    rough = _usable(cast, [cast.pours(ratio=float(ratio)).first(ROUGH) for ratio in ratios], worst)
    either = (rough[:, None] | rough[None]).mean(axis=-1)
    np.fill_diagonal(either, -1.0)
    first, second = sorted(int(at) for at in np.unravel_index(int(np.argmax(either)), either.shape))
    pair = float(ratios[first]), float(ratios[second])
    acceptable = _usable(cast, [cast.pours(ratio=ratio) for ratio in pair], worst)
    share = float((acceptable[0] | acceptable[1]).mean())
    if share < LEAST:
        return None, None, None
    return pair, (float(acceptable[0].mean()), float(acceptable[1].mean())), share


def _usable(cast: PadCastings, pours: list[Pours], worst: int) -> NDArray:
    """Which castings of several ratios are acceptable, shape (ratios, castings)."""
    targets, one = cast.space.targets, cast.slabs(pours[0])
    # thickness and crown are the same at every ratio, and so are the curves
    young, beta = np.concatenate([each.young_MPa for each in pours]), np.concatenate([each.beta for each in pours])
    every = replace(one, slab=np.tile(one.slab, len(pours)), young_MPa=young, beta=beta)
    grid, sampling = targets.protocol.steady_grid_N, cast.space.sampling.coarse
    readings = readings_along(every, targets, grid, sampling)
    return (classes(deviations(ranges_of(targets), readings), targets.limits) <= worst).reshape(len(pours), -1)
