"""Solve the fields of a round pad at static depths.

A punch with a fillet of its own has that one. A sharp one has the fillet of the finest shaped solve (0.05 of the
smaller of punch radius and thickness); the force of these fields is the one with it, not the limit of a sharp edge.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.pad.axisymmetric.case import (
    FIRST_STEP,
    LATTICE,
    Case,
    Progress,
    lattice_depths,
    relative_depths,
    rimmed_problem,
)
from dummydesign.pad.axisymmetric.filleted import filleted_problem
from dummydesign.pad.axisymmetric.friction import (
    COARSE,
    FINE,
    SlidingMesh,
    follow_rubbing,
    follow_sliding,
    rubbing_problem,
)
from dummydesign.pad.axisymmetric.profile_punch import CELLS as PROFILE_CELLS
from dummydesign.pad.axisymmetric.profile_punch import edge_problem, load_steps, profile, profile_problem
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, RoundFace
from dummydesign.pad.axisymmetric.shaped_problem import (
    CELLS,
    LARGEST_STEP,
    SMALLEST_STEP,
    first_depth,
    radius_touched,
    shaped_problem,
    visited_states,
)
from dummydesign.pad.contact.axisymmetric import FlatPunch, ProfilePunch
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fields.stress import FREE, SLIPS, STICKS, Face, Pressed, face_tractions, recovered
from dummydesign.pad.solve.continuation import Path, VisitedState, follow, state_between
from dummydesign.pad.solve.equilibrium import Problem, Solution
from dummydesign.pad.specimen import SLAB, Pad, Puck

Array = np.ndarray

# Depths of the path that are nearer than this to a wanted one are left out, over their own size.
NEAR = 0.1


Keep = Callable[[Problem, Solution, float], None]


def _follow_under_fillet(
    case: Case, depths: Array, thickness_mm: float, coarse: bool, progress: Progress | None, keep: Keep
) -> tuple[str | None, tuple[str, ...]]:
    """Follow a slab that is not glued to a filleted punch and keep its states at wanted depths."""
    found, stop = 0, None
    notes: tuple[str, ...] = ()
    for cells in (COARSE,) if coarse else (FINE, COARSE):
        wanted, path = depths[found:], _with_lattice(depths)
        problem, follow = _slipping(case, cells)

        def visit(depth: float, solution: Solution, problem: Problem = problem, wanted: Array = wanted) -> None:
            if np.isclose(wanted, depth, rtol=1e-9, atol=0.0).any():
                keep(problem, solution, depth)

        made = follow(path, progress, visit)
        before, found = found, int((depths <= (made.depth[-1] if len(made.depth) else 0.0) * (1.0 + 1e-9)).sum())
        if cells == COARSE and not coarse and found > before:
            start = f"{depths[before] * thickness_mm:.3g} mm"
            notes = (f"fields from {start} on are those of cells of 1.5 times the size: finer ones end before",)
        found, stop = max(found, before), made.stop
        if found == len(depths):
            return None, notes
    return stop, notes


def _slipping(case: Case, cells: int) -> tuple[Problem, Callable[..., Path]]:
    """The problem of a face with or without friction, and what follows it."""
    if not Interface.parse(case.condition, "condition", FACES).friction:
        mesh = SlidingMesh(case, cells)
        return mesh.problem, lambda *args: follow_sliding(mesh, *args)
    problem = rubbing_problem(case, cells)
    return problem, lambda *args: follow_rubbing(problem, *args)


def _with_lattice(depths: Array) -> Array:
    """Wanted depths and those of the force's own path between them."""
    path = lattice_depths(float(depths[-1]))
    room = NEAR * np.minimum(path, LATTICE)
    apart = np.abs(path[:, None] - depths).min(axis=1) > room
    return np.union1d(path[apart & (path < depths[-1])], depths)


RIM = 0.05
# A place touches where its pressure is above this share of the largest.
TOUCHES = 1e-3
# A place slips where its shear is this share of Coulomb's limit (the regularised law reaches 1 only for large slip).
SLIP_SHARE = 0.95


@dataclass(frozen=True)
class Setup:
    """A problem of finite elements in thicknesses and shear moduli, and how its path is followed or was already."""

    problem: Problem
    first_step: float
    largest_step: float
    smallest_step: float
    lattice: bool = False
    visited: tuple[VisitedState, ...] = ()


