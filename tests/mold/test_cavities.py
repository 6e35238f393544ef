"""Several cavities in one mould: every one is the pad's, walls between them hold, and what does not fit is told."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pytest

from dummydesign import cli
from dummydesign.mold.checks import release as check_mesh
from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks.check import genera
from dummydesign.mold.checks.process import check_process
from dummydesign.mold.files.meshes import tessellate
from dummydesign.mold.files.part_drawings import part_views
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.layout import best_grid, layout, mould_volume_mm3
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import failed, shape_spec
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

THREE = mould_spec(6.0, 30.0, 24.0, count=3)
ONE = mould_spec(6.0, 30.0, 24.0)


@pytest.fixture(scope="module")
def three():
    from dummydesign.mold.cad.build import build

    return build(THREE)


@pytest.mark.slow
def test_all_checks_pass_and_the_silicone_is_the_closed_form(three):
    assert failed(check.check_solids(three)) == []
    fine = tessellate(three.mould, *check_mesh.FINE)
    assert failed(check_mesh.check_mould_mesh(three, tessellate(three.mould), fine)) == []
    label = sum(tool.Volume() for tool in three.tools["label"])
    assert three.solid("mould").Volume() == pytest.approx(mould_volume_mm3(THREE), abs=label)


@pytest.mark.slow
def test_a_cavity_that_is_not_the_pads_fails(three):
    wrong = three.parts["mould"]
    plug = three.cavities[-1].scale(0.5)
    three.parts["mould"] = replace(wrong, solid=wrong.solid.fuse(plug.translate(three.cavities[-1].Center() * 0.5)))
    try:
        assert "cavity_volume" in {item.id for item in check.check_volumes(three) if item.status == "fail"}
    finally:
        three.parts["mould"] = wrong


@pytest.mark.parametrize("count", range(1, 13))
def test_cavities_keep_a_wall_apart_and_lie_about_the_middle(count):
    reach, places = best_grid(count, 30.0, 24.0, 12.0, 20.0, (210.0, 210.0))
    assert len(set(places)) == count
    for (x0, y0), (x1, y1) in combinations(places, 2):
        assert abs(x1 - x0) >= 42.0 - 1e-9 or abs(y1 - y0) >= 36.0 - 1e-9
    xs, ys = zip(*places)
    assert (max(xs) - min(xs), max(ys) - min(ys)) == pytest.approx(reach)
    assert max(xs) + min(xs) == pytest.approx(0.0, abs=1e-9) and max(ys) + min(ys) == pytest.approx(0.0, abs=1e-9)


def test_a_long_bed_takes_a_row_where_a_square_one_takes_a_block():
    beds = (400.0, 80.0), (200.0, 200.0)
    rows = [len({y for _, y in best_grid(4, 30.0, 30.0, 10.0, 20.0, bed)[1]}) for bed in beds]
    assert rows[0] in (1, 4) and rows[1] == 2


def test_the_batch_is_for_all_cavities_and_a_pad_weighs_what_it_weighs_alone():
    one, three = pour_plan(ONE), pour_plan(THREE)
    assert three.pad_mass_g == one.pad_mass_g and three.fill_mass_g == one.fill_mass_g
    extra, film = 1 + ONE.pour.extra_percent / 100, ONE.pour.film_loss_g
    assert three.batch_mass_g - film == pytest.approx(3 * one.fill_mass_g * extra, abs=0.2)
    assert not [item for item in check_process(THREE, three, pour_warnings(THREE, three)) if item.status == "fail"]
    text = sheet_text(pour_sheet(THREE, three, []))
    assert "Fill the 3 cavities one after the other" in text and "with 3 cavities" in text


def test_one_cavity_is_the_mould_as_before():
    assert "count" not in ONE.to_dict() and ONE.tag == "t6" and THREE.tag == "t6_x3"
    assert MouldSpec.from_dict(THREE.to_dict()) == THREE and layout(ONE).openings == layout(ONE).opening


@pytest.mark.slow
def test_the_section_goes_through_a_cavity_where_the_middle_is_a_wall():
    from dummydesign.mold.cad.build import build

    four = build(replace(THREE, count=4))
    assert layout(four.spec).places[0].y_mm < -10.0
    views = part_views(four)
    single = part_views(build(ONE))
    for name in ("mould", "master", "strike_off"):
        heights = {round(m.value, 3) for m in views[name][0].measures if m.side in ("left", "right")}
        assert heights == {round(m.value, 3) for m in single[name][0].measures if m.side in ("left", "right")}


def test_more_than_fit_are_refused_with_the_count_that_does(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for size, count, fits in (((60.0, 50.0), 9, 4), ((150.0, 120.0), 2, 1)):
        words = ["mold", "--thickness", "8", "--length", f"{size[0]}", "--width", f"{size[1]}", "--count", f"{count}"]
        assert cli.run(words) == 2
        message = capsys.readouterr().err
        assert message.count("\n") == 1 and f"; {fits} fit" in message
        mould_spec(8.0, *size, count=fits)
    assert list(tmp_path.iterdir()) == []


def test_moulds_with_one_lid_one_bone_or_two_pours_have_one_cavity():
    for given in ({"preset": "lidded"}, {}):
        with raises_code("out_of_range", "count"):
            mould_spec(8.0, 60.0, 50.0, count=2, **given) if given else shape_spec("layered:3,0.4", 8.0, count=2)
    with raises_code("out_of_range", "count"):
        mould_spec(8.0, 30.0, 30.0, count=21)


@pytest.mark.slow
def test_printed_moulds_and_glass_go_with_several_cavities():
    from dummydesign.mold.cad.build import build

    for given in ({"preset": "printed"}, {"face_sheet_mm": 2.0}, {"preset": "printed", "face_sheet_mm": 2.0}):
        made = build(mould_spec(6.0, 40.0, 40.0, count=2, **given))
        assert failed(check.check_solids(made)) == []
        holes = genera(made.spec)
        for name in ("mould", "frame"):
            assert tessellate(made.solid(name)).euler_number == 2 - 2 * holes[name], (name, given)
