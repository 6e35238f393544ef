"""Steps of the choice between pads on stand-ins: scores over tissues, whose doubt it is, what to measure first."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.assessment import choice
from dummydesign.design.assessment.castings import FORCE_LAW, MAKING, MODULUS, RELAXATION, RESIN, TISSUE, Pours
from dummydesign.design.assessment.choice import (
    POURS,
    SURE,
    Expected,
    TissueScores,
    _best_of,
    _error_of_mean,
    _near,
    _two_ratios,
    _undecided,
    by_expectation,
    castings_for_tissues,
    explain,
    measure_first,
    terms,
    tissue_share,
)
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import ACCEPTABLE, BORDERLINE, NOT_ACCEPTABLE
from dummydesign.design.search.slabs import DesignCandidate


def test_the_share_of_the_tissue_is_that_of_a_layout_of_two_ways():
    """Values = tissue + pour + rest, each of a known variance."""
    chance = np.random.default_rng(3)
    tissue, pour = chance.normal(size=(60, 1)), chance.normal(size=(1, 80))
    cases = ((1.0, 0.0, 0.0), 1.0), ((0.0, 1.0, 0.0), 0.0), ((2.0, 1.0, 0.0), None), ((1.0, 1.0, 3.0), None)
    for sizes, wanted in cases:
        rest = chance.normal(size=(60, 80))
        parts = sizes[0] * tissue, sizes[1] * pour, sizes[2] * rest
        share = parts[0].var() / sum(part.var() for part in parts) if wanted is None else wanted
        assert tissue_share(sum(parts) + np.zeros((60, 80))) == pytest.approx(share, abs=0.04)
    # a rest alone leaves something in the means of the tissues; it is taken off
    assert tissue_share(chance.normal(size=(200, 5))) < 0.1
    assert tissue_share(np.ones((3, 4))) is None and tissue_share(chance.normal(size=(1, 9))) is None


def test_the_error_of_a_mean_is_that_of_pours_and_of_tissues_in_strata():
    chance = np.random.default_rng(4)
    pours = chance.normal(size=(1, 400))
    assert _error_of_mean(pours) == pytest.approx(pours.std() / 20.0)
    assert _error_of_mean(np.repeat(pours, 7, axis=0)) == pytest.approx(pours.std() / 20.0)
    # tissues that rise evenly are strata: the error is that of one step, not of the whole range
    rising = np.repeat(np.arange(50.0)[:, None], 400, axis=1)
    assert _error_of_mean(rising) == pytest.approx(np.sqrt(0.5 / 50.0))
    loose = np.mean([_error_of_mean(chance.permutation(rising)) for _ in range(40)])
    assert loose == pytest.approx(rising.mean(axis=1).std(ddof=1) / np.sqrt(50.0), rel=0.1)


def scores(merit, known=None):
    merit = np.asarray(merit, float)
    return TissueScores(merit, merit, merit > 0.5, merit.mean(axis=0) if known is None else np.asarray(known, float))


def test_another_pad_is_taken_where_it_is_surely_worth_more():
    chance = np.random.default_rng(5)
    noise = chance.normal(size=(1, 100))
    base = np.full((1, 100), 0.5)
    error = 0.1 * noise.std() / 10.0
    for times, best in ((0.9, 0), (1.1, 1)):
        gain = 0.1 * (noise - noise.mean()) + times * SURE * error
        assert _best_of([scores(base), scores(base + gain)]) == (best, False)
    assert _best_of([scores(base), scores(base + 0.1), scores(base + 0.2), scores(base - 0.3)]) == (2, False)


def test_where_the_tissues_doubt_hides_a_difference_the_known_tissue_decides():
    """Over all tissues pads are alike within their error; for the known one the third is best and the second worse."""
    wide = 0.3 * (-1.0) ** np.arange(10.0)[:, None] + np.zeros((10, 50))
    base = np.full((10, 50), 0.5)
    first = scores(base, np.full(50, 0.5))
    # worth 0.01 more over all, hidden by tissues that differ by 0.3 either way
    better = scores(base + wide + 0.01, np.full(50, 0.6))
    worse = scores(base + wide - 0.01, np.full(50, 0.9))
    assert _best_of([first, better, worse]) == (1, True)
    assert _best_of([first, worse]) == (0, False)
    same = scores(base + wide + 0.01, 0.5 + 0.1 * (-1.0) ** np.arange(50.0))
    assert _best_of([first, same]) == (0, False)


def test_castings_are_scored_for_every_tissue_once(monkeypatch):
    """The stated tissue comes first and is left out of the mean where others are drawn."""
    drawn = tuple(SimpleNamespace(value=v) for v in (0.2, 0.4))
    stated = SimpleNamespace(value=0.6, power=3.0, drawn=drawn)
    asked = []

    def judged(targets):
        return SimpleNamespace(low_aim=np.full(3, 0.5 * targets.value), of=targets,
                               total=lambda parametric: np.full(3, targets.value) + parametric)  # fmt: skip

    monkeypatch.setattr(choice, "evaluate", lambda slabs, targets, sampling: asked.append(slabs) or judged(targets))
    monkeypatch.setattr(choice, "scored_for", lambda pressed, targets: judged(targets))
    monkeypatch.setattr(choice, "evaluated_gamma1", lambda pressed, power: power)
    monkeypatch.setattr(choice, "gamma1_score", lambda gamma1, targets: 0.01 * gamma1)
    monkeypatch.setattr(choice, "classes_of", lambda one, targets: np.array([0, 1, 2]))
    space = SimpleNamespace(targets=stated, sampling=SimpleNamespace(coarse=None))
    pours = SimpleNamespace(first=lambda count: count)
    cast = SimpleNamespace(over_tissues=[], space=space, pours=lambda: pours, slabs=lambda some: some)
    found = castings_for_tissues(cast, 0.25)
    np.testing.assert_allclose(found.total[:, 0], [0.23, 0.43])
    np.testing.assert_allclose(found.merit[:, 0], [0.75 * 0.23 + 0.25 * 0.1, 0.75 * 0.43 + 0.25 * 0.2])
    np.testing.assert_allclose(found.merit_as_known, 0.75 * 0.63 + 0.25 * 0.3)
    assert found.usable[0].tolist() == [True, True, False] and found.tissue_drawn
    assert castings_for_tissues(cast, 0.0, worst=0).usable[0].tolist() == [True, False, False] and asked == [POURS]
    alone = SimpleNamespace(**{**vars(cast), "over_tissues": [], "space": SimpleNamespace(
        targets=SimpleNamespace(value=0.6, power=3.0, drawn=()), sampling=space.sampling)})  # fmt: skip
    one = castings_for_tissues(alone, 0.0)
    assert one.total.shape == (1, 3) and not one.tissue_drawn and one.total[0, 0] == pytest.approx(0.63)


def design(total=0.6, aim=0.5, steady=0.7, low=0.4, rank=2, thickness=10.0, ratio=15.0, share=0.2, parametric=True):
    parts = {"aim": 0.3, "steady_state_range": 0.4, **({"parametric": 0.3} if parametric else {})}
    weights = SimpleNamespace(parts=parts, low_aim=share)
    evaluation = SimpleNamespace(weights=weights, aim=np.array([9.0, aim]), steady_state_range=np.array([9.0, steady]),
                                 low_aim=np.array([9.0, low]))  # fmt: skip
    return SimpleNamespace(evaluation=evaluation, index=1, total=total, rank=rank, thickness_mm=thickness, ratio=ratio,
                           worth=lambda: total * (0.01 if rank == 0 else 1.0))  # fmt: skip


def test_terms_are_weighed_differences_and_the_parameters_are_the_rest_of_the_total():
    gains = terms(design(0.7, 0.6, 0.9, 0.5), design(0.5, 0.5, 0.7, 0.8))
    assert gains["aim"] == pytest.approx(0.8 * 0.3 * 0.1)
    assert gains["steady_state_range"] == pytest.approx(0.8 * 0.4 * 0.2)
    assert gains["low_aim"] == pytest.approx(-0.2 * 0.3)
    assert sum(gains.values()) == pytest.approx(0.8 * 0.2 - 0.2 * 0.3)
    without = terms(design(parametric=False), design(aim=0.4, parametric=False))
    assert set(without) == {"aim", "steady_state_range", "low_aim"} and without["aim"] == pytest.approx(0.024)


def compared(monkeypatch, best, *others):
    values = np.linspace(0.0, 1.0, 101)[None]
    monkeypatch.setattr(choice, "castings_for_tissues", lambda cast, share: scores(values))
    protocol = SimpleNamespace(forces_N=(5.0, 10.0, 15.0))
    cast = SimpleNamespace(candidate=best, space=SimpleNamespace(targets=SimpleNamespace(protocol=protocol)))
    rows = tuple(SimpleNamespace(kind=kind, candidate=one) for kind, one in others)
    return explain(cast, "slab", rows)


def test_the_reason_names_the_term_that_gains_most_over_the_best_other_kind(monkeypatch):
    best, crowned = design(0.72, 0.9, 0.7, 0.35), design(0.6, 0.5, 0.7, 0.4, thickness=12.0, ratio=14.0)
    told = compared(monkeypatch, best, ("slab", design(0.9)), ("crowned", crowned), ("boned", design(0.5)), ("x", None))
    assert told.next_best == "the crowned pad (12 mm, ratio 14)" and told.decided_by == "aim"
    assert told.terms == terms(best, crowned)
    assert f"(+{told.terms['aim']:.2f} of {sum(told.terms.values()):+.2f})" in told.text
    # what gains less than half a hundredth is not named
    assert "weaker in its match below 5 N" in told.text
    small = compared(monkeypatch, design(0.72, 0.9, 0.7, 0.376), ("crowned", crowned))
    assert "weaker" not in small.text and small.terms["low_aim"] == pytest.approx(-0.0048)
    assert told.expected_total == pytest.approx(0.5) and told.total_low == pytest.approx(0.05)


def test_a_kind_that_is_not_representative_comes_next_by_its_verdict(monkeypatch):
    told = compared(monkeypatch, design(0.5), ("crowned", design(0.9, rank=0)))
    assert told.decided_by == "verdict"
    alone = compared(monkeypatch, design(0.5), ("slab", design(0.9)))
    assert alone.next_best is None and alone.decided_by is None and alone.terms == {}


class Contender(SimpleNamespace):
    """A pad with its castings' scores and its light, as the choice sees it."""

    def expected(self, scores, low_share):
        return Expected(self.chosen.shape.name, self.candidate.thickness_mm, 15.0, 0.5, float(scores.merit.mean()), 0.1,
                        self.share, None)  # fmt: skip


