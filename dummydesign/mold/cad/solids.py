"""Drafted prisms and exact conic solids."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.conic import Conic
from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.model.layout import Outline, PlanPoint

NEAR_MM = 1e-4


def drafted_prism(outline: Outline, height_mm: float, draft_deg: float, z_mm: float = 0.0) -> Any:
    """Make the solid over ``outline`` at ``z_mm`` whose walls move outwards by z tan(draft)."""
    if outline.is_circle:
        flat = cq.Sketch().circle(outline.radius_mm)
    else:
        flat = cq.Sketch().rect(outline.length_mm, outline.width_mm)
        if outline.radius_mm > 0:
            flat = flat.vertices().fillet(outline.radius_mm)
    plane = cq.Workplane("XY", origin=(0, 0, z_mm)).placeSketch(flat)
    # CadQuery's taper narrows when positive; ours widens.
    return plane.extrude(height_mm, taper=-draft_deg).val()


def single_solid(shape: Any) -> Any:
    """Unwrap a boolean's compound when it holds exactly one solid, else return it as it is."""
    solids = shape.Solids()
    return solids[0] if len(solids) == 1 else shape


def cylinders(places: Iterable[PlanPoint], radius_mm: float, height_mm: float, z_mm: float) -> list[Any]:
    """Make upright cylinders of one size about places, from ``z_mm`` upwards."""
    return [cq.Solid.makeCylinder(radius_mm, height_mm, cq.Vector(one.x_mm, one.y_mm, z_mm)) for one in places]


def rough_bounds(shape: Any) -> tuple[float, float, float, float, float, float]:
    """Bounds (x, y, z low, x, y, z high) that surely hold the shape, a hundred times faster than tight ones."""
    box = occ.Bnd_Box()
    occ.BRepBndLib.Add_s(shape.wrapped, box, False)
    return box.Get()


def corners_of(shape: Any) -> list[tuple[float, float, float]]:
    """Places of a shape's vertices, those that several edges share several times. [mm]"""
    points = (occ.BRep_Tool.Pnt_s(occ.TopoDS.Vertex_s(one)) for one in _walk(shape, occ.TopAbs_VERTEX))
    return [(point.X(), point.Y(), point.Z()) for point in points]


def edges_of(face: Any) -> Iterator[tuple[int, Any]]:
    """Edges around a face (``TopoDS_Edge``) with their key, which is the same for the face on the other side.

    The tip of a cone, an edge without length, is none.
    """
    for one in _walk(face, occ.TopAbs_EDGE):
        edge = occ.TopoDS.Edge_s(one)
        if not occ.BRep_Tool.Degenerated_s(edge):
            yield hash(one), edge


