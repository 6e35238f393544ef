"""What is verified of filleted punches, crowns under a punch, and contact pressure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.case import Case, first_stiffness
from dummydesign.pad.axisymmetric.filleted import filleted_problem, solve_under_fillet
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.fields import solve_fields
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.tables.slab import load_table
from studies.verification.check import Check

Array = np.ndarray
FILLETS, PRESSURE = "Filleted punches", "Crowns and contact pressure"
OTHER = "an independent finite-element code, its steps carried to zero"
# 4.5 mm, crown of radius 21.2, height 2 and foot 9.4 mm, 42.6 kPa, round punch of 15.798 mm: d/h and force in N.
CROWN_N = {0.15: 1.047, 0.2: 2.47, 0.25: 5.30}


def rounded_flat(flat: float, fillet: float, contact: Array, unit: float) -> tuple[Array, Array]:
    """Depth and force of a flat punch with a rounded shoulder on a half-space, shapes (n,).

    d = (c / rho) (sqrt(c^2 - b^2) - b acos(b / c)), F = 2 E* (c d - integral of the profile's g from b to c).

    Parameters
    ----------
    flat, fillet : float
        Radius b of the flat, and rho of the shoulder r^2 / 2 rho beside it.
    contact : ndarray, shape (n,)
        Contact radii c.
    unit : float
        Plane modulus E* = E / (1 - nu^2).
    """
    x = flat + (contact[:, None] - flat) * (np.arange(2000) + 0.5) / 2000.0
    g = x / fillet * (np.sqrt(x**2 - flat**2) - flat * np.arccos(flat / x))
    depth = contact / fillet * (np.sqrt(contact**2 - flat**2) - flat * np.arccos(flat / contact))
    return depth, 2.0 * unit * (contact * depth - g.mean(axis=1) * (contact - flat))


def rounded_punch() -> Iterator[Check]:
    """A flat with a shoulder r^2 / 2 rho on an incompressible half-space, the layer's own sink taken from flat punches.

    See :func:`rounded_flat`.
    """
    radius, fillet = 0.1, 0.03
    flat, unit = radius - fillet, 4.0
    sink = 1.0 / (3.0 * flat * first_stiffness(Case(flat, 12.0))) - 1.0 / (2.0 * unit * flat)
    contact = np.array([0.0725, 0.074])
    depth, force = rounded_flat(flat, fillet, contact, unit)
    curve = solve_under_fillet(Pad(1.0, 3.0, radius, extent_mm=12.0, edge_radius_mm=fillet), depth + sink * force)
    for c, expected, value in zip(contact, force, curve.force_N):
        name = f"rounded flat on a thick pad, contact to {c:g}"
        yield Check(FILLETS, name, float(expected), float(value), 8e-3, "closed form of a half-space")


def fillet_to_sharp() -> Iterator[Check]:
    """What fillets without sides leave to the sharp edge's table, and the power with which they do."""
    depth = np.array([0.5, 1.0])
    table = load_table()
    sharp, stated = table.force(depth, 10.0, 0.025, 7.9), table.solved_error(depth, 10.0, 7.9)
    force = np.array(
        [
            solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=mm), depth, sides=False).force_N
            for mm in (0.4, 0.2, 0.1)
        ]
    )
    gap = np.diff(force, axis=0)
    for k, d in enumerate(depth):
        order = float(np.log2(gap[0, k] / gap[1, k]))
        name = f"10 mm, d/h {d / 10:g}: order in the fillet, 0.4 to 0.1 mm"
        source = "1.25 of a sharp edge's singularity is the limit"
        yield Check(FILLETS, name, 1.0, order, 0.0, source, absolute=True, one_sided=True)
        limit = force[2, k] + gap[1, k] * 0.42 / 0.58
        name = f"10 mm, d/h {d / 10:g}, N: limit of small fillets, 25 kPa"
        yield Check(FILLETS, name, float(sharp[k]), float(limit), float(stated[k]) + 4e-3, "table of the sharp edge")


def fillet_cells() -> Iterator[Check]:
    """Order of the force in the cells round a fillet, and the same force with other wanted depths."""
    depths = np.array([0.1, 0.3])
    curve = solve_under_fillet(Pad(10.0, 3.0, 7.9, edge_radius_mm=0.5), 10.0 * depths)
    problem = filleted_problem(Case(0.79, 7.57, edge=0.05), coarser=0.5)
    finer = follow(problem, depths, 0.01, 0.02, 1e-4, lattice=True).force * 100.0
    for d, expected, force, error in zip(depths, finer, curve.force_N, curve.error_N):
        name, source = f"fillet of 0.5 mm, 10 mm, d/h {d:g}", "cells of half the size; tolerance: the stated error"
        yield Check(FILLETS, name, float(expected), float(force), float(error / force), source)
    many, one = (
        solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5), asked).force_N[-1]
        for asked in ([0.4, 1.1, 2.0], [2.0])
    )
    yield Check(FILLETS, "10 mm, d/h 0.2, N: with other depths", float(one), float(many), 1e-5, "asked for alone")


def crown_by_another_code() -> Iterator[Check]:
    """The forefinger's crowned pad, glued where it touches, from before to after the contact's flattening."""
    share = np.array(list(CROWN_N))
    curve = solve_shaped_pad(Pad(4.5, 0.0426, 7.899, geometry=Crowned(21.2, 2.0, 9.4)), 4.5 * share)
    for d, expected, force in zip(share, CROWN_N.values(), curve.force_N):
        yield Check(PRESSURE, f"crowned pad of 4.5 mm, d/h {d:g}, N", expected, float(force), 0.02, OTHER)
    dense = solve_shaped_pad(
        Pad(4.5, 0.0426, 7.899, geometry=Crowned(21.2, 2.0, 9.4)), 4.5 * np.arange(0.02, 0.251, 0.01)
    )
    name = "crowned pad of 4.5 mm, d/h 0.25, N: 3 and 24 depths asked for"
    yield Check(PRESSURE, name, float(dense.force_N[-1]), float(curve.force_N[-1]), 3e-3, "depths every 0.01 h")


def hertz_pressure() -> Iterator[Check]:
    """Peak and form of the pressure over a shallow crown without friction: p0 = 3 F / (2 pi a^2)."""
    depth = 0.16
    shape = read_shape("crowned:40,1.5,11")
    pad = Pad(20.0, 0.03, 9.0, condition="frictionless", geometry=shape, extent_mm=60.0)
    field = solve_fields(pad, [0.5 * depth, depth])[0][-1]
    r, p = field.face.radius_mm, field.face.pressure_MPa
    inside = p > 0.3 * p.max()
    slope, peak = np.polyfit(r[inside] ** 2, p[inside] ** 2, 1)
    radius = float(np.sqrt(-peak / slope))
    expected = 1.5 * field.force_N / (np.pi * radius**2)
    yield Check(PRESSURE, "peak pressure over a crown, kPa", 1e3 * expected, 1e3 * float(np.sqrt(peak)), 0.02, "Hertz")


CHECKS = (rounded_punch, fillet_to_sharp, fillet_cells, crown_by_another_code, hertz_pressure)
