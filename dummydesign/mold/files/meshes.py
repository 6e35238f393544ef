"""Triangle meshes of solids, as the parts are printed, and their files. CAD child only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.kernel import occ


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


_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)


def write_3mf(mesh: Any, path: Path) -> None:
    """Write a 3MF (millimetres) for slicers: the core specification alone, without extensions; time stamps are fixed.

    References
    ----------
    3MF Consortium, 3MF Core Specification 1.3.
    """
    import zipfile
    from xml.sax.saxutils import quoteattr

    points = "".join(f'<vertex x="{x:.6f}" y="{y:.6f}" z="{z:.6f}"/>' for x, y, z in mesh.vertices.tolist())
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.faces.tolist())
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<resources><object id="1" type="model" name={quoteattr(path.stem)}><mesh><vertices>{points}</vertices>'
        f'<triangles>{faces}</triangles></mesh></object></resources><build><item objectid="1"/></build></model>\n'
    )
    files = {"[Content_Types].xml": _TYPES, "_rels/.rels": _RELATIONS, "3D/3dmodel.model": model}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name, text in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            target.writestr(entry, text)


def write_prints(
    meshes: Mapping[str, Any], files: Mapping[str, Path], scale: float, turned: Sequence[str] = ()
) -> None:
    """Write a 3MF of each part that is named, as it lies on the bed."""
    for name, path in files.items():
        write_3mf(lying(meshes[name], name in turned, scale), path)


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
