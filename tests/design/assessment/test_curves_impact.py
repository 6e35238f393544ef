"""A free mass on measured curves: closed form, the law that made the curves, and what was not pressed."""

import numpy as np
import pytest

from dummydesign.design.safety import curves_impact, impact, tissue_body
from dummydesign.tissue import load_tissue
from dummydesign.tissue.adding.from_curves import add_curves
from dummydesign.tissue.model.measured_curves import SHARES, HeldPress, MeasuredPerson
from tests.support.refusal import raises_code
from tests.tissue.population.test_curves_without_law import law_table


def cubic(k, depth_mm=4.0, speeds=(10.0, 250.0)):
    """F = k x^3 at every speed, nothing relaxes."""
    rise = k * (SHARES * depth_mm) ** 3
    return MeasuredPerson([HeldPress(v, depth_mm, rise, np.array([0.0, 10.0]), np.full(2, rise[-1])) for v in speeds])


@pytest.mark.parametrize(("mass", "speed"), [(1.0, 100.0), (0.2, 250.0), (40.0, 10.0)])
def test_a_cubic_person_stops_a_mass_where_the_closed_form_says(mass, speed):
    found = curves_impact([cubic(0.2), cubic(0.6)], mass, speed)
    energy = 0.5e-3 * mass * speed**2
    depth = (4.0 * energy / np.array([0.2, 0.6])) ** 0.25
    np.testing.assert_allclose(found.contact.depth_mm, depth, rtol=2e-3)
    np.testing.assert_allclose(found.contact.peak_force_N, np.array([0.2, 0.6]) * depth**3, rtol=5e-3)
    np.testing.assert_allclose(found.contact.energy_mJ, energy)
    # what does not relax is at rest as stiff as in the press
    assert [float(note.split()[2]) for note in found.notes] == pytest.approx(depth, abs=0.006)


@pytest.mark.slow
def test_people_by_the_law_are_stopped_in_as_the_law_followed_says(tmp_path, monkeypatch):
    """depths within 1 %, forces at most a tenth too high: a mass slows down, and the law relaxes meanwhile"""
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    palm = load_tissue("palm")
    add_curves("own", str(law_table(tmp_path / "own.csv", palm)), "none", "5")
    own = load_tissue("own")
    people = {subject.name: subject.parameters for subject in palm.subjects}
    for mass, speed in ((1.0, 200.0), (0.1, 250.0), (1.0, 50.0)):
        found = curves_impact(own.parameter_sets, mass, speed).contact
        law = impact(tissue_body([people[subject.name] for subject in own.subjects], speed), mass, speed)
        np.testing.assert_allclose(found.depth_mm, law.depth_mm, rtol=0.01)
        ratio = found.peak_force_N / law.peak_force_N
        assert (ratio > 0.995).all() and (ratio < 1.1).all()


def test_a_mass_that_nobody_was_pressed_as_hard_as_has_no_numbers_and_says_what_was():
    found = curves_impact([cubic(0.2), cubic(20.0)], 3.0, 250.0)
    assert np.isnan(found.contact.peak_force_N[0]) and np.isfinite(found.contact.peak_force_N[1])
    assert found.notes[0] == "not stopped: it brings 93.8 mJ, the deepest press took 12.8 mJ to 4.00 mm"


def test_a_speed_that_was_not_pressed_is_refused_in_one_line_with_those_that_were():
    for speed in (500.0, 5.0):
        with raises_code("out_of_range", "robot_velocity_mm_s") as caught:
            curves_impact([cubic(0.2), cubic(0.6, speeds=(10.0, 50.0, 250.0))], 1.0, speed)
        assert "\n" not in str(caught.value)
    with raises_code("out_of_range", "mass_kg"):
        curves_impact([cubic(0.2)], -1.0, 100.0)
