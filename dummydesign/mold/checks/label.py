"""The label reads right on the mould and mirrored on the master it is cast on. CAD child only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dummydesign.mold.cad.label import label_bars
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.checks.result import Check, below, equal, skipped
from dummydesign.mold.files.meshes import tessellate

OFF_MM = 1e-4


def check_label(made: Parts, meshes: Mapping[str, Any] | None = None) -> list[Check]:
    """The label reads right on the mould (void along its strokes) and mirrored on the master (proud there).

    Parameters
    ----------
    made : Parts
    meshes : mapping of str to trimesh.Trimesh, optional
        Meshes of ``mould`` (a printed one as if it had no joint) and ``master``; made here when not given.
    """
    import numpy as np

    bars = label_bars(made.spec, made.plan)
    if not bars:
        return [skipped("label_reads_right", "no room for a label on this land")]
    plan, grow = made.plan, made.plan.silicone_scale
    meshes = meshes or {"mould": tessellate(made.mould), **(
        {} if made.spec.is_printed else {"master": tessellate(made.solid("master"))})}
    depth = plan.land_mm - made.spec.body.label_depth_mm / 2
    places = np.array([(*bar.middle, depth) for bar in bars])
    right = ~inside_mesh(meshes["mould"], places)
    wrong = ~inside_mesh(meshes["mould"], places * (-1.0, 1.0, 1.0))
    if not made.spec.is_printed:
        # Turned over about x: y changes sign, heights count from the land downwards.
        turned = (places - (0.0, 0.0, plan.land_mm)) * (grow, -grow, -grow)
        right = right & inside_mesh(meshes["master"], turned)
    note = "share of strokes cut in the mould and proud on the master"
    return [
        equal("label_reads_right", float(right.mean()), 1.0, note),
        _handedness(float(wrong.mean())),
    ]


def _handedness(shared: float) -> Check:
    """A mirrored label would share all strokes only if the text were its own mirror image."""
    if shared == 1.0:
        return skipped("label_not_mirrored", "the label is its own mirror image")
    return below("label_not_mirrored", shared, 0.99, "share of strokes that a mirrored label would share")


def inside_mesh(mesh: Any, points: Any) -> Any:
    """Which points lie inside a closed mesh: an odd number of its triangles is above them.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        [mm]
    points : ndarray, shape (n, 3)
        [mm]

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    import numpy as np

    # Off the edges of triangles, which the middle of a stroke may lie on.
    x, y, z = (points + (OFF_MM, 0.7 * OFF_MM, 0.0)).T[:, :, None]
    corners = mesh.triangles
    near = (corners[..., 0].min(axis=1) <= x.max()) & (corners[..., 0].max(axis=1) >= x.min())
    near &= (corners[..., 1].min(axis=1) <= y.max()) & (corners[..., 1].max(axis=1) >= y.min())
    a, b, c = (corners[near, k] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / area
        height = a[:, 2] + v * (b[:, 2] - a[:, 2]) + w * (c[:, 2] - a[:, 2])
        above = (v >= 0) & (w >= 0) & (v + w <= 1) & (height > z) & (np.abs(area) > 1e-12)
    return np.count_nonzero(above, axis=1) % 2 == 1
