"""The limits that ``docs/data/loop-rules.csv`` states: each decision falls one way just below and the other just above.

Nothing is fitted: models are stand-ins with the numbers that the rule compares.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.progress import quiet
from dummydesign.loop import run
from dummydesign.loop.data.trials import SAME_DEPTH
from dummydesign.loop.effects.learned import SmoothChange
from dummydesign.loop.fitting.noise import NoiseSizes
from dummydesign.loop.model.campaign_law import SLAB_ERROR
from dummydesign.loop.next_measurement import SAME_SPEED
from dummydesign.loop.selection import nonparametric_effect, search, verdict
from dummydesign.loop.selection.holdout_test import LeftOut, deepest, fastest, predicts_worse
from dummydesign.loop.selection.residuals import Dependence, ResidualCheck, ResidualDiagnostics
from dummydesign.loop.selection.verdict import Needed
from tests.support.known_laws import puck_law, slab_law
from tests.support.named_effects import effect_named

RULES = Path(__file__).parents[3] / "docs" / "data" / "loop-rules.csv"
ROWS = list(csv.DictReader(RULES.read_text(encoding="utf-8").splitlines()))
BELOW, ABOVE = 0.98, 1.02
WORDS = {"six": 6, "sixth": 6, "ten": 10, "fourth": 4}


def written(step: str, around: str) -> float:
    """The number that the row of a step states where ``around`` has a #."""
    pattern = re.escape(around).replace(r"\#", r"([\d.]*\d|[a-z]+)")
    texts = [row["rule"] for row in ROWS if row["step"] == step]
    (found,) = [match for text in texts for match in re.findall(pattern, text)]
    return float(WORDS[found]) if found in WORDS else float(found)


def cases(limit: float):
    return [(BELOW * limit, False), (ABOVE * limit, True)]


def stage(over=1.0, ratio=None, p=None, score=0.0, floor=0.03):
    priors = SLAB_ERROR
    law = SimpleNamespace(error_priors=priors)
    sizes = SimpleNamespace(floor_N=floor, law=tuple(median for median, _ in priors))
    fit = SimpleNamespace(sizes=sizes, score=score, problem=SimpleNamespace(law=law))
    errors = SimpleNamespace(heldout_N=None if over is None else floor * over)
    return SimpleNamespace(fit=fit, lack=SimpleNamespace(ratio=ratio, p=p), errors=errors)


def test_the_error_of_the_force_law_starts_at_what_is_written():
    wanted = [
        0.01 * written("fit the base", text)
        for text in ("level # %", "slope # %", "curvature # % at", "waves over depth # %")
    ]
    presses = SimpleNamespace(presses=[SimpleNamespace(white_N=one) for one in (0.03, 0.04)])
    for law in (slab_law(7.9), puck_law(30.0)):
        sizes = NoiseSizes.first(presses, law.error_priors)
        assert sizes.law == pytest.approx(wanted)
        # a factor of two is the end of the 95 % interval of the logarithm: 1.2 to 2.5 to be called so
        *smooth, waves = (np.exp(1.96 * spread) for _, spread in law.error_priors)
        assert all(1.8 < factor < 2.3 for factor in smooth) and waves == pytest.approx(4.0, rel=0.05)
    assert sizes.noise.white_N == pytest.approx(np.sqrt(0.5 * (0.03**2 + 0.04**2)))


@pytest.fixture
def plain_noise(monkeypatch):
    monkeypatch.setattr(verdict, "expected_heldout_N", lambda fit: 1.2 * fit.sizes.floor_N)


def test_left_out_errors_and_lack_of_fit_beyond_the_limits_are_unexplained(plain_noise):
    nothing = ResidualDiagnostics([], [])
    for over, more in cases(1.2 * written("unexplained", "above # times its expected")):
        left = verdict.remainder(stage(), stage(over), nothing)
        assert bool(left.reasons) is more
        assert left.over_floor == pytest.approx(over) and left.expected == pytest.approx(1.2)
    limit, p = written("unexplained", "lack of fit above # "), written("unexplained", "(p < #)")
    for ratio, high in cases(limit):
        for chance, rare in ((BELOW * p, True), (ABOVE * p, False)):
            left = verdict.remainder(stage(), stage(1.0, ratio, chance), nothing)
            assert bool(left.reasons) is (high and rare)
    assert not verdict.remainder(stage(), stage(1.0, 9.0, None), nothing).reasons


