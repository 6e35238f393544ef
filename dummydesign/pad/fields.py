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
from dummydesign.pad.axisymmetric import filleted
from dummydesign.pad.axisymmetric import shaped_problem as shaped
from dummydesign.pad.axisymmetric.case import (
    FIRST_STEP,
    LATTICE,
    Case,
    lattice_depths,
    relative_depths,
    rimmed_problem,
)
from dummydesign.pad.axisymmetric.profile_punch import CELLS as PROFILE_CELLS
from dummydesign.pad.axisymmetric.profile_punch import edge_problem, load_steps, profile, profile_problem
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, RoundFace
from dummydesign.pad.contact.axisymmetric import Array, FlatPunch, ProfilePunch
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import Solid, SolidState
from dummydesign.pad.pad_under_punch import SLAB, Pad, Puck
from dummydesign.pad.solve.continuation import ForcePath, VisitedState, follow, state_between
from dummydesign.pad.solve.equilibrium import ContactProblem, Equilibrium

# The nine nodes of a cell on the unit square, in the order of the elements: corners, mid-sides, middle.
NODES = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]])


def cauchy(solid: Solid, state: SolidState, factor: Array) -> tuple[Array, Array]:
    """Cauchy stress (rr, zz, tt, rz) and principal stretches at the quadrature points of a state.

    sigma = P F^T / J with the first Piola stress P of :mod:`dummydesign.pad.fem.mixed_solid`.
    """
    F, cofactor, slope = state.at
    P = solid.law.stress(F) + slope[..., None] * cofactor
    P = P * (factor[:, None] / state.J)[..., None]
    pairs = ((0, 0), (1, 1)), ((2, 2), (3, 3)), ((4, 4),), ((0, 2), (1, 3))
    stress = np.stack([sum(P[..., i] * F[..., j] for i, j in pair) for pair in pairs], axis=-1)
    plane = np.linalg.svd(F[..., :4].reshape(*F.shape[:-1], 2, 2), compute_uv=False)
    return stress, -np.sort(-np.concatenate([plane, F[..., 4:]], axis=-1), axis=-1)


def to_nodes(solid: Solid, places: Array, values: Array) -> Array:
    """Values at quadrature points carried to the nodes: a bilinear fit in each cell, the mean of cells at a node."""

    def bilinear(x: Array, y: Array) -> Array:
        return np.stack([np.ones_like(x), x, y, x * y], axis=1)

    carry = bilinear(NODES[:, 0], NODES[:, 1]) @ np.linalg.pinv(bilinear(*places))
    at_nodes = np.einsum("nq,eqk->enk", carry, values)
    node = meshes.cell_nodes(solid.mesh).ravel()
    size = solid.mesh.nodes.shape[1]
    count = np.bincount(node, minlength=size)
    sums = [np.bincount(node, at_nodes[..., k].ravel(), minlength=size) for k in range(values.shape[-1])]
    return np.stack(sums, axis=1) / np.maximum(count, 1)[:, None]


def face_tractions(nodes: Array, u: Array, force: Array, sides: Array) -> dict[str, Array]:
    """Pressure and shear on the face from the nodal forces that hold it.

    A constant traction on a side with three nodes has the nodal forces t 2 pi r L (1, 4, 1) / 6; each node's force is
    divided by what its sides would have under a unit traction, so the pressures carry exactly the force of the solve.
    """
    moved = nodes + u.reshape(-1, 2).T
    x = np.array([-1.0, 0.0, 1.0])
    slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
    simpson = np.array([1.0, 4.0, 1.0]) / 3.0
    now = np.einsum("qi,cei->ceq", slope, moved[:, sides])
    area = 2.0 * np.pi * moved[0, sides] * np.linalg.norm(now, axis=0) * simpson
    size = nodes.shape[1]
    share = np.bincount(sides.ravel(), area.ravel(), minlength=size)
    along = np.stack([np.bincount(sides.ravel(), part.ravel(), minlength=size) for part in now])
    node = np.unique(sides)
    node = node[np.argsort(nodes[0, node], kind="stable")]
    along = along[:, node] / np.linalg.norm(along[:, node], axis=0)
    along = along * np.sign(along[0] + 1e-300)
    outward = np.stack([-along[1], along[0]])
    pull = force.reshape(-1, 2).T[:, node]
    area_of = share[node]
    safe = np.where(area_of > 1e-12 * area_of.max(), area_of, np.inf)
    pressure, shear = -(pull * outward).sum(0) / safe, (pull * along).sum(0) / safe
    if len(node) > 2 and not np.isfinite(safe[0]):
        # On the axis no area belongs to the node: the value of a parabola through its neighbours, even in r.
        r = moved[0, node[1:3]] ** 2
        pressure[0] = pressure[1] - (pressure[2] - pressure[1]) * r[0] / (r[1] - r[0])
    return {"node": node, "pressure": pressure, "shear": shear, "down": -pull[1]}


