"""A printed mould without silicone: base and ring hold the cavity and let the pad go, or are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from dummydesign import cli
from dummydesign.mold.checks import release as check_mesh
from dummydesign.mold.checks import release as demould
from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks import solids as check_shape
from dummydesign.mold.checks.process import check_process
from dummydesign.mold.client import make_mold
from dummydesign.mold.files.meshes import tessellate
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.layout import dowel_places, layout, level_places, pad_scale, parting_mm
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import failed, named, no_check_fails, shape_spec
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

SPEC = mould_spec(8.0, 60.0, 50.0, preset="printed")


@pytest.fixture(scope="module")
def printed():
    from dummydesign.mold.cad.build import build

    return build(SPEC)


@pytest.mark.slow
def test_all_checks_pass_and_nothing_of_silicone_is_made(printed):
    checks = check.check_solids(printed)
    assert failed(checks) == [] and {"cavity_volume", "interference_frame_mould", "draft_cavity"} <= set(named(checks))
    assert set(printed.parts) == {"pad", "mould", "frame", "strike_off"}
    assert all(part.is_printed for name, part in printed.parts.items() if name != "pad")
    whole = tessellate(printed.mould)
    assert failed(check_mesh.check_mould_mesh(printed, whole, tessellate(printed.mould, *check_mesh.FINE))) == []


@pytest.mark.slow
def test_base_and_ring_together_are_the_block_without_its_cavity(printed):
    both = printed.solid("mould").Volume() + printed.solid("frame").Volume()
    assert both == pytest.approx(printed.mould.Volume(), rel=1e-9)


@pytest.mark.slow
def test_the_joint_lies_on_the_side_of_the_pad_and_the_ring_lifts_off_away_from_the_free_face(printed):
    high = parting_mm(SPEC, printed.plan)
    assert 0 < SPEC.pad.edge_radius_mm <= high < printed.plan.depth_mm
    assert printed.solid("frame").BoundingBox().zmin == pytest.approx(high, abs=1e-6)
    for lift in (0.5, 2.0, 6.0):
        assert demould.common_volume_mm3(printed.solid("frame").translate((0, 0, -lift)), printed.solid("pad")) < 1e-6
    assert demould.common_volume_mm3(printed.solid("frame").translate((0, 0, 2.0)), printed.solid("pad")) > 1.0


def test_the_ring_goes_on_in_one_way_and_its_holes_keep_apart():
    for length, width in ((60.0, 50.0), (20.0, 20.0), (150.0, 120.0)):
        spec = mould_spec(8.0, length, width, preset="printed")
        plan = layout(spec)
        pins = {(place.x_mm, place.y_mm) for place in dowel_places(spec, plan)}
        assert not {(-x, -y) for x, y in pins} & pins
        assert len({round(abs(x), 3) for x, _ in pins}) == 2
        inset = spec.box.flange_mm / 2
        x, y = plan.flange.length_mm / 2 - inset, plan.flange.width_mm / 2 - inset
        bolts = [(0.0, y), (0.0, -y), (x, 0.0), (-x, 0.0)]
        holes = [(p.x_mm, p.y_mm) for p in (*dowel_places(spec, plan), *level_places(spec, plan))] + bolts
        gaps = [((a - c) ** 2 + (b - d) ** 2) ** 0.5 for i, (a, b) in enumerate(holes) for c, d in holes[i + 1 :]]
        assert min(gaps) > spec.aids.level_screw_hole_mm + 1.0


def test_the_pad_ends_at_size_in_a_mould_that_grows_as_plastic_does():
    warmer = SPEC.pour.cure_temperature_C - SPEC.pour.room_temperature_C
    hot = pad_scale(SPEC) * (1 + SPEC.plastic.expansion_per_K * warmer)
    cured = hot * (1 - SPEC.pour.shrinkage_percent / 100)
    assert cured / (1 + SPEC.pour.resin_expansion_per_K * warmer) == pytest.approx(1.0, rel=1e-14)
    assert layout(SPEC).silicone_scale == 1.0 and pour_plan(SPEC).silicone_mass_g == 0.0


def test_too_little_draft_for_the_surface_is_refused_with_what_is_needed():
    with raises_code("out_of_range", "draft_deg"):
        mould_spec_with(pad=replace(SPEC.pad, draft_deg=2.4))
    rough = replace(SPEC.surface, depth_mm=0.05)
    with raises_code("out_of_range", "draft_deg"):
        mould_spec_with(surface=rough)
    plan = pour_plan(SPEC)
    assert named(check_process(SPEC, plan, pour_warnings(SPEC, plan)))["draft_for_surface"].value == pytest.approx(0.5)


def mould_spec_with(**changed):
    from dummydesign.mold.model.validate import validate

    return validate(replace(SPEC, **changed))


def test_sheet_list_and_answer_do_not_speak_of_silicone_that_is_cast():
    plan = pour_plan(SPEC)
    text = sheet_text(pour_sheet(SPEC, plan, pour_warnings(SPEC, plan)))
    assert "Lift the ring straight up" in text and "wax" in text.lower() and "in the tray" not in text
    assert "mould silicone" not in text and "silicone foams" not in text and "draft of 3 deg" in text
    bill = " ".join(row[0] for row in bill_of_materials(materials(SPEC, plan, {"mould": 1e5})))
    assert "steel pins" in bill and "PVA" in bill and "ASA: mould" in bill and "silicone" not in bill
    assert MouldSpec.from_dict(SPEC.to_dict()) == SPEC and "silicone" not in SPEC.to_dict()


@pytest.mark.parametrize(
    "change, said",
    [
        (("[surface.depth_mm]", "[surface.depth]"), "unknown key 'depth'"),
        (('plastic = "asa"', ""), "'plastic' is missing"),
        (('style = "printed"', 'style = "printed"\nsilicone = "platinum_a20"'), "has no silicone"),
        (("draft_deg = 3.0", "draft_deg = 1.0"), "draft_deg = 1"),
        (("value = 0.025", "value = 0.5"), "high"),
    ],
)
def test_a_damaged_preset_is_one_line_and_no_file(change, said, tmp_path, capsys, monkeypatch):
    from dummydesign.core.user_library import find

    monkeypatch.chdir(tmp_path)
    text = find("molds", "mould preset", "printed").path.read_text()
    (tmp_path / "mine.toml").write_text(text.replace(*change, 1))
    assert cli.run(["mold", "--thickness", "8", "--preset", "mine.toml", "--out", "made"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ") and message.count("\n") == 1 and said in message
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "text, thickness",
    [("crowned:3,8,9", 15.0), ("crowned:3,8,9,1", 15.0), ("boned:20,6", 15.0), ("layered:3,0.4", 8.0)],
)
def test_every_shape_is_cast_in_a_printed_mould(text, thickness):
    from dummydesign.mold.cad.build import build

    made = build(shape_spec(text, thickness, preset="printed"))
    assert failed([*check.check_solids(made), *check_shape.check_shape(made)]) == []


@pytest.mark.slow
def test_the_command_makes_all_files_of_a_printed_mould(tmp_path):
    result = make_mold(mould_spec(8.0, 60.0, 50.0, preset="printed", face_sheet_mm=3.0), tmp_path)
    assert no_check_fails(result.checks) and all(Path(name).is_file() for name in result.files.values())
    assert {"mould_3mf", "frame_3mf", "drawings_dxf", "face_sheet"} <= set(result.files)
    assert "silicone" not in result.masses_g
