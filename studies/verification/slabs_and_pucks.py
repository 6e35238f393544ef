"""What is verified: closed forms, limits, published solutions, convergence orders, invariances, tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.pad.axisymmetric.case import Case, first_stiffness, rimmed_problem
from dummydesign.pad.axisymmetric.finite_strain import follow_motion
from dummydesign.pad.axisymmetric.puck import UnitPuck, compress, puck_problem
from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import HyperelasticLaw, Ogden, Yeoh
from dummydesign.pad.material.relaxation import PronyTerm, Viscoelastic, relaxed_force
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import RESIDUAL_TOLERANCE, Equilibrium, newton_search
from dummydesign.pad.solve.sparse import Pattern
from studies.verification import contact, edges, first_touch
from studies.verification.check import Check
from studies.verification.shapes import cap_on_layer, slab_limits

Array = np.ndarray
NEO = Yeoh(1.0)
ARMS = (PronyTerm(0.05, 0.6), PronyTerm(1.0, 0.3))
HAYES = "layer solution of Hayes et al., J. Biomech. 5 (1972) 541, integral equation solved anew"
LAYER = {
    0.5: {0.2: 1.281, 0.4: 1.684, 1.0: 3.619, 2.0: 9.149, 3.0: 18.157},
    0.45: {0.4: 1.599, 1.0: 3.091, 2.0: 6.421},
    0.4: {0.4: 1.542, 1.0: 2.794, 2.0: 5.299},
    0.3: {0.4: 1.473, 1.0: 2.484, 2.0: 4.353},
}
LAWS: dict[str, tuple[HyperelasticLaw, Callable[[Array], Array]]] = {
    "neo-Hookean": (NEO, lambda s: 1 / s**2 - s),
    "Yeoh c2/mu 0.2": (Yeoh(1.0, 0.2), lambda s: (1 + 0.8 * (s * s + 2 / s - 3)) * (1 / s**2 - s)),
    "Ogden alpha 6": (Ogden([1 / 3], [6.0]), lambda s: (s**-4 - s**5) / 3),
    "Ogden two terms": (
        Ogden([0.6, -0.4], [2.0, -2.0]),
        lambda s: 0.6 * (s**-2 - s) - 0.4 * (s**0.0 - s**-3),
    ),
    "Ogden three terms": (
        Ogden([0.3, 0.2, -0.2], [1.0, 5.0, -2.0]),
        lambda s: 0.3 * (s**-1.5 - 1) + 0.2 * (s**-3.5 - s**4) - 0.2 * (1 - s**-3),
    ),
}


def uniform_compression() -> Iterator[Check]:
    """Patch test: every law, half of the height."""
    for name, (law, stress) in LAWS.items():
        path = compress(UnitPuck(1.3, "frictionless"), law, np.array([0.5]), corner=0.2)
        expected = np.pi * 1.3**2 * float(stress(np.array(0.5)))
        yield Check(
            "Uniform compression (patch test)",
            f"{name}, force at 50 %",
            expected,
            float(path.force[0]),
            5e-5,
            "uniaxial closed form",
        )


def bonded_pucks() -> Iterator[Check]:
    """Apparent modulus of discs between bonded plates."""
    published = {0.1: 1.070, 0.25: 1.196, 0.417: 1.404, 1.0: 2.956, 2.0: 8.76}
    for shape, apparent in published.items():
        radius = 2.0 * shape
        problem = puck_problem(UnitPuck(radius, "bonded"), NEO, corner=0.004 * min(radius, 1.0))
        value = problem.stiffness() / 2.0 / (3.0 * np.pi * radius**2)
        name = f"E_app / E at shape factor {shape:g}"
        yield Check("Bonded pucks", name, apparent, value, 2e-3, "an independent finite-element code")


def layer_solution() -> Iterator[Check]:
    """Small depth, frictionless punch on a bonded base."""
    for poisson, row in LAYER.items():
        for ratio, kappa in row.items():
            slab = Case(ratio, ratio + 12.0, "bonded", "frictionless", poisson=poisson)
            value = first_stiffness(slab) * 3.0 * (1 - poisson**2) / (4.0 * (1 + poisson))
            yield Check("Small depth", f"kappa, bonded base, a/h {ratio:g}, nu {poisson:g}", kappa, value, 1e-3, HAYES)
    for ratio, kappa in {0.2: 1.171, 0.4: 1.385, 1.0: 2.199}.items():
        slab = Case(ratio, ratio + 40.0, "sliding", "frictionless")
        value = first_stiffness(slab) * 3.0 * 0.75 / 6.0
        yield Check("Small depth", f"kappa, sliding base, a/h {ratio:g}", kappa, value, 2e-3, HAYES)


def limits() -> Iterator[Check]:
    """Half space and lubrication, each extrapolated from two ratios."""
    thin, thinner = (first_stiffness(Case(a, 40.0, "bonded", "frictionless")) for a in (0.1, 0.05))
    yield Check("Limits", "thick pad, F / (E a d)", 2 / 0.75, 2 * thinner - thin, 2e-2, "2 a E d / (1 - nu^2)")
    values = []
    for ratio in (6.0, 12.0):
        values.append(first_stiffness(Case(ratio, ratio + 8.0)) * 3.0 * ratio / (1.5 * np.pi * ratio**4))
    source = "confined layer, F = (3 pi / 2) mu a^4 d / h^3; the edge adds a share of order h / a"
    yield Check("Limits", "thin pad, glued punch, over the limit", 1.0, 2 * values[1] - values[0], 6e-2, source)


def orders() -> Iterator[Check]:
    """Rates on an exact smooth solution of the incompressible equations (Bessel functions)."""
    errors = np.array([smooth_errors(cells) for cells in (4, 8, 16)])
    rates = np.log2(errors[1] / errors[2])
    expected = {"displacement (L2)": 3.0, "pressure (L2)": 2.0, "energy, and so force": 4.0}
    for (name, rate), value in zip(expected.items(), rates):
        yield Check(
            "Convergence orders",
            name,
            rate,
            float(value),
            0.2,
            "biquadratic displacement, linear pressure",
            absolute=True,
            one_sided=True,
        )


def smooth_errors(cells: int) -> tuple[float, float, float]:
    """Errors of displacement, pressure and energy for boundary values of an exact solution on a unit cylinder.

    u_r = -J1(kr) (1 + kz) e^kz, u_z = k z J0(kr) e^kz, p = -2 mu k J0(kr) e^kz solve mu lap u + grad p = 0,
    div u = 0 (stream function r J1(kr) z e^kz).
    """
    from scipy.special import j0, j1

    k = 2.5
    grid = np.linspace(0.0, 1.0, cells + 1)
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, -1)
    points = np.array([(r, z - 1.0) for r in grid for z in grid]).T
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]).reshape(4, -1)
    mesh = meshes.discretise(points, quads)
    solid = Solid(mesh, NEO)
    r, z = mesh.nodes
    exact = np.stack([-j1(k * r) * (1 + k * z) * np.exp(k * z), k * z * j0(k * r) * np.exp(k * z)], axis=1).ravel()
    fixed = np.zeros(mesh.size, dtype=bool)
    edge = (r > 1 - 1e-9) | (np.abs(z) < 1e-9) | (z < -1 + 1e-9)
    fixed[2 * np.nonzero(edge)[0]] = fixed[2 * np.nonzero(edge)[0] + 1] = True
    fixed[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    zero = np.zeros(mesh.size), np.zeros((len(mesh.weight), 3))
    state = solid.state(*zero)
    tangent = solid.linearise(state)
    lift = np.where(fixed, exact, 0.0)
    pull = (tangent.stiffness @ lift[mesh.dofs][:, :, None])[:, :, 0]
    load = -np.bincount(mesh.dofs.ravel(), pull.ravel(), minlength=mesh.size)
    u = lift + Pattern([mesh.dofs], np.nonzero(~fixed)[0], mesh.size).solve([tangent.stiffness], load)
    p = solid.pressure_step(tangent, state, u) @ mesh.pressure_basis.T
    work = 0.5 * float(
        u @ np.bincount(mesh.dofs.ravel(), (tangent.stiffness @ u[mesh.dofs][:, :, None]).ravel(), minlength=mesh.size)
    )
    # The quadrature points from the isoparametric values: r from u_r / r, which is linear in the nodes.
    at_r = (mesh.gradient[:, :, 4, 0::2] @ np.ones((9, 1)))[..., 0] ** -1
    shape = mesh.gradient[:, :, 4, 0::2] * at_r[..., None]
    node = mesh.dofs[:, 0::2] // 2
    at_z = np.einsum("eqi,ei->eq", shape, z[node])
    true = np.stack(
        [-j1(k * at_r) * (1 + k * at_z) * np.exp(k * at_z), k * at_z * j0(k * at_r) * np.exp(k * at_z)], axis=-1
    )
    near = np.einsum("eqi,eic->eqc", shape, u.reshape(-1, 2)[node])
    displacement = np.sqrt(np.sum(mesh.weight * np.sum((near - true) ** 2, axis=-1)))
    pressure = -2.0 * k * j0(k * at_r) * np.exp(k * at_z)
    off = p - pressure
    off -= np.sum(mesh.weight * off) / np.sum(mesh.weight)
    return displacement, float(np.sqrt(np.sum(mesh.weight * off**2))), abs(work - _smooth_energy(k))


def _smooth_energy(k: float) -> float:
    """Integral of mu e : e of the exact solution, by Gauss quadrature of high order."""
    from scipy.special import j0, j1

    x, w = np.polynomial.legendre.leggauss(40)
    r, z = np.meshgrid(0.5 * (x + 1.0), 0.5 * (x - 1.0), indexing="ij")
    weight = 0.25 * np.outer(w, w) * 2.0 * np.pi * r
    e = np.exp(k * z)
    slope = k * (j0(k * r) - j1(k * r) / (k * r))
    rr, tt = -slope * (1 + k * z) * e, -j1(k * r) / r * (1 + k * z) * e
    zz = k * j0(k * r) * (1 + k * z) * e
    rz = 0.5 * (-j1(k * r) * k * (2 + k * z) * e - k * k * z * j1(k * r) * e)
    return float(np.sum(weight * (rr**2 + tt**2 + zz**2 + 2.0 * rz**2)))


def newton() -> Iterator[Check]:
    """Order of the last steps of Newton's method, with contact."""
    problem = puck_problem(UnitPuck(1.0, "bonded"), Ogden([0.4], [5.0]), corner=0.05)
    start = (0.1 * part for part in problem.direction())
    found = newton_search(problem, *start, 0.1, RESIDUAL_TOLERANCE, without_ties=False, most_held=1)
    assert isinstance(found, Equilibrium)
    last = [residual for residual in found.residuals if residual > 1e-13]
    rates = [np.log(c / b) / np.log(b / a) for a, b, c in zip(last, last[1:], last[2:])]
    yield Check(
        "Convergence orders",
        "Newton's method",
        2.0,
        float(max(rates)),
        0.3,
        "exact tangent",
        absolute=True,
        one_sided=True,
    )


