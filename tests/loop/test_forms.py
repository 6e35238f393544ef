"""Parameters of form, tension read off the raw data, doubt between models: closed forms, limits, a missing form."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.data.trials import shows_tension
from dummydesign.loop.effects.registry import EFFECTS
from dummydesign.loop.fitting.fit import prior_precision
from dummydesign.loop.model.effect import Arm
from dummydesign.loop.model.forward_model import WAVES, parameter_names, relax
from dummydesign.loop.model.material import UNDECLARED
from dummydesign.loop.selection.search import LAW_ERROR, doubt_of
from dummydesign.loop.selection.verdict import EACH_PARAMETER
from tests.support.made_calibration import calibration, effect
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

FORMS = [(one, p) for one in EFFECTS for p in one.parameters if p.of_form]


@pytest.mark.parametrize(("one", "p"), FORMS, ids=lambda value: value.name)
def test_a_form_has_its_usual_value_at_coordinate_zero_and_is_never_a_size(one, p):
    assert p.to_coordinate(p.null) == pytest.approx(0.0)
    assert p is not one.parameters[0] and p.low <= p.null <= p.high


def test_only_forms_and_the_law_error_have_priors():
    effects = (effect_named("friction_hysteresis"),)
    problem = SimpleNamespace(effects=effects, presses=SimpleNamespace(pads=(("", 5.0), ("", 10.0))), prior=UNDECLARED)
    forms = [one.spread**-2.0 for one in effect_named("friction_hysteresis").parameters[1:]]
    sizes = SimpleNamespace(law=(0.1, 0.2, 0.5, 0.25))
    expected = [*[0.0] * 6, *forms, 100.0, 100.0, 25.0, 25.0, 4.0, 4.0, *[16.0] * 2 * WAVES]
    assert prior_precision(problem, sizes) == pytest.approx(expected)


@pytest.fixture
def written(tmp_path):
    """A calibration's file as a table, and a function that reads it when it was changed."""
    made = calibration(effect("friction_hysteresis", friction_fraction=0.05))
    names = tuple(parameter_names(2, [made.after.active[0].effect]))
    made = replace(made, posterior=replace(made.posterior, names=names))
    path = write_calibration(made, tmp_path / "calibration.json")

    def read(table):
        path.write_text(json.dumps(table))
        return read_calibration(path)

    return json.loads(path.read_text()), read


def test_a_calibration_that_lacks_a_size_is_refused(written):
    whole, read = written
    assert read(whole).after.active[0].values == {"friction_fraction": 0.05, "turn_mm": 0.1, "in_hold": 0.0}
    del whole["after"]["effects"][0]["parameters"]["friction_fraction"]
    with raises_code("malformed"):
        read(whole)


def test_a_form_that_an_earlier_version_did_not_have_has_its_usual_value_and_prior(written):
    whole, read = written
    before = read(whole).posterior
    del whole["after"]["effects"][0]["parameters"]["in_hold"]
    at = whole["posterior"]["names"].index("friction_hysteresis.in_hold")
    for key in ("names", "mean", "covariance"):
        del whole["posterior"][key][at]
    for row in whole["posterior"]["covariance"]:
        del row[at]
    after = read(whole)
    assert after.after.active[0].values["in_hold"] == 0.0 and after.posterior.names == before.names
    form = effect_named("friction_hysteresis").parameters[2]
    assert after.posterior.mean[at] == form.null
    assert after.posterior.spread("friction_hysteresis.in_hold") == pytest.approx(form.spread * form.typical)
    rest = np.arange(len(before.names)) != at
    assert after.posterior.covariance[at, rest] == pytest.approx(0.0)
    assert after.posterior.covariance[np.ix_(rest, rest)] == pytest.approx(before.covariance[np.ix_(rest, rest)])
    del whole["posterior"]["names"][-1]
    with raises_code("malformed"):
        read(whole)


def test_an_arm_whose_time_changes_decays_with_each_time_in_turn():
    time = np.linspace(0.0, 4.0, 401)[None]
    elastic = np.minimum(time / 0.01, 1.0)
    tau = np.where(time <= 2.0, 1.0, 0.25)
    held = relax(time, elastic, [Arm(tau, 0.5)]) - elastic
    start = held[0, 1]
    expected = start * np.exp(-np.minimum(time[0] - 0.01, 1.99) / 1.0 - np.maximum(time[0] - 2.0, 0.0) / 0.25)
    assert held[0, 1:] == pytest.approx(expected[1:], rel=1e-9)


