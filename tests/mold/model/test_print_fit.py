"""Print fit of a machine: read with its sources, refused without, and what it changes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.mold.checks.process import check_process
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.products import PrintFit, read_machines
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import named
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

TEXT = """schema = 1\nname = "mine"\nbalance_resolution_g = 0.1
[printer]\nbed_x_mm = 220.0\nbed_y_mm = 220.0\nheight_mm = 250.0\nmargin_mm = 5.0
[vacuum_chamber]\ndiameter_mm = 250.0\nheight_mm = 230.0
[oven]\nshelf_x_mm = 400.0\nshelf_y_mm = 350.0\nheight_mm = 300.0\n"""


def quantity(name, value, source="a bar of 150 mm"):
    return f'[print_fit.{name}]\nvalue = {value}\nlow = 0.0\nhigh = 5.0\nkind = "measured"\nsource = "{source}"\n'


FIT = quantity("gap_per_side_mm", 0.15) + quantity("elephant_foot_mm", 0.3) + quantity("shrinkage_percent", 0.5)


def read(folder, text):
    (folder / "mine.toml").write_text(text)
    return read_machines("mine.toml", folder / "preset.toml")


def test_a_machine_keeps_its_fit_and_where_it_comes_from(tmp_path):
    machines, sources = read(tmp_path, TEXT + FIT)
    assert machines.fit == PrintFit(0.15, 0.3, 0.5) and machines.print_scale == pytest.approx(1 / 0.995)
    assert len(sources) == 3 and all("a bar of 150 mm" in line for line in sources)
    spec = replace(mould_spec(8.0, 60.0, 50.0), machines=machines)
    assert MouldSpec.from_dict(spec.to_dict()) == spec


def test_a_machine_without_fit_is_read_as_before(tmp_path):
    machines, sources = read(tmp_path, TEXT)
    assert machines.fit is None and sources == [] and machines.print_scale == 1.0 and machines.elephant_foot_mm == 0.0
    spec = replace(mould_spec(8.0, 60.0, 50.0), machines=machines)
    assert "fit" not in spec.to_dict()["machines"] and MouldSpec.from_dict(spec.to_dict()) == spec


@pytest.mark.parametrize(
    "text, code",
    [
        (FIT.replace('source = "a bar of 150 mm"\n', "", 1), "missing"),
        (quantity("gap_per_side_mm", 0.2), "missing"),
        (FIT + quantity("overhang_deg", 45.0), "unknown_key"),
        (FIT.replace("value = 0.3", "value = 1.3"), "out_of_range"),
        (FIT.replace("value = 0.5", "value = 4.0"), "out_of_range"),
    ],
)
def test_a_fit_without_sense_is_refused_with_file_and_quantity(tmp_path, text, code):
    with raises_code(code):
        read(tmp_path, TEXT + text)


def test_a_first_layer_that_spreads_too_far_for_the_bolts_fails_their_check():
    spec = mould_spec(8.0, 60.0, 50.0)
    for foot, status in ((0.2, "pass"), (0.26, "fail")):
        one = replace(spec, machines=replace(spec.machines, fit=PrintFit(0.2, foot, 0.0)))
        plan = pour_plan(one)
        assert named(check_process(one, plan, pour_warnings(one, plan)))["bolts_pass"].status == status


def test_the_sheet_says_what_to_set_in_the_slicer():
    spec = mould_spec(8.0, 60.0, 50.0)
    enlarged = replace(spec, machines=replace(spec.machines, fit=PrintFit(0.2, 0.2, 0.5)))
    for one, said in ((spec, "print a bar of 150 mm"), (enlarged, "enlarged by 0.5 %")):
        text = sheet_text(pour_sheet(one, pour_plan(one), []))
        assert said in text and "elephant's foot" in text
