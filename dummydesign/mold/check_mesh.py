"""Checks on the mould's mesh, independent of the kernel's booleans: rays, wall and floor thickness. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.build import Parts
from dummydesign.mold.check import Check, above, equal
from dummydesign.mold.demould import ray_hits, thicknesses_mm

WALL_SLACK_MM, MOST_RAYS = 0.06, 300
# On a coarser mesh the facets of a drafted corner may lean over by more than the draft.
FINE = (0.02, 0.1)


def check_mould_mesh(made: Parts, mould: Any) -> list[Check]:
    """No ray leaves the cavity blocked; wall and floor are as thick as specified."""
    import numpy as np

    spec, plan = made.spec, made.plan
    hits = ray_hits(mould, plan.opening, -0.01, plan.land_mm)
    found = [equal("rays_blocked", hits, 0, "upward rays from the cavity that meet the mould")]
    centres, normals = mould.triangles_center, mould.face_normals
    inside = (np.abs(centres[:, 0]) < plan.opening.length_mm / 2) & (np.abs(centres[:, 1]) < plan.opening.width_mm / 2)
    inside &= (centres[:, 2] > -0.01) & (centres[:, 2] < plan.land_mm - 1e-3) & (mould.area_faces > 1e-4)
    side = _few(np.flatnonzero(inside & (np.abs(normals[:, 2]) < 0.2)))
    floor = _few(np.flatnonzero(inside & (normals[:, 2] > 0.999) & (centres[:, 2] < plan.depth_mm - 0.5)))
    walls, exits = thicknesses_mm(mould, side)
    # Rays that leave into a gutter or a socket measure those; their distance is a check of its own.
    through = (np.abs(exits[:, 0]) > plan.top.length_mm / 2 - 1.0) | (np.abs(exits[:, 1]) > plan.top.width_mm / 2 - 1.0)
    through &= np.isfinite(walls)
    if through.any():
        least = float(walls[through].min())
        found.append(above("wall_thickness", least, spec.body.wall_mm - WALL_SLACK_MM, "mm, thinnest of the rays"))
    else:
        found.append(Check("wall_thickness", None, spec.body.wall_mm - WALL_SLACK_MM, "fail", "no ray left the wall"))
    floors, _ = thicknesses_mm(mould, floor)
    least = float(floors.min()) if len(floors) else 0.0
    found.append(above("floor_thickness", least, spec.body.floor_mm - WALL_SLACK_MM, "mm"))
    return found


def _few(chosen: Any) -> Any:
    return chosen[:: max(1, -(-len(chosen) // MOST_RAYS))]
