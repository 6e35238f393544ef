"""The law of first touch: force of a solved curve below its first solved depth.

A punch that meets a face first touches it as if the pad were a half-space. Where their gap f(r) is round, depth and
force of a contact of radius c are, without friction [1],

    d = c int_0^c f'(r) / sqrt(c^2 - r^2) dr,   F = 2 E / (1 - nu^2) int_0^c r^2 f'(r) / sqrt(c^2 - r^2) dr,

and beyond the contact's largest radius every further depth adds 2 E / (1 - nu^2) c. This is d of a flat punch on a flat
face, d^1.5 of a ball or a crown, d^2 of a cone, and what a fillet adds to a flat face.

A layer is stiffer by a factor whose logarithm grows about evenly with the contact's radius [2, 3]: a flat punch has
0.25 at c / h = 0.2, 0.52 at 0.4 and 1.29 at 1. So the factor that was found at the first solved depth falls evenly with
the contact's radius, to 1 at a contact without size.

References
----------
.. [1] I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47, doi 10.1016/0020-7225(65)90019-4.
.. [2] W. C. Hayes et al., J. Biomech. 5 (1972) 541, doi 10.1016/0021-9290(72)90010-3.
.. [3] E. K. Dimitriadis et al., Biophys. J. 82 (2002) 2798, doi 10.1016/S0006-3495(02)75620-8.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.interpolation import monotone_cubic
from dummydesign.geometry.interface import BASES, Interface
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.force_law import Array, ForceCurve, PadCurve
from dummydesign.pad.pad_under_punch import SLAB, Pad, Puck

# Radii of contact at which the law is worked out, the smallest over the largest, and points along each integral.
RADII, SMALLEST, QUADRATURE, FLAT = 240, 1e-7, 48, 1e-20
# Share of the logarithm of the layer's factor by which that between a contact without size and the first solved one
# may be off: 3.4 % at c / h = 0.6 and 2 % at 1 by [3].
FACTOR_ERROR = 0.1
# The change of F / d^power between the first solved depth and one at least this much deeper states how far it is known.
FURTHER = 1.5
# Contact grows cell by cell: its radius at the first depth that is solved, over the thickness, under a profile and on
# a tip. A shallower one is known better by the law of first touch. Depths over the thickness that are solved at least.
FIRST_CONTACT = {"profile": 0.01, "tip": 0.1}
LEAST_SHARE, LEAST_SHARE_IN_SPACE = 1e-4, 0.01
# A pad that rests on friction is solved from this share on: there the slip at which friction acts in full, which the
# elements need, is 1 % of the force. In shallower presses the pad's weight holds it; the force then rises from that of
# a pad that slips (0.61 to 0.98 of the glued pad's, docs/data/pad-base-friction.csv) to the glued pad's.
LEAST_SHARE_RESTING, STUCK_BASE = 0.01, 0.5
# A contact that grows is solved once at no more than this radius over the thickness, up to which a layer's factor is
# known to follow the contact's radius.
EVEN_CONTACT = 0.25
# Depths over a crown's height at which it is solved too: between two depths 2 % of the pad's thickness apart, a curve
# through a foot of 5.5 mm under a punch of 8 mm was up to 4.4 % off.
AT_FOOT = np.array([0.97, 1.0, 1.02, 1.04, 1.06, 1.09, 1.13])
# A contact grows with depth where the force rises with more than this power of it.
GROWING = 1.05


@dataclass(frozen=True)
class HalfSpaceTouch:
    """Force over E and contact radius of a punch on a half-space, at increasing depths; arrays of one length.

    ``face_mm`` is the radius that touches at once: that of a flat punch on a flat face, 0 of a tip; ``per_contact`` the
    force over E, depth and contact radius of a flat face, 2 / (1 - nu^2).
    """

    depth_mm: Array
    area_mm2: Array
    contact_mm: Array
    face_mm: float
    per_contact: float = 2.0

    def contact(self, depth_mm: ArrayLike) -> Array:
        """Radius of the contact. [mm]"""
        depth = np.asarray(depth_mm, float)
        if len(self.depth_mm) == 1:
            return np.full(depth.shape, self.contact_mm[0])
        if self.face_mm:
            return np.interp(depth, np.r_[0.0, self.depth_mm], np.r_[self.face_mm, self.contact_mm])
        return np.exp(self._log(depth, self.contact_mm))

    def area(self, depth_mm: ArrayLike) -> Array:
        """Force over Young's modulus. [mm2]"""
        depth = np.asarray(depth_mm, float)
        unit = self.per_contact
        inside = np.clip(depth, 0.0, self.depth_mm[-1])
        if self.face_mm:
            # what grows beyond the face, over what the face alone carries
            carried = self.area_mm2 / np.where(self.depth_mm > 0.0, unit * self.face_mm * self.depth_mm, 1.0)
            factor = np.interp(inside, np.r_[0.0, self.depth_mm], np.r_[1.0, np.maximum(carried, 1.0)])
            area = unit * self.face_mm * inside * factor
        else:
            area = np.exp(self._log(inside, self.area_mm2))
        area = area + unit * self.contact_mm[-1] * np.maximum(depth - self.depth_mm[-1], 0.0)
        return np.where(depth > 0.0, area, 0.0)

    def power(self, depth_mm: float) -> float:
        """d ln F / d ln d at a depth: 1 of a flat face, 1.5 of a rounded tip, 2 of a cone."""
        return float(self.per_contact * depth_mm * self.contact(depth_mm) / self.area(depth_mm))

    def depth_of(self, contact_mm: float) -> float:
        """Depth at which the contact has a radius; 0 where the face is larger. [mm]"""
        if contact_mm <= self.face_mm:
            return 0.0
        return float(np.interp(contact_mm, self.contact_mm, self.depth_mm))

    def _log(self, depth: Array, values: Array) -> Array:
        """ln of values over ln of depth, on straight lines that go on below the first."""
        known, at = np.log(self.depth_mm), np.log(np.maximum(depth, 1e-300))
        log = np.log(values)
        below = np.minimum(at - known[0], 0.0) * (log[1] - log[0]) / (known[1] - known[0])
        return np.interp(at, known, log) + below