def relaxation() -> Iterator[Check]:
    """Finite-strain relaxation in a hold, and its linear limit."""
    hold = np.array([0.02, 0.2, 2.0])
    time, depth = np.r_[0.0, 1e-7, hold], np.r_[0.0, np.full(4, 0.2)]
    problem = puck_problem(UnitPuck(1.0, "frictionless"), Viscoelastic(NEO, ARMS), corner=0.3)
    path = follow_motion(problem, time, depth, 0.05)
    kernel = 1.0 + sum(a.beta * np.exp(-hold / a.tau_s) for a in ARMS)
    for t, force, expected in zip(hold, path.force[2:], np.pi * (1 / 0.36 - 0.6) * kernel):
        name = f"hold at 40 % compression, force at {t:g} s"
        yield Check("Relaxation", name, float(expected), float(force), 3e-4, "elastic stress times the kernel")
    time = np.r_[np.linspace(0.0, 0.1, 6), 1.0]
    small = 1e-5 * np.minimum(time / 0.1, 1.0)
    bonded = UnitPuck(1.0, "bonded")
    path = follow_motion(puck_problem(bonded, Viscoelastic(NEO, ARMS)), time, small, 1.0)
    expected = relaxed_force(time, puck_problem(bonded, NEO).stiffness() * small, ARMS)
    yield Check(
        "Relaxation",
        "small press of a bonded puck, force at its stop",
        1.0,
        float(path.force[5] / expected[5]),
        2e-4,
        "linear viscoelasticity: the separable convolution",
    )


