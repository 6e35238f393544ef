"""Pours: exact without errors, worse with larger ones, and weighing acts as its closed form says."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core.quantity import Quantity
from dummydesign.design.assessment.pour_yield import Tolerances, pour_yield
from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.resin import load_resin

RADIUS = 14.0 / np.sqrt(np.pi)


@pytest.fixture(scope="module")
def resin():
    return load_resin()


@pytest.fixture(scope="module")
def exact_resin(resin):
    """The same resin as if all its numbers were known."""

    def fixed(q):
        return Quantity(q.value, q.value, q.value, "measured", "test")

    return dataclasses.replace(
        resin,
        numbers={name: fixed(q) for name, q in resin.numbers.items()},
        arms=tuple(dataclasses.replace(arm, beta=fixed(arm.beta)) for arm in resin.arms),
        softness_exponent=fixed(resin.softness_exponent),
    )


@pytest.fixture(scope="module")
def targets(finger):
    return make_targets(finger, "average", Sampling())


def study(layer_law, resin, targets, tolerances, **more):
    return pour_yield(layer_law, resin, targets, 5.5, 15.3, RADIUS, tolerances, **more)


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


def test_the_share_settles_with_the_number_of_pours(layer_law, resin, targets):
    few, many = (study(layer_law, resin, targets, Tolerances(100.0), pours=n) for n in (2000, 20000))
    spread = np.sqrt(0.25 / 2000)
    assert few.by_force["10"] == pytest.approx(many.by_force["10"], abs=4 * spread)


def test_the_band_of_castings_holds_95_percent_of_castings_that_it_was_not_drawn_from():
    from dummydesign.design.assessment.pour_yield import Tolerances, _depth_mm, depth_band_mm, draw_pours
    from dummydesign.design.inputs import resolve
    from dummydesign.design.request import Request

    inputs = resolve(Request("palm", shape="slab", verify=False))
    space, limits, force = inputs.space, Tolerances(100.0), np.array([2.0, 5.0, 10.0])
    pad = (20.0, 15.0, space.radius_mm)
    stiff, soft = depth_band_mm(inputs.slab_law, space.resin, space.targets, *pad, limits, force, pours=1500)
    other, _ = draw_pours(space.resin, 20.0, 15.0, limits, 3000, seed=5)
    depth = _depth_mm(inputs.slab_law, space.resin, space.targets, other, space.radius_mm, force)
    inside = np.nan_to_num((depth >= stiff) & (depth <= soft)).mean(axis=0)
    assert np.isfinite(soft[:2]).all() and (np.abs(inside[:2] - 0.95) < 0.015).all(), inside