def half_space_touch(
    slope: Callable[[Array], Array], face_mm: float, reach_mm: float, poisson: float
) -> HalfSpaceTouch:
    """Solve the contact of a round gap whose slope is given at radii (mm), flat to ``face_mm``, to ``reach_mm``."""
    per_contact = 2.0 / (1.0 - poisson**2)
    if face_mm >= reach_mm:
        zero = np.zeros(1)
        return HalfSpaceTouch(zero, zero, np.array([reach_mm]), reach_mm, per_contact)
    x, weight = np.polynomial.legendre.leggauss(QUADRATURE)
    t, weight = 0.5 * (x + 1.0), 0.5 * weight
    grown = (reach_mm - face_mm) * np.geomspace(SMALLEST, 1.0, RADII)
    c = face_mm + grown
    # r = c - (c - face) t^2 takes the root at the contact's edge out of the integrals
    r = c[:, None] - grown[:, None] * t**2
    part = 2.0 * np.sqrt(grown)[:, None] * slope(r) / np.sqrt(c[:, None] + r)
    depth, area = c * (part @ weight), per_contact * ((r**2 * part) @ weight)
    flat = int(np.argmax(depth > FLAT * depth[-1]))
    if flat and not face_mm:  # a flat that the shape did not name
        return half_space_touch(slope, float(c[flat - 1]), reach_mm, poisson)
    rising = (depth > 0.0) & (np.diff(depth, prepend=0.0) > 0.0) & (area > 0.0)
    rising[flat:] = np.minimum.accumulate(rising[flat:])
    return HalfSpaceTouch(depth[rising], area[rising], c[rising], face_mm, per_contact)


def touch_of(pad: Pad | Puck) -> HalfSpaceTouch | None:
    """The law of first touch of a pad and its punch; None of a puck and of a shape that is not round about its top."""
    if isinstance(pad, Puck):
        return None
    reach, poisson = float(pad.radius_mm), pad.poisson
    if pad.geometry != SLAB:
        return _shape_touch(pad, reach, poisson)
    if pad.profile_mm is not None:
        from dummydesign.pad.axisymmetric.profile_punch import profile

        punch = profile(*pad.profile_mm)
        radii, heights = (np.asarray(part, float) for part in pad.profile_mm)
        face = float(radii[max(int(np.argmax(heights > 0.0)) - 1, 0)]) if heights.any() else reach
        return half_space_touch(lambda r: punch.height(r)[1], face, reach, poisson)
    rim = pad.edge_radius_mm
    if not rim:
        return half_space_touch(np.zeros_like, reach, reach, poisson)
    face = reach - rim

    def fillet(r: Array) -> Array:
        share = np.clip((r - face) / rim, 0.0, 1.0 - 1e-9)
        return share / np.sqrt(1.0 - share**2)

    return half_space_touch(fillet, face, reach, poisson)


