"""Campaigns of the independent generator: what it puts in, and that the loop finds it."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.run import close_loop
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import independent_generator


def test_a_held_pad_relaxes_to_its_elastic_force(tmp_path):
    truth = independent_generator.write_campaign(tmp_path / "a", (), 960001)
    campaign = read_campaign(tmp_path / "a")
    for trial in campaign.trials[:6]:
        time, x, force = trial.trace.time_s, trial.trace.displacement_mm, trial.trace.force_N
        held = (time > time[np.argmax(x > 0.99 * x.max())] + 6.5) & (x > 0.98 * x.max())
        elastic = 1e-3 * truth.young_kPa * independent_generator._elastic(trial.thickness_mm, x[held], {})
        # the slow arm of 1 to 2.8 s holds at most e^-2.3 of 0.45 after 6.5 s; a pad differs by some 1 %
        assert 0.96 < np.mean(force[held] / elastic) < 1.06


@pytest.mark.slow
def test_the_same_seed_is_the_same_material_on_other_pads(tmp_path):
    first = independent_generator.write_campaign(tmp_path / "a", (("force_bias", 0.1),), 960002)
    other = independent_generator.write_campaign(tmp_path / "b", (("force_bias", 0.1),), 960002, held_out=True)
    assert (first.young_kPa, first.effects) == (other.young_kPa, other.effects)
    shown = [len(read_campaign(tmp_path / name).trials) for name in ("a", "b")]
    assert shown == [36, 16]


CASES = [
    ((("rate_dependent_viscosity", 0.37), ("contact_offset", 0.09)), 960011),
    ((("softening_with_cycles", 0.08), ("ageing", 0.035)), 960012),
    ((("adhesion", 0.45), ("contact_offset", 0.11)), 960013),
    ((("inertia", 0.05), ("slow_relaxation_mode", 0.19)), 960014),
    ((("strain_stiffening", 1.4), ("machine_compliance", 0.012)), 960015),
    ((("sensor_lag", 0.008), ("contact_offset", 0.09)), 960016),
]


@pytest.mark.slow
@pytest.mark.parametrize(("put", "seed"), CASES)
def test_two_effects_of_other_laws_are_named_and_nothing_else(put, seed, tmp_path):
    truth = independent_generator.write_campaign(tmp_path / "a", put, seed)
    result = close_loop(read_campaign(tmp_path / "a"))
    assert {one.candidate.effect.name for one in result.effects} == set(truth.effects)
    assert result.verdict == "effect"


@pytest.mark.slow
def test_a_curve_of_the_sensor_is_named_and_the_modulus_beside_it_holds(tmp_path):
    truth = independent_generator.write_campaign(tmp_path / "a", (("sensor_square", 0.02),), 960021)
    result = close_loop(read_campaign(tmp_path / "a"))
    assert [one.candidate.effect.name for one in result.effects] == ["sensor_curve"]
    assert result.after.errors.heldout_N < 1.5 * truth.floor_N < 0.5 * result.base.errors.heldout_N
    known = calibration_of(result).posterior.interval("log young_kPa")
    assert known[0] < truth.young_kPa < known[1]
    (active,) = result.after.fit.active
    assert active.values["relative_change"] == pytest.approx(10.0 * truth.effects["sensor_square"], rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("share", "seed"), [(0.3, 960031), (1.0, 960032)])
def test_a_top_that_is_cut_off_is_named_alone_and_the_modulus_holds(share, seed, tmp_path):
    truth = independent_generator.write_campaign(tmp_path / "a", (("sensor_clipping", share),), seed)
    result = close_loop(read_campaign(tmp_path / "a"))
    assert [one.candidate.effect.name for one in result.effects] == ["sensor_clipping"]
    assert result.learnt is None and result.after.fit.base.young_MPa == pytest.approx(1e-3 * truth.young_kPa, rel=0.02)
