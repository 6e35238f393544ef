"""Corners, edges and heights of solids are those that the kernel's slower ways give."""

from __future__ import annotations

import pytest

from dummydesign.mold.cad.solids import corners_of, edges_of, height_range


def _curved(solid):
    return [face for face in solid.Faces() if face.geomType() != "PLANE"]


def test_heights_reach_over_a_dome_whose_top_has_no_corner():
    import cadquery as cq

    ball = cq.Solid.makeSphere(5.0).rotate(cq.Vector(), cq.Vector(1, 0, 0), 90)
    rod = cq.Solid.makeCylinder(2.0, 10.0, cq.Vector(), cq.Vector(1, 0, 0))
    lying = rod.rotate(cq.Vector(), cq.Vector(1, 0, 0), 40)
    assert height_range(ball, _curved(ball)) == pytest.approx((-5.0, 5.0), abs=1e-3)
    assert height_range(lying, _curved(lying)) == pytest.approx((-2.0, 2.0), abs=1e-3)


def test_edges_of_both_faces_at_an_edge_have_one_key_and_the_tip_of_a_cone_is_none():
    import cadquery as cq

    box, cone = cq.Solid.makeBox(1, 2, 3), cq.Solid.makeCone(3.0, 0.0, 4.0)
    assert len({key for face in box.Faces() for key, _ in edges_of(face)}) == 12
    assert len({key for face in cone.Faces() for key, _ in edges_of(face)}) == 2
    assert {tuple(round(x, 9) for x in corner) for corner in corners_of(box)} == {
        (x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)
    }
