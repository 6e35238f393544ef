"""Pours: exact without errors, worse with larger ones, and weighing acts as its closed form says."""

import numpy as np
import pytest

from dummydesign.design.assessment.pad_castings import PadCastings, pour_yield
from dummydesign.design.pad_evaluator import one_pad
from dummydesign.design.scoring.castings import Castings, Tolerances
from dummydesign.design.scoring.crowns import EXACT
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search.slabs import SearchSpace
from dummydesign.resin import load_resin
from tests.support.cast_pads import known, outlook_at

RADIUS = 14.0 / np.sqrt(np.pi)


@pytest.fixture(scope="module")
def resin():
    return load_resin()


@pytest.fixture(scope="module")
def exact_resin(resin):
    """The same resin as if all its numbers were known."""
    return known(resin)


@pytest.fixture(scope="module")
def targets(finger):
    return make_targets(finger, "average", Sampling())


def study(layer_law, resin, targets, tolerances, **drawn):
    castings = Castings(resin, **drawn)
    space = SearchSpace(
        resin, targets, np.array([5.5]), np.array([15.3]), RADIUS, castings, lambda *_: tolerances, 0.03
    )
    candidate = one_pad(layer_law, space, 5.5, 15.3).candidate
    outlook = outlook_at(15.3, castings.n)
    return pour_yield(PadCastings(castings, layer_law, candidate, space, tolerances, outlook, EXACT))


def test_without_any_error_all_pours_are_the_nominal_one(layer_law, exact_resin, targets):
    found = study(layer_law, exact_resin, targets, Tolerances(100.0, 0.0, 0.0))
    assert found.young_spread_percent == pytest.approx(0.0, abs=1e-9)
    assert set(found.by_force.values()) <= {0.0, 1.0}
    assert found.yield_fraction == 1.0
    assert found.judged_at_N == tuple(float(force) for force, share in found.by_force.items() if share == 1.0)


def test_weighing_spreads_the_modulus_by_its_slope(layer_law, exact_resin, targets):
    """even errors of 0.1 g have a deviation of 0.1 / sqrt 3; the isocyanate's share dominates"""
    total = 120.0
    found = study(layer_law, exact_resin, targets, Tolerances(total, 0.1, 0.0))
    isocyanate, polyol = total * 15.3 / 115.3, total * 100.0 / 115.3
    relative = 0.1 / np.sqrt(3.0) * np.hypot(1 / isocyanate, 1 / polyol)
    closed = 100.0 * exact_resin.log_slope(15.3) * relative
    assert found.young_spread_percent == pytest.approx(closed, rel=0.05)


def test_more_error_never_helps_a_design_that_is_inside(layer_law, exact_resin, targets):
    yields = []
    for scale in (0.0, 1.0, 4.0, 10.0):
        found = study(layer_law, exact_resin, targets, Tolerances(100.0, 0.1 * scale, 0.2 * scale / 4))
        yields.append(found.by_force["10"])
    assert yields[0] == 1.0 and np.all(np.diff(yields) <= 0.0) and yields[-1] < 0.9


def test_what_is_not_known_of_the_resin_lowers_the_share(layer_law, resin, targets):
    found = study(layer_law, resin, targets, Tolerances(100.0))
    assert found.by_force["10"] < found.by_force_making_only["10"]
    assert found.yield_fraction <= min(found.by_force[f"{force:g}"] for force in found.judged_at_N)


def test_the_same_seed_gives_the_same_pours(layer_law, resin, targets):
    first, again, other = (
        study(layer_law, resin, targets, Tolerances(100.0), seed=seed).to_dict() for seed in (1, 1, 2)
    )
    assert first == again and first != other


@pytest.mark.slow
def test_the_share_settles_with_the_number_of_pours(layer_law, resin, targets):
    few, many = (study(layer_law, resin, targets, Tolerances(100.0), n=n) for n in (2000, 10000))
    spread = np.sqrt(0.25 / 2000)
    assert few.by_force["10"] == pytest.approx(many.by_force["10"], abs=4 * spread)
