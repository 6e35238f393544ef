"""A sheet of glass as the tested face: it fits, it is flush, the silicone does not know of it; else it is refused."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.core.errors import InputError
from dummydesign.mold.checks import solids as check
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.layout import layout, plug_top_mm, recess_outline, sheet_outline
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import pour_plan
from tests.support.mould_checks import failed, named, shape_spec
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

GLASS = mould_spec(8.0, 60.0, 50.0, face_sheet_mm=3.0)


@pytest.fixture(scope="module")
def glazed():
    from dummydesign.mold.cad.build import build

    return build(GLASS)


@pytest.mark.slow
def test_the_silicone_is_the_same_and_the_master_with_its_sheet_is_the_plain_master(glazed, open_parts):
    assert glazed.plan == open_parts.plan
    plain, sheet = open_parts.solid("master").Volume(), glazed.solid("face_sheet").Volume()
    pocket = glazed.tools["face_recess"][0].Volume()
    # The label is cut by the specification's hash, so its strokes differ by a few cubic millimetres.
    assert glazed.solid("master").Volume() == pytest.approx(plain - pocket, abs=40.0)
    assert 0 < pocket - sheet < 0.1 * sheet


@pytest.mark.slow
def test_all_checks_pass_and_a_sheet_that_stands_proud_fails(glazed):
    found = check.check_solids(glazed)
    assert failed(found) == [] and {"face_sheet_flush", "face_sheet_seated"} <= set(named(found))
    part = glazed.parts["face_sheet"]
    glazed.parts["face_sheet"] = replace(part, solid=part.solid.translate((0, 0, 0.05)))
    try:
        assert {item.id for item in check.check_sheet(glazed) if item.status == "fail"} == {
            "face_sheet_flush",
            "face_sheet_seated",
        }
    finally:
        glazed.parts["face_sheet"] = part


@pytest.mark.parametrize("corner, edge", [(5.0, 1.5), (20.0, 0.0), (24.0, 1.0), (0.5, 0.0)])
def test_the_sheets_corners_keep_the_rim_inside_the_flat_of_the_face(corner, edge):
    spec = replace(GLASS, pad=replace(GLASS.pad, corner_radius_mm=corner, edge_radius_mm=edge))
    plan = layout(spec)
    sheet, face = sheet_outline(spec, plan), plan.floor_outline.scaled(plan.silicone_scale)
    inset = edge * plan.scale * plan.silicone_scale + spec.box.sheet_rim_mm
    x, y = sheet.length_mm / 2, sheet.width_mm / 2
    centre = face.length_mm / 2 - face.radius_mm, face.width_mm / 2 - face.radius_mm
    assert face.length_mm / 2 - x >= inset - 1e-9 and face.width_mm / 2 - y >= inset - 1e-9
    if x > centre[0] and y > centre[1]:
        away = ((x - centre[0]) ** 2 + (y - centre[1]) ** 2) ** 0.5
        assert away <= face.radius_mm - inset + 1e-9
    assert recess_outline(spec, plan).length_mm == pytest.approx(sheet.length_mm + 2 * spec.machines.gap_mm)


def test_a_puck_takes_a_round_sheet():
    spec = mould_spec(20.0, 50.0, 50.0, kind="puck", face_sheet_mm=2.0)
    sheet = sheet_outline(spec, layout(spec))
    assert sheet.is_circle and 40.0 < sheet.length_mm < 42.5


def test_sheet_and_list_name_the_size_to_cut():
    plan, sheet = pour_plan(GLASS), sheet_outline(GLASS, layout(GLASS))
    size = f"{sheet.length_mm:g} x {sheet.width_mm:g} mm"
    assert any("glass, 3 mm" in row[0] and size in row[0] for row in bill_of_materials(materials(GLASS, plan)))
    assert "flush with the plug's top" in sheet_text(pour_sheet(GLASS, plan, []))


def test_the_section_of_a_sheet_goes_through_the_sheet_of_a_printed_mould_with_two_cavities():
    from dummydesign.mold.cad.parts import Parts
    from dummydesign.mold.files.part_drawings import section_origin

    spec = mould_spec(8.0, 60.0, 50.0, preset="printed", face_sheet_mm=3.0, count=2)
    first = layout(spec).places[0]
    assert section_origin(Parts(spec, layout(spec), None), "face_sheet") == (first.x_mm, first.y_mm) != (0.0, 0.0)


def test_a_mould_without_a_sheet_does_not_know_of_one():
    plain = mould_spec(8.0, 60.0, 50.0)
    assert "face_sheet_mm" not in plain.to_dict()["box"] and mould_spec(8.0, 60.0, 50.0, face_sheet_mm=0.0) == plain
    assert GLASS.hash != plain.hash and MouldSpec.from_dict(GLASS.to_dict()) == GLASS


def test_a_sheet_that_cannot_be_is_refused_with_what_is_allowed():
    for given, said in (({"face_sheet_mm": 0.5}, "face_sheet_mm = 0.5"), ({"face_sheet_mm": 9.0}, "1 to 8")):
        with pytest.raises(InputError, match=said):
            mould_spec(8.0, 60.0, 50.0, **given)
    with raises_code("not_applicable", "face_sheet_mm"):
        shape_spec("crowned:10,2", 5.0, face_sheet_mm=3.0)
    with raises_code("cannot_be_made", "face_sheet_mm"):
        mould_spec(8.0, 28.0, 28.0, face_sheet_mm=3.0)


def test_the_pocket_leaves_a_floor_under_it():
    deep = plug_top_mm(layout(mould_spec(3.0, 60.0, 50.0))) + GLASS.box.base_mm
    mould_spec(3.0, 60.0, 50.0, face_sheet_mm=8.0)
    assert deep - 8.0 - GLASS.box.sheet_bond_mm > 3.0
