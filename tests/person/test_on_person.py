"""Intervals, limits, signs of the drive, ranges, and the agreement with the verdict of `compare`."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.trace import Trace
from dummydesign.person import integrate
from dummydesign.person.drives import read_drive
from dummydesign.person.drives.drive import signs_of
from dummydesign.person.limits import ContactLoad, against_guarded_limits, decide, read_limits
from dummydesign.person.on_person import on_person
from dummydesign.person.people import draw_another, log_parameters
from dummydesign.person.press import read_press
from dummydesign.tissue import load_tissue
from tests.support.robot_presses import (
    Run,
    braking_command,
    by_mass,
    by_path,
    command,
    gel_pad,
    linear_body,
    sampled,
    skin_of,
)

TISSUE = load_tissue("forefinger")


def press(velocity=100.0, depth=1.4, hold=3.0, rounding_s=None, **more):
    path, speed, end = command(velocity, depth, hold, rounding_s or 0.1 * depth / velocity)
    return sampled(by_path(gel_pad(), path, speed, end, -0.6 / velocity, 20001), **more)


def crept(hold=3.0):
    """A clamp that keeps 10 N on a pad which creeps."""
    t = np.linspace(-0.1, hold, 20001)
    force = 10.0 * np.clip(t / 0.1, 0.0, 1.0)
    x = np.where(t < 0, 10.0 * t, 0.1 * force * (1.0 + 0.3 * (1.0 - np.exp(-np.maximum(t, 0) / 0.5))))
    return sampled(Run(t, x, force), noise_N=0.01, noise_mm=0.001)


def struck(mass=2.0, velocity=200.0):
    hit = by_mass(linear_body(15.0), velocity, mass)
    lead = np.linspace(-0.01, 0.0, 200)[:-1]
    back = slice(None, None, -1)
    t = np.r_[lead, hit.t, 2 * hit.t[-1] - hit.t[back][1:]]
    return sampled(
        Run(t, np.r_[velocity * lead, hit.x, hit.x[back][1:]], np.r_[0 * lead, hit.f, hit.f[back][1:]]),
        2000.0,
        noise_N=0.02,
        noise_mm=0.001,
    )


def braked(velocity, depth, hold, braking, **more):
    path, speed, end = braking_command(velocity, depth, hold, braking)
    return sampled(by_path(gel_pad(), path, speed, end, -0.6 / velocity, 20001), **more)


@pytest.mark.slow
@pytest.mark.parametrize("velocity", (10.0, 250.0))
def test_with_steady_the_lowest_subject_over_the_pad_is_the_shortfall_of_the_verdict(velocity):
    from dummydesign.design.measured_pad import verdict_of_traces
    from dummydesign.tissue.comparison import compare_traces

    # one braking, which the verdict assumes of every robot
    trace = braked(velocity, 1.8, 10.0, 1.2e5, rate_hz=2000.0, noise_N=0.01, noise_mm=0.001)
    compared = compare_traces([trace], TISSUE)
    judged = verdict_of_traces(compared, TISSUE).to_dict()
    found = on_person([trace], TISSUE, read_drive("steady")).presses[0]
    pad = found.pad["peak_N"]
    rows = judged["shortfall"], judged["over"]
    low, high = found.factor
    # the verdict's central figures count energies and the steady curve too: where the peak is the largest they agree
    assert (low, high) == pytest.approx(peak_factor(compared), rel=1e-2)
    assert rows[0]["central"] >= 0.99 * low and rows[1]["central"] >= 0.99 / high
    assert pad > 0


@pytest.mark.slow
def test_a_stop_that_is_rounded_is_followed_and_compared_as_one_braking():
    """Subjects' peaks by an own integrator along the very path of a robot whose braking rises and falls."""
    from scipy.optimize import brentq

    from dummydesign.tissue.comparison import compare_traces

    velocity, rounding_s = 250.0, 250.0 / (4.0 * 1.2e5)
    trace = press(velocity, 1.8, 10.0, rounding_s, rate_hz=2000.0, noise_N=0.01, noise_mm=0.001)
    found = on_person([trace], TISSUE, read_drive("steady")).presses[0]

    def pressed(one, depth):
        path, speed, end = command(velocity, depth, 10.0, rounding_s)
        return by_path(skin_of(one, velocity), path, speed, end, 0.0, 20001)

    def peak(one):
        depth = brentq(lambda d: pressed(one, d).f[-1] - found.pad["steady_N"], 1.0, 3.0, xtol=1e-4)
        return pressed(one, depth).peak

    peaks = [peak(one) for one in TISSUE.parameter_sets]
    assert found.band["peak_N"] == pytest.approx([min(peaks), max(peaks)], rel=5e-3)
    # one constant braking in place of the rounded one: up to 2 % too high
    _, band, _ = compare_traces([trace], TISSUE).presses[0]
    assert [band.peak_low_N, band.peak_high_N] == pytest.approx([min(peaks), max(peaks)], rel=2e-2)


