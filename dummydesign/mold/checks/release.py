"""Can it be taken out? Draft on the exact faces, rays and wall thickness on the mesh, a swept pull. CAD child only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from dummydesign.mold.cad.prisms import corners_of, rough_bounds
from dummydesign.mold.model.outline import Outline

FLAT = 0.9999
SAMPLES = 7


def faces_within(solid: Any, outline: Outline, low_mm: float, high_mm: float, slack_mm: float = 0.02) -> list[Any]:
    """Faces of a solid whose bounding box lies inside an outline's rectangle and between two heights.

    Parameters
    ----------
    solid : cadquery.Solid
        The part, centred on the z axis. [mm]
    outline : Outline
        Its rectangle counts, about the z axis.
    low_mm, high_mm, slack_mm : float
        Heights between which the face lies, and how far it may stand out of the region. [mm]

    Returns
    -------
    list of cadquery.Face
    """
    found = []
    across, along = outline.length_mm / 2 + slack_mm, outline.width_mm / 2 + slack_mm
    for face in solid.Faces():
        # Corners sort out most faces at a tenth of the price of a bounding box.
        if any(abs(x) > across or abs(y) > along for x, y, _ in corners_of(face)):
            continue
        box = face.BoundingBox()
        flat = max(abs(box.xmin), abs(box.xmax)) <= across and max(abs(box.ymin), abs(box.ymax)) <= along
        if flat and box.zmin >= low_mm - slack_mm and box.zmax <= high_mm + slack_mm:
            found.append(face)
    return found


def minimum_draft_deg(faces: Sequence[Any], up: float = 1.0) -> float:
    """Smallest draft of faces against a pull along z, from the normals of the exact surfaces.

    Parameters
    ----------
    faces : sequence of Face
        Faces that touch what is pulled out.
    up : float
        +1 when it leaves along +z, -1 along -z.

    Returns
    -------
    float
        min asin(n . pull) over a grid on each face, flat faces across the pull left out; negative is an
        undercut. [deg]
    """
    import numpy as np

    worst = 90.0
    for face in faces:
        u0, u1, v0, v1 = face._uvBounds()
        # A surface of revolution has no normal from the kernel right at its pole.
        steps = np.linspace(1e-6, 1.0 - 1e-6, SAMPLES)
        grid = [(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t) for s in steps for t in steps]
        normals, _ = face.normals([u for u, _ in grid], [v for _, v in grid])
        for normal in normals:
            rise = normal.z * up
            if rise < FLAT:
                worst = min(worst, math.degrees(math.asin(max(-1.0, rise))))
    return worst


def surface_samples(mesh: Any, chosen: Any, count: int) -> tuple[Any, Any]:
    """Points spread evenly over chosen triangles of a mesh, and the normals there; twice ``count`` at the most.

    Large triangles are split until their edges are shorter than the spacing, so that no patch of a flat
    wall stays unseen; points are the centroids.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        The surface. [mm]
    chosen : ndarray of int, shape (k,)
        Triangles to sample.
    count : int
        Points wanted.

    Returns
    -------
    ndarray, ndarray
        Points and outward unit normals, each of shape (n, 3). [mm]
    """
    import numpy as np
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

    Parameters
    ----------
    mesh : trimesh.Trimesh
        A closed surface. [mm]
    outline : Outline
        Rays start within its rectangle, about the z axis.
    low_mm, high_mm : float
        Heights between which they start. [mm]
    count : int
        How many rays, about.

    Returns
    -------
    int
        0 when the part can be drawn straight up.
    """
    import numpy as np

    centres, normals = mesh.triangles_center, mesh.face_normals
    inside = (np.abs(centres[:, 0]) < outline.length_mm / 2) & (np.abs(centres[:, 1]) < outline.width_mm / 2)
    inside &= (centres[:, 2] > low_mm - 1e-6) & (centres[:, 2] < high_mm + 1e-6)
    chosen = np.flatnonzero(inside & (mesh.area_faces > 1e-6))
    points, ways = surface_samples(mesh, chosen, count)
    down = int(np.count_nonzero(ways[:, 2] < -1e-3))
    looking_down = mesh.triangles[(normals[:, 2] < -1e-6) & (centres[:, 2] > low_mm)]
    return down + _vertical_hits(points + 1e-3 * ways, looking_down)


