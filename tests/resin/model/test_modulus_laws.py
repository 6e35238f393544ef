"""The modulus law, its draws and what follows from them."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core.quantity import Quantity, value_at
from dummydesign.resin import load_resin
from dummydesign.resin.model.modulus_laws import LAWS
from tests.support.refusal import raises_code


@pytest.fixture(scope="module")
def polyurethane():
    return load_resin("polyurethane-nagoya")


def quantity(value, low, high, kind="measured"):
    return Quantity(value, low, high, kind, "test")


def test_the_published_anchor_is_met(polyurethane):
    assert polyurethane.young_MPa(15.0) == pytest.approx(0.025, rel=1e-12)


@pytest.mark.parametrize("name", sorted(set(LAWS) - {"fixed"}))
def test_every_law_is_inverted_by_its_ratio(name):
    law = LAWS[name]
    central = {
        "young_ref_kPa": 25.0,
        "ratio_ref": 15.0,
        "gel_ratio_over_ref": 0.86,
        "exponent": 2.4,
        "young_neat_kPa": 60.0,
    }
    ratios = np.linspace(13.5, 60.0, 50)
    young = law.young_kPa(ratios, central)
    assert np.all(np.diff(young) * law.direction > 0)
    np.testing.assert_allclose(law.ratio(young, central), ratios, rtol=1e-12)


def test_a_fixed_mix_has_one_modulus_and_no_ratio_for_another():
    law = LAWS["fixed"]
    np.testing.assert_array_equal(law.young_kPa(np.array([1.0, 100.0]), {"young_kPa": 40.0}), [40.0, 40.0])
    assert np.isnan(law.ratio(50.0, {"young_kPa": 40.0}))
    assert law.valid(1.0, {"young_kPa": 40.0}) and not law.valid(1.0, {"young_kPa": 0.0})


def test_the_slope_near_the_gel_point_is_the_closed_form(polyurethane):
    for ratio in (14.0, 15.0, 18.0):
        closed = 2.5 / (1.0 - 0.86 * 15.0 / ratio)
        assert polyurethane.log_slope(ratio) == pytest.approx(closed, rel=1e-6)


def test_sensitivity_at_the_anchor_is_what_network_theory_gives(polyurethane):
    """physically 12 to 27 % of E per 1 % of isocyanate over the intervals of gel point and exponent"""
    draws = polyurethane.draw(4000, 1).numbers
    slopes = draws["exponent"] / (1.0 - draws["gel_ratio_over_ref"])
    low, high = np.percentile(slopes, [2.5, 97.5])
    assert 10 < low < 15 and 22 < high < 30


def test_half_thinner_at_power_three_gives_an_eighth():
    law = LAWS["polymer_fraction"]
    assert law.young_kPa(100.0, {"young_neat_kPa": 80.0, "exponent": 3.0}) == pytest.approx(10.0)


def test_relaxation_grows_towards_the_gel_point(polyurethane):
    strengths = np.array([[term.beta for term in polyurethane.prony(r)] for r in np.linspace(14, 20, 25)])
    assert np.all(np.diff(strengths, axis=0) < 0)
    growth = (25.0 / (1e3 * polyurethane.young_MPa(14.0))) ** 0.5
    np.testing.assert_allclose(strengths[0] / [t.beta for t in polyurethane.prony(15.0)], growth)


def test_a_critical_gel_keeps_its_relaxing_modulus(polyurethane):
    fixed = quantity(1.0, 1.0, 1.0)
    gel = dataclasses.replace(polyurethane, softness_exponent=fixed)
    relaxing = [gel.young_MPa(r) * gel.prony(r)[0].beta for r in (14.0, 15.0, 19.0)]
    np.testing.assert_allclose(relaxing, relaxing[0])


def test_draws_repeat_with_their_seed_and_differ_with_another(polyurethane):
    first, again, other = (polyurethane.draw(50, seed).young_MPa(16.0) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_no_draw_has_its_gel_point_inside_the_ratio_range(polyurethane):
    assert np.all(polyurethane.draw(20000, 5).young_MPa(polyurethane.ratio_min) > 0)


def test_the_interval_of_the_modulus_is_widest_away_from_the_anchor(polyurethane):
    widths = []
    for ratio in (14.0, 15.0, 20.0):
        young = polyurethane.modulus_kPa(ratio)
        assert young.low < young.value < young.high
        widths.append(np.log(young.high / young.low))
    assert widths[1] < widths[0] and widths[1] < widths[2]


def test_a_measured_interval_holds_95_percent_of_its_draws_on_each_side():
    z = np.random.default_rng(0).standard_normal(200_000)
    for q in (quantity(10.0, 5.0, 12.0), quantity(0.5, -1.0, 3.0)):
        drawn = value_at(q, z)
        assert np.median(drawn) == pytest.approx(q.value, abs=0.01 * (q.high - q.low))
        assert np.mean(drawn < q.low) == pytest.approx(0.025, abs=0.002)
        assert np.mean(drawn > q.high) == pytest.approx(0.025, abs=0.002)


def test_an_assumed_number_never_leaves_its_range_and_has_its_value_as_median():
    z = np.random.default_rng(0).standard_normal(100_000)
    drawn = value_at(quantity(2.0, 1.0, 8.0, "assumed"), z)
    assert drawn.min() >= 1.0 and drawn.max() <= 8.0
    assert np.mean(drawn < 2.0) == pytest.approx(0.5, abs=0.01)


def test_recipe_masses_have_the_ratio_and_the_total(polyurethane):
    polyol, isocyanate = polyurethane.recipe(15.6, 250.0)
    assert (polyol.name, isocyanate.name) == ("polyol", "isocyanate")
    assert isocyanate.mass_g / polyol.mass_g == pytest.approx(0.156)
    assert polyol.mass_g + isocyanate.mass_g == pytest.approx(250.0)


def test_density_of_the_mixture_conserves_volume(polyurethane):
    parts = polyurethane.recipe(17.0, 100.0)
    by_name = {liquid.name: liquid.density_g_per_cm3.value for liquid in polyurethane.liquids}
    volume = sum(part.mass_g / by_name[part.name] for part in parts)
    assert polyurethane.property("density_g_per_cm3", 17.0).value == pytest.approx(100.0 / volume)


def test_more_of_the_thin_liquid_makes_the_mixture_thinner(polyurethane):
    viscosity = [polyurethane.property("viscosity_Pa_s", r).value for r in (14.0, 17.0, 20.0)]
    assert viscosity[0] > viscosity[1] > viscosity[2]


def test_ratios_come_in_weighable_steps_with_both_ends(polyurethane):
    ratios = polyurethane.ratios()
    assert ratios[0] == 14.0 and ratios[-1] == 20.0 and len(ratios) == 61
    np.testing.assert_array_equal(polyurethane.ratios(14.96, 15.23), [15.0, 15.1, 15.2])


def test_what_lies_outside_is_refused_with_range(polyurethane):
    with raises_code("out_of_range", "ratio"):
        polyurethane.young_MPa(13.0)
    with raises_code("out_of_range", "young_of_polyurethane_nagoya_kPa"):
        polyurethane.ratio_for(9.0)
    with raises_code("out_of_range", "total_g"):
        polyurethane.recipe(15.0, -1.0)
    with raises_code("unknown_name", "property"):
        polyurethane.property("pot_life", 15.0)


def test_ratio_for_a_modulus_is_the_inverse(polyurethane):
    assert polyurethane.ratio_for(polyurethane.young_MPa(16.3)) == pytest.approx(16.3)


def test_every_number_of_the_built_in_resin_says_where_it_is_read(polyurethane):
    def sources(value):
        if isinstance(value, dict):
            if "kind" in value and "value" in value:
                yield value["source"]
            for item in value.values():
                yield from sources(item)
        elif isinstance(value, list):
            for item in value:
                yield from sources(item)

    found = list(sources(polyurethane.to_dict()))
    assert len(found) > 15 and all(len(text) > 20 for text in found)
