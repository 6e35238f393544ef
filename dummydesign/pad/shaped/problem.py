"""A shaped pad under a round flat punch as a problem of finite elements: mesh, contact, what is glued."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.geometry.shapes import PadShape
from dummydesign.pad.contact.stiffness import ROUND_SHAPED_PAD
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch, Surface
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_columns import Sizes, columns, height_lines, radial_lines, stretch
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.filleted import FilletedPunch
from dummydesign.pad.slab.problem import FILM_REACH, FILM_STIFFNESS
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Contact stiffness in shear moduli over the cell, and what holds a sticking point, as a share of it.
CONTACT_STIFFNESS, GRIP_SHARE = ROUND_SHAPED_PAD.contact, ROUND_SHAPED_PAD.grip_share
# Fillets at the punch's edge over the smaller of radius and thickness.
RIMS = (0.1, 0.05)
CELLS = 16


class Plate(FlatPunch):
    """A flat punch with a fillet whose face pushes back from any depth inside it, so that steps may be large."""

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
    edge : float
        Radius of the fillet of a real punch, whose upright side can touch; 0 for a sharp edge.
    """

    shape: PadShape
    thickness_mm: float
    radius: float
    extent: float
    base: str = "bonded"
    condition: str = "bonded"
    poisson: float = 0.5
    first: float = 0.02
    edge: float = 0.0

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
    """The pad under a punch with an edge fillet.

    Parameters
    ----------
    press : Press
        Pad, punch and support in thicknesses.
    law : Law
        Of the upper resin; its moduli set the unit of stress.
    cells : int
        Cells between the axis and the punch's edge, at least.
    rim : float
        Fillet radius that stands for a sharp edge, over the smaller of punch radius and thickness.
    twin : bool
        Make the homogeneous slab without a bone on the same grid instead.
    """
    face = Interface.parse(press.condition, "condition", FACES)
    grip = float(face.bonded)
    if press.base not in BASES:
        raise InputError(f"base = '{press.base}' is not one of {', '.join(BASES)}")
    sharp = Plate(press.radius, rim * press.scale)
    punch: FlatPunch = FilletedPunch(press.radius, press.edge) if press.edge else sharp
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
        mesh = replace(mesh, weight=mesh.weight * factor[:, None], modulus_factor=factor)
    node = meshes.cell_nodes(mesh)
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
        # The glued face moves with the punch node by node; near the fillet it is held by contact and a film.
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
