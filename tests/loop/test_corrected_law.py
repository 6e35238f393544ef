"""A calibration as a force law for designing: pad effects act, effects of the set-up do not."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.design.calibrated import pressed_force
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, SlabCurves, press_to_depth
from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.calibration_file import write_calibration
from dummydesign.loop.corrected_law import CorrectedLaw, Correction
from dummydesign.loop.effects.registry import EFFECTS
from dummydesign.loop.model.forward_model import Active, BaseParameters
from dummydesign.pad.tables.slab import load_table, slab_table
from dummydesign.pad.tables.square import punch_law
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

QUICK = ["--no-cad", "--no-verify"]
RADIUS = 14.0 / np.sqrt(np.pi)
H, D = np.array([5.0, 15.0, 20.0]), np.array([0.5, 3.0, 6.0])


def calibration(*active, law=0.0):
    base = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))
    terms = np.zeros((3, 2))
    terms[0] = law
    model = Model(base, tuple(active), (("", 5.0), ("", 20.0)), terms)
    return Calibration(model, model, "effect", {}, 0.03, {"base": "bonded", "young_kPa_expected": 25.0})


def effect(name, **values):
    one = effect_named(name)
    return Active(one, {**one.null_values(), **values})


def force(*active, **options):
    return CorrectedLaw(Correction(calibration(*active, **options)), square=False).force(D, H, 0.025, RADIUS)


def test_without_effects_it_is_the_table():
    np.testing.assert_allclose(force(), load_table("bonded").force(D, H, 0.025, RADIUS), rtol=1e-10)


@pytest.mark.parametrize(("square", "edge_mm"), [(False, 0.0), (True, 0.0), (True, 1.0)])
def test_its_stated_error_is_that_of_the_law_that_it_corrects_whatever_the_effects(square, edge_mm):
    circle = slab_table("bonded", edge_mm, RADIUS)
    plain = punch_law(circle, "square:14" if square else "round:15.8", "bonded", filleted=edge_mm > 0.0)
    for known in (calibration(), calibration(effect("strain_stiffening", coefficient=2.0), law=0.02)):
        law = CorrectedLaw(Correction(known), square, edge_mm)
        error = law.relative_error(D, H, RADIUS)
        np.testing.assert_allclose(error, plain.relative_error(D, H, RADIUS), rtol=1e-12)
        assert np.all(np.isfinite(error)) and np.all(error > 0.0)


def test_effects_of_the_material_change_it_by_their_law():
    stiff = force(effect("strain_stiffening", coefficient=2.0))
    np.testing.assert_allclose(stiff, force() * (1.0 + 2.0 * (D / H) ** 2), rtol=1e-10)
    bubbles = force(effect("compressibility", poisson_ratio=0.49)) / force()
    assert bubbles[0] < bubbles[1] < bubbles[2] < 1.0


def usual(one):
    size = one.parameters[0]
    return Active(one, {**one.null_values(), size.name: size.null + size.typical})


@pytest.mark.parametrize("one", EFFECTS, ids=lambda e: e.name)
def test_what_belongs_to_the_pad_enters_a_design_and_what_belongs_to_the_laboratory_does_not(one):
    """Of the rig or the sensor: the design is that without it, to the last bit. Of the pad: either force or
    relaxation of the design change, or the state is named that the design is for."""
    found, none = calibration(usual(one)), calibration()
    with_it, without = (CorrectedLaw(Correction(each)).force(D, H, 0.025, RADIUS) for each in (found, none))
    assert np.all(np.isfinite(with_it)) and np.all(with_it > 0.0)
    same = np.array_equal(with_it, without) and found.prony() == none.prony() and pressed_force(found) is None
    if one.belongs_to == "pad":
        assert same == bool(one.designed_for)
        assert any(one.name in note for note in CorrectedLaw(Correction(found)).notes) == same
    else:
        assert one.belongs_to in ("rig", "sensor") and not one.designed_for
        assert same and CorrectedLaw(Correction(found)).notes == ()


STRAIGHT = SlabCurves(
    np.array([10.0, 5.0]), np.array([6.0, 3.0]), np.linspace(0.0, 1.0, 61) * np.array([[60.0], [30.0]])
)
FINE = Sampling(400, 100, 200)


def pressed(active, tau_s, depth_mm, velocity_mm_s):
    """Two slabs whose force is 10 mm times modulus times depth, pressed as a design with a calibration presses them."""
    beta = np.tile([0.4, 0.3], (2, 1))[:, : len(tau_s)]
    found = None if active is None else pressed_force(calibration(active))
    batch = PadBatch(STRAIGHT, np.array([0, 1]), np.array([0.03, 0.05]), tau_s, beta, found)
    return press_to_depth(batch, np.array(depth_mm), velocity_mm_s, FINE)


@pytest.mark.parametrize("name", ["strain_dependent_relaxation", "rate_dependent_viscosity"])
def test_where_its_size_is_zero_a_press_of_a_design_is_that_without_it(name):
    plain, same = (pressed(one, (0.05, 1.2), [5.0, 2.0], 50.0) for one in (None, effect(name)))
    np.testing.assert_allclose(same.force_N, plain.force_N, rtol=1e-9, atol=1e-12)


def test_arms_that_never_relax_hold_the_integral_of_their_strength_over_the_rising_force():
    """F = k x and beta (1 + s (x/h - 0.15)): the arm holds beta k x (1 + s (x / 2h - 0.15)) at depth x."""
    slope, depth = 1.6, np.array([5.0, 2.0])
    press = pressed(effect("strain_dependent_relaxation", slope=slope), (1e9,), depth, 50.0)
    elastic = 10.0 * np.array([0.03, 0.05]) * depth
    held = 0.4 * elastic * (1.0 + slope * (depth / np.array([10.0, 5.0]) / 2.0 - 0.15))
    np.testing.assert_allclose(press.force_N[:, FINE.stopped], elastic + held, rtol=1e-5)


@pytest.mark.parametrize("velocity_mm_s", [10.0, 250.0])
def test_times_that_fall_with_speed_are_those_of_the_press(velocity_mm_s):
    one = effect("rate_dependent_viscosity", exponent=0.3, plateau_mm_per_s=5.0)
    quicker = ((velocity_mm_s**2 + 25.0) / (50.0**2 + 25.0)) ** -0.15
    press, plain = (
        pressed(active, tau_s, [5.0, 2.0], velocity_mm_s)
        for active, tau_s in ((one, (0.05, 1.2)), (None, (0.05 * quicker, 1.2 * quicker)))
    )
    np.testing.assert_allclose(press.force_N, plain.force_N, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("one", EFFECTS, ids=lambda e: e.name)
def test_a_campaign_of_pucks_can_be_designed_with_and_leaves_its_plates_behind(one):
    pucks = replace(calibration(usual(one), law=0.02), pad={"base": "friction:0.3", "shape": "cylinder"})
    own = CorrectedLaw(Correction(pucks)).force(D, H, 0.025, RADIUS)
    slabs = CorrectedLaw(Correction(calibration(usual(one)))).force(D, H, 0.025, RADIUS)
    np.testing.assert_array_equal(own, slabs)
    assert np.all(np.isfinite(CorrectedLaw(Correction(pucks)).depth_limit_mm(H, RADIUS)))


def test_the_terms_of_an_effect_are_the_arms_that_it_adds(plain):
    presses, _ = plain
    for one in map(usual, EFFECTS):
        arms = one.effect.arms(presses, (), presses.displacement_mm, one.values)
        assert [(arm.tau_s, arm.beta) for arm in arms] == [(t.tau_s, t.beta) for t in one.effect.adds_terms(one.values)]


def test_the_law_error_of_the_pads_is_kept_and_depths_beyond_the_table_are_nan():
    np.testing.assert_allclose(force(law=0.02), 1.02 * force(), rtol=1e-12)
    assert np.isnan(CorrectedLaw(Correction(calibration())).force(19.9, 20.0, 0.025, RADIUS))


@pytest.mark.parametrize("edge_mm", [0.0, 1.0])
def test_it_answers_the_thicknesses_of_its_table_and_refuses_others(edge_mm):
    law = CorrectedLaw(Correction(calibration(effect("strain_stiffening", coefficient=2.0))), True, edge_mm)
    thinnest, thickest = (RADIUS / ratio for ratio in reversed(law.ratio_range))
    inside = np.array([1.0001 * thinnest, 0.9999 * thickest])
    assert np.isfinite(law.force(0.1 * inside, inside, 0.025, RADIUS)).all()
    for outside in (0.99 * thinnest, 1.01 * thickest):
        with raises_code("out_of_range"):
            law.force(0.1 * outside, outside, 0.025, RADIUS)


def test_modes_join_the_relaxation():
    found = calibration(effect("slow_relaxation_mode", beta=0.1, tau_s=20.0))
    assert [term.tau_s for term in found.prony()] == [0.05, 1.2, 20.0]


@pytest.mark.slow
def test_suggest_takes_a_calibration_of_pucks_with_plate_friction(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pad = {"young_kPa_expected": 25.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "cylinder"}
    answers = []
    for active in ((), (effect("plate_friction", friction=0.3), effect("punch_tilt", tilt_deg=2.0))):
        path = write_calibration(replace(calibration(*active), pad=pad), tmp_path / "calibration.json")
        assert cli.run(["suggest", "--tissue", "forefinger", "--calibration", str(path), *QUICK, "--json"]) in (0, 1)
        answers.append(json.loads(capsys.readouterr().out)["recommendation"])
    assert answers[0] == answers[1]


@pytest.mark.slow
def test_suggest_says_for_which_state_of_the_pad_a_calibration_is_taken(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pad = {"young_kPa_expected": 25.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    warm = replace(calibration(effect("temperature", modulus_loss_per_K=0.01)), pad=pad)
    path = write_calibration(warm, tmp_path / "calibration.json")
    assert cli.run(["suggest", "--tissue", "forefinger", "--calibration", str(path), *QUICK, "--json"]) in (0, 1)
    said = [w["message"] for w in json.loads(capsys.readouterr().out)["warnings"] if w["code"] == "calibration"]
    assert said == ["the calibration holds temperature: the design is for 23 C"]
