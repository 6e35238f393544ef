"""A crown's height over the flat: limits from force, the record's force by the heights that were gauged."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.measurement.pad_record import read_record
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.pour.acceptance import (
    MOST_PERCENT,
    crown_change_percent,
    crown_limits,
    gauge_points,
    measured_crown,
    spread_mm,
)
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.printing import face_factor, height_words
from dummydesign.mold.pour.record import Measured, judge, record_pad
from dummydesign.mold.pour.warnings import pour_warnings
from dummydesign.pad.tables.shape import TabulatedShapeLaw
from tests.mold.pour.test_gauge_points import keep, record, typed
from tests.support.mould_checks import shape_spec
from tests.support.sheet_text import sheet_text

PALM = shape_spec("crowned:2.6,3.2,7.8", 10.0)
FOREFINGER = shape_spec("crowned:21.2,2,9.4", 4.5)
SITES = shape_spec("crowned:10,2,6,0,2,1,20", 6.0)
CROWNED = [PALM, FOREFINGER, SITES, shape_spec("crowned:5.1,3.8,7.8", 10.0), shape_spec("crowned:4,2,4", 8.0)]
FLAT = [shape_spec("slab", 10.0), shape_spec("boned:20,6", 15.0), shape_spec("layered:6,0.4", 15.0)]
UNKNOWN = [*FLAT, shape_spec("crowned:3,8,9,1", 15.0)]


def cast(spec, more=None, **off):
    """What was gauged of a pad that is off by so much at its points."""
    readings = {one.name: one.nominal_mm + off.get(one.name, off.get("all", 0.0)) for one in gauge_points(spec)}
    return Measured(tuple(readings.values()), pour_plan(spec).cast_mass_g, points=tuple(readings), **(more or {}))


def force(shape, thickness, depth):
    return float(TabulatedShapeLaw(read_shape(shape)).force(depth, np.array([thickness]), 1.0, PUNCH_RADIUS_MM)[0])


@pytest.mark.parametrize("spec", CROWNED, ids=lambda spec: str(spec.pad.shape))
def test_a_crown_as_designed_costs_nothing_and_each_length_acts_in_its_sense(spec):
    assert crown_change_percent(spec.pad) == 0.0
    made = record_pad(cast(spec), spec)
    assert made.force_percent == pytest.approx(0.0, abs=1e-9) and made.accepted and made.cast_shape == ""
    for name, sign in (("higher_mm", -1), ("thicker_mm", -1)):
        for step in (-0.02, 0.02):
            assert sign * step * crown_change_percent(spec.pad, **{name: step}) > 0.0
    # a blunter tip is touched over more of its face
    assert crown_change_percent(spec.pad, blunter=1.05) > 0.0 > crown_change_percent(spec.pad, blunter=0.95)


@pytest.mark.parametrize("spec", CROWNED, ids=lambda spec: str(spec.pad.shape))
def test_no_length_within_its_limits_changes_the_force_by_more_than_five_per_cent(spec):
    percent, pad = spec.acceptance.thickness_percent, spec.pad
    limits, shape = crown_limits(pad, percent), pad.shape
    for ends, nominal, change, step in (
        (limits.height_mm, shape.height_mm, lambda x: crown_change_percent(pad, higher_mm=x), 0.01),
        (limits.thickness_mm, pad.thickness_mm, lambda x: crown_change_percent(pad, thicker_mm=x), 0.01),
        (
            limits.tip_radius_mm,
            shape.radius_mm,
            lambda x: crown_change_percent(pad, blunter=1 + x / shape.radius_mm),
            0.1,
        ),
    ):
        for end, side in zip(ends, (-1, 1)):
            assert side * (end - nominal) >= 0.0 and abs(change(end - nominal)) <= MOST_PERCENT + 1e-6
            preset = abs(end - nominal) + step > pad.thickness_mm * percent / 100 and nominal == pad.thickness_mm
            # as wide as the force allows, but for the step in which it is read
            assert preset or abs(change(end - nominal + side * 1.02 * step)) > MOST_PERCENT
    tip = next(one for one in gauge_points(spec) if one.pressed)
    assert (tip.low_mm, tip.high_mm) == pytest.approx(limits.thickness_mm)
    assert spread_mm(spec) <= limits.thickness_mm[1] - limits.thickness_mm[0] + 1e-9


def test_a_palm_crown_that_was_accepted_is_refused_and_its_force_is_that_of_its_heights():
    """tip 10.25 and shoulder 6.78 of 10 and 6.8 mm: finite elements of this pad say -14.9 % (31.35 of 36.82 N/MPa)"""
    made = record_pad(cast(PALM, tip=0.25, shoulder=-0.02), PALM)
    own = force("crowned:2.6,3.47,7.8", 10.25, 2.5) / force("crowned:2.6,3.2,7.8", 10.0, 2.5)
    assert made.force_percent == pytest.approx(100 * (own - 1), rel=1e-6) == pytest.approx(-14.9, abs=0.5)
    assert not made.accepted and len(made.missed) == 1 and "height over the flat at tip 3.47" in made.missed[0]
    assert made.cast_shape == "crowned:radius=2.6,height=3.47,foot=7.8" and made.thickness_mm == pytest.approx(10.25)


@pytest.mark.parametrize("spec", CROWNED, ids=lambda spec: str(spec.pad.shape))
def test_a_pad_poured_too_thick_keeps_the_height_of_its_crown(spec):
    made = record_pad(cast(spec, all=0.05), spec)
    assert made.force_percent == pytest.approx(crown_change_percent(spec.pad, thicker_mm=0.05), rel=1e-6)
    assert made.cast_shape == "" and not any("height" in words for words in made.missed)
    assert made.thickness_sd_mm == pytest.approx(0.05)


def test_the_gauges_error_is_that_of_tip_and_shoulder_and_several_tips_are_averaged():
    for spec in (PALM, SITES):
        tips = len(spec.pad.shape.places_mm)
        made = record_pad(cast(spec, {"gauge_mm": 1e-3}), spec)
        tip, shoulder = (crown_change_percent(spec.pad, 1e-3), crown_change_percent(spec.pad, -1e-3, 1e-3))
        assert made.force_sd_percent == pytest.approx(np.hypot(tip / np.sqrt(tips), shoulder), rel=1e-6)
    high = measured_crown({"tip1": 6.1, "tip2": 6.2, "shoulder": 4.1}, SITES.pad)
    assert (high.higher_mm, high.thicker_mm, high.tips) == pytest.approx((0.05, 0.1, 2))


def test_a_height_that_the_gauge_cannot_tell_from_the_designed_one_leaves_the_shape_as_it_is():
    rough, fine = (cast(PALM, {"gauge_mm": gauge}, tip=0.06) for gauge in (0.05, 0.01))
    assert record_pad(rough, PALM).cast_shape == ""
    assert record_pad(fine, PALM).cast_shape == "crowned:radius=2.6,height=3.26,foot=7.8"
    assert record_pad(rough, PALM).force_percent == record_pad(fine, PALM).force_percent < 0.0


@pytest.mark.parametrize("spec", UNKNOWN, ids=lambda spec: str(spec.pad.shape))
def test_pads_without_a_crown_of_known_force_keep_the_preset_s_limits(spec):
    h, limits = spec.pad.thickness_mm, spec.acceptance
    assert crown_limits(spec.pad, limits.thickness_percent) is None and crown_change_percent(spec.pad) is None
    for one in gauge_points(spec):
        assert (one.low_mm, one.high_mm) == pytest.approx((one.nominal_mm - 0.03 * h, one.nominal_mm + 0.03 * h))
    assert spread_mm(spec) == pytest.approx(h * limits.spread_percent / 100)
    assert not any("height" in one.what for one in judge(cast(spec), spec))
    made = record_pad(cast(spec), spec)
    assert made.cast_shape == "" and made.force_sd_percent is None


def test_the_sheet_gives_nominal_and_limits_of_the_height_on_the_plug_and_on_the_pad():
    for spec in (PALM, FOREFINGER):
        low, high = crown_limits(spec.pad, spec.acceptance.thickness_percent).height_mm
        plan = pour_plan(spec)
        text = sheet_text(sheet.pour_sheet(spec, plan, pour_warnings(spec, plan)))
        nominal = spec.pad.shape.height_mm
        assert height_words(spec) in text and f"| {nominal:.2f} mm | {low:.2f} to {high:.2f} mm |" in text
        grow = face_factor(spec)
        found = [float(one) for one in re.findall(r"(\d+\.\d+)", height_words(spec))]
        assert found == pytest.approx([grow * nominal, grow * low, grow * high], abs=0.006)
    assert "measured" not in height_words(FLAT[0])


def test_a_campaign_presses_the_crown_that_was_cast(tmp_path, capsys):
    import json

    from dummydesign.measurement.campaign_file import read_campaign
    from tests.measurement.test_campaign import write

    folder = keep(tmp_path / "m", PALM)
    assert record(folder, typed(PALM, tip=0.25, shoulder=-0.02), PALM, "--json") == 1
    path = json.loads(capsys.readouterr().out)["files"]["record"]
    assert record(folder, typed(PALM, tip=0.25, shoulder=-0.02), PALM) == 1
    printed = capsys.readouterr().out
    assert "height over the flat at tip" in printed and re.search(r"-14\.\d \+- \d\.\d \(gauge\) % off", printed)
    campaign = tmp_path / "campaign"
    campaign.mkdir()

    def named(text):
        text = text.replace("thickness_mm = 15.0\n", "")
        return text.replace("young_kPa_nominal = 25.0", f'record = "{path}"')

    read = read_campaign(write(campaign, text=named))
    assert {str(trial.geometry) for trial in read.trials} == {"crowned:radius=2.6,height=3.47,foot=7.8"}
    assert {trial.thickness_mm for trial in read.trials} == {10.25}


def test_a_record_of_an_earlier_edition_reads_as_the_designed_shape(tmp_path):
    made = record_pad(cast(PALM, tip=0.25), PALM)
    plain = {key: value for key, value in made.to_dict().items() if key not in ("cast_shape", "force_sd_percent")}
    path = tmp_path / "record.json"
    import json

    path.write_text(json.dumps(plain))
    old = read_record(path)
    assert old == dataclasses.replace(made, cast_shape="", force_sd_percent=None)
