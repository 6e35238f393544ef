"""A shaped pad under a round flat punch: finite-element problem, load steps, contact radius."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError
from dummydesign.core.parsing import one_of
from dummydesign.core.progress import tell_depth
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.pad.axisymmetric.case import FILM_REACH, Case, glue_film, round_problem
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, RoundFace
from dummydesign.pad.contact.axisymmetric import (
    GROWN_SLIP,
    ROUND_SHAPED_PAD,
    Array,
    AxisymmetricSurface,
    FilletedPunch,
    FlatPunch,
)
from dummydesign.pad.contact.friction import CombinedSurface
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import STABILISATION
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import WITHOUT_TIES, ForcePath, VisitedState, follow, force_between
from dummydesign.pad.solve.equilibrium import ContactProblem, Equilibrium

# Fillets at the punch's edge over the smaller of radius and thickness.
RIMS = (0.1, 0.05)
CELLS = 16
# Size of the cells at the edge and under the face of a pad that is touched gradually, over that of the others. With 1
# the force was up to 6.5 % too high once the contact had come to the edge, with 0.25 it is within 0.9 % (d/h to 0.6);
# flat tops are divided by a slab on the same cells, where this cancels.
EDGE_REFINEMENT = 0.25
# Cells grow by this share of their distance from where they are wanted fine; a part of one that is no cell of its own.
SIZE_SLOPE, SPARE = 0.25, 0.2
# So many thicknesses beside the punch and further out they grow by this share more: it changes forces by 0.01 %.
FAR, FAR_SLOPE = 1.0, 0.5


def shaped_problem(
    case: Case,
    cells: int = CELLS,
    rim: float = RIMS[-1],
    twin: bool = False,
    refinement: float = EDGE_REFINEMENT,
    lines: tuple[Array, Array] | None = None,
) -> ContactProblem:
    """The pad under a punch with an edge fillet; its ``twin`` is the slab on the same cells.

    ``lines`` are radii and shares of the column to take instead of its own.
    """
    face = Interface.parse(case.condition, "condition", FACES)
    one_of("base", case.base, BASES)
    shape, shear, coarse = case.shape, case.law.shear_MPa, case.radius / cells
    # Without a fillet of its own the punch has no sides.
    punch = FilletedPunch(case.radius, case.edge or rim * case.scale, sides=case.edge > 0.0)
    # A crown has the same cells under every fillet that stands for a sharp edge: what they leave out cancels.
    finest = punch.rim if case.edge or shape.flat_top else RIMS[-1] * case.scale
    r, share, interface = (*lines, None) if lines else _grid(case, cells, finest, refinement)
    points, quads, row = meshes.columns(r, share)
    nothing = np.zeros_like
    move = meshes.stretch(nothing, nothing) if twin else meshes.stretch(case.drop, case.bone)
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
    surface = AxisymmetricSurface(
        mesh.nodes,
        top[near],
        strength,
        film,
        ROUND_SHAPED_PAD.grip_share * strength * float(face.bonded),
        punch.flat_radius if len(glued) else 0.0,
        face.coulomb or 0.0,
        0.02 * coarse,
        ties_within_step=True,
        slip_share=1.0 if shape.flat_top else GROWN_SLIP,
        changes=MOST_CHANGES if face.bonded and not shape.flat_top else 0,
    )
    return round_problem(mesh, case, glued, surface, punch, carried, STABILISATION, below)


def _grid(case: Case, cells: int, rim: float, refinement: float) -> tuple[Array, Array, float | None]:
    """Radii, shares of the column, and the share at which layers meet."""
    coarse = case.radius / cells
    first = min(coarse, 1.6 / cells)
    finer = 1.0 if case.shape.flat_top else refinement
    top = finer * min(coarse, 1.0 / cells)
    places = [case.radius - 0.5 * rim, *case.lines]
    sizes = [min(coarse, finer * 16.0 / cells * rim), *[0.6 * coarse] * len(case.lines)]
    tip = case.tip
    if tip is not None:
        # Contact radius of a first touch: sqrt(R d).
        first = min(first, 1.3 * np.sqrt(tip * case.first) * 8.0 / cells)
        places.append(0.0)
        sizes.append(first)
    wanted = meshes.Sizes(places, sizes, SIZE_SLOPE, coarse, case.radius)

    def size(x: Array) -> Array:
        far: Array = wanted.at(x) + FAR_SLOPE * np.maximum(x - case.radius - FAR, 0.0)
        return far

    r = meshes.lines_by_size(0.0, case.extent, (*case.lines, case.radius), size, SPARE)
    layers = case.shape.layers()
    interface = layers[0] / case.thickness_mm if layers else None
    return r, meshes.height_lines(min(first, top), interface), interface


# Load steps in thicknesses, at 16 cells, while a contact grows that sticks: half of them moves a force by at most
# 0.2 %. Wanted depths lie between their ends. Other contact takes larger ones.
LARGEST_STEP = 0.01
# The same under a flat top, where only what is drawn to the fillet comes to touch: half of it moves the ratio to the
# slab by at most 0.25 %, twice as much by 1 %.
FLAT_STEP = 0.015
FREE_STEP = 0.03
# A tip is meshed for a contact of half the radius of the smallest one whose force is solved (``first_touch``), or of
# the smallest depth; the first step ends there, or at the last of these depths.
FIRST_CONTACT, LEAST_DEPTH, FIRST_END = 0.05, 1e-4, 0.005
# Changes of contact that sticks and grows within a step of the linearised solid. A flat top's, all at once, does not
# settle so, free steps are long, and friction's matrices are not symmetric: none there.
MOST_CHANGES = 4
# Smallest step, and over the first one.
SMALLEST_STEP, SMALLEST_SHARE = 3e-4, 1.0 / 32.0
# Large cells that are only compared with are left where one of them is crumpled to this share of its volume.
SOUND_J = 0.25
# Tangents that failed steps may cost before a path ends.
MOST_WASTED = 60
# Steps of a contact without memory may be this long; over it, as they grow where nothing is tied.
LONGEST_FREE = FREE_STEP / WITHOUT_TIES


# Ends of the steps of the paths followed last, for whoever wants fields on the way; so many paths, the oldest first.
_VISITED: dict[tuple[Case, int, float], list[VisitedState]] = {}
MOST_VISITED = 8


def visited_states(case: Case, cells: int, rim: float, deepest: float) -> list[VisitedState]:
    """Ends of the steps of a path of this pad that was followed beyond a depth in this process; empty without one."""
    known = _VISITED.get((case, cells, rim), [])
    return known if known and known[-1].depth >= deepest * (1.0 - 1e-9) else []


def meshed(case: Case) -> Case:
    """The case with the depth that its tip is meshed for, by the tip's radius alone."""
    return case if case.tip is None else replace(case, first=max(FIRST_CONTACT**2 / case.tip, LEAST_DEPTH))


