"""Hours and grams of the steps after an answer, and of both ways to a pad."""

from __future__ import annotations

import re
import shlex
from dataclasses import fields, replace
from types import SimpleNamespace

import pytest

from dummydesign.cli.entry import parser_of
from dummydesign.design import next_steps as module
from dummydesign.design.request import Request
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.geometry.shape_registry import read_shape
from tests.support.judged_pads import pad, ranges

WAIT, RING, MOULD = 24.0, 1.5, 8.0


@pytest.fixture(autouse=True)
def _known_hours(monkeypatch):
    made = SimpleNamespace(printing_h=MOULD, silicone_g=200.0, resin_g=60.0, filament_g=90.0)
    ring = SimpleNamespace(printing_h=RING, filament_g=12.0, resin_g=30.0)
    monkeypatch.setattr(module, "_mould", lambda answer: made)
    monkeypatch.setattr(module, "_curing_h", lambda answer: WAIT)
    monkeypatch.setattr(module, "_search_again", lambda inputs, batch: "dummydesign suggest")
    monkeypatch.setattr(module, "beyond_people", lambda forces, tissue: 1.0)
    monkeypatch.setattr(module, "ring_cost", lambda *given, **named: ring)


def answer(level, poured=0.875, mould=None, measured=False, known=0.25, need_none=(0.25, 0.25)):
    """An answer whose castings are usable to 87.5 % after a puck."""
    as_poured = SimpleNamespace(usable=poured, stands_for=need_none[0])
    after = SimpleNamespace(usable=0.875, stands_for=need_none[1])
    return SimpleNamespace(
        verdict=SimpleNamespace(level=level),
        best=SimpleNamespace(ratio=15.25, thickness_mm=4.5, shape=read_shape("crowned:21.2,2,9.4")),
        problem=SimpleNamespace(tissue=None),
        resin=SimpleNamespace(name="r", measured=measured),
        shares=SimpleNamespace(as_poured=as_poured, resin_known=SimpleNamespace(stands_for=known), after_puck=after),
        shape="crowned:21.2,2,9.4",
        request=SimpleNamespace(
            resin="r", mould=mould, protocol=SimpleNamespace(forces_N=(5.0,)), pad_mm=(150.0, 120.0), preset="open"
        ),
    )


INPUTS = {**{one.name: one.default for one in fields(Request)}, "tissue": "palm", "resin": "r", "condition": "bonded"}
INPUTS["out"] = "suggest-palm"


def test_a_settled_pad_is_cast_and_pressed_in_half_an_hour():
    cast, plan, press, compare = module.next_steps(answer("representative"), INPUTS)
    assert cast.hours == MOULD + WAIT and cast.cost == {"silicone": 200.0, "resin": 60.0}
    assert press.hours == 0.5 and compare.command == "dummydesign compare my-dummy/*.csv --tissue palm"
    assert plan.command.startswith(
        "dummydesign campaign new my-dummy --resin r --ratio 15.25 --pads 4.5 --shape crowned:"
    )


@pytest.mark.parametrize("level", ["stands_for", "usable_with_correction", "not_settled"])
def test_of_a_batch_that_was_measured_no_puck_is_asked_for(level):
    one = answer(level, measured=True)
    steps = module.next_steps(one, INPUTS)
    assert not any("puck" in f"{step.do} {step.command}" for step in steps) and "compare" in steps[-1].command
    assert [path.name for path in module.paths_of(one)] == ["pad at once"]


def test_the_steps_of_a_pad_can_be_typed_and_ask_for_the_same_test():
    own = {"punch": "round:10", "force_N": (2.0, 4.0), "velocity_mm_s": (50.0,), "hold_s": 5.0, "pad_mm": (80.0, 60.0)}
    given = {**INPUTS, **own, "condition": "frictionless", "deceleration_mm_s2": 9000.0}
    _, plan, _, compare = module.next_steps(answer("stands_for"), given)
    typed = parser_of("campaign").parse_args(shlex.split(plan.command)[2:])
    assert (typed.punch, typed.force, typed.velocity, typed.hold) == ("round:10", "2,4", "50", "5")
    assert (typed.pad, typed.contact, typed.pads, typed.ratio) == ("80x60", "frictionless", "4.5", 15.25)
    typed = parser_of("compare").parse_args(shlex.split(compare.command)[2:])
    assert (typed.punch, typed.force_N, typed.velocity_mm_s, typed.hold_s) == ("round:10", "2,4", "50", "5")
    assert typed.condition == "frictionless" and float(typed.deceleration_mm_s2) == 9000.0


def test_after_a_calibration_the_presses_of_the_next_dummy_are_compared(tmp_path, monkeypatch):
    """The first one's folder is there: a plan of its name goes elsewhere, and its presses would be judged again."""
    monkeypatch.chdir(tmp_path)
    _, plan, press, compare = module.next_steps(answer("stands_for"), {**INPUTS, "calibration": "c.json"})
    assert shlex.split(plan.command)[3] == "my-dummy-2" and "my-dummy-2/*.csv" in compare.command
    assert "my-dummy-2" in press.do
    (tmp_path / "my-dummy-2").mkdir()
    _, plan, press, compare = module.next_steps(answer("stands_for"), {**INPUTS, "calibration": "c.json"})
    assert shlex.split(plan.command)[3] == "my-dummy-3" and "my-dummy-3" in press.do and "my-dummy-3" in compare.command


def test_a_test_beyond_the_subjects_asks_for_people_first(monkeypatch):
    monkeypatch.setattr(module, "beyond_people", lambda forces, tissue: 1.2)
    steps = module.next_steps(answer("not_settled"), INPUTS)
    assert "people" in steps[0].do and "compare" in steps[-1].command
    assert "puck" in module.next_steps(answer("not_settled", poured=0.75), INPUTS)[1].command


