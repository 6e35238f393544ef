"""Read, place and cut a bone from a file, and the conic dome nearest to it. CAD child only."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.geometry.conic import Conic
from dummydesign.geometry.dimensions import STEEPEST_BONE_DEG
from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.cad.solids import heights_over

GRID, ROUNDS = 41, 4
MOST_TIP_MM = 500.0


def nearest_dome(
    heights_mm: NDArray, radii_mm: NDArray, height_mm: float, room_mm: float
) -> tuple[float, float, float]:
    """Tip radius and foot of the dome of a given height whose profile is nearest to points of a bone.

    Least squares over all domes that can be cast, by a grid in ln(radius) and foot that is refined around its best.
    """
    low, high = np.array([0.0, 0.2 * height_mm]), np.array([np.log(MOST_TIP_MM), room_mm])
    best: tuple[float, float, float] | None = None
    for _ in range(ROUNDS):
        tips, feet = np.exp(np.linspace(low[0], high[0], GRID)), np.linspace(low[1], high[1], GRID)
        for tip, foot in product(tips.tolist(), feet.tolist()):
            conic = Conic(tip, height_mm, foot)
            if conic.factor * height_mm > tip * (1 - 1e-6) or conic.foot_slope_deg > STEEPEST_BONE_DEG - 0.5:
                continue
            off = float(np.sqrt(np.mean((height_mm - conic.sag_mm(radii_mm) - heights_mm) ** 2)))
            if best is None or off < best[2]:
                best = tip, foot, off
        if best is None:
            message = f"bone height = {height_mm:g} mm: no dome so high fits within {room_mm:g} mm of its tip"
            raise InputError(message, "cannot_be_made", "bone_height_mm", height_mm)
        step = 2 * (high - low) / (GRID - 1)
        middle = np.array([np.log(best[0]), best[1]])
        low = np.maximum(middle - step, [0.0, 0.2 * height_mm])
        high = np.minimum(middle + step, [np.log(MOST_TIP_MM), room_mm])
    assert best is not None
    return best


def undersides(triangles: NDArray, points: NDArray) -> NDArray:
    """Lowest height of a triangle mesh under points of the plane; NaN where there is none. [mm]"""
    rays = heights_over(points, triangles, -1e-9)
    return np.concatenate([np.fmin.reduce(heights, axis=1, initial=np.nan) for _, heights in rays])


MOST_TRIANGLES, MOST_READ = 1500, 500_000
OFF_FILE_MM = 0.1
STEPS = 40
TOUCH_MM = 1e-4


def read_solid(path: Path) -> tuple[Any, float]:
    """One solid of a STEP or STL file, and how far simplified triangles are off the file's. [mm]"""
    if path.suffix.lower() in (".step", ".stp"):
        try:
            shapes = cq.importers.importStep(str(path)).vals()
        except Exception:
            raise _wrong(path.name, "is not a STEP file that can be read", "file_unreadable") from None
        bodies = [solid for shape in shapes for solid in shape.Solids()]
        if len(bodies) != 1:
            raise _wrong(path.name, f"holds {len(bodies)} solids, one is needed")
        return bodies[0], 0.0
    return _of_triangles(path)


def _wrong(name: str, problem: str, code: str = "malformed") -> InputError:
    return InputError(f"bone '{name}': {problem}", code, "bone", name)


def _of_triangles(path: Path) -> tuple[Any, float]:
    """The solid of a closed triangle mesh; fewer, larger triangles where there are many."""
    import trimesh

    try:
        mesh: Any = trimesh.load(path, force="mesh")
    except Exception:
        raise _wrong(path.name, "is not an STL file that can be read", "file_unreadable") from None
    if not len(getattr(mesh, "faces", ())):
        raise _wrong(path.name, "holds no triangles")
    if len(mesh.faces) > MOST_READ:
        problem = f"{len(mesh.faces)} triangles; allowed are {MOST_READ}: simplify it first"
        raise _wrong(path.name, problem, "too_large")
    mesh.merge_vertices(digits_vertex=6)
    if not mesh.is_watertight or not mesh.is_winding_consistent:
        raise _wrong(path.name, "its surface is not closed; repair it in a mesh program first")
    if mesh.body_count != 1:
        raise _wrong(path.name, f"holds {mesh.body_count} bodies, one is needed")
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    if mesh.volume < 0:
        faces = faces[:, ::-1]
    off = 0.0
    if len(faces) > MOST_TRIANGLES:
        points, faces, off = _simplified(points, faces, path.name)
    return _sewn(points, faces, path.name), off


def _simplified(points: Any, faces: Any, name: str) -> tuple[Any, Any, float]:
    """At most so many triangles, and the largest distance of the old corners from the new surface."""
    try:
        import pyvista
    except ModuleNotFoundError as problem:
        what = f"has {len(faces):,} triangles; more than {MOST_TRIANGLES:,} need PyVista ({problem.name} is missing)"
        raise _wrong(name, f"{what}: pip install pyvista, or give STEP", "program_missing") from None

    packed = np.hstack([np.full((len(faces), 1), 3), faces]).ravel()
    whole = pyvista.PolyData(points, packed)
    small = whole.decimate(1.0 - MOST_TRIANGLES / len(faces), volume_preservation=True)
    away = np.abs(whole.compute_implicit_distance(small)["implicit_distance"])
    return np.asarray(small.points, float), small.faces.reshape(-1, 4)[:, 1:], float(away.max())