def _shape_touch(pad: Pad, reach: float, poisson: float) -> HalfSpaceTouch | None:
    shape = pad.geometry
    if not shape.axisymmetric:
        return None
    if shape.flat_top:
        return half_space_touch(np.zeros_like, reach, reach, poisson)
    step = 1e-6 * reach

    def slope(r: Array) -> Array:
        low = np.maximum(r - step, 0.0)
        # near the tip the fall is that of its radius, which a difference of tiny falls would lose
        steep = (shape.drop_mm(r + step, 0.0 * r) - shape.drop_mm(low, 0.0 * r)) / (r + step - low)
        tip = shape.tip_radius_mm
        return np.where(r < 1e-3 * reach, r / tip, steep) if tip else steep

    return half_space_touch(slope, 0.0, reach, poisson)


@dataclass(frozen=True)
class LowEnd:
    """Force of a pad from first touch to its first solved depth, and its relative error.

    ``log_first`` is the logarithm of the factor of the force over that on a half-space at the first solved depth;
    ``doubt`` what the factor may be off by at a contact without size.
    """

    first_mm: float
    force_N: float
    error: float
    touch: HalfSpaceTouch | None
    log_first: float
    log_change: float
    doubt: float
    power: float

    def force(self, depth_mm: ArrayLike) -> Array:
        """Force at depths up to the first solved one; zero above the surface. [N]"""
        depth = np.asarray(depth_mm, float)
        safe = np.maximum(depth, 1e-300)
        if self.touch is None:
            part = (safe / self.first_mm) ** _way(self.power)
            log = self.power * np.log(safe / self.first_mm) + self.log_change * (1.0 - part)
        else:
            part = self.touch.contact(safe) / self.touch.contact(self.first_mm)
            ratio = self.touch.area(safe) / self.touch.area(self.first_mm)
            log = np.log(np.maximum(ratio, 1e-300)) - self.log_first * (1.0 - part)
        return np.where(depth > 0.0, self.force_N * np.exp(log), 0.0)

    def relative_error(self, depth_mm: ArrayLike) -> Array:
        """Error of the force over the force: that of the first solved depth, and of the way to it."""
        depth = np.maximum(np.asarray(depth_mm, float), 0.0)
        return self.error + self.doubt * (1.0 - np.minimum(depth / self.first_mm, 1.0))


def low_end(pad: Pad | Puck, depth_mm: Array, force_N: Array, relative_error: Array) -> LowEnd:
    """Join the law of first touch to the first of the solved depths of a pad.

    Parameters
    ----------
    pad : Pad or Puck
    depth_mm, force_N, relative_error : ndarray, shape (n,)
        What was solved; depths above 0, increasing. [mm, N]
    """
    touch = touch_of(pad)
    first, force, error = float(depth_mm[0]), float(force_N[0]), float(relative_error[0])
    further = np.flatnonzero(depth_mm >= FURTHER * first)
    other = int(further[0]) if len(further) else None
    if touch is None:
        power = 1.0 if isinstance(pad, Puck) else pad.geometry.first_exponent
        change = doubt = 0.0
        if other is not None:
            log = np.log(force_N[[0, other]] / depth_mm[[0, other]] ** power)
            # evenly with the contact's radius, which grows as the root of the depth; of a whole face with the depth
            way = (depth_mm[other] / first) ** _way(power) - 1.0
            change = -float(log[1] - log[0]) / way
            doubt = abs(change)
        return LowEnd(first, force, error, None, 0.0, change, doubt, power)
    log_first = float(np.log(force / (pad.young_MPa * touch.area(first))))
    doubt = FACTOR_ERROR * abs(log_first) * (1.0 - touch.face_mm / float(touch.contact(first)))
    if touch.face_mm and other is not None:
        # A face that touches at once has one contact: its force per depth still changes with the depth.
        secant = np.log(force_N[[0, other]] / touch.area(depth_mm[[0, other]]))
        doubt += float(abs(secant[1] - secant[0])) * first / (float(depth_mm[other]) - first)
    if isinstance(pad, Pad) and pad.condition != "frictionless":
        doubt += float(np.log(stuck_factor(pad.poisson)))
    if isinstance(pad, Pad) and Interface.names_friction(pad.base):
        doubt += STUCK_BASE * touch.face_mm / float(touch.contact(first))
    return LowEnd(first, force, error, touch, log_first, 0.0, doubt, touch.power(first))


