"""Why this pad: its terms, the next best, its expected score over castings and tissue, and what to measure first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.design.assessment.castings import (
    FORCE_LAW,
    MAKING,
    MODULUS,
    RELAXATION,
    RESIN,
    TISSUE,
    Castings,
    PadCastings,
    Pours,
    Tolerances,
)
from dummydesign.design.scoring.law_parameters import gamma1_score
from dummydesign.design.scoring.presses import make_curves
from dummydesign.design.scoring.score import Evaluation, evaluate, evaluated_gamma1, scored_for
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import (
    ACCEPTABLE,
    BORDERLINE,
    CLASSES,
    STANDS_FOR,
    USABLE,
    acceptability_rank,
    classes,
    classes_of,
    deviations_of,
    ranges_of,
)
from dummydesign.design.search.best_of_kinds import ShapeComparison, Shaped, compare_shape, mixable
from dummydesign.design.search.slabs import DesignCandidate, SearchSpace, exact_candidates, make_slabs, with_parameters

# Castings, the first of an answer's, that are scored for every tissue.
POURS = 120
# Gain of a term below which it is not named, and standard errors by which another pad has to be expected to score more.
TELLS, SURE = 0.005, 2.0


@dataclass(frozen=True)
class TissueScores:
    """Castings of one pad, scored for each tissue that is drawn, or for the one that is known where none is."""

    total: NDArray
    merit: NDArray
    usable: NDArray
    merit_as_known: NDArray

    @property
    def tissue_drawn(self) -> bool:
        """Whether what is not known of the tissue is in the numbers."""
        return len(self.total) > 1


def castings_for_tissues(cast: PadCastings, low_share: float, worst: int = 1) -> TissueScores:
    """Score castings of a pad for every tissue that is drawn; parameters are those of gamma1.

    What is scored is kept with the castings, as several parts of an answer rest on it; its shapes are (1 + tissues,
    castings), the tissue as stated first.
    """
    if not cast.over_tissues:
        space = cast.space
        pressed = evaluate(cast.slabs(cast.pours().first(POURS)), space.targets, space.sampling.coarse)
        gamma1 = evaluated_gamma1(pressed, space.targets.power)
        rows = []
        for targets in (space.targets, *space.targets.drawn):
            evaluation = pressed if targets is space.targets else scored_for(pressed, targets)
            total = evaluation.total(gamma1_score(gamma1, targets))
            rows.append((total, evaluation.low_aim, classes_of(evaluation, targets)))
        cast.over_tissues.extend(np.array(values) for values in zip(*rows))
    total, low_aim, kinds = cast.over_tissues
    merit = (1.0 - low_share) * total + low_share * low_aim
    kept = slice(1, None) if len(total) > 1 else slice(None)
    return TissueScores(total[kept], merit[kept], (kinds <= worst)[kept], merit[0])


def usable(evaluation: Evaluation, targets: Targets) -> NDArray:
    """Whether pads may be used for a tissue, as they are or with a correction, shape (n,)."""
    return np.asarray(classes_of(evaluation, targets) <= CLASSES.index(USABLE))


def tissue_share(values: NDArray) -> float | None:
    """Share of the variance of values (tissues, pours) that is the tissue's: that of its means over the pours.

    None where no tissue was drawn. What few pours leave in the means of the tissues is taken off.
    """
    tissues, pours = values.shape
    whole = float(values.var())
    if tissues < 2 or whole <= 0.0:
        return None
    rows, columns = values.mean(axis=1, keepdims=True), values.mean(axis=0, keepdims=True)
    left = values - rows - columns + values.mean()
    rest = float((left**2).sum() / ((tissues - 1) * (pours - 1)))
    return float(np.clip((rows.var(ddof=1) - rest / pours) / whole, 0.0, 1.0))


WORDS = {
    "aim": "its closeness to the aim",
    "steady_state_range": "its steady forces",
    "force_variation_range": "its force over time",
    "parametric": "its fitted parameters",
    "low_aim": "its match below {low:g} N",
}


@dataclass(frozen=True)
class Choice(Serialised):
    """Why a pad was taken."""

    text: str
    next_best: str | None
    terms: dict[str, float]
    decided_by: str | None
    expected_total: float
    total_low: float
    tissue_share: float | None


def explain(cast: PadCastings, kind: str, comparisons: tuple[ShapeComparison, ...]) -> Choice:
    """Compare the recommended pad with the best of another kind."""
    best, targets = cast.candidate, cast.space.targets
    totals = castings_for_tissues(cast, 0.0).total
    score = float(totals.mean()), float(np.quantile(totals, 0.05)), tissue_share(totals)
    doubt = f"score {score[0]:.2f} of 1 with all uncertainties (5 % of castings below {score[1]:.2f})"
    others = [(item.candidate, item.kind) for item in comparisons if item.kind != kind and item.candidate is not None]
    if not others:
        return Choice(f"no other kind of shape was compared; {doubt}", None, {}, None, *score)
    other, other_kind = max(others, key=lambda item: item[0].worth())
    name = f"the {other_kind} pad ({other.thickness_mm:g} mm, ratio {other.ratio:g})"
    gains = terms(best, other)
    words = {term: text.format(low=targets.protocol.forces_N[0]) for term, text in WORDS.items()}
    decided = max(gains, key=lambda term: gains[term])
    lost = [words[term] for term, gain in gains.items() if gain < -TELLS]
    if other.rank < best.rank:
        decided, text = "verdict", f"{name} comes next and is not representative"
    else:
        text = f"chosen over {name} mainly for {words[decided]} (+{gains[decided]:.2f} of {sum(gains.values()):+.2f})"
        text += f"; weaker in {' and '.join(lost)}" if lost else ""
    return Choice(f"{text}; {doubt}", name, gains, decided, *score)


def terms(best: DesignCandidate, other: DesignCandidate) -> dict[str, float]:
    """What each term of the score adds to the merit of one design over another; they sum to the difference."""
    weights = best.evaluation.weights
    share = weights.low_aim

    def parts(one: DesignCandidate) -> dict[str, float]:
        shares = {
            name: (1.0 - share) * weight * float(getattr(one.evaluation, name)[one.index])
            for name, weight in weights.parts.items()
            if name != "parametric"
        }
        # What the total says of the parameters, also where they were fitted to one and not to the other.
        if "parametric" in weights.parts:
            shares["parametric"] = (1.0 - share) * one.total - sum(shares.values())
        return {**shares, "low_aim": share * float(one.evaluation.low_aim[one.index])}

    mine, its = parts(best), parts(other)
    return {name: mine[name] - its[name] for name in mine}


@dataclass(frozen=True)
class Expected:
    """One pad: its score at central estimates, mean and 5 % quantile over its castings, and how many are usable.

    ``acceptable_fraction`` is the share of the answer's castings that may be used, as they are or with a correction.
    ``tissue_share`` is the share of the variance of its score that is the tissue's; None where no tissue is drawn.
    """

    kind: str
    thickness_mm: float
    ratio: float
    worth: float
    expected_worth: float
    low_worth: float
    acceptable_fraction: float
    tissue_share: float | None

    @property
    def words(self) -> str:
        """The pad: kind, thickness and ratio."""
        return f"the {self.kind} pad of {self.thickness_mm:g} mm, ratio {self.ratio:g}"


@dataclass(frozen=True)
class Expectation(Serialised):
    """The choice by castings beside that at central estimates; ``differs`` when they are two pads.

    ``undecided`` says between which two kinds the relaxation of the resin decides; None where it does not.
    """

    text: str
    differs: bool
    taken: Expected
    middle: Expected
    undecided: str | None = None


@dataclass(frozen=True)
class _Contender:
    """A pad that the search does not tell apart from the best, with its castings."""

    chosen: Shaped
    candidate: DesignCandidate
    cast: PadCastings

    @property
    def green(self) -> bool:
        """Whether enough castings stand for the subjects; within the limits' tie counts as kept."""
        targets = self.cast.space.targets
        limits, tie = targets.limits, 1.0 + targets.limits.tie
        near = replace(limits, stands_shortfall=limits.stands_shortfall * tie, stands_over=limits.stands_over * tie)
        return bool((classes(deviations_of(self.cast.every, targets), near) == 0).mean() >= limits.share)

    def expected(self, scores: TissueScores, low_share: float) -> Expected:
        """Its score over castings and tissues."""
        one, merit = self.candidate, scores.merit
        return Expected(
            self.chosen.shape.name, one.thickness_mm, one.ratio, one.merit(low_share), float(merit.mean()),
            float(np.quantile(merit, 0.05)), float(usable(self.cast.every, self.cast.space.targets).mean()),
            tissue_share(merit),
        )  # fmt: skip


