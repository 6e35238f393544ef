"""One set of parameters at the bound above a share of people."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.tissue.model import people_share
from dummydesign.tissue.model.maxwell_law import Parameters, law_named
from dummydesign.tissue.model.people_share import Population, share_parameters
from dummydesign.tissue.model.tissue import Subject, Tissue
from tests.support.refusal import raises_code

STEADY = np.array([0.02, 0.03, 0.05, 0.06])


def person(gamma1, strength=2.0, times=(0.4, 0.02)):
    """Arms of ``strength`` times gamma1 that relax at 10 N in these times at 10 mm/s, and in half of them at 250."""
    area = np.cbrt(10.0 / gamma1) ** 2
    gamma = strength * gamma1
    slow = tuple(gamma * area * t for t in times)
    return Parameters("consistent", gamma1, (gamma, gamma), ((10.0, slow), (250.0, tuple(0.5 * c for c in slow))))


def tissue(people):
    subjects = tuple(
        Subject(f"p{at}", one, {"gamma1_N_per_mm3": SimpleNamespace(kind="measured")}) for at, one in enumerate(people)
    )
    return Tissue("made", "made", people[0].law, subjects, (), (), "user")


ALIKE = tissue([person(one) for one in STEADY])


@pytest.fixture(autouse=True)
def _few_halvings(monkeypatch):
    monkeypatch.setattr(people_share, "STEPS", 14)


def peak(one, speed):
    return float(people_share._peaks([one], speed)[0])


@pytest.mark.parametrize("share", [0.5, 0.95])
def test_gamma1_is_the_bound_of_the_subjects_and_the_peaks_reach_theirs(share):
    found = ALIKE.target(f"people:{100.0 * share:g}")
    assert found.gamma1_N_per_mm3 == pytest.approx(float(Population.of(STEADY).bound(share)))
    peaks = {v: [peak(one, v) for one in ALIKE.parameter_sets] for v in (10.0, 250.0)}
    wanted = {v: float(Population.of(own).bound(share)) for v, own in peaks.items()}
    reached = {v: peak(found, v) / wanted[v] for v in wanted}
    # both are reached, and one of them just so
    assert min(reached.values()) == pytest.approx(1.0, abs=2e-3) and min(reached.values()) > 1.0 - 1e-3


def test_a_larger_share_has_a_stiffer_and_stronger_dummy():
    low, high = (ALIKE.target(f"people:{100.0 * share:g}") for share in (0.5, 0.99))
    assert high.gamma1_N_per_mm3 > low.gamma1_N_per_mm3
    assert all(a > b for a, b in zip(high.gamma_N_per_mm3, low.gamma_N_per_mm3))


def test_arms_have_the_times_of_the_subjects_at_ten_newtons():
    found = ALIKE.target("people:90")
    area = float(law_named("consistent").root(10.0 / found.gamma1_N_per_mm3)) ** 2
    for speed, factor in ((10.0, 1.0), (250.0, 0.5)):
        times = np.array(found.dampers_at(speed)) / (np.array(found.gamma_N_per_mm3) * area)
        np.testing.assert_allclose(times, factor * np.array([0.4, 0.02]), rtol=1e-9)


def test_people_of_springs_alone_have_a_bound_of_their_springs_alone():
    springs = [Parameters("spring", one, (), ()) for one in (2.0, 3.0, 5.0)]
    found = share_parameters([springs], springs, (), 0.9)
    assert found.gamma1_N_per_mm3 == pytest.approx(float(Population.of([2.0, 3.0, 5.0]).bound(0.9)))
    assert found.gamma_N_per_mm3 == () and found.law == "spring"


def test_one_subject_is_no_population():
    with raises_code("not_enough_data", "subjects"):
        replace(ALIKE, subjects=ALIKE.subjects[:1]).target("people:90")
