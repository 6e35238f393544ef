"""A shaped pad under a round flat punch: finite-element problem, load steps, contact radius."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError
from dummydesign.core.parsing import one_of
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.pad.axisymmetric.case import FILM_REACH, Case, glue_film, round_problem
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, RoundFace
from dummydesign.pad.contact.axisymmetric import FilletedPunch, FlatPunch, Surface
from dummydesign.pad.contact.friction import CombinedSurface
from dummydesign.pad.contact.penalty import ROUND_SHAPED_PAD
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_axisymmetric import Sizes, columns, height_lines, lines_by_size, stretch
from dummydesign.pad.fem.mixed_solid import STABILISATION
from dummydesign.pad.solve.continuation import Path, VisitedState, follow
from dummydesign.pad.solve.equilibrium import Problem, Solution
from dummydesign.pad.specimen import Pad

Array = np.ndarray

# Fillets at the punch's edge over the smaller of radius and thickness.
RIMS = (0.1, 0.05)
CELLS = 16
# Size of the cells at the edge and under the face of a pad that is touched gradually, over that of the others. With 1
# the force was up to 6.5 % too high once the contact had come to the edge, with 0.25 it is within 0.9 % (d/h to 0.6);
# flat tops are divided by a slab on the same cells, where this cancels.
EDGE_REFINEMENT = 0.25
# Cells grow by this share of their distance from where they are wanted fine; a part of one that is no cell of its own.
SIZE_SLOPE, SPARE = 0.25, 0.2


def shaped_problem(
    case: Case, cells: int = CELLS, rim: float = RIMS[-1], twin: bool = False, refinement: float = EDGE_REFINEMENT
) -> Problem:
    """The pad under a punch with an edge fillet; its ``twin`` is the slab on the same cells."""
    face = Interface.parse(case.condition, "condition", FACES)
    one_of("base", case.base, BASES)
    shape, shear, coarse = case.shape, case.law.shear_MPa, case.radius / cells
    # Without a fillet of its own the punch has no sides.
    punch = FilletedPunch(case.radius, case.edge or rim * case.scale, sides=case.edge > 0.0)
    r, share, interface = _grid(case, cells, punch.rim, refinement)
    points, quads, row = columns(r, share)
    nothing = np.zeros_like
    move = stretch(nothing, nothing) if twin else stretch(case.drop, case.bone)
    mesh = meshes.discretise(points, quads, move=move)
    layers = shape.layers()
    if layers and interface is not None and not twin:
        # Energy and pressure terms scale alike: the pressure is that of the upper layer, times the ratio.
        factor = np.where(share[row] >= interface - 1e-9, layers[1], 1.0)
        mesh = replace(mesh, weight=mesh.weight * factor[:, None], modulus_factor=factor)
    if case.base != "bonded" and np.any(case.bone(r) > 0.0):
        message = "base = 'sliding' is not built for a pad with a bone; take bonded"
        raise InputError(message, "unsupported", "base", "sliding", "bonded")
    node = meshes.cell_nodes(mesh)
    top, below = node[row == 0][:, [2, 6, 3]], np.unique(node[row == row.max()][:, [0, 4, 1]])
    radius = mesh.nodes[0, top]
    near = radius.min(axis=1) <= case.radius + 0.8 * case.scale
    strength = ROUND_SHAPED_PAD.contact * shear / coarse
    film, glued, carried = None, np.array([], dtype=int), None
    if shape.flat_top:
        carried = np.unique(top[radius.max(axis=1) <= punch.flat_radius + 1e-9])
    if shape.flat_top and face.bonded:
        # The glued face moves with the punch node by node; near the fillet it is held by contact and a film.
        inner = max(punch.flat_radius - FILM_REACH * punch.rim, 0.3 * punch.flat_radius)
        inside = radius.max(axis=1) <= inner
        glued, near = np.unique(top[inside]), near & ~inside
        film = partial(glue_film, punch=punch, shear_MPa=shear)
    surface = Surface(
        mesh.nodes, top[near], strength, film, ROUND_SHAPED_PAD.grip_share * strength * float(face.bonded),
        punch.flat_radius if len(glued) else 0.0, face.coulomb or 0.0, 0.02 * coarse, ties_within_step=True,
    )  # fmt: skip
    return round_problem(mesh, case, glued, surface, punch, carried, STABILISATION, below)


def _grid(case: Case, cells: int, rim: float, refinement: float) -> tuple[Array, Array, float | None]:
    """Radii, shares of the column, and the share at which layers meet."""
    coarse = case.radius / cells
    first = min(coarse, 1.6 / cells)
    finer = 1.0 if case.shape.flat_top else refinement
    top = finer * min(coarse, 1.0 / cells)
    places = [case.radius - 0.5 * rim, *case.lines]
    sizes = [min(coarse, finer * 16.0 / cells * rim), *[0.6 * coarse] * len(case.lines)]
    near = np.array([1e-3])
    fallen = float(case.drop(near)[0])
    if fallen > 0.0:
        # Contact radius of a first touch: sqrt(R d), with R from the profile itself.
        tip = float(near[0] ** 2 / (2.0 * fallen))
        first = min(first, 1.3 * np.sqrt(tip * case.first) * 8.0 / cells)
        places.append(0.0)
        sizes.append(first)
    wanted = Sizes(places, sizes, SIZE_SLOPE, coarse, case.radius)
    r = lines_by_size(0.0, case.extent, (*case.lines, case.radius), wanted.at, SPARE)
    layers = case.shape.layers()
    interface = layers[0] / case.thickness_mm if layers else None
    return r, height_lines(min(first, top), interface), interface


# Load steps in thicknesses, at 16 cells, while a contact grows that sticks: half of them moves a force by at most
# 0.35 %, twice as much by 1.2 %. Wanted depths are solved beside the path, which is the same whatever they are. Other
# contact takes larger ones.
LARGEST_STEP = 0.005
# The same under a flat top, where only what is drawn to the fillet comes to touch: half of it moves the ratio to the
# slab by at most 0.25 %, twice as much by 1 %.
FLAT_STEP = 0.015
FREE_STEP = 0.03
FIRST_DEPTH = 0.02
SMALLEST_STEP = 3e-4


# Ends of the steps of the paths followed last that do not fold, for whoever wants fields on the way; so many paths, the
# oldest first.
_VISITED: dict[tuple[Case, int, float], list[VisitedState]] = {}
MOST_VISITED = 8


def visited_states(case: Case, cells: int, rim: float, deepest: float) -> list[VisitedState]:
    """Ends of the steps of a path of this pad that was followed beyond a depth in this process; empty without one."""
    known = _VISITED.get((case, cells, rim), [])
    return known if known and known[-1].depth >= deepest * (1.0 - 1e-9) else []


def solve_path(
    case: Case, depths: Array, cells: int = CELLS, rim: float = RIMS[-1], twin: bool = False,
    visit: Callable[[Problem, float, Solution], None] | None = None,
) -> Path:  # fmt: skip
    """Follow the pad under a punch with one edge fillet."""
    problem = shaped_problem(case, cells, rim, twin)
    watch = None if twin or case.shape.flat_top else FoldWatch(RoundFace(problem, case.thickness_mm))

    def check(depth: float, solution: Solution) -> str | None:
        if watch is not None and (folded := watch.check(depth, solution.u)):
            return folded
        if visit is not None:
            visit(problem, depth, solution)
        return None

    first, largest, lattice = 0.25 * case.first, LARGEST_STEP * CELLS / cells, True
    if case.condition == "frictionless":
        # Contact without memory: the force is the same whatever the steps were.
        largest, lattice = FREE_STEP, False
    elif case.shape.flat_top:
        first, largest = 0.3 * rim, FLAT_STEP
    ends: list[VisitedState] = []
    keep = ends.append if watch is not None and lattice else None
    path = follow(problem, depths, first, largest, SMALLEST_STEP, lattice=lattice, visit=check, keep=keep)
    if watch is None:
        return path
    if watch.folded is None:
        if len(_VISITED) >= MOST_VISITED:
            _VISITED.pop(next(iter(_VISITED)))
        # Up to the last state that was checked for a fold.
        last = path.depth[-1] if len(path.depth) else 0.0
        _VISITED[case, cells, rim] = [end for end in ends if end.depth <= last * (1.0 + 1e-9)]
    return watch.with_stop_reason(path, ends[-1].u if ends else None)


class PathCache:
    """Paths of one pad and its depths that were followed already, by grid.

    ``touched`` has, of a pad that is touched gradually, every depth, the radius of its contact, and whether that
    is the punch's edge, from the finest grid. [thicknesses]
    """

    def __init__(self) -> None:
        self._paths: dict[tuple[int, float, bool], Path] = {}
        self.touched: list[tuple[float, float, bool]] = []

    def path(self, case: Case, depths: Array, grid: tuple[int, float], twin: bool) -> Path:
        """The path on one grid, followed now if it was not yet."""
        key = (*grid, twin)
        if key not in self._paths:
            visit = self._touch if grid == grids(CELLS, case)[-2] and not case.shape.flat_top else None
            self._paths[key] = solve_path(case, depths, *grid, twin=twin, visit=visit)
        return self._paths[key]

    def _touch(self, problem: Problem, depth: float, solution: Solution) -> None:
        self.touched.append((depth, *radius_touched(problem, depth, solution)))


def radius_touched(problem: Problem, depth: float, solution: Solution) -> tuple[float, bool]:
    """Radius of the contact at an equilibrium, and whether it has reached the fillet of the punch's edge."""
    surface, punch = problem.surface, problem.punch
    if isinstance(surface, CombinedSurface):
        surface = surface.face
    assert isinstance(surface, Surface) and punch is not None
    points = surface.points(solution.u)
    touching = punch.gap(points, depth)[0] <= 0.0
    glued = np.unique(problem.driven // 2)
    moved = problem.solid.mesh.nodes[0, glued] + solution.u.reshape(-1, 2)[glued, 0]
    radius = float(max(np.max(points[..., 0], where=touching, initial=0.0), np.max(moved, initial=0.0)))
    return radius, isinstance(punch, FlatPunch) and radius >= punch.flat_radius


def first_depth(depths: Array) -> float:
    """Depth that the apex is meshed for: 0.02, halved until no wanted depth is smaller."""
    return FIRST_DEPTH * 0.5 ** max(0, int(np.ceil(np.log2(FIRST_DEPTH / float(depths[0])) - 1e-9)))


def grids(cells: int, case: Case) -> list[tuple[int, float]]:
    """Cells and fillet of the solves: large fillet, small fillet, small fillet on cells of twice the size.

    A real fillet is solved as it is, without the first.
    """
    if case.edge:
        rim = case.edge / case.scale
        return [(cells, rim), (max(4, cells // 2), rim)]
    return [(cells, RIMS[0]), (cells, RIMS[1]), (max(4, cells // 2), RIMS[1])]


@dataclass(frozen=True)
class Touch:
    """Radius of the contact, in the deformed state, at depths that were reached. [mm]

    ``reaches_edge`` is where the contact has come to the punch's edge.
    """

    depth_mm: Array
    contact_radius_mm: Array
    reaches_edge: Array

    def radius_at(self, depth_mm: Array) -> Array:
        """Contact radius at other depths, on straight lines between the solved ones. [mm]"""
        known = np.concatenate([[0.0], self.depth_mm])
        return np.interp(depth_mm, known, np.concatenate([[0.0], self.contact_radius_mm]), right=np.nan)


def contact_radius(pad: Pad, depth_mm: Sequence[float] | Array, cells: int = CELLS) -> Touch:
    """Press a round shaped pad with a round flat punch and find how far the contact reaches."""
    depths = np.asarray(depth_mm, dtype=float) / pad.thickness_mm
    case = replace(Case.of(pad), first=float(depths[0]))
    inputs = {"case": case, "depth": depths, "cells": cells}
    return Touch(**cached("touch", inputs, lambda: _touch(case, depths, cells)))


def _touch(case: Case, depths: Array, cells: int) -> dict[str, Any]:
    problem = shaped_problem(case, cells)
    rows: list[tuple[float, bool]] = []

    def measure(depth: float, solution: Solution) -> None:
        rows.append(radius_touched(problem, depth, solution))

    path = follow(problem, depths, 0.25 * float(depths[0]), FREE_STEP, SMALLEST_STEP, visit=measure)
    radius, edge = np.array(rows).reshape(-1, 2).T
    return {
        "depth_mm": path.depth * case.thickness_mm,
        "contact_radius_mm": np.minimum(radius, case.radius) * case.thickness_mm,
        "reaches_edge": edge > 0.0,
    }
