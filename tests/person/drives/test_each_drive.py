"""Each drive on people who are springs: the closed form of what they bear, and when the trace speaks against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.measurement.motion import RISE_STEPS, Motion
from dummydesign.measurement.trace import Trace
from dummydesign.person.drives.drive import MASSES, RobotDrive, TraceSigns
from dummydesign.person.drives.followed import SAME_SPEED, Force, Position, SteadyDrive, own_late_mean, path_of
from dummydesign.person.drives.mass import Mass
from dummydesign.person.people import People
from dummydesign.person.press import SHORTEST_HOLD_S, Press
from dummydesign.tissue.model.laws import SPRING
from tests.support.refusal import raises_code

K = np.array([2.0, 5.0, 20.0])
PEOPLE = People(SPRING, K, np.zeros((3, 0)), np.zeros((3, 0)))
SPEED, DEPTH, HOLD, PAD = 50.0, 2.0, 2.0, 6.0
STOP = DEPTH / SPEED
TIME = np.r_[np.linspace(0.0, STOP, 41), STOP + np.linspace(0.0, HOLD, 401)[1:]]


def press(**more):
    """A pad of 6 N/mm pressed by 2 mm at 50 mm/s, from 10 mm above it."""
    t = np.arange(-0.2, STOP + HOLD, 1e-3)
    x = np.minimum(SPEED * t, DEPTH)
    trace = Trace("pad.csv", t + 0.2, x, PAD * np.maximum(x, 0.0))
    path = np.minimum(SPEED * TIME, DEPTH)
    none = np.zeros((len(TIME), 1))
    own = Press(
        *(trace, TIME, path, PAD * path, none, none, 0.2, STOP, HOLD, SPEED),
        *(np.asarray(SPEED), 0.5, np.asarray(PAD * DEPTH), 0.01),
    )
    return replace(own, **more)


def signs(looks=None, creep=0.01, relaxed=0.5, mass=None):
    return TraceSigns(looks, HOLD, creep, 0.05, relaxed, 12.0, mass)


def test_position_gives_everyone_the_depth_of_the_pad():
    found = Position().respond(press(), PEOPLE)
    np.testing.assert_allclose(found.depth_mm, DEPTH)
    np.testing.assert_allclose(found.peak_N, K * DEPTH)
    np.testing.assert_allclose(found.steady_N, K * DEPTH)
    np.testing.assert_allclose(found.energy_mJ, 0.5 * K * DEPTH**2)


def test_force_gives_everyone_the_force_of_the_pad():
    found = Force().respond(press(), PEOPLE)
    force = PAD * DEPTH
    np.testing.assert_allclose(found.peak_N, force, rtol=1e-6)
    np.testing.assert_allclose(found.depth_mm, force / K, rtol=1e-4)
    np.testing.assert_allclose(found.energy_mJ, 0.5 * force**2 / K, rtol=1e-3)
    # the four numbers of many draws are a little coarser
    quick = Force().respond(press(), PEOPLE, keep=False)
    np.testing.assert_allclose(quick.depth_mm, found.depth_mm, rtol=1e-3)


@pytest.mark.parametrize("mass", [0.2, 5.0])
def test_a_free_mass_stops_after_a_quarter_of_a_period_with_its_energy_in_the_person(mass):
    drive = Mass(mass)
    for keep in (True, False):
        found = drive.respond(press(), PEOPLE, keep)
        np.testing.assert_allclose(found.peak_N, SPEED * np.sqrt(1e-3 * mass * K), rtol=1e-3)
        np.testing.assert_allclose(found.depth_mm, SPEED * np.sqrt(1e-3 * mass / K), rtol=1e-3)
        np.testing.assert_allclose(found.energy_mJ, 0.5e-3 * mass * SPEED**2, rtol=1e-3)
        np.testing.assert_allclose(found.stop_s, 0.5 * np.pi * np.sqrt(1e-3 * mass / K), rtol=2e-3)
    # the curves go on as long again as the slowest takes to stop
    curves = drive.respond(press(), PEOPLE)
    assert np.max(curves.time_s) == pytest.approx(2.0 * float(np.max(curves.stop_s)), rel=1e-6)
    assert drive.on_pad(press())["steady_N"] is None and drive.on_pad(press())["peak_N"] == PAD * DEPTH


@pytest.mark.parametrize("mass", [0.7, 30.0])
def test_without_an_approach_a_mass_has_the_speed_of_the_energy_that_the_pad_took(mass):
    drive, energy = Mass(mass), 0.5 * PAD * DEPTH**2
    speed = np.sqrt(2.0 * energy / (1e-3 * mass))
    assert drive.with_own_speed(press()).contact_mm_s == SPEED
    own = drive.with_own_speed(press(approached=False))
    assert float(own.contact_mm_s) == pytest.approx(speed, rel=1e-6)
    # a force sensor's hundredth of the energy is half of that in speed
    assert own.contact_sd_mm_s == pytest.approx(0.005 * speed, rel=1e-6)


@pytest.mark.parametrize(("off", "doubted"), [(2.9, False), (3.1, True), (-2.9, False), (-3.1, True)])
def test_a_speed_is_doubted_from_three_errors_on(off, doubted):
    energy = 0.5 * PAD * DEPTH**2
    drive = Mass(2e3 * energy / SPEED**2)
    error = np.hypot(0.005 * SPEED, 0.5)
    text = drive.speed_doubt(press(contact_mm_s=np.asarray(SPEED + off * error)))
    assert bool(text) is doubted
    if doubted:
        assert f"{energy:.3g} mJ" in text


def test_steady_gives_everyone_the_pad_s_steady_force_along_its_path():
    found = SteadyDrive().respond(press(), PEOPLE)
    force = PAD * DEPTH
    np.testing.assert_allclose(found.steady_N, force, rtol=1e-3)
    np.testing.assert_allclose(found.depth_mm, force / K, rtol=1e-3)
    np.testing.assert_allclose(found.peak_N, force, rtol=1e-3)
    # the same speed at contact, so the rise lasts as long as the depth is deep
    rows = zip(found.depth_mm, found.depth_curve_mm[:, : RISE_STEPS + 1], found.time_s[:, : RISE_STEPS + 1])
    rise = np.array([np.interp(0.9 * depth, x, t) for depth, x, t in rows])
    np.testing.assert_allclose(rise, 0.9 * force / K / SPEED, rtol=1e-3)


@pytest.mark.parametrize(("steady", "code"), [(None, "not_enough_data"), (0.0, "out_of_range"), (-1.0, "out_of_range")])
def test_steady_needs_a_steady_force_above_nothing(steady, code):
    SteadyDrive().check(press(steady_N=np.asarray(1e-6)))
    with raises_code(code) as caught:
        SteadyDrive().check(press(steady_N=None if steady is None else np.array([1.0, steady]), hold_s=0.1))
    assert "pad.csv" in str(caught.value)
    assert (f"{SHORTEST_HOLD_S:g} s" in str(caught.value)) is (steady is None)


@pytest.mark.parametrize(("share", "braked"), [(0.94, True), (0.96, False), (1.2, False)])
def test_a_robot_came_faster_than_it_touched_where_it_lost_a_twentieth_of_its_speed(share, braked):
    assert share < SAME_SPEED or not braked
    path = path_of(press(contact_mm_s=np.asarray(share * SPEED)), 1e4)
    assert path.approach_mm_s == (SPEED if braked else share * SPEED) and path.contact_mm_s == share * SPEED
    assert path.braking_mm_s2 == 1e4 and path.depth_mm == DEPTH


def test_the_path_of_drawn_presses_is_their_mean_from_contact():
    x = np.stack([press().x_mm + 0.1, press().x_mm + 0.3])
    drawn = press(x_mm=x, contact_mm_s=np.array([49.0, 51.0]))
    path = path_of(drawn, 1e4)
    np.testing.assert_allclose(path.x_mm, press().x_mm, atol=1e-12)
    assert path.contact_mm_s == 50.0


def test_a_late_mean_is_that_of_the_last_seconds_of_each_press():
    """Of a straight line it is its value in the middle of them."""
    time = np.stack([np.linspace(0.0, 2.0, 50), np.linspace(0.0, 4.0, 50)])
    found = own_late_mean(Motion(time, time), 3.0 * time, 0.5)
    np.testing.assert_allclose(found, 3.0 * np.array([1.75, 3.75]))


@pytest.mark.parametrize("drive", [Position(), Force(), Mass(2.0)], ids=lambda drive: drive.name)
def test_a_drive_without_curves_refuses_people_who_are_measured_curves(drive):
    with raises_code("unsupported", "drive") as caught:
        drive.on_curves(press(), PEOPLE)
    assert "--drive steady" in str(caught.value)


@pytest.mark.parametrize(
    ("drive", "looks", "words"),
    [
        (Position(), "position", ""),
        (Position(), "force", "crept by 0.3 mm"),
        (Position(), "mass", "mass of 2 kg"),
        (SteadyDrive(), "force", "crept by 0.3 mm"),
        (SteadyDrive(), None, ""),
        (Force(), "force", ""),
        (Force(), "position", "fell by 0.5 N"),
        (Force(), "mass", "mass of 2 kg"),
    ],
)
def test_a_trace_speaks_against_a_drive_that_did_not_make_it(drive, looks, words):
    said = drive.contradicted(signs(looks, 0.3, 0.5, 2.0))
    assert words in said and bool(said) is bool(words)


@pytest.mark.parametrize(("mass", "agrees"), [(2.59, True), (2.61, False), (1.55, True), (1.53, False)])
def test_a_mass_agrees_with_that_of_the_path_within_a_factor_of_one_point_three(mass, agrees):
    said = Mass(mass).contradicted(signs(None, None, None, 2.0))
    assert bool(said) is not agrees


def test_a_mass_is_contradicted_by_a_hold_and_by_a_path_that_no_mass_explains():
    assert "held 2 s" in Mass(2.0).contradicted(signs(None, 0.01, 0.5, None))
    assert "any free mass" in Mass(2.0).contradicted(signs(None, None, None, None))


class Two(RobotDrive):
    """A drive of a mass and another mass that may be left out."""

    name, form, words = "two", "two:KG[,KG]", "two"
    numbers = Mass.numbers * 2
    defaults = (3.0,)

    def respond(self, press, people, keep=True):
        raise NotImplementedError


@pytest.mark.parametrize(
    ("text", "values", "shown"),
    [
        ("5", (5.0, 3.0), "two:5"),
        ("5,3", (5.0, 3.0), "two:5"),
        (" 5 , 4 ", (5.0, 4.0), "two:5,4"),
        ("500g", (0.5, 3.0), "two:0.5"),
    ],
)
def test_numbers_are_read_and_last_ones_that_are_usual_are_left_out(text, values, shown):
    drive = Two.read(text)
    assert drive.values == values and drive.text == shown


@pytest.mark.parametrize("text", ["", "1,2,3"])
def test_too_few_and_too_many_numbers_are_refused_with_the_form(text):
    with raises_code("malformed", "drive") as caught:
        Two.read(text)
    assert Two.form in str(caught.value)


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_masses_have_both_ends_of_their_range(share):
    low, high = MASSES
    for value, inside in ((low * share, share > 1.0), (high * share, share < 1.0)):
        if inside:
            assert Mass(value).values == (value,)
        else:
            with raises_code("out_of_range"):
                Mass(value)


def test_a_drive_leaves_press_and_pad_as_they_are_unless_it_knows_better():
    own = press()
    plain = Position()
    assert plain.with_own_speed(own) is own and plain.arm is None and plain.speed_doubt(own) == ""
    assert plain.check(own) is None
    numbers = plain.on_pad(own)
    assert (numbers["peak_N"], numbers["steady_N"], numbers["depth_mm"]) == (12.0, 12.0, DEPTH)
    assert numbers["energy_mJ"] == pytest.approx(0.5 * PAD * DEPTH**2)
