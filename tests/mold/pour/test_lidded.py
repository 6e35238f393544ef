"""Lidded moulds: silicone of mould and lid apart, and the resin that the hot cavity takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.mold.client import without_cad
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.layout import layout, lid_volume_mm3, mould_volume_mm3, resin_volume_mm3
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.bill_of_materials import mould_cost
from dummydesign.mold.pour.plan import batch_of, pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.sheet_text import sheet_text


def lidded(thickness_mm=8.0, cure_C=70.0, length_mm=150.0, width_mm=120.0):
    spec = mould_spec(thickness_mm, length_mm, width_mm, preset="lidded")
    return replace(spec, pour=replace(spec.pour, cure_temperature_C=cure_C))


def text_of(spec):
    plan = pour_plan(spec)
    return sheet_text(pour_sheet(spec, plan, pour_warnings(spec, plan)))


def test_volumes_of_mould_and_lid_are_those_of_the_solids(lidded_parts):
    spec, parts = lidded_parts.spec, lidded_parts.parts
    assert lid_volume_mm3(spec) == pytest.approx(parts["lid"].volume_mm3, rel=1e-9)
    assert mould_volume_mm3(spec) == pytest.approx(parts["mould"].volume_mm3, rel=1e-3)  # but for the label


def test_mould_and_lid_are_two_pours_with_two_masses():
    spec = lidded()
    plan, answer = pour_plan(spec), without_cad(spec)
    assert 0.0 < plan.lid_silicone_mass_g < plan.silicone_mass_g
    assert answer["masses_g"]["silicone"] == plan.silicone_mass_g
    assert answer["masses_g"]["silicone (lid)"] == answer["pour"]["lid_silicone_mass_g"] == plan.lid_silicone_mass_g
    assert mould_cost(spec).silicone_g == pytest.approx(plan.silicone_mass_g + plan.lid_silicone_mass_g)
    text = text_of(spec)
    assert f"{plan.silicone_mass_g:.0f} g" in text and f"{plan.lid_silicone_mass_g:.0f} g for the lid" in text
    assert "silicone (lid)" not in without_cad(mould_spec(8.0, 60.0, 50.0))["masses_g"]


def test_the_hot_cavity_is_full_of_the_resin_that_was_poured_for_it():
    """Mass of the hot resin in the hot cavity, by the densities of both temperatures."""
    rng = np.random.default_rng(81)
    rings = 0
    for _ in range(100):
        size = np.round((rng.uniform(4.0, 30.0), *rng.uniform(55.0, 140.0, 2)), 1)
        spec = lidded(size[0], float(rng.uniform(45.0, 70.0)), *size[1:])
        plan, pour, warmer = pour_plan(spec), spec.pour, spec.pour.cure_temperature_C - spec.pour.room_temperature_C
        hot_mm3 = resin_volume_mm3(spec) * (1 + spec.tool.expansion_per_K * warmer) ** 3
        hot_g = hot_mm3 * 1e-3 * pour.density_g_per_cm3 / (1 + pour.resin_expansion_per_K * warmer) ** 3
        assert plan.pad_mass_g == pytest.approx(hot_g, rel=1e-9)
        # What stands over the cold cavity, in lid, backer and rings, is at least that.
        stems = sum(one.volume_mm3(spec.lid.lid_mm) for one in layout(spec).funnels)
        over = plan.fill_mass_g / pour.density_g_per_cm3 * 1e3 - resin_volume_mm3(spec)
        assert over >= stems + plan.riser_mm3 * (1 - 1e-9)
        rings += plan.riser_mm > 0.0
        assert ("ring of plasticine" in text_of(spec)) == (plan.riser_mm > 0.0)
    assert 5 < rings < 95


@pytest.mark.parametrize("spec", [lidded(cure_C=23.0), lidded(cure_C=6.0), mould_spec(8.0, 60.0, 50.0)])
def test_a_cold_cure_or_an_open_mould_needs_no_riser(spec):
    plan = pour_plan(spec)
    assert plan.riser_mm3 == plan.riser_mm == 0.0 and "plasticine" not in text_of(spec)
    assert plan.pad_mass_g == pytest.approx(1e-3 * spec.pour.density_g_per_cm3 * resin_volume_mm3(spec))


def test_a_pour_has_one_mass_on_sheet_screen_and_in_the_answer():
    rng = np.random.default_rng(82)
    for thickness in np.round(rng.uniform(3.5, 25.0, 60), 2):
        spec = mould_spec(float(thickness), 60.0, 50.0)
        plan = pour_plan(spec)
        shown = f"{batch_of(spec, spec.pour, plan).to_dict()['pour_g']:.1f} g"
        text = text_of(spec)
        assert f"pour {shown} of it into the mould" in text and f"Stop at -{shown}" in text
