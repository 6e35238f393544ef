"""Views taken from the solids themselves: visible edges from above, cut faces, holes, levels. CAD child only."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.cad.solids import edges_of, height_range

CURVE_MM = 0.5
LEVEL_AREA_MM2, LEVEL_GAP_MM = 5.0, 0.15
SMOOTH = 0.9994
"""Cosine of 2 deg: directions that differ by less go on smoothly."""
Run = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Hole:
    """Round holes of one kind: diameters on their way down, and where they are. [mm]"""

    diameters_mm: tuple[float, ...]
    places: tuple[tuple[float, float], ...]

    @property
    def words(self) -> str:
        """As it stands in a drawing: ``8 x Ø4.5``."""
        across = "/".join(f"Ø{d:.3g}" for d in self.diameters_mm)
        return f"{len(self.places)} x {across}"


@dataclass(frozen=True)
class Section:
    """A cut: its closed outlines, and the points at which they have a corner. [mm]"""

    loops: tuple[Run, ...]
    corners: Run


def edges_from_above(solid: Any) -> list[tuple[Run, str]]:
    """Edges of a solid that bound a face looking up, seen from above, each with the layer it is drawn on.

    Seams of round faces are left out, and so are smooth joints, but for level ones where a rounding begins: thin.
    Curves are broken into short straight pieces.
    """
    listed = _faces(solid)
    faces, kind_of = [face for face, _, _ in listed], [(kind, normal) for _, kind, normal in listed]
    beside: dict[int, list[int]] = {}
    edges: dict[int, Any] = {}
    seams: set[int] = set()
    for index, face in enumerate(faces):
        around: set[int] = set()
        for key, edge in edges_of(face):
            if key in around:
                # A seam bounds its face on both sides.
                continue
            around.add(key)
            edges[key] = edge
            beside.setdefault(key, []).append(index)
            if occ.BRep_Tool.IsClosed_s(edge, face.wrapped):
                seams.add(key)
    runs = []
    for key, edge in edges.items():
        kinds = [kind_of[face] for face in beside[key]]
        if key in seams or all(flat is not None and flat.z < 1e-6 for _, flat in kinds):
            continue
        edge = cq.Edge(edge)
        middle = edge.positionAt(0.5)
        normals = [flat or faces[face].normalAt(middle) for face, (_, flat) in zip(beside[key], kinds)]
        if all(normal.z < 1e-6 for normal in normals):
            continue
        smooth = len(normals) == 2 and normals[0].dot(normals[1]) > SMOOTH
        if smooth and kinds[0][0] == kinds[1][0]:
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
    found = ((face, face.geomType()) for face in solid.Faces())
    return [(face, kind, face.normalAt() if kind == "PLANE" else None) for face, kind in found]


def turned_over(solid: Any) -> Any:
    """The solid turned by half a turn about the x axis, for a view from below."""
    return solid.rotate(cq.Vector(), cq.Vector(1, 0, 0), 180)


def cut_at_y(solid: Any, y_mm: float = 0.0) -> Section:
    """Outlines (x, z) of a solid cut by the plane y = const."""
    return _cut(solid, (0, y_mm, 0), (0, 1, 0), 0)


def cut_at_x(solid: Any, x_mm: float = 0.0) -> Section:
    """Outlines (y, z) of a solid cut by the plane x = const."""
    return _cut(solid, (x_mm, 0, 0), (1, 0, 0), 1)


def _cut(solid: Any, origin: tuple[float, float, float], normal: tuple[int, int, int], across: int) -> Section:
    plane = cq.Face.makePlane(1000.0, 1000.0, cq.Vector(*origin), cq.Vector(*normal))
    wires = [w for face in plane.intersect(solid).Faces() for w in (face.outerWire(), *face.innerWires())]
    loops = tuple(tuple((point[across], point[2]) for point in wire_points(wire)) for wire in wires)
    found = [point for wire in wires for point in _corners(list(wire))]
    return Section(loops, tuple((point[across], point[2]) for point in found))


def _corners(edges: list[Any]) -> list[tuple[float, float, float]]:
    """Ends that two edges of a wire share and at which its direction changes."""
    found = []
    for one, other in zip(edges, [*edges[1:], edges[0]]):
        ends = ((a, b) for a in (0.0, 1.0) for b in (0.0, 1.0))
        a, b = min(ends, key=lambda pair: _far(one.positionAt(pair[0]).toTuple(), other.positionAt(pair[1]).toTuple()))
        if abs(one.tangentAt(a).dot(other.tangentAt(b))) < SMOOTH:
            found.append(one.positionAt(a).toTuple())
    return found


def edge_points(edge: Any) -> list[tuple[float, float, float]]:
    """Points along an edge: its ends, of a curve more."""
    if edge.geomType() == "LINE":
        return [edge.startPoint().toTuple(), edge.endPoint().toTuple()]
    count = max(4, min(48, int(edge.Length() / CURVE_MM)))
    return [edge.positionAt(i / count).toTuple() for i in range(count + 1)]


def wire_points(wire: Any) -> list[tuple[float, float, float]]:
    """Points around a wire in order, closed at the end."""
    pieces = [edge_points(edge) for edge in wire]
    if len(pieces) > 1:
        first, second = pieces[0], pieces[1]
        ends = (second[0], second[-1])
        if min(_far(first[0], end) for end in ends) < min(_far(first[-1], end) for end in ends):
            first.reverse()
    run = list(pieces[0])
    for points in pieces[1:]:
        if _far(run[-1], points[0]) > _far(run[-1], points[-1]):
            points.reverse()
        run += points[1:]
    return [*run, run[0]]


def _far(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    return sum((p - q) ** 2 for p, q in zip(a, b))


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
                place = (round(middle.x, 3), round(middle.y, 3))
                rims.setdefault(place, set()).add(round(2 * edges[0].radius(), 3))
    kinds: dict[tuple[float, ...], list[tuple[float, float]]] = {}
    for place, across in rims.items():
        kinds.setdefault(tuple(sorted(across, reverse=True)), []).append(place)
    return [Hole(across, tuple(sorted(places))) for across, places in sorted(kinds.items())]


def levels(solid: Any) -> list[float]:
    """Heights of the flat faces that lie level, lowest and highest of the solid among them. [mm]"""
    areas: dict[float, float] = {}
    for face, _, normal in _faces(solid):
        if normal is not None and abs(normal.z) > 0.999:
            high = round(face.Center().z, 4)
            areas[high] = areas.get(high, 0.0) + face.Area()
    found = list(height_range(solid, [face for face, _, normal in _faces(solid) if normal is None]))
    for high, area in sorted(areas.items()):
        if area > LEVEL_AREA_MM2 and all(abs(high - other) > LEVEL_GAP_MM for other in found):
            found.append(high)
    return sorted(found)