@pytest.fixture
def contenders(monkeypatch):
    """``by_expectation`` on pads given as (kind, rank, green, merit over the pours, usable)."""
    state = SimpleNamespace(tighter=ACCEPTABLE, pads=[])

    def choose(*rows, drawn=()):
        pads = []
        for number, (kind, rank, green, merit, share) in enumerate(rows):
            evaluation = SimpleNamespace()
            candidate = SimpleNamespace(rank=rank, thickness_mm=10.0 + number, evaluation=evaluation, index=0)
            chosen = SimpleNamespace(shape=SimpleNamespace(name=kind), result=SimpleNamespace(best=candidate),
                                     number=number, comparisons=(), cast=None)  # fmt: skip
            beta = np.stack([np.linspace(0.1, 1.0, 60), np.zeros(60)], axis=-1)
            cast = SimpleNamespace(scores=scores(merit), pours=lambda beta=beta: Pours(beta, beta, beta))
            pads.append(Contender(chosen=chosen, candidate=candidate, cast=cast, green=green, share=share))
        queue = iter(pads)
        monkeypatch.setattr(choice, "_Contender", lambda chosen, candidate, cast: next(queue))
        monkeypatch.setattr(choice, "PadCastings", lambda *args: None)
        monkeypatch.setattr(choice, "_near", lambda chosen, space: [chosen.result.best])
        monkeypatch.setattr(choice, "castings_for_tissues", lambda cast, share: cast.scores)
        monkeypatch.setattr(choice, "acceptability_rank", lambda evaluation, targets, tighter: [state.tighter])
        space = SimpleNamespace(targets=SimpleNamespace(drawn=drawn))
        taken, told = by_expectation([pad.chosen for pad in pads], space, None, None, 0.0)
        return taken.number, told

    state.choose = choose
    return state


