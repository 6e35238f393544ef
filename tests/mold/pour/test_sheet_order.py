"""The order of the pour, the plastic in the oven, acceptance and the list of what is needed."""

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.model.validate import validate
from dummydesign.mold.pour.acceptance import (
    COMPARED_DEPTH,
    acceptance_rows,
    force_per_thickness,
    measured_blanks,
    when_it_fails,
)
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials, screw_length_mm
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.steps import BLANK, MOVE, PREPARE, PourStep, order_faults, pour_steps
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import shape_spec
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

SHAPES = ("slab", "crowned:3,8,9", "layered:6,0.4", "boned:20,6")


def specs():
    found = [shape_spec(shape, 15.0) for shape in SHAPES]
    found += [
        mould_spec(8.0, 70.0, 60.0, preset="lidded"),
        mould_spec(8.0, 70.0, 60.0, resin="ecoflex-00-30", ratio=0.0),
    ]
    in_mould = mould_spec(8.0, 60.0, 50.0)
    return [*found, replace(in_mould, pour=replace(in_mould.pour, degas="mould"))]


@pytest.mark.parametrize("spec", specs(), ids=lambda spec: f"{spec.preset}-{spec.pad.name}-{spec.pour.degas}")
def test_nothing_that_was_levelled_is_moved_before_the_resin_has_gelled(spec):
    plan = pour_plan(spec)
    steps = pour_steps(spec, plan)
    assert order_faults(steps) == []
    # The rule sees a move: carry the mould to the balance or the oven before the cure.
    carried = [*steps[:-1], PourStep("Stand the mould on the balance.", (MOVE,)), steps[-1]]
    assert "not level or was moved" in " ".join(order_faults(carried))
    assert order_faults([*reversed(steps)])
    text = sheet_text(sheet.pour_sheet(spec, plan, pour_warnings(spec, plan)))
    assert "mould on the balance" not in text


def test_a_pour_without_degassing_or_with_a_plate_before_the_resin_is_out_of_order():
    steps = pour_steps(shape_spec("slab", 10.0), pour_plan(shape_spec("slab", 10.0)))
    assert order_faults([step for step in steps if step.acts != ("degas",)])
    closed = [step for step in steps if step.acts == ("close",)]
    assert "closed before" in order_faults([*closed, *steps])[0]


def test_a_plastic_that_softens_in_the_oven_is_refused():
    spec = mould_spec(8.0, 60.0, 50.0)
    assert spec.plastic.service_temperature_C > spec.pour.cure_temperature_C
    soft = replace(spec, plastic=replace(spec.plastic, name="petg", service_temperature_C=60.0))
    with raises_code("out_of_range", "plastic.service_temperature_C"):
        validate(soft)


@pytest.mark.parametrize("name", ["asa", "petg", "pla"])
def test_shipped_plastics_are_read_with_their_sources(tmp_path, name):
    from dummydesign.core.user_library import data_folder

    text = (data_folder() / "molds" / "open.toml").read_text().replace('plastic = "asa"', f'plastic = "{name}"')
    preset = tmp_path / "own.toml"
    preset.write_text(text)
    spec = mould_spec(8.0, 60.0, 50.0, preset=str(preset), resin="ecoflex-00-30", ratio=0.0)
    assert spec.plastic.name == name
    assert any("plastic service_temperature_C" in source for source in spec.sources)


def test_specifications_from_before_plastics_are_still_read():
    spec = mould_spec(8.0, 60.0, 50.0)
    old = {key: value for key, value in spec.to_dict().items() if key not in ("plastic", "acceptance")}
    read = MouldSpec.from_dict(old)
    assert read.plastic is None and read.acceptance == spec.acceptance
    assert order_faults(pour_steps(read, pour_plan(read))) == []


