"""Triangle meshes of parts as they are printed, and their files. CAD child only."""

from __future__ import annotations

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