def _way(power: float) -> float:
    """Power of the depth with which the secant changes: that of the contact's radius, 1 if a face touches at once."""
    return 1.0 if power == 1.0 else 0.5


def stuck_factor(poisson: float) -> float:
    """Force of a flat punch that sticks to a half-space over that of one without friction; 1 of an incompressible one.

    (1 - nu) ln(3 - 4 nu) / (1 - 2 nu), V. I. Mossakovskii, J. Appl. Math. Mech. 18 (1954) 187.
    """
    if poisson > 0.499999:
        return 1.0
    return (1.0 - poisson) * float(np.log(3.0 - 4.0 * poisson)) / (1.0 - 2.0 * poisson)


def with_foot(depth_mm: Array, shape: PadShape, radius_mm: float) -> Array:
    """Rising depths, and within them those at which the face around a crown's foot under the punch comes to touch.

    The force bends there. [mm]
    """
    if not (isinstance(shape, Crowned) and shape.foot_mm < radius_mm):
        return depth_mm
    foot = shape.height_mm * AT_FOOT
    return np.union1d(depth_mm, foot[foot < depth_mm[-1]])


def solvable_depths(pad: Pad | Puck, depth_mm: Array, in_space: bool = False) -> Array:
    """Depths of a grid that can be solved, those of a crown's foot, and those that first touch is joined to. [mm]"""
    if isinstance(pad, Pad) and not in_space:
        depth_mm = with_foot(depth_mm, pad.geometry, pad.radius_mm)
    touch = touch_of(pad)
    least = least_depth_mm(pad, in_space)
    depth_mm = depth_mm[depth_mm >= least * (1.0 - 1e-9)]
    if len(depth_mm) < 2:  # a curve has two, however shallow the wanted ones are
        depth_mm = np.union1d(depth_mm, least * np.array([1.0, FURTHER]))
    if touch is not None and not touch.face_mm:
        shallow = max(least, touch.depth_of(EVEN_CONTACT * pad.thickness_mm))
        if shallow < depth_mm[0]:
            depth_mm = np.r_[shallow, depth_mm]
    return depth_mm


def least_depth_mm(pad: Pad | Puck, in_space: bool = False) -> float:
    """Smallest depth that is solved. [mm]"""
    touch = touch_of(pad)
    h = pad.thickness_mm
    least = (LEAST_SHARE_IN_SPACE if in_space else LEAST_SHARE) * h
    if isinstance(pad, Puck):
        return least
    if Interface.names_friction(pad.base):
        least = max(least, LEAST_SHARE_RESTING * h)
    if touch is not None and not touch.face_mm:
        return max(least, touch.depth_of(FIRST_CONTACT["profile" if pad.geometry == SLAB else "tip"] * h))
    plain = pad.geometry == SLAB and pad.profile_mm is None
    if plain and (pad.edge_radius_mm or (pad.condition == "bonded" and pad.base in BASES)):
        return 0.0  # interpolated between depths of its own, first touch among them
    return least


def interpolate_curve(solved: PadCurve, end: LowEnd) -> ForceCurve:
    """A curve through solved depths that runs down to first touch by its law.

    Parameters
    ----------
    solved : PadCurve
        What was solved, at two depths above 0 or more.
    end : LowEnd
        The law of first touch, joined at the first solved depth.
    """
    depth, force = solved.depth_mm, solved.force_N
    # F over depth to the power of first touch varies little: with a contact that grows, over the root of the depth.
    scale = np.sqrt if end.power > GROWING else np.asarray
    stiffness = monotone_cubic(scale(depth), np.log(force / depth**end.power))
    error = solved.error_N / force

    def value(at: Array) -> Array:
        at = np.asarray(at, dtype=float)
        inside = np.clip(at, depth[0], depth[-1])
        return np.where(at < depth[0], end.force(at), inside**end.power * np.exp(stiffness(scale(inside))))

    def error_at(at: Array) -> Array:
        return np.where(np.asarray(at) < depth[0], end.relative_error(at), np.interp(at, depth, error))

    return ForceCurve(value, error_at, float(depth[-1]), solved.solver, solved.notes, first_mm=end.first_mm)
