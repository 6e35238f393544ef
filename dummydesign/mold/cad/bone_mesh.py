"""The triangles of a bone's file: mended where that has one answer, checked, simplified, sewn. CAD child only."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.mold.cad.kernel import cq, occ

MOST_READ = 500_000
FEWER = (1500, 1000, 700)
"""Numbers of triangles that are tried for a file of more; the kernel takes minutes for several thousand."""
SAME, FLAT = 1e-6, 1e-6
"""Corners nearer than this share of the bone's size are one; lower triangles than that have no area."""


ON_EDGE = 1e-9
"""Barycentric coordinate from which on a point on a triangle's side is on the triangle."""


def fault(name: str, problem: str, code: str = "malformed") -> InputError:
    """Error of a bone's file."""
    return InputError(f"bone '{name}': {problem}", code, "bone", name)


def read_triangles(path: Path) -> tuple[NDArray, NDArray, str]:
    """Corners and faces of one closed body, wound outwards, and what was mended in words."""
    import trimesh

    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False)
    except Exception:
        raise fault(path.name, "is not an STL file that can be read", "file_unreadable") from None
    if not len(getattr(mesh, "faces", ())):
        raise fault(path.name, "holds no triangles")
    if len(mesh.faces) > MOST_READ:
        problem = f"{len(mesh.faces)} triangles; allowed are {MOST_READ}: simplify it first"
        raise fault(path.name, problem, "too_large")
    points, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces)
    if not np.isfinite(points).all():
        raise fault(path.name, "has corners that are not finite numbers")
    return _mended(points, faces, path.name)


def _mended(points: NDArray, faces: NDArray, name: str) -> tuple[NDArray, NDArray, str]:
    size = float(np.ptp(points, axis=0).max()) or 1.0
    points, faces, lost = _joined(points, faces, SAME * size)
    _refuse_open(points, faces, name)
    faces, turned = _wound(faces, name)
    flipped = _without_flat(points, faces, FLAT * size)
    if _volume(points, faces) < 0:
        faces = faces[:, ::-1]
    words = [
        f"{count:,} {what}"
        for count, what in ((lost + flipped, "degenerate triangles removed"), (turned, "triangles turned round"))
        if count
    ]
    return points, faces, ", ".join(words)


def _joined(points: NDArray, faces: NDArray, near: float) -> tuple[NDArray, NDArray, int]:
    """Near corners as one, without triangles that have two corners in one place or are there twice."""
    _, first, into = np.unique(np.round(points / near), axis=0, return_index=True, return_inverse=True)
    points, faces = points[first], into.reshape(-1)[faces]
    ends = np.sort(faces, axis=1)
    whole = np.all(ends[:, 1:] != ends[:, :-1], axis=1)
    _, once = np.unique(ends[whole], axis=0, return_index=True)
    kept = faces[whole][np.sort(once)]
    return points, kept, len(faces) - len(kept)


def _refuse_open(points: NDArray, faces: NDArray, name: str) -> None:
    """Every edge has two triangles."""
    edges, count = np.unique(np.sort(_edges(faces), axis=1), axis=0, return_counts=True)
    for wrong, words in (
        (count > 2, "more than two triangles meet at {} of its edges"),
        (count == 1, "its surface is not closed: {} edges have one triangle only"),
    ):
        if wrong.any():
            at = _at(points[edges[wrong][0]].mean(axis=0))
            raise fault(name, f"{words.format(wrong.sum())}, one near {at}; repair it in a mesh program first")


def _at(point: NDArray) -> str:
    return "({})".format(", ".join(f"{value:.4g}" for value in point))


def _edges(faces: NDArray) -> NDArray:
    return faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)


