"""The presses that the loop considers as the next measurement."""

from __future__ import annotations

from functools import partial

import numpy as np

from dummydesign.loop import next_measurement as planning
from dummydesign.measurement.motion import ramp_and_hold


def test_a_planned_press_stops_where_its_hold_begins_however_finely_the_motion_is_sampled(plain, monkeypatch):
    presses, law = plain
    chosen = planning.options(presses, law)[:6]
    usual = planning.planned_presses(presses, None, chosen)
    monkeypatch.setattr(planning, "ramp_and_hold", partial(ramp_and_hold, hold_points=20))
    coarse = planning.planned_presses(presses, None, chosen)
    np.testing.assert_allclose(coarse.stop_s, usual.stop_s, atol=1e-9)
    for made in (usual, coarse):
        np.testing.assert_allclose(made.hold_end_s - made.stop_s, planning.HOLD_S, atol=0.05)
