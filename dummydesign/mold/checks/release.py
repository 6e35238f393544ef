"""Whether the pad can be taken out: draft on exact faces, rays and wall thickness on the mesh."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.solids import corners_of, heights_over, rough_bounds
from dummydesign.mold.checks import Check, above, equal
from dummydesign.mold.model.layout import Layout, Outline

FLAT = 0.9999
SAMPLES = 7


def faces_within(solid: Any, outline: Outline, low_mm: float, high_mm: float, slack_mm: float = 0.02) -> list[Any]:
    """Faces of a solid whose bounding box lies inside an outline's rectangle and between two heights."""
    across, along = outline.length_mm / 2 + slack_mm, outline.width_mm / 2 + slack_mm

    def holds(x0: float, y0: float, z0: float, x1: float, y1: float, z1: float) -> bool:
        flat = max(-x0, x1) <= across and max(-y0, y1) <= along
        return flat and z0 >= low_mm - slack_mm and z1 <= high_mm + slack_mm

    def inside(face: Any) -> bool:
        # Corners sort out most faces at a tenth of the price of a bounding box.
        if any(abs(x) > across or abs(y) > along for x, y, _ in corners_of(face)):
            return False
        if holds(*rough_bounds(face)):
            return True
        box = face.BoundingBox()
        return holds(box.xmin, box.ymin, box.zmin, box.xmax, box.ymax, box.zmax)

    return [face for face in solid.Faces() if inside(face)]


def minimum_draft_deg(faces: Sequence[Any], up: float = 1.0) -> float:
    """Smallest draft of faces against a pull along z, from the normals of the exact surfaces. [deg]"""
    worst = 90.0
    for face in faces:
        u0, u1, v0, v1 = face._uvBounds()
        # A surface of revolution has no normal from the kernel right at its pole.
        steps = np.linspace(1e-6, 1.0 - 1e-6, SAMPLES)
        grid = [(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t) for s in steps for t in steps]
        normals, _ = face.normals([u for u, _ in grid], [v for _, v in grid])
        rises = (normal.z * up for normal in normals)
        worst = min([worst, *(math.degrees(math.asin(max(-1.0, rise))) for rise in rises if rise < FLAT)])
    return worst


