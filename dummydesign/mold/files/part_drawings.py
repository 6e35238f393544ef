"""The drawing of every part: what is shown, taken from the solids themselves, and what is measured. CAD child only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.solids import edges_of, height_range
from dummydesign.mold.files.drawing_layout import LETTER, Measure, Title, View, arrange, crown_detail, profile_words
from dummydesign.mold.files.drawing_sheet import Drawing
from dummydesign.mold.pour.acceptance import MOST_PERCENT, CrownLimits, crown_limits
from dummydesign.mold.pour.printing import face_factor
from dummydesign.mold.pour.steps import shape_mark

CURVE_MM = 0.5
LEVEL_AREA_MM2, LEVEL_GAP_MM = 5.0, 0.15
SMOOTH = 0.9994
"""Cosine of 2 deg: directions that differ by less go on smoothly."""
Run = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Hole:
    """Round holes of one kind: diameters on their way down, and where they are; balls with ``sign`` SØ. [mm]"""

    diameters_mm: tuple[float, ...]
    places: tuple[tuple[float, float], ...]
    sign: str = "Ø"

    @property
    def words(self) -> str:
        """As it stands in a drawing: ``8 x Ø4.5``."""
        across = "/".join(f"{self.sign}{d:.3g}" for d in self.diameters_mm)
        return f"{len(self.places)} x {across}"


@dataclass(frozen=True)
class CutSection:
    """A cut: its closed outlines, and the points at which they have a corner. [mm]"""

    loops: tuple[Run, ...]
    corners: Run


def edges_from_above(solid: Any) -> list[tuple[Run, str]]:
    """Edges of a solid that bound a face looking up, seen from above, each with the layer it is drawn on.

    Seams of round faces are left out, and so are smooth joints, but for level ones where a rounding begins: thin.
    Curves are broken into short straight pieces.
    """
    faces_of: dict[int, list[tuple[Any, str, Any]]] = {}
    edges: dict[int, Any] = {}
    seams: set[int] = set()
    for one in _faces(solid):
        # A seam bounds its face on both sides, but counts once.
        for key, edge in dict(edges_of(one[0])).items():
            edges[key] = edge
            faces_of.setdefault(key, []).append(one)
            if occ.BRep_Tool.IsClosed_s(edge, one[0].wrapped):
                seams.add(key)
    runs = []
    for key, edge in edges.items():
        sides = faces_of[key]
        if key in seams or all(flat is not None and flat.z < 1e-6 for _, _, flat in sides):
            continue
        edge = cq.Edge(edge)
        middle = edge.positionAt(0.5)
        normals = [flat or face.normalAt(middle) for face, _, flat in sides]
        if all(normal.z < 1e-6 for normal in normals):
            continue
        smooth = len(normals) == 2 and normals[0].dot(normals[1]) > SMOOTH
        if smooth and sides[0][1] == sides[1][1]:
            continue
        points = edge_points(edge)
        level = max(abs(z - points[0][2]) for _, _, z in points) < 1e-6
        run = tuple((x, y) for x, y, _ in points)
        if (level or not smooth) and max(abs(a - b) for p in run for a, b in zip(p, run[0])) > 1e-6:
            runs.append((run, "thin" if smooth else "outline"))
    return runs


@lru_cache(maxsize=1)
def _faces(solid: Any) -> list[tuple[Any, str, Any]]:
    """Faces of a solid with the kind of their surface and, of a plane, its normal; those of the last solid are kept."""
    kinds = ((face, face.geomType()) for face in solid.Faces())
    return [(face, kind, face.normalAt() if kind == "PLANE" else None) for face, kind in kinds]


def cut(solid: Any, across: bool = False) -> CutSection:
    """Outlines (x, z) of a solid cut by the plane y = 0, or (y, z) by the plane x = 0."""
    plane = cq.Face.makePlane(1000.0, 1000.0, cq.Vector(0, 0, 0), cq.Vector(across, not across, 0))
    wires = [w for face in plane.intersect(solid).Faces() for w in (face.outerWire(), *face.innerWires())]
    loops = tuple(tuple((point[across], point[2]) for point in wire_points(wire)) for wire in wires)
    corners = [point for wire in wires for point in _corners(list(wire))]
    return CutSection(loops, tuple((point[across], point[2]) for point in corners))


def _corners(edges: list[Any]) -> list[tuple[float, float, float]]:
    """Ends that two edges of a wire share and at which its direction changes."""
    corners = []
    for one, other in zip(edges, [*edges[1:], edges[0]]):
        end, start = float(not _is_reversed(one)), float(_is_reversed(other))
        if abs(one.tangentAt(end).dot(other.tangentAt(start))) < SMOOTH:
            corners.append(one.positionAt(end).toTuple())
    return corners


def _is_reversed(edge: Any) -> bool:
    """Whether a wire runs along an edge from its end to its start."""
    return bool(edge.wrapped.Orientation() == occ.TopAbs_REVERSED)


def edge_points(edge: Any) -> list[tuple[float, float, float]]:
    """Points along an edge: its ends, of a curve more."""
    if edge.geomType() == "LINE":
        return [edge.startPoint().toTuple(), edge.endPoint().toTuple()]
    count = max(4, min(48, int(edge.Length() / CURVE_MM)))
    return [edge.positionAt(i / count).toTuple() for i in range(count + 1)]


def wire_points(wire: Any) -> list[tuple[float, float, float]]:
    """Points around a wire in order, closed at the end."""
    run: list[tuple[float, float, float]] = []
    for edge in wire:
        points = edge_points(edge)
        # The kernel gives the ends of a line, but not places along a curve, in the direction of its edge.
        if _is_reversed(edge) and edge.geomType() != "LINE":
            points.reverse()
        run += points[1:] if run else points
    return [*run, run[0]]


def holes(solid: Any) -> list[Hole]:
    """Round vertical holes that end in a flat face, by their diameters; what stands out of a face is none."""
    inside = occ.BRepClass3d_SolidClassifier(solid.wrapped)
    rims: dict[tuple[float, float], set[float]] = {}
    for face, _, normal in _faces(solid):
        if normal is None or abs(normal.z) < 0.999:
            continue
        inwards = -0.05 if normal.z > 0 else 0.05
        for wire in face.innerWires():
            edges = wire.Edges()
            if len(edges) != 1 or edges[0].geomType() != "CIRCLE":
                continue
            middle = edges[0].arcCenter()
            inside.Perform(occ.gp_Pnt(middle.x, middle.y, middle.z + inwards), 1e-6)
            if inside.State() != occ.TopAbs_IN:
                centre = (round(middle.x, 3), round(middle.y, 3))
                rims.setdefault(centre, set()).add(round(2 * edges[0].radius(), 3))
    kinds: dict[tuple[float, ...], list[tuple[float, float]]] = {}
    for centre, across in rims.items():
        kinds.setdefault(tuple(sorted(across, reverse=True)), []).append(centre)
    return [Hole(across, tuple(sorted(places))) for across, places in sorted(kinds.items())]


def levels(solid: Any) -> list[float]:
    """Heights of the flat faces that lie level, lowest and highest of the solid among them. [mm]"""
    areas: dict[float, float] = {}
    for face, _, normal in _faces(solid):
        if normal is not None and abs(normal.z) > 0.999:
            high = round(face.Center().z, 4)
            areas[high] = areas.get(high, 0.0) + face.Area()
    heights = list(height_range(solid, [face for face, _, normal in _faces(solid) if normal is None]))
    for high, area in sorted(areas.items()):
        if area > LEVEL_AREA_MM2 and all(abs(high - other) > LEVEL_GAP_MM for other in heights):
            heights.append(high)
    return sorted(heights)


TURNED = ("strike_off", "spacer", "carrier", "lid", "pad")
"""Parts whose interesting side is below: drawn turned over."""
LEFT_OUT = ("layer_top", "layer_base")
"""Parts that another drawing shows."""
DETAILED = ("pad", "master")
"""Parts whose crown is shown enlarged."""
MOST_WIDTHS, NEAR_MM = 6, 0.3
NAMES = {
    "strike_off": "strike-off plate",
    "lid_master": "master of the lid",
    "lid_frame": "frame of the lid",
    "face_sheet": "face sheet",
    "sprue_pin": "sprue pin",
    "vent_pin": "vent pin",
}
PRINTED_NAMES = {**NAMES, "mould": "base of the mould", "frame": "ring of the mould"}


def part_views(made: Parts) -> dict[str, list[View]]:
    """What is shown of every part that is made, by its name."""
    return {name: _views(made, name) for name in made.parts if name not in LEFT_OUT}


def sheets(made: Parts, views: dict[str, list[View]], date: str = "", paper: str = "A3") -> dict[str, Drawing]:
    """Arrange what is shown of the parts, a sheet each."""
    pad, limits, drawings = made.spec.pad, made.spec.acceptance, {}
    names = PRINTED_NAMES if made.spec.is_printed else NAMES
    thickness, crown = f"; thickness +-{pad.thickness_mm * limits.thickness_percent / 100:.2f}", _crown(made)
    if crown is not None:
        thickness = "; thickness {:.2f} to {:.2f}".format(*crown.thickness_mm)
    for count, name in enumerate(views, 1):
        title = Title(
            pad.title,
            f"{names.get(name, name)}, {made.spec.preset} mould",
            made.parts[name].material.drawn,
            f"ISO 2768-m{thickness if name == 'pad' else ''}",
            made.spec.hash,
            date or "-",
            f"{count} of {len(views)}",
        )
        drawings[name] = arrange(views[name], title, _notes(made, name), paper)
    return drawings


def _crown(made: Parts) -> CrownLimits | None:
    return crown_limits(made.spec.pad, made.spec.acceptance.thickness_percent)


def _profile(made: Parts, name: str) -> list[str]:
    """The profile of the crown on the parts that have it, with its tolerance where that is known."""
    pad, shape = made.spec.pad, made.spec.pad.shape
    if name not in (*DETAILED, *(["mould"] if made.spec.is_printed else [])) or not shape.relief_mm:
        return []
    factor, limits = 1.0 if name == "pad" else face_factor(made.spec), _crown(made)
    if limits is None:
        return [profile_words(shape, factor)]
    zone = 2.0 * factor * min(abs(one - pad.shape.relief_mm) for one in limits.height_mm)
    low, high = (factor * one for one in limits.height_mm)
    return [
        f"{profile_words(shape, factor, zone)} Height over the flat {low:.2f} to {high:.2f}: "
        f"{MOST_PERCENT:g} % of force."
    ]


def _notes(made: Parts, name: str) -> list[str]:
    """What holds for the whole part: sizes, factors, draft and radii."""
    spec, plan, pad = made.spec, made.plan, made.spec.pad
    mark = shape_mark(spec)
    if name == "pad":
        return [
            "After cure; tested face up.",
            f"Tested face {pad.length_mm:g} x {pad.width_mm:g} to its sharp corner.",
            f"Draft {pad.draft_deg:g} deg, widening from the tested face.",
            f"Vertical corners R{pad.corner_radius_mm:g}, edge of the tested face R{pad.edge_radius_mm:g}.",
            *([f"{pad.kind}: {mark}."] if mark else []),
            *_profile(made, name),
        ]
    notes = [f"For a {pad.title} after cure.{' Drawn turned over.' if name in TURNED else ''}"]
    if name in ("mould", "lid") or (spec.is_printed and name == "frame"):
        notes += [
            f"Cavity x {plan.scale:.5f} of the pad; draft {pad.draft_deg:g} deg, outside "
            f"{spec.body.outer_draft_deg:g} deg.",
            f"Corners of the cavity R{plan.floor_outline.radius_mm:.2f}, edge of its floor "
            f"R{plan.scale * pad.edge_radius_mm:.2f}, outside R{plan.top.radius_mm:.3g}.",
        ]
        notes += [f"{pad.kind}: {mark}."] if mark and name == "mould" else []
        notes += _profile(made, name)
    elif name in ("master", "frame", "lid_master", "lid_frame"):
        notes.append(
            f"x {plan.silicone_scale:.5f} of the silicone part; draft {pad.draft_deg:g} deg inside, "
            f"{spec.body.outer_draft_deg:g} deg outside; flange R{plan.flange.radius_mm:.3g}."
        )
        notes += _profile(made, name)
    if name == "face_sheet":
        return [*notes, "Cut to size, edges broken; bonded into the master, flush with the plug's top."]
    if name == "carrier" and made.with_bone is None:
        return [
            *notes,
            "Glue the pad on by its free face, its middle on the plate's; each groove points at a row of "
            "tips, and the punch is set down where the lines cross.",
        ]
    if made.parts[name].is_printed:
        against = "resin" if spec.is_printed else "silicone"
        notes.append(f"Print solid skins; faces against {against} sanded or sealed.")
    return notes


def _views(made: Parts, name: str) -> list[View]:
    """A section and a view from above under it; a part whose interesting side is below is shown turned over."""
    solid = made.pad_nominal if name == "pad" else made.solid(name)
    if name in TURNED:
        solid = solid.rotate(cq.Vector(), cq.Vector(1, 0, 0), 180)
    rims = holes(solid)
    if name == "lid":
        keys = tuple((key.x_mm, -key.y_mm) for key in made.plan.keys)
        rims.append(Hole((2 * made.spec.lid.key_radius_mm,), keys, "SØ"))
    shape = made.spec.pad.shape
    sites = shape.places_mm if name in ("pad", "carrier") and len(shape.places_mm) > 1 else ()
    views = [_section(made, name, solid, rims), _from_above(solid, rims, sites)]
    if name in ("mould", "pad") and shape.runs_out:
        # Along a ridge or a bar the usual section shows a straight line.
        views.append(_section(made, name, solid, rims, across=True))
    if name in DETAILED and shape.relief_mm:
        factor = 1.0 if name == "pad" else made.plan.scale * made.plan.silicone_scale
        limits = _crown(made)
        views.append(crown_detail(shape, factor, None if limits is None else limits.tip_radius_mm))
        shown = 2 if name == "pad" and shape.runs_out else 0
        x, _ = min(shape.places_mm, key=lambda centre: (abs(centre[1]), abs(centre[0])))
        views[shown] = replace(views[shown], marks=(((factor * x, 0.0), LETTER),))
    return views


def _section(made: Parts, name: str, solid: Any, rims: Sequence[Hole], across: bool = False) -> View:
    x0, y0 = section_origin(made, name)
    solid = solid.translate((-x0, -y0, 0.0)) if x0 or y0 else solid
    section = cut(solid, across)
    measures = [*_heights(solid, section.loops), *_widths(section, rims)]
    runs: list[tuple[Run, str]] = [(loop, "cut") for loop in section.loops]
    if name == "mould":
        measures += _of_cavity(made, section.loops)
        for other in ("spacer", "carrier"):
            if other in made.parts and not (other == "carrier" and made.with_bone is None):
                runs += [(loop, "thin") for loop in cut(made.solid(other), across).loops]
    plane = f"x = {x0:.4g}" if across else f"y = {y0:.4g}"
    return View(f"section {plane}", tuple(runs), tuple(measures), (), True)


def section_origin(made: Parts, name: str) -> tuple[float, float]:
    """What a section goes through: the middle of the first of several cavities, in it the row of crowns next to it."""
    grow, printed = made.plan.silicone_scale, made.spec.is_printed
    x = y = 0.0
    if len(made.plan.places) > 1 and name in ("mould", "frame", "master", "face_sheet", "strike_off"):
        first = made.plan.places[0]
        # The casting frame is larger than the mould and turned over.
        cast = name == "master" or (name in ("frame", "face_sheet") and not printed)
        x = first.x_mm * (grow if cast else 1.0)
        y = first.y_mm * (-grow if cast else -1.0 if name in TURNED else 1.0)
    if name not in ("mould", "master", "pad"):
        return x, y
    factor = 1.0 if name == "pad" else made.plan.scale * (grow if name == "master" else 1.0)
    return x, y + factor * min((across for _, across in made.spec.pad.shape.places_mm), key=abs)


def _heights(solid: Any, loops: Sequence[Run]) -> list[Measure]:
    """Overall height on the left, the other levels from the lowest on the right."""
    heights = levels(solid)
    xs = [x for loop in loops for x, _ in loop]
    low, left, right = heights[0], min(xs), max(xs)
    return [
        Measure((left, low), (left, heights[-1]), "left"),
        *(Measure((right, low), (right, z), "right") for z in heights[1:-1]),
    ]


def _of_cavity(made: Parts, loops: Sequence[Run]) -> list[Measure]:
    """Heights in the cavity from its floor: a crown's foot, the interface of layers, the tip of a bone, the fill."""
    plan, pad = made.plan, made.spec.pad
    bone = plan.scale * pad.least_gel_mm if pad.shape.bone_height_mm else 0.0
    left = min(x for loop in loops for x, _ in loop)
    heights = [z for z in (plan.face_mm, plan.interface_mm, bone, plan.depth_mm) if z]
    return [Measure((left, 0.0), (left, z), "left") for z in heights]


