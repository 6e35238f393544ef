"""A free mass that a pad stops: energy, closed forms, another integration, the order of the rule, pads that bottom."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import dummydesign
from dummydesign.core.errors import NoAnswerError
from dummydesign.pad.force_law import NO_COST, ForceCurve
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.person.free_mass import PadBody, mass_on_pad, stop_mass, work_over
from dummydesign.person.integrate import run_robot
from dummydesign.person.smoothing import RobotArm
from tests.support.refusal import raises_code

RADIUS = 14.0 / np.sqrt(np.pi)


def curve(force, limit_mm=30.0):
    """A long-term force in closed form."""
    return ForceCurve(force, np.zeros_like, limit_mm, dict(NO_COST))


def stopped(law, mass_kg, velocity, prony=(), **more):
    return stop_mass(PadBody(law, prony), mass_kg, np.array([velocity]), **more)


@pytest.mark.parametrize("mass_kg, velocity, stiffness", [(0.05, 600.0, 80.0), (2.0, 30.0, 4.0), (40.0, 5.0, 9.0)])
def test_a_spring_stops_a_mass_after_a_quarter_of_its_period_with_v_root_k_m(mass_kg, velocity, stiffness):
    found = stopped(curve(lambda x: stiffness * x), mass_kg, velocity)
    mass = 1e-3 * mass_kg
    assert found.peak_N[0] == pytest.approx(velocity * np.sqrt(stiffness * mass), rel=1e-4)
    assert found.depth_mm[0] == pytest.approx(velocity * np.sqrt(mass / stiffness), rel=1e-4)
    assert found.stop_s[0] == pytest.approx(0.5 * np.pi * np.sqrt(mass / stiffness), rel=1e-4)
    # as long again for the rebound: it leaves where it came from
    assert abs(found.depth_curve_mm[0, -1]) < 1e-3 * found.depth_mm[0]


def test_a_ball_on_a_half_space_stops_as_hertz_says():
    """F = K x^1.5; x = (5 m v^2 / 4 K)^0.4, and the way in takes 1.4716 x / v."""
    factor = 16.0 / 9.0 * 0.03 * np.sqrt(20.0)
    found = stopped(curve(lambda x: factor * np.maximum(x, 0.0) ** 1.5), 0.3, 200.0)
    depth = (1.25 * 0.3e-3 * 200.0**2 / factor) ** 0.4
    way_in = quad(lambda s: 2.0 / 5.0 * s ** (-0.6) / np.sqrt(1.0 - s), 0.0, 1.0)[0]
    assert way_in == pytest.approx(1.4716, rel=1e-4)
    assert found.depth_mm[0] == pytest.approx(depth, rel=2e-4)
    assert found.peak_N[0] == pytest.approx(factor * depth**1.5, rel=3e-4)
    assert found.stop_s[0] == pytest.approx(way_in * depth / 200.0, rel=1e-3)


def drawn(count, seed):
    """Pads, masses and speeds that a pad can stop: 0.15 to 0.45 of the thickness deep at rest."""
    rng, cases = np.random.default_rng(seed), []
    while len(cases) < count:
        thickness, young = rng.uniform(5.0, 20.0), 1e-3 * rng.uniform(10.0, 120.0)
        pad = Pad(thickness, young, RADIUS)
        law = elastic_curve(pad, "table")
        depth = rng.uniform(0.15, 0.45) * thickness
        if depth > 0.9 * law.limit_mm:
            continue
        velocity = float(np.exp(rng.uniform(np.log(10.0), np.log(600.0))))
        energy = quad(lambda x, law=law: float(law.force(np.array([x]))[0]), 0.0, depth)[0]
        cases.append((pad, law, 2e3 * energy / velocity**2, velocity, depth))
    return cases


@pytest.mark.parametrize("pad, law, mass_kg, velocity, depth", drawn(6, 58))
def test_an_elastic_pad_stops_a_mass_where_the_work_of_its_force_is_the_energy(pad, law, mass_kg, velocity, depth):
    found = mass_on_pad(pad, mass_kg, velocity)
    assert found.depth_mm == pytest.approx(depth, rel=1e-4)
    assert found.energy_mJ == pytest.approx(0.5e-3 * mass_kg * velocity**2, rel=1e-4)
    assert found.prediction.peak_force_N == pytest.approx(float(law.force(np.array([depth]))[0]), rel=1e-3)
    assert found.depth_at_peak_mm == pytest.approx(depth, rel=1e-4)


@pytest.mark.parametrize("seed", range(5))
def test_a_relaxing_pad_stops_a_mass_as_its_inner_states_say(seed):
    """M x'' = -(A(x) + sum beta q), q' = A'(x) x' - q / tau, by another integrator."""
    ((pad, law, mass_kg, velocity, _),) = drawn(1, 100 + seed)
    rng = np.random.default_rng(seed)
    prony = tuple(PronyTerm(10.0 ** rng.uniform(-3.5, 1.0), rng.uniform(0.1, 1.2)) for _ in range(3))
    tau, beta = (np.array([getattr(term, name) for term in prony]) for name in ("tau_s", "beta"))

    def at(x):
        return float(law.force(np.array([max(x, 0.0)]))[0])

    def rates(time, state):
        x, v, *q = state
        slope = (at(x + 1e-5) - at(x - 1e-5)) / 2e-5
        return [v, -(at(x) + beta @ q) / (1e-3 * mass_kg), *(slope * v - np.array(q) / tau)]

    def halt(time, state):
        return state[1]

    halt.terminal, halt.direction = True, -1
    start = [0.0, velocity, *np.zeros(len(prony))]
    wanted = solve_ivp(rates, (0.0, 5.0), start, "LSODA", events=halt, rtol=1e-8, atol=1e-10)
    force = np.array([at(x) for x in wanted.y[0]]) + beta @ wanted.y[2:]
    found = mass_on_pad(Pad(pad.thickness_mm, pad.young_MPa, RADIUS, prony), mass_kg, velocity)
    assert found.depth_mm == pytest.approx(wanted.y_events[0][0][0], rel=3e-4)
    assert found.stop_s == pytest.approx(wanted.t_events[0][0], rel=1e-3)
    assert found.prediction.peak_force_N == pytest.approx(force.max(), rel=1e-3)
    assert found.depth_at_peak_mm <= found.depth_mm


