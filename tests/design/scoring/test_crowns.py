"""Crowns as they are made: without errors nothing changes, with errors each pad has the force of its own crown."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.quantity import Quantity
from dummydesign.design.pad_evaluator import law_of_shape
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.castings import MAKING, Castings, Tolerances
from dummydesign.design.scoring.crowns import Crowns, crown_scatter, crowned_curves
from dummydesign.design.scoring.press_simulation import make_curves
from dummydesign.design.scoring.settings import STEPS, CrownMaking, crown_making
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.tables.shape import TabulatedShapeLaw, load_shape_table
from dummydesign.resin import load_resin
from tests.support.cast_pads import poured_slabs, space_of

RADIUS = 14.0 / np.sqrt(np.pi)
PADS = [("crowned:2.4,3.5,7.8", 11.0), ("crowned:2,4.3,7.8", 13.5), ("crowned:21.2,2,9.4", 4.5), ("crowned:10,2", 5.0)]
GEL = 0.5


@pytest.fixture(scope="module")
def castings():
    return Castings(load_resin())


@pytest.fixture(scope="module")
def space():
    return space_of()


def law_of(space, shape, thickness):
    return law_of_shape(space[1], read_shape(shape), thickness)


def drawn(n=40, seed=5, height=0.1, radius=0.15):
    rng = np.random.default_rng(seed)
    return Crowns(rng.uniform(-height, height, n), 1.0 + rng.uniform(-radius, radius, n))


def with_crowns(law, crowns, designed, thickness):
    return crowned_curves(law, crowns, thickness, RADIUS, GEL)(crowns, designed)


def rows(law, thickness, n):
    return make_curves(law, [thickness], RADIUS, GEL).take(np.zeros(n, int))


def test_crowns_as_designed_leave_the_curves_as_they_are(space):
    for shape, thickness in PADS:
        law = law_of(space, shape, thickness)
        designed = rows(law, thickness, 3)
        made = with_crowns(law, Crowns(np.zeros(3), np.ones(3)), designed, thickness)
        for name, values in vars(designed).items():
            np.testing.assert_allclose(getattr(made, name), values, rtol=1e-12)


@pytest.mark.parametrize("shape, thickness", PADS)
def test_each_pad_has_the_force_of_its_own_crown(space, shape, thickness):
    """against the response table of each of the crowns, one by one"""
    law, crowns, one = law_of(space, shape, thickness), drawn(), read_shape(shape)
    made = with_crowns(law, crowns, rows(law, thickness, 40), thickness)
    for n, (higher, blunter) in enumerate(zip(crowns.higher_mm, crowns.blunter)):
        own = TabulatedShapeLaw(type(one)(one.radius_mm * blunter, one.height_mm + higher, one.foot_mm))
        h = np.array([thickness + higher])
        assert made.thickness_mm[n] == pytest.approx(h[0])
        depth = made.limit_mm[n] * np.array([0.1, 0.3, 0.6, 0.9])
        known = own.force(depth, h, 1.0, RADIUS)
        assert made.area_at(np.array([n]), depth[None])[0] == pytest.approx(known, rel=0.01)


def test_a_higher_crown_reaches_a_force_deeper_and_a_blunter_one_less_deep(space):
    law = law_of(space, *PADS[0])
    crowns = Crowns(np.array([0.0, 0.1, 0.0]), np.array([1.0, 1.0, 1.15]))
    made = with_crowns(law, crowns, rows(law, PADS[0][1], 3), PADS[0][1])
    designed, high, blunt = made.depth_at(np.arange(3), np.full(3, 100.0))
    assert blunt < designed < high


def test_errors_of_the_steps_add_up_within_what_the_file_states(castings):
    making = crown_making()
    crowns = castings.crowns(making)
    blunter = 100 * (crowns.blunter - 1)
    for values, stated in ((crowns.higher_mm, making.height_mm), (blunter, making.tip_radius_percent)):
        most = sum(one.high for one in stated.values())
        spread = np.sqrt(sum((one.high - one.low) ** 2 / 12 for one in stated.values()))
        assert np.abs(values).max() <= most + 1e-9 and values.std() == pytest.approx(spread, rel=0.06)
        assert abs(values.mean()) < 4 * spread / np.sqrt(castings.n)
    every = [*making.height_mm.values(), *making.tip_radius_percent.values()]
    assert all(one.source and one.low < one.value < one.high for one in every)
    assert abs(np.corrcoef(crowns.higher_mm, crowns.blunter)[0, 1]) < 4 / np.sqrt(castings.n)


def test_a_slab_draws_no_crown_and_what_it_draws_does_not_depend_on_one(castings):
    request = read_problem(Request("palm", shape="slab", verify=False))
    assert request.tolerances(Slab(), 10.0, 15.0).crown is None
    crown = read_shape("crowned:2.4,3.5,7.8")
    assert request.tolerances(crown, 11.0, 15.0).crown == crown_making()
    plain, crowned = (castings.pours(10.0, 15.3, Tolerances(60.0, crown=one)) for one in (None, crown_making()))
    for name in ("thickness_mm", "young_MPa", "beta"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(crowned, name))
    assert plain.crowns is None and len(crowned.crowns.higher_mm) == castings.n
    frozen = castings.pours(10.0, 15.3, Tolerances(60.0, crown=crown_making()), known=(MAKING,))
    assert frozen.crowns is None


def test_pours_of_a_crown_have_a_curve_each_and_without_errors_of_the_crown_that_of_their_thickness(space):
    law, exact = law_of(space[0:2], *PADS[0]), Quantity(0.0, 0.0, 0.0, "assumed", "none")
    none = CrownMaking(dict.fromkeys(STEPS, exact), dict.fromkeys(STEPS, exact))
    plain, crowned = (
        poured_slabs(law, space[2].pours(11.0, 15.4, Tolerances(60.0, crown=one)), space[0]) for one in (None, none)
    )
    np.testing.assert_allclose(crowned.curves.area_mm2, plain.curves.area_mm2[plain.slab], rtol=1e-12)
    np.testing.assert_array_equal(crowned.slab, np.arange(len(plain.slab)))
    made = poured_slabs(law, space[2].pours(11.0, 15.4, Tolerances(60.0, crown=crown_making())), space[0])
    assert np.std(made.curves.area_mm2[:, 240]) > np.std(crowned.curves.area_mm2[:, 240])


def test_scatter_of_small_errors_is_the_slope_times_their_deviation(space):
    shape, thickness = PADS[0]
    law, one, depth = law_of(space, shape, thickness), read_shape(shape), np.array([2.0])
    off = drawn(200, height=1e-3, radius=0.0).higher_mm
    found = crown_scatter(law, Crowns(off, np.ones(200)), thickness, depth, RADIUS)
    logs = [
        float(
            np.log(
                TabulatedShapeLaw(type(one)(one.radius_mm, one.height_mm + step, one.foot_mm)).force(
                    depth, np.array([thickness + step]), 1.0, RADIUS
                )[0]
            )
        )
        for step in (-1e-3, 1e-3)
    ]
    assert found == pytest.approx(abs(logs[1] - logs[0]) / 2e-3 * off.std(), rel=0.02)
    # equal rows of a product of matrices differ by the rounding of its sums, n u times the sum of the terms' sizes
    weights = load_shape_table("crowned").response.before.weights
    rounding = 0.5 * np.finfo(float).eps * weights.shape[1] * np.abs(weights).sum(axis=1).max()
    none = crown_scatter(law, Crowns(np.zeros(5), np.ones(5)), thickness, depth, RADIUS)
    assert none < rounding < 1e-3 * found


def test_depths_in_many_curves_at_once_are_those_in_each(space):
    shape, thickness = PADS[1]
    law, crowns = law_of(space, shape, thickness), drawn(700)
    made = with_crowns(law, crowns, rows(law, thickness, 700), thickness)
    slab, area = np.arange(700), np.geomspace(0.1, 1e4, 9) * np.ones((700, 1))
    found = made.depth_at(slab, area)
    for n in (0, 333, 699):
        alone = made.take(slab[n : n + 1]).depth_at(np.zeros(1, int), area[[n]])
        np.testing.assert_allclose(found[n], alone[0], rtol=1e-9)
    known = np.isfinite(found)
    assert known.any() and not known.all()
    np.testing.assert_allclose(made.area_at(slab, found)[known], area[known], rtol=1e-6)
    np.testing.assert_array_equal(made.depth_at(slab, area[:, 4]), found[:, 4])
