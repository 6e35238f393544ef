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
from dummydesign.mold.cad.bone_mesh import FEWER, crosses, crossing, fault, read_triangles, sewn, simplified
from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.cad.solids import exact_volume_mm3, heights_over
from dummydesign.mold.cad.tessellate import tessellate
from dummydesign.mold.model.spec import THIN_LAYER

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


STEPS = 40
TOUCH_MM = 1e-4
LONGEST_MM = 5.0, 300.0
"""Lengths that a bone of a hand may have; beyond them its file is in other units."""
UNITS = {"metres": 1000.0, "inches": 25.4, "centimetres": 10.0, "micrometres": 0.001}
MOST_FORCE = 0.05
"""Change of the force that a simplified surface may make; other tolerances of a casting are held to the same."""


def read_solid(path: Path, scale: float) -> tuple[Any, dict[str, Any]]:
    """One solid of a STEP or STL file in mm, and what was done to its triangles."""
    if path.suffix.lower() not in (".step", ".stp"):
        points, faces, mended = read_triangles(path)
        points = points * scale
        _check_units(float(np.ptp(points, axis=0).max()), scale, path.name)
        few, kept, off, rms = simplified(points, faces, path.name)
        return sewn(few, kept, path.name), {
            "mended": mended,
            "triangles": len(faces),
            "off_file_mm": off,
            "off_file_rms_mm": rms,
        }
    solid = _of_step(path).scale(scale)
    box = solid.BoundingBox(1e-2)
    _check_units(max(box.xlen, box.ylen, box.zlen), scale, path.name)
    return solid, {}


def _of_step(path: Path) -> Any:
    """The one solid of a STEP file, checked as far as the kernel can."""
    try:
        shapes = cq.importers.importStep(str(path)).vals()
    except Exception:
        raise fault(path.name, "is not a STEP file that can be read", "file_unreadable") from None
    bodies = [solid for shape in shapes for solid in shape.Solids()]
    if len(bodies) != 1:
        surfaces = sum(len(shape.Faces()) for shape in shapes)
        what = f"holds {surfaces} surfaces and no solid" if surfaces and not bodies else f"holds {len(bodies)} solids"
        raise fault(path.name, f"{what}, one solid is needed")
    solid = bodies[0]
    if not solid.isValid():
        solid = solid.fix()
        if not solid.isValid() or len(solid.Solids()) != 1:
            raise fault(path.name, "its surfaces do not close to a valid solid; repair it in a CAD program first")
    places = [_crossing(solid, near) for near in (0.05, 0.0125)]
    if places[0] is not None and places[1] is not None:
        raise crosses(path.name, places[1])
    if solid.Volume() < 0:
        occ.BRepLib.OrientClosedSolid_s(solid.wrapped)
    return solid


def _crossing(solid: Any, share: float) -> NDArray | None:
    """Where the triangles of a solid cross; its size may be any, so that their deflection is a share of a hundredth.

    The kernel's own analyser finds crossings in sound ellipsoids of splines.
    """
    size = solid.BoundingBox(1e-2).DiagonalLength
    mesh = tessellate(solid, share * 1e-2 * size, 4.0 * share)
    return crossing(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def _check_units(longest_mm: float, scale: float, name: str) -> None:
    """Ask about the unit of a file that makes no bone of a hand."""
    low, high = LONGEST_MM
    if low <= longest_mm <= high:
        return
    may_be = [
        f"{unit} with --bone-scale {scale * factor:g} ({longest_mm * factor:.3g} mm)"
        for unit, factor in UNITS.items()
        if low <= longest_mm * factor <= high
    ]
    advice = f"the file may be in {' or in '.join(may_be)}" if may_be else "give --bone-scale"
    message = f"bone '{name}' is {longest_mm:.4g} mm long as scaled, a bone is {low:g} to {high:g} mm long: {advice}"
    raise InputError(message, "implausible_unit", "bone_scale", scale)


def set_into_pad(solid: Any, asked: dict[str, Any], thickness_mm: float, name: str) -> Any:
    """Turn, set the tip down and cut at the free face; see :class:`dummydesign.mold.model.spec.Placing`."""
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
            "out_of_range",
            "bone_height_mm",
            asked["height_mm"],
            (None, high - TOUCH_MM),
        )
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
        "volume_mm3": exact_volume_mm3(bone),
        "seat_mm2": seat_mm2,
        "overhang": bool(up.any()),
        "x_low_mm": float(low[0]),
        "x_high_mm": float(high[0]),
        "y_low_mm": float(low[1]),
        "y_high_mm": float(high[1]),
        "off_dome_mm": off,
        "tip_mm": radius,
        "foot_mm": foot,
    }


def placed_bone(file: str, solid: str, placing: dict[str, Any], thickness_mm: float, room_mm: float) -> dict[str, Any]:
    """Read a bone from a file, place it, write it as ``solid`` and say what was measured."""
    path = Path(file)
    read, facts = read_solid(path, placing["scale"])
    rms = facts.get("off_file_rms_mm", 0.0)
    cover = thickness_mm - placing["height_mm"]
    if (change := THIN_LAYER * rms / cover) > MOST_FORCE:
        problem = (
            f"simplified to {FEWER[0]:,} triangles its surface is {rms:.2f} mm off (root mean square), up to "
            f"{100 * change:.0f} % of force over {cover:g} mm of gel; allowed are {100 * MOST_FORCE:g} %: "
            "smooth the scan first, or give STEP"
        )
        raise fault(path.name, problem, "too_large")
    bone = set_into_pad(read, placing, thickness_mm, path.name)
    measured = measure(bone, placing, thickness_mm, room_mm)
    bone.exportBrep(solid)
    return {**measured, **facts}