def test_the_rule_converges_with_the_square_of_the_step():
    body = PadBody(curve(lambda x: 3.0 * x + x**3), (PronyTerm(0.01, 0.8), PronyTerm(0.3, 0.4)))

    def depth(steps):
        step, scale = 0.03 / steps, np.array([5.0])
        given = RobotArm(0.0, 1.0), lambda t: (0.0, 0.0), 1.0, np.array([200.0]), scale, lambda t: step
        return run_robot(body, *given, until_stop=True, keep=False, tolerance=1e6).depth_mm[0]

    coarse, middle, fine = (depth(steps) for steps in (200, 400, 800))
    assert 3.0 < (coarse - middle) / (middle - fine) < 5.5
    assert stop_mass(body, 1.0, np.array([200.0])).depth_mm[0] == pytest.approx(fine, rel=1e-4)


def test_a_pad_bottoms_out_beyond_the_energy_that_it_takes_and_not_before():
    pad = Pad(9.0, 0.04, RADIUS)
    law = elastic_curve(pad, "table")
    most = quad(lambda x: float(law.force(np.array([x]))[0]), 0.0, law.limit_mm)[0]
    just = mass_on_pad(pad, 0.998 * 2e3 * most / 150.0**2, 150.0)
    assert 0.99 * law.limit_mm < just.depth_mm <= law.limit_mm
    for times in (1.002, 10.0, 1e4):
        with pytest.raises(NoAnswerError) as refused:
            mass_on_pad(pad, times * 2e3 * most / 150.0**2, 150.0)
        assert refused.value.code == "bottoms_out"
        found = refused.value.result
        assert found["absorbed_mJ"] == pytest.approx(most, rel=2e-3) and found["depth_limit_mm"] == law.limit_mm
        assert found["energy_mJ"] == pytest.approx(times * most, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("fidelity", ["axisymmetric", "viscoelastic"])
def test_the_force_of_a_solved_pad_takes_the_energy_of_the_mass(fidelity):
    pad = Pad(10.0, 0.03, RADIUS, (PronyTerm(0.01, 0.8), PronyTerm(1.0, 0.3)))
    found = mass_on_pad(pad, 0.3, 200.0, fidelity)
    curves, table = found.prediction, mass_on_pad(pad, 0.3, 200.0)
    way_in = slice(0, int(np.argmax(curves.displacement_mm)) + 1)
    taken = work_over(curves.displacement_mm[way_in], curves.force_N[way_in])[-1]
    assert taken == pytest.approx(6.0, rel=2e-3)
    assert found.depth_mm == pytest.approx(table.depth_mm, rel=0.02)
    assert table.prediction.force_low_N.max() < curves.peak_force_N < table.prediction.force_high_N.max()


@pytest.mark.slow
def test_a_puck_between_plates_that_slide_is_a_spring_of_modulus_area_over_height():
    puck = {"pad": "cylinder:50", "punch": "plate", "condition": "frictionless", "fidelity": "axisymmetric"}
    found = dummydesign.predict(30, young_kPa=30, **puck, drive="mass:0.1", velocity_mm_s=10).to_dict()
    stiffness = 0.03 * np.pi * 25.0**2 / 30.0
    assert found["peak_force_N"] == pytest.approx(10.0 * np.sqrt(stiffness * 1e-4), rel=5e-3)


def joined(count, seed):
    """Questions of ``predict`` whose press is long enough to be read."""
    rng, asked = np.random.default_rng(seed), []
    shapes = {"slab": (5.0, 20.0), "crowned:radius=21.2,height=2,foot=9.4": (4.5, 10.0)}
    for _ in range(count):
        shape = str(rng.choice(list(shapes)))
        material = {"resin": "polyurethane-nagoya", "ratio": float(rng.uniform(14.5, 16.0))}
        if rng.random() < 0.5:
            arms = f"{10.0 ** rng.uniform(-3, 0):.3g}:{rng.uniform(0.1, 1.2):.3g}"
            material = {"young_kPa": float(rng.uniform(15, 100)), "prony": arms if rng.random() < 0.7 else None}
        mass, velocity = float(np.exp(rng.uniform(-2.3, 1.0))), float(np.exp(rng.uniform(3.0, 5.5)))
        rate = {"rate_Hz": 5000.0} if rng.random() < 0.3 else {}
        asked.append((float(rng.uniform(*shapes[shape])), f"{mass:.3g}", velocity, {"shape": shape} | material | rate))
    return asked


@pytest.mark.parametrize(
    "thickness, mass, velocity, more",
    [pytest.param(*one, marks=[pytest.mark.slow] * (at >= 4)) for at, one in enumerate(joined(16, 7))],
)
def test_on_person_takes_the_file_of_a_predicted_mass_without_a_caution(thickness, mass, velocity, more, tmp_path):
    out = tmp_path / "hit.csv"
    asked = {**more, "drive": f"mass:{mass}", "velocity_mm_s": velocity, "out": out}
    try:
        found = dummydesign.predict(thickness, **asked).to_dict()
    except NoAnswerError as reason:
        assert reason.code == "bottoms_out" and not out.exists()
        return
    people = dummydesign.on_person([out], tissue="forefinger", drive=f"mass:{mass}").to_dict()
    assert "drive_mismatch" not in [one["code"] for one in people["warnings"]]
    (press,) = people["presses"]
    assert press["pad"]["peak_N"] == pytest.approx(found["peak_force_N"], rel=5e-3)
    assert press["pad"]["energy_mJ"] == pytest.approx(found["energy_mJ"], rel=1e-2)
    assert press["contact_mm_s"] == pytest.approx(velocity, rel=5e-3)


MASS = {"young_kPa": 30.0, "prony": "0.1:0.3", "drive": "mass:0.3"}


@pytest.mark.parametrize(
    "given, code, quantity",
    [
        ({}, "missing", "velocity"),
        ({"velocity_mm_s": -5.0}, "out_of_range", "velocity_mm_s"),
        ({"velocity_mm_s": 0.15}, "implausible_unit", "velocity_mm_s"),
        ({"velocity_mm_s": "100,200"}, "conflict", "velocity"),
        ({"velocity_mm_s": 150.0, "drive": "mass:3000"}, "implausible_unit", "mass_kg"),
        ({"velocity_mm_s": 150.0, "drive": "mass:-1"}, "out_of_range", "mass_kg"),
        ({"velocity_mm_s": 150.0, "drive": "mass:"}, "malformed", "drive"),
        ({"velocity_mm_s": 150.0, "drive": "spring:10,2"}, "not_applicable", "drive"),
        ({"velocity_mm_s": 150.0, "drive": "maas:2"}, "unknown_name", "drive"),
        ({"velocity_mm_s": 150.0, "depth_mm": 1.0}, "conflict", "depth"),
        ({"velocity_mm_s": 150.0, "force_N": 5.0}, "conflict", "depth"),
        ({"velocity_mm_s": 150.0, "motion": "no.csv"}, "conflict", "depth"),
        ({"velocity_mm_s": 150.0, "hold_s": 5.0}, "not_applicable", "hold_s"),
        ({"velocity_mm_s": 150.0, "pad": "slab:10x10"}, "out_of_range", None),
    ],
)
def test_what_a_mass_cannot_be_asked_is_refused_by_its_quantity(given, code, quantity):
    with raises_code(code, quantity):
        dummydesign.predict(8.0, **MASS | given)