def test_a_residual_that_follows_a_factor_is_unexplained_beyond_both_limits(plain_noise):
    least = written("unexplained", "chi-square above # ")
    share = 1.0 / written("unexplained", "and a # of the evidence")

    def reasons(excess, won=0.0, ratio=None, columns=7):
        seen = ResidualDiagnostics([Dependence("depth", excess + columns, columns, 0.5, "")], [])
        return verdict.remainder(stage(score=100.0 + won), stage(1.0, ratio, 1.0, 100.0), seen).reasons

    for excess, more in cases(least):
        assert bool(reasons(excess)) is more
        # a model that misfits by chance of its noise is allowed as much more
        assert bool(reasons(1.4 * excess, ratio=1.4)) is more
        assert bool(reasons(excess, ratio=0.5)) is more
    for excess, more in cases(share * 6000.0):
        assert bool(reasons(excess, won=6000.0)) is more
    several = ResidualDiagnostics([Dependence(name, 900.0, 2, 0.4, "") for name in ("depth", "speed")], [])
    assert len(verdict.remainder(stage(), stage(), several).reasons) == 1


def test_every_check_that_is_exceeded_is_a_reason(plain_noise):
    checks = [ResidualCheck("step in the hold", 9.0, 6.0, seen, "") for seen in (True, False, True)]
    assert len(verdict.remainder(stage(), stage(), ResidualDiagnostics([], checks)).reasons) == 2


def errors_of(*squares):
    return SimpleNamespace(heldout_by_trial_N=np.sqrt(np.array(squares)))


def test_much_better_is_a_squared_error_lower_by_what_is_written():
    step, text = "keep an effect beside others", "lowers the squared left-out error by #"
    drop = 0.01 * written(step, f"fourth and further one {text}")
    assert drop == 0.01 * written(step, f"or {text}")
    for change, much in cases(drop):
        # halves of it on each of two presses; what one model cannot predict counts in neither
        before, after = errors_of(1.0, 3.0, np.nan), errors_of(1.0 - 2.0 * change, 3.0 - 2.0 * change, 0.5)
        assert verdict.much_better(before, after) is much
    assert not verdict.much_better(errors_of(np.nan), errors_of(0.1))


def test_an_effect_in_doubt_needs_the_written_share_of_anothers_evidence(monkeypatch):
    share = 0.01 * written("keep an effect beside others", "evidence below # % of another's")
    first, beside = (
        written("keep an effect", "evidence above # and the"),
        written("keep an effect beside others", "evidence above # plus twice the logarithm"),
    )
    monkeypatch.setattr(verdict, "lack_of_fit", lambda fit: SimpleNamespace(ratio=None))
    own, others = np.array([0.25, 0.75, 0.0]), np.array([0.25, 0.25, 0.5])
    monkeypatch.setattr(
        verdict, "_where", lambda fit, names: {name: own if name == "ageing" else others for name in names}
    )
    alone = verdict.needed([], None, "ageing", {}, 50)
    assert alone == Needed(first, first, "ageing")
    found = verdict.needed([], None, "ageing", {"inertia": 1e5, "adhesion": 1e4}, 50)
    assert found.least == pytest.approx(beside + 2.0 * np.log(50.0))
    # they share a quarter and a quarter of their bins
    assert found.doubted == pytest.approx(share * 0.5 * 1e5)
    near = verdict.needed([], None, "ageing", {"inertia": 10.0}, 1)
    assert near.doubted == near.least == pytest.approx(beside)


def candidate(name, gain, score=0.0, bound=False):
    effect = effect_named(name)
    size = effect.parameters[0]
    values = {size.name: size.high if bound else 0.5 * (size.low + size.high)}
    fit = SimpleNamespace(
        problem=SimpleNamespace(effects=(effect,)), score=score, active=(SimpleNamespace(effect=effect, values=values),)
    )
    unlike = SimpleNamespace(signature=np.eye(2)[int(name == "ageing")])
    return SimpleNamespace(effect=effect, fit=fit, gain=gain, screened=unlike)


def test_rivals_are_within_the_written_evidence_of_an_effect_however_the_model_misfits():
    gap = written("rivals", "evidence within # in the same place")
    for ratio, scale in ((None, 1.0), (0.5, 1.0), (3.0, 3.0)):
        for distance, far in cases(gap * scale):
            options = [candidate("ageing", 500.0), candidate("temperature", 500.0 - distance)]
            assert bool(search._near(SimpleNamespace(options=options), ratio)) is not far


