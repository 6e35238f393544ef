"""The presses that the loop considers as the next measurement."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from dummydesign.loop import next_measurement as planning
from dummydesign.loop.data import trials
from dummydesign.loop.fitting.candidates import first_fit, screen
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.measurement.motion import ramp_and_hold
from tests.support.named_effects import effect_named


def test_a_planned_press_stops_where_its_hold_begins_however_finely_the_motion_is_sampled(plain, monkeypatch):
    presses, law = plain
    chosen = planning.options(presses, law)[:6]
    usual = planning.planned_presses(presses, None, chosen)
    monkeypatch.setattr(trials, "ramp_and_hold", partial(ramp_and_hold, hold_points=20))
    coarse = planning.planned_presses(presses, None, chosen)
    np.testing.assert_allclose(coarse.stop_s, usual.stop_s, atol=1e-9)
    for made in (usual, coarse):
        np.testing.assert_allclose(made.hold_end_s - made.stop_s, planning.HOLD_S, atol=0.05)


@pytest.fixture(scope="module")
def explained(plain):
    """A campaign's base fit, one with a stiffening pad, and an option at a press that was made twice."""
    presses, law = plain
    base = fit_base(presses, law, 0.03)
    screened = next(one for one in screen(base, (effect_named("strain_stiffening"),)))
    other = first_fit(base, screened)
    # no way back is recorded in half of the presses; the one below was taken back in none
    cells = [np.flatnonzero(presses.cell == one) for one in np.unique(presses.cell)]
    twice = next(rows for rows in cells if len(rows) == 2 and not presses.unloads[rows].any())
    trial = presses.trials[twice[0]]
    share = float(presses.depth_mm[twice].mean() / trial.thickness_mm)
    option = planning.PossiblePress(
        trial.thickness_mm, trial.velocity_mm_s, share, False, "", 3600.0, 23.0, 7.0, trial.geometry, True
    )
    return base, other, option


def gain(explained, **changes):
    """What an option like that of the press made twice is expected to show."""
    base, other, option = explained
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(planning, "options", lambda presses, law: [replace(option, **changes)])
        return planning.next_measurement(base, (other,), ("none", "strain_stiffening"), None).expected_gain


@pytest.mark.slow
def test_a_press_made_twice_or_nearly_shows_nothing_and_another_depth_or_speed_does(explained):
    option = explained[2]
    for near in (0.97, 1.0, 1.03):
        assert gain(explained, depth_share=near * option.depth_share) == 0.0
        assert gain(explained, velocity_mm_s=near * option.velocity_mm_s) == 0.0
    for far in (0.94, 1.06):
        assert gain(explained, depth_share=far * option.depth_share) > 0.0
    assert gain(explained, velocity_mm_s=1.5 * option.velocity_mm_s) > 0.0
    assert gain(explained, circumstance="at 10 K more", temperature_C=33.0) > 0.0


def test_of_a_press_that_was_never_taken_back_only_the_way_back_is_new(explained):
    """It counts, and no more than the whole press would under other circumstances."""
    back = gain(explained, unloading=True)
    assert 0.0 < back < gain(explained, unloading=True, circumstance="again")


def test_a_press_made_once_may_be_made_again(explained, monkeypatch):
    monkeypatch.setattr(planning, "MADE", 3)
    assert gain(explained) > 0.0