# State of a place on the tested face.
FREE, STICKS, SLIPS = 0, 1, 2
STATES = ("free", "sticks", "slips")


@dataclass(frozen=True)
class PressedFace:
    """The tested face of a pressed pad, from the axis outwards."""

    node: Array
    radius_mm: Array
    height_mm: Array
    pressure_MPa: Array
    shear_MPa: Array
    state: Array
    contact_radius_mm: float


@dataclass(frozen=True)
class Pressed:
    """A pad pressed to one depth: a mesh of nine-node quadrilaterals in the (r, z) plane and its fields."""

    depth_mm: float
    force_N: float
    rest_mm: Array
    displacement_mm: Array
    cells: Array
    cauchy_MPa: Array
    stretch: Array
    face: PressedFace
    punch_mm: Array

    @property
    def principal_MPa(self) -> Array:
        """Principal values of the Cauchy stress, largest first, shape (n, 3). [MPa]"""
        rr, zz, tt, rz = self.cauchy_MPa.T
        middle, half = 0.5 * (rr + zz), np.hypot(0.5 * (rr - zz), rz)
        return -np.sort(-np.stack([middle + half, middle - half, tt], axis=1), axis=1)

    @property
    def pressure_MPa(self) -> Array:
        """Minus the mean of the principal stresses, shape (n,). [MPa]"""
        return -self.cauchy_MPa[:, :3].mean(axis=1)

    @property
    def von_mises_MPa(self) -> Array:
        """sqrt(3/2 s:s) of the deviator s, shape (n,). [MPa]"""
        one, two, three = self.principal_MPa.T
        return np.sqrt(0.5 * ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2))

    def contact(self) -> dict[str, Any]:
        """Mean, peak and profile of the contact pressure as plain values; lengths in mm, pressures in kPa.

        The mean is the force over the contact seen from above, pi times the square of ``contact_radius_mm``. A sharp
        edge has no finite peak: ``peak_kPa`` is the largest value inside 0.9 of the contact's radius, ``edge_kPa`` the
        largest outside it, which depends on the fillet of the edge.
        """
        face, reach = self.face, self.face.contact_radius_mm
        touched = face.state != FREE
        inner = touched & (face.radius_mm <= 0.9 * reach)
        outer = touched & ~inner
        pressure = 1e3 * face.pressure_MPa
        at = int(np.argmax(np.where(inner, pressure, -np.inf))) if inner.any() else 0
        area = np.pi * reach**2
        return {
            "depth_mm": float(self.depth_mm),
            "force_N": float(self.force_N),
            "contact_radius_mm": reach,
            "mean_kPa": 1e3 * self.force_N / area if area else 0.0,
            "peak_kPa": float(pressure[at]) if inner.any() else 0.0,
            "peak_radius_mm": float(face.radius_mm[at]) if inner.any() else 0.0,
            "edge_kPa": float(pressure[outer].max()) if outer.any() else 0.0,
            "profile": {
                "radius_mm": np.minimum(face.radius_mm[touched], reach).tolist(),
                "pressure_kPa": pressure[touched].tolist(),
                "shear_kPa": (1e3 * face.shear_MPa[touched]).tolist(),
                "state": [STATES[k] for k in face.state[touched]],
            },
        }


# Depths of the path that are nearer than this to a wanted one are left out, over their own size.
NEAR = 0.1