def test_a_single_effect_that_explains_more_by_what_is_written_is_named(monkeypatch):
    more = written("explains_more", "better than the result by # in evidence")
    monkeypatch.setattr(run, "needed", lambda *args: Needed(30.0, 30.0, "ageing"))
    after = SimpleNamespace(fit=SimpleNamespace(problem=SimpleNamespace(effects=()), score=1000.0))
    for gain, enough in ((29.9, False), (30.1, True)):
        for better, named in cases(more):
            ranking = [candidate("ageing", gain, 1000.0 - better)]
            found = [*run._better_alone(SimpleNamespace(ranking=ranking, screened=[]), after)]
            assert bool(found) is (enough and named)
    used = SimpleNamespace(fit=SimpleNamespace(problem=SimpleNamespace(effects=(effect_named("ageing"),)), score=1e3))
    assert not [*run._better_alone(SimpleNamespace(ranking=[candidate("ageing", 90.0)], screened=[]), used)]


def test_presses_left_out_are_beyond_the_written_shares():
    depth = written("keep the base (base_kept)", "beyond # of a pad's largest depth")
    speed = written("keep the base (base_kept)", "and beyond # of the largest speed")
    values = np.array([5.0, 6.0, BELOW * depth * 20.0, ABOVE * depth * 20.0, 20.0])

    def fit_of(**columns):
        return SimpleNamespace(problem=SimpleNamespace(presses=SimpleNamespace(pad=np.zeros(5, int), **columns)))

    assert deepest(fit_of(depth_mm=values)).tolist() == [False, False, False, True, True]
    values[2:4] *= speed / depth
    assert fastest(fit_of(velocity_mm_s=values)).tolist() == [False, False, False, True, True]


def test_the_base_is_kept_beyond_the_written_ratio_of_squares():
    limit = written("keep the base (base_kept)", "squared error on these is above # of the base's")
    for ratio, worse in ((0.995 * limit, False), (1.005 * limit, True)):
        rows = (LeftOut("other conditions", 3.0, 3.0 * np.sqrt(ratio)), LeftOut("deeper presses", 1.0, np.sqrt(ratio)))
        assert predicts_worse(rows) is worse


@pytest.fixture
def tried(monkeypatch):
    """What is learned further, with the evidence of each quantity and pair given."""
    made, known = [], {}
    names = "depth_mm", "temperature_C", "age_days", "thickness_mm", "since_stop_s"
    quantities = dict.fromkeys(names, np.arange(3.0))

    def first(fit, quantities, *names):
        return SmoothChange(names, ((0.0, 1.0),) * len(names), ()), SimpleNamespace(evidence=known.get(names, -5.0))

    monkeypatch.setattr(nonparametric_effect, "modest", lambda fit: fit)
    monkeypatch.setattr(nonparametric_effect, "followed", lambda presses, forces: quantities)
    monkeypatch.setattr(nonparametric_effect, "_first", first)
    monkeypatch.setattr(nonparametric_effect, "_learnt", lambda fit, usual, shape, step: made.append(shape.follows))
    fit = SimpleNamespace(problem=SimpleNamespace(presses=None), forces=None)

    def run_it(evidence, among=tuple(quantities)):
        made.clear()
        known.clear()
        known.update(evidence)
        assert nonparametric_effect.learn(fit, among) is None
        return list(made)

    return run_it


def test_a_curve_needs_the_written_evidence_and_a_pair_so_much_more_than_the_best_curve(tried):
    least = written("learn a curve", "gains # in evidence")
    for evidence, enough in cases(least):
        assert tried({("age_days",): evidence}) == ([("age_days",)] if enough else [])
    for more, enough in cases(least):
        found = tried({("age_days",): 200.0, ("temperature_C",): 90.0, ("age_days", "temperature_C"): 200.0 + more})
        # a pair is tried first, the best curve alone after it
        assert found == [("age_days", "temperature_C"), ("age_days",)][not enough :]
    # where no curve gains anything a pair needs as much as a curve
    for evidence, enough in cases(least):
        found = tried({("age_days",): -1.0, ("age_days", "temperature_C"): evidence, ("temperature_C",): -2.0})
        assert found == ([("age_days", "temperature_C")] if enough else [])


