"""What a shaped pad holds, in closed form: caps, ridges, bones, layers; no CAD.

A conic profile of apex radius R has r^2 = 2 R z - e z^2 at depth z below its apex (sphere e = 1, paraboloid
e = 0), which is all that these volumes need.
"""

from __future__ import annotations

import math

from dummydesign.geometry.shapes import Boned, Bumped, Conic, Crowned, sphere_foot_mm
from dummydesign.mold.model.layout import Layout, layout
from dummydesign.mold.model.outline import drafted_volume_mm3, slab_volume_mm3
from dummydesign.mold.model.spec import MouldSpec, PadGeometry

# A bar ends this much before the drafted walls, so that it does not bind when it is lowered. [mm]
BAR_END_GAP_MM = 0.5
GAUSS_POINTS = 40


def cap_volume_mm3(conic: Conic) -> float:
    """Volume of a round cap, pi times the integral of r^2: pi (R c^2 - e c^3 / 3). [mm3]

    For a sphere this is pi c^2 (3 R - c) / 3.
    """
    return math.pi * (conic.radius_mm * conic.height_mm**2 - conic.factor * conic.height_mm**3 / 3)


def ridge_volume_mm3(conic: Conic, half_length_mm: float, slope: float) -> float:
    """Volume of a conic profile drawn out along a line whose ends lean outwards. [mm3]

    Parameters
    ----------
    conic : Conic
        Profile across the line.
    half_length_mm : float
        Half the length at the apex. [mm]
    slope : float
        Growth of the half length per depth below the apex.

    Returns
    -------
    float
        Integral of 2 r(z) 2 (half + slope z) over the depth z, by Gauss-Legendre quadrature in sqrt(z), where
        the integrand is smooth; exact to rounding.
    """
    import numpy as np

    place, weight = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    root = (place + 1) / 2
    z = conic.height_mm * root**2
    r = np.sqrt(2 * conic.radius_mm * z - conic.factor * z**2)
    grown = 2 * r * 2 * (half_length_mm + slope * z)
    return float(np.sum(grown * conic.height_mm * root * weight))


def ridge_ends(pad: PadGeometry) -> tuple[float, float]:
    """Half length at the apex [mm] and its growth per depth, of a ridge or of a bar in a drafted pad."""
    slope = math.tan(math.radians(pad.draft_deg))
    shape = pad.shape
    if isinstance(shape, Boned):
        return pad.length_mm / 2 + slope * (pad.thickness_mm - shape.height_mm) - BAR_END_GAP_MM, slope
    return pad.length_mm / 2 - slope * pad.face_height_mm, slope


def top_volume_mm3(pad: PadGeometry) -> float:
    """What stands above the flat of the tested face: crown, ridge or caps. [mm3]"""
    shape = pad.shape
    if isinstance(shape, Crowned):
        return ridge_volume_mm3(shape.conic, *ridge_ends(pad)) if shape.ridge else cap_volume_mm3(shape.conic)
    if isinstance(shape, Bumped):
        radius = shape.radius_mm
        return sum(cap_volume_mm3(Conic(radius, c, sphere_foot_mm(radius, c))) for _, _, c in shape.caps_mm())
    return 0.0


def bone_volume_mm3(pad: PadGeometry) -> float:
    """What a rigid bone displaces in the pad. [mm3]"""
    shape = pad.shape
    if not isinstance(shape, Boned):
        return 0.0
    return ridge_volume_mm3(shape.conic, *ridge_ends(pad)) if shape.bar else cap_volume_mm3(shape.conic)


def cavity_volume_mm3(spec: MouldSpec, plan: Layout | None = None) -> float:
    """Room in the mould up to the fill plane, a bone's room included: drafted slab and what its top adds. [mm3]

    See :func:`dummydesign.mold.model.outline.slab_volume_mm3`.
    """
    plan = plan or layout(spec)
    pad = spec.pad
    flat = slab_volume_mm3(
        plan.floor_outline, plan.depth_mm - plan.face_mm, pad.draft_deg, pad.edge_radius_mm * plan.scale
    )
    return flat + plan.scale**3 * top_volume_mm3(pad)


def resin_volume_mm3(spec: MouldSpec, plan: Layout | None = None) -> float:
    """Resin of the pad in the cold cavity: the cavity less the bone. [mm3]"""
    plan = plan or layout(spec)
    return cavity_volume_mm3(spec, plan) - plan.scale**3 * bone_volume_mm3(spec.pad)


def layer_volumes_mm3(spec: MouldSpec, plan: Layout | None = None) -> tuple[float, float]:
    """Volumes of the upper layer (at the mould's floor, poured first) and of the base layer. [mm3]"""
    plan = plan or layout(spec)
    pad = spec.pad
    upper = slab_volume_mm3(plan.floor_outline, plan.interface_mm, pad.draft_deg, pad.edge_radius_mm * plan.scale)
    return upper, cavity_volume_mm3(spec, plan) - upper


def mould_volume_mm3(spec: MouldSpec, plan: Layout | None = None) -> float:
    """Silicone of an open mould: block less cavity less brim, label neglected. [mm3]"""
    plan = plan or layout(spec)
    block = drafted_volume_mm3(plan.bottom, plan.height_mm, spec.body.outer_draft_deg)
    brim = drafted_volume_mm3(plan.brim_outline, spec.body.freeboard_mm, spec.pad.draft_deg)
    return block - cavity_volume_mm3(spec, plan) - brim
