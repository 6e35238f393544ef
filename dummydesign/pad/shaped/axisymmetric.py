"""Force of a shaped pad under a round flat punch, by axisymmetric finite elements at finite strain.

The pad stands from the base (or from a rigid bone) up to its tested face; both may be curved. A crowned pad
is touched at its apex first: depth 0 is there, the contact opens over the crown and may reach the flat around
it and the punch's edge later. The edge is a bead of small radius, without a wall behind it.

A pad with a flat top has the sharp edge of a slab under its punch. Its force is the ratio to a homogeneous
slab on the same cells with the same bead, times the slab's own sharp-edge force (``axisymmetric``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch, Surface
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_columns import Sizes, columns, height_lines, radial_lines, stretch
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law, Yeoh
from dummydesign.pad.slab.problem import FILM_REACH, FILM_STIFFNESS, PadCurve, normalise
from dummydesign.pad.solve.continuation import NOTHING, Path, cost, follow
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Contact stiffness in shear moduli over the cell, and what holds a sticking point, as a share of it.
CONTACT_STIFFNESS = 2000.0
GRIP_SHARE = 0.1
# Beads at the punch's edge over the smaller of radius and thickness. From one to the next of half the size the
# missing force falls by 0.42 (the power 1.25 of ``edge_limit``), so this share of the last step is left.
RIMS = (0.1, 0.05)
LEFT_TO_SHARP = 0.42 / (1.0 - 0.42)
# Share of that extrapolation, and of the step to cells of half the size, that is stated as error.
EDGE_ERROR = 0.3
MESH_ERROR = 1.0
LEAST_ERROR = 2e-3
CELLS = 16
# Load steps in thicknesses, at 16 cells, while a contact grows that sticks: a quarter of them moves a force by at most
# 0.2 %. Wanted depths are solved beside the path, which is the same whatever they are. Other contact takes larger ones.
LARGEST_STEP = 0.01
FREE_STEP = 0.03
FIRST_DEPTH = 0.02


class Plate(FlatPunch):
    """A flat punch with a bead whose face pushes back from any depth inside it, so that steps may be large."""

    @staticmethod
    def _flat(v: Array) -> Array:
        return v[..., 0] < 0.0


@dataclass(frozen=True)
class Press:
    """A shaped pad and the punch on it, all lengths in thicknesses.

    Attributes
    ----------
    shape : PadShape
        Round; its lengths in mm.
    thickness_mm : float
    radius, extent : float
        Of the punch and of the pad.
    base, condition : str
    poisson : float
    first : float
        Smallest depth of interest; the apex is meshed for the contact it makes.
    """

    shape: PadShape
    thickness_mm: float
    radius: float
    extent: float
    base: str = "bonded"
    condition: str = "bonded"
    poisson: float = 0.5
    first: float = 0.02

    @property
    def lines(self) -> tuple[float, ...]:
        """Radii with a kink."""
        return tuple(line / self.thickness_mm for line in self.shape.lines_mm())

    @property
    def scale(self) -> float:
        """The smaller of punch radius and thickness."""
        return min(self.radius, 1.0)

    def drop(self, r: Array) -> Array:
        """Fall of the tested face."""
        return self.shape.drop_mm(r * self.thickness_mm, 0.0 * r) / self.thickness_mm

    def bone(self, r: Array) -> Array:
        """Height of the bone."""
        return self.shape.bone_mm(r * self.thickness_mm, 0.0 * r) / self.thickness_mm

    def check(self) -> None:
        """Refuse what cannot be meshed round.

        Raises
        ------
        InputError
            For a shape that is not round, that leaves nothing between bone and face, or that reaches the rim.
        """
        if not self.shape.axisymmetric:
            raise InputError(f"shape = {self.shape} is not round; this solve is for round pads")
        if not self.extent >= 1.5 * self.radius:
            raise InputError(
                f"pad radius over punch radius = {self.extent / self.radius:.3g} is below 1.5; "
                "the punch must stay away from the pad's rim"
            )
        r = np.linspace(0.0, self.extent, 400)
        left = float((1.0 - self.drop(r) - self.bone(r)).min())
        layers = self.shape.layers()
        if layers:
            left = min(left, layers[0] / self.thickness_mm, 1.0 - layers[0] / self.thickness_mm)
        if not left >= 0.02:
            raise InputError(
                f"shape {self.shape} leaves {left * self.thickness_mm:.3g} mm of a pad of {self.thickness_mm:g} mm "
                f"at its thinnest; at least {0.02 * self.thickness_mm:.3g} mm must stay"
            )
        if self.lines and max(self.lines) > 0.95 * self.extent:
            raise InputError(
                f"shape {self.shape} reaches {max(self.lines) * self.thickness_mm:.3g} mm from the middle of a pad "
                f"of radius {self.extent * self.thickness_mm:.3g} mm"
            )


def shaped_problem(press: Press, law: Law, cells: int = CELLS, rim: float = RIMS[-1], twin: bool = False) -> Problem:
    """The pad under a punch with a bead of radius ``rim`` times the smaller of punch radius and thickness.

    Parameters
    ----------
    press : Press
    law : Law
        Of the upper resin; its moduli set the unit of stress.
    cells : int
        Cells between the axis and the punch's edge, at least.
    twin : bool
        Make the homogeneous slab without a bone on the same grid instead.
    """
    face = Interface.parse(press.condition, "condition", FACES)
    grip = float(face.bonded)
    if press.base not in BASES:
        raise InputError(f"base = '{press.base}' is not one of {', '.join(BASES)}")
    punch = Plate(press.radius, rim * press.scale)
    coarse = press.radius / cells
    r, share, interface = _grid(press, cells, punch.rim)
    points, quads, row = columns(r, share)
    nothing = np.zeros_like
    move = stretch(nothing, nothing) if twin else stretch(press.drop, press.bone)
    mesh = meshes.discretise(points, quads, move=move)
    layers = press.shape.layers()
    if layers and not twin:
        # Energy and pressure terms scale alike: the pressure is that of the upper layer, times the ratio.
        factor = np.where(share[row] >= interface - 1e-9, layers[1], 1.0)
        mesh = replace(mesh, weight=mesh.weight * factor[:, None])
    node = mesh.dofs.reshape(len(mesh.dofs), 9, 2)[:, :, 0] // 2
    top, below = node[row == 0][:, [2, 6, 3]], np.unique(node[row == row.max()][:, [0, 4, 1]])
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    held[2 * below + 1] = True
    if press.base == "bonded":
        held[2 * below] = True
    elif np.any(press.bone(r) > 0.0):
        raise InputError("base = 'sliding' is not built for a pad with a bone; take bonded")
    place = mesh.nodes[0, top]
    near = place.min(axis=1) <= press.radius + 0.8 * press.scale
    strength = CONTACT_STIFFNESS * law.shear_MPa / coarse
    film, driven, carried = nothing, np.array([], dtype=int), None
    if press.shape.flat_top:
        carried = 2 * np.unique(top[place.max(axis=1) <= punch.flat_radius + 1e-9]) + 1
    if press.shape.flat_top and grip:
        # The glued face moves with the punch node by node; near the bead it is held by contact and a film.
        inner = max(punch.flat_radius - FILM_REACH * punch.rim, 0.3 * punch.flat_radius)
        inside = place.max(axis=1) <= inner
        glued = np.unique(top[inside])
        held[2 * glued] = True
        driven, near = 2 * glued + 1, near & ~inside

        def film(radius: Array) -> Array:
            fade = np.exp(np.minimum((punch.flat_radius - radius) / punch.rim, FILM_REACH))
            return np.where(radius < punch.flat_radius, law.shear_MPa * FILM_STIFFNESS / punch.rim * fade, 0.0)

    surface = Surface(
        mesh.nodes, top[near], lambda at: np.full_like(at, strength), film, GRIP_SHARE * strength * grip,
        punch.flat_radius if len(driven) else 0.0, face.coulomb or 0.0, 0.02 * coarse, ties_within_step=True,
    )  # fmt: skip
    return Problem(Solid(mesh, law, press.poisson), held, driven, 2 * below + 1, surface, punch, carried)


def _grid(press: Press, cells: int, rim: float) -> tuple[Array, Array, float | None]:
    """Radii, shares of the column, and the share at which layers meet."""
    coarse = press.radius / cells
    first = min(coarse, 1.6 / cells)
    places, sizes = [press.radius - 0.5 * rim], [min(coarse, 16.0 / cells * rim)]
    for line in press.lines:
        places.append(line)
        sizes.append(0.6 * coarse)
    near = np.array([1e-3])
    fallen = float(press.drop(near)[0])
    if fallen > 0.0:
        # Contact radius of a first touch: sqrt(R d), with R from the profile itself.
        tip = float(near[0] ** 2 / (2.0 * fallen))
        first = min(first, 1.3 * np.sqrt(tip * press.first) * 8.0 / cells)
        places.append(0.0)
        sizes.append(first)
    marks = (*press.lines, press.radius)
    r = radial_lines(Sizes(tuple(places), tuple(sizes), coarse, press.radius), marks, press.extent)
    layers = press.shape.layers()
    interface = layers[0] / press.thickness_mm if layers else None
    return r, height_lines(min(first, 1.0 / cells), interface), interface


def climb(press: Press, law: Law, depths: Array, cells: int = CELLS, rim: float = RIMS[-1], twin: bool = False,
          progress: Callable[[float], None] | None = None) -> Path:  # fmt: skip
    """Follow the pad with one bead through relative ``depths``."""
    problem = shaped_problem(press, law, cells, rim, twin)
    if press.condition == "frictionless":
        # Contact without memory: the force is the same whatever the steps were.
        return follow(problem, depths, 0.25 * press.first, FREE_STEP, 3e-4, progress)
    if press.shape.flat_top:
        return follow(problem, depths, 0.3 * rim, FREE_STEP, 3e-4, progress, lattice=True)
    return follow(problem, depths, 0.25 * press.first, LARGEST_STEP * CELLS / cells, 3e-4, progress, lattice=True)


def sharp(rough: Array, fine: Array) -> tuple[Array, Array]:
    """Values with beads of 0.1 and 0.05 carried on to a sharp edge; NaN where a bead did not get to.

    Where only one is known, the step between them is taken from the last depth at which both are.

    Returns
    -------
    value, added : ndarray
        The limit, and what it adds over the smaller bead, relative.
    """
    step = np.log(fine / rough)
    known = np.isfinite(step)
    if known.any():
        at = np.arange(len(step))
        step = np.where(known, step, step[known][-1]) if at[known][-1] < at[-1] else np.where(known, step, 0.0)
    else:
        step = np.zeros(len(step))
    best = np.where(np.isfinite(fine), fine, rough * np.exp(step))
    return best * np.exp(LEFT_TO_SHARP * step), np.expm1(LEFT_TO_SHARP * step)


def solve_shaped_pad(
    shape: PadShape,
    thickness_mm: float,
    radius_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    condition: str = "bonded",
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    cells: int = CELLS,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a round shaped pad under a round, flat, sharp-edged punch, from first touch.

    Parameters
    ----------
    shape : PadShape
        Round (``shape.axisymmetric``): slab, crowned, layered or boned.
    thickness_mm, radius_mm : float
        Thickness of the pad at its highest point and radius of the punch. [mm]
    young_MPa : float
        Long-term Young's modulus of the resin, the upper one of a layered pad. [MPa]
    depth_mm : sequence of float
        Depths of the punch below the pad's highest point, above 0, at most 0.6 thicknesses. [mm]
    condition : str
        ``bonded`` (what touches sticks), ``frictionless`` or ``friction:MU``.
    base, poisson, extent_mm, law, progress
        As for :func:`dummydesign.pad.slab.sharp_edge.solve_curve`.
    cells : int
        Cells between the axis and the punch's edge, at least; half as many are solved for the error.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing. The stated error is what
        cells of twice the size changed, 0.3 of what the sharp edge added, and 0.2 %.

    Raises
    ------
    InputError
        For a value outside its range or a shape that is not round.
    NoAnswerError
        When no depth could be solved.
    """
    own, depths, ratio, unit = normalise(thickness_mm, radius_mm, young_MPa, depth_mm, poisson, law)
    press = Press(
        shape, float(thickness_mm), ratio, extent_mm / thickness_mm, base, condition, poisson, first_depth(depths)
    )
    press.check()
    if shape.flat_top:
        return _over_slab(press, own, young_MPa, depths, cells, law, progress)
    paths = [climb(press, own, depths, *grid, progress=progress) for grid in _grids(cells)]
    rough, fine, half = (_padded(path, len(depths)) for path in paths)
    value, added = sharp(rough, fine)
    count = int(np.isfinite(value).sum())
    stops = [path.stop for path in paths[:2] if path.stop]
    if not count:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {stops[0]}")
    error = LEAST_ERROR + EDGE_ERROR * np.abs(added) + MESH_ERROR * _held_on(np.abs(np.log(half / fine)))
    return _curve(press, depths, value * unit * thickness_mm**2, error, count, paths, stops)


