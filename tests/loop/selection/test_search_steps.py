"""Steps of the search on stand-ins: the beam, places of effects, what is dropped or exchanged, and rival models."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.progress import quiet
from dummydesign.loop.effects.learned import Learned, SmoothChange
from dummydesign.loop.fitting.candidates import EffectCandidate, Screened
from dummydesign.loop.selection import search
from dummydesign.loop.selection.verdict import EACH_PARAMETER, Needed
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit


def fit_of(*names, score=0.0, bound=False, value=None):
    effects = tuple(effect_named(name) for name in names)
    active = []
    for effect in effects:
        size = effect.parameters[0]
        middle = 0.4 * size.low + 0.6 * size.high if value is None else value
        active.append(SimpleNamespace(effect=effect, values={size.name: size.high if bound else middle}))
    return SimpleNamespace(problem=SimpleNamespace(effects=effects), active=tuple(active), score=score)


def child(gain, *names, bound=False):
    name = names[-1]
    unlike = screened(name, 9.0, (1.0, 0.0) if name == "ageing" else (0.0, 1.0))
    return EffectCandidate(effect_named(name), fit_of(*names, score=-gain, bound=bound), gain, unlike)


def kept(candidates, won, size):
    return [[effect.name for effect in one.fit.problem.effects] for one in search._beam(candidates, won, size)]


@pytest.mark.parametrize(("size", "share"), [(1, 0.5), (2, 0.8), (3, 0.9), (5, 0.9)])
def test_a_rival_is_kept_with_the_share_of_the_evidence_that_is_stated_for_its_size(size, share):
    assert search._share(size) == share
    for won in (0.0, 400.0):
        # with what their parent has won: 1000
        first = child(1000.0 - won, "ageing")
        for evidence, near in ((1000.0 * share + 1.0, True), (1000.0 * share - 1.0, False)):
            found = kept([first, child(evidence - won, "temperature")], won, size)
            assert found == [["ageing"], ["temperature"]][: 1 + near]


def test_models_of_the_same_effects_count_once_and_three_are_kept():
    rows = [
        child(100.0, "ageing", "inertia"),
        child(99.0, "inertia", "ageing"),
        child(98.0, "ageing"),
        child(97.0, "inertia"),
        child(96.0, "temperature"),
    ]
    assert kept(rows, 0.0, 2) == [["ageing", "inertia"], ["ageing"], ["inertia"]]


def test_a_model_at_its_bound_is_kept_where_no_other_has_half_of_its_evidence():
    for other, passed in ((490.0, False), (510.0, True)):
        rows = [child(1000.0, "ageing", bound=True), child(other, "temperature")]
        assert kept(rows, 0.0, 1) == ([["temperature"]] if passed else [["ageing"]])
    # with what was won: 400 + 100 of 400 + 600
    rows = [child(600.0, "ageing", bound=True), child(101.0, "temperature")]
    assert kept(rows, 400.0, 1) == [["temperature"]]
    assert kept([child(600.0, "ageing", bound=True), child(99.0, "temperature")], 400.0, 1) == [["ageing"]]
    # behind one that is kept it is passed over
    assert kept([child(600.0, "temperature"), child(590.0, "ageing", bound=True)], 0.0, 1) == [["temperature"]]


def screened(name, z, signature=(1.0, 0.0)):
    return Screened(effect_named(name), z, 0.1, np.array(signature), np.zeros(1))


@pytest.fixture
def refitted(monkeypatch):
    """Refits give what ``scores`` say; what was fitted to the end is noted."""
    state = SimpleNamespace(screened=[], scores={}, ended=[])
    reduced = fit_of("temperature", score=500.0)

    def first(usual, one):
        return fit_of("temperature", one.effect.name, score=state.scores[one.effect.name])

    def ended(fit, one):
        state.ended.append(one.effect.name)
        return one

    monkeypatch.setattr(search, "without", lambda full, effect: reduced)
    monkeypatch.setattr(search, "modest", lambda fit: fit)
    monkeypatch.setattr(search, "screen", lambda usual, effects: state.screened)
    monkeypatch.setattr(search, "first_fit", first)
    monkeypatch.setattr(search, "finished", ended)
    return state


def test_an_effect_is_compared_with_those_that_score_as_high_in_its_place(refitted):
    """From a score of four on, and from three tenths of its own squared score; three of them at most."""
    full = fit_of("temperature", "ageing", score=200.0)
    names = "inertia", "adhesion", "force_bias", "force_drift", "time_skew"
    refitted.scores = dict(zip(names, (210.0, 235.0, 245.0, 300.0, 300.0)))
    scores = zip(names, (9.0, -6.0, 5.5, 5.48, 5.4))
    refitted.screened = [screened("ageing", 10.0), *(screened(name, z) for name, z in scores)]
    check = search.refit_without(full, effect_named("ageing"), ())
    assert [one.effect.name for one in check.options] == ["ageing", "inertia", "adhesion", "force_bias"]
    assert [one.gain for one in check.options] == [300.0, 290.0, 265.0, 255.0]
    # within 40 of the evidence of the effect: 260
    assert refitted.ended == ["inertia", "adhesion"]
    assert check.options[0].fit is full and check.options[0].screened.z == 10.0
    refitted.screened = [screened("ageing", 10.0), screened("inertia", 5.47)]
    assert len(search.refit_without(full, effect_named("ageing"), ()).options) == 1
    refitted.screened = [screened("ageing", 2.0), screened("inertia", 4.1), screened("adhesion", 3.9)]
    options = search.refit_without(full, effect_named("ageing"), ()).options
    assert [one.effect.name for one in options] == ["ageing", "inertia"]
    refitted.screened = [screened("inertia", 4.1)]
    assert search.refit_without(full, effect_named("ageing"), ()).options[0].screened.z == 0.0


def test_effects_of_the_model_are_not_tried_in_the_place_of_another(refitted, monkeypatch):
    asked = []
    monkeypatch.setattr(search, "screen", lambda usual, effects: asked.extend(effects) or [screened("ageing", 9.0)])
    available = tuple(effect_named(name) for name in ("temperature", "ageing", "inertia"))
    search.refit_without(fit_of("temperature", "ageing", score=0.0), effect_named("ageing"), available)
    assert [effect.name for effect in asked] == ["ageing", "inertia"]


def check_of(name, gain, *others):
    """One effect of a model, with what explains as much in its place."""
    options = [child(gain, name), *others]
    return search.EffectCheck(effect_named(name), f"without {name}", [screened(name, 9.0)], options)


@pytest.fixture
def judged(monkeypatch):
    """Models with what is needed 50, and verdicts that tests set."""
    state = SimpleNamespace(worth=True, better=lambda fit: True, null=False)
    monkeypatch.setattr(search, "gain_floor", lambda fit: 30.0)
    monkeypatch.setattr(search, "needed", lambda screened, fit, name, others, tried, first: Needed(50.0, 50.0, name))
    monkeypatch.setattr(search, "worth", lambda gain, limit, before, after: gain >= limit.least)
    monkeypatch.setattr(search, "holds_null", lambda model, effect: state.null)
    monkeypatch.setattr(search, "assess", lambda fit: fit)
    monkeypatch.setattr(search, "predicts_better", lambda before, fit: state.better(fit))
    return state


def model(*names, score=0.0, ratio=None, value=None):
    return SimpleNamespace(
        fit=fit_of(*names, score=score, value=value),
        lack=SimpleNamespace(ratio=ratio),
        errors=SimpleNamespace(heldout_N=0.04),
    )


def test_the_weakest_effect_is_dropped_first_and_nothing_of_a_model_that_stands(judged):
    current = model("ageing", "temperature")
    checks = [check_of("ageing", 700.0), check_of("temperature", 600.0)]
    assert search._change(current, checks, 9) is None
    weak = [check_of("ageing", 45.0), check_of("temperature", 40.0)]
    assert search._change(current, weak, 9) == "without temperature"
    assert search._change(current, [weak[0], checks[1]], 9) == "without ageing"


def test_a_size_below_what_instruments_tell_is_dropped(judged):
    effect = effect_named("sensor_curve")
    size = effect.parameters[0]
    assert effect.negligible > 0.0
    for times, dropped in ((0.98, True), (1.02, False)):
        for sign in (-1.0, 1.0):
            current = model("sensor_curve", value=size.null + sign * times * effect.negligible)
            assert (search._change(current, [check_of("sensor_curve", 900.0)], 3) is not None) is dropped


def test_a_rival_takes_a_place_with_ten_more_in_evidence_if_it_predicts_better(judged):
    current = model("ageing", score=-700.0)
    for gain, swapped in ((709.0, False), (711.0, True)):
        rival = child(gain, "temperature")
        found = search._change(current, [check_of("ageing", 700.0, rival)], 3)
        assert (found is rival.fit) is swapped
        at_its_end = child(gain, "temperature", bound=True)
        assert search._change(current, [check_of("ageing", 700.0, at_its_end)], 3) is None
    judged.better = lambda fit: fit is current.fit or "ageing" in [one.name for one in fit.problem.effects]
    assert search._change(current, [check_of("ageing", 700.0, child(711.0, "temperature"))], 3) is None
    two = [child(711.0, "temperature"), child(730.0, "inertia")]
    judged.better = lambda fit: True
    assert search._change(current, [check_of("ageing", 700.0, *two)], 3) is two[1].fit


def test_an_effect_stays_where_a_rival_that_looks_the_same_predicts_better(judged):
    current = model("ageing", score=-700.0)
    judged.better = lambda fit: "temperature" in [one.name for one in fit.problem.effects]
    for gain, stays in ((695.0, True), (689.0, False), (700.0, True), (705.0, False)):
        found = search._change(current, [check_of("ageing", 700.0, child(gain, "temperature"))], 3)
        assert (found is None) is stays
    judged.better = lambda fit: False
    assert search._change(current, [check_of("ageing", 700.0)], 3) == "without ageing"


def test_what_was_accepted_names_its_rivals_and_what_looks_alike(judged, monkeypatch):
    current = model("ageing", "inertia", ratio=2.0)
    rivals = [child(gain, name) for gain, name in ((695.0, "temperature"), (685.0, "adhesion"), (681.0, "time_skew"))]
    first = search.EffectCheck(
        effect_named("ageing"),
        None,
        [
            screened("ageing", 9.0),
            screened("temperature", 8.0, (0.95, 0.1)),
            screened("adhesion", 7.0, (-0.95, 0.0)),
            screened("force_bias", 6.0, (0.85, 0.5)),
        ],
        [child(700.0, "ageing"), *rivals],
    )
    first.options[0] = SimpleNamespace(**{**vars(first.options[0]), "screened": screened("ageing", 9.0)})
    other = search.EffectCheck(effect_named("inertia"), None, [screened("inertia", 9.0)], [child(900.0, "inertia")])
    other.options[0] = SimpleNamespace(**{**vars(other.options[0]), "screened": screened("inertia", 9.0)})
    monkeypatch.setattr(search, "replace", lambda one, **more: SimpleNamespace(**{**vars(one), **more}))
    found = search._accepted(current, [first, other], 5)
    assert [one.candidate.gain for one in found] == [900.0, 700.0]
    assert all(one.candidate.fit is current.fit and one.threshold == 50.0 and one.heldout_N == 0.04 for one in found)
    # twice the gap where the model misfits twice; two at most
    assert found[1].confounded_with == ("temperature", "adhesion") and found[0].confounded_with == ()
    assert found[1].family == ("temperature", "adhesion")
    assert found[1].ranking == tuple(first.options)


def test_children_count_from_the_first_parent_and_those_that_cannot_come_near_are_not_fitted(monkeypatch):
    parents = [fit_of("ageing", score=-1000.0), fit_of("temperature", score=-900.0)]
    available = tuple(effect_named(name) for name in ("ageing", "temperature", "inertia", "adhesion"))
    gains = {("ageing", "inertia"): 300.0, ("ageing", "temperature"): 200.0, ("temperature", "inertia"): 350.0}
    asked = []

    def fits(parent, rest, count, least_z, progress, least):
        asked.append((parent, [effect.name for effect in rest], count, least_z, least))
        (own,) = (effect.name for effect in parent.problem.effects)
        made = []
        for effect in rest:
            gain = gains.get((own, effect.name))
            if gain is not None:
                made.append(EffectCandidate(effect, fit_of(own, effect.name, score=parent.score - gain), gain, None))
        return [], made

    monkeypatch.setattr(search, "first_fits", fits)
    monkeypatch.setattr(search, "to_the_end", lambda fit, rows: rows)
    found = search._children(parents, available, 1000.0)
    named = {tuple(effect.name for effect in one.fit.problem.effects): one.gain for one in found}
    assert named == {("ageing", "inertia"): 300.0, ("ageing", "temperature"): 200.0, ("temperature", "inertia"): 250.0}
    assert asked[0][1] == ["temperature", "inertia", "adhesion"] and asked[0][4] == 0.0
    # the pair is known; two effects need eight tenths of 1300, from a parent that is 100 behind
    assert asked[1][1] == ["inertia", "adhesion"] and asked[1][4] == pytest.approx(0.8 * 1300.0 - 1000.0 + 100.0)


def rival(gain, shift, extra=(), scale=1.0, bound=False):
    found = clean_fit()
    vector = found.vector.copy()
    vector[:5] += shift
    made = fit_of(*extra, bound=bound)
    return gain, SimpleNamespace(
        vector=vector, covariance=scale * found.covariance, problem=made.problem, active=made.active
    )


def test_doubt_is_the_spread_of_rivals_weighed_by_their_evidence():
    found = clean_fit()
    law = np.zeros((5, 5))
    law[0, 0] = 0.004**2
    np.testing.assert_allclose(search.doubt_of(found, ()), law)
    shift = np.array([0.1, -0.2, 0.0, 0.05, 0.0])
    own = found.covariance[:5, :5]
    equal = search.doubt_of(found, [rival(0.0, shift)])
    np.testing.assert_allclose(equal, 0.5 * (np.outer(shift, shift) + own) + law, rtol=1e-9)
    # four in evidence are e squared in weight
    behind = search.doubt_of(found, [rival(-4.0, shift, scale=3.0)])
    weight = np.exp(-2.0) / (1.0 + np.exp(-2.0))
    np.testing.assert_allclose(behind, weight * (np.outer(shift, shift) + 3.0 * own) + law, rtol=1e-9)
    two = search.doubt_of(found, [rival(0.0, shift), rival(0.0, -2.0 * shift)])
    np.testing.assert_allclose(two, (5.0 * np.outer(shift, shift) + 2.0 * own) / 3.0 + law, rtol=1e-9)
    # each named parameter costs its evidence; one at its bound counts for nothing
    named = search.doubt_of(found, [rival(EACH_PARAMETER, shift, ("contact_offset",))])
    np.testing.assert_allclose(named, equal, rtol=1e-9)
    np.testing.assert_allclose(search.doubt_of(found, [rival(99.0, shift, ("contact_offset",), bound=True)]), law)
    far = search.doubt_of(found, [rival(1e5, shift)])
    np.testing.assert_allclose(far, np.outer(shift, shift) + own + law, rtol=1e-9)


def test_beside_a_curve_the_modulus_is_as_doubtful_as_the_curve_is_large():
    doubt = search.doubt_of(clean_fit(), (), curve=np.array([0.03, -0.05, 0.01]))
    assert doubt[0, 0] == pytest.approx(0.004**2 + 0.05**2) and np.count_nonzero(doubt) == 1


def test_named_parameters_are_counted_without_forms_and_curves():
    curve = Learned(SmoothChange(("depth_mm",), ((0.0, 1.0),), (0.1, 0.0)))
    for name in ("contact_offset", "machine_compliance", "sensor_lag"):
        effect = effect_named(name)
        made = SimpleNamespace(problem=SimpleNamespace(effects=(effect, curve)))
        assert search.named_parameters(made) == sum(not p.of_form for p in effect.parameters) >= 1


@pytest.fixture
def searched(monkeypatch):
    """A search whose models gain what ``gains`` say by their number of effects; ``worth`` are the sizes that stand."""
    state = SimpleNamespace(gains=[0.0, 500.0, 300.0, 200.0], worth={1, 2, 3}, noise=9, asked=[], grown=0)

    def model_of(count):
        effects = tuple(SimpleNamespace(name=f"e{n}", parameters=()) for n in range(count))
        problem = SimpleNamespace(effects=effects)
        return SimpleNamespace(problem=problem, score=-sum(state.gains[: count + 1]), active=())

    def child_of(count):
        if count >= len(state.gains):
            return []
        return [SimpleNamespace(fit=model_of(count), gain=state.gains[count])]

    def children(parents, available, won):
        state.grown += 1
        state.asked.append(won)
        return child_of(len(parents[0].problem.effects) + 1)

    monkeypatch.setattr(search, "same_noise", lambda fit: fit)
    monkeypatch.setattr(search, "gain_floor", lambda fit: 30.0)
    monkeypatch.setattr(search, "needed", lambda screened, fit, last, others, tried, _: (last, dict(others), tried))
    monkeypatch.setattr(search, "worth", lambda gain, limit, before, after: len(after.problem.effects) in state.worth)
    monkeypatch.setattr(search, "much_better", lambda before, after: False)
    monkeypatch.setattr(search, "errors", lambda fit: None)
    monkeypatch.setattr(search, "diagnose", lambda fit: None)
    monkeypatch.setattr(search, "assess", lambda fit: SimpleNamespace(fit=fit))
    monkeypatch.setattr(
        search,
        "remainder",
        lambda base, after, seen: SimpleNamespace(
            reasons=() if len(after.fit.problem.effects) >= state.noise else ("more",)
        ),
    )
    monkeypatch.setattr(search, "_children", children)
    monkeypatch.setattr(
        search, "prune_effects", lambda current, *_: (current, [SimpleNamespace(ranking=[SimpleNamespace(gain=1.0)])])
    )

    def run():
        state.grown, state.asked = 0, []
        found = search.search(SimpleNamespace(fit=model_of(0)), (), quiet, ([], child_of(1)))
        return len(found.after.fit.problem.effects)

    state.run = run
    return state


def test_models_grow_while_they_are_worth_it_and_one_size_beyond(searched):
    assert searched.run() == 3 and searched.asked[:2] == [500.0, 800.0]
    searched.worth = {1}
    assert searched.run() == 1 and searched.grown == 2
    # two that are only worth it together
    searched.worth = {2, 3}
    assert searched.run() == 3
    searched.worth = {3}
    assert searched.run() == 0
    searched.worth = set()
    assert searched.run() == 0


def test_a_model_that_leaves_noise_is_not_grown_beyond_the_next(searched):
    searched.noise, searched.worth = 1, {1}
    assert searched.run() == 1 and searched.grown == 1
    searched.worth = {1, 2, 3}
    assert searched.run() == 3


def test_too_little_evidence_ends_the_search_at_twelve_alone_and_at_twenty_five_beside_others(searched):
    searched.worth = {2}
    for first, found in ((11.5, 0), (12.5, 2)):
        searched.gains = [0.0, first, 300.0]
        assert searched.run() == found
    searched.worth = {1, 2}
    for second, found in ((24.5, 1), (25.5, 2)):
        searched.gains = [0.0, 500.0, second]
        assert searched.run() == found