def _widths(section: CutSection, rims: Sequence[Hole]) -> list[Measure]:
    """Widths of a symmetrical section at its corners, those of nearly the same width and of holes left out."""
    holes = [abs(x) + side * d / 2 for one in rims for x, _ in one.places for d in one.diameters_mm for side in (1, -1)]
    spans: list[tuple[float, float]] = []
    for x, z in sorted(section.corners, reverse=True):
        partner = any(abs(a + x) < 1e-3 and abs(b - z) < 1e-3 for a, b in section.corners)
        fresh = all(abs(x - other) > NEAR_MM for other, _ in spans)
        if x > NEAR_MM and partner and fresh and all(abs(x - rim) > 1e-2 for rim in holes):
            spans.append((x, z))
    heights = [z for loop in section.loops for _, z in loop]
    middle = (max(heights) + min(heights)) / 2
    kept = spans if len(spans) <= MOST_WIDTHS else [*spans[: MOST_WIDTHS - 1], spans[-1]]
    return [Measure((-x, z), (x, z), "above" if z > middle else "below") for x, z in kept]


def _from_above(solid: Any, rims: Sequence[Hole], sites: Sequence[tuple[float, float]] = ()) -> View:
    runs = edges_from_above(solid)
    x0, y0, x1, y1 = View("", tuple(runs)).bounds
    measures = [Measure((x0, y0), (x1, y0), "below"), Measure((x1, y0), (x1, y1), "right")]
    leaders = []
    for hole in rims:
        measures += _pattern(hole.places)
        first = min(hole.places)
        leaders.append(((first[0] - hole.diameters_mm[0] / 2, first[1]), hole.words))
    if sites:
        measures += _pattern(sites)
        half = 0.05 * min(x1 - x0, y1 - y0)
        for x, y in sites:
            runs = [*runs, (((x - half, y), (x + half, y)), "thin"), (((x, y - half), (x, y + half)), "thin")]
        leaders.append((min(sites), f"{len(sites)} sites"))
    unique = {(round(m.value, 3), m.side): m for m in measures if m.value > 1e-6}
    return View("view from above", tuple(runs), tuple(unique.values()), tuple(leaders))


def _pattern(places: Sequence[tuple[float, float]]) -> list[Measure]:
    """Distances across a pattern of holes, or from the middle line where a hole has no partner."""
    measures = []
    for axis, side in ((0, "above"), (1, "right")):
        for at in sorted({abs(point[axis]) for point in places}):
            row = [point for point in places if abs(abs(point[axis]) - at) < 1e-6]
            both = any(point[axis] > 0 for point in row) and any(point[axis] < 0 for point in row)
            level = max(point[1 - axis] for point in row)
            start, end = (
                (one, level) if axis == 0 else (level, one) for one in ((-at, at) if both else (0.0, row[0][axis]))
            )
            measures.append(Measure(start, end, side))
    return measures
