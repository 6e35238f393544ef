"""Triangle meshes of parts as they are printed, and their files. CAD child only."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any


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
