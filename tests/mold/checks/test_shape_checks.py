"""Checks of the moulds of shaped pads: good ones pass, and what is wrong is seen."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.mold.cad.build import brim_tool, build, pad_solid
from dummydesign.mold.cad.solids import single_solid
from dummydesign.mold.checks import release as check_mesh
from dummydesign.mold.checks import release as demould
from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks import solids as check_shape
from dummydesign.mold.files.meshes import tessellate
from tests.support.mould_checks import failed, named, shape_spec


@pytest.mark.slow
def test_all_checks_of_a_crowned_mould_pass(crowned):
    checks = check.check_solids(crowned) + check_shape.check_shape(crowned)
    fine = tessellate(crowned.solid("mould"), *check_mesh.FINE)
    checks += check_mesh.check_mould_mesh(crowned, tessellate(crowned.solid("mould")), fine)
    assert failed(checks) == []
    assert {"face_profile", "closed_form", "floor_thickness"} <= set(named(checks))
    assert named(checks)["floor_thickness"].value == pytest.approx(crowned.spec.body.floor_mm, abs=0.06)


@pytest.mark.slow
def test_all_checks_of_a_boned_mould_pass(boned):
    checks = check.check_solids(boned) + check_shape.check_shape(boned)
    assert failed(checks) == []
    wanted = {"bone_volume", "gel_and_bone", "bone_cover", "interference_carrier_mould", "interference_carrier_pad"}
    assert wanted <= set(named(checks)) and "strike_off" not in boned.parts


@pytest.mark.slow
def test_shape_checks_of_a_layered_mould_pass(layered):
    checks = check_shape.check_shape(layered) + check.check_validity(layered) + check.check_volumes(layered)
    assert failed(checks) == []
    assert {"layers_fill_cavity", "layer_closed_form", "spacer_height"} <= set(named(checks))
    common = demould.common_volume_mm3(layered.solid("spacer"), layered.solid("mould"))
    assert common < check.INTERFERENCE_MM3


OTHERS = [("crowned:10,2,0,1", 8.0), ("boned:20,6,0,1", 15.0)]


@pytest.mark.slow
@pytest.mark.parametrize("text, thickness", OTHERS)
def test_volumes_drafts_and_shape_of_the_other_moulds_pass(text, thickness):
    made = build(shape_spec(text, thickness))
    checks = check.check_validity(made) + check.check_volumes(made) + check.check_drafts(made)
    checks += check_shape.check_shape(made)
    assert failed(checks) == []


@pytest.mark.slow
def test_pocket_near_the_underside_fails_the_floor_check(crowned):
    import cadquery as cq

    floor = crowned.spec.body.floor_mm
    for left, most in ((3.0, 3.4), (-1.0, 1.0)):
        low = crowned.solid("pad").translate(cq.Vector(0, 0, left - floor))
        thin = single_solid(crowned.hull.cut(low, crowned.solid("pad"), brim_tool(crowned.spec, crowned.plan)))
        rough = tessellate(thin, 0.2, 0.5)
        found = named(check_mesh.check_mould_mesh(crowned, rough, rough))["floor_thickness"]
        assert found.status == "fail" and found.value < most


@pytest.mark.slow
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
    fine = tessellate(mould, *check_mesh.FINE)
    assert demould.ray_hits(fine, plan.opening, -0.01, plan.land_mm) > 0
    assert demould.sweep_interference_mm3(pad, mould, check.sweep_offsets_mm(plan.depth_mm)) > 1.0


def _moved(made, name, up_mm):
    import cadquery as cq

    part = made.parts[name]
    parts = {**made.parts, name: replace(part, solid=part.solid.translate(cq.Vector(0, 0, up_mm)))}
    return replace(made, parts=parts)


@pytest.mark.slow
def test_spacer_at_the_wrong_height_is_seen(layered):
    low, high = _moved(layered, "spacer", -0.2), _moved(layered, "spacer", 0.2)
    assert named(check_shape.check_shape(high))["spacer_height"].status == "fail"
    found = named(check_shape.check_shape(low))
    assert found["spacer_height"].status == found["interference_spacer_layer_top"].status == "fail"


@pytest.mark.slow
def test_layers_that_leave_a_gap_are_seen(layered):
    from dummydesign.mold.cad.solids import drafted_prism

    gap = drafted_prism(layered.plan.top, 0.1, 0.0, layered.plan.interface_mm)
    part = layered.parts["layer_base"]
    parts = {**layered.parts, "layer_base": replace(part, solid=single_solid(part.solid.cut(gap)))}
    assert named(check_shape.check_shape(replace(layered, parts=parts)))["layers_fill_cavity"].status == "fail"


@pytest.mark.slow
def test_bone_that_touches_the_tested_face_is_seen(boned):
    cover = boned.plan.scale * boned.spec.pad.least_gel_mm
    low = _moved(boned, "carrier", -cover)
    assert low.solid("carrier").BoundingBox().zmin == pytest.approx(0.0, abs=1e-6)
    found = named(check_shape.check_shape(low) + check.check_interference(low))
    for name in ("bone_cover", "bone_volume", "interference_carrier_pad", "interference_carrier_mould"):
        assert found[name].status == "fail", name
