"""Views for the drawings, taken from the solids themselves: visible edges from above, cut faces. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.files.drawing import Dimension, Drawing, View, arrange
from dummydesign.mold.pour.shape_notes import shape_mark

CURVE_MM = 0.02


def drawings(made: Parts) -> dict[str, Drawing]:
    """Drawing of the mould and of its master with frame: top view and section of each, dimensioned."""
    spec = made.spec
    pad = spec.pad
    size = f"{pad.length_mm:g} x {pad.width_mm:g} x {pad.thickness_mm:g}"
    notes = [
        f"pad {size} after cure, draft {pad.draft_deg:g} deg, tested face on the cavity floor; #{spec.hash}",
        f"cavity x {made.plan.scale:.5f} of the pad, master x {made.plan.silicone_scale:.5f} of the mould",
        *([f"{pad.kind}: {shape_mark(spec)}"] if shape_mark(spec) else []),
        f"corner radius {pad.corner_radius_mm:g}, edge radius {pad.edge_radius_mm:g}, silicone {spec.silicone.name}",
    ]
    # Along a ridge or a bar the usual section shows a straight line.
    across = [_mould_across(made)] if pad.shape.runs_out else []
    title = f"Silicone mould, {spec.preset}, t = {pad.thickness_mm:g}"
    return {
        "mould": arrange(title, [_mould_top(made), _mould_cut(made), *across], notes),
        "master": arrange(f"Master and frame, t = {pad.thickness_mm:g}", [_master_top(made), _master_cut(made)], notes),
    }


def edges_from_above(solid: Any, low_mm: float) -> list[tuple[tuple[float, float], ...]]:
    """Edges of a solid above a height, seen from above, curves broken into short straight pieces."""
    runs = []
    for edge in solid.Edges():
        points = _points(edge)
        if min(point[2] for point in points) > low_mm:
            flat = tuple((x, y) for x, y, _ in points)
            if max(abs(a - b) for p in flat for a, b in zip(p, flat[0])) > 1e-6:
                runs.append(flat)
    return runs


def cut_at_y(solid: Any, y_mm: float = 0.0) -> list[tuple[tuple[float, float], ...]]:
    """Closed outlines (x, z) of a solid cut by the plane y = const."""
    return [tuple((x, z) for x, _, z in loop) for loop in _cut(solid, (0, y_mm, 0), (0, 1, 0))]


def cut_at_x(solid: Any, x_mm: float = 0.0) -> list[tuple[tuple[float, float], ...]]:
    """Closed outlines (y, z) of a solid cut by the plane x = const."""
    return [tuple((y, z) for _, y, z in loop) for loop in _cut(solid, (x_mm, 0, 0), (1, 0, 0))]


def _cut(solid: Any, origin: tuple[float, float, float], normal: tuple[int, int, int]) -> list[list[Any]]:
    import cadquery as cq

    plane = cq.Face.makePlane(1000.0, 1000.0, cq.Vector(*origin), cq.Vector(*normal))
    faces = plane.intersect(solid).Faces()
    return [_wire_points(wire) for face in faces for wire in (face.outerWire(), *face.innerWires())]


def _points(edge: Any) -> list[tuple[float, float, float]]:
    if edge.geomType() == "LINE":
        return [edge.startPoint().toTuple(), edge.endPoint().toTuple()]
    count = max(4, min(48, int(edge.Length() / 0.5)))
    return [edge.positionAt(i / count).toTuple() for i in range(count + 1)]


def _wire_points(wire: Any) -> list[tuple[float, float, float]]:
    """Points around a wire in order, closed at the end."""
    run: list[tuple[float, float, float]] = []
    for edge in wire:
        points = _points(edge)
        if run and _far(run[-1], points[0]) > _far(run[-1], points[-1]):
            points.reverse()
        elif not run:
            first = points
        run += points if not run else points[1:]
    # The first edge may have been entered at its wrong end.
    if len(run) > len(first) and _far(run[len(first) - 1], run[len(first)]) > _far(run[0], run[len(first)]):
        run[: len(first)] = first[::-1]
    return [*run, run[0]]


def _far(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    return sum((p - q) ** 2 for p, q in zip(a, b))


def _across(x: float, y: float, offset: float) -> Dimension:
    return Dimension((-x, y), (x, y), offset, False, 2 * x)


def _upright(x: float, low: float, high: float, offset: float) -> Dimension:
    return Dimension((x, low), (x, high), offset, True, high - low)


def _mould_top(made: Parts) -> View:
    spec, plan = made.spec, made.plan
    runs = [(run, "outline") for run in edges_from_above(made.solid("mould"), -spec.body.floor_mm + 0.1)]
    top, fill, floor = plan.top, plan.fill_outline, plan.floor_outline
    dims = [
        _across(top.length_mm / 2, top.width_mm / 2, 16.0),
        _across(fill.length_mm / 2, top.width_mm / 2, 8.0),
        _upright(top.length_mm / 2, -top.width_mm / 2, top.width_mm / 2, 18.0),
        _upright(top.length_mm / 2, -fill.width_mm / 2, fill.width_mm / 2, 9.0),
        _across(floor.length_mm / 2, 0.0, 0.0),
        _upright(0.3 * floor.length_mm, -floor.width_mm / 2, floor.width_mm / 2, 0.0),
    ]
    return View("top view, cavity up", tuple(runs), tuple(dims))


def _mould_cut(made: Parts) -> View:
    spec, plan = made.spec, made.plan
    loops = cut_at_y(made.solid("mould"))
    half, low = plan.top.length_mm / 2, -spec.body.floor_mm
    dims = [
        _upright(plan.bottom.length_mm / 2, low, 0.0, 12.0),
        _upright(plan.bottom.length_mm / 2, 0.0, plan.depth_mm, 12.0),
        _upright(-half, low, plan.land_mm, -12.0),
        _across(plan.bottom.length_mm / 2, low, -9.0),
        Dimension((plan.opening.length_mm / 2, plan.land_mm), (half, plan.land_mm), 8.0, False, spec.body.wall_mm),
    ]
    middle = 0.15 * plan.floor_outline.length_mm
    if plan.face_mm:
        dims.append(_upright(middle, 0.0, plan.face_mm, 0.0))
    for name, level in (("spacer", plan.interface_mm), ("carrier", _bone_low(made))):
        if name in made.parts:
            loops += cut_at_y(made.solid(name))
            dims.append(_upright(middle, 0.0, level, 0.0))
    if spec.body.freeboard_mm:
        dims.append(_upright(half, plan.depth_mm, plan.land_mm, 24.0))
    if "lid" in made.parts:
        loops += cut_at_y(made.solid("lid"))
        dims.append(_upright(half, plan.land_mm, plan.land_mm + spec.closure.lid_mm, 24.0))
    return View("section y = 0", tuple((loop, "cut") for loop in loops), tuple(dims), True)


def _mould_across(made: Parts) -> View:
    """Section across a ridge or a bar, with the carrier in its place."""
    plan = made.plan
    loops = cut_at_x(made.solid("mould")) + (cut_at_x(made.solid("carrier")) if "carrier" in made.parts else [])
    foot = plan.scale * max(made.spec.pad.shape.lines_mm())
    level = plan.face_mm or plan.depth_mm
    dims = [
        _across(foot, level, 8.0),
        _upright(0.0, 0.0, plan.face_mm or _bone_low(made), 0.0),
        _across(plan.bottom.width_mm / 2, -made.spec.body.floor_mm, -9.0),
    ]
    return View("section x = 0", tuple((loop, "cut") for loop in loops), tuple(dims), True)


def _bone_low(made: Parts) -> float:
    """Height of a bone's tip over the cavity's floor."""
    pad, plan = made.spec.pad, made.plan
    return plan.scale * pad.least_gel_mm if pad.shape.bone_height_mm else 0.0


def _master_top(made: Parts) -> View:
    plan, grow = made.plan, made.plan.silicone_scale
    runs = [(run, "outline") for run in edges_from_above(made.solid("master"), -0.1)]
    flange, opening = plan.flange, plan.opening.scaled(grow)
    dims = [
        _across(flange.length_mm / 2, flange.width_mm / 2, 16.0),
        _across(opening.length_mm / 2, flange.width_mm / 2, 8.0),
        _upright(flange.length_mm / 2, -flange.width_mm / 2, flange.width_mm / 2, 18.0),
        _upright(flange.length_mm / 2, -opening.width_mm / 2, opening.width_mm / 2, 9.0),
    ]
    return View("master, top view", tuple(runs), tuple(dims))


def _master_cut(made: Parts) -> View:
    spec, plan = made.spec, made.plan
    grow, flange = plan.silicone_scale, plan.flange
    loops = [*cut_at_y(made.solid("master")), *cut_at_y(made.solid("frame"))]
    high = plan.height_mm * grow
    dims = [
        _upright(flange.length_mm / 2, -spec.box.base_mm, 0.0, 10.0),
        _upright(flange.length_mm / 2, 0.0, high, 20.0),
        _upright(-flange.length_mm / 2, 0.0, high + spec.box.rim_mm, -10.0),
        _upright(0.0, 0.0, plan.land_mm * grow, 0.0),
        _across(plan.top.length_mm * grow / 2, -spec.box.base_mm, -9.0),
    ]
    return View("master and frame, section y = 0", tuple((loop, "cut") for loop in loops), tuple(dims), True)
