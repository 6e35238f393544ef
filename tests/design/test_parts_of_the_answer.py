"""Parts of an answer on stand-ins: conditions, verification, warnings, words of the verdict, limits of numbers."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.parsing import command_words
from dummydesign.design import measured_pad, suggest, suggestion
from dummydesign.design.assessment import warnings
from dummydesign.design.assessment.pad_castings import limits_that_bind
from dummydesign.design.measured_pad import PARABOLA, energy_of, peak_of
from dummydesign.design.request import NAGOYA_PROTOCOL, Request
from dummydesign.design.scoring.castings import Pours
from dummydesign.design.scoring.press_simulation import SAMPLES, PadBatch, SlabCurves
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import ReadingCorrection, _ending, _reading_words, deviations, whole_percents
from dummydesign.design.search.slabs import DesignCandidate
from dummydesign.design.suggest import centring_tolerance, of_shape, verify_design
from dummydesign.design.suggestion import LOSS_PERCENT, CentringTolerance, _low_force, _reads, condition_rows
from dummydesign.design.test_conditions import LEAST_SIDE, check_numbers
from dummydesign.pad.axisymmetric.shaped_problem import Touch
from tests.support.cast_pads import poured_slabs
from tests.support.judged_pads import away, ranges
from tests.support.refusal import raises_code


def test_a_peak_reads_low_or_high_from_one_per_cent_beyond_the_subjects_on():
    assert _reads(None, 8.0, 12.0) == (None, None)
    for peak, told in ((8.0 / 1.009, "inside"), (8.0 / 1.011, "low"), (12.0 * 1.009, "inside"), (12.0 * 1.011, "high")):
        assert _reads(peak, 8.0, 12.0)[0] == told
    assert _reads(6.0, 8.0, 12.0)[1] == pytest.approx(25.0) and _reads(15.0, 8.0, 12.0)[1] == pytest.approx(25.0)
    assert _reads(10.0, 8.0, 12.0) == ("inside", 0.0)


def pressed_candidate(depths=(1.0, np.nan)):
    curves = SlabCurves(np.array([10.0, 12.0]), np.array([4.0, 5.0]), np.zeros((2, SAMPLES)))
    slabs = PadBatch(curves, np.array([0, 1]), np.ones(2), (1.0,), np.ones((2, 1)))
    presses = tuple(SimpleNamespace(peak_N=np.array([99.0, peak])) for peak in (7.0, np.nan))
    evaluation = SimpleNamespace(slabs=slabs, depth_mm=np.array([[9.0, 9.0], depths]), presses=presses,
                                 inside=np.array([[0.0, 0.0], [0.75, 0.0]]))  # fmt: skip
    return DesignCandidate(12.0, 15.0, 1, evaluation)


def test_conditions_of_a_design_are_its_own_and_one_out_of_reach_says_why():
    bands = [
        SimpleNamespace(
            steady_force_N=force, velocity_mm_s=10.0, range=SimpleNamespace(peak_low_N=8.0, peak_high_N=12.0)
        )
        for force in (5.0, 15.0)
    ]
    rows = condition_rows(pressed_candidate(), SimpleNamespace(conditions=bands), SimpleNamespace(bone_height_mm=4.0))
    first, last = rows
    assert first["depth_over_thickness"] == pytest.approx(1.0 / 12.0)
    assert first["gel_compression"] == pytest.approx(1.0 / 8.0)
    assert first["peak_force_N"] == 7.0 and first["reads"] == "low" and first["inside_fraction"] == 0.75
    assert first["percent_outside"] == pytest.approx(12.5) and first["out_of_reach"] is None
    assert last["depth_mm"] is None and last["reads"] is None
    assert last["out_of_reach"].startswith("15 N steady needs more than 5.0 mm, 0.42 of the thickness")


def test_small_forces_are_shares_of_the_lowest_at_their_own_depths():
    grid = NAGOYA_PROTOCOL.low_grid_N
    evaluation = SimpleNamespace(low_depth_mm=np.array([0.0 * grid, 2.0 * grid]))
    targets = SimpleNamespace(protocol=NAGOYA_PROTOCOL, depth_range_mm=lambda force: (0.5 * force, 3.0 * force))
    rows = _low_force(SimpleNamespace(evaluation=evaluation, index=1), targets)
    for row in rows:
        assert 0.0 < row["force_N"] <= 5.0
        assert row["depth_mm"] == pytest.approx(2.0 * row["force_N"], rel=0.1)
        assert (row["tissue_depth_low_mm"], row["tissue_depth_high_mm"]) == pytest.approx(
            (0.5 * row["force_N"], 3.0 * row["force_N"])
        )


def test_a_verification_is_the_largest_difference_at_the_same_depths(monkeypatch):
    from dummydesign.pad import force_source

    def solved(pad, depth, independent):
        assert independent and depth.tolist() == sorted(depth)
        force = np.array([2.0, 4.2, 5.7])
        return SimpleNamespace(depth_mm=np.array(depth), force_N=force, notes=["n"])

    monkeypatch.setattr(force_source, "solve_points", solved)
    found = verify_design(None, [3.0, 1.0, 2.0], [6.0, 2.0, 4.0])
    assert found.max_difference_percent == pytest.approx(5.0) and found.table_force_N == (2.0, 4.0, 6.0)
    assert found.depth_mm == (1.0, 2.0, 3.0) and found.solved_force_N == (2.0, 4.2, 5.7) and found.notes == ("n",)

    def fails(*given, **more):
        raise NoAnswerError("no_convergence", "stopped")

    monkeypatch.setattr(force_source, "solve_points", fails)
    assert verify_design(None, [1.0], [1.0]).max_difference_percent is None
    table = SimpleNamespace(force=lambda d, h, young, radius: 2.0 * d, shape=SimpleNamespace(fidelity="axisymmetric"))
    law = SimpleNamespace(
        table=table, depth_mm=np.array([1.0, 2.0]), thickness_mm=10.0, log_factor=np.log([0.9, 1.05]), end=""
    )
    own = of_shape(law, 0.03, 7.9)
    assert own.max_difference_percent == pytest.approx(10.0) and own.solved_force_N == pytest.approx((1.8, 4.2))


def test_only_slow_depths_that_the_circle_reaches_are_verified(monkeypatch):
    class Law:
        def force(self, depth, thickness, young, radius):
            return 2.0 * np.asarray(depth)

        def depth_limit_mm(self, thickness, radius):
            return 0.25 * np.asarray(thickness)

        def gel_mm(self, thickness):
            return np.asarray(thickness)

    asked = []
    monkeypatch.setattr(suggest, "circle_of", lambda law: Law())
    monkeypatch.setattr(suggest, "pad_of_request", lambda request, punch, *given: given)
    monkeypatch.setattr(suggest, "verify_design", lambda *given: asked.append(given))
    depth = np.array([[9.0] * 6, [1.0, np.nan, 2.6, 1.0, 2.0, 2.4]])
    best = DesignCandidate(10.0, 15.0, 1, SimpleNamespace(depth_mm=depth))
    from dummydesign.geometry.shapes.slab import Slab

    chosen = SimpleNamespace(cast=None, shape=Slab())
    space = SimpleNamespace(
        resin=SimpleNamespace(young_MPa=lambda ratio: 0.5),
        radius_mm=7.9,
        targets=SimpleNamespace(protocol=NAGOYA_PROTOCOL, limits=verdict_limits()),
    )
    suggest._verify(chosen, best, SimpleNamespace(**vars(space), request=None, punch=None))
    pad, depths, forces = asked[0]
    assert pad == (10.0, 0.5)
    np.testing.assert_allclose(depths, [1.0])
    np.testing.assert_allclose(forces, [1.0])


def test_the_way_a_punch_may_be_moved_is_to_the_side_of_the_contact():
    depth = np.linspace(0.0, 4.0, SAMPLES)
    curves = SlabCurves(np.array([10.0]), np.array([4.0]), 10.0 * depth[None])
    slabs = PadBatch(curves, np.array([0]), np.array([0.5]), (1.0,), np.ones((1, 1)))
    best = DesignCandidate(10.0, 15.0, 0, SimpleNamespace(slabs=slabs))
    crown = SimpleNamespace(flat_top=False, axisymmetric=True)
    touch = Touch(np.linspace(0.0, 4.0, 9), 2.0 * np.linspace(0.0, 4.0, 9))
    found = centring_tolerance(best, crown, 7.9, 7.0, (5.0, 15.0, 18.0, 30.0), touch=touch)
    # 5 N at 1 mm touch 2 mm: 5 mm are left; beyond the curve nothing is known
    assert found.contact_radius_mm[0] == pytest.approx(2.0, abs=0.05)
    assert found.margin_mm[0] == pytest.approx(5.0, abs=0.05) and found.margin_mm[1] == pytest.approx(1.0, abs=0.05)
    assert found.margin_mm[2] == 0.0 and found.margin_mm[3] is None
    assert "5.0 mm at 5 N" in found.text and f"at 18 N the force falls by at most {LOSS_PERCENT:g} %" in found.text
    assert centring_tolerance(best, SimpleNamespace(flat_top=True, axisymmetric=True), 7.9, 7.0) is None
    assert centring_tolerance(best, SimpleNamespace(flat_top=False, axisymmetric=False), 7.9, 7.0) is None
    for margin, free in ((0.051, True), (0.049, False)):
        text = CentringTolerance((5.0,), (1.0,), (margin,)).text
        assert ("no effect within" in text) is free and ("falls by" in text) is not free


def trace(force, time, contact_s=0.0, stop_s=1.0, x=None):
    """Without ``x`` the punch brakes all the way to 1 mm at 1 s."""
    x = 1.0 - np.maximum(1.0 - time, 0.0) ** 2 if x is None else x
    inside, depth_mm = np.ones(len(time), bool), float(x.max())
    ramp = {"contact_time_s": contact_s, "stop_time_s": stop_s, "hold_end_s": time[-1], "overshoot_mm": 0.0}
    return SimpleNamespace(
        trace=SimpleNamespace(force_N=force, time_s=time, displacement_mm=x),
        inside=inside,
        ramp=SimpleNamespace(**ramp, depth_mm=depth_mm),
    )


def test_a_peak_is_that_of_a_parabola_and_noise_does_not_raise_it():
    time = np.linspace(0.0, 2.0, 201)
    smooth = 10.0 - 4.0 * (time - 1.0) ** 2
    assert peak_of(trace(smooth, time)) == pytest.approx(10.0, abs=1e-9)
    assert PARABOLA.sum() == pytest.approx(1.0) and PARABOLA @ np.arange(-2, 3) ** 2 == pytest.approx(0.0, abs=1e-12)
    chance = np.random.default_rng(1)
    found = [peak_of(trace(smooth + 0.05 * chance.normal(size=201), time), 0.05) for _ in range(200)]
    assert np.mean(found) == pytest.approx(10.0, abs=0.05)
    # few samples in the rise, or uneven ones: the sample itself
    few = np.linspace(0.0, 2.0, 30)
    spike = np.where(np.arange(30) == 20, 12.0, 5.0)
    assert peak_of(trace(spike, few), 0.05) == 12.0
    uneven = np.r_[np.linspace(0.0, 1.0, 100), 1.05, 1.2, np.linspace(1.3, 2.0, 50)]
    high = np.where(np.isclose(uneven, 1.2), 12.0, 5.0)
    assert peak_of(trace(high, uneven), 0.05) == pytest.approx(12.0 - 1.5 * 0.05)


@pytest.mark.parametrize(("samples", "noise_N"), [(20, 0.0), (40, 0.005), (400, 0.02)])
def test_the_peak_at_an_abrupt_stop_is_that_of_the_law_however_few_samples_show_it(samples, noise_N):
    """Elastic and one arm in a ramp of 10 mm/s: k d + b v T (1 - exp(-t_p / T)), between two samples (v T arm)."""
    depth_mm, speed, k, b, tau = 3.0, 10.0, 2.0, 3.0, 0.05
    stop_s, chance, found = depth_mm / speed, np.random.default_rng(5), []
    peak_N = k * depth_mm + b * speed * tau * -np.expm1(-stop_s / tau)
    for _ in range(40):
        time = np.arange(-5, 20 * samples) * stop_s / samples + chance.uniform(0.0, stop_s / samples)
        rise = np.clip(time, 0.0, stop_s)
        arm = b * speed * tau * -np.expm1(-rise / tau) * np.exp(-np.maximum(time - stop_s, 0.0) / tau)
        force = k * speed * rise + arm + noise_N * chance.standard_normal(len(time))
        found.append(peak_of(trace(force, time, stop_s=stop_s, x=speed * np.minimum(time, stop_s)), noise_N))
    assert np.mean(found) == pytest.approx(peak_N, rel=1e-3) and np.std(found) < 0.004 * peak_N


def test_a_peak_within_a_braking_that_is_seen_is_not_extrapolated():
    """Ten samples in the braking; the end of the rise points higher than the force goes."""
    time = np.linspace(0.0, 3.0, 3001)
    left = np.maximum(1.0 - time, 0.0)
    x = np.where(left > 0.01, 1.0 - 0.005 - (left - 0.01), 1.0 - 50.0 * left**2)
    rate = np.gradient(x, time)
    found = peak_of(trace(4.0 * x + 2.0 * rate, time, x=x))
    assert found == pytest.approx(float((4.0 * x + 2.0 * rate).max()), rel=5e-3)


def test_energy_is_from_contact_to_the_end_of_the_hold():
    time = np.linspace(-0.5, 3.0, 701)
    x = np.clip(time, -0.5, 1.0)
    found = energy_of(trace(np.maximum(4.0 * x, 0.0), time, stop_s=0.9, x=x))
    assert found == pytest.approx(2.0, rel=1e-3)


def test_readings_of_repeats_are_averaged_and_their_scatter_is_over_the_lowest_subject(monkeypatch):
    peaks, energies = {1: 11.0, 2: 13.0}, {1: 5.0, 2: 7.0}
    monkeypatch.setattr(measured_pad, "peak_of", lambda one, noise: peaks[one.name])
    monkeypatch.setattr(measured_pad, "energy_of", lambda one: energies[one.name])
    asked = []

    def press(bands, law, sampling):
        asked.append(sampling)
        return [np.array([3.0, 9.0]) * band.scale for band in bands]

    monkeypatch.setattr(measured_pad, "energies_of", press)

    def pair(name, low, scale):
        band = SimpleNamespace(peak_low_N=low, peak_high_N=2.0 * low, scale=scale, energy_mJ=None)
        return SimpleNamespace(name=name, hold_s=7.0, steady_force_N=5.0 + name), band, 1234.0

    pressed = [measured_pad.ComparedPress(*pair(*one)) for one in ((1, 10.0, 1.0), (2, 12.0, 2.0))]
    row = measured_pad._press(pressed, SimpleNamespace(law="x"), 250.0, 0.3)
    force, speed, low, high, least, most, peak, error, energy = row
    assert (force, speed, low, high) == (6.5, 250.0, 11.0, 22.0) and (least, most) == (4.5, 13.5)
    assert (peak, energy) == (12.0, 6.0) and asked[0].hold_s == 7.0 and asked[0].deceleration_mm_s2 == 1234.0
    scatter = np.std([1.1, 13.0 / 12.0], ddof=1) * 11.0
    assert error == pytest.approx(np.hypot(0.3, scatter) / np.sqrt(2.0))
    alone = measured_pad._press(pressed[:1], SimpleNamespace(law="x"), 250.0, 0.3)
    assert alone[7] == pytest.approx(0.3)


@pytest.mark.parametrize(("kind", "factor"), [("measured", 1.15), ("fitted", 1.5)])
def test_speeds_far_from_those_of_the_subjects_are_named(monkeypatch, kind, factor):
    monkeypatch.setattr(warnings, "law_named", lambda law: SimpleNamespace(fitted=True))
    for speed, far in (
        (10.0 * factor * 0.99, False),
        (10.0 * factor * 1.01, True),
        (10.0 / factor * 1.01, False),
        (10.0 / factor * 0.99, True),
        (250.0, False),
    ):
        tissue = SimpleNamespace(
            notice=None, measured=kind == "measured", velocities_mm_s=(10.0, 250.0), name="t", law=""
        )
        space = SimpleNamespace(targets=SimpleNamespace(conditions=[SimpleNamespace(velocity_mm_s=speed)]))
        told = warnings._of_speeds(space, tissue)
        assert bool(told) is far
        if far:
            assert told[0][0] == "speed_not_in_band" and f"{speed:g} mm/s" in told[0][1]


def chosen_of(low=0.9, depths=(1.0, 2.0), thickness=10.0, ratio=15.0, flat=True):
    """A design and its pad."""
    evaluation = SimpleNamespace(depth_mm=np.array([[9.0, 9.0], depths]), low_force_range=np.array([0.0, low]))
    chosen = SimpleNamespace(shape=SimpleNamespace(flat_top=flat, plain=True), law=SimpleNamespace(notes=()))
    return chosen, DesignCandidate(thickness, ratio, 1, evaluation)


RESIN = SimpleNamespace(name="toy", ratio_min=14.0, ratio_max=16.0, young_MPa=lambda ratio: 0.01 * ratio)
SPACE = SimpleNamespace(
    resin=RESIN,
    targets=SimpleNamespace(protocol=NAGOYA_PROTOCOL, conditions=[SimpleNamespace(steady_force_N=f, velocity_mm_s=v)
                                                        for f, v in ((5.0, 10.0), (15.0, 250.0))]),
    thickness_mm=np.array([8.0, 10.0, 12.0]), ratio=np.array([14.0, 15.0, 16.0]), allowed_mm=(3.0, 30.0),
)  # fmt: skip


def test_forces_out_of_reach_and_a_stiff_start_are_named():
    assert warnings._of_forces(*chosen_of(), 1, SPACE) == []
    ((code, text),) = warnings._of_forces(*chosen_of(depths=(1.0, np.nan)), 1, SPACE)
    assert code == "out_of_reach" and text.startswith("15 N at 250 mm/s")
    for low, stiff in ((0.49, True), (0.51, False)):
        told = warnings._of_forces(*chosen_of(low=low), 1, SPACE)
        assert bool(told) is stiff
    assert "49 %" in warnings._of_forces(*chosen_of(low=0.49), 1, SPACE)[0][1]
    assert "--shape auto" in warnings._why_stiff(chosen_of()[0], 1)
    assert "--shape auto" not in warnings._why_stiff(chosen_of()[0], 2)


def test_designs_at_an_end_of_the_range_are_named():
    assert warnings._edges(chosen_of()[1], SPACE) == []
    for thickness, ratio, named in (
        (8.0, 15.0, "thickness"),
        (12.0, 15.0, "thickness"),
        (10.0, 14.0, "ratio"),
        (10.0, 16.0, "ratio"),
    ):
        ((code, text),) = warnings._edges(chosen_of(thickness=thickness, ratio=ratio)[1], SPACE)
        assert code == "at_edge" and named in text
    single = SimpleNamespace(thickness_mm=np.array([10.0]), ratio=np.array([15.0]), resin=RESIN, allowed_mm=(3.0, 30.0))
    assert warnings._edges(chosen_of()[1], single) == []


def test_kinds_without_a_design_share_a_line_where_they_share_the_reason():
    rows = [
        SimpleNamespace(kind=kind, reason=reason)
        for kind, reason in (
            ("boned", "boned pads are designed on a glued base only"),
            ("layered", "layered pads are designed on a glued base only"),
            ("crowned", "no crowned pad reaches"),
            ("slab", ""),
        )
    ]
    assert warnings._reasons(rows) == [
        "boned, layered pads are designed on a glued base only",
        "no crowned pad reaches",
    ]


def warned(monkeypatch, off=None, share=0.9, people=3, judged=(5.0, 10.0, 15.0), plain=True, verify=True):
    monkeypatch.setattr(warnings, "_of_speeds", lambda space, tissue: [])
    monkeypatch.setattr(warnings, "_of_data", lambda resin, tissue: [])
    chosen, best = chosen_of()
    chosen.shape.plain = plain
    space = SPACE
    pour = SimpleNamespace(yield_fraction=share, making_only_fraction=1.0, judged_at_N=judged)
    verification = SimpleNamespace(max_difference_percent=off, notes=("n",))
    tissue = SimpleNamespace(subjects=range(people), name="t")
    return [
        code for code, _ in warnings.design_warnings(chosen, best, (), space, tissue, pour, verification, None, verify)
    ]


def test_warnings_of_a_design_begin_where_their_limits_are(monkeypatch):
    assert warned(monkeypatch) == ["verification"] and warned(monkeypatch, verify=False) == []
    assert "table_error" in warned(monkeypatch, 1.01) and "table_error" not in warned(monkeypatch, 0.99)
    assert "table_error" not in warned(monkeypatch, 1.01, plain=False)
    assert "low_yield" in warned(monkeypatch, share=0.49) and "low_yield" not in warned(monkeypatch, share=0.51)
    assert "outside_steady_range" in warned(monkeypatch, judged=(5.0, 10.0))
    one = warned(monkeypatch, share=0.1, people=1, judged=())
    assert "one_subject" in one and not {"low_yield", "outside_steady_range"} & set(one)


@pytest.mark.parametrize(
    ("short", "over", "level", "first"),
    [
        (1.3, 1.2, "not_representative", "below"),
        (1.2, 1.3, "not_representative", "above"),
        (1.2, 1.3, "usable_with_correction", "below"),
    ],
)
def test_what_is_farther_off_comes_first_where_a_pad_is_not_representative(short, over, level, first):
    readings = away(short, over)
    text = _reading_words(deviations(ranges(), readings), readings, level)
    assert (text.index(" below ") < text.index(" above ")) is (first == "below")
    # of its own subject a reading is this share below, and above by this one
    assert f"{100.0 * (1.0 - 1.0 / short):.0f} % below" in text and f"{100.0 * (over - 1.0):.0f} % above" in text


def test_a_correction_is_said_for_what_needs_it():
    def said(force, every):
        return _ending("usable_with_correction", ReadingCorrection(every, every, None, force, force), "", False)

    assert said(1.0, 1.009).startswith("multiply readings by 1.00:") and "1.01" in said(1.0, 1.011)
    assert said(1.2, 1.2049) == "multiply readings by 1.20" and said(1.2, 1.2051) != "multiply readings by 1.21"
    assert said(1.009, 1.2) == "multiply energies by 1.20, forces by 1.00"
    assert said(1.011, 1.2) == "multiply forces by 1.01, energies by 1.20"
    assert said(None, 1.2) == "" and _ending("stands_for", ReadingCorrection(1.2, 1.2), "", True) == ""
    assert _ending("not_settled", ReadingCorrection(1.2, 1.2), "why", True) == "why"


def test_shares_are_rounded_so_that_they_keep_their_sum():
    chance = np.random.default_rng(1)
    for _ in range(50):
        shares = chance.dirichlet(np.ones(4))
        whole = whole_percents(shares.tolist())
        assert sum(whole) == 100 and np.abs(np.array(whole) - 100.0 * shares).max() < 1.0
        rest = whole_percents(shares[1:].tolist(), round(100.0 * shares[0]))
        assert sum(rest) == 100 - round(100.0 * shares[0]) and min(rest) >= 0


def test_numbers_of_a_test_are_refused_beyond_their_ends():
    check_numbers((0.05, 300.0), (0.1, 5000.0), 3600.0)
    check_numbers(tuple(np.linspace(1.0, 8.0, 8)), None, 0.05)
    for force, speed, hold in (
        ((0.049,), None, None),
        ((301.0,), None, None),
        (None, (0.09,), None),
        (None, (5001.0,), None),
        (None, None, 0.049),
        (None, None, 3601.0),
        ((np.nan,), None, None),
    ):
        with raises_code("out_of_range"):
            check_numbers(force, speed, hold)
    with raises_code("too_large"):
        check_numbers(tuple(np.linspace(1.0, 9.0, 9)), None, None)
    with raises_code("missing"):
        check_numbers((), None, None)
    assert LEAST_SIDE > 1.0


def options(**given):
    return Request.read(tissue="palm", **given)


def test_what_was_asked_is_typed_again():
    words = command_words(Request, vars(options(force_N="5,10", pad="60x50")), ["force_N", "pad_mm", "hold_s"])
    assert words == " --force 5,10 --pad 60x50"


def test_castings_are_at_the_nearest_of_even_steps_and_held_to_the_law():
    class Law:
        ratio_range = (0.5, 1.0)

        def force(self, depth, thickness, young, radius):
            return np.asarray(thickness) * np.asarray(depth)

        def depth_limit_mm(self, thickness, radius):
            return 0.5 * np.asarray(thickness)

        def gel_mm(self, thickness):
            return np.asarray(thickness)

    targets = SimpleNamespace(limits=verdict_limits())
    space = SimpleNamespace(radius_mm=8.0, resin=SimpleNamespace(tau_s=(0.3,), pressed_force=None), targets=targets)
    thickness = np.array([9.8, 10.2, 10.0, 9.913])
    made = poured_slabs(Law(), Pours(thickness, np.ones(4), np.ones((4, 1)), np.zeros(4)), space)
    assert np.abs(made.thickness_mm - thickness).max() <= 0.5 * 0.01 + 1e-9 and made.tau_s == (0.3,)
    assert len(made.curves.thickness_mm) == 41 and np.diff(made.curves.thickness_mm) == pytest.approx(0.01)
    held = poured_slabs(Law(), Pours(np.array([5.0, 30.0, 12.0]), np.ones(3), np.ones((3, 1)), np.zeros(3)), space)
    np.testing.assert_allclose(held.thickness_mm, [8.0, 16.0, 12.0], atol=0.11)
    one = poured_slabs(Law(), Pours(np.array([10.0, 10.0]), np.ones(2), np.ones((2, 1)), np.zeros(2)), space)
    assert one.thickness_mm.tolist() == [10.0, 10.0] and len(one.curves.thickness_mm) == 1


def test_limits_bind_where_a_design_lies_at_them():
    curves = SlabCurves(np.array([12.0, 10.0]), np.array([9.0, 5.0]), np.zeros((2, 3)))
    slabs = PadBatch(curves, np.array([0, 1]), np.ones(2), (), np.ones((2, 0)))

    def bound(depth, thickness=10.0, ratio=15.0):
        evaluation = SimpleNamespace(depth_mm=np.array([[1.0, 1.0], [1.0, depth]]), slabs=slabs)
        one = DesignCandidate(thickness, ratio, 1, evaluation)
        return limits_that_bind(one, SPACE.thickness_mm, SPACE.ratio)

    assert bound(4.94) == () and bound(4.96) == ("depth over thickness (at most 0.50)",) and len(bound(np.nan)) == 1
    assert bound(1.0, thickness=8.0) == ("thickness (8 to 12 mm)",) and bound(1.0, ratio=16.0) == ("ratio (14 to 16)",)


def test_the_limits_that_come_with_the_package_rise_from_green_to_amber():
    found = verdict_limits()
    assert 1.0 < found.stands_shortfall <= found.shortfall
    assert found.stands_over <= found.over and 0.5 < found.share < 1.0 and found.beyond_people > 1.0


def test_a_mould_that_fails_leaves_the_recipe_and_says_what_to_type(monkeypatch):
    from dummydesign.mold import client

    @dataclass(frozen=True)
    class Poured:
        usable_kPa: tuple[float, ...] = ()

    @dataclass(frozen=True)
    class Mould:
        pour: Poured

    made = []

    def fails(spec, folder):
        made.append(spec)
        raise NoAnswerError("no_convergence", "stopped")

    monkeypatch.setattr(client, "make_mold", fails)
    request = SimpleNamespace(resin="r", pad_mm=(60.0, 50.0), preset="lidded")
    problem = SimpleNamespace(mould=lambda best: Mould(Poured()))
    best, shares = SimpleNamespace(thickness_mm=9.0, ratio=15.5), SimpleNamespace(window_kPa=(20.0, 60.0))
    answer = SimpleNamespace(best=best, request=request, problem=problem, shape="slab", shares=shares)
    answer.mould_command = suggestion.Suggestion.mould_command.fget(answer)
    with pytest.raises(NoAnswerError) as caught:
        suggestion.make_mould(answer, None)
    assert made == [Mould(Poured((20.0, 60.0)))], "the sheet's limit is the answer's window"
    words = "--thickness 9 --resin r --ratio 15.5 --shape slab --length 60 --width 50 --preset lidded"
    assert words in str(caught.value)