def solve_fields(
    pad: Pad | Puck, depth_mm: Sequence[float], progress: Progress | None = None, coarse: bool = False
) -> tuple[tuple[Pressed, ...], tuple[str, ...]]:
    """Fields of a round pad at static depths."""
    if not has_fields(pad):
        what = "pad = cylinder between plates" if isinstance(pad, Puck) else f"shape {pad.geometry}"
        message = f"fields are for round pads under a punch; {what} has none yet"
        raise InputError(message, "unsupported", "fields", what)
    depths, shear = relative_depths(depth_mm, pad.thickness_mm), pad.shear_MPa
    found: list[Pressed] = []

    def keep(problem: Problem, solution: Solution, depth: float) -> None:
        found.append(_pressed(problem, solution, depth, pad, shear))

    stop, notes = _follow(pad, depths, coarse, progress, keep)
    if not found:
        raise NoAnswerError("no_convergence", f"the fields could not be solved: {stop}", quantity="fields")
    if pad.sides_mm is not None:
        notes += (f"fields are those of a round punch of equal area, radius {pad.radius_mm:.4g} mm",)
    if stop:
        notes += (f"fields were solved to {found[-1].depth_mm:.3g} mm: {stop}",)
    return tuple(found), notes


def has_fields(pad: Pad | Puck) -> TypeGuard[Pad]:
    """Whether the pad is round and under a punch."""
    return isinstance(pad, Pad) and pad.geometry.axisymmetric


def contact_pressures(pad: Pad, depth_mm: Sequence[float]) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """Mean, peak and profile of the contact pressure at static depths; solves are kept in the cache."""
    def solve() -> dict[str, Any]:
        fields, notes = solve_fields(pad, depth_mm)
        return {"contact": [pressed.contact() for pressed in fields], "notes": list(notes)}

    made = cached("contact", {"pad": replace(pad, prony=()), "depth": np.asarray(depth_mm, dtype=float)}, solve)
    return made["contact"], tuple(made["notes"])


def _follow(
    pad: Pad, depths: Array, coarse: bool, progress: Progress | None, keep: Keep
) -> tuple[str | None, tuple[str, ...]]:
    """Keep the equilibria at depths; return why some are missing, and notes on the others."""
    case = Case.of(pad, check=pad.profile_mm is None)
    if pad.edge_radius_mm and pad.condition != "bonded":
        return _follow_under_fillet(case, depths, pad.thickness_mm, coarse, progress, keep)
    setup = _setup(pad, case, depths, coarse)
    if setup.visited:
        solutions = [state_between(setup.problem, setup.visited, depth) for depth in depths]
        reached = [one for one in solutions if isinstance(one, Solution)]
        if len(reached) == len(depths):
            for depth, solution in zip(depths, reached):
                keep(setup.problem, solution, depth)
            return None, ()
        setup = _setup(pad, case, depths, coarse)
    watch = None if pad.geometry.flat_top else FoldWatch(RoundFace(setup.problem, pad.thickness_mm))

    def visit(depth: float, solution: Solution) -> str | None:
        if watch is not None and (folded := watch.check(depth, solution.u)):
            return folded
        keep(setup.problem, solution, depth)
        return None

    path = follow(
        setup.problem, depths, setup.first_step, setup.largest_step, setup.smallest_step, progress,
        lattice=setup.lattice, visit=visit,
    )  # fmt: skip
    return path.stop if watch is None else watch.stop_reason(path.stop), ()


def _setup(pad: Pad, case: Case, depths: Array, coarse: bool) -> Setup:
    """The problem that the pad's own curve is solved by, with one fillet."""
    scale = case.scale
    if pad.geometry != SLAB:
        case = replace(case, first=first_depth(depths))
        flat, cells = pad.geometry.flat_top, CELLS // 2 if coarse else CELLS
        visited = () if flat else tuple(visited_states(case, cells, RIM, float(depths[-1])))
        first, largest = 0.3 * RIM if flat else 0.25 * case.first, LARGEST_STEP * CELLS / cells
        return Setup(shaped_problem(case, cells, RIM), first, largest, SMALLEST_STEP, True, visited)
    if pad.profile_mm is not None:
        punch = ProfilePunch(profile(*(np.asarray(part) / pad.thickness_mm for part in pad.profile_mm)).height)
        cells = PROFILE_CELLS // 2 if coarse else PROFILE_CELLS
        first, largest, lattice = load_steps(pad.condition, float(depths[0]))
        return Setup(profile_problem(case, punch, float(depths[0]), cells), first, largest, first / 64.0, lattice)
    if pad.condition != "bonded" or pad.base not in BASES:
        rim = RIM * scale
        return Setup(edge_problem(replace(case, edge=rim)), 0.1 * rim, 0.05 * scale, 0.002 * scale)
    if pad.edge_radius_mm:
        return Setup(filleted_problem(case), FIRST_STEP, LATTICE, LATTICE / 256.0, True)
    made = rimmed_problem(case, RIM * scale, meshes.Resolution(cells=3 if coarse else 6))
    return Setup(made, RIM * scale, 0.05 * scale, 0.005 * scale)