def peak_factor(found):
    """Lowest and highest subject over the pad, as the verdict takes them from the same press."""
    from dummydesign.design.measured_pad import peak_of

    reduced, band, _ = found.presses[0]
    own = peak_of(reduced, float(found.fit.result["noise_floor_N"] or 0.0))
    return band.peak_low_N / own, band.peak_high_N / own


@pytest.mark.slow
def test_intervals_hold_the_band_and_grow_with_noise():
    plain = on_person([press(noise_N=0.01, noise_mm=0.001)], TISSUE, read_drive("position")).presses[0]
    for name in ("peak_N", "steady_N", "energy_mJ"):
        assert plain.interval[name][0] < plain.band[name][0] < plain.band[name][1] < plain.interval[name][1]
    forced = on_person([press(noise_N=0.01, noise_mm=0.001)], TISSUE, read_drive("force")).presses[0]
    loud = on_person([press(noise_N=0.3, noise_mm=0.001)], TISSUE, read_drive("force")).presses[0]
    width = [np.diff(one.interval["steady_N"])[0] for one in (forced, loud)]
    assert width[1] > 3.0 * width[0]


def test_one_more_person_is_student_s_prediction():
    """Of n subjects the ln of gamma1 of one more lies within t(0.975, n - 1) s sqrt(1 + 1 / n)."""
    from scipy.stats import t

    tissue = replace(TISSUE, origin="file")
    logs = np.log([one.gamma1_N_per_mm3 for one in tissue.parameter_sets])
    drawn = log_parameters(draw_another(tissue, 10.0, 200_000, np.random.default_rng(1)))[:, 0]
    half = t.ppf(0.975, 4) * logs.std(ddof=1) * np.sqrt(1.2)
    inside = np.mean(np.abs(drawn - logs.mean()) < half)
    assert 0.947 < inside < 0.956


@pytest.mark.slow
def test_the_same_question_has_the_same_answer():
    one, other = (on_person([press()], TISSUE, read_drive("force")).presses[0].to_dict(196.0) for _ in range(2))
    assert one == other


@pytest.mark.parametrize(
    ("high", "low", "beyond", "result"),
    [
        (90.0, 50.0, False, "pass"),
        (90.0, 50.0, True, "undecided"),
        (110.0, 50.0, False, "undecided"),
        (110.0, 101.0, False, "fail"),
        (110.0, 101.0, True, "fail"),
        (None, 50.0, False, "undecided"),
        (100.0, 50.0, False, "pass"),
    ],
)
def test_the_guard_band(high, low, beyond, result):
    assert decide(high, (low, 20.0), 100.0, beyond)[0] == result


@pytest.mark.parametrize("share", [1.01, 1.04, 1.09])
@pytest.mark.parametrize("limit", [65.0, 140.0])
def test_a_limit_has_no_allowance(share, limit):
    """One, four and nine per cent above a limit are above it, for one more person and for a subject."""
    assert decide(share * limit, (0.5 * limit,), limit, False)[0] == "undecided"
    assert decide(2.0 * limit, (0.5 * limit, share * limit), limit, False)[0] == "fail"
    assert decide(limit / share, (0.5 * limit,), limit, False)[0] == "pass"
    assert decide(limit / share, (limit / share,), limit, False)[0] == "pass"


@pytest.mark.parametrize("share", [1.01, 1.04, 1.09])
def test_forces_and_pressures_above_a_limit_do_not_pass(share):
    limits = read_limits(Path(__file__).parents[2] / "examples" / "limits.toml")
    force, transient = limits.force_N.value, limits.transient_factor.value
    pressure = replace(limits.pressure_N_per_cm2, value=1e6, low=1e6, high=1e6)
    for kind, allowed in (("quasi-static", force), ("transient", transient * force)):
        load = ContactLoad(kind, None, 0.5 * allowed, share * allowed, (0.5 * allowed,))
        (row, other) = against_guarded_limits([load], replace(limits, pressure_N_per_cm2=pressure), 196.0, False)
        assert (row.limit, row.result, other.result) == (pytest.approx(allowed), "undecided", "pass")
        load = ContactLoad(kind, None, 0.5 * allowed, 2.0 * allowed, (share * allowed,))
        assert against_guarded_limits([load], limits, 196.0, False)[0].result == "fail"


