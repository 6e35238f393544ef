"""What a mould maker would work out by hand: level, meniscus, deflection, forces, steps of a print. No CAD."""

from __future__ import annotations

import math

GRAVITY_M_PER_S2 = 9.80665


def tilt_error_mm(length_mm: float, angle_deg: float) -> float:
    """Difference of thickness over a length when the mould is out of level. [mm]"""
    return length_mm * math.tan(math.radians(angle_deg))


def level_tolerance_deg(thickness_mm: float, length_mm: float, share: float = 0.025, most_mm: float = 0.26) -> float:
    """How level the mould must stand so that thickness differs by at most ``share`` of it, or ``most_mm``. [deg]"""
    return math.degrees(math.atan(min(share * thickness_mm, most_mm) / length_mm))


def capillary_length_mm(surface_tension_N_per_m: float, density_g_per_cm3: float) -> float:
    """Capillary length sqrt(sigma / (rho g)). [mm]"""
    return 1e3 * math.sqrt(surface_tension_N_per_m / (density_g_per_cm3 * 1e3 * GRAVITY_M_PER_S2))


def meniscus_height_mm(surface_tension_N_per_m: float, density_g_per_cm3: float, contact_angle_deg: float) -> float:
    """Rise of a liquid at a long vertical wall, sqrt(2 (1 - sin theta)) capillary lengths. [mm]

    References
    ----------
    L. D. Landau, E. M. Lifshitz, Fluid Mechanics, section 61.
    """
    rise = math.sqrt(2 * (1 - math.sin(math.radians(contact_angle_deg))))
    return rise * capillary_length_mm(surface_tension_N_per_m, density_g_per_cm3)


def meniscus_volume_mm3(
    surface_tension_N_per_m: float, density_g_per_cm3: float, contact_angle_deg: float, perimeter_mm: float
) -> float:
    """Liquid held up by the meniscus along a wall, sigma cos(theta) / (rho g) per length. [mm3]"""
    length = capillary_length_mm(surface_tension_N_per_m, density_g_per_cm3)
    return length**2 * math.cos(math.radians(contact_angle_deg)) * perimeter_mm


def wall_deflection_mm(depth_mm: float, wall_mm: float, young_MPa: float, density_g_per_cm3: float) -> float:
    """Deflection of the top of a mould wall under the liquid, as a cantilever plate strip.

    Triangular load q = rho g (h - z): delta = rho g h^5 / (30 E I), I = w^3 / 12 per length (beam table).
    The side walls hold each other at the corners, so this is an upper bound. [mm]
    """
    weight = density_g_per_cm3 * 1e-6 * GRAVITY_M_PER_S2
    return weight * depth_mm**5 / (30 * young_MPa * wall_mm**3 / 12)


def collar_height_mm(thickness_mm: float, foam_factor: float) -> float:
    """Head room needed above the fill plane for resin that foams to ``foam_factor`` times its volume. [mm]"""
    return (foam_factor - 1) * thickness_mm


def peel_force_N(width_mm: float, adhesion_J_per_m2: float) -> float:
    """Steady force of peeling at a right angle, adhesion times width. [N]"""
    return adhesion_J_per_m2 * width_mm * 1e-3


def suction_force_N(area_mm2: float, pressure_kPa: float = 101.325) -> float:
    """Force that air pressure alone can hold on a pad without an air path. [N]"""
    return pressure_kPa * 1e-3 * area_mm2


def print_layer_mm(height_mm: float) -> float:
    """Layer height to print a curved master with: 5 % of the curve's height, 0.025 to 0.1 mm (judgement). [mm]"""
    return min(0.1, max(0.025, 0.05 * height_mm))


def tip_flat_mm(radius_mm: float, layer_mm: float) -> float:
    """Diameter of the flat that a layer leaves on a tip of a given radius, 2 sqrt(2 R l). [mm]"""
    return 2 * math.sqrt(2 * radius_mm * layer_mm)
