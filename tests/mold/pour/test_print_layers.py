"""Layers of the print: a low tip costs what the response table says, and a printer too coarse is refused."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.mold import client
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.products import read_machines
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.printing import (
    allowed_layer_mm,
    check_layers,
    height_cost,
    printed_thickness_mm,
    rounding_cost,
)
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import shape_spec
from tests.support.refusal import raises_code

CROWN = shape_spec("crowned:10,2", 5.0)


def coarse(spec, layer):
    return replace(spec, machines=replace(spec.machines, layer_mm=layer))


def test_a_lower_tip_costs_force_in_proportion_and_none_on_a_flat_face():
    costs = np.array([height_cost(CROWN, low) for low in (0.01, 0.02, 0.04)])
    assert np.all(costs > 0) and costs / costs[0] == pytest.approx([1.0, 2.0, 4.0], rel=0.05)
    assert height_cost(mould_spec(5.0), 0.05) == 0.0 and allowed_layer_mm(mould_spec(5.0)) is None


def test_half_the_allowed_layer_costs_one_per_cent():
    for spec in (CROWN, shape_spec("crowned:20,2,9", 8.0), shape_spec("crowned:10,4", 15.0)):
        assert abs(height_cost(spec, allowed_layer_mm(spec) / 2)) == pytest.approx(1.0, rel=0.05)


def test_a_flatter_share_of_the_thickness_makes_the_height_less_critical():
    assert allowed_layer_mm(shape_spec("crowned:10,4", 15.0)) > 3 * allowed_layer_mm(CROWN)


def test_a_printer_too_coarse_is_refused_before_anything_is_written_and_a_fine_one_is_not(tmp_path):
    with raises_code("out_of_range", "layer_mm"):
        client.make_mold(coarse(CROWN, 0.2), tmp_path / "m")
    assert list(tmp_path.iterdir()) == []
    for spec in (coarse(CROWN, 0.01), CROWN, coarse(mould_spec(5.0), 0.1)):
        check_layers(spec)


def test_the_warning_says_what_the_layers_cost():
    words = " ".join(item["message"] for item in pour_warnings(CROWN, pour_plan(CROWN)))
    assert "change the force by 1 %, layers of 0.1 mm by up to 4" in words


def test_the_printers_layer_is_read_and_machines_without_one_keep_their_hash(tmp_path):
    text = """schema = 1\nname = "mine"\nbalance_resolution_g = 0.1
[printer]\nbed_x_mm = 220.0\nbed_y_mm = 220.0\nheight_mm = 250.0\nmargin_mm = 5.0\nlayer_mm = 0.2
[vacuum_chamber]\ndiameter_mm = 250.0\nheight_mm = 230.0
[oven]\nshelf_x_mm = 400.0\nshelf_y_mm = 350.0\nheight_mm = 300.0\n"""
    (tmp_path / "mine.toml").write_text(text)
    found, _ = read_machines("mine.toml", tmp_path / "preset.toml")
    assert found.layer_mm == 0.2 and "layer_mm" not in CROWN.to_dict()["machines"]
    spec = replace(CROWN, machines=found)
    assert MouldSpec.from_dict(spec.to_dict()) == spec and spec.hash != CROWN.hash
    (tmp_path / "mine.toml").write_text(text.replace("layer_mm = 0.2", "layer_mm = 20.0"))
    with raises_code("out_of_range", "layer_mm"):
        read_machines("mine.toml", tmp_path / "preset.toml")


@pytest.mark.parametrize("given", [{"preset": "open"}, {"preset": "lidded"}, {"face_sheet_mm": 3.0}])
def test_whole_layers_make_the_thickness_within_a_layer_and_exact_in_the_limit(given):
    spec = mould_spec(8.0, 80.0, 70.0, **given)
    for layer in (0.3, 0.2, 0.12):
        # Four heights are rounded, each by half a layer at most.
        assert abs(printed_thickness_mm(spec, layer) - 8.0) <= 2 * layer
    assert printed_thickness_mm(spec, 1e-6) == pytest.approx(8.0, abs=4e-6)


def test_a_pad_as_thick_as_its_print_is_printed_exactly():
    first = mould_spec(5.0)
    again = mould_spec(printed_thickness_mm(first, 0.2))
    assert printed_thickness_mm(again, 0.2) == pytest.approx(again.pad.thickness_mm, abs=1e-9)
    assert rounding_cost(again, 0.2) == pytest.approx(0.0, abs=1e-6)


def test_a_thinner_print_is_stiffer_and_one_that_costs_more_than_a_per_cent_is_refused_with_a_layer_that_does():
    spec = coarse(mould_spec(5.0), 0.3)
    assert printed_thickness_mm(spec, 0.3) < 5.0 and rounding_cost(spec, 0.3) > 1.0
    with raises_code("out_of_range", "layer_mm") as refused:
        check_layers(spec)
    check_layers(coarse(spec, float(re.search(r"layers of (\S+) mm do", str(refused.value))[1])))
    codes = {item["code"]: item["message"] for item in pour_warnings(coarse(spec, 0.1), pour_plan(spec))}
    assert "% of force" in codes["print_layers"]


def test_a_low_bone_leaves_more_gel_and_less_force():
    spec = shape_spec("boned:26.7,3.6,13.4", 6.0)
    costs = np.array([height_cost(spec, low) for low in (0.02, 0.04)])
    assert np.all(costs < 0) and costs[1] / costs[0] == pytest.approx(2.0, rel=0.1)
    assert allowed_layer_mm(spec) is not None