Keep = Callable[[ContactProblem, Equilibrium, float], None]


def _follow_under_fillet(
    case: Case, depths: Array, thickness_mm: float, coarse: bool, keep: Keep
) -> tuple[str | None, tuple[str, ...]]:
    """Follow a slab that is not glued to a filleted punch and keep its states at wanted depths."""
    done, stop = 0, None
    notes: tuple[str, ...] = ()
    for cells in (filleted.COARSE,) if coarse else (filleted.FINE, filleted.COARSE):
        wanted, path = depths[done:], _with_lattice(depths)
        problem, follow = _slipping(case, cells)

        def visit(
            depth: float, solution: Equilibrium, problem: ContactProblem = problem, wanted: Array = wanted
        ) -> None:
            if np.isclose(wanted, depth, rtol=1e-9, atol=0.0).any():
                keep(problem, solution, depth)

        made = follow(path, visit)
        before, done = done, int((depths <= (made.depth[-1] if len(made.depth) else 0.0) * (1.0 + 1e-9)).sum())
        if cells == filleted.COARSE and not coarse and done > before:
            start = f"{depths[before] * thickness_mm:.3g} mm"
            notes = (f"fields from {start} on are those of cells of 1.5 times the size: finer ones end before",)
        done, stop = max(done, before), made.stop
        if done == len(depths):
            return None, notes
    return stop, notes


def _slipping(case: Case, cells: int) -> tuple[ContactProblem, Callable[..., ForcePath]]:
    """The problem of a face with or without friction, and what follows it."""
    if not Interface.parse(case.condition, "condition", FACES).friction:
        mesh = filleted.SlidingMesh(case, cells)
        return mesh.problem, lambda *args: filleted.follow_sliding(mesh, *args)
    problem = filleted.rubbing_problem(case, cells)
    return problem, lambda *args: filleted.follow_rubbing(problem, *args)


def _with_lattice(depths: Array) -> Array:
    """Wanted depths and those of the force's own path between them."""
    path = lattice_depths(float(depths[-1]))
    room = NEAR * np.minimum(path, LATTICE)
    far = np.abs(path[:, None] - depths).min(axis=1) > room
    return np.union1d(path[far & (path < depths[-1])], depths)


RIM = 0.05
# A place touches where its pressure is above this share of the largest.
TOUCHES = 1e-3
# A place slips where its shear is this share of Coulomb's limit (the regularised law reaches 1 only for large slip).
SLIP_SHARE = 0.95


@dataclass(frozen=True)
class Setup:
    """A problem of finite elements in thicknesses and shear moduli, and how its path is followed or was already.

    ``steps`` of the load are the first, the largest and the smallest.
    """

    problem: ContactProblem
    steps: tuple[float, float, float]
    lattice: bool = False
    visited: tuple[VisitedState, ...] = ()


# Pressures are resolved from this many times the depth from which a force is.
FIELD_DEPTHS = 4.0


def solve_fields(
    pad: Pad | Puck, depth_mm: Sequence[float], coarse: bool = False
) -> tuple[tuple[Pressed, ...], tuple[str, ...]]:
    """Fields of a round pad at static depths."""
    if not has_fields(pad):
        what = "pad = cylinder between plates" if isinstance(pad, Puck) else f"shape {pad.geometry}"
        message = f"fields are for round pads under a punch; {what} has none yet"
        raise InputError(message, "unsupported", "fields", what)
    depths, shear = relative_depths(depth_mm, pad.thickness_mm), pad.shear_MPa
    fields: list[Pressed] = []

    def keep(problem: ContactProblem, solution: Equilibrium, depth: float) -> None:
        fields.append(_pressed(problem, solution, depth, pad, shear))

    stop, notes = _follow(pad, depths, coarse, keep)
    if not fields:
        raise NoAnswerError("no_convergence", f"the fields could not be solved: {stop}", quantity="fields")
    if pad.sides_mm is not None:
        notes += (f"fields are those of a round punch of equal area, radius {pad.radius_mm:.4g} mm",)
    if stop:
        notes += (f"fields were solved to {fields[-1].depth_mm:.3g} mm: {stop}",)
    return tuple(fields), notes