def even(value):
    return np.full((1, 60), value)


def test_of_the_pads_of_the_best_light_the_one_expected_to_score_most_is_taken(contenders):
    number, told = contenders.choose(("slab", 2, True, even(0.5), 0.9), ("crowned", 2, True, even(0.6), 0.8))
    assert number == 1 and told.differs and told.taken.kind == "crowned" and told.middle.kind == "slab"
    assert "80 % against 90 % of castings usable" in told.text and "0.600 against 0.500" in told.text
    number, told = contenders.choose(("slab", 2, True, even(0.6), 0.9), ("crowned", 2, True, even(0.5), 0.9))
    assert number == 0 and not told.differs and told.taken == told.middle
    # a better light before a better score, a lower rank never
    assert contenders.choose(("slab", 2, True, even(0.5), 1.0), ("crowned", 2, False, even(0.9), 1.0))[0] == 0
    rows = ("slab", 2, False, even(0.9), 1.0), ("crowned", 2, True, even(0.4), 1.0), ("boned", 2, True, even(0.5), 1.0)
    assert contenders.choose(*rows)[0] == 2
    assert contenders.choose(("slab", 2, True, even(0.5), 1.0), ("crowned", 1, True, even(0.9), 1.0))[0] == 0


def test_a_pad_that_hardly_keeps_a_limit_is_compared_with_those_just_beyond(contenders):
    rows = ("slab", ACCEPTABLE, True, even(0.5), 1.0), ("crowned", BORDERLINE, True, even(0.9), 1.0)
    assert contenders.choose(*rows)[0] == 0
    contenders.tighter = BORDERLINE
    assert contenders.choose(*rows)[0] == 1
    rows = rows[0], ("crowned", NOT_ACCEPTABLE, True, even(0.9), 1.0)
    assert contenders.choose(*rows)[0] == 0