def test_what_a_thickness_costs_in_force_is_the_slope_of_the_pad_model():
    from dummydesign.pad.tables.slab import load_table

    spec = shape_spec("slab", 10.0)
    law = load_table("bonded")
    thick, thin = (law.force(COMPARED_DEPTH * 10.0, h, 1.0, PUNCH_RADIUS_MM) for h in (10.2, 9.8))
    assert force_per_thickness(spec) == pytest.approx(np.log(thick / thin) / np.log(10.2 / 9.8), rel=0.02)
    # A thicker pad is softer, the more so the thinner it is.
    assert force_per_thickness(shape_spec("slab", 5.0)) < force_per_thickness(shape_spec("slab", 20.0)) < 0.0
    assert force_per_thickness(shape_spec("boned:20,6,0,1", 15.0)) is None
    rows = acceptance_rows(spec, pour_plan(spec))
    assert {len(row) for row in rows} == {6}


def test_screws_go_through_what_they_hold():
    assert screw_length_mm(14.0) == 20 and screw_length_mm(15.1) == 25
    spec = mould_spec(8.0, 70.0, 60.0, preset="lidded")
    rows = bill_of_materials(materials(spec, pour_plan(spec), {"master": 1e5}))
    assert ("screws M4 x 20 with nuts and washers", "16", "frame on master") in rows
    assert any(row[0] == "ASA: master" and "g" in row[1] for row in rows)
    needed = {row[0] for row in rows}
    assert {name for name, _ in pour_plan(spec).components} <= needed


def test_sheet_and_check_agree_on_which_cure_needs_an_oven():
    from dataclasses import replace

    from dummydesign.mold.checks.process import check_process
    from dummydesign.mold.pour.plan import pour_plan
    from dummydesign.mold.pour.steps import pour_steps
    from dummydesign.mold.pour.warnings import pour_warnings

    spec = mould_spec(8.0, 60.0, 50.0)
    for warmer, oven in ((2.0, False), (5.0, False), (6.0, True)):
        pour = replace(spec.pour, cure_temperature_C=spec.pour.room_temperature_C + warmer)
        warm = replace(spec, pour=pour)
        plan = pour_plan(warm)
        # Drying, before the resin is opened, needs one with every cure.
        said = any("oven" in step.text for step in pour_steps(warm, plan) if PREPARE not in step.acts)
        checks = {one.id: one.status for one in check_process(warm, plan, pour_warnings(warm, plan))}
        assert said == oven and (checks["fits_oven"] != "skipped") == oven


def test_advice_for_a_step_that_fails_names_only_what_the_mould_has():
    words = {spec.preset + spec.pad.kind: " ".join(when_it_fails(spec)) for spec in specs()}
    printed = " ".join(when_it_fails(mould_spec(8.0, 70.0, 60.0, preset="printed")))
    assert "strike off" in words["openslab"] and "vent" not in words["openslab"]
    assert "strike off" not in words["lidded" + "slab"] and "vents" in words["lidded" + "slab"]
    assert "bone" in words["openboned"] and "strike off" not in words["openboned"]
    assert "silicone" not in printed and "leaks" in printed


def test_each_pad_of_a_mould_has_its_own_places_for_what_is_measured():
    assert measured_blanks(1).count(BLANK) == 1
    assert measured_blanks(3).count(BLANK) == 3 and "pad 3:" in measured_blanks(3)


@pytest.mark.parametrize("spec", specs(), ids=lambda spec: f"{spec.preset}-{spec.pad.name}-{spec.pour.degas}")
def test_every_oven_of_the_sheet_is_vented_and_the_cure_says_why(spec):
    plan = pour_plan(spec)
    text = sheet_text(sheet.pour_sheet(spec, plan, pour_warnings(spec, plan)))
    sentences = [one for one in text.replace("|", ".").split(".") if " oven" in one]
    assert sentences and all("vented oven" in one or "oven's air" in one for one in sentences)
    cure = pour_steps(spec, plan)[-1].text
    assert ("vented oven" in cure and "vapour" in cure) == spec.pour.cures_warm
    assert any(row[0] == "vented oven" for row in bill_of_materials(materials(spec, plan))) == spec.pour.cures_warm
