"""The five drives against closed forms, limits, energy, and an integration by other code."""

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.trace import Trace
from dummydesign.person.drives import DRIVES, read_drive
from dummydesign.person.drives.spring import press_by_spring
from dummydesign.person.on_person import on_person
from dummydesign.person.people import People
from dummydesign.person.press import read_press
from dummydesign.person.smoothing import RobotArm
from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.laws import SPRING
from tests.support.robot_presses import (
    Run,
    by_mass,
    by_path,
    by_robot,
    command,
    gel_pad,
    linear_body,
    sampled,
    skin_by_force,
    skin_of,
)

SPEEDS = (10.0, 250.0)
TISSUE = load_tissue("forefinger")


def springs(*stiffness):
    """People that are springs."""
    k = np.array(stiffness)
    return People(SPRING, k, np.zeros((len(k), 0)), np.zeros((len(k), 0)))


def pressed(velocity, depth=1.4, hold=1.5):
    """A pad by path, from 1 mm above it, and its command."""
    path, speed, end = command(velocity, depth, hold, 0.1 * depth / velocity)
    return by_path(gel_pad(), path, speed, end, -0.6 / velocity), (path, speed, end)


def near(response, run, row, share=0.01):
    found = [float(response.four()[name][row]) for name in ("peak_N", "depth_mm", "energy_mJ")]
    assert found == pytest.approx([run.peak, run.depth, run.energy], rel=share)


@pytest.mark.slow
@pytest.mark.parametrize("velocity", SPEEDS)
def test_position_is_the_law_along_the_path_by_another_integrator(velocity):
    run, (path, speed, end) = pressed(velocity)
    press = read_press(sampled(run))
    found = read_drive("position").respond(press, People.of(TISSUE.parameter_sets, press.velocity_mm_s))
    for row, one in enumerate(TISSUE.parameter_sets):
        near(found, by_path(skin_of(one, velocity), path, speed, end, -0.6 / velocity), row)


def through(t, x):
    """A path and its speed by straight lines."""
    return lambda s: np.interp(s, t, x), lambda s: (np.interp(s + 1e-7, t, x) - np.interp(s - 1e-7, t, x)) / 2e-7


@pytest.mark.slow
@pytest.mark.parametrize("velocity", SPEEDS)
def test_steady_presses_everyone_to_the_pad_s_steady_force(velocity):
    run, _ = pressed(velocity, hold=9.0)
    press = read_press(sampled(run))
    found = read_drive("steady").respond(press, People.of(TISSUE.parameter_sets, velocity))
    assert found.steady_N == pytest.approx(np.full(5, float(press.steady_N)), rel=1e-3)
    for row, one in enumerate(TISSUE.parameter_sets):
        t, x = found.time_s[row], found.depth_curve_mm[row]
        near(found, by_path(skin_of(one, velocity), *through(t, x), t[-1], 0.0), row)


