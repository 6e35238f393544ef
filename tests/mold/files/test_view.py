"""The view of the parts: all of them, named, apart, nothing from outside; in a real browser where there is one."""

from __future__ import annotations

import json
import re
from itertools import pairwise

import numpy as np
import pytest

from dummydesign.mold.files.picture import turned_over
from dummydesign.mold.files.solid_view import Shown, box, mould_view, stack, view_page
from dummydesign.report.page import solid_section
from tests.support.browser import visit

GREY = (0.7, 0.7, 0.7)


@pytest.fixture(scope="module")
def page():
    import trimesh

    meshes = {
        name: trimesh.creation.box((60, 50, high))
        for name, high in (("tray", 12), ("mould", 20), ("pad", 8), ("strike_off", 8), ("master", 30), ("frame", 30))
    }
    return mould_view(meshes, dict.fromkeys(meshes, GREY), "A mould")


def test_stacked_parts_stand_clear_of_each_other():
    parts = stack({"low": box(10, 10, 5), "middle": box(10, 10, 2), "high": box(10, 10, 4) + (0.0, 0.0, 90.0)}, 7.0)
    tops = [one.triangles[..., 2].max() + one.lift_mm for one in parts]
    bottoms = [one.triangles[..., 2].min() + one.lift_mm for one in parts]
    assert bottoms[1] - tops[0] == pytest.approx(7.0) and bottoms[2] > tops[1]


def test_casting_boxes_stand_beside_what_is_in_use(page):
    parts = {one["name"]: one for one in json.loads(re.search(r'id="view-data">(.*?)</script>', page, re.S)[1])}
    assert set(parts) == {"tray", "mould", "pad", "strike off", "master", "frame"}
    assert parts["pad"]["beside"] == 0 and parts["master"]["beside"] == parts["frame"]["beside"] > 60.0
    assert 0 == parts["tray"]["lift"] < parts["mould"]["lift"] < parts["pad"]["lift"] < parts["strike off"]["lift"]


def test_what_is_turned_over_keeps_its_heights_and_its_outside():
    block = box(10, 8, 5) + (0.0, 0.0, 3.0)
    over = turned_over(block)
    assert over[..., 2].min() == 3.0 and over[..., 2].max() == 8.0

    def volume(triangles):
        return float(np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6)

    assert volume(over) == pytest.approx(volume(block)) and volume(block) == pytest.approx(400.0)


def test_in_a_report_the_pad_beside_its_mould_lies_with_its_tested_face_up():
    cone = box(20, 20, 6)
    cone[cone[..., 2] == 0, :2] *= 0.1
    html = solid_section({"mould": box(40, 40, 20), "pad": cone}, "").html
    assert "pad, tested face up" in html and "pad, tested face up" not in solid_section({"pad": cone}, "").html


@pytest.mark.slow
@pytest.mark.parametrize("window", ["1200,800", "400,844"])
def test_a_browser_draws_every_part_and_names_it_apart_from_the_others(page, window, tmp_path):
    (tmp_path / "view.html").write_text(page)
    seen = visit((tmp_path / "view.html").as_uri(), tmp_path, f"--window-size={window}")
    assert seen.console == [] and seen.requests == []
    # in whichever order the browser writes the attributes
    label = r'<span(?=[^>]* style="top: ([-\d.]+)px;")(?=[^>]* class="(far)?")[^>]*>([^<]+)</span>'
    labels = re.findall(label, seen.dom)
    assert {name for *_, name in labels} == {"tray", "mould", "pad", "strike off", "master", "frame"}
    for side in ("", "far"):
        heights = sorted(float(top) for top, where, _ in labels if where == side)
        assert all(b - a > 12.0 for a, b in pairwise(heights))
    assert seen.dom.count("<path ") == 6 and seen.dom.count('type="checkbox"') == 6


def test_a_title_is_only_text():
    assert "<b>" not in view_page([Shown("pad", box(1, 1, 1), GREY)], "<b>", "").split("</title>")[0]