def test_pairs_are_made_of_the_most_promising_and_thickness_only_with_the_time_since_the_stop(tried):
    """Third and fourth of four do not pair; thickness is followed neither alone nor with another."""
    alone = {("depth_mm",): 40.0, ("temperature_C",): 30.0, ("age_days",): 20.0, ("since_stop_s",): 10.0}
    assert tried({**alone, ("age_days", "since_stop_s"): 1e4}) == []
    assert tried({**alone, ("depth_mm", "age_days"): 1e4}) == [("depth_mm", "age_days")]
    assert tried({**alone, ("temperature_C", "since_stop_s"): 1e4}) == [("temperature_C", "since_stop_s")]
    assert tried({**alone, ("thickness_mm",): 1e4}) == []
    assert tried({**alone, ("thickness_mm", "since_stop_s"): 1e4}) == [("thickness_mm", "since_stop_s")]
    assert tried({("depth_mm",): 1e4}, ("depth_mm", "temperature_C")) == [("depth_mm",)]
    assert tried({("depth_mm",): 1e4}, ("thickness_mm",)) == []


def test_a_curve_must_lower_the_squared_left_out_error_to_what_is_written(monkeypatch):
    limit = written("learn a curve", "squared left-out error to #")
    shape = SmoothChange(("depth_mm",), ((0.0, 1.0, 2.0),), (0.0, 0.0, 0.0))
    noise = SimpleNamespace(noise=None)
    before = SimpleNamespace(score=1000.0, sizes=noise, squares=2.0)
    step = nonparametric_effect._Step(
        np.array([0.0, 0.1, 0.2]), 500.0, np.diag([1.0, 2.0, 1.0]), np.diag([4.0, 2.0, 8.0])
    )
    monkeypatch.setattr(nonparametric_effect, "replace", lambda one, **more: one)
    monkeypatch.setattr(nonparametric_effect, "_with", lambda fit, shape: (shape, None))
    monkeypatch.setattr(nonparametric_effect, "_step", lambda fit, shape: step)
    monkeypatch.setattr(nonparametric_effect, "refitted_squares", lambda fit: fit.squares)
    for ratio, enough in ((BELOW * limit, True), (ABOVE * limit, False)):
        after = SimpleNamespace(score=700.0, sizes=noise, squares=2.0 * ratio)
        monkeypatch.setattr(nonparametric_effect, "fit_with_noise", lambda *args, after=after: after)
        found = nonparametric_effect._learnt(before, before, shape, step)
        assert (found is not None) is enough
        if found is not None:
            assert found.left_out == pytest.approx(ratio) and found.fit is after
            assert found.evidence == pytest.approx(before.score - after.score - found.cost)
            values = found.effect.shape.flat
            assert values == pytest.approx([-0.1, 0.0, 0.1])
            # the prior's cost and the volume that the data leave
            prior = values @ step.precision @ values
            volume = np.sum(np.log1p(np.diag(step.information) / np.diag(step.precision)))
            assert found.cost == pytest.approx(prior + volume)
            assert found.to_dict()["heldout_rmse_over_without"] == pytest.approx(np.sqrt(ratio))


def test_at_most_the_written_number_of_effects_and_from_the_fourth_on_only_what_predicts_much_better(monkeypatch):
    """Every effect has evidence; the left-out error falls by half or stays."""
    most = int(written("keep an effect beside others", "at most # effects"))
    usual = int(written("keep an effect beside others", "a # and further one")) - 1

    def model(count):
        effects = tuple(SimpleNamespace(name=f"e{n}") for n in range(count))
        return SimpleNamespace(problem=SimpleNamespace(effects=effects), score=-1000.0 * count)

    def child(count):
        return [SimpleNamespace(fit=model(count), gain=1000.0)]

    monkeypatch.setattr(search, "at_bound", lambda fit: False)
    monkeypatch.setattr(search, "same_noise", lambda fit: fit)
    monkeypatch.setattr(search, "needed", lambda *args: Needed(50.0, 50.0, ""))
    monkeypatch.setattr(search, "gain_floor", lambda fit: 30.0)
    monkeypatch.setattr(search, "worth", lambda *args: True)
    monkeypatch.setattr(search, "remainder", lambda *args: SimpleNamespace(reasons=("more",)))
    monkeypatch.setattr(search, "assess", lambda fit: SimpleNamespace(fit=fit))
    monkeypatch.setattr(search, "diagnose", lambda fit: None)
    monkeypatch.setattr(search, "errors", lambda fit: None)
    monkeypatch.setattr(search, "_children", lambda parents, *_: child(len(parents[0].problem.effects) + 1))
    chosen = []
    monkeypatch.setattr(search, "prune_effects", lambda current, *_: chosen.append(current.fit) or (current, []))
    base = SimpleNamespace(fit=model(0))
    for much, count in ((True, most), (False, usual)):
        monkeypatch.setattr(search, "much_better", lambda before, after, much=much: much)
        search.search(base, (), quiet, ([], child(1)))
        assert len(chosen[-1].problem.effects) == count
    search.search(base, (), quiet, ([], child(1)), most=2)
    assert len(chosen[-1].problem.effects) == 2