def test_two_kinds_of_which_each_is_better_at_one_end_of_the_relaxation_are_not_decided(contenders):
    rising = np.linspace(-0.1, 0.1, 60)[None] + 0.002 * np.sin(np.arange(60.0))[None]
    first = ("slab", 2, True, even(0.5), 1.0)
    ripple = 1e-3 * np.cos(np.arange(60.0))[None]
    for change, told in ((rising, True), (np.abs(rising), False), (ripple, False)):
        found = contenders.choose(first, ("crowned", 2, True, even(0.5) + change - 0.001, 1.0))[1]
        assert (found.undecided is not None) is told
    assert contenders.choose(first, ("slab", 2, True, even(0.5) + rising - 0.001, 1.0))[1].undecided is None


def test_an_end_of_the_relaxation_counts_from_two_standard_errors_of_its_third():
    beta = np.linspace(0.1, 1.0, 60)[:, None]
    chance = np.random.default_rng(1)
    noise = 0.05 * chance.normal(size=60)
    noise -= np.repeat([noise[:20].mean(), noise[20:40].mean(), noise[40:].mean()], 20)
    pads = [SimpleNamespace(chosen=SimpleNamespace(shape=SimpleNamespace(name=kind)),
                            cast=SimpleNamespace(pours=lambda: Pours(beta, beta, beta)))
            for kind in ("a", "b")]  # fmt: skip
    errors = [noise[part].std(ddof=1) / np.sqrt(20.0) for part in (slice(20), slice(40, 60))]
    for times, told in ((1.9, False), (2.1, True)):
        shift = np.r_[np.full(20, -times * errors[0]), np.zeros(20), np.full(20, times * errors[1])]
        found = _undecided(0, pads, {0: scores((noise + shift)[None]), 1: scores(np.zeros((1, 60)))})
        assert (found is not None) is told
    flat = [SimpleNamespace(**{**vars(pad), "cast": SimpleNamespace(pours=lambda: Pours(0 * beta, 0 * beta, 0 * beta))})
            for pad in pads]  # fmt: skip
    assert _undecided(0, flat, {0: scores(np.ones((1, 60))), 1: scores(np.zeros((1, 60)))}) is None
    # scores without scatter, alike or not, are no division by zero
    level = scores(np.zeros((1, 60)))
    assert _undecided(0, pads, {0: level, 1: level}) is None
    assert _undecided(0, pads, {0: scores(np.ones((1, 60))), 1: level}) is None
    ends = scores(np.repeat([-0.1, 0.0, 0.1], 20)[None])
    assert _undecided(0, pads, {0: ends, 1: level}) is not None


