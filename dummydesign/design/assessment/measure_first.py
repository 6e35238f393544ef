"""What to measure first: the group of uncertainties that, once known, makes most castings usable."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import (
    FORCE_LAW,
    MAKING,
    MODULUS,
    RELAXATION,
    RESIN,
    TISSUE,
    PadCastings,
    Pours,
)
from dummydesign.design.expected.tissue_doubt import castings_for_tissues, kinds_of
from dummydesign.design.scoring.acceptability import strict_aim
from dummydesign.design.scoring.deviations import CLASSES, STANDS_FOR, USABLE
from dummydesign.design.scoring.score import evaluate

if TYPE_CHECKING:
    from dummydesign.design.search.slabs import Candidate

GAIN = 0.03
"""Least gain of usable castings for which something is measured: twice the standard error of a share."""
NEAR, ROUGH, LEAST = 10, 120, 0.01
"""Steps of the ratio that are tried for two pads, castings of each, and the share below which none is proposed."""
NAMES = {
    MODULUS: "the modulus", RELAXATION: "the relaxation", MAKING: "weighing and thickness",
    FORCE_LAW: "the pad's force law", TISSUE: "the tissue",
}  # fmt: skip
PUCK_MM = (50.0, 30.0)


@dataclass(frozen=True)
class MeasureFirst:
    """What to measure first, and what it is worth.

    Attributes
    ----------
    group : str or None
        Of :data:`~dummydesign.design.assessment.castings.GROUPS`; None where nothing that is measured helps.
    acceptable_now : float
        Share of castings that are acceptable.
    acceptable_means : str
        ``stands_for``: without a correction, where most castings would be once the resin is measured; else ``usable``.
    acceptable_if_known : dict
        The share with one group known; ``modulus+relaxation`` with both.
    acceptable_over_tissues : float or None
        The same of castings for tissues that the data allow; None where no tissue is drawn.
    protocol, command, text : str
        How it is measured, what to type then, and both in a sentence. Empty without a group.
    ratios, each_fraction, either_fraction : tuple or None
        Two ratios to pour meanwhile, with the share of castings of each, and of at least one, that are usable.
    """

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

    def to_dict(self) -> dict[str, Any]:
        """Return all fields."""
        return asdict(self)


def measure_first(cast: PadCastings) -> MeasureFirst:
    """Compare the castings of a pad with all unknown and with one group known.

    A group that is known has its deviates at the centre. The tissue is no part of the castings, which are judged
    against its subjects as stated; it comes first where no group of the castings helps and its own doubt costs most.

    Parameters
    ----------
    cast : PadCastings
    """
    targets, strict = cast.space.targets, strict_aim(cast.space.targets)
    known = {group: kinds_of(cast.pressed((group,)), targets) for group in (MODULUS, RELAXATION, MAKING, FORCE_LAW)}
    both = kinds_of(cast.pressed(RESIN), targets)
    means = STANDS_FOR if strict or (both == 0).mean() > 0.5 else USABLE
    worst = CLASSES.index(means)
    fit = kinds_of(cast.every, targets) <= worst
    now = float(fit.mean())
    listed = {group: float((kinds <= worst).mean()) for group, kinds in known.items()}
    gains = {group: share - now for group, share in listed.items()}
    listed["modulus+relaxation"] = resin = float((both <= worst).mean())
    if resin - now >= GAIN and max(gains.values()) < GAIN:
        gains[max(sorted(RESIN), key=lambda group: gains[group])] = resin - now  # only both together help
    over = castings_for_tissues(cast, 0.0, worst=worst)
    # the first castings alone are scored for other tissues: what they lose there is taken off the share of all
    lost_there = float(fit[: over.usable.shape[1]].mean() - over.usable.mean())
    over_tissues = min(max(now - lost_there, 0.0), 1.0) if over.tissue_drawn else None
    listed[TISSUE] = now
    group = max(gains, key=lambda name: gains[name])
    if gains[group] < GAIN:
        lost = 0.0 if over_tissues is None else now - over_tissues
        group, gains[TISSUE] = TISSUE, lost
    if gains[group] < GAIN or len(targets.tissue.subjects) < 2:
        return MeasureFirst(None, now, means, listed, over_tissues, "", "", "")
    protocol, command = _how(group, cast.candidate, cast)
    share = now + gains[group] if group != TISSUE else now
    start = now if group != TISSUE else over_tissues or 0.0
    words = "are usable" if means == USABLE else "need no correction"
    if group == TISSUE:
        text = f"measure people: for other people that the data allow {_percent(start)} of castings {words}"
        return MeasureFirst(group, now, means, listed, over_tissues, protocol, command, text)
    text = f"measure {NAMES[group]}: {_percent(start)} of castings {words}, {_percent(share)} once it is known"
    pair = _two_ratios(cast, worst) if group in RESIN else None
    found = MeasureFirst(group, now, means, listed, over_tissues, protocol, command, text)
    return found if pair is None else replace(found, ratios=pair[0], each_fraction=pair[1], either_fraction=pair[2])


def _how(group: str, candidate: Candidate, cast: PadCastings) -> tuple[str, str]:
    """How a group is measured, and what to type then."""
    resin = cast.space.resin
    if group in RESIN:
        diameter, height = PUCK_MM
        batch = batch_name(resin.name)
        protocol = (
            f"cast a puck ({diameter:g} mm diameter, {height:g} mm high) at ratio {candidate.ratio:g}; "
            "press it: ramp, then 10 s hold; "
            "this measures modulus and relaxation with one puck in two minutes"
        )
        command = (
            f"dummydesign resins add-compression puck.csv --diameter {diameter:g} --height {height:g} "
            f"--ratio {candidate.ratio:g} --name {batch} --resin {resin.name}"
        )
        return protocol, command
    if group == MAKING:
        return ("weigh a larger batch or use a finer balance, and gauge the thickness of the cast pad",
                "dummydesign suggest ... --balance 0.01 --thickness-tolerance 0.1")  # fmt: skip
    if group == FORCE_LAW:
        return ("cast the pad, press it by a campaign and calibrate", "dummydesign loop CAMPAIGN_DIR")
    return ("press the people themselves, or use published traces of them", "dummydesign tissues add NAME TRACE.csv...")


def batch_name(resin: str) -> str:
    """Name of the resin that a puck's measurement makes of a resin."""
    return "my-batch" if resin != "my-batch" else "my-batch-2"


