"""Pouring shaped pads: masses, the base of a layered pad, and what the pour sheet tells."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from dummydesign.mold.cad.build import cavity_solid, pad_solid
from dummydesign.mold.checks import process as check_process
from dummydesign.mold.client import without_cad
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.model.layout import layout
from dummydesign.mold.pour.plan import batch_of, pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from dummydesign.resin import load_resin
from tests.support.mould_checks import shape_spec
from tests.support.sheet_text import sheet_text


def test_base_is_mixed_to_the_ratio_of_moduli():
    resin = load_resin()
    for wanted in (0.4, 1.0, 3.0):
        spec = shape_spec(f"layered:3,{wanted}", 8.0)
        found = resin.young_MPa(spec.base.pour.ratio) / resin.young_MPa(spec.pour.ratio)
        assert found == pytest.approx(wanted, rel=1e-9) == pytest.approx(spec.base.modulus_ratio)
    typed = shape_spec("layered:3,0.4", 8.0, base_ratio=14.5)
    assert typed.base.pour.ratio == 14.5
    assert "modulus_ratio" in {item["code"] for item in pour_warnings(typed, pour_plan(typed))}


def test_masses_come_from_volumes_and_layers_sum_to_the_pad():
    for text, thickness in (("crowned:3,8,9", 15.0), ("boned:20,6", 15.0)):
        spec = shape_spec(text, thickness)
        solid = pad_solid(spec.pad).Volume() * layout(spec).scale ** 3
        assert pour_plan(spec).pad_mass_g == pytest.approx(solid * spec.pour.density_g_per_cm3 * 1e-3, rel=1e-9)
    spec = shape_spec("layered:3,0.4", 8.0)
    plan = pour_plan(spec)
    whole = cavity_solid(spec.pad).Volume() * layout(spec).scale ** 3
    assert plan.cavity_mm3 + plan.base.cavity_mm3 == pytest.approx(whole, rel=1e-9)
    masses = without_cad(spec)["masses_g"]
    assert list(masses) == ["polyol", "isocyanate", "polyol (base)", "isocyanate (base)", "silicone"]
    assert masses["isocyanate (base)"] / masses["polyol (base)"] == pytest.approx(spec.base.pour.ratio / 100, rel=0.05)


TOLD = {
    "crowned:3,8,9": ("tip radius 3 mm, height 8 mm", "layers of at most 0.1 mm", "pour by mass"),
    "layered:6,0.4": ("UPPER LAYER FIRST", "BASE LAYER SECOND", "spacer", "Gelled at", "still tacky"),
    "boned:20,6": ("prime", "every vent shows resin", "must not float", "stays on its plate", "carrier with the bone"),
    "boned:20,6,0,1": ("bar along the length", "film of gel covers its ends"),
}


@pytest.mark.parametrize("text", TOLD)
def test_pour_sheet_says_what_the_shape_needs(text):
    spec = shape_spec(text, 15.0)
    plan = pour_plan(spec)
    warnings = pour_warnings(spec, plan)
    written = sheet_text(sheet.pour_sheet(spec, plan, warnings))
    for words in (*TOLD[text], spec.pad.title, f"{plan.fill_mass_g:.1f} g"):
        assert words in written
    assert f"{spec.pad.kind}:" not in written  # no raw parameters
    assert [c.id for c in check_process.check_process(spec, plan, warnings) if c.status == "fail"] == []
    told = {"curved_master", "layer_bond", "bone_air"} & {item["code"] for item in warnings}
    assert told
    for code in told:
        rest = [item for item in warnings if item["code"] != code]
        assert "warnings_told" in [c.id for c in check_process.check_process(spec, plan, rest) if c.status == "fail"]


def test_two_pours_are_weighed_apart_and_in_their_order():
    spec = shape_spec("layered:6,0.4", 15.0)
    plan = pour_plan(spec)
    written = sheet_text(sheet.pour_sheet(spec, plan, pour_warnings(spec, plan)))
    assert written.index("UPPER LAYER FIRST") < written.index("Gelled at") < written.index("BASE LAYER SECOND")
    for pour, part in ((spec.pour, plan), (spec.base.pour, plan.base)):
        for name, mass in batch_of(spec, pour, part).mix.components:
            assert re.search(rf"\| {name} \| {mass:.1f} \|", written)
    assert f"--ratio {spec.base.pour.ratio:.6g}" in written
    light = replace(plan, base=replace(plan.base, components=(("polyol", 1.0), ("isocyanate", 0.2)), batch_mass_g=1.2))
    failed = [c.id for c in check_process.check_process(spec, light, pour_warnings(spec, plan)) if c.status == "fail"]
    assert "batch_covers_cavity_base" in failed
