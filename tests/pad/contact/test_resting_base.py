"""A pad that rests on a plate with friction: between its limits, in equilibrium, lifting off beside the punch."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.interface import BASES, Interface
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.filleted import filleted_problem, follow_filleted
from dummydesign.pad.axisymmetric.profile_punch import Region, indentation_problem
from dummydesign.pad.axisymmetric.shaped_pad import solve_flat
from dummydesign.pad.contact.axisymmetric import FlatPunch
from dummydesign.pad.contact.friction import RestingBase, weight_over_shear
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)
DEPTHS = np.array([0.1, 0.3])
HEAVY, LIGHT = 10.0, 0.01


def press_slab(base, weight, ratio=0.8, depths=DEPTHS):
    """Path of a sticking punch with a bead of a tenth of its radius, and its problem."""
    punch = FlatPunch(ratio, 0.1 * ratio)
    region = Region(0.7 * ratio, 1.2 * ratio, punch.rim / 1.5)
    problem = indentation_problem(punch, region, Case(ratio, 7.0, base, weight=weight))
    path = follow(problem, depths, 0.1 * punch.rim, 0.05 * ratio, 0.002)
    assert path.stop is None
    return path, problem


@pytest.fixture(scope="module")
def glued():
    return press_slab("bonded", 0.0)[0].force


@pytest.fixture(scope="module")
def sliding():
    return press_slab("sliding", 0.0)[0].force


def test_forces_of_the_base_have_an_exact_tangent():
    rng = np.random.default_rng(3)
    r = np.linspace(0.0, 2.0, 4)
    number = np.arange(8).reshape(4, 2)
    points = np.array([(x, z) for x in r for z in (0.0, -1.0)]).T
    quads = np.stack([number[:-1, 1], number[1:, 1], number[1:, 0], number[:-1, 0]])
    mesh = meshes.discretise(points, quads)
    base = RestingBase(mesh, meshes.edges_on(mesh, meshes.on_base(mesh, 1.0)), 1.0, 0.4, 0.05)
    u = 1e-5 * rng.standard_normal(mesh.size)
    force, matrix = base.forces(u, None, 0.05)
    whole = np.zeros((mesh.size, mesh.size))
    for side, block in zip(base.dofs, matrix):
        whole[np.ix_(side, side)] += block
    for k in np.unique(base.dofs):
        step = np.zeros(mesh.size)
        step[k] = 1e-10
        up, down = (base.forces(u + sign * step, None, 0.05)[0] for sign in (1.0, -1.0))
        assert whole[:, k] == pytest.approx((up - down) / 2e-10, rel=1e-4, abs=1e-3 * np.abs(whole).max())
    assert np.abs(force).max() > 0.01


def test_a_pad_at_rest_is_in_equilibrium_with_its_weight():
    region = Region(0.5, 0.9, 0.1)
    problem = indentation_problem(
        FlatPunch(0.8, 0.1), region, Case(0.8, 5.0, "friction:0.3", "frictionless", weight=LIGHT)
    )
    force, _ = problem.surface.forces(np.zeros(problem.solid.mesh.size), problem.punch, 0.0)
    assert np.abs(force).max() < 1e-12


def test_a_heavy_pad_without_friction_slides_and_does_not_lift(sliding):
    assert press_slab("friction:0", HEAVY)[0].force == pytest.approx(sliding, rel=1e-3)


def test_a_heavy_pad_with_friction_sticks(glued):
    assert press_slab("friction:1", HEAVY)[0].force == pytest.approx(glued, rel=1e-3)


def press_filleted(base="bonded", weight=0.0, depths=(0.02, 0.2), ratio=0.8):
    """Path of a glued face that moves with the punch node by node, with a fillet of a tenth of the radius."""
    problem = filleted_problem(Case(ratio, 7.0, base, edge=0.1 * ratio, weight=weight), sides=False)
    return follow_filleted(problem, np.array(depths))


@pytest.mark.parametrize(("base", "friction"), [("sliding", 0.0), ("bonded", 1.0)])
def test_a_heavy_pad_under_a_fillet_slides_without_friction_and_sticks_with_it(base, friction):
    held = press_filleted(base).force
    assert press_filleted(f"friction:{friction:g}", HEAVY).force == pytest.approx(held, rel=2e-3)


@pytest.mark.slow
def test_a_thin_pad_on_much_friction_is_pressed_to_two_fifths():
    path = press_filleted("friction:1", weight_over_shear(5.0, 0.025 / 3.0), (0.1, 0.2, 0.4), 7.9 / 5.0)
    assert path.stop is None and np.all(np.diff(path.force) > 0.0)


@pytest.mark.slow
def test_the_force_grows_with_friction_between_sliding_and_sticking(glued):
    forces = np.array([press_slab(f"friction:{mu:g}", LIGHT)[0].force for mu in (0.0, 0.1, 0.3, 1.0)])
    assert np.all(np.diff(forces, axis=0) > 0.0)
    assert np.all(forces[-1] < glued)
    assert np.all(forces[-1] > 0.9 * glued)


def test_a_light_pad_lifts_off_beside_the_punch_and_is_softer_for_it(sliding):
    path, problem = press_slab("friction:0", 0.001)
    assert np.all(path.force < sliding)
    assert path.force[-1] < 0.98 * sliding[-1]
    assert problem.surface.dofs.shape[1] == 6


def test_the_base_pushes_back_as_hard_as_the_punch_pushes_and_friction_pulls_inwards():
    """Equilibrium at finite depth; the pad spreads, so the plate drags it towards the axis."""
    punch = FlatPunch(0.8, 0.08)
    region = Region(0.56, 0.96, punch.rim / 1.5)
    problem = indentation_problem(punch, region, Case(0.8, 7.0, "friction:0.3", weight=LIGHT))
    states = []
    problem.force = lambda state: states.append(state) or float(state.internal_force[problem.base].sum())
    path = follow(problem, [0.1, 0.2], 0.008, 0.04, 0.002)
    internal = states[-1].internal_force.reshape(-1, 2)
    base = np.zeros(len(internal), dtype=bool)
    base[problem.base // 2] = True
    assert path.force[-1] == pytest.approx(-internal[~base, 1].sum(), rel=1e-5)
    drag = -internal[base, 0].sum()
    whole = path.force[-1] + LIGHT * np.pi * 7.0**2
    assert 0.0 < drag < 0.3 * whole


@pytest.mark.slow
def test_a_curve_on_a_rough_base_lies_between_its_limits_and_states_a_small_error():
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve

    rough = solve_flat(Pad(10.0, 0.025, 7.9, base="friction:0.3"), [1.0, 2.0])
    low, high = (solve_curve(Pad(10.0, 0.025, 7.9, base=base), [1.0, 2.0]) for base in ("sliding", "bonded"))
    assert np.all((low.force_N < rough.force_N) & (rough.force_N < high.force_N))
    assert np.all(rough.error_N < 0.015 * rough.force_N)
    assert rough.solver["newton_iterations"] > high.solver["newton_iterations"]


def test_the_weight_of_a_pad_is_rho_g_h():
    """10 mm of 1030 kg/m3 press with 101 Pa."""
    assert weight_over_shear(10.0, 1e-3) == pytest.approx(101.04e-6 / 1e-3, rel=1e-3)


@pytest.mark.parametrize("text", ["friction", "friction:x", "friction:-0.1", "friction:6", "glue", "friction:nan"])
def test_bases_that_are_none_are_refused(text):
    with raises_code("unknown_name", "base"):
        Interface.parse(text, "base", BASES)
