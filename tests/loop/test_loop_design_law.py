"""A calibration as a force law for designing: pad effects act, effects of the set-up do not."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.chain import Active
from dummydesign.loop.design_law import CorrectedLaw, young_factor
from dummydesign.loop.effects import effect_named
from dummydesign.loop.parameters import BaseParameters
from dummydesign.pad.table import load_table

RADIUS = 14.0 / np.sqrt(np.pi)
H, D = np.array([5.0, 15.0, 20.0]), np.array([0.5, 3.0, 6.0])


def calibration(*active, law=0.0):
    base = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))
    terms = np.zeros((3, 2))
    terms[0] = law
    model = Model(base, tuple(active), np.array([5.0, 20.0]), terms)
    return Calibration(model, model, "effect", {}, 0.03, {"base": "bonded", "young_kPa_expected": 25.0})


def effect(name, **values):
    one = effect_named(name)
    return Active(one, {**one.null_values(), **values})


def force(*active, **options):
    return CorrectedLaw(calibration(*active, **options), square=False).force(D, H, 0.025, RADIUS)


def test_without_effects_it_is_the_table():
    np.testing.assert_allclose(force(), load_table("bonded").force(D, H, 0.025, RADIUS), rtol=1e-10)


def test_pad_effects_change_it_and_effects_of_the_set_up_do_not():
    stiff = force(effect("strain_stiffening", coefficient=2.0))
    np.testing.assert_allclose(stiff, force() * (1.0 + 2.0 * (D / H) ** 2), rtol=1e-10)
    slipped = force(effect("base_slip", slip_fraction=1.0))
    np.testing.assert_allclose(slipped, load_table("sliding").force(D, H, 0.025, RADIUS), rtol=1e-10)
    laboratory = (effect("machine_compliance", compliance_mm_per_N=0.02), effect("force_bias", bias_N=1.0))
    np.testing.assert_array_equal(force(*laboratory), force())


def test_the_law_error_of_the_pads_is_kept_and_depths_beyond_the_table_are_nan():
    np.testing.assert_allclose(force(law=0.02), 1.02 * force(), rtol=1e-12)
    assert np.isnan(CorrectedLaw(calibration()).force(19.9, 20.0, 0.025, RADIUS))


def test_modes_join_the_relaxation_and_the_batch_scales_the_modulus():
    found = calibration(effect("slow_relaxation_mode", beta=0.1, tau_s=20.0))
    assert [term.tau_s for term in found.prony()] == [0.05, 1.2, 20.0]
    assert young_factor(found) == pytest.approx(1.2)