def test_neighbours_in_ratio_that_rank_no_lower_are_looked_at_too(monkeypatch):
    ratios = np.array([13.0, 14.0, 15.0, 16.0])
    made = []
    evaluation = SimpleNamespace(feasible=np.array([True, True]))
    ranks = np.array([2, 1])
    monkeypatch.setattr(choice, "mixable", lambda shape, ratio, resin: ratio != 16.0)
    monkeypatch.setattr(choice, "make_curves", lambda *args: None)
    monkeypatch.setattr(choice, "make_slabs", lambda curves, slab, resin, ratio: made.append(ratio))
    monkeypatch.setattr(choice, "exact_candidates", lambda slabs, ratio, space: [
        DesignCandidate(10.0, one, at, evaluation, rank=int(ranks[at])) for at, one in enumerate(ratio.tolist())])
    space = SimpleNamespace(ratio=ratios, resin=None, targets=None, sampling=None, radius_mm=7.9)

    def near(ratio, rank=1):
        best = SimpleNamespace(ratio=ratio, thickness_mm=10.0, rank=rank)
        chosen = SimpleNamespace(result=SimpleNamespace(best=best), shape=None, cast=None)
        first, *others = _near(chosen, space)
        assert first is best
        return [one.ratio for one in others]

    assert near(14.02) == [13.0, 15.0] and near(13.0) == [14.0] and near(15.0) == [14.0]
    # below a best of rank 2 one that is borderline stays, one that is not representative does not
    assert near(14.0, 2) == [13.0, 15.0]
    ranks[1] = 0
    assert near(14.0, 2) == [13.0] and near(14.0, 0) == [13.0, 15.0]
    evaluation.feasible[0] = False
    assert near(14.0, 2) == []


def shares(fraction, count=1000):
    """Classes of castings, so many of them usable with a correction; the rest reads low."""
    return np.where(np.arange(count) < round(fraction * count), 1, 2)


