"""One contract for every force law: a toy law goes wherever the response table goes, and all laws keep it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from dummydesign.design.search.fe_candidates import ElementsLaw
from dummydesign.design.search.shape_family import FamilyLaw as FamilyShapeLaw
from dummydesign.design.search.shape_family import load_family
from dummydesign.design.sweep.run import whatif
from dummydesign.design.sweep.spec import Study
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.loop.corrected_law import CorrectedLaw
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.fe_force_law import FeForceLaw
from dummydesign.pad.force_law import ForceCurve, ForceLaw, ScaledLaw, curve_at
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import motion_on_curve
from dummydesign.pad.tables.shape import TabulatedShapeLaw
from dummydesign.pad.tables.slab import ResponseTable, load_table
from dummydesign.pad.tables.square import circle_of, square_factor, square_law
from tests.support.exact_law import ExactLaw
from tests.support.refusal import raises_code

RADIUS = 7.9
MEMBERS = ("force", "stiffness", "depth_limit_mm", "gel_mm", "relative_error", "ratio_range", "provenance", "notes")


@dataclass(frozen=True)
class Foam(ExactLaw):
    """F = 20 E pi a^2 (d/h)^2 / (1 - d/h): springs under the punch alone, all known in closed form."""

    notes = ("foam",)

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        x = np.maximum(np.asarray(depth_mm, float) / thickness_mm, 0.0)
        return 20.0 * np.asarray(young_MPa, float) * np.pi * np.asarray(radius_mm, float) ** 2 * x**2 / (1.0 - x)

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.5 * np.asarray(thickness_mm, float)


def depth_of(force_N, thickness_mm, young_MPa, radius_mm):
    """Depth of the foam at a force: the root of x^2 + q x - q = 0, q = F / (20 E pi a^2)."""
    q = force_N / (20.0 * young_MPa * np.pi * radius_mm**2)
    return thickness_mm * 0.5 * (np.sqrt(q**2 + 4.0 * q) - q)


def laws():
    """One of each law that can be had without a solve."""
    table = load_table()
    depth = np.linspace(0.5, 5.0, 10)
    solved = FeForceLaw(RADIUS, {10.0: (1.0, 0.3)}, {10.0: (depth, np.full(10, 1e-3))}, ())
    crowned = read_shape("crowned:radius=20,height=3")
    family = FamilyShapeLaw(load_family("crowned"), crowned, 10.0)
    return {
        "family": family,
        "elements": ElementsLaw(replace(family, cast=True), 10.0, depth, np.linspace(0.0, 0.02, 10), np.full(10, 0.01)),
        "table": table,
        "square": square_law(table, "bonded"),
        "crowned": TabulatedShapeLaw(crowned),
        "solved": solved,
        "toy": Foam(),
        "times": ScaledLaw(Foam(), lambda d, h, a: (np.full(np.shape(d), 2.0), np.full(np.shape(d), 0.1))),
    }


NAMES = ("table", "square", "crowned", "family", "elements", "solved", "toy", "times")


@pytest.mark.parametrize("name", NAMES)
def test_a_law_offers_every_member_and_its_stiffness_is_the_slope_of_its_force(name):
    law = laws()[name]
    assert isinstance(law, ForceLaw)
    assert np.shape(law.relative_error(np.array([1.0, 2.0]), 10.0, RADIUS)) == (2,)
    assert np.shape(law.relative_error(np.array([[1.0, 2.0]]), np.array([[10.0]]), RADIUS)) == (1, 2)
    depth, step = np.array([0.8, 2.0, 3.1]), 1e-3
    slope = (law.force(depth + step, 10.0, 0.03, RADIUS) - law.force(depth - step, 10.0, 0.03, RADIUS)) / (2.0 * step)
    assert law.stiffness(depth, 10.0, 0.03, RADIUS) == pytest.approx(slope, rel=1e-4)


def test_a_solved_law_keeps_the_form_of_its_thicknesses_and_names_one_that_was_not_solved():
    solved = laws()["solved"]
    for thickness in (10.0, np.array([10.0]), np.array([[10.0], [10.0 + 1e-12]])):
        limit = solved.depth_limit_mm(thickness, RADIUS)
        assert np.shape(limit) == np.shape(thickness) and np.all(limit == 5.0)
    asked = (
        lambda: solved.force(1.0, 8.1, 0.03, RADIUS),
        lambda: solved.depth_limit_mm(8.1, RADIUS),
        lambda: solved.relative_error(1.0, 8.1, RADIUS),
    )
    for ask in asked:
        with pytest.raises(ValueError, match=r"thicknesses of 10 mm, requested 8\.1 mm"):
            ask()


@pytest.mark.parametrize(
    "kind", [ResponseTable, TabulatedShapeLaw, FamilyShapeLaw, FeForceLaw, ScaledLaw, ElementsLaw, CorrectedLaw]
)
def test_no_law_of_the_package_lacks_a_member(kind):
    own = set(dir(kind)) | set(getattr(kind, "__dataclass_fields__", ()))
    assert [name for name in MEMBERS if name not in own] == []


def test_stiffness_by_differences_is_the_derivative_inside_and_at_both_ends():
    depth = np.array([1e-3, 1.0, 3.0, 5.0])
    x = depth / 10.0
    exact = 20.0 * 0.03 * np.pi * RADIUS**2 / 10.0 * (2.0 * x - x**2) / (1.0 - x) ** 2
    found = Foam().stiffness(depth, 10.0, 0.03, RADIUS)
    assert found[1:3] == pytest.approx(exact[1:3], rel=1e-6)
    assert found[3] == pytest.approx(exact[3], rel=1e-3)
    assert 0.0 < found[0] < exact[1] and Foam().stiffness(0.0, 10.0, 0.03, RADIUS) == 0.0


def test_a_toy_law_is_predicted_with():
    curve, depth = curve_at(Foam(), 10.0, 0.03, RADIUS), np.array([1.0, 2.5, 4.9])
    assert curve.force(depth) == pytest.approx(Foam().force(depth, 10.0, 0.03, RADIUS), rel=1e-12)
    exponent = depth * curve.stiffness(depth) / curve.force(depth)
    assert exponent == pytest.approx(1.0 + 1.0 / (1.0 - depth / 10.0), rel=1e-4)
    assert curve.notes == ("foam",)
    with raises_code("out_of_range", "depth_mm"):
        motion_on_curve(Pad(10.0, 0.03, RADIUS), ramp_and_hold(100.0, 5.1, 10.0), curve)


def test_a_toy_law_relaxes_to_its_static_force():
    pad = Pad(10.0, 0.03, RADIUS, (PronyTerm(0.05, 1.0),))
    found = motion_on_curve(pad, ramp_and_hold(100.0, 3.0, 10.0), curve_at(Foam(), 10.0, 0.03, RADIUS))
    assert found.steady_force_N == pytest.approx(float(Foam().force(3.0, 10.0, 0.03, RADIUS)), rel=1e-6)
    assert found.peak_force_N > 1.2 * found.steady_force_N


def test_a_toy_law_is_scored_by_a_study():
    study = Study((8.0, 12.0), (15.0,), (("round:15.8", RADIUS),), tissue="palm")
    rows = whatif(study, law=Foam())["rows"]
    for row in rows:
        young = 1e-3 * row["young_kPa"]
        for force in (1.0, 15.0):
            wanted = depth_of(force, row["thickness_mm"], young, RADIUS)
            assert wanted < 0.5 * row["thickness_mm"]
            assert row["depth_mm_at_N"][f"{force:g}"] == pytest.approx(wanted, rel=1e-4)
        assert row["force_error_percent"] == 0.0
        assert row["score"] is not None


def test_factors_multiply_forces_and_add_errors():
    table, depth = load_table(), np.array([1.0, 2.0])
    law = square_law(table, "bonded")
    factor, error = square_factor(depth, 10.0, RADIUS)
    assert np.array_equal(law.force(depth, 10.0, 0.03, RADIUS), factor * table.force(depth, 10.0, 0.03, RADIUS))
    assert np.array_equal(law.relative_error(depth, 10.0, RADIUS), error + table.relative_error(depth, 10.0, RADIUS))
    assert (law.ratio_range, law.provenance) == (table.ratio_range, table.provenance)
    assert circle_of(law) is table and circle_of(table) is table


def test_a_curve_is_its_law_at_one_pad():
    curve = curve_at(load_table(), 10.0, 0.03, RADIUS)
    depth = np.array([0.5, 3.0])
    assert np.array_equal(curve.force(depth), load_table().force(depth, 10.0, 0.03, RADIUS))
    assert curve.limit_mm == pytest.approx(float(load_table().depth_limit_mm(10.0, RADIUS)))
    end = curve.relative_error(np.array([curve.limit_mm]))
    assert np.array_equal(curve.relative_error(np.array([2.0 * curve.limit_mm])), end)


def test_a_curve_of_the_pad_keeps_the_contract_of_curves():
    table, depth = load_table(), np.array([0.5, 3.0])
    curves = [curve_at(table, 10.0, 0.03, RADIUS), elastic_curve(Pad(10.0, 0.03, RADIUS), "table")]
    for curve in curves:
        assert isinstance(curve, ForceCurve)
        assert curve.force(depth) == pytest.approx(table.force(depth, 10.0, 0.03, RADIUS), rel=1e-12)
        assert curve.stiffness(depth) == pytest.approx(table.stiffness(depth, 10.0, 0.03, RADIUS), rel=1e-6)
        assert curve.relative_error(depth) == pytest.approx(table.relative_error(depth, 10.0, RADIUS))
        assert (curve.provenance, curve.notes) == (table.provenance, ())
