"""Finite-strain relaxation: tangents, closed forms, the linear limit, order in time, no relaxation without arms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from dummydesign.pad.axisymmetric.finite_strain import follow_motion
from dummydesign.pad.axisymmetric.puck import UnitPuck, puck_problem
from dummydesign.pad.material.hyperelastic import Axisymmetric, Ogden, Spatial, Yeoh
from dummydesign.pad.material.relaxation import Isochoric, PronyTerm, Viscoelastic, relaxed_force
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import ContactProblem
from tests.support.energies import energy
from tests.support.refusal import raises_code

ARMS = (PronyTerm(0.05, 0.6), PronyTerm(1.0, 0.3))
LAWS = [Yeoh(0.7), Yeoh(0.7, 0.2), Ogden([0.3], [3.0])]


def random_F(components, spread=0.2, count=6, seed=1):
    rng = np.random.default_rng(seed)
    kinematics = Axisymmetric if components == 5 else Spatial
    F = kinematics.identity + spread * rng.standard_normal((count, components))
    assert np.all(kinematics.determinant(F) > 0.1)
    return F


def with_history(law, components):
    material = Viscoelastic(law, ARMS)
    for seed in (11, 12):
        material.begin(0.03)
        material.commit(random_F(components, seed=seed))
    material.begin(0.02)
    return material


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("components", [5, 9])
def test_stress_and_tangent_are_the_derivatives_of_the_step_energy_with_history(law, components):
    material, F, step = with_history(law, components), random_F(components), 1e-6
    for k in range(components):
        up, down = F.copy(), F.copy()
        up[:, k] += step
        down[:, k] -= step
        slope = (energy(material, up) - energy(material, down)) / (2 * step)
        assert material.stress(F)[:, k] == pytest.approx(slope, rel=1e-7, abs=1e-8)
        numeric = (material.stress(up) - material.stress(down)) / (2 * step)
        assert material.tangent(F)[:, :, k] == pytest.approx(numeric, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("law", LAWS)
def test_the_isochoric_stress_sees_no_volume_change_and_has_no_mean_stress(law):
    F = random_F(9)
    part = Isochoric(law)
    assert energy(part, 1.3 * F) == pytest.approx(energy(part, F), rel=1e-12)
    assert np.einsum("ec,ec->e", part.stress(F), F) == pytest.approx(0.0, abs=1e-12)


def test_the_history_turns_with_the_body():
    """A rotation after loading turns the stress and changes nothing else: Q lives in the reference frame."""
    rng = np.random.default_rng(4)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    F = random_F(9)
    material = with_history(Yeoh(0.7, 0.2), 9)
    turned = (turn @ F.reshape(-1, 3, 3)).reshape(-1, 9)
    expected = (turn @ material.stress(F).reshape(-1, 3, 3)).reshape(-1, 9)
    assert material.stress(turned) == pytest.approx(expected, abs=1e-12)
    assert energy(material, turned) == pytest.approx(energy(material, F), rel=1e-12)


def test_without_strength_the_stress_and_tangent_are_those_of_the_law_to_the_last_bit():
    law, F = Yeoh(0.7, 0.2), random_F(5)
    for prony in ((), (PronyTerm(0.1, 0.0), PronyTerm(2.0, 0.0))):
        material = Viscoelastic(law, prony)
        material.begin(0.1)
        material.commit(F)
        material.begin(0.1)
        assert np.array_equal(material.stress(F), law.stress(F))
        assert np.array_equal(material.tangent(F), law.tangent(F))


def puck(law, prony):
    return puck_problem(UnitPuck(1.0, "frictionless"), Viscoelastic(law, prony), corner=0.3)


def test_a_uniform_puck_in_a_hold_relaxes_as_the_closed_form_says():
    """Sudden compression to stretch l: axial nominal stress (l - l^-2) (1 + sum beta e^(-t / tau)) mu.

    In a hold F does not change, so the second Piola convolution is the elastic stress times the kernel.
    """
    depth, hold = 0.2, np.geomspace(0.01, 5.0, 12)
    time = np.r_[0.0, 1e-7, 1e-7 + hold]
    path = follow_motion(puck(Yeoh(1.0), ARMS), time, np.r_[0.0, np.full(13, depth)], 0.05)
    stretch = 1.0 - 2.0 * depth
    kernel = 1.0 + sum(a.beta * np.exp(-hold / a.tau_s) for a in ARMS)
    assert path.stop is None
    assert path.force[2:] == pytest.approx(np.pi * (1 / stretch**2 - stretch) * kernel, rel=3e-4)


def uniaxial_ramp(rate, end, prony):
    """Nominal stress at the end of a uniaxial ramp of a neo-Hookean solid, by quadrature of the convolution.

    S_iso is J^(-2/3) mu Dev(1): axial 2/3 (1 - l^-3) mu, lateral -1/3 (l^3 - 1) mu in C^-1 measure; with
    the pressure that frees the side, P = l (S_a - S_l / l^3) for every arm.
    """
    stretch = lambda t: 1.0 - rate * t  # noqa: E731
    axial_rate = lambda s: (2.0 / 3.0) * 3.0 * stretch(s) ** -4 * -rate  # noqa: E731
    lateral_rate = lambda s: -(1.0 / 3.0) * 3.0 * stretch(s) ** 2 * -rate  # noqa: E731
    last = stretch(end)
    total = last - last**-2
    for arm in prony:
        axial, lateral = (
            quad(lambda s: arm.beta * np.exp(-(end - s) / arm.tau_s) * slope(s), 0.0, end, epsabs=1e-12)[0]  # noqa: B023
            for slope in (axial_rate, lateral_rate)
        )
        total += last * (axial - lateral / last**3)
    return -total


def test_a_uniform_ramp_agrees_with_the_convolution_integral_and_converges_in_second_order():
    rate, end = 2.0, 0.2
    exact = np.pi * uniaxial_ramp(rate, end, ARMS)
    errors = []
    for steps in (4, 8, 16):
        time = np.linspace(0.0, end, steps + 1)
        path = follow_motion(puck(Yeoh(1.0), ARMS), time, 0.5 * rate * time, 1.0)
        errors.append(abs(path.force[-1] / exact - 1.0))
    assert errors[-1] < 2e-3
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders == pytest.approx(2.0, abs=0.25)


def small_press(corner):
    """Relative difference of a small press of a bonded puck to the separable convolution, at each time."""
    time = np.r_[np.linspace(0.0, 0.1, 6), 0.15, 0.4, 2.0]
    depth = 1e-5 * np.minimum(time / 0.1, 1.0)
    bonded = UnitPuck(1.0, "bonded")
    path = follow_motion(puck_problem(bonded, Viscoelastic(Yeoh(1.0), ARMS), corner=corner), time, depth, 1.0)
    elastic = puck_problem(bonded, Yeoh(1.0), corner=corner).stiffness() * depth
    return np.abs(path.force[1:] / relaxed_force(time, elastic, ARMS)[1:] - 1.0)


def test_small_strain_is_the_separable_convolution_also_where_strain_is_not_uniform():
    """Exactly so as the mesh is refined: the corner of a coarse mesh keeps its volume in the mean only."""
    coarse, fine = small_press(0.1).max(), small_press(0.01).max()
    assert fine < 2e-4
    assert fine < coarse / 8.0


def test_at_large_strain_the_elements_follow_the_integral_and_not_the_separable_convolution():
    """The reason for this model: history in the second Piola stress is not separable in force while it moves."""
    time = np.linspace(0.0, 0.2, 49)
    separable = relaxed_force(time, np.array([np.pi * uniaxial_ramp(2.0, t, ()) for t in time]), ARMS)[-1]
    exact = np.pi * uniaxial_ramp(2.0, 0.2, ARMS)
    found = follow_motion(puck(Yeoh(1.0), ARMS), time, time, 1.0).force[-1]
    assert abs(separable / exact - 1.0) > 4e-3
    assert abs(found / exact - 1.0) < 0.1 * abs(separable / exact - 1.0)


def test_without_arms_a_motion_gives_the_elastic_forces_to_rounding():
    depths = np.array([0.05, 0.1, 0.15])
    elastic = puck_problem(UnitPuck(1.0, "bonded"), Yeoh(1.0), corner=0.1)
    plain = follow(elastic, depths, 0.05, 0.05, 0.01)
    silent = Viscoelastic(Yeoh(1.0), (PronyTerm(0.1, 0.0),))
    problem = puck_problem(UnitPuck(1.0, "bonded"), silent, corner=0.1)
    path = follow_motion(problem, np.r_[0.0, 1.0, 2.0, 3.0], np.r_[0.0, depths], 0.05)
    np.testing.assert_allclose(path.force[1:], plain.force, rtol=1e-12)


def test_a_time_step_of_zero_is_refused():
    with raises_code("out_of_range", "time_step_s"):
        Viscoelastic(Yeoh(1.0), ARMS).begin(0.0)


def test_a_motion_that_cannot_be_followed_says_where_it_stopped():
    problem: ContactProblem = puck_problem(UnitPuck(1.0, "bonded"), Viscoelastic(Yeoh(1.0), ARMS), corner=0.3)
    path = follow_motion(problem, np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.2, 0.499]), 0.1)
    assert path.stop is not None and "stopped at relative depth" in path.stop
    assert len(path.force) == 2


def test_a_motion_ends_before_the_first_state_that_is_refused_and_says_when():
    problem: ContactProblem = puck_problem(UnitPuck(1.0, "bonded"), Viscoelastic(Yeoh(1.0), ARMS), corner=0.3)
    seen = []

    def look(depth, u):
        seen.append(depth)
        return "met itself" if depth > 0.12 else None

    path = follow_motion(problem, np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.1, 0.2]), 0.05, check=look)
    assert path.stop == "met itself; at 1.5 s"
    assert seen == pytest.approx([0.05, 0.1, 0.15]) and len(path.force) == 2