def load_steps(case: Case, cells: int, rim: float) -> tuple[float, float, float]:
    """The first, the largest and the smallest load step: what the pad, not a list of depths, asks for."""
    first, largest = min(case.first, FIRST_END), LARGEST_STEP * CELLS / cells
    if case.condition == "frictionless":
        largest = LONGEST_FREE
    elif case.shape.flat_top:
        first, largest = 0.3 * rim, FLAT_STEP
    return first, largest, min(SMALLEST_STEP, SMALLEST_SHARE * first)


@dataclass(frozen=True)
class Climb:
    """A path as far as it was followed: ends of its steps, why it ends where no depth was reached, and its cost."""

    ends: tuple[VisitedState, ...]
    path: ForcePath

    @property
    def reached(self) -> float:
        """The deepest end of a step."""
        return self.ends[-1].depth if self.ends else 0.0

    def at(self, depths: Array) -> ForcePath:
        """Forces at the depths that were reached, between the ends of steps."""
        kept = depths[depths <= self.reached * (1.0 + 1e-9)]
        force, doubt = force_between(self.ends, kept) if len(kept) else (kept, kept)
        smallest = [end.smallest_J for end in self.ends]
        J = np.interp(kept, [end.depth for end in self.ends], smallest) if len(kept) else kept
        stop = None if len(kept) == len(depths) else self.path.stop
        return replace(self.path, depth=kept, force=force, smallest_J=J, stop=stop, doubt=doubt)


def climb(
    case: Case,
    deepest: float,
    cells: int = CELLS,
    rim: float = RIMS[-1],
    twin: bool = False,
    visit: Callable[[ContactProblem, VisitedState], None] | None = None,
    smaller: Climb | None = None,
    sound_J: float = 0.0,
) -> Climb:
    """Follow the pad under a punch with one edge fillet to the second end of a step beyond a depth.

    ``visit`` is called with every end of a step. ``smaller`` is the path of a crown under a smaller fillet on the same
    cells, which this one shares until the contact comes to its own fillet. The path ends where the smallest volume
    ratio is below ``sound_J``.
    """
    problem = shaped_problem(case, cells, rim, twin)
    watch = None if twin or case.shape.flat_top else FoldWatch(RoundFace(problem, case.thickness_mm))
    ends = [] if smaller is None else list(takewhile(partial(_inside, problem), smaller.ends))

    def keep(end: VisitedState) -> str | None:
        if watch is not None and (folded := watch.check(end.depth, end.u)):
            return folded
        if end.smallest_J < sound_J:
            return f"a volume ratio fell below {sound_J:g} at relative depth {end.depth:.3f}"
        ends.append(end)
        if visit is not None:
            visit(problem, end)
        tell_depth(end.depth)
        # Forces between ends know of the next end but one, the first of the first three.
        far = len(ends) >= LEAST_ENDS and ends[-2].depth >= deepest * (1.0 - 1e-9)
        return FAR_ENOUGH if far else None

    path = follow(
        problem,
        [np.inf],
        *load_steps(case, cells, rim),
        lattice=True,
        keep=keep,
        most_wasted=MOST_WASTED,
        after=tuple(ends),
    )
    path = replace(path, stop=None if path.stop == FAR_ENOUGH else path.stop)
    if watch is None:
        return Climb(tuple(ends), path)
    if len(_VISITED) >= MOST_VISITED:
        _VISITED.pop(next(iter(_VISITED)))
    _VISITED[case, cells, rim] = ends
    return Climb(tuple(ends), watch.with_stop_reason(path, ends[-1].u if ends else None))


