"""Solids of shaped pads: their closed forms, true spheres, profiles, and the holes of a carrier."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dummydesign.geometry.conic import Conic
from dummydesign.mold.cad.build import pad_solid
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks import solids as check_shape
from dummydesign.mold.model.layout import layout, slab_volume_mm3
from tests.support.mould_checks import failed, shape_spec


def _top_by_heights(spec, count: int = 600) -> float:
    """Volume over the flat from the heights the finite-element model uses, on a midpoint grid; no draft."""
    pad = spec.pad
    x = (np.arange(count) + 0.5) * pad.length_mm / count - pad.length_mm / 2
    y = (np.arange(count) + 0.5) * pad.width_mm / count - pad.width_mm / 2
    x, y = np.meshgrid(x, y)
    drop = np.min([pad.shape.drop_mm(x - at, y - across) for at, across in pad.shape.places_mm], axis=0)
    rise = pad.face_height_mm - drop + pad.shape.bone_mm(x, y)
    return float(rise.mean() * pad.length_mm * pad.width_mm)


CURVED = [
    "crowned:10,2",
    "crowned:3,8,9",
    "crowned:5,3,5.5",
    "boned:20,6",
    "crowned:10,2,6,0,2,1,20",
]


@pytest.mark.parametrize("text", CURVED)
def test_what_a_shape_adds_is_the_integral_of_its_heights(text):
    spec = shape_spec(text, 15.0)
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
    ("crowned:10,2", 5.0),
    ("crowned:3,8,9", 15.0),
    ("crowned:1,12,10", 20.0),
    ("crowned:5,3,5.477225575051661", 8.0),
    ("crowned:10,2,0,1", 5.0),
    ("crowned:3,8,9,1", 15.0),
    ("boned:20,6", 15.0),
    ("boned:8,4,14", 15.0),
    ("boned:20,6,0,1", 15.0),
    ("boned:8,4,14,1", 15.0),
    ("layered:3,0.4", 8.0),
    ("crowned:10,2,6,0,2,1,20", 5.0),
]


@pytest.mark.slow
@pytest.mark.parametrize("text, thickness", SOLIDS)
def test_solid_of_a_shape_has_its_closed_form_and_its_height(text, thickness):
    spec = shape_spec(text, thickness)
    pad, solid = spec.pad, pad_solid(spec.pad)
    plain = slab_volume_mm3(
        layout(spec).floor_outline.scaled(1 / layout(spec).scale),
        thickness - pad.face_height_mm,
        pad.draft_deg,
        pad.edge_radius_mm,
    )
    exact = plain + pad.shape.top_volume_mm3(pad) - pad.shape.bone_volume_mm3(pad)
    assert solid.Volume() == pytest.approx(exact, rel=check.VOLUME_REL)
    assert solid.isValid() and len(solid.Solids()) == 1
    bounds = solid.BoundingBox()
    assert (bounds.zmin, bounds.zmax) == pytest.approx((0.0, thickness), abs=1e-6)
    if text.split(":")[0] != "layered":
        assert failed([check_shape.face_profile(Parts(spec, layout(spec), solid))]) == []


def test_sphere_gets_a_true_sphere_face():
    for text in ("crowned:10,2", "boned:20,6"):
        kinds = [face.geomType() for face in pad_solid(shape_spec(text, 15.0).pad).Faces()]
        assert kinds.count("SPHERE") == 1


def test_flat_and_other_curves_fail_the_profile_check():
    spec = shape_spec("crowned:10,2", 8.0)
    right = pad_solid(spec.pad)
    wrong = [pad_solid(shape_spec(text, 8.0).pad) for text in ("slab", "crowned:10.01,2,6", "crowned:10,2,6.01")]
    for solid in (*wrong, right.translate((0, 0, 1e-4)), right.translate((1e-3, 0, 0))):
        assert failed([check_shape.face_profile(Parts(spec, layout(spec), solid))])


@pytest.mark.slow
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