def has_fields(pad: Pad | Puck) -> TypeGuard[Pad]:
    """Whether the pad is round and under a punch."""
    return isinstance(pad, Pad) and pad.geometry.axisymmetric


def contact_pressures(pad: Pad, depth_mm: Sequence[float]) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """Mean, peak and profile of the contact pressure at static depths; solves are kept in the cache."""
    from dummydesign.pad.first_touch import least_depth_mm

    # a contact of a few cells has a force, but no pressures
    least = FIELD_DEPTHS * least_depth_mm(pad)
    wanted = [depth for depth in depth_mm if depth >= least]
    left_out = f"the contact at depths below {least:.2g} mm is too small for its pressures to be resolved"
    if not wanted:
        return [], (left_out,)
    notes_before = () if len(wanted) == len(depth_mm) else (left_out,)

    def solve() -> dict[str, Any]:
        fields, notes = solve_fields(pad, wanted)
        return {"contact": [pressed.contact() for pressed in fields], "notes": list(notes)}

    made = cached("contact", {"pad": replace(pad, prony=()), "depth": np.asarray(wanted, dtype=float)}, solve)
    return made["contact"], (*notes_before, *made["notes"])


def _follow(pad: Pad, depths: Array, coarse: bool, keep: Keep) -> tuple[str | None, tuple[str, ...]]:
    """Keep the equilibria at depths; return why some are missing, and notes on the others."""
    case = Case.of(pad, check=pad.profile_mm is None)
    if pad.edge_radius_mm and pad.condition != "bonded":
        return _follow_under_fillet(case, depths, pad.thickness_mm, coarse, keep)
    setup = _setup(pad, case, depths, coarse)
    if setup.visited:
        solutions = [state_between(setup.problem, setup.visited, depth) for depth in depths]
        reached = [one for one in solutions if isinstance(one, Equilibrium)]
        if len(reached) == len(depths):
            for depth, solution in zip(depths, reached):
                keep(setup.problem, solution, depth)
            return None, ()
        setup = _setup(pad, case, depths, coarse)
    watch = None if pad.geometry.flat_top else FoldWatch(RoundFace(setup.problem, pad.thickness_mm))

    def visit(depth: float, solution: Equilibrium) -> str | None:
        if watch is not None and (folded := watch.check(depth, solution.u)):
            return folded
        keep(setup.problem, solution, depth)
        return None

    path = follow(
        setup.problem,
        depths,
        *setup.steps,
        lattice=setup.lattice,
        visit=visit,
    )
    return path.stop if watch is None else watch.stop_reason(path.stop), ()


def _setup(pad: Pad, case: Case, depths: Array, coarse: bool) -> Setup:
    """The problem that the pad's own curve is solved by, with one fillet."""
    scale = case.scale
    if pad.geometry != SLAB:
        case = shaped.meshed(case)
        # pressures of a contact that is smaller than those whose force is solved
        case = replace(case, first=min(case.first, float(depths[0])))
        flat, cells = pad.geometry.flat_top, shaped.CELLS // 2 if coarse else shaped.CELLS
        visited = () if flat else tuple(shaped.visited_states(case, cells, RIM, float(depths[-1])))
        return Setup(shaped.shaped_problem(case, cells, RIM), shaped.load_steps(case, cells, RIM), True, visited)
    if pad.profile_mm is not None:
        punch = ProfilePunch(profile(*(np.asarray(part) / pad.thickness_mm for part in pad.profile_mm)).height)
        cells = PROFILE_CELLS // 2 if coarse else PROFILE_CELLS
        first, largest, lattice = load_steps(pad.condition, float(depths[0]))
        return Setup(profile_problem(case, punch, float(depths[0]), cells), (first, largest, first / 64.0), lattice)
    if pad.condition != "bonded" or pad.base not in BASES:
        rim = RIM * scale
        return Setup(edge_problem(replace(case, edge=rim)), (0.1 * rim, 0.05 * scale, 0.002 * scale))
    if pad.edge_radius_mm:
        return Setup(filleted.filleted_problem(case), (FIRST_STEP, LATTICE, LATTICE / 256.0), True)
    # Of a picture, whose stresses this moves by 1 % (at most 3.5 %), the fillet is twice as large.
    rim, cells = (2.0 * RIM * scale, 3) if coarse else (RIM * scale, 6)
    made = rimmed_problem(case, rim, meshes.Resolution(cells=cells))
    return Setup(made, (rim, 0.05 * scale, 0.005 * scale), coarse)