@pytest.fixture
def measured(monkeypatch):
    """What ``measure_first`` says of shares usable now and once a group is known."""
    def first(now, groups=None, both=None, over=None, strict=False, green=0.0, people=3):
        known = {MODULUS: now, RELAXATION: now, MAKING: now, FORCE_LAW: now, **(groups or {})}
        kinds = {group: shares(share) for group, share in known.items()}
        pressed = SimpleNamespace(
            space=SimpleNamespace(targets=SimpleNamespace(tissue=SimpleNamespace(subjects=range(people))),
                                  resin=SimpleNamespace(name="polyurethane-nagoya"), ratio=np.array([15.0])),
            pressed=lambda groups: "both" if groups == RESIN else groups[0], every="now",
            candidate=SimpleNamespace(ratio=15.0, thickness_mm=10.0))  # fmt: skip
        rows = {**kinds, "now": shares(now), "both": shares(max(known.values()) if both is None else both)}
        if green:
            first = np.arange(1000) < round(green * 1000)
            rows = {name: np.where(first, 0, values) for name, values in rows.items()}
        monkeypatch.setattr(choice, "classes_of", lambda key, targets: rows[key])
        monkeypatch.setattr(choice, "ranges_of", lambda targets: SimpleNamespace(strict=strict))
        monkeypatch.setattr(choice, "_two_ratios", lambda cast, worst: (None, None, None))
        usable = np.zeros((2, 100), bool) if over is None else np.tile(np.arange(100) < round(100 * over), (2, 1))
        monkeypatch.setattr(choice, "castings_for_tissues", lambda cast, share, worst: SimpleNamespace(
            usable=usable, tissue_drawn=over is not None))  # fmt: skip
        return measure_first(pressed)

    return first


def test_the_group_that_gains_most_castings_is_measured_first_from_three_hundredths_on(measured):
    assert measured(0.5, {MODULUS: 0.6, MAKING: 0.7}).group == MAKING
    assert measured(0.5, {MODULUS: 0.53}).group == MODULUS and measured(0.5, {MODULUS: 0.529}).group is None
    found = measured(0.5, {MODULUS: 0.6, RELAXATION: 0.55}, both=0.65)
    assert found.acceptable_now == 0.5 and found.acceptable_means == "usable"
    assert found.acceptable_if_known == {
        MODULUS: 0.6, RELAXATION: 0.55, MAKING: 0.5, FORCE_LAW: 0.5, "modulus+relaxation": 0.65, TISSUE: 0.5,
    }  # fmt: skip
    assert "then 60 % of castings are usable (now 50 %)" in found.text
    assert "puck" in found.protocol and "--ratio 15 " in found.command
    assert measured(0.5, {MAKING: 0.7}).command.startswith("dummydesign suggest")
    assert measured(0.5, {FORCE_LAW: 0.7}).command == "dummydesign loop CAMPAIGN_DIR"


def test_both_parts_of_the_resin_are_measured_where_only_both_together_help(measured):
    found = measured(0.5, {MODULUS: 0.51, RELAXATION: 0.52}, both=0.6)
    assert found.group == RELAXATION and "then 60 %" in found.text
    assert measured(0.5, {MODULUS: 0.51, RELAXATION: 0.52}, both=0.529).group is None
    # one that helps alone is taken for what it gains alone
    assert "then 54 %" in measured(0.5, {MODULUS: 0.54}, both=0.9).text


def test_people_are_measured_where_their_doubt_costs_three_hundredths(measured):
    found = measured(0.5, over=0.46)
    # of the first hundred castings all are usable as stated, 46 for other tissues
    assert found.acceptable_over_tissues == pytest.approx(max(0.5 - (1.0 - 0.46), 0.0), abs=1e-9)
    assert found.group == TISSUE and "dummydesign tissues add" in found.command
    assert measured(1.0, over=0.96).acceptable_over_tissues == pytest.approx(0.96)
    assert measured(1.0, over=0.96).group == TISSUE and measured(1.0, over=0.98).group is None
    assert measured(1.0, over=0.5, people=1).group is None
    assert measured(1.0).acceptable_over_tissues is None


