"""Triangle meshes of the parts: tessellation in the kernel, proof and files by trimesh. CAD child only."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

TOLERANCE_MM, ANGLE_RAD, SMALL_MM = 0.05, 0.2, 60.0


def tessellate(solid: Any, tolerance_mm: float | None = None, angle_rad: float | None = None) -> Any:
    """Tessellate a solid into one watertight trimesh (millimetres), seams between faces merged.

    The kernel keeps the first triangulation on the shape, so a copy is meshed. A part of a few
    millimetres is meshed finer than the default, so that its volume too is right to a thousandth.
    """
    import numpy as np
    import trimesh

    size = solid.BoundingBox().DiagonalLength
    small = size < SMALL_MM
    tolerance_mm = tolerance_mm or (TOLERANCE_MM / 10 if small else TOLERANCE_MM)
    angle_rad = angle_rad or (ANGLE_RAD / 4 if small else ANGLE_RAD)
    points, triangles = solid.copy().tessellate(tolerance_mm, angle_rad)
    vertices = np.array([point.toTuple() for point in points])
    mesh = trimesh.Trimesh(vertices, np.array(triangles), process=False)
    mesh.merge_vertices(digits_vertex=6)
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    return mesh


def write_stl(mesh: Any, path: Path) -> None:
    """Write a binary STL; the 80-byte head is blank but for the name, so equal meshes give equal files."""
    data = mesh.export(file_type="stl")
    path.write_bytes(path.stem.encode("ascii", "replace")[:80].ljust(80, b" ") + data[80:])


def write_3mf(mesh: Any, path: Path) -> None:
    """Write a 3MF (millimetres) for slicers."""
    path.write_bytes(mesh.export(file_type="3mf"))


def coloured_scene(meshes: Mapping[str, Any], colours: Mapping[str, tuple[float, float, float]], unit: float) -> Any:
    """Put meshes in one scene, lengths times ``unit``; z up is turned to y up as GLB viewers expect."""
    import numpy as np
    import trimesh

    turn = trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0])
    scene = trimesh.Scene()
    for name, mesh in meshes.items():
        shown = mesh.copy()
        shown.apply_scale(unit)
        shown.apply_transform(turn)
        colour = [*(int(255 * c) for c in colours[name]), 255]
        material = trimesh.visual.material.PBRMaterial(
            name=name, baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.7
        )
        shown.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(shown, node_name=name, geom_name=name)
    return scene


def write_glb(scene: Any, path: Path) -> None:
    """Write a binary glTF; its unit is the metre."""
    path.write_bytes(scene.export(file_type="glb"))