def by_expectation(
    close: Sequence[Shaped], space: SearchSpace, castings: Castings, tolerances: Tolerances, low_share: float
) -> tuple[Shaped, Expectation]:
    """Take the pad of the best light, and of these the one with the largest expected score."""
    pads = [
        _Contender(chosen, candidate, PadCastings(castings, chosen.cast, candidate, space, tolerances))
        for chosen in close
        for candidate in _near(chosen, space)
    ]
    green = [pad.green for pad in pads]
    first, least = pads[0].candidate, pads[0].candidate.rank
    # a pad that keeps a limit by less than the limits' tie: the score decides over pads just beyond it
    tighter = acceptability_rank(first.evaluation, space.targets, tighter=True)[first.index]
    if least == ACCEPTABLE and tighter < ACCEPTABLE:
        least = BORDERLINE
    able = [at for at, pad in enumerate(pads) if pad.candidate.rank >= least and green[at] >= max(green)]
    order = able if 0 in able else [0, *able]
    scores = {at: castings_for_tissues(pads[at].cast, low_share) for at in order}
    best, as_known = _best_of([scores[at] for at in order])
    if 0 not in able and best == 0:
        # another pad has the better light: the best expected of those
        best = max(range(1, len(order)), key=lambda at: float(scores[order[at]].merit.mean()))
    taken = order[best]
    chosen, candidate = pads[taken].chosen, pads[taken].candidate
    winner, middle = (pads[at].expected(scores[at], low_share) for at in (taken, 0))
    undecided = _undecided(taken, pads, scores)
    uncertain = "resin, casting and tissue" if space.targets.drawn else "resin and casting"
    if taken == 0:
        text = f"{winner.words} is also the best over {uncertain}"
        return chosen, Expectation(text, False, winner, middle, undecided)
    shares = f"{100 * winner.acceptable_fraction:.0f} % against {100 * middle.acceptable_fraction:.0f} %"
    text = (
        f"{winner.words} beats {middle.words} over {'resin and casting' if as_known else uncertain}: score "
        f"{winner.expected_worth:.3f} against {middle.expected_worth:.3f}, {shares} of castings usable"
    )
    if candidate is not chosen.result.best:
        chosen = replace(chosen, result=replace(chosen.result, best=with_parameters([candidate], space)[0]))
        rows = tuple(
            compare_shape(chosen, space, item.by or "table") if item.kind == chosen.shape.name else item
            for item in chosen.comparisons
        )
        chosen = replace(chosen, comparisons=rows)
    return chosen, Expectation(text, True, winner, middle, undecided)


