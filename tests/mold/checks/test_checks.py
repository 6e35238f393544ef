"""The checks pass on good moulds and fail on bad ones: each negative control breaks one thing on purpose."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.mold.cad.build import brim_tool, pad_solid
from dummydesign.mold.cad.solids import drafted_prism, single_solid
from dummydesign.mold.checks import process as check_process
from dummydesign.mold.checks import release as check_mesh
from dummydesign.mold.checks import release as demould
from dummydesign.mold.checks import solids as check
from dummydesign.mold.files.meshes import tessellate
from dummydesign.mold.model.layout import Outline, layout
from dummydesign.mold.pour.plan import above_fill_mm3, pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import failed


@pytest.mark.slow
def test_all_checks_of_an_open_mould_pass(open_parts):
    checks = check.check_solids(open_parts)
    assert failed(checks) == []
    assert {"cavity_volume", "closed_form", "draft_cavity", "sweep_cavity", "silicone_in_box_mould"} <= {
        item.id for item in checks
    }


@pytest.mark.slow
def test_all_checks_of_a_lidded_mould_pass(lidded_parts):
    checks = check.check_solids(lidded_parts)
    assert failed(checks) == []
    assert {"lid_one_way", "features_apart", "gutter_to_cavity", "silicone_in_box_lid"} <= {c.id for c in checks}


def _mesh_checks(made, mould):
    return check_mesh.check_mould_mesh(made, tessellate(mould), tessellate(mould, *check_mesh.FINE))


@pytest.mark.slow
def test_mesh_checks_pass_on_good_moulds(open_parts, lidded_parts):
    for made in (open_parts, lidded_parts):
        assert failed(_mesh_checks(made, made.solid("mould"))) == []


def _bad_mould(made, pad=None, lip=None):
    """A block with another cavity, or with something fused into its cavity."""
    solid = made.hull.cut(pad, brim_tool(made.spec, made.plan)) if pad is not None else made.solid("mould")
    return single_solid(solid.fuse(lip) if lip is not None else solid)


def _measures(made, mould, pad):
    plan = made.plan
    fine = tessellate(mould, *check_mesh.FINE)
    return {
        "draft": check.cavity_draft_deg(mould, made),
        "rays": demould.ray_hits(fine, plan.opening, -0.01, plan.land_mm),
        "sweep": demould.sweep_interference_mm3(pad, mould, check.sweep_offsets_mm(plan.depth_mm)),
    }


@pytest.mark.slow
def test_good_cavity_reads_its_draft_and_nothing_else(open_parts):
    found = _measures(open_parts, open_parts.solid("mould"), open_parts.solid("pad"))
    assert found["draft"] == pytest.approx(2.0, abs=1e-6)
    assert found["rays"] == 0 and found["sweep"] < 1e-6


@pytest.mark.slow
def test_negative_draft_fails_draft_rays_and_sweep(open_parts):
    spec = replace(open_parts.spec, pad=replace(open_parts.spec.pad, draft_deg=-2.0))
    pad = pad_solid(spec.pad).scale(layout(spec).scale)
    found = _measures(open_parts, _bad_mould(open_parts, pad), pad)
    assert found["draft"] == pytest.approx(-2.0, abs=1e-6)
    assert found["rays"] > 0 and found["sweep"] > 1.0


@pytest.mark.slow
def test_zero_draft_passes_rays_and_sweep_but_not_the_draft_gate(open_parts):
    spec = replace(open_parts.spec, pad=replace(open_parts.spec.pad, draft_deg=0.0))
    pad = pad_solid(spec.pad).scale(layout(spec).scale)
    found = _measures(open_parts, _bad_mould(open_parts, pad), pad)
    assert abs(found["draft"]) < 1e-6
    assert found["rays"] == 0 and found["sweep"] < check.INTERFERENCE_MM3
    assert found["draft"] < open_parts.spec.pad.draft_deg - check.DRAFT_SLACK_DEG


@pytest.mark.slow
def test_inward_lip_fails_rays_and_sweep(open_parts):
    plan = open_parts.plan
    outer = drafted_prism(plan.fill_outline.grown(1.0), 1.0, 0.0, plan.depth_mm - 1.0)
    lip = outer.cut(drafted_prism(plan.floor_outline.grown(-1.5), 3.0, 0.0, plan.depth_mm - 2.0))
    mould = _bad_mould(open_parts, lip=lip)
    pad = open_parts.solid("pad").cut(lip)
    found = _measures(open_parts, mould, pad)
    assert found["rays"] > 0 and found["sweep"] > 1.0 and found["draft"] < 0
    assert "rays_blocked" in " ".join(failed(_mesh_checks(open_parts, mould)))


@pytest.mark.slow
def test_closed_hole_through_the_pad_fails_rays_and_sweep(open_parts):
    import cadquery as cq

    plan = open_parts.plan
    rod = cq.Solid.makeCylinder(2.0, 80.0, cq.Vector(-40, 0, plan.depth_mm / 2), cq.Vector(1, 0, 0))
    mould = single_solid(open_parts.solid("mould").fuse(rod.intersect(open_parts.solid("pad"))))
    found = _measures(open_parts, mould, open_parts.solid("pad").cut(rod))
    assert found["rays"] > 0 and found["sweep"] > 1.0


@pytest.mark.slow
def test_lid_turned_round_collides(lidded_parts):
    import cadquery as cq

    lid, mould = lidded_parts.solid("lid"), lidded_parts.solid("mould")
    assert demould.common_volume_mm3(lid, mould) < check.INTERFERENCE_MM3
    turned = lid.rotate(cq.Vector(), cq.Vector(0, 0, 1), 180)
    assert demould.common_volume_mm3(turned, mould) > 100.0


@pytest.mark.slow
def test_lid_with_symmetric_keys_fails_the_one_way_check(lidded_parts):
    from dummydesign.mold.cad.casting_box import ball

    land, keys = lidded_parts.plan.land_mm, lidded_parts.plan.keys[:2]
    places = [*keys, *(type(key)(-key.x_mm, -key.y_mm) for key in keys)]
    block, hull = lidded_parts.hull, lidded_parts.tools["lid_hull"][0]
    mould = block.cut(lidded_parts.solid("pad"), *[ball(place, land, 3.15) for place in places])
    lid = hull.fuse(*[ball(place, land, 3.0) for place in places])
    assert check.lid_one_way(lid, mould).status == "fail"


@pytest.mark.slow
def test_lid_moved_sideways_fails_interference(lidded_parts):
    import cadquery as cq

    lid = lidded_parts.solid("lid").translate(cq.Vector(1.0, 0, 0))
    assert demould.common_volume_mm3(lid, lidded_parts.solid("mould")) > 1.0


def test_wrong_compensation_is_seen(open_parts):
    from dummydesign.mold.cad.parts import Parts

    wrong = Parts(open_parts.spec, open_parts.plan, open_parts.pad_nominal.scale(1.001))
    wrong.parts, wrong.tools, wrong.hull = open_parts.parts, open_parts.tools, open_parts.hull
    assert any("compensation" in text for text in failed(check.check_volumes(wrong)))


@pytest.mark.slow
def test_missing_label_on_the_master_is_seen(open_parts):
    from dummydesign.mold.cad.parts import Parts

    plan, grow = open_parts.plan, open_parts.plan.silicone_scale
    deep = open_parts.spec.body.label_depth_mm
    ring = drafted_prism(plan.top, deep * 2, 0.0).cut(drafted_prism(plan.opening.scaled(grow).grown(0.5), 5.0, 0.0))
    bald = open_parts.solid("master").cut(ring)
    other = Parts(open_parts.spec, plan, open_parts.pad_nominal, dict(open_parts.parts), open_parts.tools)
    other.hull = open_parts.hull
    other.parts["master"] = replace(other.parts["master"], solid=bald)
    assert any("label_reads_right" in text for text in failed(check.check_label(other)))
    assert any("silicone_in_box" in text for text in failed(check.check_boxes(other)))


def test_thin_wall_and_floor_are_seen(open_parts):
    made = open_parts
    pocket = drafted_prism(Outline(20, 10, 1), 3.0, 0.0, -made.spec.body.floor_mm - 1.0)
    groove = drafted_prism(Outline(4, 40, 1), 30.0, 0.0, -5.0).translate((made.plan.top.length_mm / 2, 0, 0))
    thin = single_solid(made.solid("mould").cut(pocket, groove))
    found = {c.id: c for c in _mesh_checks(made, thin)}
    assert found["wall_thickness"].status == found["floor_thickness"].status == "fail"
    assert found["floor_thickness"].value == pytest.approx(made.spec.body.floor_mm - 2.0, abs=0.05)
    assert found["wall_thickness"].value == pytest.approx(made.spec.body.wall_mm - 2.0, abs=0.2)


@pytest.mark.slow
def test_features_that_touch_are_seen(lidded_parts):
    from dummydesign.mold.cad.parts import Parts

    made = lidded_parts
    near = Parts(made.spec, made.plan, made.pad_nominal, made.parts, dict(made.tools))
    near.tools["vents"] = [made.tools["gutter"][0], *made.tools["vents"]]
    assert any("features_apart" in text for text in failed(check.check_distances(near)))


def _process(spec, plan=None, drop=()):
    plan = plan or pour_plan(spec)
    told = [item for item in pour_warnings(spec, plan) if item["code"] not in drop]
    return " ".join(failed(check_process.check_process(spec, plan, told)))


def test_process_checks_fail_on_what_cannot_be_poured(open_spec):
    plan = pour_plan(open_spec)
    assert _process(open_spec) == ""
    assert "pot_life" in _process(
        replace(open_spec, pour=replace(open_spec.pour, pot_life_min=8.1, viscosity_Pa_s=300.0))
    )
    assert "tray_growth_room" in _process(replace(open_spec, aids=replace(open_spec.aids, tray_clearance_mm=0.1)))
    assert "wall_deflection" in _process(replace(open_spec, silicone=replace(open_spec.silicone, young_MPa=1e-6)))
    assert "cup_fits_chamber" in _process(
        replace(open_spec, machines=replace(open_spec.machines, chamber_height_mm=30.0))
    )
    short = replace(plan, components=(("polyol", 10.0), ("isocyanate", 1.5)), batch_mass_g=11.5)
    assert "batch_covers" in _process(open_spec, short)
    assert "weights_sum" in _process(open_spec, replace(plan, components=(("polyol", 26.03), ("isocyanate", 3.9))))
    assert "warnings_told" in _process(open_spec, drop=("meniscus",))


@pytest.mark.slow
def test_stems_hold_what_the_funnels_of_the_lid_hold(lidded_parts):
    hull = lidded_parts.tools["lid_hull"][0]
    funnels = [*lidded_parts.tools["sprue"], *lidded_parts.tools["vents"]]
    held = sum(tool.intersect(hull).Volume() for tool in funnels)
    assert above_fill_mm3(lidded_parts.spec, lidded_parts.spec.pour) == pytest.approx(held, rel=1e-9)


def test_parts_scale_as_their_factors_say(open_parts):
    plan = open_parts.plan
    assert open_parts.solid("pad").Volume() == pytest.approx(open_parts.pad_nominal.Volume() * plan.scale**3, rel=1e-12)
    master, mould = open_parts.solid("master").BoundingBox(), open_parts.solid("mould").BoundingBox()
    assert master.zmax == pytest.approx(plan.land_mm * plan.silicone_scale, abs=1e-6)
    assert mould.zmax == pytest.approx(plan.land_mm, abs=1e-6)


def test_strike_off_leaves_the_pad_at_its_thickness(open_parts):
    plate, pad = open_parts.solid("strike_off").BoundingBox(), open_parts.solid("pad").BoundingBox()
    assert plate.zmin == pytest.approx(pad.zmax, abs=1e-6) == pytest.approx(open_parts.plan.depth_mm, abs=1e-6)


def test_collar_is_built_for_degassing_in_the_mould(open_spec):
    from dummydesign.mold.cad.build import collar

    spec = replace(open_spec, pour=replace(open_spec.pour, degas="mould"))
    ring = collar(spec, layout(spec))
    assert ring.isValid() and len(ring.Solids()) == 1
    assert ring.BoundingBox().zmax == pytest.approx(layout(spec).land_mm + 3 * layout(spec).depth_mm)


@pytest.mark.slow
def test_puck_is_a_plain_cylinder_whose_mould_passes():
    import math

    from dummydesign.mold.cad.build import build
    from dummydesign.mold.model.preset import mould_spec

    made = build(mould_spec(30.0, 50.0, 50.0, kind="puck"))
    assert made.pad_nominal.Volume() == pytest.approx(math.pi * 25**2 * 30, rel=1e-12)
    assert failed(check.check_solids(made)) == []


def test_what_a_pad_meets_of_its_mould_is_met_of_its_core(open_parts):
    """A pad pushed a millimetre aside cuts as much of the core as of the whole mould, of which the core is a part."""
    import cadquery as cq

    made = open_parts
    pad = made.solid("pad").translate(cq.Vector(0.5, 0.2, 0.4))
    whole, core = (demould.common_volume_mm3(pad, solid) for solid in (made.mould, made.core))
    assert whole > 10.0 and core == pytest.approx(whole, rel=1e-9)
    assert made.core.Volume() < made.mould.Volume() and len(made.core.Faces()) < 60 < len(made.mould.Faces())


def test_points_are_told_inside_a_mesh_from_those_in_its_hole():
    import cadquery as cq
    import numpy as np

    from dummydesign.mold.checks.solids import inside_mesh

    plate = cq.Solid.makeBox(10, 10, 2).cut(cq.Solid.makeBox(4, 4, 5).translate(cq.Vector(3, 3, -1)))
    points = np.array([(5.0, 5.0, 1.0), (1.0, 5.0, 1.0), (5.0, 9.0, 1.9), (1.0, 1.0, 2.1), (-1.0, 5.0, 1.0)])
    assert inside_mesh(tessellate(plate), points).tolist() == [False, True, True, False, False]
