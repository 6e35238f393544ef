"""Among pads that the search does not tell apart the one with the better expected worth is taken, and it is said."""

import dataclasses

import numpy as np
import pytest

from dummydesign.design.assessment.castings import PadCastings, Tolerances, verdict_of_design
from dummydesign.design.assessment.choice import (
    POURS,
    TissueScores,
    _best_of,
    by_expectation,
    castings_for_tissues,
    tissue_share,
    usable,
)
from dummydesign.design.pad_evaluator import one_pad
from dummydesign.design.request import Request
from dummydesign.design.scoring.score import evaluate, scored_for
from dummydesign.design.search.best_of_kinds import best_of_kinds, choose, close_to
from dummydesign.design.suggest import design, resolve
from tests.support.cast_pads import SHARP, known, with_tissues


@pytest.fixture(scope="module")
def crowned():
    inputs = resolve(Request("forefinger", shape="crowned", verify=False))
    found = best_of_kinds("crowned", inputs.slab_law, inputs.space)
    return inputs, found, choose(found, inputs.space)


def exact(inputs):
    """Castings of the resin as if it were known."""
    return dataclasses.replace(inputs.castings, resin=known(inputs.castings.resin))


@pytest.mark.slow
def test_a_resin_and_a_tissue_that_are_known_and_poured_exactly_give_the_choice_by_the_middle(crowned):
    inputs, _, chosen = crowned
    space = with_tissues(inputs.space, ())
    taken, told = by_expectation((chosen,), space, exact(inputs), SHARP, space.targets.weights.low_aim)
    assert taken is chosen and not told.differs and told.taken == told.middle
    assert told.taken.expected_worth == pytest.approx(told.taken.worth, abs=0.03)
    assert told.taken.acceptable_fraction == 1.0 and told.taken.tissue_share is None and told.undecided is None


def test_the_doubt_is_all_the_tissues_where_the_pad_is_known_and_none_of_it_where_the_tissue_is(crowned):
    inputs, _, chosen = crowned
    share = inputs.space.targets.weights.low_aim

    def cast(castings, tolerances, space=inputs.space):
        return PadCastings(castings, chosen.cast, chosen.result.best, space, tolerances)

    shares = []
    sure = cast(exact(inputs), SHARP)
    sure.__dict__["error"] = 0.0
    for one in (sure, cast(inputs.castings, Tolerances(110.0)), cast(inputs.castings, Tolerances(1.0, 0.02))):
        found = castings_for_tissues(one, share)
        assert found.total.shape == (len(inputs.space.targets.drawn), POURS)
        shares.append(tissue_share(found.merit))
    assert shares[0] > 0.99 > shares[1] > shares[2] > 0.0
    alone = castings_for_tissues(cast(inputs.castings, Tolerances(110.0), with_tissues(inputs.space, ())), share)
    assert alone.total.shape == (1, POURS) and tissue_share(alone.merit) is None and not alone.tissue_drawn


def test_presses_scored_for_another_tissue_are_what_pressing_anew_for_it_gives(crowned):
    inputs, _, chosen = crowned
    other, coarse = inputs.space.targets.drawn[5], inputs.space.sampling.coarse
    slabs = chosen.result.best.evaluation.slabs
    anew = evaluate(slabs, other, coarse)
    again = scored_for(evaluate(slabs, inputs.space.targets, coarse), other)
    for name in ("aim", "low_aim", "steady_state_range", "force_variation_range", "inside", "depth_mm"):
        np.testing.assert_array_equal(getattr(again, name), getattr(anew, name))


