"""The presses on which an effect is tried: as their docstring says, and faults of an effect are seen on them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop import Effect, Parameter, check_effect, wrap
from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.effects.contract_check import BASE, faults_on, reference_presses
from dummydesign.loop.effects.learned import Learned, SmoothChange
from dummydesign.loop.effects.material.strain_dependent_relaxation import strength
from dummydesign.loop.model.forward_model import WAVES, Active, BaseParameters, simulate
from tests.support.named_effects import effect_named


@pytest.mark.parametrize("shape", ["slab", "cylinder", "shaped"])
def test_eight_presses_of_two_pads_at_two_speeds_go_up_hold_and_come_back(shape):
    presses, law = reference_presses(shape)
    assert law.shape == shape and len(presses.trials) == 8
    assert len(np.unique(presses.thickness_mm)) == 2 and len(set(presses.pads)) == 2
    speeds = np.array([trial.velocity_mm_s for trial in presses.trials])
    assert set(speeds) == {10.0, 250.0}
    # each pad lies within what its law knows, and is pressed again to seven tenths
    share = presses.depth_mm / presses.thickness_mm
    assert np.all(presses.depth_mm < law.limit_of(presses.trials))
    np.testing.assert_allclose(share[4:], 0.7 * share[:4], rtol=1e-3)
    assert presses.history.repeat.tolist() == [1.0] * 4 + [2.0] * 4
    for row, (trial, depth, speed) in enumerate(zip(presses.trials, presses.depth_mm, speeds)):
        time, x = trial.trace.time_s, trial.trace.displacement_mm
        assert time[0] < -0.07 and np.all(np.diff(time) > 0.0)
        # at full speed before contact, where its time begins; three seconds of hold
        rising = x < 0.0
        rising[np.argmax(~rising) :] = False
        np.testing.assert_allclose(x[rising], speed * time[rising], rtol=1e-9)
        held = time[x > depth * (1.0 - 1e-9)]
        assert held[-1] - held[0] == pytest.approx(3.0, abs=0.03)
        back = time > held[-1] + 1e-9
        np.testing.assert_allclose(np.diff(x[back]) / np.diff(time[back]), -10.0, rtol=1e-6)
        assert x[-1] == pytest.approx(-2.0, abs=0.06)
        elastic = BASE.young_MPa * law(np.maximum(x, 0.0)[None], presses.thickness_mm[row, None][None])[0]
        np.testing.assert_allclose(trial.trace.force_N, elastic, rtol=1e-9, atol=1e-12)
    # each differs in temperature, pairs in age and rest, so that effects of the history can be seen
    assert len(np.unique(presses.history.temperature_C)) == 8
    assert len(np.unique(presses.history.age_days)) == 2 and len(np.unique(presses.history.rest_s)) == 2
    top = simulate(presses, law, BASE).max()
    assert presses.flat_top_N == pytest.approx(0.5 * top)
    assert presses.velocity_mm_s.max() > 10.0 * presses.velocity_mm_s.min()


class Good(Effect):
    """Force times one plus the size."""

    name, hook, belongs_to = "good", "sensor", "sensor"
    parameters = (Parameter("share", "1", 0.0, -0.5, 0.5, 0.1),)
    signature = reference = "x"
    shapes = ("cylinder",)

    def factor(self, size):
        return 1.0 + size

    def sensor(self, presses, force_N, values):
        return force_N * self.factor(values["share"])


def with_factor(factor):
    return type("Odd", (Good,), {"__doc__": "x", "factor": staticmethod(factor)})


def test_faults_are_told_and_what_is_sound_is_not():
    assert check_effect(Good) == ()
    assert any("changes nothing" in fault for fault in check_effect(with_factor(lambda size: 1.0)))
    steep = with_factor(lambda size: 1.0 + np.sign(size) * 0.05)
    assert any("leaves a step" in fault for fault in check_effect(steep))
    root = with_factor(lambda size: 1.0 + 0.05 * np.sign(size) * abs(size) ** 0.2)
    assert any("leaves a step" in fault for fault in check_effect(root))
    # a ten thousandth of the usual change may be left at a millionth of the usual size
    for left, told in ((0.95e-4, False), (1.05e-4, True)):
        small = with_factor(lambda size, left=left: 1.0 + 0.2 * (1.0 if abs(size) > 0.05 else left) * np.sign(size))
        assert any("leaves a step" in fault for fault in check_effect(small)) is told
    ends = with_factor(lambda size: 1.0 + size if size < 0.4 else np.nan)
    assert any("not finite at share = 0.5" in fault for fault in check_effect(ends))
    log = type("Log", (Good,), {"__doc__": "x", "parameters": (Parameter("share", "1", 0.1, 0.1, 0.5, 0.2, log=True),)})
    assert any("logarithm" in fault for fault in check_effect(log))


@pytest.mark.parametrize(
    "wrong",
    [
        {"low": 0.1},
        {"high": -0.1},
        {"typical": 0.0},
        {"typical": 0.6},
        {"starts": (0.7,)},
        {"null": 0.6},
        {"low": 0.5},
        {"unit": ""},
        {"high": float("inf")},
        {"typical": -0.51},
    ],
)
def test_a_parameter_that_cannot_be_is_told(wrong):
    parameter = replace(Good.parameters[0], **wrong)
    assert check_effect(type("Odd", (Good,), {"__doc__": "x", "parameters": (parameter,)}))


@pytest.mark.parametrize("right", [{"typical": 0.5}, {"typical": -0.5}, {"starts": (0.5, -0.5)}, {"low": 0.0}])
def test_a_parameter_at_its_bounds_is_sound(right):
    parameter = replace(Good.parameters[0], **right)
    assert check_effect(type("Edge", (Good,), {"__doc__": "x", "parameters": (parameter,)})) == ()


def test_a_name_that_ends_in_a_unit_has_it():
    for name, unit, right in (("gap_mm", "mm", True), ("gap_mm", "N", False), ("loss_per_K", "1/K", True)):
        parameter = replace(Good.parameters[0], name=name, unit=unit)
        acts = {"sensor": lambda self, presses, force, values, name=name: force * (1.0 + values[name])}
        effect = type("Named", (Good,), {"__doc__": "x", "parameters": (parameter,), **acts})
        assert (check_effect(effect) == ()) is right


def test_an_effect_that_answers_differently_or_spoils_the_base_is_told():
    presses, law = reference_presses("cylinder")

    class Counting(Good):
        """Another force each time."""

        count = 0

        def sensor(self, presses, force_N, values):
            Counting.count += 1
            return force_N * (1.0 + Counting.count * 0.01)

    assert "asked twice" in faults_on(Counting(), presses, law)[0]

    class Rough(Good):
        """Another shape."""

        def sensor(self, presses, force_N, values):
            return force_N[:, :-1]

    assert "shape" in faults_on(Rough(), presses, law)[0]
    assert faults_on(Good(), presses, law) == ()


def test_a_learned_curve_survives_its_file(tmp_path):
    shape = SmoothChange(("depth_share",), ((0.01, 0.1, 0.3),), (0.02, -0.05, 0.04))
    model = Model(BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2)), (Active(Learned(shape), {"size": 1.0}),),
                  (("", 5.0), ("", 9.0)), np.array([[0.01, 0.02], [0.0, -0.03], [0.04, 0.0]]))  # fmt: skip
    pad = {"young_kPa_expected": 30.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    path = write_calibration(Calibration(model, model, "unexplained", {}, 0.03, pad), tmp_path / "c.json")
    again = read_calibration(path)
    assert again.after.active[0].effect.shape == shape
    np.testing.assert_allclose(again.base.base.to_logs(), model.base.to_logs())
    np.testing.assert_array_equal(again.after.law, np.concatenate([model.law, np.zeros((WAVES, 2))]))
    assert again.after.pads == model.pads


def test_the_reference_of_strain_in_the_relaxation_is_at_the_written_depth():
    """docs/loop.md: slope is the relative change of the arms' strengths with d/h, at d/h 0.15."""
    effect = effect_named("strain_dependent_relaxation")
    presses, _ = reference_presses("cylinder")
    values = {p.name: p.typical if n == 0 else p.null for n, p in enumerate(effect.parameters)}
    thickness = presses.thickness_mm[:, None]

    def strength(share):
        from dummydesign.loop.model.effect import Arm

        depth = share * thickness + 0.0 * presses.displacement_mm
        arm = effect.arms(presses, (Arm(0.1, 0.5),), depth, values)[0]
        return np.asarray(arm.beta) * (1.0 if arm.weight is None else arm.weight) + 0.0 * presses.displacement_mm

    np.testing.assert_allclose(strength(0.15), 0.5, rtol=1e-9)
    change = np.log(strength(0.151) / strength(0.149)) / 0.002
    np.testing.assert_allclose(change, values[effect.parameters[0].name], rtol=0.02)