def _sewn(points: Any, faces: Any, name: str) -> Any:
    sewing = occ.BRepBuilderAPI_Sewing(1e-6)
    for corners in points[faces]:
        line = occ.BRepBuilderAPI_MakePolygon(*(occ.gp_Pnt(*map(float, corner)) for corner in corners), True)
        sewing.Add(occ.BRepBuilderAPI_MakeFace(line.Wire(), True).Face())
    sewing.Perform()
    shells = cq.Shape.cast(sewing.SewedShape()).Shells()
    if len(shells) != 1 or not shells[0].Closed():
        raise _wrong(name, "its surface is not closed; repair it in a mesh program first")
    solid = cq.Solid.makeSolid(shells[0])
    occ.BRepLib.OrientClosedSolid_s(solid.wrapped)
    return solid


def set_into_pad(solid: Any, asked: dict[str, Any], thickness_mm: float, name: str) -> Any:
    """Scale, turn, set the tip down and cut at the free face; see :class:`dummydesign.mold.model.spec.Placing`."""
    solid = solid.scale(asked["scale"])
    for axis, angle in zip(((1, 0, 0), (0, 1, 0), (0, 0, 1)), asked["turn_deg"]):
        if angle:
            solid = solid.rotate(cq.Vector(), cq.Vector(*axis), angle)
    corners = [point.toTuple() for point in solid.copy().tessellate(0.02, 0.1)[0]]
    low = min(z for _, _, z in corners)
    tip = [(x, y) for x, y, z in corners if z < low + 1e-6]
    middle = [sum(values) / len(tip) for values in zip(*tip)]
    high = max(z for _, _, z in corners) - low
    if high < asked["height_mm"] + TOUCH_MM:
        raise InputError(
            f"bone '{name}' is {high:.2f} mm high as scaled and turned; it must reach through the free face to its "
            f"plate, so bone height must be below that (it is {asked['height_mm']:g} mm)",
            "out_of_range", "bone_height_mm", asked["height_mm"], (None, high - TOUCH_MM),
        )  # fmt: skip
    bottom = thickness_mm - asked["height_mm"]
    moved = solid.translate(cq.Vector(asked["x_mm"] - middle[0], asked["y_mm"] - middle[1], bottom - low))
    reach = 2.0 * max(max(abs(x), abs(y)) for x, y, _ in corners) + 1000.0
    below = cq.Solid.makeBox(2 * reach, 2 * reach, thickness_mm + reach, cq.Vector(-reach, -reach, -reach))
    parts = moved.intersect(below).Solids()
    if len(parts) != 1:
        message = f"bone '{name}' comes apart into {len(parts)} pieces at the free face; let it reach otherwise"
        raise InputError(message, "cannot_be_made", "bone", name)
    return parts[0]


def measure(bone: Any, asked: dict[str, Any], thickness_mm: float, room_mm: float) -> dict[str, Any]:
    """Volume, seat, bounds, overhang, and the nearest dome of a placed bone."""
    points, faces = bone.copy().tessellate(0.02, 0.1)
    corners = np.array([point.toTuple() for point in points])
    triangles = corners[np.array(faces)]
    seat_mm2 = sum(face.Area() for face in bone.Faces() if face.Center().z > thickness_mm - TOUCH_MM)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    up = (normal[:, 2] > 1e-3 * np.linalg.norm(normal, axis=1)) & (triangles[..., 2].min(axis=1) < thickness_mm - 1e-3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    tip = np.array([asked["x_mm"], asked["y_mm"]])
    across = 1.2 * float(np.hypot(*(corners[:, :2] - tip).T).max())
    line = np.linspace(-across, across, STEPS)
    grid = np.array([(x, y) for x in line for y in line if np.hypot(x, y) <= across])
    under = undersides(triangles, grid + tip)
    heights = np.where(np.isfinite(under), thickness_mm - under, 0.0)
    radius, foot, off = nearest_dome(heights, np.hypot(*grid.T), asked["height_mm"], room_mm)
    return {
        "volume_mm3": bone.Volume(), "seat_mm2": seat_mm2, "overhang": bool(up.any()),
        "x_low_mm": float(low[0]), "x_high_mm": float(high[0]), "y_low_mm": float(low[1]), "y_high_mm": float(high[1]),
        "off_dome_mm": off, "tip_mm": radius, "foot_mm": foot,
    }  # fmt: skip


def placed_bone(
    file: str, solid: str, placing: dict[str, Any], thickness_mm: float, room_mm: float
) -> dict[str, Any]:
    """Read a bone from a file, place it, write it as ``solid`` and say what was measured."""
    path = Path(file)
    read, off = read_solid(path)
    bone = set_into_pad(read, placing, thickness_mm, path.name)
    measured = measure(bone, placing, thickness_mm, room_mm)
    bone.exportBrep(solid)
    if off > OFF_FILE_MM:
        message = f"{MOST_TRIANGLES} triangles are up to {off:.2f} mm off its surface; give STEP"
        raise _wrong(path.name, message, "too_large")
    return {**measured, "off_file_mm": off}
