"""The map of a search on a few made designs: who is unbeaten, who lies apart."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from dummydesign.design.search import slabs as search_module
from dummydesign.design.search.slabs import _far, alternatives_to, pareto, thickness_steps
from tests.support.refusal import raises_code


def test_pads_are_far_beyond_a_millimetre_or_three_tenths_of_a_part():
    for thickness, ratio, far in (
        (11.01, 15.0, True),
        (10.99, 15.0, False),
        (10.0, 15.31, True),
        (10.0, 15.29, False),
        (8.99, 15.0, True),
        (10.0, 14.69, True),
        (10.9, 15.2, False),
    ):
        assert _far((thickness, ratio), [(10.0, 15.0)]) is far
    assert not _far((12.0, 15.0), [(10.0, 15.0), (12.2, 15.1)]) and _far((1.0, 1.0), [])


def scored(total, values, feasible=None):
    total = np.array(total)[:, None]
    named = dict(zip(search_module.OBJECTIVES, np.array(values, float).T[..., None]))
    return search_module.ScoreMap(
        np.arange(len(total)) * 2.0 + 4.0,
        np.array([15.0]),
        total,
        named["steady_state_range"],
        named["force_variation_range"],
        named["aim"],
        named["low_force_range"],
        np.ones_like(total, bool) if feasible is None else np.array(feasible)[:, None],
    )


def test_unbeaten_designs_of_the_map_have_half_of_the_best_total_and_lie_apart():
    values = [(0.9, 0.9, 0.9, 0.1), (0.1, 0.1, 0.1, 0.9), (0.8, 0.8, 0.8, 0.1), (0.95, 0.1, 0.1, 0.1),
              (0.2, 0.1, 0.97, 0.1)]  # fmt: skip
    found = pareto(scored([0.8, 0.5, 0.7, 0.39, 0.41], values), 0)
    # the third is beaten by the first, the fourth has less than half of its total
    assert found.tolist() == [1, 4]
    assert pareto(scored([0.8, 0.5, 0.7, 0.41, 0.42], values), 0).tolist() == [1, 4, 3]
    assert pareto(scored([0.8, 0.5, 0.7, 0.41, 0.42], values, [1, 0, 1, 1, 1]), 0).tolist() == [4, 3]
    same = [(0.5, 0.5, 0.5, 0.5)] * 5
    assert len(pareto(scored([0.8, 0.8, 0.8, 0.8, 0.8], same), 0)) == 0


def test_alternatives_are_those_that_no_other_beats_by_falling_total():
    def one(thickness, total, values):
        scores = {name: np.array([value]) for name, value in zip(search_module.OBJECTIVES, values)}
        evaluation = SimpleNamespace(**scores)
        return SimpleNamespace(thickness_mm=thickness, ratio=15.0, total=total, index=0, evaluation=evaluation)

    best = one(10.0, 0.9, (0.9, 0.5, 0.5, 0.5))
    rows = [
        best,
        one(12.0, 0.6, (0.5, 0.9, 0.5, 0.5)),
        one(14.0, 0.7, (0.5, 0.5, 0.9, 0.5)),
        one(16.0, 0.8, (0.4, 0.4, 0.8, 0.5)),
        one(10.5, 0.85, (0.1, 0.1, 0.1, 0.99)),
        one(18.0, 0.2, (0.5, 0.9, 0.5, 0.5)),
    ]
    found = alternatives_to(rows, best)
    assert [one.thickness_mm for one in found] == [14.0, 12.0, 18.0]


def test_thicknesses_come_in_half_millimetres_with_both_ends():
    assert thickness_steps(4.0, 5.5).tolist() == [4.0, 4.5, 5.0, 5.5]
    assert thickness_steps(4.1, 5.4).tolist() == [4.5, 5.0] and thickness_steps(3.0, 3.0).tolist() == [3.0]
    for low, high in ((4.1, 4.4), (2.9, 5.0), (4.0, 30.1), (np.nan, 5.0)):
        with raises_code("out_of_range"):
            thickness_steps(low, high)