def test_a_law_that_is_wrapped_keeps_its_root():
    law = reference_presses("cylinder")[1]
    twice = wrap(law, lambda depth, h: 2.0 * law(depth, h))
    assert twice.__wrapped__ is law


@pytest.mark.parametrize("slope", [3.0, -3.0])
def test_no_strength_of_an_arm_turns_negative(slope):
    """Below a tenth of its base it falls on as a hyperbola with the same tangent, as the class says."""
    plain = np.array([2.0, 1.0, 0.2, 0.101, 0.1, 0.099, 0.05, 0.0, -1.0])
    found = strength(0.15 + (plain - 1.0) / slope, slope, 0.0)
    np.testing.assert_allclose(found[:5], plain[:5], rtol=1e-9)
    np.testing.assert_allclose(found[5:], 0.01 / (0.2 - plain[5:]), rtol=1e-9)
    # exponential growth has the same value and slope at the reference
    bent = strength(np.array([0.15, 0.15 + 1e-6]), slope, 4.0)
    assert bent[0] == 1.0 and (bent[1] - bent[0]) / 1e-6 == pytest.approx(slope, rel=1e-4)
    assert strength(np.array([0.25]), 2.0, 4.0)[0] == pytest.approx(1.0 + 0.5 * np.expm1(0.4))
