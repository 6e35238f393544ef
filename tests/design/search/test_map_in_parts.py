"""The map of a search on a few made designs: who is unbeaten, who lies apart, what castings make of a ratio."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.search import slabs as search_module
from dummydesign.design.search.slabs import _far, alternatives_to, averaging, pareto, thickness_steps
from tests.support.refusal import raises_code


def test_pads_are_far_beyond_a_millimetre_or_three_tenths_of_a_part():
    for thickness, ratio, far in ((11.01, 15.0, True), (10.99, 15.0, False), (10.0, 15.31, True), (10.0, 15.29, False),
                                  (8.99, 15.0, True), (10.0, 14.69, True), (10.9, 15.2, False)):  # fmt: skip
        assert _far((thickness, ratio), [(10.0, 15.0)]) is far
    assert not _far((12.0, 15.0), [(10.0, 15.0), (12.2, 15.1)]) and _far((1.0, 1.0), [])


def scored(total, values, feasible=None):
    total = np.array(total)[:, None]
    named = dict(zip(search_module.OBJECTIVES, np.array(values, float).T[..., None]))
    return search_module.ScoreMap(
        np.arange(len(total)) * 2.0 + 4.0, np.array([15.0]), total, named["steady_state_range"],
        named["force_variation_range"], named["aim"], named["low_force_range"],
        np.ones_like(total, bool) if feasible is None else np.array(feasible)[:, None],
    )  # fmt: skip


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
    rows = [best, one(12.0, 0.6, (0.5, 0.9, 0.5, 0.5)), one(14.0, 0.7, (0.5, 0.5, 0.9, 0.5)),
            one(16.0, 0.8, (0.4, 0.4, 0.8, 0.5)), one(10.5, 0.85, (0.1, 0.1, 0.1, 0.99)),
            one(18.0, 0.2, (0.5, 0.9, 0.5, 0.5))]  # fmt: skip
    found = alternatives_to(rows, best)
    assert [one.thickness_mm for one in found] == [14.0, 12.0, 18.0]


def test_castings_of_a_ratio_have_the_moduli_of_its_neighbours():
    """The logarithm of the modulus falls by 0.1 a step, castings scatter evenly by 0.2 either way."""
    class Even:
        def young_MPa(self, ratio):
            return 0.05 * np.exp(-0.1 * (np.asarray(ratio) - 15.0))

        def draw(self, count):
            off = np.exp(np.linspace(-0.2, 0.2, count) + 0.05)
            return SimpleNamespace(young_MPa=lambda ratio: off * self.young_MPa(ratio))

    ratio = np.arange(11.0, 20.0)
    weights = averaging(Even(), ratio)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    # in the middle: even over two steps either way about the ratio itself, the draws' own bias left out
    np.testing.assert_allclose(weights[4] @ ratio, 15.0, atol=0.02)
    assert np.sqrt(weights[4] @ (ratio - 15.0) ** 2) == pytest.approx(2.0 / np.sqrt(3.0), rel=0.1)
    assert weights[4][[0, 1, 7, 8]].max() == 0.0
    assert weights[0][0] > 0.4 and weights[8][8] > 0.4
    np.testing.assert_array_equal(averaging(Even(), np.array([15.0])), [[1.0]])


def test_thicknesses_come_in_half_millimetres_with_both_ends():
    assert thickness_steps(4.0, 5.5).tolist() == [4.0, 4.5, 5.0, 5.5]
    assert thickness_steps(4.1, 5.4).tolist() == [4.5, 5.0] and thickness_steps(3.0, 3.0).tolist() == [3.0]
    for low, high in ((4.1, 4.4), (2.9, 5.0), (4.0, 30.1), (np.nan, 5.0)):
        with raises_code("out_of_range"):
            thickness_steps(low, high)