def way_back(pull_N, drift_N_s=0.0, seed=3):
    """Time, force, contact and end of hold of a press of 5 N with tension on the way back."""
    time = np.arange(0.0, 4.0, 1e-2)
    force = 5.0 * np.clip((time - 0.5) / 0.2, 0.0, 1.0) * np.clip((3.0 - time) / 0.2, 0.0, 1.0)
    force = force - pull_N * ((time > 3.0) & (time < 3.3)) + drift_N_s * time
    return time, force + np.random.default_rng(seed).normal(0.0, 0.02, len(time)), 0.5, 2.8


def test_tension_is_seen_beyond_the_noise_and_a_drift_of_the_zero_is_none():
    for seed in range(40):
        assert shows_tension(*way_back(0.2, seed=seed)) and shows_tension(*way_back(0.2, 0.01, seed))
        assert not shows_tension(*way_back(0.0, seed=seed)) and not shows_tension(*way_back(0.0, -0.02, seed))


def model(log_young, variance=0.0, effects=()):
    vector = np.array([log_young, 0.0, 0.0, 0.0, 0.0])
    covariance = np.diag([variance, 0.0, 0.0, 0.0, 0.0])
    return SimpleNamespace(
        vector=vector, covariance=covariance, active=(), problem=SimpleNamespace(effects=effects, base_count=5)
    )


def test_rivals_widen_the_modulus_by_their_weight_and_the_law_by_its_error():
    chosen, other = model(1.3), model(1.4, 0.02**2, (effect_named("thickness_error"),))
    alone = doubt_of(chosen, [])
    assert alone[0, 0] == pytest.approx(LAW_ERROR**2) and np.count_nonzero(alone) == 1
    # as likely as the chosen one once its parameter is paid for
    even = doubt_of(chosen, [(EACH_PARAMETER, other)])
    assert even[0, 0] == pytest.approx(0.5 * (0.1**2 + 0.02**2) + LAW_ERROR**2)
    never = doubt_of(chosen, [(EACH_PARAMETER - 60.0, other)])
    assert never[0, 0] == pytest.approx(LAW_ERROR**2, rel=1e-6)


def test_the_exponent_of_stiffening_keeps_its_coefficient_at_a_depth_of_three_tenths():
    one, depth, thickness = effect_named("strain_stiffening"), np.linspace(0.0, 4.0, 9)[None], np.array([[10.0]])

    def plain(d, h):
        return np.ones_like(d)

    factors = [one.law(plain, {"coefficient": 1.5, "exponent": p})(depth, thickness)[0] for p in (2.0, 3.0)]
    assert factors[0] == pytest.approx(1.0 + 1.5 * (depth[0] / 10.0) ** 2)
    assert factors[1][6] == pytest.approx(factors[0][6]) == pytest.approx(1.0 + 1.5 * 0.09)
    assert np.all(factors[1][7:] > factors[0][7:]) and np.all(factors[1][1:6] < factors[0][1:6])


def test_a_joint_that_hardens_gives_way_as_a_spring_at_ten_newton():
    one, force = effect_named("machine_compliance"), np.array([[0.0, 1.0, 10.0, 20.0]])
    spring = one.yielding(None, force, {"compliance_mm_per_N": 0.01, "exponent": 1.0})
    joint = one.yielding(None, force, {"compliance_mm_per_N": 0.01, "exponent": 0.7})
    assert spring == pytest.approx(0.01 * force)
    assert joint[0, 2] == pytest.approx(spring[0, 2]) and joint[0, 0] == 0.0
    assert joint[0, 1] > spring[0, 1] and joint[0, 3] < spring[0, 3]


def test_two_stages_of_a_lag_share_its_time():
    """A ramp after two filters of first order, in closed form; late by the whole time in the end."""
    time, share, lag = np.linspace(0.0, 1.0, 600)[None] ** 1.3, 0.25, 0.04
    presses = SimpleNamespace(time_s=time)
    late = effect_named("sensor_lag").sensor(presses, 5.0 * time, {"time_constant_s": lag, "second_stage": share})
    slow, fast = (1.0 - share) * lag, share * lag
    gone = (slow**2 * np.exp(-time / slow) - fast**2 * np.exp(-time / fast)) / (slow - fast)
    # the second stage takes the first one's signal for straight between samples
    assert late == pytest.approx(5.0 * (time - lag + gone), abs=2e-4)
    assert late[0, -1] == pytest.approx(5.0 * (1.0 - lag), abs=1e-5)