def test_green_is_asked_for_where_the_measured_resin_would_be_green(measured):
    assert measured(0.9, green=0.51).acceptable_means == "stands_for"
    assert measured(0.9, green=0.49).acceptable_means == "usable"
    assert measured(0.9, green=0.51).acceptable_now == pytest.approx(0.51)
    assert measured(0.9, strict=True).acceptable_means == "stands_for"


def test_two_ratios_are_those_of_which_at_least_one_is_usable_most_often(monkeypatch):
    """Castings are deviates in 0 to 1; a ratio is usable for a window of them."""
    deviates = np.linspace(0.0, 1.0, 1200)
    low = {13.0: 0.0, 14.0: 0.1, 15.0: 0.2, 16.0: 0.55, 17.0: 0.6}

    def usable(cast, pours, worst):
        rows = []
        for one in pours:
            begin = low[one.ratio]
            rows.append((deviates[: one.count] >= begin) & (deviates[: one.count] < begin + 0.3))
        return np.array(rows)

    class Some(SimpleNamespace):
        def first(self, count):
            return Some(ratio=self.ratio, count=1200)

    monkeypatch.setattr(choice, "_usable", usable)
    space = SimpleNamespace(ratio=np.array(sorted(low)))
    cast = SimpleNamespace(space=space, candidate=SimpleNamespace(ratio=15.0),
                           pours=lambda ratio: Some(ratio=ratio, count=1200))  # fmt: skip
    pair, each, either = _two_ratios(cast, 1)
    assert pair == (13.0, 16.0)
    assert each == pytest.approx((0.3, 0.3), abs=2e-3) and either == pytest.approx(0.6, abs=2e-3)
    one = SimpleNamespace(**{**vars(cast), "space": SimpleNamespace(ratio=np.array([15.0]))})
    assert _two_ratios(one, 1) == (None, None, None)
    for count in (11, 13):
        # below a hundredth of the castings none is proposed
        few = np.arange(1200)[None] < count
        monkeypatch.setattr(choice, "_usable", lambda cast, pours, worst, few=few: np.repeat(few, len(pours), axis=0))
        assert _two_ratios(cast, 1)[2] == (pytest.approx(13.0 / 1200.0) if count == 13 else None)


def test_enough_castings_stand_for_the_subjects_also_within_the_tie(monkeypatch):
    limits = verdict_limits()
    asked = []
    count = round(limits.share * 1000)

    def kinds(differences, near):
        asked.append(near)
        return np.where(np.arange(1000) < state["green"], 0, 1)

    monkeypatch.setattr(choice, "classes", kinds)
    monkeypatch.setattr(choice, "deviations_of", lambda *args: None)
    space = SimpleNamespace(targets=SimpleNamespace(limits=limits))
    pad = choice._Contender(None, None, SimpleNamespace(space=space, every=None))
    for green, enough in ((count, True), (count - 1, False)):
        state = {"green": green}
        assert pad.green is enough
    assert asked[0].stands_shortfall == pytest.approx(limits.stands_shortfall * (1.0 + limits.tie))
    assert asked[0].stands_over == pytest.approx(limits.stands_over * (1.0 + limits.tie))


def test_what_is_expected_of_a_pad_is_over_its_castings(monkeypatch):
    merit = np.linspace(0.0, 1.0, 101)[None]
    monkeypatch.setattr(choice, "usable", lambda evaluation, targets: np.arange(10) < 7)
    candidate = SimpleNamespace(thickness_mm=10.0, ratio=15.0, merit=lambda share: 0.3 + share)
    cast = SimpleNamespace(every=None, space=SimpleNamespace(targets=None))
    pad = choice._Contender(SimpleNamespace(shape=SimpleNamespace(name="boned")), candidate, cast)
    found = pad.expected(scores(merit), 0.2)
    assert (found.worth, found.expected_worth, found.low_worth) == pytest.approx((0.5, 0.5, 0.05))
    assert found.acceptable_fraction == 0.7 and found.words == "the boned pad of 10 mm, ratio 15"
