"""The inside of the pressed pad: where the punch stands, what the pressures add up to, and what is left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.design.plot_data import press_pictures
from dummydesign.design.request import Request
from dummydesign.design.suggest import suggest
from dummydesign.design.test_conditions import pad_of_request
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.fields import solve_fields
from dummydesign.pad.force_source import elastic_curve
from dummydesign.report.suggest_sections import pressed_section

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def answer():
    """A crowned pad by its table; the slab that ``auto`` puts beside it is that of its own search."""
    limits = {"thickness_mm": (4.5, 5.0), "ratio": (15.0, 16.0)}
    found = suggest(Request("forefinger", shape="crowned:21.2,2,9.4", verify=False, **limits))
    return replace(found, problem=replace(found.problem, request=replace(found.request, verify=True)))


@pytest.fixture(scope="module")
def pictures(answer):
    return press_pictures(answer)


@pytest.mark.slow
def test_every_force_of_the_test_is_pictured_at_the_depth_of_the_design(answer, pictures):
    assert pictures.left_out == "" and [one.force_N for one in pictures.pads] == [5.0, 10.0, 15.0]
    depths = answer.best.evaluation.depth_mm[answer.best.index, :3]
    assert np.allclose([one.depth_mm for one in pictures.pads], depths)
    # pictures are of the circle of the punch's area: the square's corners are a factor on it
    best, request = answer.best, answer.request
    young = float(np.asarray(answer.resin.young_MPa(best.ratio)))
    round_pad = replace(pad_of_request(request, answer.punch, best.thickness_mm, young), geometry=answer.shape)
    by_table = elastic_curve(replace(round_pad, sides_mm=None), "table").force(depths)
    assert np.all(by_table > [5.0, 10.0, 15.0])
    assert np.allclose([one.static_N for one in pictures.pads], by_table, rtol=0.06)


def test_the_pad_ends_at_the_punch_and_both_sides_are_alike(answer, pictures):
    for one in pictures.pads:
        column = one.stress_kPa[:, one.stress_kPa.shape[1] // 2]
        top = one.height_mm[np.isfinite(column)].max()
        size = one.height_mm[1] - one.height_mm[0]
        assert abs(top + 0.5 * size - (answer.best.thickness_mm - one.depth_mm)) < size
        assert np.array_equal(one.stress_kPa, one.stress_kPa[:, ::-1], equal_nan=True)
        assert one.punch_mm[0, 1] == pytest.approx(answer.best.thickness_mm - one.depth_mm, abs=1e-9)


def test_the_mean_pressure_over_the_contact_carries_the_force(pictures):
    for one in (*pictures.pads, *pictures.slab):
        area = np.pi * one.contact["contact_radius_mm"] ** 2
        assert 1e-3 * one.contact["mean_kPa"] * area == pytest.approx(one.static_N)


def test_a_crown_is_pressed_most_in_the_middle(pictures):
    crown = pictures.pads[-1].contact
    assert crown["peak_radius_mm"] < 0.5 and crown["peak_kPa"] > 1.2 * crown["mean_kPa"]


@pytest.mark.slow
def test_pictures_are_within_three_percent_of_the_fine_elements(answer, pictures):
    best = answer.best
    young = float(np.asarray(answer.resin.young_MPa(best.ratio)))
    pad = replace(pad_of_request(answer.request, answer.punch, best.thickness_mm, young), geometry=answer.shape)
    fine, _ = solve_fields(pad, [one.depth_mm for one in pictures.pads])
    for rough, one in zip(pictures.pads, fine):
        assert rough.static_N == pytest.approx(one.force_N, rel=0.03)
        assert rough.contact["peak_kPa"] == pytest.approx(one.contact()["peak_kPa"], rel=0.03)


def _verified(answer, verify):
    problem = answer.problem
    return replace(answer, problem=replace(problem, request=replace(problem.request, verify=verify)))


@pytest.mark.slow
def test_without_finite_elements_and_for_pads_that_are_not_round_it_says_what_is_left_out(answer):
    quick = _verified(answer, False)
    made = press_pictures(quick)
    assert made.pads == () and "finite elements were not requested" in pressed_section(quick, made).text
    ridge = replace(answer, best=replace(answer.best, shape=read_shape("crowned:10,2,6,1")))
    assert "crowned pads are not round" in pressed_section(ridge, press_pictures(ridge)).text


def test_the_report_draws_to_scale_and_compares_the_pressures(answer, pictures):
    section = pressed_section(answer, pictures)
    assert "largest at the centre" in section.text
    sections = [plot for plot in section.plots if plot.to_scale]
    assert [plot.name for plot in sections] == ["pressed-5N", "pressed-10N", "pressed-15N"]
    for plot in sections:
        assert plot.figure()["layout"]["yaxis"]["scaleanchor"] == "x"
        assert any(one.label.startswith("subjects at") for one in plot.series)
