"""The enlarged detail of a crown: tip radius, height and foot radius, at a scale that the detail's name gives."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.mold.files.drawing_layout import (
    PROFILE_POINTS,
    SCALES,
    View,
    arrange,
    crown_detail,
    foot_mm,
    profile_words,
    ratio,
)
from dummydesign.mold.files.drawing_sheet import PAPERS, to_dxf
from dummydesign.mold.files.part_drawings import part_views, sheets
from tests.mold.files.test_drawings import TITLE, meeting

CROWNS = {
    "crowned:21.2,2,9.4": (21.2, 2.0, 9.4),
    "crowned:3,8,9,1": (3.0, 8.0, 9.0),
    "crowned:10,2": (10.0, 2.0, 6.0),
}
SLAB = (((-75.0, -4.5), (75.0, -4.5), (75.0, -2.0), (0.0, 0.0), (-75.0, -2.0), (-75.0, -4.5)), "cut")


@pytest.mark.parametrize("text", CROWNS)
def test_a_detail_measures_what_the_shape_says_and_draws_its_profile(text):
    shape, (radius, high, foot) = read_shape(text), CROWNS[text]
    assert foot_mm(shape) == pytest.approx(foot, abs=1e-4)
    view = crown_detail(shape, 1.01)
    across, up = view.measures
    assert across.value == pytest.approx(1.01 * foot, abs=1e-3) and up.value == pytest.approx(1.01 * high)
    assert [words for _, words in view.leaders] == [f"R{1.01 * radius:.2f}".rstrip("0").rstrip(".") + " at the tip"]
    profile = np.array(next(run for run, layer in view.runs if layer == "cut"))
    r, drop = profile[:, 0] / 1.01, -profile[:, 1] / 1.01
    near = np.abs(r) < 0.15 * foot
    # The curvature at the tip is that of its radius.
    assert r[near] ** 2 / 2 / radius == pytest.approx(drop[near], rel=0.05, abs=1e-9)
    assert drop.max() == pytest.approx(high) and drop.min() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("paper", PAPERS)
@pytest.mark.parametrize("text", CROWNS)
def test_a_detail_is_larger_than_the_sheet_says_its_scale_and_meets_no_text(text, paper):
    section = View("section", (SLAB,), (), (), True, marks=(((0.0, 0.0), "A"),))
    above = View("view from above", ((((-75.0, 0.0), (75.0, 0.0), (75.0, 120.0), (-75.0, 120.0)), "outline"),))
    drawing = arrange([section, above, crown_detail(read_shape(text))], TITLE, ["a note"], paper)
    assert meeting(drawing) == []
    scales = {round(drawing.scale * d.enlarged, 6) for d in drawing.dimensions}
    (own,) = scales
    assert own in SCALES and own >= 2.0 * drawing.scale
    assert f"detail A ({ratio(own)})" in [one.words for one in drawing.texts]
    for d in drawing.dimensions:
        axis = int(d.vertical)
        assert abs(d.end[axis] - d.start[axis]) == pytest.approx(own * d.value)
    assert "A" in [one.words for one in drawing.texts]


@pytest.mark.parametrize("text", CROWNS)
def test_the_profile_is_given_as_points_of_the_shape_from_tip_to_foot_with_its_tolerance(text):
    shape, (_, high, foot) = read_shape(text), CROWNS[text]
    words = profile_words(shape, 1.01, 0.14)
    r, drop = np.array([[float(one) for one in pair] for pair in re.findall(r"(\d+\.\d+)/(\d+\.\d+)", words)]).T
    assert len(r) == PROFILE_POINTS and (r[0], drop[0]) == (0.0, 0.0)
    assert (r[-1], drop[-1]) == pytest.approx((1.01 * foot, 1.01 * high), abs=0.006)
    still = np.zeros(len(r))
    known = shape.drop_mm(still, r / 1.01) if shape.runs_out else shape.drop_mm(r / 1.01, still)
    # r is rounded to 0.01 mm on a slope of at most 70 deg
    assert drop == pytest.approx(1.01 * known, abs=0.015)
    assert "profile tolerance 0.14" in words and "tolerance" not in profile_words(shape)


def test_the_limits_of_the_tip_radius_stand_at_the_tip():
    view = crown_detail(read_shape("crowned:21.2,2,9.4"), 1.01, (20.0, 22.5))
    assert [words for _, words in view.leaders] == ["R21.41 at the tip (20.2 to 22.73)"]


@pytest.mark.slow
def test_pad_and_master_of_a_crown_have_the_detail_in_every_format(crowned):
    import ezdxf

    found = sheets(crowned, part_views(crowned), "", "A3")
    shape = dict(crowned.spec.pad.shape.parameters)
    factor = crowned.plan.scale * crowned.plan.silicone_scale
    for name, grown in (("pad", 1.0), ("master", factor)):
        drawing = found[name]
        values = [d.value for d in drawing.dimensions if d.enlarged != 1.0]
        assert sorted(values) == pytest.approx(sorted([grown * shape["height"], grown * shape["foot"]]), abs=1e-3)
        words = [one.words for one in drawing.texts]
        assert any(one.startswith("R3") for one in words) and "A" in words
        assert any(one.startswith("Profile, distance from the axis") for one in words)
        texts = [e.dxf.text for e in ezdxf.read(io.StringIO(to_dxf([drawing]))).layout(f"1 {name}").query("TEXT")]
        assert any(one.startswith("detail A (") for one in texts)
    assert not any("detail" in one.words for one in found["frame"].texts)