def surface_samples(mesh: Any, chosen: Any, count: int) -> tuple[Any, Any]:
    """Points spread evenly over chosen triangles of a mesh, and the normals there; twice ``count`` at the most.

    Large triangles are split until their edges are shorter than the spacing, so that no patch of a flat
    wall stays unseen; points are the centroids.
    """
    import trimesh

    if len(chosen) == 0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    edge = max(0.2, float(np.sqrt(4.0 * mesh.area_faces[chosen].sum() / count)))
    vertices, faces, origin = trimesh.remesh.subdivide_to_size(
        mesh.vertices, mesh.faces[chosen], max_edge=edge, max_iter=20, return_index=True
    )
    step = max(1, -(-len(faces) // (2 * count)))
    return vertices[faces[::step]].mean(axis=1), mesh.face_normals[chosen][origin[::step]]


def ray_hits(mesh: Any, outline: Outline, low_mm: float, high_mm: float, count: int = 2500) -> int:
    """Count upward rays from a mesh's faces inside a region that meet the mesh again: undercuts.

    Rays start 1e-3 mm in front of points spread over the faces; a face that looks down counts as well. A ray
    that is in the open can only enter material through a face that looks down, so only those are searched.
    """
    centres, normals = mesh.triangles_center, mesh.face_normals
    inside = _within(centres, outline)
    inside &= (centres[:, 2] > low_mm - 1e-6) & (centres[:, 2] < high_mm + 1e-6)
    chosen = np.flatnonzero(inside & (mesh.area_faces > 1e-6))
    points, ways = surface_samples(mesh, chosen, count)
    down = int(np.count_nonzero(ways[:, 2] < -1e-3))
    looking_down = mesh.triangles[(normals[:, 2] < -1e-6) & (centres[:, 2] > low_mm)]
    met = (heights > start[:, 2:3] + 1e-6 for start, heights in heights_over(points + 1e-3 * ways, looking_down, 1e-9))
    return down + sum(int(np.count_nonzero(hit.any(axis=1))) for hit in met)


def thicknesses_mm(triangles: Any, points: Any, normals: Any) -> tuple[Any, Any]:
    """Material behind points of a surface, along the inward normal, and where the ray leaves it.

    Ray against triangle by Moeller and Trumbore, J. Graphics Tools 2 (1997) 21.
    """
    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    outward = np.cross(e1, e2)
    thickness = np.full(len(points), np.inf)
    # What of a triangle depends on the direction alone is worked out once for all rays that share one.
    ways, which = np.unique(-normals, axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    for way, rays in zip(ways, np.split(order, np.cumsum(np.bincount(which.ravel(), minlength=len(ways)))[:-1])):
        # An exit is a face that the ray meets from behind; its determinant is away from zero.
        ahead = outward @ way > 1e-12
        across, along = np.cross(way, e2[ahead]), np.cross(e1[ahead], way)
        det = np.einsum("ij,ij->i", e1[ahead], across)
        for some in np.array_split(rays, -(-len(rays) * len(det) // MOST_PAIRS) or 1):
            start = points[some] + 1e-4 * way
            u, v, t = (_over(start, side / det[:, None], a[ahead]) for side in (across, along, outward[ahead]))
            hit = (u >= -ON_EDGE) & (v >= -ON_EDGE) & (u + v <= 1 + ON_EDGE) & (t > 1e-3)
            thickness[some] = np.where(hit, t, np.inf).min(axis=1, initial=np.inf)
    return thickness, points - np.where(np.isfinite(thickness), thickness, 0.0)[:, None] * normals


MOST_PAIRS, ON_EDGE = 500_000, 1e-12
"""Rays times triangles at a time, and what a ray may miss a triangle by, so that none slips between two of them."""


def _over(points: Any, sides: Any, origins: Any) -> Any:
    """Products of (point - origin) with the side of each triangle; shape (points, triangles)."""
    return points @ sides.T - np.einsum("ij,ij->i", origins, sides)


def sweep_interference_mm3(moving: Any, still: Any, offsets_mm: Sequence[float]) -> float:
    """Largest common volume while one solid is pulled along +z through given offsets. [mm3]"""
    return max(common_volume_mm3(moving.translate(cq.Vector(0, 0, offset)), still) for offset in offsets_mm)


def common_volume_mm3(one: Any, other: Any) -> float:
    """Common volume of two solids, 0 when they only touch. [mm3]"""
    a, b = rough_bounds(one), rough_bounds(other)
    if any(a[axis] > b[axis + 3] or b[axis] > a[axis + 3] for axis in range(3)):
        return 0.0
    return abs(one.intersect(other).Volume())


WALL_SLACK_MM, RAYS = 0.06, 400
# Upward part of a floor's normal, up to slopes of 72 degrees: steeper is wall.
UPWARD = 0.3
# On a coarser mesh the facets of a drafted corner may lean over by more than the draft.
FINE = (0.02, 0.1)


def check_mould_mesh(made: Parts, mould: Any, fine: Any) -> list[Check]:
    """No ray leaves the cavity blocked; wall and floor are as thick as specified."""
    spec, plan = made.spec, made.plan
    hits = ray_hits(fine, plan.openings, -0.01, plan.land_mm)
    checks = [equal("rays_blocked", hits, 0, "upward rays from the cavity that meet the mould")]
    centres, normals = mould.triangles_center, mould.face_normals
    inside = _within(centres, plan.openings)
    # A pocket that is too deep must not escape, so the floor is looked for down to the underside.
    inside &= (centres[:, 2] < plan.land_mm - 1e-3) & (mould.area_faces > 1e-4)
    side = np.flatnonzero(inside & (centres[:, 2] > -0.01) & (np.abs(normals[:, 2]) < 0.2))
    floor = np.flatnonzero(inside & (normals[:, 2] > UPWARD) & (centres[:, 2] < plan.depth_mm - 0.5))
    # A ray that leaves below all that is cut into the land met the outside; those cuts have checks of their own, and
    # what lies above them is left out: the label alone is most of the mesh.
    keys = 0.0 if spec.closure is None else spec.closure.key_radius_mm + 1.0
    cut = plan.land_mm - max(keys, spec.body.label_depth_mm + 0.05)
    met = mould.triangles[(mould.triangles[..., 2].min(axis=1) < cut) | _near_side(centres, plan)]
    walls, exits = thicknesses_mm(met, *surface_samples(mould, side, RAYS))
    outside = np.isfinite(walls) & ((exits[:, 2] < cut) | _near_side(exits, plan))
    least = float(walls[outside].min()) if outside.any() else 0.0
    checks.append(above("wall_thickness", least, spec.body.wall_mm - WALL_SLACK_MM, f"mm, {outside.sum()} rays"))
    # Straight down: under a curved floor the normal would lead past the thinnest place.
    places, ways = surface_samples(mould, floor, RAYS)
    floors, _ = thicknesses_mm(mould.triangles, places, np.tile((0.0, 0.0, 1.0), (len(ways), 1)))
    least = float(floors.min()) if len(floors) else 0.0
    checks.append(above("floor_thickness", least, spec.body.floor_mm - WALL_SLACK_MM, f"mm, {len(floors)} rays"))
    return checks


def _near_side(points: Any, plan: Layout) -> Any:
    """Which points lie on the outer side of the block."""
    return ~_within(points, plan.top.grown(-1.0))


def _within(points: Any, outline: Outline) -> Any:
    """Which points lie inside an outline's rectangle."""
    return (np.abs(points[:, 0]) < outline.length_mm / 2) & (np.abs(points[:, 1]) < outline.width_mm / 2)
