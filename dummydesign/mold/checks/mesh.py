"""Checks on the mould's mesh, independent of the kernel's booleans: rays, wall and floor thickness. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.checks.release import ray_hits, surface_samples, thicknesses_mm
from dummydesign.mold.checks.result import Check, above, equal
from dummydesign.mold.model.layout import Layout

WALL_SLACK_MM, RAYS = 0.06, 400
# Upward part of a floor's normal, up to slopes of 72 degrees: steeper is wall.
UPWARD = 0.3
# On a coarser mesh the facets of a drafted corner may lean over by more than the draft.
FINE = (0.02, 0.1)


def check_mould_mesh(made: Parts, mould: Any, fine: Any) -> list[Check]:
    """No ray leaves the cavity blocked; wall and floor are as thick as specified.

    Parameters
    ----------
    made : Parts
        The parts with specification and layout.
    mould : trimesh.Trimesh
        Mesh of the mould as exported. [mm]
    fine : trimesh.Trimesh
        A finer one of what is around the cavities, for the rays. [mm]

    Returns
    -------
    list of Check
    """
    import numpy as np

    spec, plan = made.spec, made.plan
    hits = ray_hits(fine, plan.openings, -0.01, plan.land_mm)
    found = [equal("rays_blocked", hits, 0, "upward rays from the cavity that meet the mould")]
    centres, normals = mould.triangles_center, mould.face_normals
    inside = np.abs(centres[:, 0]) < plan.openings.length_mm / 2
    inside &= np.abs(centres[:, 1]) < plan.openings.width_mm / 2
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
    found.append(above("wall_thickness", least, spec.body.wall_mm - WALL_SLACK_MM, f"mm, {outside.sum()} rays"))
    # Straight down: under a curved floor the normal would lead past the thinnest place.
    places, ways = surface_samples(mould, floor, RAYS)
    floors, _ = thicknesses_mm(mould.triangles, places, np.tile((0.0, 0.0, 1.0), (len(ways), 1)))
    least = float(floors.min()) if len(floors) else 0.0
    found.append(above("floor_thickness", least, spec.body.floor_mm - WALL_SLACK_MM, f"mm, {len(floors)} rays"))
    return found


def _near_side(points: Any, plan: Layout) -> Any:
    """Which points lie on the outer side of the block."""
    import numpy as np

    return (np.abs(points[:, 0]) > plan.top.length_mm / 2 - 1.0) | (np.abs(points[:, 1]) > plan.top.width_mm / 2 - 1.0)