FAR_ENOUGH, LEAST_ENDS = "far enough", 4


def _inside(problem: ContactProblem, end: VisitedState) -> bool:
    """Whether a contact, under whatever fillet, is inside the flat face of a problem's punch."""
    points = _face(problem).points(end.u)
    assert isinstance(problem.punch, FlatPunch)
    return bool(np.all(points[..., 0][points[..., 1] + end.depth >= 0.0] < problem.punch.flat_radius))


def _face(problem: ContactProblem) -> AxisymmetricSurface:
    """The surface that the punch presses."""
    surface = problem.surface.face if isinstance(problem.surface, CombinedSurface) else problem.surface
    assert isinstance(surface, AxisymmetricSurface)
    return surface


def solve_path(
    case: Case,
    depths: Array,
    cells: int = CELLS,
    rim: float = RIMS[-1],
    twin: bool = False,
    visit: Callable[[ContactProblem, VisitedState], None] | None = None,
) -> ForcePath:
    """Forces of the pad under a punch with one edge fillet at depths."""
    return climb(case, float(np.max(depths)), cells, rim, twin, visit).at(np.asarray(depths, float))


class PathCache:
    """Paths of one pad that were followed already, by grid.

    ``touched`` has, of a pad that is touched gradually, ends of steps and the radius of the contact there, from the
    finest grid. [thicknesses]
    """

    def __init__(self) -> None:
        self._climbs: dict[tuple[int, float, bool], Climb] = {}
        self.touched: list[tuple[float, float]] = []

    def climb(self, case: Case, deepest: float, grid: tuple[int, float], twin: bool, sound_J: float = 0.0) -> Climb:
        """The path on one grid, followed now if it was not yet."""
        key = (*grid, twin)
        if key not in self._climbs:
            visit = self._touch if grid == grids(CELLS, case)[0] and not case.shape.flat_top else None
            cells, rim = grid
            crown = not case.edge and not case.shape.flat_top
            smaller = self._climbs.get((cells, RIMS[1], twin)) if crown and rim == RIMS[0] else None
            self._climbs[key] = climb(case, deepest, *grid, twin, visit, smaller, sound_J)
        return self._climbs[key]

    def _touch(self, problem: ContactProblem, end: VisitedState) -> None:
        self.touched.append((end.depth, radius_touched(problem, end.depth, end.u)[0]))


def radius_touched(problem: ContactProblem, depth: float, u: Array) -> tuple[float, bool]:
    """Radius of the contact at displacements, and whether it has reached the fillet of the punch's edge."""
    punch, points = problem.punch, _face(problem).points(u)
    assert punch is not None
    touching = punch.gap(points, depth)[0] <= 0.0
    glued = np.unique(problem.driven // 2)
    moved = problem.solid.mesh.nodes[0, glued] + u.reshape(-1, 2)[glued, 0]
    radius = float(max(np.max(points[..., 0], where=touching, initial=0.0), np.max(moved, initial=0.0)))
    return radius, isinstance(punch, FlatPunch) and radius >= punch.flat_radius


def grids(cells: int, case: Case) -> list[tuple[int, float]]:
    """Cells and fillet of the solves: small fillet, the same on cells of twice the size, large fillet.

    A real fillet is solved as it is, without the last.
    """
    coarse = max(4, cells // 2)
    if case.edge:
        rim = case.edge / case.scale
        return [(cells, rim), (coarse, rim)]
    return [(cells, RIMS[1]), (coarse, RIMS[1]), (cells, RIMS[0])]


@dataclass(frozen=True)
class Touch:
    """Radius of the contact, in the deformed state, at depths that were reached. [mm]"""

    depth_mm: Array
    contact_radius_mm: Array

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
    radius: list[float] = []

    def measure(depth: float, solution: Equilibrium) -> None:
        radius.append(radius_touched(problem, depth, solution.u)[0])

    path = follow(problem, depths, 0.25 * float(depths[0]), FREE_STEP, SMALLEST_STEP, visit=measure)
    return {
        "depth_mm": path.depth * case.thickness_mm,
        "contact_radius_mm": np.minimum(radius, case.radius) * case.thickness_mm,
    }