def _wound(faces: NDArray, name: str) -> tuple[NDArray, int]:
    """Wind all triangles alike, and how many were turned for it.

    Each triangle is two nodes, as it is and turned; those that may stand side by side are joined.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges, n = _edges(faces), len(faces)
    order = np.lexsort(np.sort(edges, axis=1).T)
    one, other = order[::2], order[1::2]
    # Neighbours that are wound alike run along their common edge in opposite directions.
    against = (edges[one, 0] == edges[other, 0]) * n
    a, b = one // 3, other // 3
    rows, columns = np.concatenate([a, a + n]), np.concatenate([b + against, b + n - against])
    count, part = connected_components(coo_array((np.ones(len(rows)), (rows, columns)), (2 * n, 2 * n)), directed=False)
    if (part[:n] == part[n:]).any():
        raise fault(name, "its surface has one side only (a Moebius strip); repair it in a mesh program first")
    if count > 2:
        raise fault(name, f"holds {count // 2} bodies, one is needed")
    turn = part[:n] != part[0]
    if turn.sum() > n / 2:
        turn = ~turn
    return np.where(turn[:, None], faces[:, ::-1], faces), int(turn.sum())


def _without_flat(points: NDArray, faces: NDArray, low: float) -> int:
    """Take triangles without area, whose corners lie on one line, out of ``faces`` by flipping their longest edge."""
    count = 0
    for _ in range(3):
        corners = points[faces]
        sides = np.linalg.norm(corners[:, [1, 2, 0]] - corners, axis=2)
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        flat = np.flatnonzero(area < low * sides.max(axis=1))
        if not len(flat):
            break
        owner = {tuple(edge): at // 3 for at, edge in enumerate(_edges(faces).tolist())}
        changed: set[int] = set()
        for one in flat.tolist():
            a, b, c = np.roll(faces[one], -int(sides[one].argmax())).tolist()
            other = owner[b, a]
            if changed & {one, other}:
                continue
            d = next(corner for corner in faces[other].tolist() if corner not in (a, b))
            faces[one], faces[other] = (c, a, d), (d, b, c)
            changed |= {one, other}
            count += 1
    return count


def _volume(points: NDArray, faces: NDArray) -> float:
    a, b, c = np.moveaxis(points[faces] - points.mean(axis=0), 1, 0)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def crossing(points: NDArray, faces: NDArray) -> NDArray | None:
    """One point at which an edge of a triangle runs through another triangle, or None."""
    corners = points[faces]
    for one, other in _near_pairs(corners):
        for edged, pierced in ((one, other), (other, one)):
            triangle = corners[pierced]
            a, u, v = triangle[:, 0], triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
            for end in range(3):
                start, stop = faces[edged, end], faces[edged, (end + 1) % 3]
                apart = ~((faces[pierced] == start[:, None]) | (faces[pierced] == stop[:, None])).any(axis=1)
                foot, way = points[start], points[stop] - points[start]
                across = np.cross(way, v)
                det = np.einsum("ij,ij->i", u, across)
                # An edge that lies in the triangle's plane, but for rounding, runs through it nowhere.
                sizes = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1) * np.linalg.norm(way, axis=1)
                det[np.abs(det) < ON_EDGE * sizes] = 0.0
                with np.errstate(divide="ignore", invalid="ignore"):
                    off = foot - a
                    s = np.einsum("ij,ij->i", off, across) / det
                    turned = np.cross(off, u)
                    t = np.einsum("ij,ij->i", way, turned) / det
                    share = np.einsum("ij,ij->i", v, turned) / det
                    hit = apart & (s > -ON_EDGE) & (t > -ON_EDGE) & (s + t < 1 + ON_EDGE) & (share > 0) & (share < 1)
                if hit.any():
                    at = int(hit.argmax())
                    return np.asarray(foot[at] + share[at] * way[at])
    return None


def _near_pairs(corners: NDArray) -> Iterator[tuple[NDArray, NDArray]]:
    """Pairs of triangles whose boxes overlap, some at a time, in the order of their lowest x."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    axis = int(np.ptp(low, axis=0).argmax())
    order = np.argsort(low[:, axis])
    first = np.arange(len(order)) + 1
    last = np.searchsorted(low[order, axis], high[order, axis], side="right")
    count = last - first
    ends = np.cumsum(count)
    for begin in range(0, len(order), 500):
        some = slice(begin, begin + 500)
        total = int(count[some].sum())
        one = np.repeat(np.arange(len(order))[some], count[some])
        other = np.arange(total) - np.repeat(ends[some] - count[some] - (ends[begin] - count[begin]), count[some])
        other = order[other + first[one]]
        one = order[one]
        near = np.all((low[one] <= high[other]) & (low[other] <= high[one]), axis=1)
        yield one[near], other[near]


def simplified(points: NDArray, faces: NDArray, name: str) -> tuple[NDArray, NDArray, float, float]:
    """Few enough triangles that do not cross, with the distance of the old corners from the new surface.

    The distance is given at most and as root mean square, in lengths of the file.
    """
    if len(faces) <= FEWER[0]:
        if (at := crossing(points, faces)) is not None:
            raise crosses(name, at)
        return points, faces, 0.0, 0.0
    try:
        import pyvista
    except ModuleNotFoundError as problem:
        what = f"has {len(faces):,} triangles; more than {FEWER[0]:,} need PyVista ({problem.name} is missing)"
        raise fault(name, f"{what}: pip install pyvista, or give STEP", "program_missing") from None
    whole = pyvista.PolyData(points, np.hstack([np.full((len(faces), 1), 3), faces]).ravel())
    for number in FEWER:
        small = whole.decimate(1.0 - number / len(faces), volume_preservation=True)
        corners, kept = np.asarray(small.points, float), small.faces.reshape(-1, 4)[:, 1:]
        if _is_closed(kept) and crossing(corners, kept) is None:
            off = whole.compute_implicit_distance(small)["implicit_distance"]
            return corners, kept, float(np.abs(off).max()), float(np.sqrt(np.mean(off**2)))
    if (at := crossing(points, faces)) is not None:
        raise crosses(name, at)
    why = f"its {len(faces):,} triangles cannot be simplified to {FEWER[0]:,} that do not cross each other"
    raise fault(name, f"{why}: smooth it in a mesh program first", "too_large")


def crosses(name: str, at: NDArray) -> InputError:
    """Error of a surface that crosses itself at a point."""
    return fault(name, f"its surface crosses itself near {_at(at)}; repair it first")


def _is_closed(faces: NDArray) -> bool:
    _, count = np.unique(np.sort(_edges(faces), axis=1), axis=0, return_counts=True)
    return bool((count == 2).all())


def sewn(points: NDArray, faces: NDArray, name: str) -> Any:
    """The solid of a closed surface."""
    sewing = occ.BRepBuilderAPI_Sewing(1e-6)
    for corners in points[faces]:
        line = occ.BRepBuilderAPI_MakePolygon(*(occ.gp_Pnt(*map(float, corner)) for corner in corners), True)
        sewing.Add(occ.BRepBuilderAPI_MakeFace(line.Wire(), True).Face())
    sewing.Perform()
    shells = cq.Shape.cast(sewing.SewedShape()).Shells()
    if len(shells) != 1 or not shells[0].Closed():
        raise fault(name, "the CAD kernel cannot close its surface: it touches itself; repair it in a mesh program")
    solid = cq.Solid.makeSolid(shells[0])
    occ.BRepLib.OrientClosedSolid_s(solid.wrapped)
    return solid
