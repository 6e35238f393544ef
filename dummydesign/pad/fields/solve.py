"""Solve the fields of a round pad at static depths.

A punch with a fillet of its own has that one. A sharp one has the fillet of the finest shaped solve (0.05 of the
smaller of punch radius and thickness); the force of these fields is the one with it, not the limit of a sharp edge.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fields.pressed import FREE, SLIPS, STICKS, Face, Pressed
from dummydesign.pad.fields.recover import face_tractions, recovered
from dummydesign.pad.pad import SLAB, Pad, Puck
from dummydesign.pad.shaped.fold import FoldWatch, RoundFace
from dummydesign.pad.shaped.paths import radius_touched
from dummydesign.pad.solve.continuation import Passed, beside_path, follow
from dummydesign.pad.solve.equilibrium import Problem, Solution

Array = np.ndarray

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
    passed: tuple[Passed, ...] = ()


def solve_fields(
    pad: Pad | Puck, depth_mm: Sequence[float], progress: Callable[[float], None] | None = None, coarse: bool = False
) -> tuple[tuple[Pressed, ...], tuple[str, ...]]:
    """Fields of a round pad at static depths.

    Parameters
    ----------
    pad : Pad
        A slab or a round shaped pad under a round punch or a profile; a square punch is taken as the circle of equal
        area.
    depth_mm : sequence of float, shape (depths,)
        Depths above 0, increasing or not. [mm]
    progress : callable, optional
        Called with each solved depth over thickness.
    coarse : bool
        On cells of twice the size, for pictures: a third of the work. Pressures inside 0.9 of the contact's radius
        then differ by up to 2 %.

    Returns
    -------
    fields : tuple of Pressed
        At the depths that were reached.
    notes : tuple of str
        Why some are missing, and what was taken for what.

    Raises
    ------
    InputError
        For a pad that is not round, or depths outside the validity.
    NoAnswerError
        When no depth could be solved.
    """
    from dummydesign.pad.slab.problem import normalise

    if not has_fields(pad):
        what = "pad = cylinder between plates" if isinstance(pad, Puck) else f"shape {pad.geometry}"
        raise InputError(f"fields are for round pads under a punch; {what} has none yet")
    h = pad.thickness_mm
    law, depths, _, shear = normalise(h, pad.radius_mm, pad.young_MPa, depth_mm, pad.poisson, pad.shape)
    found: list[Pressed] = []

    def keep(problem: Problem, solution: Solution, depth: float) -> None:
        found.append(_pressed(problem, solution, depth, pad, shear))

    stop, notes = _follow(pad, law, depths, shear, coarse, progress, keep)
    if not found:
        raise NoAnswerError("no_convergence", f"the fields could not be solved: {stop}")
    if pad.sides_mm is not None:
        notes += (f"fields are those of a round punch of equal area, radius {pad.radius_mm:.4g} mm",)
    if stop:
        notes += (f"fields were solved to {found[-1].depth_mm:.3g} mm: {stop}",)
    return tuple(found), notes


def has_fields(pad: Pad | Puck) -> TypeGuard[Pad]:
    """Whether the pad is round and under a punch."""
    return isinstance(pad, Pad) and pad.geometry.axisymmetric


def contact_pressures(pad: Pad, depth_mm: Sequence[float]) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """Mean, peak and profile of the contact pressure at static depths; solves are kept in the cache.

    Returns
    -------
    contact : list of dict
        As the method ``contact`` of ``Pressed`` gives them, at the depths that were reached.
    notes : tuple of str
    """
    from dummydesign.core.cache import cached

    def solve() -> dict[str, Any]:
        fields, notes = solve_fields(pad, depth_mm)
        return {"contact": [pressed.contact() for pressed in fields], "notes": list(notes)}

    made = cached("contact", {"pad": replace(pad, prony=()), "depth": np.asarray(depth_mm, dtype=float)}, solve)
    return made["contact"], tuple(made["notes"])


def _follow(
    pad: Pad, law: Any, depths: Array, shear: float, coarse: bool, progress: Callable[[float], None] | None,
    keep: Callable[[Problem, Solution, float], None],
) -> tuple[str | None, tuple[str, ...]]:  # fmt: skip
    """Hand over the equilibria at depths; why some are missing, and what is said of the others."""
    if pad.edge_radius_mm and pad.condition != "bonded":
        from dummydesign.pad.fields.sliding import follow_states

        moved = follow_states(pad, law, depths, coarse, progress, keep)
        return moved.stop, moved.notes
    setup = _setup(pad, law, depths, shear, coarse)
    if setup.passed:
        solutions = [beside_path(setup.problem, setup.passed, depth) for depth in depths]
        reached = [one for one in solutions if isinstance(one, Solution)]
        if len(reached) == len(depths):
            for depth, solution in zip(depths, reached):
                keep(setup.problem, solution, depth)
            return None, ()
        setup = _setup(pad, law, depths, shear, coarse)
    watch = None if pad.geometry.flat_top else FoldWatch(RoundFace(setup.problem, pad.thickness_mm))

    def visit(depth: float, solution: Solution) -> str | None:
        if watch is not None and (folded := watch.look(depth, solution.u)):
            return folded
        keep(setup.problem, solution, depth)
        return None

    path = follow(
        setup.problem, depths, setup.first_step, setup.largest_step, setup.smallest_step, progress,
        lattice=setup.lattice, visit=visit,
    )  # fmt: skip
    return path.stop if watch is None else watch.said(path.stop), ()


def _setup(pad: Pad, law: Any, depths: Array, shear: float, coarse: bool) -> Setup:
    """The problem that the pad's own curve is solved by, with one fillet."""
    from dummydesign.pad.contact.resting_base import weight_over_shear
    from dummydesign.pad.contact.surface_axisymmetric import ProfilePunch
    from dummydesign.pad.shaped.paths import LARGEST_STEP, first_depth, passed_by
    from dummydesign.pad.shaped.problem import CELLS, Press, shaped_problem
    from dummydesign.pad.slab.indentation import CELLS as PROFILE_CELLS
    from dummydesign.pad.slab.indentation import (
        SHAPED_STIFFNESS,
        Region,
        indentation_problem,
        load_steps,
        profile,
        tip_region,
    )
    from dummydesign.pad.slab.problem import Slab, rimmed_problem

    h, extent = pad.thickness_mm, (pad.extent_mm or PAD_EXTENT_MM) / pad.thickness_mm
    radius = pad.radius_mm / h
    if pad.geometry != SLAB:
        first = first_depth(depths)
        edge = pad.edge_radius_mm / h
        press = Press(pad.geometry, h, radius, extent, pad.base, pad.condition, pad.poisson, first, edge)
        press.check()
        step = 0.3 * RIM if pad.geometry.flat_top else 0.25 * first
        cells = CELLS // 2 if coarse else CELLS
        passed = () if pad.geometry.flat_top else tuple(passed_by(press, law, cells, RIM, float(depths[-1])))
        return Setup(shaped_problem(press, law, cells, RIM), step, LARGEST_STEP * CELLS / cells, 3e-4, True, passed)
    weight = weight_over_shear(h, shear)
    own = (law, pad.poisson, pad.base, pad.condition)
    if pad.profile_mm is not None:
        shape = profile(*(np.asarray(part) / h for part in pad.profile_mm))
        punch = ProfilePunch(shape.height)
        region = tip_region(punch, radius, float(depths[0]), PROFILE_CELLS // 2 if coarse else PROFILE_CELLS)
        made = indentation_problem(punch, region, extent, *own, stiffness=SHAPED_STIFFNESS, weight=weight)
        first, largest, lattice = load_steps(pad.condition, float(depths[0]))
        return Setup(made, first, largest, first / 64.0, lattice)
    slab_scale = min(radius, 1.0)
    if pad.condition == "bonded" and pad.base in BASES:
        slab = Slab(radius, extent, pad.base, pad.condition)
        if pad.edge_radius_mm:
            from dummydesign.pad.slab.filleted import filleted_problem
            from dummydesign.pad.slab.solved_depths import HALVINGS, LATTICE

            made = filleted_problem(slab, law, pad.poisson, pad.edge_radius_mm / h)
            return Setup(made, LATTICE * 0.5**HALVINGS, LATTICE, LATTICE / 256.0, True)
        made = rimmed_problem(slab, law, pad.poisson, RIM * slab_scale, meshes.Resolution(cells=3 if coarse else 6))
        return Setup(made, RIM * slab_scale, 0.05 * slab_scale, 0.005 * slab_scale)
    flat = FlatPunch(radius, RIM * slab_scale)
    region = Region(max(0.0, radius - 3.0 * flat.rim), radius + 2.0 * flat.rim, flat.rim / 3.0)
    made = indentation_problem(flat, region, extent, *own, weight=weight)
    return Setup(made, 0.1 * flat.rim, 0.05 * slab_scale, 0.002 * slab_scale)


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
    reach, punch = radius_touched(problem, depth, solution), problem.punch
    if not pad.edge_radius_mm and isinstance(punch, FlatPunch) and reach >= punch.flat_radius:
        reach = punch.radius  # the fillet stands for a sharp edge, which is reached
    return Face(node, place[0], place[1], solid.mesh.nodes[0, node], pressure, drag, state, reach)


def face_sides(problem: Problem) -> Array:
    """Sides of the tested face: those of one cell only that lie neither on the axis, the base nor the rim."""
    mesh = problem.solid.mesh
    node = meshes.cell_nodes(mesh)
    three = np.concatenate([node[:, [i, side, j]] for side, i, j in meshes.SIDES])
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
