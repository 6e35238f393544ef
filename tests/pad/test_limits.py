"""Numbers that solves allow: the ends of a range belong to it, and just beyond them it says so."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS, MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.pad.axisymmetric.case import Case, held_on, lattice_depths, padded, relative_depths
from dummydesign.pad.axisymmetric.filleted import check_fillet
from dummydesign.pad.axisymmetric.puck import UnitPuck
from dummydesign.pad.fem.mixed_solid import INCOMPRESSIBLE_LAME_RATIO, lame_ratio
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.solve.continuation import ForcePath
from dummydesign.pad.spatial.shaped_pad import Load
from dummydesign.pad.spatial.square_punch import SquareProblem
from tests.support.refusal import raises_code

RANGES = {
    "slab": (lambda one: Case(one, 99.0).check(), 0.05, 20.0),
    "extent": (lambda one: Case(1.0, one).check(), 1.5, None),
    "block": (lambda one: SquareProblem((1.0, one), (99.0, 99.0)), 0.05, 20.0),
    "slab over block": (lambda one: SquareProblem((1.0, 1.0), (9.0, one)), 1.5, None),
    "puck": (lambda one: UnitPuck(one), 0.1, 10.0),
    "fillet": (lambda one: check_fillet(one, 2.0), None, LARGEST_EDGE_RADIUS * 2.0),
    "edge": (lambda one: Pad(10.0, 0.03, 8.0, edge_radius_mm=one), 0.0, LARGEST_EDGE_RADIUS * 8.0),
    "edge of an oblong": (
        lambda one: Pad(10.0, 0.03, 8.0, sides_mm=(20.0, 10.0), edge_radius_mm=one),
        0.0,
        LARGEST_EDGE_RADIUS * 5.0,
    ),
    "offset": (lambda one: Load((1.0, 1.0), (3.0, 3.0), thickness_mm=9.0, offset=(0.0, one)).check(), -1.7, 1.7),
    "depth": (lambda one: relative_depths([1.0, one], 10.0), 0.0, MAX_DEPTH_OVER_THICKNESS * 10.0),
}


@pytest.mark.parametrize("name", RANGES)
def test_the_ends_of_a_range_belong_to_it_and_one_per_cent_beyond_is_refused(name):
    allow, low, high = RANGES[name]
    for end in (low, high):
        if end is not None:
            allow(end)
            beyond = end - 0.01 * max(abs(end), 0.5) if end == low else 1.01 * end
            with raises_code("out_of_range"):
                allow(beyond)


@pytest.mark.parametrize(
    ("shape", "thickness", "stays"),
    [
        (Boned(9.0, 7.5, 9.0), 10.0, True),
        (Layered(0.21, 2.0), 10.0, True),
        (Layered(0.19, 2.0), 10.0, False),
        (Layered(9.79, 2.0), 10.0, True),
        (Layered(9.81, 2.0), 10.0, False),
    ],
)
def test_a_fiftieth_of_a_pad_must_stay_at_its_thinnest(shape, thickness, stays):
    case = Case(0.8, 7.0, shape=shape, thickness_mm=thickness)
    if stays:
        case.check()
        return
    with raises_code("cannot_be_made", "shape"):
        case.check()


def test_a_shape_must_end_within_the_pad():
    shape = Crowned(20.0, 2.0, 9.0)
    Case(0.5, 0.91, shape=shape, thickness_mm=10.0 / 0.91 * 0.97).check()
    with raises_code("cannot_be_made", "shape"):
        Case(0.5, 0.93, shape=shape, thickness_mm=10.0).check()


def test_shapes_are_counted_in_thicknesses_and_a_slab_is_one_case_whatever_its_thickness():
    crown = Crowned(20.0, 2.0, 9.0)
    case, r = Case.of(Pad(8.0, 0.03, 7.9, geometry=crown)), np.array([0.0, 0.5, 1.0, 2.0])
    assert case.lines == pytest.approx(np.array(crown.lines_mm()) / 8.0) and case.radius == pytest.approx(7.9 / 8.0)
    assert case.drop(r) == pytest.approx(crown.drop_mm(8.0 * r, 0.0 * r) / 8.0) and not case.bone(r).any()
    bone = Boned(9.0, 2.0, 6.0)
    boned = Case.of(Pad(8.0, 0.03, 7.9, geometry=bone))
    assert boned.bone(r) == pytest.approx(bone.bone_mm(8.0 * r, 0.0 * r) / 8.0)
    one, other = (Case.of(Pad(h, 0.03, 0.79 * h, extent_mm=7.0 * h, edge_radius_mm=0.05 * h)) for h in (5.0, 10.0))
    assert one == other and (one.radius, one.extent, one.edge) == pytest.approx((0.79, 7.0, 0.05))
    assert (Case(0.4, 9.0).scale, Case(3.0, 9.0).scale) == (0.4, 1.0)


def test_a_resting_pad_weighs_its_height_over_its_shear_modulus():
    """rho g h over mu, 1030 kg/m3: of 10 mm and 10 kPa a hundredth."""
    light = Case.of(Pad(10.0, 0.03, 7.9, base="friction:0.3"))
    assert light.weight == pytest.approx(1030.0 * 9.81 * 0.010 / 1e4) and Case.of(Pad(10.0, 0.03, 7.9)).weight == 0.0
    stiff = Case.of(Pad(20.0, 0.06, 7.9, base="friction:0.3"))
    assert stiff.weight == pytest.approx(light.weight)


def test_relative_depths_are_sorted_once_each_and_above_zero():
    assert relative_depths([2.0, 0.0, 1.0, 2.0], 10.0) == pytest.approx([0.1, 0.2])
    for wrong in ([], [0.0], [np.nan], [-0.1, 1.0]):
        with raises_code("out_of_range", "depth_mm") as refused:
            relative_depths(wrong, 10.0)
        assert isinstance(refused.value.value, float)


@pytest.mark.parametrize("deepest", [0.013, 0.02, 0.041, 0.3, 9.0])
def test_depths_of_the_lattice_are_its_multiples_to_the_deepest_and_halves_of_the_first(deepest):
    nodes = lattice_depths(deepest)
    first = nodes[5]
    assert nodes[:6] == pytest.approx(first * 0.5 ** np.arange(5, -1, -1)) and nodes[5:] / first == pytest.approx(
        np.arange(1, len(nodes) - 4)
    )
    last = min(deepest, MAX_DEPTH_OVER_THICKNESS)
    assert last * (1.0 - 1e-9) <= nodes[-1] < last + first


def test_what_a_path_did_not_reach_is_not_known_and_a_difference_is_held_on():
    path = ForcePath(np.array([0.1]), np.array([2.0]), np.ones(1), 1, 1, 1, 0.0, "stop")
    assert np.array_equal(padded(path, 3), [2.0, np.nan, np.nan], equal_nan=True)
    assert held_on(np.array([0.1, 0.05, np.nan, 0.2, np.nan])) == pytest.approx([0.1, 0.1, 0.1, 0.2, 0.2])
    assert held_on(np.full(2, np.nan)) == pytest.approx([0.01, 0.01])


def test_the_lame_ratio_is_that_of_poisson_and_capped_where_nothing_gives_way():
    for poisson in (0.1, 0.3, 0.4999):
        assert lame_ratio(poisson) == pytest.approx(2.0 * poisson / (1.0 - 2.0 * poisson))
    assert lame_ratio(0.5) == INCOMPRESSIBLE_LAME_RATIO >= lame_ratio(0.499999)


def test_a_law_of_four_terms_or_of_a_negative_product_is_refused():
    assert Ogden([1.0, 2.0, -1.0], [2.0, 1.0, -2.0]).shear_MPa == pytest.approx(0.5 * (2.0 + 2.0 + 2.0))
    assert Ogden([1.0, -1.0], [2.0, -2.0]).reference_stress_MPa == 0.0
    for mu, alpha in (([1.0] * 4, [2.0] * 4), ([], []), ([1.0], [2.0, 3.0]), ([1.0], [-2.0]), ([0.0], [2.0])):
        with pytest.raises(InputError):
            Ogden(mu, alpha)


def test_the_shear_modulus_of_a_pad_and_of_a_puck_is_that_of_its_poisson_ratio():
    assert Pad(10.0, 0.03, 8.0, poisson=0.25).shear_MPa == pytest.approx(0.03 / 2.5)
    puck = Puck(10.0, 0.03, 50.0, law=Ogden([4.0], [3.0]))
    assert (puck.shear_MPa, puck.shape.shear_MPa) == pytest.approx((0.01, 1.0)) and puck.radius_mm == 25.0