def _force(slab: Case, depth: float, rim: float, resolution: Resolution | None = None) -> float:
    """Force at one relative depth with one fillet (over scale), by even steps on the way; nan if not reached."""
    way = np.linspace(0.0, depth, 9)[1:]
    problem = rimmed_problem(slab, rim * slab.scale, resolution or Resolution())
    # Small steps are wanted here; a curve gives a fillet up sooner.
    path = follow(problem, way, rim * slab.scale, 0.05 * slab.scale, 0.005 * slab.scale)
    return float(path.force[-1]) if len(path.force) == len(way) else float("nan")


def independence() -> Iterator[Check]:
    """Mesh, extent and units at finite depth."""
    slab = Case(1.0, 9.58)
    meshing = Resolution(), Resolution(2 * Resolution.cells, Resolution.growth**0.5)
    coarse, fine = (_force(slab, 0.2, 0.05, resolution) for resolution in meshing)
    yield Check("Independence", "cells, against half the cells, rim 0.05, d/h 0.2", fine, coarse, 3e-3, "finer mesh")
    wide, narrow = (_force(Case(0.395, extent), 0.2, 0.05) for extent in (3.785, 3.0))
    yield Check(
        "Independence",
        "60 mm instead of 75.7 mm outer radius, 20 mm pad, d/h 0.2",
        0.996,
        narrow / wide,
        2e-3,
        "an independent finite-element code: 0.3 to 0.5 % softer",
    )
    one = solve_curve(Pad(10.0, 0.025, 7.9), [1.0, 2.0]).force_N[-1]
    si = solve_curve(Pad(0.01, 0.025e6, 0.0079, extent_mm=0.0756940), [0.001, 0.002]).force_N[-1]
    yield Check("Independence", "mm and MPa, or m and Pa", float(one), float(si), 1e-4, "units")


