"""Triangles of a solid. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.kernel import occ

TOLERANCE_MM, ANGLE_RAD, VOLUME_REL, MOST_HALVINGS = 0.05, 0.2, 3e-4, 4


def tessellate(solid: Any, tolerance_mm: float | None = None, angle_rad: float | None = None) -> Any:
    """Tessellate a solid into one watertight trimesh (millimetres), seams between faces merged.

    Without a tolerance it is refined until the mesh holds the solid's volume to ``VOLUME_REL``, so that
    small round parts come out as true as large flat ones.
    """
    if tolerance_mm is not None:
        return _mesh(solid, tolerance_mm, angle_rad or ANGLE_RAD)
    volume = solid.Volume()
    for halving in range(MOST_HALVINGS):
        mesh = _mesh(solid, TOLERANCE_MM / 2**halving, ANGLE_RAD / 2**halving)
        if abs(mesh.volume / volume - 1) < VOLUME_REL:
            break
    return mesh


def _mesh(solid: Any, tolerance_mm: float, angle_rad: float) -> Any:
    """One tessellation; the kernel keeps the first one on a shape, so a copy is meshed."""
    import numpy as np
    import trimesh

    points, triangles = _kernel_triangles(solid.copy(), tolerance_mm, angle_rad)
    mesh = trimesh.Trimesh(np.array(points), np.array(triangles), process=False)
    mesh.merge_vertices(digits_vertex=6)
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


def _kernel_triangles(
    solid: Any, tolerance_mm: float, angle_rad: float
) -> tuple[list[tuple[float, float, float]], list[tuple[int, int, int]]]:
    """Points and triangles of all faces, straight from the kernel: a vector object for each point takes longer."""
    occ.BRepMesh_IncrementalMesh(solid.wrapped, tolerance_mm, True, angle_rad, False)
    points: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    faces = occ.TopExp_Explorer(solid.wrapped, occ.TopAbs_FACE)
    while faces.More():
        face, location = occ.TopoDS.Face_s(faces.Current()), occ.TopLoc_Location()
        faces.Next()
        one = occ.BRep_Tool.Triangulation_s(face, location)
        if one is None:
            continue
        first, move = len(points) - 1, location.Transformation()
        nodes = (one.Node(i) for i in range(1, one.NbNodes() + 1))
        moved = nodes if location.IsIdentity() else (node.Transformed(move) for node in nodes)
        points += [(node.X(), node.Y(), node.Z()) for node in moved]
        corners = (one.Triangle(i).Get() for i in range(1, one.NbTriangles() + 1))
        if face.Orientation() == occ.TopAbs_REVERSED:
            triangles += [(first + a, first + c, first + b) for a, b, c in corners]
        else:
            triangles += [(first + a, first + b, first + c) for a, b, c in corners]
    return points, triangles
