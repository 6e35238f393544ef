"""The batch to mix: as much as the balance needs, the pour itself when the balance is good enough."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.mold.client import without_cad
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import (
    RATIO_ERROR_LIMIT_PERCENT,
    batch_of,
    batches_of,
    least_film_mm,
    pour_plan,
    spreading_time_s,
    witness_mass_g,
)
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import shape_spec
from tests.support.sheet_text import sheet_text

CROWN = mould_spec(4.5, 150.0, 120.0, kind="crowned", parameters=(("radius", 21.2), ("height", 2.0), ("foot", 9.4)))


def with_balance(spec, resolution_g):
    return replace(spec, machines=replace(spec.machines, balance_resolution_g=resolution_g))


def text_of(spec):
    plan = pour_plan(spec)
    return sheet_text(sheet.pour_sheet(spec, plan, pour_warnings(spec, plan)))


@pytest.mark.parametrize("spec", [CROWN, shape_spec("slab", 8.0), mould_spec(8.0, 40.0, 30.0, count=4)])
def test_a_small_pour_is_mixed_as_large_as_the_balance_needs_and_poured_as_before(spec):
    plan = pour_plan(spec)
    batch = batch_of(spec, spec.pour, plan)
    assert plan.ratio_error_percent > RATIO_ERROR_LIMIT_PERCENT and batch.raised
    assert batch.mix.total_g >= plan.batch_for_ratio_g > plan.batch_mass_g
    assert batch.mix.error_percent <= RATIO_ERROR_LIMIT_PERCENT
    assert sum(mass for _, mass in batch.mix.components) == pytest.approx(batch.mix.total_g)
    assert batch.pour_g == pytest.approx(spec.count * plan.fill_mass_g, abs=0.01)
    share = dict(batch.mix.components)["isocyanate"] / batch.mix.total_g
    assert share == pytest.approx(dict(spec.pour.components)["isocyanate"], rel=RATIO_ERROR_LIMIT_PERCENT / 100)


@pytest.mark.parametrize("spec", [with_balance(CROWN, 0.01), mould_spec(20.0, 150.0, 120.0)])
def test_with_a_good_balance_or_a_large_pad_the_batch_is_the_recipe(spec):
    plan = pour_plan(spec)
    batch = batch_of(spec, spec.pour, plan)
    assert not batch.raised and batch.mix.components == plan.components and batch.mix.total_g == plan.batch_mass_g
    assert batch.with_witness.total_g >= plan.batch_mass_g + witness_mass_g(spec.pour)


def test_sheet_list_and_answer_say_the_same_batch():
    plan = pour_plan(CROWN)
    answer = without_cad(CROWN)
    batch = answer["batch"]
    assert batch == batches_of(CROWN, plan) and {"components", "total_g", "pour_g"} <= set(batch)
    # The recipe's keys are as they were.
    assert answer["pour"]["components"] == plan.to_dict()["components"]
    assert answer["masses_g"]["polyol"] == dict(plan.components)["polyol"]
    text = text_of(CROWN)
    assert f"Mix {batch['total_g']:.1f} g and pour {batch['pour_g']:.1f} g" in text
    rows = bill_of_materials(materials(CROWN, plan))
    for part in batch["components"]:
        assert f"| {part['name']} | {part['mass_g']:.1f} | {sheet.BLANK} |" in text
        assert (part["name"], f"{part['mass_g']:.1f} g") in [row[:2] for row in rows]
    assert "mix at least" not in text


def test_a_witness_that_the_rest_does_not_hold_has_a_column_of_its_own():
    spec = with_balance(CROWN, 0.01)
    batch = batch_of(spec, spec.pour, pour_plan(spec))
    assert not batch.holds_witness and "mix with a witness puck, g" in text_of(spec)
    assert batch_of(CROWN, CROWN.pour, pour_plan(CROWN)).holds_witness
    assert "mix with a witness puck, g" not in text_of(CROWN)


def test_both_layers_have_a_batch():
    spec = shape_spec("layered:3,0.4", 8.0)
    plan = pour_plan(spec)
    found = batches_of(spec, plan)
    assert found["pour_g"] == pytest.approx(plan.fill_mass_g, abs=0.01)
    assert found["base"]["pour_g"] == pytest.approx(plan.base.fill_mass_g, abs=0.01)


def test_a_coarse_balance_never_asks_for_more_than_the_chamber_degasses():
    spec = with_balance(CROWN, 5.0)
    plan = pour_plan(spec)
    batch = batch_of(spec, spec.pour, plan)
    machines = spec.machines
    litres = 4.0 * batch.mix.total_g / spec.pour.density_g_per_cm3 * 1e-3
    cup_mm = min(machines.chamber_diameter_mm, machines.chamber_height_mm)
    assert litres <= 0.7854 * (cup_mm * 1e-2) ** 3 * 1.01 and batch.mix.total_g < plan.batch_for_ratio_g
    assert "small_batch" in {item["code"] for item in pour_warnings(spec, plan)}


@pytest.mark.parametrize("pad_mm", [(60.0, 60.0), (150.0, 120.0)])
def test_the_least_film_levels_itself_just_within_the_pot_life(pad_mm: tuple[float, float]) -> None:
    spec = mould_spec(10.0, *pad_mm)
    film_mm = least_film_mm(spec)
    needed_min = spec.pour.pour_and_degas_min + spreading_time_s(spec, spec.pour, film_mm) / 60
    assert needed_min == pytest.approx(spec.pour.pot_life_min)
