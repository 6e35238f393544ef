"""Unilateral contact of a slab with a rigid axisymmetric punch: frictionless, rough or sticking.

The whole face is in contact that opens and closes; the pad is pushed by it alone. Use this for shaped
punches, and for flat ones that are not glued; the sharp, glued punch has its own way (``sharp_edge``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.errors import InputError
from dummydesign.geometry.interface import FACES, Interface
from dummydesign.pad.axisymmetric.case import Case, held_on, padded, relative_depths, round_problem, unsolved
from dummydesign.pad.contact.axisymmetric import (
    PROFILE_PUNCH,
    SLIDING_EDGE,
    AxisymmetricSurface,
    FlatPunch,
    Penalty,
    ProfilePunch,
    RigidPunch,
)
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import STABILISATION
from dummydesign.pad.force_law import Array, PadCurve
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath, cost, follow
from dummydesign.pad.solve.equilibrium import ContactProblem

SLIP_SCALE = 0.02
# A profile whose slope at the axis, by the parabola through its first three points, is at least this share of that to
# the first point has a pointed tip; a ball's is 0, a cone's 1.
POINTED = 0.5
# Cells from the axis to a profile's reach, and how large they may be over their radius: uniform ones move the force by
# 0.1 %. Four of them lie in the contact at the first depth, where that is less than a sixth of the reach.
CELLS, SHARE = 24, 0.08
# Cells per fillet of a flat face that slides, which is meshed finely this many fillets inwards of its edge and beyond.
EDGE_CELLS, EDGE_INWARDS, EDGE_BEYOND = 3.0, 3.0, 2.0
TIP_CELLS = 6.0
# Growth of the cells away from where they are fine.
GROWTH = 1.3
# A step: the slope falls by this within two cells. Forces are right to this share of the depth at which its top is as
# deep as the surface was (beyond it two ledges were 3 to 14 % off with 0.7 to 5 % stated).
FALL, BEFORE_TOP = 1.0, 0.8
# Stated besides a third of what cells of twice the size change: together more than what half the size changes.
LEAST_ERROR = {"frictionless": 2e-3, "bonded": 3e-3, "friction": 5e-3}
# Load steps in thicknesses of contact that remembers its path: half of them move a force by at most 0.27 %.
STEP = 0.005


def profile(radius: ArrayLike, height: ArrayLike) -> ProfilePunch:
    """A punch through points (r, z(r)) measured from its lowest point, joined by a smooth curve.

    Its tip is round, or pointed where the first points lie on a straight line.
    """
    from scipy.interpolate import CubicHermiteSpline

    r, z = np.asarray(radius, dtype=float), np.asarray(height, dtype=float)
    if len(r) < 3 or len(r) != len(z) or r[0] != 0.0 or np.any(np.diff(r) <= 0.0) or not np.isfinite(z).all():
        message = "a punch profile needs at least 3 points with radii that start at 0 and increase"
        raise InputError(message, "malformed", "punch_profile")
    if abs(z[0]) > 1e-9 or z.min() < -1e-9:
        message = f"punch profile height = {z.min():.4g} at its lowest; it must start at 0 on the axis and rise"
        raise InputError(message, "malformed", "punch_profile")
    curve = CubicHermiteSpline(r, z, tilts(r, z))
    slope, second, third = (curve.derivative(order) for order in (1, 2, 3))

    def height_at(at: Array) -> tuple[Array, Array, Array, Array]:
        inside = np.clip(at, 0.0, r[-1])
        steep = slope(inside)
        bent = (np.where(at <= r[-1], part(inside), 0.0) for part in (second, third))
        return curve(inside) + (at - inside) * steep, steep, *bent

    return ProfilePunch(height_at)


def tilts(r: Array, z: Array) -> Array:
    """Slopes of a profile at its points: of the parabola through three, kept between the points' heights [1].

    A ball's are exact to third order, where those of Fritsch and Butland are a quarter off next to its tip and make a
    shallow contact a fifth too soft.

    References
    ----------
    .. [1] F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238, doi 10.1137/0717021.
    """
    step = np.diff(r)
    secant = np.diff(z) / step
    tilt = np.empty(len(r))
    before, after = secant[:-1], secant[1:]
    tilt[1:-1] = (step[1:] * before + step[:-1] * after) / (step[1:] + step[:-1])
    bend = (after - before) / (step[1:] + step[:-1])
    tilt[0] = secant[0] - bend[0] * step[0]
    if tilt[0] < POINTED * secant[0]:
        tilt[0] = 0.0
    tilt[-1] = secant[-1] + bend[-1] * step[-1]
    if tilt[-1] * secant[-1] < 0.0:
        tilt[-1] = 0.0
    least = np.minimum(np.abs(np.r_[secant[0], secant]), np.abs(np.r_[secant, secant[-1]]))
    turns = np.r_[False, before * after <= 0.0, False]
    return np.where(turns, 0.0, np.sign(tilt) * np.minimum(np.abs(tilt), 3.0 * least))


@dataclass(frozen=True)
class Region:
    """Where the surface is meshed finely: from ``start`` to ``stop`` with cells of size ``cell`` (thicknesses).

    With ``share`` cells may be as large as that share of their radius: a contact that grows from the axis is then
    resolved alike at every depth.
    """

    start: float
    stop: float
    cell: float
    share: float = 0.0

    def lines(self) -> Array:
        """Radii of the cells' ends, shape (n,)."""
        if not self.share:
            return np.linspace(self.start, self.stop, max(2, round((self.stop - self.start) / self.cell)) + 1)
        r = [self.start]
        while r[-1] < self.stop:
            r.append(r[-1] + max(self.cell, self.share * r[-1]))
        return self.start + (np.array(r) - self.start) * (self.stop - self.start) / (r[-1] - self.start)


