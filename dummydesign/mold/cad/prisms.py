"""Drafted prisms, what booleans leave, and the extent of solids. CadQuery is imported inside."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dummydesign.mold.model.outline import Outline

NEAR_MM = 1e-4


def drafted_prism(outline: Outline, height_mm: float, draft_deg: float, z_mm: float = 0.0) -> Any:
    """Make the solid over ``outline`` at ``z_mm`` whose walls move outwards by z tan(draft).

    Parameters
    ----------
    outline : Outline
        Its lower face, a rounded rectangle or a circle.
    height_mm, z_mm : float
        Height, and level of the lower face. [mm]
    draft_deg : float
        Angle of the walls from the vertical; positive widens upwards. [deg]

    Returns
    -------
    cadquery.Solid
    """
    import cadquery as cq

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


def rough_bounds(shape: Any) -> tuple[float, float, float, float, float, float]:
    """Bounds (x, y, z low, x, y, z high) that surely hold the shape, a hundred times faster than tight ones."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape.wrapped, box, False)
    return box.Get()


def corners_of(shape: Any) -> list[tuple[float, float, float]]:
    """Places of a shape's vertices, those that several edges share several times. [mm]"""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_VERTEX
    from OCP.TopoDS import TopoDS

    points = (BRep_Tool.Pnt_s(TopoDS.Vertex_s(one)) for one in _walk(shape, TopAbs_VERTEX))
    return [(point.X(), point.Y(), point.Z()) for point in points]


def edges_of(face: Any) -> Iterator[tuple[int, Any]]:
    """Edges around a face (``TopoDS_Edge``) with their key, which is the same for the face on the other side.

    The tip of a cone, an edge without length, is none.
    """
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopoDS import TopoDS

    for one in _walk(face, TopAbs_EDGE):
        edge = TopoDS.Edge_s(one)
        if not BRep_Tool.Degenerated_s(edge):
            yield hash(one), edge


def height_range(solid: Any, curved: list[Any]) -> tuple[float, float]:
    """Lowest and highest z of a solid: of its corners, and of those curved faces that reach beyond them. [mm]

    Parameters
    ----------
    solid : cadquery.Shape
    curved : list of cadquery.Face
        Its faces that are not flat.
    """
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
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape.wrapped, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()
