"""Exact solids of conic profiles: round caps and drawn-out ridges. CadQuery is imported inside.

A conic arc is a rational quadratic Bezier curve, so nothing is approximated; a sphere gets a true sphere face.
References: L. Piegl, W. Tiller, The NURBS Book, section 7.3.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

from dummydesign.geometry.conic import Conic

SPHERE_WITHIN = 1e-12
# One arc would be as exact, but the kernel integrates volumes with a fixed number of points a face; with twelve
# the volume of the steepest ridge holds to 1e-11.
RIDGE_PIECES = 12


def cap_solid(conic: Conic, x_mm: float = 0.0, y_mm: float = 0.0, z_mm: float = 0.0) -> Any:
    """Make the cap that widens upwards from its apex at a place to its flat ``height_mm`` above it.

    Parameters
    ----------
    conic : Conic
        Profile from the apex outwards.
    x_mm, y_mm, z_mm : float
        Where the apex lies. [mm]

    Returns
    -------
    cadquery.Solid
    """
    import cadquery as cq

    b, c = conic.foot_mm, conic.height_mm
    apex, foot, middle = cq.Vector(0, 0, 0), cq.Vector(b, 0, c), cq.Vector(0, 0, c)
    if abs(conic.factor - 1.0) < SPHERE_WITHIN:
        between = cq.Vector(b / 2, 0, float(conic.sag_mm(b / 2)))
        arc = cq.Edge.makeThreePointArc(apex, between, foot)
    else:
        points, weight = _arc(conic, 0.0, b)
        arc = _bezier(tuple((r, 0.0, z) for r, z in points), weight)
    wire = cq.Wire.assembleEdges([arc, cq.Edge.makeLine(foot, middle), cq.Edge.makeLine(middle, apex)])
    solid = cq.Solid.revolve(wire, [], 360, cq.Vector(0, 0, 0), cq.Vector(0, 0, 1))
    return solid.translate(cq.Vector(x_mm, y_mm, z_mm))


def ridge_solid(conic: Conic, half_length_mm: float, slope: float, z_mm: float = 0.0) -> Any:
    """Make the ridge along x that widens upwards from its crest at ``z_mm``; its ends lean outwards by ``slope``.

    The ends are planes, on which the profile is again a conic; ruled faces between the two are exact.

    Parameters
    ----------
    conic : Conic
        Profile across the ridge, from its crest outwards.
    half_length_mm : float
        Half the length of the crest, along x. [mm]
    slope : float
        Tangent of the draft angle: how far an end moves outwards per height.
    z_mm : float
        Height of the crest. [mm]

    Returns
    -------
    cadquery.Solid
    """
    import cadquery as cq

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
    z = float(conic.sag_mm(r))
    return z, r / (conic.radius_mm - conic.factor * z)


def _bezier(points: tuple[tuple[float, float, float], ...], weight: float) -> Any:
    """Rational quadratic Bezier edge with weights 1, ``weight``, 1."""
    import cadquery as cq
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.Geom import Geom_BezierCurve
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array1OfPnt
    from OCP.TColStd import TColStd_Array1OfReal

    poles, weights = TColgp_Array1OfPnt(1, 3), TColStd_Array1OfReal(1, 3)
    for index, (point, value) in enumerate(zip(points, (1.0, weight, 1.0)), 1):
        poles.SetValue(index, gp_Pnt(*point))
        weights.SetValue(index, value)
    return cq.Edge(BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles, weights)).Edge())