@pytest.mark.slow
def test_an_extrapolation_says_how_far():
    deep = on_person([press(depth=2.5)], TISSUE, read_drive("position")).presses[0]
    depth = next(one for one in deep.beyond if one.quantity == "depth_mm")
    assert depth.value == pytest.approx(2.5, rel=1e-2) and depth.pressed_to < 2.0 and "%" in depth.text
    fast = on_person([press(velocity=400.0)], TISSUE, read_drive("position")).presses[0]
    assert any(one.quantity == "velocity_mm_s" and one.pressed_to == 250.0 for one in fast.beyond)
    inside = on_person([press(depth=1.1, hold=9.0)], TISSUE, read_drive("steady")).presses[0]
    assert inside.beyond == ()


@pytest.mark.parametrize(
    ("trace", "looks", "fits", "not_"),
    [
        (
            lambda: press(noise_N=0.01, noise_mm=0.001),
            "position",
            ("position", "steady", "spring:2000,3"),
            ("force", "mass:2", "spring:3,1"),
        ),
        (crept, "force", ("force",), ("position", "steady", "mass:2")),
        (struck, "mass", ("mass:2", "mass:1.8"), ("position", "force", "mass:8")),
    ],
)
def test_the_trace_tells_which_drive_made_it(trace, looks, fits, not_):
    signs = signs_of(read_press(trace()))
    assert signs.looks_like == looks
    assert [text for text in fits if read_drive(text).contradicted(signs)] == []
    assert [text for text in not_ if not read_drive(text).contradicted(signs)] == []
    if looks == "mass":
        assert signs.mass_kg == pytest.approx(2.0, rel=0.05)


@pytest.mark.slow
def test_measured_curves_take_steady_and_refuse_the_rest(tmp_path, monkeypatch):
    from dummydesign.tissue.adding.from_traces import add_curves
    from tests.support.fung_people import PEOPLE, write_table

    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    table = write_table(tmp_path / "c.csv", PEOPLE, (5.0, 10.0, 15.0))
    add_curves("curved", str(table), "none", "5")
    tissue, trace = load_tissue("curved"), press(10.0, 1.1, 10.0)
    for text in ("position", "force", "mass:2", "spring:20,2"):
        with pytest.raises(InputError) as raised:
            on_person([trace], tissue, read_drive(text))
        assert raised.value.code == "unsupported"
    found = on_person([trace], tissue, read_drive("steady")).presses[0]
    assert found.band["steady_N"] == pytest.approx([found.pad["steady_N"]] * 2, rel=2e-2)
    assert found.interval["peak_N"][0] < found.band["peak_N"][0] < found.band["peak_N"][1] < found.interval["peak_N"][1]


def cut(trace, until):
    keep = trace.time_s <= until
    return Trace(trace.name, trace.time_s[keep], trace.displacement_mm[keep], trace.force_N[keep])


@pytest.fixture(scope="module")
def whole():
    return press()


@pytest.mark.parametrize(
    ("spoilt", "drive", "code"),
    [
        (lambda one: cut(one, 0.012), "position", "not_enough_data"),
        (
            lambda one: replace(one, force_N=0.02 * np.random.default_rng(1).standard_normal(len(one.time_s))),
            "position",
            "nothing_found",
        ),
        (lambda one: replace(one, displacement_mm=one.displacement_mm - 5.0), "position", "nothing_found"),
        (lambda one: replace(one, displacement_mm=one.displacement_mm + 1.0), "position", None),
        (lambda one: cut(one, 0.1), "steady", "not_enough_data"),
    ],
)
def test_bad_traces_are_one_line(spoilt, drive, code, whole):
    with pytest.raises(InputError) as raised:
        on_person([spoilt(whole)], TISSUE, read_drive(drive))
    assert "\n" not in str(raised.value) and "press.csv" in str(raised.value)
    assert code is None or raised.value.code == code


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["position", "steady", "force", "mass:2", "spring:1000,3"])
def test_the_work_of_ten_seconds_at_1_khz_is_less_than_a_solve_a_sample(drive, monkeypatch):
    solve, solves = integrate._solve, []
    monkeypatch.setattr(integrate, "_solve", lambda *given, **named: solves.append(1) or solve(*given, **named))
    trace = press(250.0, 1.4, 10.0, noise_N=0.02, noise_mm=0.001)
    found = on_person([trace], TISSUE, read_drive(drive))
    assert len(found.presses[0].press.time_s) < 1000
    assert len(solves) < len(trace.time_s)


def test_the_root_of_a_covariance_is_unique_and_its_inverse_is_the_precision():
    from dummydesign.person.smoothing import root_of_inverse

    rng = np.random.default_rng(3)
    rough = np.diff(np.eye(60), 2, axis=0)
    precision = np.diag(rng.uniform(0.0, 9.0, 60)) + 1e4 * rough.T @ rough
    root = root_of_inverse(precision)
    assert np.all(np.tril(root, -1) == 0.0) and np.all(np.diag(root) > 0.0)
    assert root @ root.T @ precision == pytest.approx(np.eye(60), abs=1e-6)
