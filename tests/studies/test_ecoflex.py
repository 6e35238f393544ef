"""The Ecoflex families: reduced curves, one mixture fitted anew, the family law, resin files and a recipe."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from dummydesign.resin import load_resin
from studies.resins.ecoflex import (
    FAMILIES,
    BatchFit,
    Mixture,
    fit_family,
    fit_mixtures,
    measured_folder,
    read_curves,
    reduce_curves,
)


@pytest.fixture(scope="module")
def curves():
    return read_curves(measured_folder() / "ecoflex-compression.csv")


def test_all_curves_of_the_nineteen_mixtures_are_there(curves):
    assert len(curves) == 19
    assert sum(len(batch) for batch in curves.values()) == 114
    assert all({curve.puck for curve in batch} == {"A", "B"} for batch in curves.values())


@pytest.mark.slow
def test_fitting_a_mixture_anew_gives_the_stored_numbers(curves):
    key = ("EF30", 25.0)
    fit = fit_mixtures({key: curves[key]})[0].fit
    with open(measured_folder() / "ecoflex-moduli.csv", newline="", encoding="utf-8") as stream:
        rows = {(row["family"], float(row["thinner_per_100"])): row for row in csv.DictReader(stream)}
    stored = rows["ecoflex-00-30", 25.0]
    for name in ("young_kPa", "young_low_kPa", "young_high_kPa", "alpha", "rmse", "young_frictionless_kPa"):
        assert getattr(fit, name) == pytest.approx(float(stored[name]), rel=5e-3), name


def test_held_faces_fit_every_mixture_better_than_frictionless_plates():
    with open(measured_folder() / "ecoflex-moduli.csv", newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 19
    for row in rows:
        assert float(row["rmse"]) < 0.75 * float(row["rmse_frictionless"])
        assert float(row["young_low_kPa"]) < float(row["young_kPa"]) < float(row["young_high_kPa"])


def made_mixture(thinner, young, spread=0.03, open_friction=False):
    above = 1.0 if open_friction else 50.0
    profile = ((0.0, 1.4 * young, above), (np.inf, young, 0.0))
    return Mixture(
        "EF10",
        thinner,
        BatchFit(
            young,
            young * np.exp(-1.96 * spread),
            young * np.exp(1.96 * spread),
            2.0,
            np.inf,
            0.0,
            np.inf,
            np.zeros(0),
            1.4 * young,
            young,
            0.01,
            0.02,
            0.01,
            profile,
        ),
    )


def family(error=0.0, **kwargs):
    rng = np.random.default_rng(1)
    thinners = (0.0, 12.5, 25.0, 50.0, 75.0, 100.0)
    return [
        made_mixture(t, 40.0 * (100 / (100 + t)) ** 2.8 * np.exp(error * rng.standard_normal()), **kwargs)
        for t in thinners
    ]


def test_the_law_of_a_family_is_recovered_and_foretells_what_is_left_out():
    law = fit_family(family())
    assert law.young_neat_kPa[0] == pytest.approx(40.0, rel=1e-6)
    assert law.exponent[0] == pytest.approx(2.8, rel=1e-6)
    assert law.scatter == 0.0
    assert law.cross_validated_error < 1e-6


def test_scatter_beyond_the_intervals_widens_the_law_and_shows_in_what_is_left_out():
    calm, rough = fit_family(family(0.03)), fit_family(family(0.12))
    assert rough.scatter > calm.scatter
    assert rough.cross_validated_error > 0.04
    width = [np.log(law.young_neat_kPa[2] / law.young_neat_kPa[1]) for law in (calm, rough)]
    assert width[1] > width[0]


def test_what_friction_leaves_open_is_not_averaged_over_the_mixtures():
    law = fit_family(family(open_friction=True))
    assert law.friction == (0.0, np.inf)
    assert law.young_neat_kPa[2] > 1.4 * 40.0
    assert fit_family(family()).young_neat_kPa[2] < 1.2 * 40.0


def test_reducing_keeps_the_numbers_as_they_are(tmp_path):
    source, target = tmp_path / "curves.csv", tmp_path / "out.csv"
    source.write_text("compression_mm,EF10_0T_A1_N\n0.0,-0.01\n0.25,0.5\n0.5,1.234\n18.5,9\n")
    reduce_curves(source, target)
    assert target.read_text() == "compression_mm,EF10_0T_A1_N\n0.0,-0.01\n0.5,1.234\n"


@pytest.mark.parametrize("name", FAMILIES.values())
def test_each_family_is_a_resin_whose_recipe_names_part_a_part_b_and_thinner(name):
    resin = load_resin(name)
    recipe = {part.name: part.mass_g for part in resin.recipe(25.0, 250.0)}
    assert recipe == pytest.approx({"part A": 100.0, "part B": 100.0, "thinner": 50.0})
    modulus = resin.modulus_kPa(25.0)
    assert modulus.low < modulus.value < modulus.high
    assert resin.young_MPa(0.0) > resin.young_MPa(50.0)