def first_depth(depths: Array) -> float:
    """Depth that the apex is meshed for: 0.02, halved until no wanted depth is smaller."""
    return FIRST_DEPTH * 0.5 ** max(0, int(np.ceil(np.log2(FIRST_DEPTH / float(depths[0])) - 1e-9)))


def _grids(cells: int) -> list[tuple[int, float]]:
    """Cells and bead of the three solves: large bead, small bead, small bead on cells of twice the size."""
    return [(cells, RIMS[0]), (cells, RIMS[1]), (max(4, cells // 2), RIMS[1])]


def _over_slab(
    press: Press, own: Law, young_MPa: float, depths: Array, cells: int, law: Law | None,
    progress: Callable[[float], None] | None,
) -> PadCurve:  # fmt: skip
    """Force of a flat-topped pad: its ratio to the slab of the upper resin on twin grids, times the slab's force."""
    slab = _slab_curve(press, young_MPa, depths, law, progress)
    factors, paths = [], []
    if press.shape.plain:
        factors = [np.ones(len(depths))] * 3
    else:
        for grid in _grids(cells):
            pair = [climb(press, own, depths, *grid, twin=twin, progress=progress) for twin in (False, True)]
            factors.append(_padded(pair[0], len(depths)) / _padded(pair[1], len(depths)))
            paths += pair
    rough, fine, half = factors
    best = np.where(np.isfinite(fine), fine, rough)
    spread = np.abs(np.log(rough / fine)) + MESH_ERROR * np.abs(np.log(half / fine))
    error = slab.error_N / slab.force_N + 1e-3 + _held_on(spread)[: len(slab.depth_mm)]
    count = min(int(np.isfinite(best).sum()), len(slab.depth_mm))
    stops = [path.stop for path in paths[:4] if path.stop] + list(slab.notes)
    if not count:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {stops[0]}")
    force = best[:count] * slab.force_N[:count]
    curve = _curve(press, depths, force, error, count, paths, stops)
    solver = {name: value + slab.solver[name] for name, value in curve.solver.items()}
    return replace(curve, solver={**solver, "unknowns": max(curve.solver["unknowns"], slab.solver["unknowns"])})


def _slab_curve(
    press: Press, young_MPa: float, depths: Array, law: Law | None, progress: Callable[[float], None] | None
) -> PadCurve:
    """Sharp-edge force of the slab of the upper resin: from its table where it holds, else solved."""
    from dummydesign.pad.slab.sharp_edge import solve_curve
    from dummydesign.pad.slab.sliding_faces import solve_flat
    from dummydesign.pad.tables.slab import load_table

    h, a = press.thickness_mm, press.radius * press.thickness_mm
    plain = press.condition == "bonded" and press.poisson == 0.5 and (law is None or law == Yeoh(law.shear_MPa))
    if plain and abs(press.extent * h / PAD_EXTENT_MM - 1.0) < 0.01:
        table = load_table(press.base)
        low, high = table.ratio_range
        if low <= press.radius <= high:
            depth = depths[depths <= table.depth_limit(press.radius) * (1.0 + 1e-9)] * h
            force = table.force(depth, h, young_MPa, a)
            notes = () if len(depth) == len(depths) else (f"the slab's table ends at {depth[-1] / h:.3f}",)
            return PadCurve(depth, force, table.relative_error(depth, h, a) * force, dict(NOTHING), notes)
    common = {
        "base": press.base, "poisson": press.poisson, "extent_mm": press.extent * h, "law": law, "progress": progress
    }  # fmt: skip
    if press.condition == "bonded":
        return solve_curve(h, a, young_MPa, depths * h, **common)
    return solve_flat(h, a, young_MPa, depths * h, press.condition, **common)


def _padded(path: Path, count: int) -> Array:
    return np.concatenate([path.force, np.full(count - len(path.force), np.nan)])


def _held_on(values: Array) -> Array:
    """Largest value so far, carried over depths where it is not known; 1 % where it never is."""
    return np.maximum.accumulate(np.nan_to_num(values, nan=0.0)) if np.isfinite(values).any() else 0.0 * values + 0.01


def _curve(
    press: Press, depths: Array, force: Array, error: Array, count: int, paths: list[Path], stops: list[str]
) -> PadCurve:
    notes = ()
    if count < len(depths):
        notes = (f"solved to d/h = {depths[count - 1]:.3f} of {depths[-1]:.3f}: {stops[0]}",)
    depth, value = depths[:count] * press.thickness_mm, force[:count]
    return PadCurve(depth, value, error[:count] * value, cost(paths) if paths else dict(NOTHING), notes)
