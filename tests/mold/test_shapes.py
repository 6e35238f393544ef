"""Moulds of shaped pads: exact solids, their spacer and carrier, what the checks see and what is refused."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.geometry.conic import Conic
from dummydesign.geometry.shapes import read_shape
from dummydesign.mold.cad.build import brim_tool, build
from dummydesign.mold.cad.pad_solids import cavity_solid, pad_solid
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.prisms import single_solid
from dummydesign.mold.checks import mesh as check_mesh
from dummydesign.mold.checks import process as check_process
from dummydesign.mold.checks import release as demould
from dummydesign.mold.checks import shape as check_shape
from dummydesign.mold.checks import solids as check
from dummydesign.mold.files import meshes as mesh
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.outline import slab_volume_mm3
from dummydesign.mold.model.pad_kind import read_kind
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from dummydesign.mold.runner import make_mold, without_cad
from dummydesign.resin import load_resin
from tests.support.mould_checks import no_check_fails


def _spec(text: str, thickness_mm: float, **given):
    kind, parameters = read_kind(text)
    return mould_spec(thickness_mm, 60.0, 50.0, kind=kind, parameters=parameters, **given)


def _failed(checks):
    return [f"{item.id} = {item.value} ({item.note})" for item in checks if item.status == "fail"]


def _named(checks):
    return {item.id: item for item in checks}


@pytest.fixture(scope="module")
def crowned():
    return build(_spec("crowned:3,8,9", 15.0))


@pytest.fixture(scope="module")
def layered():
    return build(_spec("layered:3,0.4", 8.0))


@pytest.fixture(scope="module")
def boned():
    return build(_spec("boned:20,6", 15.0))


# Closed forms.


def _top_by_heights(spec, count: int = 600) -> float:
    """Volume over the flat from the heights the finite-element model uses, on a midpoint grid; no draft."""
    pad = spec.pad
    x = (np.arange(count) + 0.5) * pad.length_mm / count - pad.length_mm / 2
    y = (np.arange(count) + 0.5) * pad.width_mm / count - pad.width_mm / 2
    rise = pad.face_height_mm - pad.shape.drop_mm(*np.meshgrid(x, y)) + pad.shape.bone_mm(*np.meshgrid(x, y))
    return float(rise.mean() * pad.length_mm * pad.width_mm)


CURVED = ["crowned:10,2", "crowned:3,8,9", "crowned:5,3,5.5", "bumped:13,6,1.5,0.2", "boned:20,6"]


@pytest.mark.parametrize("text", CURVED)
def test_what_a_shape_adds_is_the_integral_of_its_heights(text):
    spec = _spec(text, 15.0)
    added = spec.pad.shape.top_volume_mm3(spec.pad) + spec.pad.shape.bone_volume_mm3(spec.pad)
    assert added == pytest.approx(_top_by_heights(spec), rel=1e-3)


def test_ridge_is_a_circular_segment_times_its_length_and_its_leaning_ends_add_the_moment():
    radius, high = 10.0, 2.0
    foot = math.sqrt(2 * radius * high - high**2)
    segment = radius**2 * math.acos((radius - high) / radius) - (radius - high) * foot
    conic = Conic(radius, high, foot)
    assert conic.ridge_volume_mm3(30.0, 0.0) == pytest.approx(60.0 * segment, rel=1e-13)
    # First moment of the segment about its crest: its centroid lies (2 b)^3 / (12 A) from the centre.
    centroid = radius - (2 * foot) ** 3 / (12 * segment)
    lean = conic.ridge_volume_mm3(30.0, 0.1) - 60.0 * segment
    assert lean == pytest.approx(2 * 0.1 * centroid * segment, rel=1e-12)


SOLIDS = [
    ("crowned:10,2", 5.0), ("crowned:3,8,9", 15.0), ("crowned:1,12,10", 20.0), ("crowned:5,3,5.477225575051661", 8.0),
    ("crowned:10,2,0,1", 5.0), ("crowned:3,8,9,1", 15.0), ("bumped:13,6,1.5,0.2", 10.0), ("boned:20,6", 15.0),
    ("boned:8,4,14", 15.0), ("boned:20,6,0,1", 15.0), ("boned:8,4,14,1", 15.0), ("layered:3,0.4", 8.0),
]  # fmt: skip


@pytest.mark.parametrize("text, thickness", SOLIDS)
def test_solid_of_a_shape_has_its_closed_form_and_its_height(text, thickness):
    spec = _spec(text, thickness)
    pad, solid = spec.pad, pad_solid(spec.pad)
    plain = slab_volume_mm3(
        layout(spec).floor_outline.scaled(1 / layout(spec).scale),
        thickness - pad.face_height_mm, pad.draft_deg, pad.edge_radius_mm,
    )  # fmt: skip
    exact = plain + pad.shape.top_volume_mm3(pad) - pad.shape.bone_volume_mm3(pad)
    assert solid.Volume() == pytest.approx(exact, rel=check.VOLUME_REL)
    assert solid.isValid() and len(solid.Solids()) == 1
    bounds = solid.BoundingBox()
    assert (bounds.zmin, bounds.zmax) == pytest.approx((0.0, thickness), abs=1e-6)
    if text.split(":")[0] != "layered":
        assert _failed([check_shape.face_profile(Parts(spec, layout(spec), solid))]) == []


def test_sphere_gets_a_true_sphere_face():
    for text in ("crowned:10,2", "boned:20,6", "bumped:13,6,1"):
        kinds = [face.geomType() for face in pad_solid(_spec(text, 15.0).pad).Faces()]
        assert kinds.count("SPHERE") == (9 if text.startswith("bumped") else 1)


def test_flat_and_other_curves_fail_the_profile_check():
    spec = _spec("crowned:10,2", 8.0)
    right = pad_solid(spec.pad)
    wrong = [pad_solid(_spec(text, 8.0).pad) for text in ("slab", "crowned:10.01,2,6", "crowned:10,2,6.01")]
    for solid in (*wrong, right.translate((0, 0, 1e-4)), right.translate((1e-3, 0, 0))):
        assert _failed([check_shape.face_profile(Parts(spec, layout(spec), solid))])


# Whole moulds.


def test_all_checks_of_a_crowned_mould_pass(crowned):
    checks = check.check_solids(crowned) + check_shape.check_shape(crowned)
    fine = mesh.tessellate(crowned.solid("mould"), *check_mesh.FINE)
    checks += check_mesh.check_mould_mesh(crowned, mesh.tessellate(crowned.solid("mould")), fine)
    assert _failed(checks) == []
    assert {"face_profile", "closed_form", "floor_thickness"} <= set(_named(checks))
    assert _named(checks)["floor_thickness"].value == pytest.approx(crowned.spec.body.floor_mm, abs=0.06)


def test_all_checks_of_a_boned_mould_pass(boned):
    checks = check.check_solids(boned) + check_shape.check_shape(boned)
    assert _failed(checks) == []
    wanted = {"bone_volume", "gel_and_bone", "bone_cover", "interference_carrier_mould", "interference_carrier_pad"}
    assert wanted <= set(_named(checks)) and "strike_off" not in boned.parts


def test_shape_checks_of_a_layered_mould_pass(layered):
    checks = check_shape.check_shape(layered) + check.check_validity(layered) + check.check_volumes(layered)
    assert _failed(checks) == []
    assert {"layers_fill_cavity", "layer_closed_form", "spacer_height"} <= set(_named(checks))
    common = demould.common_volume_mm3(layered.solid("spacer"), layered.solid("mould"))
    assert common < check.INTERFERENCE_MM3


OTHERS = [("bumped:13,6,1.5,0.2", 10.0), ("crowned:10,2,0,1", 8.0), ("boned:20,6,0,1", 15.0)]


@pytest.mark.parametrize("text, thickness", OTHERS)
def test_volumes_drafts_and_shape_of_the_other_moulds_pass(text, thickness):
    made = build(_spec(text, thickness))
    checks = check.check_validity(made) + check.check_volumes(made) + check.check_drafts(made)
    checks += check_shape.check_shape(made)
    assert _failed(checks) == []


def test_pocket_near_the_underside_fails_the_floor_check(crowned):
    import cadquery as cq

    floor = crowned.spec.body.floor_mm
    for left, most in ((3.0, 3.4), (-1.0, 1.0)):
        low = crowned.solid("pad").translate(cq.Vector(0, 0, left - floor))
        thin = single_solid(crowned.hull.cut(low, crowned.solid("pad"), brim_tool(crowned.spec, crowned.plan)))
        rough = mesh.tessellate(thin, 0.2, 0.5)
        found = _named(check_mesh.check_mould_mesh(crowned, rough, rough))["floor_thickness"]
        assert found.status == "fail" and found.value < most


def test_undercut_bulb_fails_draft_rays_and_sweep(crowned):
    import cadquery as cq

    spec, plan = crowned.spec, crowned.plan
    bulb = cq.Solid.makeSphere(4.0, cq.Vector(0, 0, 0), angleDegrees1=-90, angleDegrees2=90).translate(
        cq.Vector(0, 0, plan.face_mm - 3.0)
    )
    flat = pad_solid(replace(spec.pad, kind="slab", parameters=(), thickness_mm=7.0)).scale(plan.scale)
    pad = single_solid(flat.translate(cq.Vector(0, 0, plan.face_mm)).fuse(bulb))
    mould = single_solid(crowned.hull.cut(pad, brim_tool(spec, plan)))
    assert check.cavity_draft_deg(mould, crowned) < 0
    fine = mesh.tessellate(mould, *check_mesh.FINE)
    assert demould.ray_hits(fine, plan.opening, -0.01, plan.land_mm) > 0
    assert demould.sweep_interference_mm3(pad, mould, check.sweep_offsets_mm(plan.depth_mm)) > 1.0


def _moved(made, name, up_mm):
    import cadquery as cq

    part = made.parts[name]
    parts = {**made.parts, name: replace(part, solid=part.solid.translate(cq.Vector(0, 0, up_mm)))}
    return replace(made, parts=parts)


def test_spacer_at_the_wrong_height_is_seen(layered):
    low, high = _moved(layered, "spacer", -0.2), _moved(layered, "spacer", 0.2)
    assert _named(check_shape.check_shape(high))["spacer_height"].status == "fail"
    found = _named(check_shape.check_shape(low))
    assert found["spacer_height"].status == found["interference_spacer_layer_top"].status == "fail"


def test_layers_that_leave_a_gap_are_seen(layered):
    from dummydesign.mold.cad.prisms import drafted_prism

    gap = drafted_prism(layered.plan.top, 0.1, 0.0, layered.plan.interface_mm)
    part = layered.parts["layer_base"]
    parts = {**layered.parts, "layer_base": replace(part, solid=single_solid(part.solid.cut(gap)))}
    assert _named(check_shape.check_shape(replace(layered, parts=parts)))["layers_fill_cavity"].status == "fail"


def test_bone_that_touches_the_tested_face_is_seen(boned):
    cover = boned.plan.scale * boned.spec.pad.least_gel_mm
    low = _moved(boned, "carrier", -cover)
    assert low.solid("carrier").BoundingBox().zmin == pytest.approx(0.0, abs=1e-6)
    found = _named(check_shape.check_shape(low) + check.check_interference(low))
    for name in ("bone_cover", "bone_volume", "interference_carrier_pad", "interference_carrier_mould"):
        assert found[name].status == "fail", name


def test_carrier_opens_four_vents_over_the_gel_and_four_screw_holes_beside_it(boned):
    carrier, plan = boned.solid("carrier"), boned.plan
    mid = (plan.land_mm + carrier.BoundingBox().zmax) / 2
    import cadquery as cq

    face = cq.Face.makePlane(1000, 1000, cq.Vector(0, 0, mid), cq.Vector(0, 0, 1)).intersect(carrier).Faces()[0]
    holes = [wire.BoundingBox() for wire in face.innerWires()]
    over = [abs(box.center.x) < plan.fill_outline.length_mm / 2 for box in holes]
    assert len(holes) == 8 and sum(over) == 4
    for box, inside in zip(holes, over):
        if not inside:
            assert abs(box.center.x) - box.xlen / 2 > plan.opening.length_mm / 2
            assert abs(box.center.x) + box.xlen / 2 < plan.top.length_mm / 2 - 1.0


def test_steps_of_spacer_and_carrier_do_not_depend_on_what_was_written_before(layered, boned):
    from dummydesign.mold.files import step
    from dummydesign.mold.produce import step_part

    for made, name in ((layered, "spacer"), (layered, "layer_base"), (boned, "carrier"), (boned, "pad")):
        first = step.step_text([step_part(made, name)], name, "test")
        assert step.step_text([step_part(made, name)], name, "test") == first


def test_curved_faces_survive_step(crowned, boned, tmp_path):
    from dummydesign.mold.files import step
    from dummydesign.mold.produce import step_part

    for made, name in ((crowned, "pad"), (crowned, "mould"), (boned, "carrier"), (boned, "pad")):
        path = tmp_path / f"{name}.step"
        path.write_text(step.step_text([step_part(made, name)], name, "test"), encoding="ascii")
        (again,) = step.read_step(path)
        assert again.valid and again.volume_mm3 == pytest.approx(made.solid(name).Volume(), rel=1e-9)


def test_drawings_dimension_the_curve_and_stay_on_paper(crowned, layered, boned):
    from dummydesign.mold.files import drawing
    from dummydesign.mold.files import drawing_views as section

    heights = {
        "crowned": crowned.plan.face_mm, "layered": layered.plan.interface_mm, "boned": 9.0 * boned.plan.scale,
    }  # fmt: skip
    for made in (crowned, layered, boned):
        paper = section.drawings(made)["mould"]
        assert any(d.vertical and d.value == pytest.approx(heights[made.spec.pad.kind]) for d in paper.dimensions)
        assert any(str(made.spec.pad.kind) in text.words for text in paper.texts)
        for d in paper.dimensions:
            axis = 1 if d.vertical else 0
            assert abs(d.end[axis] - d.start[axis]) / paper.scale == pytest.approx(d.value, abs=1e-9)
        for x, y in (point for line in paper.lines for point in line.points):
            assert 0 <= x <= drawing.SHEET_MM[0] and 0 <= y <= drawing.SHEET_MM[1]


def test_section_across_a_ridge_shows_its_profile():
    from dummydesign.mold.files import drawing_views as section

    spec = _spec("crowned:10,2,0,1", 8.0)
    loops = section.cut_at_x(cavity_solid(spec.pad))
    low = [(y, z) for y, z in loops[0] if z < spec.pad.face_height_mm - 1e-6]
    assert len(low) > 20
    for y, z in low:
        assert z == pytest.approx(float(spec.pad.shape.drop_mm(0.0, y)), abs=1e-6)


# Specification, resin, paper.


def test_equal_shapes_make_equal_specifications_and_a_slab_is_as_it_was():
    typed = [_spec(text, 8.0) for text in ("crowned:10,2", "crowned:height=2,radius=10", "CROWNED:10,2,6,0")]
    assert len({spec.hash for spec in typed}) == 1
    assert typed[0].pad.parameters == (("radius", 10.0), ("height", 2.0), ("foot", 6.0), ("ridge", 0.0))
    assert typed[0].hash != _spec("crowned:10,2,6.1", 8.0).hash != _spec("slab", 8.0).hash
    plain = _spec("slab", 8.0).to_dict()
    assert "base" not in plain and plain["pad"]["parameters"] == [] and _spec("slab", 8.0).tag == "t8"
    assert typed[0].tag == "crowned_t8" and _spec("layered:3,0.4", 8.0).tag == "layered_t8"


def test_layered_specification_survives_json():
    import json

    from dummydesign.mold.model.spec import MouldSpec

    spec = _spec("layered:3,0.4", 8.0)
    assert MouldSpec.from_dict(json.loads(spec.canonical())) == spec


def test_base_is_mixed_to_the_ratio_of_moduli():
    resin = load_resin()
    for wanted in (0.4, 1.0, 3.0):
        spec = _spec(f"layered:3,{wanted}", 8.0)
        found = resin.young_MPa(spec.base.pour.ratio) / resin.young_MPa(spec.pour.ratio)
        assert found == pytest.approx(wanted, rel=1e-9) == pytest.approx(spec.base.modulus_ratio)
    typed = _spec("layered:3,0.4", 8.0, base_ratio=14.5)
    assert typed.base.pour.ratio == 14.5
    assert "modulus_ratio" in {item["code"] for item in pour_warnings(typed, pour_plan(typed))}


def test_masses_come_from_volumes_and_layers_sum_to_the_pad():
    for text, thickness in (("crowned:3,8,9", 15.0), ("bumped:13,6,1.5", 10.0), ("boned:20,6", 15.0)):
        spec = _spec(text, thickness)
        solid = pad_solid(spec.pad).Volume() * layout(spec).scale ** 3
        assert pour_plan(spec).pad_mass_g == pytest.approx(solid * spec.pour.density_g_per_cm3 * 1e-3, rel=1e-9)
    spec = _spec("layered:3,0.4", 8.0)
    plan = pour_plan(spec)
    whole = cavity_solid(spec.pad).Volume() * layout(spec).scale ** 3
    assert plan.cavity_mm3 + plan.base.cavity_mm3 == pytest.approx(whole, rel=1e-9)
    masses = without_cad(spec)["masses_g"]
    assert list(masses) == ["polyol", "isocyanate", "polyol (base)", "isocyanate (base)", "silicone"]
    assert masses["isocyanate (base)"] / masses["polyol (base)"] == pytest.approx(spec.base.pour.ratio / 100, rel=0.05)


TOLD = {
    "crowned:3,8,9": ("tip radius 3, height 8", "layers of at most 0.1 mm", "pour by mass"),
    "bumped:13,6,1.5": ("9 caps", "pockets in the floor keep air", "layers of at most 0.075 mm"),
    "layered:6,0.4": ("UPPER LAYER FIRST", "BASE LAYER SECOND", "spacer", "Gelled at", "still tacky"),
    "boned:20,6": ("prime", "every vent shows resin", "must not float", "stays on its plate", "carrier with the bone"),
    "boned:20,6,0,1": ("bar along the length", "film of gel covers its ends"),
}


@pytest.mark.parametrize("text", TOLD)
def test_pour_sheet_says_what_the_shape_needs(text):
    spec = _spec(text, 15.0)
    plan = pour_plan(spec)
    warnings = pour_warnings(spec, plan)
    written = sheet.to_markdown(sheet.pour_sheet(spec, plan, warnings))
    for words in (*TOLD[text], str(spec.pad.shape), f"{plan.fill_mass_g:.1f} g"):
        assert words in written
    assert [c.id for c in check_process.check_process(spec, plan, warnings) if c.status == "fail"] == []
    told = {"curved_master", "air_pockets", "layer_bond", "bone_air"} & {item["code"] for item in warnings}
    assert told
    for code in told:
        rest = [item for item in warnings if item["code"] != code]
        assert "warnings_told" in [c.id for c in check_process.check_process(spec, plan, rest) if c.status == "fail"]


def test_two_pours_are_weighed_apart_and_in_their_order():
    spec = _spec("layered:6,0.4", 15.0)
    plan = pour_plan(spec)
    written = sheet.to_markdown(sheet.pour_sheet(spec, plan, pour_warnings(spec, plan)))
    assert written.index("UPPER LAYER FIRST") < written.index("Gelled at") < written.index("BASE LAYER SECOND")
    for part in (plan, plan.base):
        for name, mass in part.components:
            assert re.search(rf"\| {name} \| {mass:.1f} \|", written)
    assert f"--ratio {spec.base.pour.ratio:.6g}" in written
    light = replace(plan, base=replace(plan.base, components=(("polyol", 1.0), ("isocyanate", 0.2)), batch_mass_g=1.2))
    failed = [c.id for c in check_process.check_process(spec, light, pour_warnings(spec, plan)) if c.status == "fail"]
    assert "batch_covers_cavity_base" in failed


REFUSED = [
    (["--shape", "crown:10,2"], "did you mean 'crowned'"), (["--shape", "crowned:10"], "needs height"),
    (["--shape", "crowned:5,6"], "no cap that widens"), (["--shape", "crowned:20,7"], "at least 1.5 mm"),
    (["--shape", "puck:3"], "takes no parameters"), (["--shape", "layered:4,0.05"], "allowed is 0.199 to 21"),
    (["--shape", "layered:4,0.4", "--preset", "lidded"], "--preset open"), (["--base-ratio", "14.5"], "layered pad"),
    (["--shape", "boned:20,4", "--preset", "lidded"], "--preset open"),
    (["--shape", "layered:4,0.4", "--base-ratio", "3"], "14.0 to 20.0"), (["--shape", "bumped:5,6,1"], "caps overlap"),
]  # fmt: skip


@pytest.mark.parametrize("arguments, named", REFUSED)
def test_refused_before_cad_with_the_reason(arguments, named, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("dummydesign.mold.runner.make_mold", lambda *a: pytest.fail("CAD was asked"))
    size = ["--thickness", "8", "--length", "60", "--width", "60"]
    assert cli.run(["mold", *size, *arguments]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ") and message.count("\n") == 1 and named in message
    assert list(tmp_path.iterdir()) == []


CHANGES = [
    ("crowned:10,2", {"edge_radius_mm": 4.5}, "edge_radius_mm"),
    ("crowned:10,2,6,1", {"edge_radius_mm": 1.0}, "ridge must be 0"),
    ("boned:20,6,0,1", {"corner_radius_mm": 9.0}, "corner_radius_mm"),
    ("layered:2,0.4", {"edge_radius_mm": 2.5}, "upper layer"),
]


@pytest.mark.parametrize("text, change, named", CHANGES)
def test_edges_and_corners_that_meet_a_curve_are_refused(text, change, named):
    from dummydesign.mold.model.validate import validate

    spec = _spec(text, 15.0)
    with pytest.raises(InputError, match=named):
        validate(replace(spec, pad=replace(spec.pad, **change)))


def test_known_shapes_are_those_of_the_model_and_the_puck():
    for text in ("crowned:10,2", "bumped:13,6,1.5", "layered:3,0.4", "boned:20,6", "slab"):
        kind, parameters = read_kind(text)
        assert mould_spec(10.0, 60.0, 50.0, kind=kind, parameters=parameters).pad.shape == read_shape(text)
    assert mould_spec(30.0, 50.0, 50.0, kind="puck").pad.shape == read_shape("slab")


@pytest.mark.slow
@pytest.mark.parametrize(
    "text, thickness, preset",
    [
        ("crowned:10,2", 5.0, "open"), ("crowned:3,8,9", 15.0, "lidded"), ("crowned:3,8,9,1", 15.0, "open"),
        ("bumped:13,6,1.5,0.2", 10.0, "lidded"), ("layered:8,0.4", 20.0, "open"), ("boned:20,6", 15.0, "open"),
        ("boned:20,6,0,1", 15.0, "open"), ("crowned:1,12,10", 25.0, "open"), ("boned:1,10,14,1", 20.0, "open"),
    ],
)  # fmt: skip
def test_every_shape_is_made_with_all_its_files(text, thickness, preset, tmp_path):
    result = make_mold(_spec(text, thickness, preset=preset), tmp_path)
    assert no_check_fails(result.checks)
    assert all(Path(name).is_file() for name in result.files.values())
    assert Path(result.files["pad"]).name == f"pad_{text.split(':')[0]}_t{thickness:g}.step"