def indentation_problem(
    punch: RigidPunch, region: Region, case: Case, penalty: Penalty = SLIDING_EDGE
) -> ContactProblem:
    """A slab of unit thickness under a rigid punch, contact over the whole top."""
    face, cell = Interface.parse(case.condition, "condition", FACES), region.cell
    inner = meshes.graded(region.start, 0.0, cell, GROWTH)[::-1] if region.start > 0.0 else np.array([0.0])
    fine = region.lines()
    outer = meshes.graded(region.stop, case.extent, max(cell, fine[-1] - fine[-2]), GROWTH)
    points, quads, _ = meshes.columns(
        np.concatenate([inner[:-1], fine, outer[1:]]), -meshes.graded(0.0, -1.0, cell, GROWTH)
    )
    mesh = meshes.discretise(points, quads)
    sides = meshes.edges_on(mesh, meshes.on_top(mesh) & (mesh.nodes[0] <= region.stop + 0.5))
    contact = case.law.shear_MPa * penalty.contact
    surface = AxisymmetricSurface(
        mesh.nodes,
        sides,
        lambda radius: contact / np.maximum(cell, region.share * radius),
        grip=contact / cell * float(face.bonded),
        grip_from=0.0,
        friction=face.coulomb or 0.0,
        slip_scale=SLIP_SCALE * cell,
        ties_within_step=True,
    )
    # What touches at the start sticks or slips from where it is.
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    return round_problem(mesh, case, np.array([], dtype=int), surface, punch, None, STABILISATION)


def edge_problem(case: Case) -> ContactProblem:
    """A slab under a flat punch with a small fillet ``case.edge``, contact over the whole face."""
    start = max(0.0, case.radius - EDGE_INWARDS * case.edge)
    region = Region(start, case.radius + EDGE_BEYOND * case.edge, case.edge / EDGE_CELLS)
    return indentation_problem(FlatPunch(case.radius, case.edge), region, case)


def press(
    problem: ContactProblem, depths: ArrayLike, first_step: float, largest_step: float, lattice: bool = False
) -> ForcePath:
    """Follow the contact through depths; raise when not even the first is reached."""
    path = follow(problem, depths, first_step, largest_step, first_step / 64.0, lattice=lattice)
    if not len(path.depth):
        raise unsolved(path.stop, "contact")
    return path