@pytest.mark.slow
@pytest.mark.parametrize(("velocity", "rounding_s"), [(20.0, 2e-3), (120.0, 4e-3), (250.0, 2e-3)])
@pytest.mark.parametrize("approach_mm", (0.0, 6.0))
def test_with_steady_the_robot_stops_on_people_as_softly_as_on_the_pad(velocity, rounding_s, approach_mm):
    path, speed, end = command(velocity, 1.1, 2.0, rounding_s)
    begin = 0.0 if approach_mm == 0.0 else -approach_mm / velocity
    press = read_press(sampled(by_path(gel_pad(), path, speed, end, begin), 5000.0))
    people = [load_tissue(name).parameter_sets[2] for name in ("forefinger", "palm")]
    for one in people:
        found = read_drive("steady").respond(press, People.of([one], velocity))
        depth = 1.1 + float(found.depth_mm[0]) - press.x_mm[-1]
        deeper = command(velocity, depth, 2.0, rounding_s)
        run = by_path(skin_of(one, velocity), *deeper[:2], deeper[2], -6.0 / velocity)
        late = run.t >= run.t[-1] - 0.1
        assert float(found.steady_N[0]) == pytest.approx(run.f[late].mean(), rel=2e-3)
        assert float(found.peak_N[0]) == pytest.approx(run.peak, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("velocity", SPEEDS)
def test_force_gives_the_depth_that_another_integrator_gives(velocity):
    run, _ = pressed(velocity)
    after = run.t > 0.0
    rate = np.gradient(run.f[after], run.t[after])
    press = read_press(sampled(run, 4000.0))
    found = read_drive("force").respond(press, People.of(TISSUE.parameter_sets, velocity))
    for row, one in enumerate(TISSUE.parameter_sets):
        own = skin_by_force(
            one.gamma1_N_per_mm3,
            one.gamma_N_per_mm3,
            one.dampers_at(velocity),
            lambda t: np.interp(t, run.t, run.f),
            lambda t: np.interp(t, run.t[after], rate),
            0.01 * 1.4 / velocity,
            run.t[-1],
        )
        near(found, own, row)


@pytest.mark.slow
@pytest.mark.parametrize("mass", (0.5, 8.0))
def test_a_free_mass_stops_as_by_another_integrator_and_gives_its_energy(mass):
    run, _ = pressed(250.0)
    press = read_press(sampled(run, 2000.0))
    assert float(press.contact_mm_s) == pytest.approx(250.0, rel=5e-3)
    found = read_drive(f"mass:{mass}").respond(press, People.of(TISSUE.parameter_sets, 250.0))
    speed = float(press.contact_mm_s)
    for row, one in enumerate(TISSUE.parameter_sets):
        near(found, by_mass(skin_of(one, 250.0), speed, mass), row, 2e-3)
    assert found.energy_mJ == pytest.approx(np.full(5, 0.5e-3 * mass * speed**2), rel=1e-3)


@pytest.mark.parametrize(("mass", "velocity"), [(1.2, 90.0), (3.0, 250.0)])
@pytest.mark.parametrize(("noise_N", "noise_mm"), [pytest.param(0.0, 0.0, marks=pytest.mark.slow), (0.03, 0.001)])
def test_a_trace_that_begins_at_contact_has_the_speed_of_its_energy(mass, velocity, noise_N, noise_mm):
    run = by_mass(gel_pad(), velocity, mass, rebound=0.5)
    press, drive = read_press(sampled(run, 2000.0, noise_N, noise_mm)), read_drive(f"mass:{mass}")
    assert not press.approached and not drive.speed_doubt(press)
    own = drive.with_own_speed(press)
    assert float(own.contact_mm_s) == pytest.approx(velocity, rel=5e-3)
    assert abs(float(own.contact_mm_s) - velocity) < 2.0 * own.contact_sd_mm_s < 0.02 * velocity
    found = drive.respond(own, springs(20.0))
    assert found.peak_N == pytest.approx([velocity * np.sqrt(20.0 * 1e-3 * mass)], rel=6e-3)


@pytest.mark.slow
def test_a_mass_that_does_not_have_the_energy_of_the_press_is_doubted():
    run = by_mass(gel_pad(), 90.0, 1.2, rebound=0.5)
    lead = np.linspace(-0.03, 0.0, 61)[:-1]
    whole = Run(np.r_[lead, run.t], np.r_[90.0 * lead, run.x], np.r_[0.0 * lead, run.f])
    press = read_press(sampled(whole, 2000.0, 0.02, 0.001))
    assert press.approached
    assert [mass for mass in (1.0, 1.1, 1.2, 1.3, 1.5) if not read_drive(f"mass:{mass}").speed_doubt(press)] == [1.2]
    (one,) = on_person([press.trace], TISSUE, read_drive("mass:1.1")).warnings[:1]
    assert one["code"] == "drive_mismatch"
    # where the approach is recorded its speed is kept
    assert read_drive("mass:1.1").with_own_speed(press) is press


def test_the_energy_of_a_ringing_press_is_that_of_its_largest_depth():
    """A spring takes k x^2 / 2 whatever rings before and after, on the pad and on people."""
    time = np.arange(-0.1, 3.0, 5e-4)
    since = np.maximum(time - 0.2, 0.0)
    x = np.minimum(10.0 * time, 2.0) + 0.15 * np.exp(-5.0 * since) * np.sin(90.0 * since)
    press = read_press(Trace("rings.csv", time, x, 4.0 * np.maximum(x, 0.0)))
    largest = float(x.max())
    assert largest > 2.1
    assert float(press.energy_mJ) == pytest.approx(2.0 * largest**2, rel=3e-3)
    found = read_drive("position").respond(press, springs(10.0))
    assert found.energy_mJ == pytest.approx([5.0 * largest**2], rel=3e-3)
    held = read_drive("steady").respond(press, springs(4.0))
    assert held.energy_mJ == pytest.approx([2.0 * largest**2], rel=4e-3)
    # a force that is followed rings alike, and so does the spring that bears it
    forced = read_drive("force").respond(press, springs(8.0))
    assert forced.energy_mJ == pytest.approx([(4.0 * largest) ** 2 / 16.0], rel=4e-3)


def test_a_free_mass_on_springs_is_that_of_the_closed_form():
    run, _ = pressed(250.0)
    press, k = read_press(sampled(run, 2000.0)), np.array([5.0, 20.0, 75.0])
    found = read_drive("mass:2").respond(press, springs(*k))
    omega, speed = np.sqrt(k / 2e-3), float(press.contact_mm_s)
    assert found.depth_mm == pytest.approx(speed / omega, rel=1e-4)
    assert found.peak_N == pytest.approx(k * speed / omega, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("velocity", "stiffness", "mass"), [(10.0, 5.0, 0.5), (250.0, 20.0, 0.1), (250.0, 80.0, 0.5), (100.0, 300.0, 5.0)]
)
@pytest.mark.parametrize("ratio", (0.0, 0.05))
def test_an_arm_with_a_spring_acts_on_people_as_its_true_command_does(velocity, stiffness, mass, ratio):
    path, speed, end = command(velocity, 2.0, 2.0, 0.02)
    begin = -0.6 / velocity
    pad = by_robot(gel_pad(), path, speed, end, begin, stiffness, mass, ratio=ratio, method="LSODA")
    drive = read_drive(f"spring:{stiffness},{mass},{ratio}")
    press = read_press(sampled(pad, 2000.0), None, drive.arm)
    found = drive.respond(press, People.of(TISSUE.parameter_sets, press.velocity_mm_s))
    for row, one in enumerate(TISSUE.parameter_sets):
        person = skin_of(one, press.velocity_mm_s)
        own = by_robot(person, path, speed, end, begin, stiffness, mass, ratio=ratio, method="LSODA")
        near(found, own, row)


def two_springs(t, v, big, k, mass):
    """Closed form of M x'' = K (v t - x) - k x from contact at speed v."""
    omega = np.sqrt((big + k) / (1e-3 * mass))
    return big * v * t / (big + k) + v * k / ((big + k) * omega) * np.sin(omega * t)


def test_two_masses_and_springs_by_hand():
    v, big, mass, pad, people = 50.0, 30.0, 2.0, 12.0, np.array([4.0, 12.0, 40.0])
    t = np.linspace(0.0, 0.06, 6001)
    x = two_springs(t, v, big, pad, mass)
    # the command stops nothing: the press ends where it ends
    before = np.linspace(-0.01, 0.0, 200)[:-1]
    run = Run(np.r_[before, t], np.r_[v * before, x], np.r_[0.0 * before, pad * x])
    press = read_press(ending(run))
    found = press_by_spring(press, springs(*people), RobotArm(big, mass))
    inside = found.time_s < 0.055
    for row, k in enumerate(people):
        own = two_springs(found.time_s[inside], v, big, k, mass)
        assert np.max(np.abs(found.depth_curve_mm[row][inside] - own)) < 2e-3 * x.max()


def ending(run):
    """The trace of a run that then holds its last depth: what is looked at lies before."""
    tail, same = np.linspace(run.t[-1], run.t[-1] + 0.1, 500)[1:], np.ones(499)
    held = Run(np.r_[run.t, tail], np.r_[run.x, same * run.x[-1]], np.r_[run.f, same * run.f[-1]])
    return sampled(held, 10_000.0)


@pytest.mark.slow
def test_an_infinitely_stiff_arm_is_position():
    run, _ = pressed(100.0)
    press, people = read_press(sampled(run)), People.of(TISSUE.parameter_sets, 100.0)
    stiff = press_by_spring(press, people, RobotArm(1e6, 3.0))
    path = read_drive("position").respond(press, people)
    for name in ("peak_N", "steady_N", "depth_mm", "energy_mJ"):
        assert stiff.four()[name] == pytest.approx(path.four()[name], rel=2e-3)


def test_an_infinitely_soft_arm_with_speed_is_a_free_mass():
    hit = by_mass(linear_body(15.0), 200.0, 2.0)
    omega = np.sqrt(15.0 / 2e-3)
    t = np.linspace(-0.01, 0.98 * np.pi / omega, 20001)
    x = np.where(t < 0, 200.0 * t, 200.0 / omega * np.sin(omega * t))
    assert hit.depth == pytest.approx(x.max(), rel=1e-5)
    press = read_press(sampled(Run(t, x, 15.0 * np.maximum(x, 0.0)), 10_000.0))
    people = People.of(TISSUE.parameter_sets[2:], 200.0)
    free = read_drive("mass:2").respond(press, people)
    soft = press_by_spring(press, people, RobotArm(1e-6, 2.0))
    assert soft.peak_N == pytest.approx(free.peak_N, rel=1e-2)
    assert soft.depth_mm == pytest.approx(free.depth_mm, rel=1e-2)


def test_work_of_the_command_is_in_spring_mass_and_person():
    """With springs for people nothing is lost: work of the command = spring + kinetic + person, at any time."""
    v, big, mass, pad, k = 60.0, 25.0, 3.0, 8.0, 20.0
    t = np.linspace(0.0, 0.07, 7001)
    lead, path = np.linspace(-0.01, 0, 100)[:-1], two_springs(t, v, big, pad, mass)
    run = Run(np.r_[lead, t], np.r_[v * lead, path], np.r_[0.0 * lead, pad * path])
    found = press_by_spring(read_press(ending(run)), springs(k), RobotArm(big, mass))
    inside = found.time_s < 0.065
    at, x = found.time_s[inside], found.depth_curve_mm[0][inside]
    speed = np.gradient(x, at)
    drawn = big * (v * at - x)
    work = np.r_[0.0, np.cumsum(0.5 * (drawn[1:] + drawn[:-1]) * v * np.diff(at))]
    kept = 0.5 * drawn**2 / big + 0.5e-3 * mass * (speed**2 - v**2) + 0.5 * k * x**2
    assert np.max(np.abs(work - kept)[5:-5]) < 5e-3 * work[-1]


@pytest.mark.slow
def test_sampling_does_not_matter():
    run, _ = pressed(250.0)
    people = People.of(TISSUE.parameter_sets, 250.0)
    for text in ("position", "steady", "force", "mass:2", "spring:30,2"):
        rows = []
        for rate in (1000.0, 2000.0, 7300.0):
            rows.append(read_drive(text).respond(read_press(sampled(run, rate)), people).four())
        for name in ("peak_N", "depth_mm", "energy_mJ"):
            assert rows[0][name] == pytest.approx(rows[2][name], rel=1e-2), (text, name)
            assert rows[1][name] == pytest.approx(rows[2][name], rel=1e-2), (text, name)


@pytest.mark.slow
def test_a_declared_filter_is_undone():
    from dummydesign.measurement.sensor import Lowpass

    run, _ = pressed(250.0)
    people = People.of(TISSUE.parameter_sets, 250.0)
    passed = Lowpass(35.0, 2, 1)
    plain, undone = read_press(sampled(run)), read_press(sampled(run, lowpass=passed), passed)
    assert float(undone.peak_N) == pytest.approx(run.peak, rel=1e-2)
    for text in ("position", "steady", "force", "mass:2", "spring:30,2"):
        one, other = (read_drive(text).respond(press, people).four() for press in (plain, undone))
        for name in ("peak_N", "depth_mm", "energy_mJ"):
            assert one[name] == pytest.approx(other[name], rel=1e-2), (text, name)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("mass:0", "out_of_range"),
        ("mass:-2", "out_of_range"),
        ("mass:4000", "implausible_unit"),
        ("mass", "malformed"),
        ("mass:two", "not_a_number"),
        ("mass:nan", "not_a_number"),
        ("mass:1,2", "malformed"),
        ("spring:0,3", "out_of_range"),
        ("spring:-5,3", "out_of_range"),
        ("spring:20000,3", "implausible_unit"),
        ("spring:20", "malformed"),
        ("spring:20,3,0.1,1", "malformed"),
        ("spring:20,3,-0.1", "out_of_range"),
        ("spring:20,3,5", "out_of_range"),
        ("spring:20,3,nan", "not_a_number"),
        ("spring:20,0", "out_of_range"),
        ("spring:20,4000", "implausible_unit"),
        ("bounce", "unknown_name"),
        ("position:3", "malformed"),
        ("", "unknown_name"),
    ],
)
def test_bad_drives_are_refused(text, code):
    with pytest.raises(InputError) as raised:
        read_drive(text)
    assert raised.value.code == code and "\n" not in str(raised.value)


def test_units_of_masses_and_stiffnesses():
    assert read_drive("spring:20000N/m,500g").values == pytest.approx((20.0, 0.5, 0.0))
    assert read_drive("spring:20,0.5,5%").values == pytest.approx((20.0, 0.5, 0.05))
    assert [read_drive(text).text for text in ("spring:20,3", "spring:20,3,0", "spring:20,3,0.05")] == [
        "spring:20,3",
        "spring:20,3",
        "spring:20,3,0.05",
    ]
    assert list(DRIVES) == ["position", "steady", "force", "mass", "spring"]
