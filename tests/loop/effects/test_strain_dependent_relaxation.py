"""Relaxation that depends on strain: recovered whatever its law of growth, and not seen where there is none."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop.calibration import Calibration, Model, Posterior
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.effects.material.strain_dependent_relaxation import (
    REFERENCE_DEPTH_SHARE,
    StrainDependentRelaxation,
    strength,
)
from dummydesign.loop.fitting.candidates import finished, first_fits
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.effect import Effect, Parameter
from dummydesign.loop.model.forward_model import Active, BaseParameters, simulate
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.cross_validation import AssessedModel, assess, effect_intervals
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator as generator
from tests.support.campaign_press import Pad, Physics, pad_force
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

BASE = BaseParameters(0.025, (0.06, 1.4), (0.3, 0.25))
EFFECT = effect_named("strain_dependent_relaxation")
SHARES = np.linspace(0.0, 0.5, 101)
LAWS = {
    "linear": lambda x: 1.0 + 3.0 * x,
    "exponential": lambda x: np.exp(5.0 * x),
    "saturating": lambda x: 1.0 + 0.6 * (1.0 - np.exp(-4.0 * x)),
}


class Grows(Effect):
    """Strengths that follow a function of d/h - 0.15, written apart from the effect that must find them."""

    parameters = (Parameter("on", "1", 0.0, 0.0, 1.0, 1.0),)

    def __init__(self, law):
        self._law = law

    def arms(self, presses, arms, depth_mm, values):
        apart = np.maximum(depth_mm, 0.0) / presses.thickness_mm[:, None] - 0.15
        return tuple(arm.changed(weight=self._law(apart)) for arm in arms)


@pytest.mark.parametrize("slope", [-2.0, 0.7, 3.0, 5.0])
def test_the_family_holds_the_linear_and_the_exponential_law(slope):
    apart = SHARES - REFERENCE_DEPTH_SHARE
    np.testing.assert_allclose(strength(SHARES, slope, 0.0), 1.0 + slope * apart, rtol=1e-12)
    np.testing.assert_allclose(strength(SHARES, slope, 1e-7), strength(SHARES, slope, 0.0), rtol=1e-6)
    np.testing.assert_allclose(strength(SHARES, slope, slope), np.exp(slope * apart), rtol=1e-12)


def test_at_the_reference_depth_the_strength_is_the_base_and_the_slope_its_relative_change():
    near = REFERENCE_DEPTH_SHARE + np.array([-1e-5, 0.0, 1e-5])
    for slope, growth in ((2.0, -3.0), (4.0, 0.0), (1.0, 9.0), (-1.0, 2.0)):
        weight = strength(near, slope, growth)
        assert weight[1] == 1.0
        assert (weight[2] - weight[0]) / 2e-5 == pytest.approx(slope, rel=1e-6)


def test_no_strength_is_zero_or_jumps_at_any_depth_within_the_bounds():
    first, second = StrainDependentRelaxation.parameters
    for slope in np.linspace(first.low, first.high, 19):
        for growth in np.linspace(second.low, second.high, 14):
            weight = strength(np.linspace(0.0, 0.5, 5001), slope, growth)
            assert np.all(weight > 0.0) and np.all(np.isfinite(weight))
            rises = np.diff(weight) * np.sign(slope)
            assert np.all(rises >= -1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_each_law_of_growth_is_recovered_to_the_noise_with_the_modulus(plain, name):
    presses, law = plain
    rng = np.random.default_rng(7)
    truth = simulate(presses, law, BASE, [Active(Grows(LAWS[name]), {"on": 1.0})])
    noise = rng.normal(0.0, 0.03, presses.force_N.shape) / np.sqrt(np.maximum(presses.samples, 1))
    presses = replace(presses, force_N=presses.measure(truth) + noise)
    base = fit_base(presses, law, 0.03)
    _, tried = first_fits(base, (EFFECT,), 1, 0.0)
    fit = finished(base, tried[0]).fit
    weight = strength(SHARES[10:81], *fit.active[0].values.values())
    np.testing.assert_allclose(weight, LAWS[name](SHARES[10:81] - 0.15), rtol=0.03)
    assert fit.base.young_MPa == pytest.approx(BASE.young_MPa, rel=0.01)
    true_slope = {"linear": 3.0, "exponential": 5.0, "saturating": 2.4}[name]
    stage: AssessedModel = assess(fit)
    found = effect_intervals(stage, EFFECT)["slope"]
    assert found["low"] - 0.02 * true_slope <= true_slope <= found["high"] + 0.02 * true_slope
    assert np.sqrt(np.mean((fit.residual[presses.used]) ** 2)) < 1.1 * np.sqrt(np.mean(noise[presses.used] ** 2))


@pytest.mark.slow
@pytest.mark.parametrize("strength_of_it", [1.0, 3.0])
def test_a_machine_that_gives_way_is_not_called_strain_dependent_relaxation(campaigns, strength_of_it):
    result = close_loop(read_campaign(campaigns("machine_compliance", 416, strength_of_it)))
    names = [found.candidate.effect.name for found in result.effects]
    assert "strain_dependent_relaxation" not in names
    assert all("strain_dependent_relaxation" not in found.confounded_with for found in result.effects)


@pytest.mark.slow
def test_relaxation_that_grows_exponentially_is_named_alone_without_a_machine_that_gives_way(tmp_path):
    generator.write_campaign(tmp_path / "a", "strain_dependent_relaxation", 5.0, 417)
    result = close_loop(read_campaign(tmp_path / "a"))
    assert [found.candidate.effect.name for found in result.effects] == ["strain_dependent_relaxation"]
    assert result.verdict == "effect"


def test_a_calibration_that_lacks_a_parameter_is_refused(tmp_path):
    model = Model(BASE, (Active(EFFECT, {"slope": 2.0, "growth": 0.0}),), (("", 5.0),), np.zeros((3, 1)))
    pad = {"young_kPa_expected": 25.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    names = ("log young_kPa", "log tau_1_s", "log beta_1", "log tau_2_s", "log beta_2")
    names = (*names, *(f"strain_dependent_relaxation.{p.name}" for p in EFFECT.parameters))
    known = Posterior(names, np.zeros(7), 1e-4 * np.eye(7), (0.01, 0.01, 0.01))
    path = write_calibration(Calibration(model, model, "effect", {}, 0.03, pad, (), known), tmp_path / "c.json")
    again = read_calibration(path)
    assert again.after.active[0].values == model.active[0].values and again.posterior.names == names
    data = json.loads(path.read_text())
    del data["after"]["effects"][0]["parameters"]["growth"]
    path.write_text(json.dumps(data))
    with raises_code("malformed", "calibration"):
        read_calibration(path)


def test_the_generator_is_not_off_by_its_time_step():
    pad = Pad(np.array([5.0]), np.zeros(1), np.zeros(1))
    forces = []
    for step in (5e-4, 6.25e-5):
        time = np.arange(0.0, 0.3 + 0.5 * step, step)[None]
        depth = np.minimum(250.0 * time, 2.0)
        physics = Physics(np.array([0.03]), np.full((1, 1), 0.05), np.full((1, 1), 0.3), pad, np.zeros(1))
        physics.beta_strain = 6.0
        out = pad_force(time, depth, np.zeros_like(time, bool), physics)[0]
        forces.append(np.interp([0.008, 0.02, 0.05], time[0], out))
    np.testing.assert_allclose(forces[0], forces[1], rtol=0.01)