def solve_profile(pad: Pad, depth_mm: ArrayLike, punch: ProfilePunch | None = None, cells: int = CELLS) -> PadCurve:
    """Static force of a slab under a ball or profile, its own or another one in mm, from first touch.

    The stated error is a third of what cells of twice the size change, and 0.2 % without friction, 0.3 % where it
    sticks, else 0.5 %.
    """
    h, case, depths = pad.thickness_mm, Case.of(pad, check=False), relative_depths(depth_mm, pad.thickness_mm)
    own = relative_punch(pad, punch)
    depths, note = before_the_step(own, case.radius, depths, h, cells)
    first, largest, lattice = load_steps(pad.condition, float(depths[0]))
    fine, coarse = (profile_problem(case, own, float(depths[0]), number) for number in (cells, max(4, cells // 2)))
    path = press(fine, depths, first, largest, lattice)
    half = follow(coarse, path.depth, first, largest, first / 64.0, lattice=lattice)
    # With cells of twice the size a smooth contact is wrong by four times as much.
    change = held_on(np.abs(np.log(padded(half, len(path.depth)) / path.force))) / 3.0
    error = LEAST_ERROR[pad.condition.partition(":")[0]] + change
    force = path.force * pad.shear_MPa * h**2
    notes = tuple(one for one in (path.stop, note) if one)
    return PadCurve(path.depth * h, force, error * force, cost([path, half]), notes)


def before_the_step(punch: ProfilePunch, reach: float, depth: Array, unit_mm: float, cells: int) -> tuple[Array, str]:
    """Depths that end before the top of a step narrower than two cells (thicknesses), and a note if any are left out.

    Raises
    ------
    InputError
        When all depths are beyond.
    """
    region = tip_region(punch, reach, float(depth[0]), cells)
    r = np.linspace(0.0, reach, 4001)[1:-1]
    height, slope, *_ = punch.height(r)
    # in steps of r, of the cells there
    widths = np.maximum(1, np.ceil(2.0 * np.maximum(region.cell, region.share * r) / (r[1] - r[0]))).astype(int)
    later = np.minimum(np.arange(len(r)) + widths, len(r) - 1)
    falls = np.flatnonzero(slope - slope[later] > FALL)
    if not len(falls):
        return depth, ""
    top = later[falls[0]]
    limit = BEFORE_TOP * float(height[top])
    kept = depth[depth <= limit]
    if len(kept) == len(depth):
        return depth, ""
    steepest = falls[0] + int(np.argmax(slope[falls[0] : top + 1]))
    message = (
        f"the punch profile has a step at r = {r[steepest] * unit_mm:.3g} mm, {height[top] * unit_mm:.3g} mm high, "
        f"that is narrower than two cells; forces deeper than {limit * unit_mm:.3g} mm are not resolved"
    )
    if not len(kept):
        advice = "press less deep, or end the profile before the step if the pad does not reach it"
        raise InputError(f"{message}: {advice}", "unsupported", "punch_profile", float(depth[0]) * unit_mm)
    return kept, message


def profile_problem(case: Case, punch: ProfilePunch, first: float, cells: int = CELLS) -> ContactProblem:
    """A slab under a profile in thicknesses, meshed for the contact at a first depth."""
    return indentation_problem(punch, tip_region(punch, case.radius, first, cells), case, PROFILE_PUNCH)


def relative_punch(pad: Pad, punch: ProfilePunch | None = None) -> ProfilePunch:
    """The pad's profile, or another one in mm, with lengths in thicknesses."""
    h = pad.thickness_mm
    if punch is None:
        assert pad.profile_mm is not None
        punch = profile(*pad.profile_mm)

    def height(r: Array) -> tuple[Array, Array, Array, Array]:
        value, slope, second, third = punch.height(r * h)
        return value / h, slope, second * h, third * h**2

    return ProfilePunch(height)


def tip_region(punch: ProfilePunch, reach: float, first: float, cells: int) -> Region:
    """Cells under a profile punch, small enough at the axis for the contact at the first depth."""
    r = np.geomspace(1e-4 * reach, reach, 400)
    # Where the surface, which rises to half of the depth at a ball's contact, meets the profile.
    tip = float(r[np.searchsorted(punch.height(r)[0], 0.5 * first).clip(0, len(r) - 1)])
    return Region(0.0, reach, min(reach, TIP_CELLS * tip) / cells, SHARE * CELLS / cells)


def load_steps(condition: str, first: float) -> tuple[float, float, bool]:
    """First and largest load step under a profile punch, and whether they are the same for all wanted depths."""
    return (0.25 * first, 0.05, False) if condition == "frictionless" else (0.25 * STEP, STEP, True)
