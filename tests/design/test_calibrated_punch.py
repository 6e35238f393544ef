"""A design for another punch than the campaign's takes of a calibration what holds there, or says why it cannot."""

from __future__ import annotations

import re
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.cli.text import FIRST
from dummydesign.design.assessment.warnings import _edges
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.calibration_file import write_calibration
from dummydesign.loop.fitting.fit import NORMAL_95
from dummydesign.loop.model.forward_model import BaseParameters
from dummydesign.pad.tables.slab import load_filleted, load_table
from tests.support.made_calibration import calibration as made_calibration
from tests.support.refusal import raises_code

YOUNG_MPA = 0.03
DEPTH_MM, THICKNESS_MM = np.array([0.5, 2.0]), 10.0


@pytest.fixture
def calibration(tmp_path):
    """File of a calibration whose law is 10 % too soft at 10 mm, of a campaign with a named punch or none."""

    def written(punch=None):
        base = BaseParameters(YOUNG_MPA, (0.05, 1.2), (0.3, 0.2))
        model = Model(base, (), (("", THICKNESS_MM),), np.array([[0.1], [0.0], [0.0]]))
        pad = {
            "young_kPa_expected": 30.0,
            "resin": None,
            "ratio": 15.0,
            "base": "bonded",
            "shape": "slab",
            "contact": "bonded",
            **({} if punch is None else {"punch": punch}),
        }
        return str(write_calibration(Calibration(model, model, "none", {}, 0.0, pad), tmp_path / "c.json"))

    return written


def _resolved(path, punch, **more):
    asked = Request("forefinger", punch=punch, calibration=path, shape="slab", thickness_mm=(5.0, 12.0), **more)
    return read_problem(asked)


def _force(inputs):
    return inputs.slab_law.force(DEPTH_MM, THICKNESS_MM, YOUNG_MPA, inputs.punch.radius_mm)


@pytest.mark.slow
def test_another_punch_is_designed_for_with_the_table_of_that_punch_and_says_what_is_left_behind(calibration):
    found = _resolved(calibration("square:14"), "round:16")
    plain = load_table(base="bonded").force(DEPTH_MM, THICKNESS_MM, YOUNG_MPA, 8.0)
    assert _force(found) == pytest.approx(plain, rel=1e-9)
    (said,) = [one["message"] for one in found.calibrated.warnings if one["code"] == "calibration_punch"]
    assert "square:14" in said and "round:16" in said
    assert found.resin.references[-1].startswith("calibration ")


def test_the_punch_of_the_campaign_takes_its_force_law_too(calibration):
    found = _resolved(calibration("round:16"), "round:16")
    plain = load_table(base="bonded").force(DEPTH_MM, THICKNESS_MM, YOUNG_MPA, 8.0)
    assert _force(found) / plain == pytest.approx(1.1, rel=1e-6)
    assert not [one for one in found.calibrated.warnings if one["code"] == "calibration_punch"]


@pytest.mark.slow
def test_a_file_without_a_punch_is_taken_for_the_standard_punch(calibration):
    law = _force(_resolved(calibration(), "square:14")) / _force(_resolved(calibration("round:16"), "square:14"))
    assert law == pytest.approx(1.1, rel=1e-6)


@pytest.mark.slow
def test_a_fillet_is_designed_for_with_the_table_of_that_fillet_and_the_law_of_a_campaign_under_it(calibration):
    table = load_filleted("bonded", 1.0 / 8.0).force(DEPTH_MM, THICKNESS_MM, YOUNG_MPA, 8.0)
    for pressed, found, warned in (("round:16, edge radius 1 mm", 1.1, False), ("round:16", 1.0, True)):
        made = _resolved(calibration(pressed), "round:16", edge_radius_mm=1.0)
        assert _force(made) / table == pytest.approx(found, rel=1e-6)
        assert any(one["code"] == "calibration_punch" for one in made.calibrated.warnings) == warned


@pytest.mark.parametrize(
    "punch, more, code",
    [
        ("ball:20", {}, "not_applicable"),
        ("square:14", {"base": "sliding"}, "not_applicable"),
        ("square:14", {"pad_mm": (40.0, 40.0)}, "not_applicable"),
    ],
)
def test_what_a_calibration_cannot_correct_is_refused_with_the_way_out(calibration, punch, more, code):
    with raises_code(code) as problem:
        _resolved(calibration("square:14"), punch, **more)
    assert "--calibration none" in str(problem.value)