def _undecided(taken: int, pads: Sequence[_Contender], scores: dict[int, TissueScores]) -> str | None:
    """Two kinds between which the relaxation decides: one is better where it is weak, the other where it is strong."""
    kind = pads[taken].chosen.shape.name
    for at in scores:
        other = pads[at].chosen.shape.name
        if other == kind:
            continue
        gain = (scores[taken].merit - scores[at].merit).mean(axis=0)
        strength = pads[taken].cast.pours().first(len(gain)).beta.sum(axis=-1)
        if not strength.std() > 0.0:
            continue
        rank = np.argsort(np.argsort(strength))
        thirds = [gain[rank < len(gain) // 3], gain[rank >= len(gain) - len(gain) // 3]]
        means = np.array([one.mean() for one in thirds])
        sure = SURE * np.array([one.std(ddof=1) for one in thirds]) / np.sqrt(len(gain) // 3)
        if (means < -sure).any() and (means > sure).any():
            return f"cannot choose between the {kind} and the {other} pad until the resin's relaxation is measured"
    return None


def _near(chosen: Shaped, space: SearchSpace) -> list[DesignCandidate]:
    """The best pad, and those of one step of the ratio either way that rank no lower."""
    best = chosen.result.best
    here = int(np.argmin(np.abs(space.ratio - best.ratio)))
    beside = (at for at in (here - 1, here + 1) if 0 <= at < len(space.ratio))
    steps = [at for at in beside if mixable(chosen.shape, float(space.ratio[at]), space.resin)]
    if not steps:
        return [best]
    curves = make_curves(chosen.cast, np.array([best.thickness_mm]), space.radius_mm)
    slabs = make_slabs(curves, np.zeros(len(steps), int), space.resin, space.ratio[steps])
    others = exact_candidates(slabs, space.ratio[steps], space)
    least = min(best.rank, BORDERLINE)
    return [best, *(one for one in others if one.evaluation.feasible[one.index] and one.rank >= least)]


def _best_of(drawn: Sequence[TissueScores]) -> tuple[int, bool]:
    """Which pad is surely expected to be worth more than the first, and whether for the tissue as it is known alone.

    Where the doubt about the tissue hides a difference, that for the central tissue decides
    among the pads that are expected to be worth no less over all of it.
    """
    gains = [one.merit - drawn[0].merit for one in drawn]
    best = max(range(len(drawn)), key=lambda at: float(gains[at].mean()))
    if float(gains[best].mean()) > SURE * _error_of_mean(gains[best]):
        return best, False
    able = [at for at, gain in enumerate(gains) if gain.mean() >= 0.0]
    best = max(able, key=lambda at: float(drawn[at].merit_as_known.mean()))
    gain = (drawn[best].merit_as_known - drawn[0].merit_as_known)[None]
    return (best, True) if float(gain.mean()) > SURE * _error_of_mean(gain) else (0, False)


def _error_of_mean(values: NDArray) -> float:
    """Standard error of the mean of values (tissues, pours), drawn along each axis.

    Tissues drawn evenly over a posterior come in strata: only differences of neighbours remain.
    """
    tissues, pours = values.shape
    of_pours = values.mean(axis=0).var() / pours
    of_tissues = 0.5 * np.mean(np.diff(values.mean(axis=1)) ** 2) / tissues if tissues > 1 else 0.0
    return float(np.sqrt(of_pours + of_tissues))


# Least gain of usable castings for which something is measured: twice the standard error of a share.
GAIN = 0.03
# Steps of the ratio that are tried for two pads, castings of each, and the share below which none is proposed.
NEAR_RATIOS, ROUGH, LEAST = 10, 120, 0.01
NAMES = {
    MODULUS: "the modulus", RELAXATION: "the relaxation", MAKING: "weighing and thickness",
    FORCE_LAW: "the pad's force law", TISSUE: "the tissue",
}  # fmt: skip
# How what is no resin is measured, and what to type then.
HOW = {
    MAKING: ("weigh a larger batch or use a finer balance, and gauge the thickness of the cast pad",
             "dummydesign suggest ... --balance 0.01 --thickness-tolerance 0.1"),
    FORCE_LAW: ("cast the pad, press it by a campaign and calibrate", "dummydesign loop CAMPAIGN_DIR"),
    TISSUE: ("press the people themselves, or use published traces of them",
             "dummydesign tissues add NAME TRACE.csv..."),
}  # fmt: skip
# Diameter and height.
PUCK_MM = (50.0, 30.0)


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
    """
    targets = cast.space.targets
    known = {group: classes_of(cast.pressed((group,)), targets) for group in (MODULUS, RELAXATION, MAKING, FORCE_LAW)}
    both = classes_of(cast.pressed(RESIN), targets)
    means = STANDS_FOR if ranges_of(targets).strict or (both == 0).mean() > 0.5 else USABLE
    worst = CLASSES.index(means)
    fit = classes_of(cast.every, targets) <= worst
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
        group, gains[TISSUE] = TISSUE, 0.0 if over_tissues is None else now - over_tissues
    shares = now, means, listed, over_tissues
    if gains[group] < GAIN or len(targets.tissue.subjects) < 2:
        return MeasureFirst(None, *shares, "", "", "")
    words = "are usable" if means == USABLE else "need no correction"
    if group == TISSUE:
        text = f"measure people: for other people that the data allow {100 * (over_tissues or 0.0):.0f} % of castings"
        return MeasureFirst(group, *shares, *_how(group, cast), f"{text} {words}")
    then = f"{100 * (now + gains[group]):.0f} % of castings {words}"
    text = f"measure {NAMES[group]}: then {then} (now {100 * now:.0f} %)"
    pair = _two_ratios(cast, worst) if group in RESIN else (None, None, None)
    return MeasureFirst(group, *shares, *_how(group, cast), text, *pair)


def _how(group: str, cast: PadCastings) -> tuple[str, str]:
    """How a group is measured, and what to type then."""
    resin, ratio = cast.space.resin.name, cast.candidate.ratio
    if group in RESIN:
        diameter, height = PUCK_MM
        batch = "my-batch" if resin != "my-batch" else "my-batch-2"
        protocol = (
            f"cast a puck ({diameter:g} mm diameter, {height:g} mm high) at ratio {ratio:g}; press it: ramp, then 10 s "
            "hold; this measures modulus and relaxation with one puck in two minutes"
        )
        command = (
            f"dummydesign resins add-compression puck.csv --diameter {diameter:g} --height {height:g} "
            f"--ratio {ratio:g} --name {batch} --resin {resin}"
        )
        return protocol, command
    return HOW[group]


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
    every = Pours(*(np.concatenate(columns) for columns in zip(*(vars(one).values() for one in pours))))
    targets = cast.space.targets
    evaluation = evaluate(cast.slabs(every), targets, cast.space.sampling.coarse)
    return (classes_of(evaluation, targets) <= worst).reshape(len(pours), -1)
