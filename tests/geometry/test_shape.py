"""Shapes of pads: profiles against closed forms, what is read and printed, and what cannot be cast."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.geometry.conic import Conic, sphere_foot_mm
from dummydesign.geometry.dimensions import RIM_FREE_MM
from dummydesign.geometry.shape_registry import make_shape, read_shape, shape_help, shape_kinds, shape_names
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.shapes.slab import Slab
from tests.support.refusal import raises_code

SHAPE_EXAMPLES = [
    Slab(),
    Crowned(10.0, 2.0),
    Crowned(10.0, 1.3),
    Crowned(3.0, 8.0, 9.0),
    Crowned(3.0, 8.0, 9.0, 1.0),
    Layered(8.0, 0.4),
    Layered(1 / 3 + 2, 1 / 7),
    Boned(20.0, 6.0),
    Boned(20.0, 6.0, 0.0, 1.0),
    Boned(8.0, 4.0, 14.1),
]
CONICS = [Conic(10.0, 2.0, 6.0), Conic(3.0, 8.0, 9.0), Conic(5.0, 3.0, math.sqrt(30.0)), Conic(4.0, 6.0, 5.0)]


def test_sphere_is_exact():
    cap = Conic(7.0, 2.5, sphere_foot_mm(7.0, 2.5))
    r = np.linspace(0.0, cap.foot_mm, 101)
    assert cap.factor == pytest.approx(1.0, abs=1e-14)
    assert cap.sag_mm(r) == pytest.approx(7.0 - np.sqrt(49.0 - r**2), abs=1e-14)


def test_paraboloid_and_limit_of_the_cone():
    paraboloid = Conic(5.0, 3.0, math.sqrt(30.0))
    r = np.linspace(0.0, paraboloid.foot_mm, 50)
    assert paraboloid.sag_mm(r) == pytest.approx(r**2 / 10.0, abs=1e-13)
    # A tip that vanishes leaves the straight flank of a cone.
    sharp = Conic(1e-9, 8.0, 9.0)
    assert sharp.sag_mm(np.array([3.0, 6.0])) == pytest.approx([8.0 / 3, 16.0 / 3], rel=1e-6)


@pytest.mark.parametrize("conic", CONICS)
def test_profile_is_the_conic_of_its_apex_radius(conic):
    r = np.linspace(0.0, conic.foot_mm, 64)
    z = conic.sag_mm(r)
    assert r**2 == pytest.approx(2 * conic.radius_mm * z - conic.factor * z**2, abs=1e-11)
    assert z[-1] == pytest.approx(conic.height_mm, rel=1e-13)
    step = 1e-3
    assert conic.sag_mm(step) * 2 / step**2 == pytest.approx(1 / conic.radius_mm, rel=1e-5)
    assert np.all(np.diff(z) > 0)


@pytest.mark.parametrize("conic", CONICS)
def test_height_is_continuous_at_the_foot_and_held_beyond_it(conic):
    near = conic.foot_mm * np.array([1 - 1e-9, 1.0, 1 + 1e-9, 2.0])
    assert conic.sag_mm(near) == pytest.approx(np.full(4, conic.height_mm), abs=1e-6)
    inside = conic.foot_mm * (1 - 1e-6)
    slope = (conic.height_mm - float(conic.sag_mm(inside))) / (conic.foot_mm - inside)
    assert math.degrees(math.atan(slope)) == pytest.approx(conic.foot_slope_deg, abs=1e-3)


def test_crown_is_round_and_ridge_runs_along_the_length():
    x, y = np.meshgrid(np.linspace(-20, 20, 9), np.linspace(-20, 20, 9))
    crown, ridge = Crowned(10.0, 2.0), Crowned(10.0, 2.0, 0.0, 1.0)
    assert crown.drop_mm(x, y) == pytest.approx(crown.sag_mm(np.hypot(x, y)))
    assert ridge.drop_mm(x, y) == pytest.approx(crown.sag_mm(y))
    assert np.ptp(ridge.drop_mm(x, y), axis=1) == pytest.approx(np.zeros(9), abs=1e-15)
    assert crown.axisymmetric and not ridge.axisymmetric and not crown.flat_top


def test_bone_and_crown_of_equal_numbers_are_complements():
    x, y = np.meshgrid(np.linspace(-20, 20, 9), np.linspace(-20, 20, 9))
    for last in (0.0, 1.0):
        crown, bone = Crowned(20.0, 6.0, 0.0, last), Boned(20.0, 6.0, 0.0, last)
        assert crown.drop_mm(x, y) + bone.bone_mm(x, y) == pytest.approx(np.full(x.shape, 6.0))
        assert np.all(bone.drop_mm(x, y) == 0) and np.all(crown.bone_mm(x, y) == 0) and bone.flat_top


def test_every_shape_has_its_full_thickness_over_the_origin():
    x, y = np.random.default_rng(2).uniform(-50, 50, (2, 300))
    for shape in SHAPE_EXAMPLES:
        assert float(shape.drop_mm(np.array(0.0), np.array(0.0))) == 0.0
        assert np.all(shape.drop_mm(x, y) >= 0) and np.all(shape.bone_mm(x, y) >= 0)


@pytest.mark.parametrize("shape", SHAPE_EXAMPLES, ids=str)
def test_printed_shape_is_read_back_as_the_same_shape(shape):
    assert read_shape(str(shape)) == shape
    assert make_shape(shape.name, shape.parameters) == shape


def test_names_places_and_case_make_one_shape():
    crown = read_shape("crowned:10,2")
    assert crown == read_shape("Crowned:height=2,radius=10") == read_shape("crowned:10,height_mm=2")
    assert crown.foot_mm == 6.0 and str(read_shape("crowned:10,2,6")) == "crowned:radius=10,height=2"
    assert read_shape("layered:8,0.4").layers() == (8.0, 0.4) and read_shape("slab") == Slab()
    assert list(shape_kinds())[:4] == ["slab", "crowned", "layered", "boned"]
    assert set(shape_names()) == set(shape_kinds()) and shape_help("slab").startswith("slab (default), boned, ")


UNREADABLE = [
    ("crown:10,2", "did you mean 'crowned'"),
    ("bumped:13,6,1.5", "it is gone, take a crown"),
    ("crowned:10", "needs height"),
    ("crowned:10,x", "'x' is not a number"),
    ("crowned:10,2,6,0,2,2,20,20,9", "at most 8"),
    ("crowned:10,2,radius=3", "twice"),
    ("slab:3", "takes no parameters"),
    ("crowned:10,nan", "finite"),
    ("boned:10,2,hight=3", "did you mean 'height'"),
    ("layered:8,inf", "finite"),
]


@pytest.mark.parametrize("text, named", UNREADABLE)
def test_what_cannot_be_read_is_named(text, named):
    with pytest.raises(InputError, match=named) as caught:
        read_shape(text)
    assert "\n" not in str(caught.value)


UNCASTABLE = [
    ("crowned:0.9,1,3", 10, "below 1 mm"),
    ("crowned:10,0.2", 10, "below 0.3"),
    ("crowned:10,9.5", 15, "70 deg"),
    ("crowned:5,5", 15, "no cap that widens"),
    ("crowned:5,6", 15, "no cap that widens"),
    ("crowned:10,4", 5.4, "at least 1.5 mm must stay"),
    ("crowned:200,1", 5, "allows 17 mm"),
    ("crowned:10,2,6,0.5", 10, "ridge = 0.5"),
    ("crowned:10,2,6,0,2,1,11", 10, "meet"),
    ("crowned:10,2,6,0,2,1,40", 10, "reaches 26 mm"),
    ("crowned:10,2,6,1,2,1,20", 10, "a ridge has one site"),
    ("crowned:10,2,6,0,1.5", 10, "whole number"),
    ("crowned:10,-2,6", 10, "height"),
    ("crowned:10,2,-6", 10, "no cap"),
    ("layered:1,0.4", 10, "top in mm"),
    ("layered:9,0.4", 10, "1.5 to 8.5"),
    ("layered:5,0.01", 10, "modulus_ratio"),
    ("boned:20,9", 10, "at least 2 mm must stay"),
    ("boned:10,8", 15, "60 deg"),
    ("boned:20,6,18", 15, "allows 17 mm"),
    ("boned:20,6,0,2", 15, "bar = 2"),
]


@pytest.mark.parametrize("text, thickness, named", UNCASTABLE)
def test_what_cannot_be_cast_is_refused_with_its_reason(text, thickness, named):
    with pytest.raises(InputError, match=named):
        read_shape(text).check(thickness, 60.0, 50.0)


def test_what_is_just_castable_passes():
    for text, thickness in (
        ("crowned:10,2", 3.5),
        ("boned:20,6", 8.0),
        ("layered:1.5,0.05", 3.0),
        ("layered:1.5,20", 3.0),
        ("crowned:1,0.3,1", 5),
        ("crowned:50,0.3", 5),
        ("slab", 3.0),
    ):
        read_shape(text).check(thickness, 60.0, 60.0)


def test_a_ridge_may_be_longer_than_wide_but_not_reach_the_sides():
    Crowned(10.0, 2.0, 6.0, 1.0).check(10.0, 20.0, 12.0 + 2 * RIM_FREE_MM)
    with raises_code("out_of_range", "crown_reach_mm"):
        Crowned(10.0, 2.0, 6.0, 1.0).check(10.0, 200.0, 11.9 + 2 * RIM_FREE_MM)
    with raises_code("out_of_range", "crown_reach_mm"):
        Crowned(10.0, 2.0, 6.0, 0.0).check(10.0, 20.0, 60.0)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_numbers_that_are_none_never_pass(value):
    shapes = (
        Crowned(value, 2.0, 6.0),
        Crowned(10.0, value, 6.0),
        Layered(value, 0.4),
        Layered(8.0, value),
        Boned(20.0, 6.0, value),
    )
    for shape in shapes:
        with pytest.raises(InputError):
            shape.check(15.0)