def _vertical_hits(points: Any, triangles: Any) -> int:
    """How many points have one of the triangles straight above them."""
    import numpy as np

    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    seen = np.abs(area) > 1e-9
    a, b, c, area = a[seen], b[seen], c[seen], area[seen]
    hits = 0
    for chunk in np.array_split(points, max(1, len(points) // 200)):
        x, y = chunk[:, :1], chunk[:, 1:2]
        v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / area
        height = a[:, 2] + v * (b[:, 2] - a[:, 2]) + w * (c[:, 2] - a[:, 2])
        above = (v > 1e-9) & (w > 1e-9) & (v + w < 1 - 1e-9) & (height > chunk[:, 2:3] + 1e-6)
        hits += int(np.count_nonzero(above.any(axis=1)))
    return hits


def thicknesses_mm(triangles: Any, points: Any, normals: Any) -> tuple[Any, Any]:
    """Material behind points of a surface, along the inward normal, and where the ray leaves it.

    Ray against triangle by Moeller and Trumbore, J. Graphics Tools 2 (1997) 21.

    Parameters
    ----------
    triangles : ndarray, shape (k, 3, 3)
        Corners of the triangles of a closed surface. [mm]
    points : ndarray, shape (n, 3)
        Points on the surface. [mm]
    normals : ndarray, shape (n, 3)
        Outward unit normals there.

    Returns
    -------
    ndarray, ndarray
        Thickness, shape (n,), infinite without an exit, and exit points, shape (n, 3). [mm]
    """
    import numpy as np

    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    outward = np.cross(e1, e2)
    found = np.full(len(points), np.inf)
    for i, (point, way) in enumerate(zip(points, -normals)):
        ahead = outward @ way > 1e-12
        p = np.cross(way, e2[ahead])
        det = np.einsum("ij,ij->i", e1[ahead], p)
        s = point + 1e-4 * way - a[ahead]
        q = np.cross(s, e1[ahead])
        # An exit is a face that the ray meets from behind; its determinant is away from zero.
        with np.errstate(divide="ignore", invalid="ignore"):
            u = np.einsum("ij,ij->i", s, p) / det
            v = (q @ way) / det
            t = np.einsum("ij,ij->i", e2[ahead], q) / det
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-3)
        if hit.any():
            found[i] = t[hit].min()
    return found, points - np.where(np.isfinite(found), found, 0.0)[:, None] * normals


def sweep_interference_mm3(moving: Any, still: Any, offsets_mm: Sequence[float]) -> float:
    """Largest common volume while one solid is pulled along +z through given offsets. [mm3]

    Parameters
    ----------
    moving, still : cadquery.Shape
        The part that is pulled, in its first position, and the one it is pulled out of.
    offsets_mm : sequence of float
        Heights at which the common volume is taken. [mm]

    Returns
    -------
    float
        0 when nothing is in the way. [mm3]
    """
    import cadquery as cq

    worst = 0.0
    for offset in offsets_mm:
        worst = max(worst, common_volume_mm3(moving.translate(cq.Vector(0, 0, offset)), still))
    return worst


def common_volume_mm3(one: Any, other: Any) -> float:
    """Common volume of two solids, 0 when they only touch. [mm3]"""
    a, b = rough_bounds(one), rough_bounds(other)
    if any(a[axis] > b[axis + 3] or b[axis] > a[axis + 3] for axis in range(3)):
        return 0.0
    return abs(one.intersect(other).Volume())