def _two_ratios(
    cast: PadCastings, worst: int
) -> tuple[tuple[float, float], tuple[float, float], float] | None:
    """Two ratios of which at least one is usable for most castings: found on a few castings, counted on all."""
    space = cast.space
    here = int(np.argmin(np.abs(space.ratio - cast.candidate.ratio)))
    ratios = space.ratio[max(here - NEAR, 0) : here + NEAR + 1]
    if len(ratios) < 2:
        return None
    each = [cast.pours(ratio=float(ratio)).first(ROUGH) for ratio in ratios]
    rough = _usable(cast, each, worst)
    either = (rough[:, None] | rough[None]).mean(axis=-1)
    np.fill_diagonal(either, -1.0)
    first, second = sorted(int(at) for at in np.unravel_index(int(np.argmax(either)), either.shape))
    pair = float(ratios[first]), float(ratios[second])
    found = _usable(cast, [cast.pours(ratio=ratio) for ratio in pair], worst)
    share = float((found[0] | found[1]).mean())
    if share < LEAST:
        return None
    return pair, (float(found[0].mean()), float(found[1].mean())), share


def _usable(cast: PadCastings, pours: list[Pours], worst: int) -> NDArray:
    """Which castings of several ratios are acceptable, shape (ratios, castings)."""
    names = ("thickness_mm", "young_MPa", "beta")
    every = Pours(*(np.concatenate([getattr(one, name) for one in pours]) for name in names))
    targets = cast.space.targets
    found = evaluate(cast.slabs(every), targets, cast.space.sampling.coarse)
    return (kinds_of(found, targets) <= worst).reshape(len(pours), -1)


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"