def tables() -> Iterator[Check]:
    """The shipped response table against solves made now, and published ratios."""
    from dummydesign.pad.tables.slab import load_table

    radius = PUNCH_RADIUS_MM
    for thickness in (5.0, 10.0, 15.0, 20.0):
        depth = 0.3 * thickness
        curve = solve_curve(Pad(thickness, 0.025, radius), [0.5 * depth, depth], independent=True)
        solved, error = float(curve.force_N[-1]), float(curve.solved_error_N[-1] / curve.force_N[-1])
        table = float(load_table().force(depth, thickness, 0.025, radius))
        stated = error + float(np.squeeze(load_table().solved_error(depth, thickness, radius)))
        source = "solved now; the tolerance is the sum of the errors that both state"
        yield Check("Table", f"{thickness:g} mm at d/h 0.3, N at 25 kPa", solved, table, round(stated, 4), source)
    for thickness, share in ((5.0, 0.420), (15.0, 0.716), (20.0, 0.779)):
        args = (0.3 * thickness, thickness, 0.025, radius)
        tables = [load_table(base) for base in ("sliding", "bonded")]
        value = float(tables[0].force(*args) / tables[1].force(*args))
        stated = share * sum(float(np.squeeze(table.relative_error(args[0], thickness, radius))) for table in tables)
        source = "an independent finite-element code; the tolerance is 0.012 or the errors that both state"
        name = f"sliding over bonded base, {thickness:g} mm, d/h 0.3"
        yield Check("Table", name, share, value, max(0.012, round(stated, 4)), source, absolute=True)


def laws_on_a_pad() -> Iterator[Check]:
    """Strain stiffening on a glued slab."""
    for thickness, weak, strong in ((5.0, 1.23, 1.84), (15.0, 1.11, 1.37)):
        ratio = 7.9 / thickness
        slab = Case(ratio, 75.7 / thickness)
        base = _force(slab, 0.3, 0.05)
        for c2, factor in ((0.05, weak), (0.2, strong)):
            force = _force(replace(slab, law=Yeoh(1.0, c2)), 0.3, 0.05)
            yield Check(
                "Laws on a slab",
                f"Yeoh c2/mu {c2:g} over neo-Hookean, {thickness:g} mm, d/h 0.3",
                factor,
                force / base,
                2e-2,
                "an independent finite-element code",
            )


ALL: tuple[tuple[bool, Callable[[], Iterator[Check]]], ...] = (
    (True, uniform_compression),
    (True, bonded_pucks),
    (False, layer_solution),
    (False, limits),
    (True, orders),
    (True, newton),
    (True, relaxation),
    (False, laws_on_a_pad),
    (False, independence),
    (False, tables),
    (False, cap_on_layer),
    (False, slab_limits),
    *((False, check) for check in (*edges.CHECKS, *contact.CHECKS, *first_touch.CHECKS)),
)