def test_the_range_that_a_refusal_names_is_not_advised_to_be_widened(calibration):
    """The answer in that range advised --thickness again, and the wider range was refused with the first advice."""
    asked = Request("forefinger", punch="round:10", pad_mm=(40.0, 40.0), calibration=calibration(), shape="slab")
    with raises_code("not_applicable") as problem:
        read_problem(asked)
    named = re.search(r"--thickness (\S+):(\S+)", str(problem.value))
    low, high = (float(end) for end in named.groups())
    assert 3.0 <= low < high < 20.0
    found = read_problem(replace(asked, thickness_mm=(low, high)))
    assert found.allowed_mm == (low, high)
    best = SimpleNamespace(thickness_mm=high, ratio=float(found.ratio[1]))
    ((code, text),) = _edges(best, found)
    assert code == "at_edge" and "widen" not in text
    narrow = read_problem(replace(asked, thickness_mm=(low, high - 1.0)))
    assert "widen --thickness" in _edges(SimpleNamespace(thickness_mm=high - 1.0, ratio=best.ratio), narrow)[0][1]


@pytest.mark.slow
def test_a_calibration_of_another_resin_is_named_as_one(tmp_path):
    def written(name, ratio):
        made = made_calibration(pad={"resin": name, "ratio": ratio})
        return str(write_calibration(made, tmp_path / f"{ratio:g}.json"))

    with raises_code("inconsistent", "calibration.ratio"):
        _resolved(written("sister-of-it", 10.0), "square:14")
    codes = [one["code"] for one in _resolved(written("sister-of-it", 15.0), "square:14").calibrated.warnings]
    assert "calibration_resin" in codes and "calibration_resin" in FIRST


def test_a_ratio_of_other_liquids_leads_to_no_recipe(tmp_path):
    made = made_calibration(pad={"resin": "ecoflex-00-30", "ratio": 15.0})
    with raises_code("inconsistent", "calibration.resin"):
        _resolved(str(write_calibration(made, tmp_path / "c.json")), "square:14")


def test_a_calibration_without_a_ratio_leads_to_no_recipe(tmp_path):
    made = made_calibration(pad={"resin": None, "ratio": None})
    with raises_code("missing", "calibration.ratio") as problem:
        _resolved(str(write_calibration(made, tmp_path / "c.json")), "square:14")
    assert "campaign.toml" in str(problem.value) and "\n" not in str(problem.value)


def _known_to(spreads):
    """A calibration whose posterior has these standard deviations of ln modulus and ln strengths."""
    made = made_calibration()
    return replace(made, posterior=replace(made.posterior, covariance=np.diag(np.square(spreads))))


def test_a_modulus_that_the_campaign_leaves_undetermined_is_refused(tmp_path):
    """0.2 to 2e4 kPa: ln of it is known to 2.9 (95 % within a factor of 300)."""
    path = str(write_calibration(_known_to([2.9, 0.01, 0.01, 0.01, 0.01]), tmp_path / "c.json"))
    with raises_code("not_enough_data", "calibration.young_kPa"):
        _resolved(path, "square:14")


@pytest.mark.parametrize(("factor", "refused"), [(2.95, False), (3.05, True)])
def test_a_modulus_is_used_when_it_is_known_within_a_factor_of_three(tmp_path, factor, refused):
    own = np.sqrt((np.log(factor) / NORMAL_95) ** 2 - 0.004**2)
    path = str(write_calibration(_known_to([own, 0.01, 0.01, 0.01, 0.01]), tmp_path / "c.json"))
    with raises_code("not_enough_data", "calibration.young_kPa") if refused else nullcontext():
        _resolved(path, "square:14")


def test_an_interval_is_even_in_the_logarithm_and_a_strength_that_is_not_known_is_named(tmp_path):
    path = str(write_calibration(_known_to([0.4, 0.01, 0.01, 0.01, 1.0]), tmp_path / "c.json"))
    found = _resolved(path, "square:14").calibrated
    (point,), arm = found.resin.points, found.resin.arms[1].beta
    width = NORMAL_95 * np.hypot(0.4, 0.004)
    ends = [point.young_kPa.low / 30.0, point.young_kPa.high / 30.0]
    assert np.log(ends) == pytest.approx([-width, width], rel=1e-9)
    assert np.log([arm.low / 0.2, arm.high / 0.2]) == pytest.approx([-NORMAL_95, NORMAL_95], rel=1e-9)
    assert [one["code"] for one in found.warnings] == ["calibration_relaxation"]
