"""The search: practical steps, the best of the map, aims, alternatives, what cannot be had."""

import dataclasses

import numpy as np
import pytest

from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search.slabs import search, thickness_steps
from dummydesign.resin import load_resin
from tests.support.cast_pads import space_with
from tests.support.refusal import raises_code
from tests.support.slab_by_formula import make_tissue


@pytest.fixture(scope="module")
def resin():
    return load_resin()


@pytest.fixture(scope="module")
def found(layer_law, resin, finger):
    targets = make_targets(finger, "average", Sampling())
    return search(layer_law, space_with(resin, targets, thickness_steps(3.0, 30.0), resin.ratios()))


def test_the_recommendation_is_in_practical_steps(found):
    assert found[0].thickness_mm / 0.5 == pytest.approx(round(found[0].thickness_mm / 0.5))
    assert found[0].ratio / 0.1 == pytest.approx(round(found[0].ratio / 0.1))


def test_the_recommendation_is_at_the_top_of_the_map(found, resin):
    total = found[2].total
    rows = np.argsort(-np.where(found[2].feasible, total, -1.0).ravel())[:24]
    places = [np.unravel_index(row, total.shape) for row in rows]
    assert (found[0].thickness_mm, found[0].ratio) in {(found[2].thickness_mm[t], found[2].ratio[r]) for t, r in places}


def test_no_design_nearby_scores_better_when_worked_out_exactly(found, layer_law, resin, finger):
    targets = make_targets(finger, "average", Sampling())
    near = thickness_steps(found[0].thickness_mm - 1.0, found[0].thickness_mm + 1.0)
    ratios = resin.ratios(found[0].ratio - 0.3, found[0].ratio + 0.3)
    again = search(layer_law, space_with(resin, targets, near, ratios))
    assert again[0].total <= found[0].total + 0.01


def test_the_recommendation_crosses_the_tissues_range_in_the_measured_part(found, finger):
    depth = found[0].evaluation.depth_mm[found[0].index, 1]
    low, high = finger.steady_depth_range(10.0)
    assert low <= depth <= high
    assert found[0].evaluation.steady_state_range[found[0].index] > 0.5


def test_no_condition_is_deeper_than_the_limit(found):
    for candidate in (found[0], *found[1]):
        depth = candidate.evaluation.depth_mm[candidate.index]
        assert np.nanmax(depth) <= 0.6 * candidate.thickness_mm + 1e-9


def test_alternatives_are_not_beaten_by_the_recommendation_and_differ_from_it(found):
    def parts(candidate):
        e, i = candidate.evaluation, candidate.index
        return np.array([e.steady_state_range[i], e.force_variation_range[i], e.aim[i], e.low_force_range[i]])

    assert found[1]
    for other in found[1]:
        assert np.any(parts(other) > parts(found[0]))
        assert abs(other.thickness_mm - found[0].thickness_mm) > 1.0 or abs(other.ratio - found[0].ratio) > 0.3


def depth_at_10_N(layer_law, resin, tissue, aim):
    targets = make_targets(tissue, aim, Sampling())
    best = search(layer_law, space_with(resin, targets, thickness_steps(3.0, 30.0), resin.ratios()))[0]
    return best.evaluation.depth_mm[best.index, 1]


@pytest.mark.slow
def test_each_aim_is_answered_by_its_own_pad(layer_law, resin):
    """people who differ tenfold: the safe side is stiffer than the average, the stiffest subject than the softest"""
    people = make_tissue((0.3, 1.0, 3.0))
    depth = {
        aim: depth_at_10_N(layer_law, resin, people, aim) for aim in ("average", "safe-side", "subject:a", "subject:c")
    }
    assert depth["safe-side"] < 0.9 * depth["average"]
    assert depth["subject:c"] < 0.8 * depth["subject:a"]


def test_limits_are_kept(layer_law, resin, finger):
    targets = make_targets(finger, "average", Sampling())
    found = search(layer_law, space_with(resin, targets, thickness_steps(8.0, 12.0), resin.ratios(16.0, 16.5)))
    assert 8.0 <= found[0].thickness_mm <= 12.0 and 16.0 <= found[0].ratio <= 16.5


def test_when_nothing_reaches_10_N_it_says_so(layer_law, resin, finger):
    soft = dataclasses.replace(resin, numbers={**resin.numbers})
    targets = make_targets(finger, "average", Sampling())
    with raises_code("no_feasible_design", "pad") as problem:
        search(layer_law, space_with(soft, targets, thickness_steps(25.0, 30.0), resin.ratios(14.0, 14.1)))
    assert problem.value.code == "no_feasible_design"


def test_thicknesses_include_both_ends_and_refuse_what_cannot_be_cast():
    np.testing.assert_array_equal(thickness_steps(3.0, 4.0), [3.0, 3.5, 4.0])
    np.testing.assert_array_equal(thickness_steps(3.2, 4.2), [3.5, 4.0])
    with raises_code("out_of_range", "thickness_mm"):
        thickness_steps(2.0, 10.0)
    with raises_code("out_of_range", "thickness_range_mm"):
        thickness_steps(3.1, 3.4)
