"""The study of limbs: laws of thickness on presses of known moduli."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from studies import limbs

ROOT = Path(__file__).parents[2]
AREA = 360.0


def press(person, site, thickness, young_MPa, law, share=0.2):
    empty = limbs.Press(person, site, thickness, share * thickness, 0.0, AREA)
    return limbs.Press(*list(vars(empty).values())[:4], young_MPa * limbs.force_over_modulus(empty, law), AREA)


def people(law, seed, scatter=0.3):
    """Twelve people of one modulus each, at four sites of drawn thickness."""
    chance = np.random.default_rng(seed)
    rows = []
    for person in range(12):
        young = 0.02 * math.exp(scatter * chance.normal())
        rows += [press(str(person), site, chance.uniform(12.0, 40.0), young, law) for site in list(limbs.SITES)[:4]]
    return rows


def test_the_laws_are_those_of_text_books():
    one = limbs.Press("1", "UA_A", 20.0, 1.0, 1.0, AREA)
    radius = math.sqrt(AREA / math.pi)
    assert limbs.force_over_modulus(one, "bar") == pytest.approx(AREA / 20.0)
    assert limbs.force_over_modulus(one, "half_space") == pytest.approx(2.0 * radius / (1.0 - 0.25))
    glued, slides = (limbs.force_over_modulus(one, law) for law in ("bonded", "sliding"))
    assert glued > slides > limbs.force_over_modulus(one, "half_space")


@pytest.mark.parametrize("law", ["bonded", "sliding", "bar"])
def test_the_right_law_has_no_slope_and_no_error_on_people_of_one_modulus(law):
    rows = people(law, seed=int(np.random.SeedSequence().entropy % 2**31))
    right = limbs.judge(rows, law, draws=50)
    assert right.people_slope == pytest.approx(0.0, abs=1e-9) and right.left_out == pytest.approx(0.0, abs=1e-9)
    wrong = limbs.judge(rows, "half_space", draws=50)
    assert wrong.people_high < -0.2 and wrong.within_person > 0.05


def test_left_out_errors_take_the_sites_of_others_and_the_person():
    names, places = list("aabbcc"), ["x", "y"] * 3
    person, site = {"a": 0.3, "b": -0.2, "c": 0.1}, {"x": 1.0, "y": 2.0}
    values = np.array([person[n] + site[p] for n, p in zip(names, places)])
    assert limbs.left_out_errors(values, names, places) == pytest.approx(np.zeros(6), abs=1e-12)
    values[0] += 0.5
    assert limbs.left_out_errors(values, names, places)[0] == pytest.approx(0.5)


def test_the_page_has_the_rows_of_its_table():
    with (ROOT / limbs.ROWS).open(encoding="utf-8", newline="") as file:
        rows = {row["law"]: row for row in csv.DictReader(file)}
    text = (ROOT / limbs.PAGE.path).read_text(encoding="utf-8")
    assert set(rows) == set(limbs.LAWS)
    for law, row in rows.items():
        line = next(line for line in text.splitlines() if line.startswith(f"| {limbs.LAWS[law]} |"))
        assert f"{float(row['people_slope']):+.2f} (" in line and f"{float(row['left_out_factor']):.2f}" in line