def _pressed(problem: Problem, solution: Solution, depth: float, pad: Pad, shear: float) -> Pressed:
    """The fields of one equilibrium in mm and MPa."""
    solid, h = problem.solid, pad.thickness_mm
    mesh = solid.mesh
    factor = np.ones(len(mesh.weight)) if mesh.modulus_factor is None else mesh.modulus_factor
    stress, stretch = recovered(solid, solution, factor)
    bottom = float(mesh.nodes[1].min())
    lift = np.array([0.0, bottom])
    moved = solution.u.reshape(-1, 2)
    used = np.unique(meshes.cell_nodes(mesh))
    number = np.full(mesh.nodes.shape[1], -1)
    number[used] = np.arange(len(used))
    face = _face(problem, solution, depth, pad)
    outline = _outline(problem, depth, pad.radius_mm / h)
    face = Face(
        number[face.node], face.radius_mm * h, (face.height_mm - bottom) * h, face.rest_mm * h,
        face.pressure_MPa * shear, face.shear_MPa * shear, face.state,
        face.contact_radius_mm * h,
    )  # fmt: skip
    return Pressed(
        depth * h, problem.force(solution.state) * shear * h * h, (mesh.nodes.T - lift)[used] * h, moved[used] * h,
        number[meshes.cell_nodes(mesh)], stress[used] * shear, stretch[used], face, (outline - lift) * h,
    )  # fmt: skip


def _face(problem: Problem, solution: Solution, depth: float, pad: Pad) -> Face:
    """The tested face in the problem's own units."""
    solid = problem.solid
    sides = face_sides(problem)
    found = face_tractions(solid.mesh.nodes, solution.u, solution.state.internal_force, sides)
    node, pressure, drag = found["node"], found["pressure"], found["shear"]
    touches = pressure > TOUCHES * pressure.max()
    driven = problem.driven[problem.driven % 2 == 1] // 2
    touches |= np.isin(node, driven)
    face = Interface.parse(pad.condition, "condition", FACES)
    state = np.where(touches, STICKS, FREE)
    if not face.bonded:
        limit = SLIP_SHARE * (face.coulomb or 0.0) * pressure
        state = np.where(touches & (np.abs(drag) >= limit), SLIPS, state)
    pressure, drag = np.where(touches, pressure, 0.0), np.where(touches, drag, 0.0)
    place = solid.mesh.nodes[:, node] + solution.u.reshape(-1, 2).T[:, node]
    (reach, at_edge), punch = radius_touched(problem, depth, solution), problem.punch
    if not pad.edge_radius_mm and at_edge and isinstance(punch, FlatPunch):
        reach = punch.radius  # the fillet stands for a sharp edge, which is reached
    return Face(node, place[0], place[1], solid.mesh.nodes[0, node], pressure, drag, state, reach)


def face_sides(problem: Problem) -> Array:
    """Sides of the tested face: those of one cell only that lie neither on the axis, the base nor the rim."""
    mesh = problem.solid.mesh
    node = meshes.cell_nodes(mesh)
    three = np.concatenate([node[:, [i, side, j]] for side, i, j in meshes.PATCH_SIDES])
    middle, counts = np.unique(three[:, 1], return_counts=True)
    once = np.isin(three[:, 1], middle[counts == 1])
    r = mesh.nodes[0]
    length = np.linalg.norm(mesh.nodes[:, three[:, 0]] - mesh.nodes[:, three[:, 2]], axis=0)
    base = np.zeros(mesh.nodes.shape[1], dtype=bool)
    base[problem.base // 2] = True
    near = 1e-9
    elsewhere = base[three].all(axis=1) | (r[three] < near).all(axis=1) | (r[three] > r.max() - near).all(axis=1)
    return three[once & ~elsewhere & (length > 1e-12)]


def _outline(problem: Problem, depth: float, radius: float) -> Array:
    """Lower outline of the punch from the axis out, then up."""
    punch: Any = problem.punch
    if hasattr(punch, "height"):
        r = np.linspace(0.0, radius, 200)
        return np.stack([r, np.asarray(punch.height(r)[0]) - depth], axis=1)
    rim = getattr(punch, "rim", 0.0)
    turn = np.linspace(0.0, 0.5 * np.pi, 30)
    flat = radius - rim
    bend = np.stack([flat + rim * np.sin(turn), rim * (1.0 - np.cos(turn)) - depth], axis=1)
    return np.concatenate([[[0.0, -depth]], bend, [[radius, 0.3 + rim]]])
