"""A round pad under a punch as a finite-element problem; the depths it is solved at and the curve through them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError, out_of_range
from dummydesign.core.interpolation import monotone_cubic
from dummydesign.core.parsing import one_of
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS, PAD_EXTENT_MM
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.contact.axisymmetric import GLUED_SLAB, AxisymmetricSurface, ContactSurface, FlatPunch, RigidPunch
from dummydesign.pad.contact.friction import CombinedSurface, RestingBase, weight_over_shear
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import Discretisation, Solid
from dummydesign.pad.force_law import PadCurve
from dummydesign.pad.material.hyperelastic import NEO_HOOKEAN, Array, HyperelasticLaw
from dummydesign.pad.pad_under_punch import SLAB, Pad
from dummydesign.pad.solve.continuation import ForcePath, cost
from dummydesign.pad.solve.equilibrium import ContactProblem

# Stiffness of the film in shear moduli per rim, and how many rims it reaches inwards.
FILM_STIFFNESS = GLUED_SLAB.contact * GLUED_SLAB.grip_share
FILM_REACH = 6.0
# The energy term that keeps elements from inverting, in shear moduli, where a glued face ends in an edge: ten times as
# much stiffens the cells there and the pad by up to 1 % at d/h 0.45; a tenth of it changes no more than 0.2 %.
EDGE_STABILISATION = 1.0
# A pad is at least this thick at its thinnest, and its shape ends within this share of its radius.
THINNEST, WIDEST = 0.02, 0.95


@dataclass(frozen=True)
class Case:
    """A round pad and the punch on it, lengths in thicknesses, the law with unit shear modulus.

    ``shape`` has its lengths in mm, for a pad of ``thickness_mm``; ``edge`` is the fillet of the punch's edge, 0 where
    it is sharp; ``first`` is the depth that an apex is meshed for, ``weight`` the
    pressure of a resting pad on its base.
    """

    radius: float
    extent: float
    base: str = "bonded"
    condition: str = "bonded"
    law: HyperelasticLaw = NEO_HOOKEAN
    poisson: float = 0.5
    edge: float = 0.0
    shape: PadShape = SLAB
    thickness_mm: float = 1.0
    first: float = 0.02
    weight: float = 0.0

    @classmethod
    def of(cls, pad: Pad, check: bool = True) -> Case:
        """Make the case of a pad; with ``check`` refuse what cannot be meshed under a flat punch."""
        h = pad.thickness_mm
        extent_mm = PAD_EXTENT_MM if pad.extent_mm is None else pad.extent_mm
        # Slabs of one proportion are one case, whatever their thickness.
        own_mm = 1.0 if pad.geometry == SLAB else float(h)
        weight = weight_over_shear(h, pad.shear_MPa) if Interface.names_friction(pad.base) else 0.0
        case = cls(
            pad.radius_mm / h,
            extent_mm / h,
            pad.base,
            pad.condition,
            pad.shape,
            pad.poisson,
            pad.edge_radius_mm / h,
            pad.geometry,
            own_mm,
            weight=weight,
        )
        if check:
            case.check()
        return case

    @property
    def scale(self) -> float:
        """The smaller of punch radius and thickness, over the thickness."""
        return min(self.radius, 1.0)

    @property
    def lines(self) -> tuple[float, ...]:
        """Radii with a kink."""
        return tuple(line / self.thickness_mm for line in self.shape.lines_mm())

    def drop(self, r: Array) -> Array:
        """Fall of the tested face."""
        return self.shape.drop_mm(r * self.thickness_mm, 0.0 * r) / self.thickness_mm

    def bone(self, r: Array) -> Array:
        """Height of the bone."""
        return self.shape.bone_mm(r * self.thickness_mm, 0.0 * r) / self.thickness_mm

    @property
    def tip(self) -> float | None:
        """Radius of curvature of the tested face on the axis, from its profile; None of a flat one."""
        near = 1e-3
        fallen = float(self.drop(np.array([near]))[0])
        return near**2 / (2.0 * fallen) if fallen > 0.0 else None

    def check(self) -> None:
        """Refuse what cannot be meshed round."""
        what = "slab" if self.shape == SLAB else "pad"
        if not self.shape.axisymmetric:
            message = f"shape = {self.shape} is not round; this solve is for round pads"
            raise InputError(message, "unsupported", "shape", str(self.shape))
        if what == "slab" and not 0.05 <= self.radius <= 20.0:
            raise out_of_range("punch radius over thickness", self.radius, 0.05, 20.0)
        if not self.extent >= 1.5 * self.radius:
            raise InputError(
                f"{what} radius over punch radius = {self.extent / self.radius:.3g} is below 1.5; "
                f"the punch must stay away from the {what}'s rim",
                "out_of_range",
                f"{what}_radius_over_punch_radius",
                self.extent / self.radius,
            )
        r = np.linspace(0.0, self.extent, 400)
        left = float((1.0 - self.drop(r) - self.bone(r)).min())
        layers = self.shape.layers()
        if layers:
            left = min(left, layers[0] / self.thickness_mm, 1.0 - layers[0] / self.thickness_mm)
        if not left >= THINNEST:
            raise InputError(
                f"shape {self.shape} leaves {left * self.thickness_mm:.3g} mm of a pad of {self.thickness_mm:g} mm "
                f"at its thinnest; at least {THINNEST * self.thickness_mm:.3g} mm must stay",
                "cannot_be_made",
                "shape",
                str(self.shape),
            )
        if self.lines and max(self.lines) > WIDEST * self.extent:
            raise InputError(
                f"shape {self.shape} reaches {max(self.lines) * self.thickness_mm:.3g} mm from the middle of a pad "
                f"of radius {self.extent * self.thickness_mm:.3g} mm",
                "cannot_be_made",
                "shape",
                str(self.shape),
            )


def round_problem(
    mesh: Discretisation,
    case: Case,
    glued: Array,
    surface: ContactSurface | None = None,
    punch: RigidPunch | None = None,
    face: Array | None = None,
    stabilisation: float = EDGE_STABILISATION,
    base: Array | None = None,
) -> ContactProblem:
    """Hold axis and base of a pad, or let it rest on friction, and move the ``glued`` nodes with the punch.

    ``face`` are the nodes that lie on the punch at first touch, ``base`` those on the base where it is not at -1.
    """
    support = Interface.parse(case.base, "base", BASES)
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    base = np.nonzero(meshes.on_base(mesh, 1.0))[0] if base is None else base
    held[2 * base + 1] = support.coulomb is None
    held[2 * base] |= support.bonded
    if case.condition == "bonded":
        held[2 * glued] = True
    if support.coulomb is not None and surface is not None:
        bottom = meshes.edges_on(mesh, meshes.on_base(mesh, 1.0))
        resting = RestingBase(mesh, bottom, case.law.shear_MPa, support.coulomb, case.weight)
        surface = CombinedSurface(surface, resting)
    solid = Solid(mesh, case.law, case.poisson, stabilisation)
    carried = None if face is None else 2 * face + 1
    return ContactProblem(solid, held, 2 * glued + 1, 2 * base + 1, surface, punch, carried)


def _check_smooth(case: Case) -> None:
    """Refuse friction, which the meshes around an edge are not made for."""
    one_of("base", case.base, BASES)
    one_of("condition", case.condition, CONDITIONS)


def sharp_problem(
    case: Case, resolution: meshes.Resolution, rings: int = 6, quarter_points: bool = True
) -> ContactProblem:
    """The sharp-edged punch, for the small-strain limit: quarter-point elements at the edge."""
    _check_smooth(case)
    half_box = resolution.box * case.scale
    points, quads, centre = meshes.web_mesh(case.radius, case.extent, half_box, rings, resolution)
    mesh = meshes.discretise(points, quads, centre, quarter_points)
    return round_problem(mesh, case, np.nonzero(meshes.on_top(mesh) & (mesh.nodes[0] <= case.radius + 1e-9))[0])


def rimmed_problem(case: Case, rim: float, resolution: meshes.Resolution) -> ContactProblem:
    """The punch with a small fillet at its edge, glued or frictionless under its flat face.

    The face far from the edge moves with the punch node by node. Within six fillet radii of the fillet, and
    everywhere for a frictionless face, the surface is held by contact; a glued face is also held by the film, whose
    stiffness falls off over one radius towards the fillet, and what touches the fillet sticks to it.
    """
    _check_smooth(case)
    punch, shear = FlatPunch(case.radius, rim), case.law.shear_MPa
    half_box = resolution.box * case.scale
    rings = max(1, int(np.ceil(np.log2(half_box / rim)))) + 2
    points, quads, centre = meshes.web_mesh(punch.flat_radius, case.extent, half_box, rings, resolution)
    mesh = meshes.discretise(points, quads, centre)
    top, r = meshes.on_top(mesh), mesh.nodes[0]
    glued = case.condition == "bonded"
    inner = max(punch.flat_radius - FILM_REACH * rim, 0.3 * punch.flat_radius)
    vertices = points[0][(np.abs(points[1]) < 1e-9) & (points[0] <= inner + 1e-9)]
    inner = vertices.max()
    reach = case.radius + 0.8 * case.scale
    sides = meshes.edges_on(mesh, top & (r >= inner - 1e-9) & (r <= reach))
    film = partial(glue_film, punch=punch, shear_MPa=shear) if glued else None
    surface = AxisymmetricSurface(
        mesh.nodes,
        sides,
        shear * GLUED_SLAB.contact / rim,
        film,
        shear * FILM_STIFFNESS / rim * glued,
        punch.flat_radius,
    )
    face = np.nonzero(top & (r <= punch.flat_radius + 1e-9))[0]
    return round_problem(mesh, case, np.nonzero(top & (r <= inner + 1e-9))[0], surface, punch, face)


def glue_film(radius: Array, punch: FlatPunch, shear_MPa: float) -> Array:
    """Stiffness of the film under a glued face, which fades over one fillet radius towards the fillet."""
    fade = np.exp(np.minimum((punch.flat_radius - radius) / punch.rim, FILM_REACH))
    return np.where(radius < punch.flat_radius, shear_MPa * (FILM_STIFFNESS / punch.rim * fade), 0.0)


def first_stiffness(case: Case, resolution: meshes.Resolution | None = None) -> float:
    """Force per depth at first touch over E a, E = 3 mu, of a sharp-edged punch (dimensionless).

    For a frictionless face on a bonded base this is 2 kappa / (1 - nu^2) * (E / E') of the layer solution
    of Hayes et al., J. Biomech. 5 (1972) 541, at the same shear modulus.
    """
    problem = sharp_problem(case, resolution or meshes.Resolution(cells=4))
    return problem.stiffness() / (3.0 * case.law.shear_MPa * case.radius)


def relative_depths(depth_mm: ArrayLike, thickness_mm: float) -> Array:
    """Return the wanted depths above 0, increasing, over the thickness."""
    depths = np.unique(np.asarray(depth_mm, dtype=float))
    limit = MAX_DEPTH_OVER_THICKNESS * thickness_mm
    depths = depths[depths != 0.0]
    wrong = depths[~((depths > 0.0) & (depths <= limit * (1.0 + 1e-9)))]
    if len(wrong) or not len(depths):
        worst = float(wrong[0]) if len(wrong) else 0.0
        raise InputError(
            f"depth_mm = {worst:g} is outside the allowed range above 0 to {limit:.4g}",
            "out_of_range",
            "depth_mm",
            worst,
            (0.0, limit),
        )
    return depths / thickness_mm


def unsolved(why: str | None, what: str = "the pad") -> NoAnswerError:
    """Make the error of a solve that reached no depth."""
    return NoAnswerError("no_convergence", f"{what} could not be solved: {why}", quantity="force_N")


def end_note(reached: float, wanted: float, why: str | None) -> tuple[str, ...]:
    """Say where a curve ends, in thicknesses, and why."""
    return (f"solved to d/h = {reached:.3f} of {wanted:.3f}: {why}",)


def padded(path: ForcePath, count: int) -> Array:
    """Forces of a path at all wanted depths, shape (count,); NaN where it did not get to."""
    return np.concatenate([path.force, np.full(count - len(path.force), np.nan)])


def held_on(values: Array) -> Array:
    """Largest value so far, carried over depths where it is not known (NaN); 1 % where it never is."""
    known = np.isfinite(values).any()
    return np.maximum.accumulate(np.nan_to_num(values, nan=0.0)) if known else np.full(len(values), 0.01)


def extend_path(path: ForcePath, other: ForcePath, tail: Array) -> ForcePath:
    """Extend a path beyond its end by forces of another one; the cost is that of both."""
    longer = replace(other, force=np.concatenate([path.force, tail])) if len(tail) else path
    both: dict[str, Any] = cost([path, other]) | {"unknowns": longer.unknowns}
    return replace(longer, **both)


# Load steps end at multiples of this depth over the thickness, halves and less of it at first.
LATTICE, HALVINGS = 0.02, 5
FIRST_STEP = LATTICE * 0.5**HALVINGS


def lattice_depths(deepest: float) -> Array:
    """Depths that are solved: multiples of the lattice up to the deepest wanted one, and halvings of the first."""
    count = int(np.ceil(min(deepest, MAX_DEPTH_OVER_THICKNESS) / LATTICE - 1e-9))
    return LATTICE * np.concatenate([0.5 ** np.arange(HALVINGS, 0, -1), np.arange(1, count + 1)])


def solve_on_lattice(
    kind: str, pad: Pad, depth_mm: ArrayLike, solve: Callable[[Case, Array], dict[str, Any]]
) -> PadCurve:
    """Solve a slab at the lattice's depths, kept in the cache, and interpolate its force at the wanted ones.

    ``solve`` gives F / (mu h d) at the depths over the thickness that were reached, with its relative error. Between
    them its logarithm is a monotone cubic over the root of the depth.
    """
    case, depths = Case.of(pad), relative_depths(depth_mm, pad.thickness_mm)
    nodes = lattice_depths(float(depths[-1]))
    made = cached(kind, {"case": case, "depths": nodes}, lambda: solve(case, nodes))
    nodes, log = made["depth"], np.log(made["stiffness"])
    reached = nodes[-1] if len(nodes) else 0.0
    kept = depths[depths <= reached * (1.0 + 1e-9)]
    if not len(kept):
        raise unsolved(made["stop"])
    notes = end_note(reached, depths[-1], made["stop"]) if len(kept) < len(depths) else ()
    at, where = np.sqrt(nodes), np.sqrt(np.maximum(kept, nodes[0]))
    stiffness = np.exp(monotone_cubic(at, log)(where) if len(nodes) > 1 else log[0])
    force = stiffness * kept * pad.shear_MPa * pad.thickness_mm**2
    return PadCurve(kept * pad.thickness_mm, force, np.interp(where, at, made["error"]) * force, made["solver"], notes)


def of_two_meshes(coarse: ForcePath, fine: ForcePath, nodes: Array, least_error: float) -> dict[str, Any]:
    """F / d at the first of the nodes from two meshes: the finer one's, extrapolated by the one that got further."""
    both = min(len(coarse.force), len(fine.force))
    further = fine if len(fine.force) > both else coarse
    count = len(further.force)
    step = np.zeros(count)
    step[:both] = np.log(fine.force[:both] / coarse.force[:both])
    force = further.force.copy()
    force[:both] = fine.force[:both]
    if both and further is coarse:
        force[both:] *= np.exp(step[both - 1])
    error = least_error + np.where(np.arange(count) < both, 1.0, 2.0) * np.maximum.accumulate(np.abs(step))
    return {
        "depth": nodes[:count],
        "stiffness": force / nodes[:count],
        "error": error,
        "solver": cost([coarse, fine]),
        "stop": further.stop,
    }