def test_the_search_and_repeated_presses_end_where_it_is_written():
    assert run.SEARCH_ITERATIONS == written("stop the search (search_stopped)", "after # iterations")
    assert 100.0 * SAME_DEPTH == written("next measurement", "within # % of the depth")
    assert 100.0 * SAME_SPEED == written("next measurement", "within # % of the speed")


def test_an_effect_whose_interval_holds_zero_needs_the_written_multiple(monkeypatch):
    times = written("keep an effect", "# times that if its interval contains zero")
    monkeypatch.setattr(search, "needed", lambda *args: Needed(30.0, 30.0, "ageing"))
    monkeypatch.setattr(search, "gain_floor", lambda fit: 30.0)
    monkeypatch.setattr(search, "worth", lambda *args: True)
    monkeypatch.setattr(search, "_negligible", lambda fit, effect: False)
    monkeypatch.setattr(search, "assess", lambda fit: fit)
    monkeypatch.setattr(search, "predicts_better", lambda before, after: True)
    current = SimpleNamespace(fit=SimpleNamespace(score=0.0), lack=SimpleNamespace(ratio=None))
    for holds in (True, False):
        monkeypatch.setattr(search, "holds_null", lambda model, effect, holds=holds: holds)
        for gain, certain in cases(30.0 * times):
            one = candidate("ageing", gain)
            check = search.EffectCheck(one.effect, "reduced", [], [one])
            assert (search._change(current, [check], 3) == "reduced") is (holds and not certain)


def test_a_curve_that_gains_less_than_it_costs_and_is_written_is_not_learned(monkeypatch):
    limit = written("learn a curve", "# beyond its cost")
    shape = SmoothChange(("depth_mm",), ((0.0, 1.0, 2.0),), (0.0, 0.0, 0.0))
    step = nonparametric_effect._Step(np.array([0.0, 0.1, 0.2]), 500.0, np.diag([1.0, 2.0, 1.0]), np.eye(3))
    noise = SimpleNamespace(noise=None)
    monkeypatch.setattr(nonparametric_effect, "replace", lambda one, **more: one)
    monkeypatch.setattr(nonparametric_effect, "_with", lambda fit, shape: (shape, None))
    monkeypatch.setattr(nonparametric_effect, "_step", lambda fit, shape: step)
    monkeypatch.setattr(nonparametric_effect, "refitted_squares", lambda fit: fit.squares)
    cost = 0.02 + np.log(2.0 * 3.0 * 2.0)
    for gain, enough in cases(limit):
        before = SimpleNamespace(score=0.0, sizes=noise, squares=2.0)
        after = SimpleNamespace(score=-gain - cost, sizes=noise, squares=0.2)
        monkeypatch.setattr(nonparametric_effect, "fit_with_noise", lambda *args, after=after: after)
        assert (nonparametric_effect._learnt(before, before, shape, step) is not None) is enough


def test_a_first_effect_needs_less_where_the_law_is_off_by_more_than_is_stated(plain_noise):
    usual, less = (written("keep an effect", around) for around in ("evidence above # and the", "(# in place of 30"))
    fit = stage().fit
    assert verdict.gain_floor(fit) == usual
    median, spread = SLAB_ERROR[1]
    fit.sizes.law = (*fit.sizes.law[:2], median * np.exp(1.1 * verdict.STATED * spread), *fit.sizes.law[3:])
    assert verdict.gain_floor(fit) == less


def test_a_law_that_would_have_to_be_far_worse_than_stated_explains_nothing(plain_noise):
    times = written("unexplained", "force law # standard deviations above")
    nothing = ResidualDiagnostics([], [])
    for term, (median, spread) in enumerate(SLAB_ERROR):
        for share, far in cases(times):
            base, after = stage(), stage()
            sizes = list(after.fit.sizes.law)
            sizes[term] = median * np.exp(share * spread)
            after.fit.sizes.law = tuple(sizes)
            # a level is the pad's own as well
            assert bool(verdict.remainder(base, after, nothing).reasons) is (far and term > 0)
