"""Drafted prisms and what booleans leave: the plain solids that everything is made of. CadQuery is imported inside."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.model.outline import Outline


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
