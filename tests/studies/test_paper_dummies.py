"""The study of the paper's dummies: presses, fits and verdicts behave as their definitions say."""

import math

import numpy as np
import pytest

from dummydesign.design.scoring.press_simulation import make_curves
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.tissue.model.tissue_file import load_tissue
from studies.paper_dummies import dummies
from studies.paper_dummies import presses as study
from studies.paper_dummies.in_time import bow, half_time_s
from studies.paper_dummies.statements import statements
from studies.paper_dummies.study import main
from studies.paper_dummies.tables import needed_exponents, verdict
from tests.support.exact_law import ExactLaw
from tests.support.refusal import raises_code

PRONY = (PronyTerm(0.05, 0.8), PronyTerm(1.0, 0.3))


class CubicLaw(ExactLaw):
    """Force E a d (d / h)^2 C: a slab that follows the tissue's own law."""

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        depth, thickness = np.asarray(depth_mm, float), np.asarray(thickness_mm, float)
        return 100.0 * np.asarray(young_MPa) * radius_mm * depth**3 / thickness**2

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.9 * np.asarray(thickness_mm, float)


def test_a_press_ends_its_hold_at_the_wanted_force_and_agrees_with_the_pad_model():
    from dummydesign.measurement.motion import ramp_and_hold
    from dummydesign.pad.pad_under_punch import Pad
    from dummydesign.pad.predict import predict_motion

    law = study.force_laws([])["bonded", 0.0]
    dummy = study.press_dummy("III", law, 0.025, PRONY)
    pad = Pad(5.0, 0.025, dummies.RADIUS_MM, PRONY, sides_mm=(14.0, 14.0))
    for speed in dummies.VELOCITIES_MM_S:
        press = dummy.presses[10.0, speed]
        assert press.force_N[-1] == pytest.approx(10.0, rel=1e-4)
        other = predict_motion(pad, ramp_and_hold(speed, press.depth_mm))
        assert press.peak_N == pytest.approx(other.peak_force_N, rel=2e-3)
        assert press.force_N[-1] == pytest.approx(other.steady_force_N, rel=2e-3)


def test_a_slab_with_the_exponent_of_tissue_keeps_its_place_and_never_enters():
    tissue = load_tissue("palm")
    gamma1 = 2.0 * max(p.gamma1_N_per_mm3 for p in tissue.parameter_sets)
    young = gamma1 * 15.0**2 / (100.0 * dummies.RADIUS_MM)
    dummy = study.press_dummy("I", CubicLaw(), young, (), only_steady=True)
    assert dummy.exponent() == pytest.approx(3.0, abs=0.01)
    assert dummy.position_at(5.0) == pytest.approx(dummy.position_at(15.0), abs=0.01)
    assert math.isnan(dummy.crossing_N)
    judged = {
        said.words: said.judge({"I": dummy})[0] for said in statements() if said.dummy == "I" and said.steady_curve
    }
    assert len(judged) == 3 and not any(judged.values())


def test_a_power_law_through_the_needed_exponent_meets_the_wanted_place():
    dummy = study.press_dummy("I", CubicLaw(), 0.05, (), only_steady=True)
    middle, low, high = needed_exponents(dummy, "I")
    start = dummy.tissue.steady_depth_range([5.0])[0][0]
    stiff, soft = (edge[0] for edge in dummy.tissue.steady_depth_range([10.0]))
    depth = start * 2.0 ** (1.0 / middle)
    assert (soft - depth) / (soft - stiff) == pytest.approx(0.5)
    assert low < middle < high


@pytest.mark.slow
def test_the_fit_is_that_of_the_command_fit():
    from dummydesign.tissue.fitting.fit import fit_traces

    dummy = study.press_dummy("III", study.force_laws([])["bonded", 0.0], 0.025, PRONY)
    traces = [press.trace for press in dummy.presses.values()]
    found = fit_traces(traces, 5, dummy.tissue.law, "per-speed", intervals=False).result
    own = dummy.parameters.to_dict()
    for name, entry in found["parameters"].items():
        if "value" in entry:
            assert own[name] == pytest.approx(entry["value"], rel=1e-6)
        else:
            assert own[name] == pytest.approx({speed: one["value"] for speed, one in entry.items()}, rel=1e-6)
    assert dummy.rmse_N == pytest.approx(found["rmse_N"])


def test_an_exponential_has_its_half_time_and_a_straight_rise_no_bow():
    time = np.linspace(0.0, 10.0, 20001)
    assert half_time_s(time, 4.0 + 3.0 * np.exp(-time / 0.2)) == pytest.approx(0.2 * math.log(2.0), rel=1e-3)
    assert bow(time, time, 2.0) == pytest.approx(0.0, abs=1e-9)
    assert bow(time, np.sqrt(time), 2.0) == pytest.approx(2.0 / 3.0 - 0.5, abs=1e-3)
    assert bow(time, time**2, 2.0) < 0.0


def test_an_arm_much_slower_than_the_rise_adds_its_full_strength_and_a_fast_one_next_to_nothing():
    curves = make_curves(study.force_laws([])["bonded", 0.0], 5.0, dummies.RADIUS_MM, 0.6)
    weights = study.arm_weights(curves, 0.025)
    for speed in dummies.VELOCITIES_MM_S:
        assert np.all(np.diff(weights[speed]) > 0)
        assert weights[speed][-1] == pytest.approx(1.0, abs=0.02)
    assert weights[10.0][0] < 0.03
    assert study.arm_weights(curves, 0.001) == {}


def test_a_verdict_says_where_a_statement_holds():
    neo, stiff = dummies.Variant("sliding"), dummies.Variant("bonded", 25.0, 0.1)

    def of(first, second, third):
        return verdict({dummies.REFERENCE: (first, ""), neo: (second, ""), stiff: (third, "")})

    assert of(True, False, False) == "agrees"
    assert of(None, True, False) == of(False, True, True) == "disagrees"
    assert of(False, None, True) == "cannot be reproduced by a neo-Hookean resin"
    assert of(False, None, False) == "cannot be reproduced"


def test_the_command_refuses_a_folder_without_the_page(tmp_path):
    with raises_code("missing", "page"):
        main(["--repository", str(tmp_path)])
    assert not list(tmp_path.iterdir())


def test_a_steady_curve_is_judged_below_and_above_5_newtons_apart():
    force = dummies.STEADY_GRID_N
    cubic = np.cbrt(force / 0.1)
    linear = np.cbrt(10.0 / 0.1) * force / 10.0
    curves = np.stack([cubic, linear, np.full(146, np.nan)])
    shares = dummies.inside_shares(curves, np.cbrt(force / 0.2), np.cbrt(force / 0.05))
    assert shares["inside_fraction"][0] == 1.0 and shares["inside_fraction"][2] == 0.0
    # the line through the cubic at 10 N leaves the range where F/10 = (F/10 * 0.1/0.2)^(1/3), at 10/sqrt(2) N
    inside = force >= 10 / np.sqrt(2)
    inside &= force <= 10 * np.sqrt(2)
    assert shares["inside_fraction"][1] == pytest.approx(inside.mean(), abs=0.01)
    assert shares["below_5N_fraction"][1] == 0.0
    assert shares["above_5N_fraction"][1] == pytest.approx(inside[force >= 5].mean(), abs=0.01)
