"""A free mass beyond the presses on people is marked, and a hand that is free is offered its reduced mass."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.design.safety import SafetyView
from dummydesign.person.free_mass import EXTRAPOLATED, UNUSABLE, hand_mass_kg, reduced_mass_kg, with_known_range
from dummydesign.person.validity_range import limits_of_subjects
from dummydesign.report.suggest_facts import impact_text
from dummydesign.tissue.model.tissue_file import load_tissue


def row(body, depth_mm, peak_N):
    return {
        "body": body,
        "depth_mm": depth_mm,
        "peak_force_N": peak_N,
        "energy_mJ": 1.0,
        "mean_pressure_N_per_cm2": 1.0,
        "note": "",
    }


def marked(shares, mass_kg=16.0):
    tissue = load_tissue("palm")
    deepest, strongest = limits_of_subjects(tissue)
    rows = [
        row(f"tissue, subject {at + 1}", 0.5 * deep, share * most)
        for at, (deep, most, share) in enumerate(zip(deepest, strongest, shares))
    ]
    view = SafetyView((), (row("pad", 3.0, 90.0), *rows), "A free mass.")
    return with_known_range(view, tissue, mass_kg, 250.0)


@pytest.mark.parametrize("share, mark", [(0.9, None), (1.5, EXTRAPOLATED), (4.0, UNUSABLE)])
def test_each_subject_beyond_its_own_presses_is_marked_in_table_line_and_warning(share, mark):
    view = marked([share, 0.5, 0.5, 0.5, 0.5])
    assert [one["beyond_range"] for one in view.impact] == [False, mark is not None] + [False] * 4
    assert (view.impact[1]["note"] == (mark or "")) and not view.impact[0]["note"]
    assert [one["code"] for one in view.warnings] == ["impact_beyond_people"] * (mark is not None)
    line = impact_text({"safety": view.to_dict()})
    assert ("do not use" in line) == (mark == UNUSABLE) and ("extrapolated" in line) == (mark == EXTRAPOLATED)


def test_a_free_hand_is_offered_the_reduced_mass_and_a_small_mass_nothing():
    assert reduced_mass_kg(16.0, 0.6) == pytest.approx(0.5783, abs=1e-4)
    assert reduced_mass_kg(1e9, 0.6) == pytest.approx(0.6)
    view = marked([4.0] * 5)
    assert "--robot-mass 0.578" in view.impact_text and "--robot-mass 0.578" in view.warnings[0]["message"]
    small = marked([0.5] * 5, 0.578)
    assert small.impact_text == "A free mass." and not small.warnings


def test_the_reduced_mass_takes_as_much_energy_as_two_free_bodies_lose():
    """Two masses, one at rest, end at the speed of their centre of mass; what they lose the tissue takes."""
    robot, hand, speed = 16.0, 0.6, 0.25
    together = (robot + hand) * (robot * speed / (robot + hand)) ** 2
    assert reduced_mass_kg(robot, hand) * speed**2 == pytest.approx(robot * speed**2 - together)


def test_the_mass_of_a_hand_has_a_range_and_a_source():
    mass = hand_mass_kg()
    assert mass.low < mass.value < mass.high and "15066" in mass.source and np.isfinite(mass.high)