def heights_over(points: NDArray, triangles: NDArray, margin: float = 0.0) -> Iterator[tuple[NDArray, NDArray]]:
    """Height at which the vertical through each point meets each triangle, NaN where it does not. [mm]

    ``points`` have shape (n, 2 or 3), ``triangles`` (m, 3, 3); given are some points at a time with their heights,
    shape (k, m). Counted are barycentric coordinates of at least ``margin``.
    """
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    seen = np.abs(area) > 1e-12
    a, u, v, area = a[seen], u[seen], v[seen], area[seen]
    for chunk in np.array_split(points, max(1, len(points) // 200)):
        x, y = chunk[:, :1] - a[:, 0], chunk[:, 1:2] - a[:, 1]
        s, t = (x * v[:, 1] - y * v[:, 0]) / area, (u[:, 0] * y - u[:, 1] * x) / area
        inside = (s >= margin) & (t >= margin) & (s + t <= 1 - margin)
        yield chunk, np.where(inside, a[:, 2] + s * u[:, 2] + t * v[:, 2], np.nan)


def height_range(solid: Any, curved: list[Any]) -> tuple[float, float]:
    """Lowest and highest z of a solid: of its corners, and of those curved faces that reach beyond them. [mm]"""
    heights = [z for _, _, z in corners_of(solid)]
    low, high = min(heights), max(heights)
    for face in curved:
        box = rough_bounds(face)
        if box[2] < low - NEAR_MM or box[5] > high + NEAR_MM:
            # Only here is the tight box, which takes fifty times as long, of use.
            tight = face.BoundingBox(1e-3)
            low, high = min(low, tight.zmin), max(high, tight.zmax)
    return low, high


def _walk(shape: Any, kind: Any) -> Iterator[Any]:
    explorer = occ.TopExp_Explorer(shape.wrapped, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


SPHERE_WITHIN = 1e-12
# One arc would be as exact, but the kernel integrates volumes with a fixed number of points a face; with twelve
# the volume of the steepest ridge holds to 1e-11.
RIDGE_PIECES = 12


def cap_solid(conic: Conic, z_mm: float = 0.0) -> Any:
    """Make the cap that widens upwards from its apex at a height to its flat ``height_mm`` above it."""
    b, c = conic.foot_mm, conic.height_mm
    apex, foot, middle = cq.Vector(0, 0, 0), cq.Vector(b, 0, c), cq.Vector(0, 0, c)
    if abs(conic.factor - 1.0) < SPHERE_WITHIN:
        between = cq.Vector(b / 2, 0, float(conic.sag_mm(np.asarray(b / 2))))
        arc = cq.Edge.makeThreePointArc(apex, between, foot)
    else:
        points, weight = _arc(conic, 0.0, b)
        arc = _bezier(tuple((r, 0.0, z) for r, z in points), weight)
    wire = cq.Wire.assembleEdges([arc, cq.Edge.makeLine(foot, middle), cq.Edge.makeLine(middle, apex)])
    solid = cq.Solid.revolve(wire, [], 360, cq.Vector(0, 0, 0), cq.Vector(0, 0, 1))
    return solid.translate(cq.Vector(0, 0, z_mm))


def ridge_solid(conic: Conic, half_length_mm: float, slope: float, z_mm: float = 0.0) -> Any:
    """Make the ridge along x that widens upwards from its crest at ``z_mm``; its ends lean outwards by ``slope``.

    The ends are planes, on which the profile is again a conic; ruled faces between the two are exact.
    """
    b, c = conic.foot_mm, conic.height_mm
    places = [-b + 2 * b * i / RIDGE_PIECES for i in range(RIDGE_PIECES + 1)]
    wires = []
    for sign in (-1.0, 1.0):

        def end(y: float, z: float, sign: float = sign) -> tuple[float, float, float]:
            return sign * (half_length_mm + slope * z), y, z

        edges = []
        for y0, y1 in pairwise(places):
            points, weight = _arc(conic, y0, y1)
            edges.append(_bezier(tuple(end(y, z) for y, z in points), weight))
        edges.append(cq.Edge.makeLine(cq.Vector(*end(b, c)), cq.Vector(*end(-b, c))))
        wires.append(cq.Wire.assembleEdges(edges))
    return cq.Solid.makeLoft(wires, True).translate(cq.Vector(0, 0, z_mm))


def _arc(conic: Conic, r0: float, r1: float) -> tuple[tuple[tuple[float, float], ...], float]:
    """Control points (r, z) and middle weight of the profile between two radii of either sign."""
    (z0, s0), (z1, s1) = _depth_and_slope(conic, r0), _depth_and_slope(conic, r1)
    # The tangents at both ends meet here.
    r_meet = (z1 - z0 + s0 * r0 - s1 * r1) / (s0 - s1)
    z_meet = z0 + s0 * (r_meet - r0)
    r = (r0 + r1) / 2
    z, _ = _depth_and_slope(conic, r)
    # In barycentric coordinates of the three points a conic obeys l1^2 = 4 w^2 l0 l2.
    area = (r_meet - r0) * (z1 - z0) - (r1 - r0) * (z_meet - z0)
    l1 = ((r - r0) * (z1 - z0) - (r1 - r0) * (z - z0)) / area
    l2 = ((r_meet - r0) * (z - z0) - (r - r0) * (z_meet - z0)) / area
    return ((r0, z0), (r_meet, z_meet), (r1, z1)), math.sqrt(l1**2 / (4 * (1 - l1 - l2) * l2))


def _depth_and_slope(conic: Conic, r: float) -> tuple[float, float]:
    z = float(conic.sag_mm(np.asarray(r)))
    return z, r / (conic.radius_mm - conic.factor * z)


def _bezier(points: tuple[tuple[float, float, float], ...], weight: float) -> Any:
    """Rational quadratic Bezier edge with weights 1, ``weight``, 1."""
    poles, weights = occ.TColgp_Array1OfPnt(1, 3), occ.TColStd_Array1OfReal(1, 3)
    for index, (point, value) in enumerate(zip(points, (1.0, weight, 1.0)), 1):
        poles.SetValue(index, occ.gp_Pnt(*point))
        weights.SetValue(index, value)
    return cq.Edge(occ.BRepBuilderAPI_MakeEdge(occ.Geom_BezierCurve(poles, weights)).Edge())