def _pressed(problem: ContactProblem, solution: Equilibrium, depth: float, pad: Pad, shear: float) -> Pressed:
    """The fields of one equilibrium in mm and MPa."""
    solid, h = problem.solid, pad.thickness_mm
    mesh = solid.mesh
    factor = np.ones(len(mesh.weight)) if mesh.modulus_factor is None else mesh.modulus_factor
    bottom = float(mesh.nodes[1].min())
    lift = np.array([0.0, bottom])
    moved = solution.u.reshape(-1, 2)
    used = np.unique(meshes.cell_nodes(mesh))
    both = to_nodes(solid, meshes.POINTS, np.concatenate(cauchy(solid, solution.state, factor), axis=-1))[used]
    number = np.full(mesh.nodes.shape[1], -1)
    number[used] = np.arange(len(used))
    face = _face(problem, solution, depth, pad, shear)
    face = replace(face, node=number[face.node])
    outline = _outline(problem, depth, pad.radius_mm / h)
    return Pressed(
        depth * h,
        problem.force(solution.state) * shear * h * h,
        (mesh.nodes.T - lift)[used] * h,
        moved[used] * h,
        number[meshes.cell_nodes(mesh)],
        both[:, :4] * shear,
        both[:, 4:],
        face,
        (outline - lift) * h,
    )


def _face(problem: ContactProblem, solution: Equilibrium, depth: float, pad: Pad, shear: float) -> PressedFace:
    """The tested face, by the mesh's nodes."""
    solid, h = problem.solid, pad.thickness_mm
    sides = face_sides(problem)
    traction = face_tractions(solid.mesh.nodes, solution.u, solution.state.internal_force, sides)
    node, pressure, drag = traction["node"], traction["pressure"], traction["shear"]
    touches = pressure > TOUCHES * pressure.max()
    driven = problem.driven[problem.driven % 2 == 1] // 2
    touches |= np.isin(node, driven)
    face = Interface.parse(pad.condition, "condition", FACES)
    state = np.where(touches, STICKS, FREE)
    if not face.bonded:
        limit = SLIP_SHARE * (face.coulomb or 0.0) * pressure
        state = np.where(touches & (np.abs(drag) >= limit), SLIPS, state)
    pressure, drag = np.where(touches, pressure, 0.0), np.where(touches, drag, 0.0)
    position = solid.mesh.nodes[:, node] + solution.u.reshape(-1, 2).T[:, node]
    (reach, at_edge), punch = shaped.radius_touched(problem, depth, solution.u), problem.punch
    if not pad.edge_radius_mm and at_edge and isinstance(punch, FlatPunch):
        reach = punch.radius  # the fillet stands for a sharp edge, which is reached
    height = position[1] - float(solid.mesh.nodes[1].min())
    return PressedFace(node, position[0] * h, height * h, pressure * shear, drag * shear, state, reach * h)


def face_sides(problem: ContactProblem) -> Array:
    """Sides of the tested face: those of one cell only that lie neither on the axis, the base nor the rim."""
    mesh = problem.solid.mesh
    three = meshes.cell_sides(mesh)
    middle, counts = np.unique(three[:, 1], return_counts=True)
    once = np.isin(three[:, 1], middle[counts == 1])
    r = mesh.nodes[0]
    base = np.zeros(mesh.nodes.shape[1], dtype=bool)
    base[problem.base // 2] = True
    near = 1e-9
    elsewhere = base[three].all(axis=1) | (r[three] < near).all(axis=1) | (r[three] > r.max() - near).all(axis=1)
    return three[once & ~elsewhere]


def _outline(problem: ContactProblem, depth: float, radius: float) -> Array:
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