def test_a_pad_at_the_end_of_a_range_gives_way_to_its_neighbour_one_step_of_the_ratio_away(crowned):
    """the pad one step softer than the best over castings is offered first"""
    inputs, _, chosen = crowned
    space = with_tissues(inputs.space, ())
    step = float(np.diff(space.ratio).min())
    edge = one_pad(chosen.cast, space, chosen.result.best.thickness_mm, chosen.result.best.ratio - 3 * step).candidate
    assert edge.evaluation.feasible[edge.index]
    offered = dataclasses.replace(chosen, result=dataclasses.replace(chosen.result, best=edge))
    low_share = space.targets.weights.low_aim
    taken, told = by_expectation((offered,), space, inputs.castings, Tolerances(110.0), low_share)
    best = taken.result.best
    assert told.differs and told.taken.expected_worth > told.middle.expected_worth
    assert told.taken.acceptable_fraction >= told.middle.acceptable_fraction and best.rank >= edge.rank
    assert best.ratio - edge.ratio == pytest.approx(step) and best.thickness_mm == edge.thickness_mm
    # the row beside the other kinds is the pad that is recommended, with the tissue's law fitted to it
    row = next(item for item in taken.comparisons if item.kind == "crowned")
    assert row.candidate is best and best.parameters is not None
    assert f"ratio {best.ratio:g}" in told.text and f"ratio {edge.ratio:g}" in told.text


def test_the_usable_share_of_an_expectation_is_that_of_the_verdict(crowned):
    inputs, _, chosen = crowned
    space, tolerances = with_tissues(inputs.space, ()), Tolerances(110.0)
    taken, told = by_expectation((chosen,), space, inputs.castings, tolerances, space.targets.weights.low_aim)
    cast = PadCastings(inputs.castings, taken.cast, taken.result.best, space, tolerances)
    found = verdict_of_design(cast)
    assert found.usable_share == pytest.approx(told.taken.acceptable_fraction, abs=1e-12)
    assert told.taken.acceptable_fraction == usable(cast.every, space.targets).mean()


def castings(merit, as_known):
    merit, as_known = np.asarray(merit, float), np.asarray(as_known, float)
    return TissueScores(merit, merit, merit > 0.5, as_known)


def test_the_tissue_as_it_is_known_decides_where_its_doubt_hides_the_difference_and_only_there():
    rng = np.random.default_rng(5)
    first = rng.uniform(0.3, 0.4, (6, 50))
    hidden = first + np.array([0.4, -0.3, 0.2, -0.3, 0.3, -0.2])[:, None]
    better = castings(hidden, first[0] + 0.1)
    assert _best_of([castings(first, first[0]), better]) == (1, True)
    surely = castings(first + 0.05, first[0] - 0.1)
    assert _best_of([castings(first, first[0]), better, surely]) == (2, False)
    worse = castings(hidden - 0.1, first[0] + 0.1)
    assert _best_of([castings(first, first[0]), worse]) == (0, False)
    assert _best_of([castings(first, first[0]), castings(first, first[0])]) == (0, False)


@pytest.mark.slow
def test_of_kinds_whose_worth_is_alike_all_are_compared_and_no_other(crowned):
    inputs, _, _ = crowned
    space = inputs.space
    found = best_of_kinds("auto", inputs.slab_law, space)
    chosen = choose(found, space)
    assert [one.shape for one in close_to(chosen, found, space)] == [chosen.shape]
    wide = dataclasses.replace(space.targets)
    numbers = wide.weights.numbers
    numbers = numbers | {"resolution": dataclasses.replace(numbers["resolution"], value=1.0)}
    wide.__dict__["weights"] = dataclasses.replace(wide.weights, numbers=numbers)
    every = close_to(chosen, found, dataclasses.replace(space, targets=wide))
    assert {one.shape.name for one in every} == {item.kind for item in chosen.comparisons if item.candidate is not None}


@pytest.mark.slow
def test_the_answer_says_where_the_choice_by_expectation_differs_and_by_which_weights():
    answer = design(resolve(Request("forefinger", shape="crowned", verify=False))).to_dict()["choice"]
    told = answer["expectation"]
    assert told["differs"] == (told["taken"] != told["middle"])
    assert answer["weights"]["set"] == "curves" and answer["weights"]["aim"] == 0.6