def test_a_pad_that_is_not_settled_has_a_puck_first_with_its_curing_and_its_presses():
    for one in (answer("not_settled"), answer("usable_with_correction", poured=0.84)):
        steps = module.next_steps(one, INPUTS)
        assert [step.hours for step in steps] == [RING, WAIT + 0.5, None, None]
        assert steps[0].cost == {"filament": 12.0} and steps[1].cost == {"resin": 30.0}


@pytest.mark.parametrize(
    ("more", "puck"),
    [
        ({"poured": 0.86}, False),
        ({"poured": 0.84}, True),
        ({"need_none": (0.4, 0.9)}, False),
        ({"need_none": (0.4, 0.9), "known": 0.75}, True),
        ({"poured": 0.5, "need_none": (0.9, 0.9), "known": 0.75}, False),
        ({"poured": 0.5, "measured": True}, False),
    ],
)
def test_the_share_after_a_puck_decides_whether_one_comes_first(more, puck):
    steps = module.next_steps(answer("usable_with_correction", **more), INPUTS)
    assert ("puck" in steps[0].do) == puck


def test_the_mould_is_printed_while_the_puck_cures():
    puck, at_once = module.paths_of(answer("not_settled", poured=0.75))
    assert puck.printing_h == RING + MOULD and puck.calendar_h == RING + WAIT + 0.5 + WAIT
    assert puck.grams == {"silicone": 200.0, "filament": 102.0, "resin": 90.0} and puck.usable == 0.875
    assert at_once.usable == 0.75 and at_once.printing_h == MOULD and at_once.calendar_h == MOULD + WAIT
    # the words have the same hours, grams and days
    assert puck.text == "puck first, 9.5 h printing, 90 g, 3 days: 88 % usable"
    assert at_once.text == "pad at once, 8 h printing, 60 g, 2 days: 75 % usable"
    # of a mould that is kept nothing is printed but the ring
    puck, at_once = module.paths_of(answer("not_settled", mould="moulds/a"))
    assert puck.printing_h == RING and puck.grams["silicone"] == 0.0 and puck.grams["filament"] == 12.0


def test_printing_that_is_not_known_is_left_out_of_hours_and_days(monkeypatch):
    made = SimpleNamespace(printing_h=None, silicone_g=200.0, resin_g=60.0, filament_g=None)
    monkeypatch.setattr(module, "_mould", lambda answer: made)
    puck, at_once = module.paths_of(answer("not_settled", poured=0.75))
    assert [one.printing_h for one in (puck, at_once)] == [one.calendar_h for one in (puck, at_once)] == [None, None]
    assert puck.text == "puck first, 90 g, 3 days: 88 % usable"
    assert at_once.text == "pad at once, 60 g, 1 day: 75 % usable"


@pytest.mark.parametrize(("strict", "peak"), [(False, 0.6), (False, 1.9), (True, 0.7), (True, 0.9)])
def test_a_red_pad_whose_peaks_are_off_is_said_to_relax_on_the_side_on_which_its_peak_lies(monkeypatch, strict, peak):
    """on the safe side the peak is held to the highest subject's: it may lie above the lowest and still be too low"""
    band = replace(ranges(), strict=strict)
    readings = pad(peak)
    readings.depth_mm[:] = band.stiff_mm
    monkeypatch.setattr(module, "ranges_of", lambda targets: band)
    limits = verdict_limits()
    text = module.why_red(
        SimpleNamespace(
            targets=SimpleNamespace(limits=limits),
            best=SimpleNamespace(readings=readings),
            verdict=SimpleNamespace(castings={"over": 0.9, "out_of_reach": 0.0}),
        )
    )
    people, own, factor = (
        float(one) for one in re.findall(r"(\d+\.\d+) times| pad's (\d+\.\d+)", text) for one in one if one
    )
    side = -1.0 if peak > 1.0 else 1.0
    assert ("too little" in text) == (side > 0.0) and side * (people - own) > 0.0 and side * (factor - 1.0) > 0.0
    subject = (band.peak_high_N if strict or side < 0.0 else band.peak_low_N)[0]
    assert [people, own] == pytest.approx([subject / 5.0, readings.peak_N[0] / 5.0], abs=0.006)
    limit = limits.stands_shortfall if strict else limits.shortfall if side > 0.0 else 1.0 / limits.over
    assert factor == pytest.approx((subject / limit - 5.0) / (readings.peak_N[0] - 5.0), abs=0.051)


@pytest.mark.parametrize(("worst", "named"), [("out_of_reach", "--thickness"), ("over", "puck"), ("reads_low", "puck")])
def test_a_pad_within_the_limits_whose_castings_fail_is_not_said_to_relax_wrongly(monkeypatch, worst, named):
    """its peak is 2 % below all subjects, which a correction mends; what fails are castings"""
    band = ranges()
    readings = pad(0.98)
    readings.depth_mm[:] = band.stiff_mm
    monkeypatch.setattr(module, "ranges_of", lambda targets: band)
    castings = {"stands_for": 0.3, "with_correction": 0.59, "reads_low": 0.01, "over": 0.03, "out_of_reach": 0.02}
    text = module.why_red(
        SimpleNamespace(
            targets=SimpleNamespace(limits=verdict_limits()),
            best=SimpleNamespace(readings=readings),
            verdict=SimpleNamespace(castings={**castings, worst: 0.07}),
        )
    )
    assert named in text and "relax" not in text and "7 %" in text
