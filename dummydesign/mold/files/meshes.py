"""Triangle meshes of the parts: tessellation in the kernel, proof and files by trimesh. CAD child only."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.kernel import occ

TOLERANCE_MM, ANGLE_RAD, VOLUME_REL, MOST_HALVINGS = 0.05, 0.2, 3e-4, 4
_UUID = re.compile(r"[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}")


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


def lying(mesh: Any, turned: bool, scale: float = 1.0) -> Any:
    """A copy of a mesh as it is printed: turned over about x where asked, enlarged, its lowest point at z = 0."""
    import numpy as np

    laid = mesh.copy()
    if turned:
        # Half a turn about x by signs alone, so that flat faces stay flat to the last digit.
        laid.vertices = np.asarray(laid.vertices) * (1.0, -1.0, -1.0)
    if scale != 1.0:
        laid.apply_scale(scale)
    laid.apply_translation((0.0, 0.0, -laid.bounds[0][2]))
    return laid


def write_stl(mesh: Any, path: Path) -> None:
    """Write a binary STL; the 80-byte head is blank but for the name, so equal meshes give equal files."""
    data = mesh.export(file_type="stl")
    path.write_bytes(path.stem.encode("ascii", "replace")[:80].ljust(80, b" ") + data[80:])


def write_3mf(mesh: Any, path: Path) -> None:
    """Write a 3MF (millimetres) for slicers; its time stamps are fixed and its identifiers counted."""
    import io
    import uuid
    import zipfile

    known: dict[str, str] = {}

    def counted(hit: re.Match[str]) -> str:
        name = f"{path.stem}/{len(known)}"
        return known.setdefault(hit.group(0), str(uuid.uuid5(uuid.NAMESPACE_URL, name)))

    source = zipfile.ZipFile(io.BytesIO(mesh.export(file_type="3mf")))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name in sorted(source.namelist(), key=lambda name: (name != "[Content_Types].xml", name)):
            text = _UUID.sub(counted, source.read(name).decode("utf-8"))
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            target.writestr(entry, text)


def write_glb(meshes: Mapping[str, Any], colours: Mapping[str, tuple[float, float, float]], path: Path) -> None:
    """Write meshes as one binary glTF, whose unit is the metre; z up is turned to y up as its viewers expect."""
    import numpy as np
    import trimesh

    turn = trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0])
    scene = trimesh.Scene()
    for name, mesh in meshes.items():
        shown = mesh.copy()
        shown.apply_scale(1e-3)
        shown.apply_transform(turn)
        colour = [*(int(255 * c) for c in colours[name]), 255]
        material = trimesh.visual.material.PBRMaterial(
            name=name, baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.7
        )
        shown.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(shown, node_name=name, geom_name=name)
    path.write_bytes(scene.export(file_type="glb"))
