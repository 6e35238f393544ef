"""Contact that is not at zero: found per press, counted in the intervals, and proposed where it explains a residual."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.accuracy.fit_coverage import DAMPER, GAMMA, GAMMA1, TRUTH, press
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.fit import _chosen, fit_traces
from tests.support.refusal import raises_code

SIX = [(v, f) for v in (10.0, 250.0) for f in (5.0, 10.0, 15.0)]


def presses(late, truth=TRUTH, white_N=0.03):
    """Six presses whose zero lies ``late`` mm deeper than where the punch touched."""
    made = []
    for number, ((speed, force), off) in enumerate(zip(SIX, late)):
        one = press(speed, np.cbrt(force / GAMMA1), truth=truth)
        noise = np.random.default_rng(number).normal(size=len(one.time_s)) * white_N
        made.append(Trace(f"p{number}.csv", one.time_s, one.displacement_mm - off, one.force_N + noise))
    return made


def said(fit, code):
    return [one["message"] for one in fit.result["warnings"] if one["code"] == code]


@pytest.mark.slow
@pytest.mark.parametrize("late", [(0.5,) * 6, (0.5, 0.3, 0.0, 0.4, -0.2, 0.1)])
def test_contact_half_a_millimetre_late_is_warned_of_and_with_offsets_the_parameters_come_back(late):
    without = fit_traces(presses(late), 5)
    gamma1 = without.result["parameters"]["gamma1_N_per_mm3"]
    assert not gamma1["low"] < GAMMA1 < gamma1["high"]
    proposal = said(without, "contact_offsets")
    assert len(proposal) == 1 and "--contact per-press" in proposal[0] and "before its zero" in proposal[0]
    proposed = without.result["proposed_contact_offsets"]
    assert [row["value_mm"] for row in proposed] == pytest.approx(late, abs=0.005)
    fit = fit_traces(presses(late), 5, contact="per-press")
    for true, row in zip(late, fit.result["contact_offsets"]):
        spread = (row["high_mm"] - row["low_mm"]) / 3.92
        assert abs(row["value_mm"] - true) < 3.5 * spread and spread < 0.002
    for true, entry in zip(TRUTH, fit.result["parameters"].values()):
        spread = (entry["high"] - entry["low"]) / 3.92
        assert abs(entry["value"] - true) < 3.5 * spread and entry["value"] == pytest.approx(true, rel=0.01)
    assert not said(fit, "contact_offsets") and not said(fit, "lack_of_fit")


@pytest.mark.slow
def test_intervals_count_the_offsets_as_unknown():
    known = fit_traces(presses((0.0,) * 6), 5)
    free = fit_traces(presses((0.0,) * 6), 5, contact="per-press")
    widths = [
        fit.result["parameters"]["gamma1_N_per_mm3"]["high"] - fit.result["parameters"]["gamma1_N_per_mm3"]["low"]
        for fit in (known, free)
    ]
    assert widths[1] > 1.5 * widths[0]
    assert (
        all(row["low_mm"] < 0.0 < row["high_mm"] for row in free.result["contact_offsets"])
        or max(abs(row["value_mm"]) for row in free.result["contact_offsets"]) < 0.005
    )
    assert "proposed_contact_offsets" not in known.result and not said(known, "contact_offsets")


@pytest.mark.slow
def test_what_offsets_do_not_explain_is_not_blamed_on_them():
    """A flat pad's force is linear in depth: no shift of the zero makes it a cubic law's."""
    made = []
    for one in presses((0.0,) * 6):
        depth = np.maximum(one.displacement_mm, 0.0)
        noise = np.random.default_rng(1).normal(size=len(depth)) * 0.03
        made.append(replace(one, force_N=3.0 * depth + noise))
    fit = fit_traces(made, 3)
    assert said(fit, "lack_of_fit") and not said(fit, "contact_offsets")
    forced = fit_traces(made, 3, intervals=False, contact="per-press")
    assert said(forced, "contact_at_end") and said(forced, "lack_of_fit")


@pytest.mark.slow
def test_the_mode_that_suits_the_data_is_per_speed_where_speeds_differ():
    slow, fast = np.r_[GAMMA1, GAMMA, 3 * DAMPER], TRUTH
    both = [*presses((0.0,) * 6, slow)[:3], *presses((0.0,) * 6, fast)[3:]]
    fit = fit_traces(both, 5, mode="auto", intervals=False)
    assert fit.mode == fit.result["mode"] == "per-speed" and not said(fit, "lack_of_fit")
    assert fit.result["parameters"]["c3_N_s_per_mm"]["10"]["value"] == pytest.approx(3 * DAMPER[1], rel=0.03)
    assert fit_traces(both[:3], 5, mode="auto", intervals=False).mode == "joint"


def test_elements_auto_never_takes_what_predicts_left_out_presses_worse():
    def table(*rows):
        return {str(n): {"aicc": aicc, "heldout_rmse_N": out} for n, (aicc, out) in zip((3, 5, 7), rows)}

    assert _chosen(table((500, 0.5), (100, 0.10), (50, 0.12))) == 5
    assert _chosen(table((500, 0.5), (100, 0.10), (50, 0.1004))) == 7
    assert _chosen(table((100, 0.1), (99, 0.1), (98, 0.1))) == 3
    assert _chosen(table((100, 0.10), (50, 0.20), (40, 0.30))) == 3
    assert _chosen(table((100, 0.10), (98, 0.09), (97, 0.08))) == 3
    assert _chosen(table((500, None), (100, None), (50, None))) == 7


def test_an_unknown_contact_is_refused():
    with raises_code("unknown_name", "contact"):
        fit_traces(presses((0.0,) * 6)[:1], 5, contact="all")
