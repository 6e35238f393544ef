"""A predicted pad is judged as the same pad of a suggestion is."""

from dataclasses import replace

import numpy as np
import pytest

import dummydesign
from dummydesign.design import measured_pad as verdict_of_traces
from dummydesign.design import pad_evaluator as verdict_of_pad
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad
from tests.support.refusal import raises_code


@pytest.mark.slow
def test_the_recommended_pad_has_the_presses_and_the_numbers_of_its_suggestion():
    told = dummydesign.suggest("forefinger", shape="slab", verify=False).to_dict()
    best = told["recommendation"]
    found = dummydesign.predict(
        best["thickness_mm"], resin=best["resin"], ratio=best["ratio"], tissue="forefinger"
    ).to_dict()
    for own, wanted in zip(found["conditions"], best["conditions"]):
        assert own["depth_mm"] == pytest.approx(wanted["depth_mm"], rel=2e-3)
        assert own["peak_force_N"] == pytest.approx(wanted["peak_force_N"], rel=3e-3)
    same = ("peaks_below", "peaks_above", "peaks", "subjects", "reads", "light", "not_reached")
    assert [found["verdict"][name] for name in same] == [told["verdict"][name] for name in same]


def test_with_one_force_law_a_predicted_shaped_pad_has_the_presses_of_the_design():
    """What `suggest` and `predict --tissue` differ by on a shaped pad is elements against table, nothing else."""
    shape, inputs = read_shape("crowned:5.1,3.8,7.8"), read_problem(Request("palm", shape="crowned", verify=False))
    resin = inputs.resin
    designed = verdict_of_pad.PadEvaluator(inputs).evaluate(shape, 10.0, 15.3)
    pad = Pad(10.0, resin.young_MPa(15.3), inputs.punch.radius_mm, prony=resin.prony(15.3), geometry=shape)
    pad = replace(pad, sides_mm=(14.0, 14.0))
    curve, young = elastic_curve(pad, "table"), {"low": 20.0, "high": 60.0}
    judged, predicted, _ = verdict_of_pad.verdict_of_pad(pad, curve, young, inputs.tissue, "average", Sampling())
    own, wanted = predicted.evaluation, designed.candidate.evaluation
    np.testing.assert_allclose(own.depth_mm, wanted.depth_mm, rtol=1e-9)
    for press, other in zip(own.presses, wanted.presses):
        np.testing.assert_allclose(press.peak_N, other.peak_N, rtol=1e-9)
    assert judged.shortfall.central == pytest.approx(designed.verdict.shortfall.central, rel=1e-9)


def test_a_pad_far_too_soft_is_out_of_reach_and_an_elastic_one_reads_low_and_both_are_red():
    soft = dummydesign.predict(12, young_kPa=3.0, tissue="palm").to_dict()["verdict"]
    elastic = dummydesign.predict(12, young_kPa=28.0, tissue="palm").to_dict()["verdict"]
    assert soft["light"] == "red" and soft["not_reached"] > 0 and soft["castings"]["out_of_reach"] > 0.9
    assert elastic["light"] == "red" and elastic["reads"] in ("low", "mixed") and elastic["peaks_below"] == 6
    assert elastic["shortfall"]["central"] > 1.2 and elastic["shortfall"]["quantity"] == "peak"


@pytest.mark.parametrize("module", [verdict_of_pad, verdict_of_traces])
def test_a_share_of_pads_is_as_certain_as_one_of_castings(module):
    assert 0.5 / np.sqrt(module.DRAWS) <= 0.015


def test_what_goes_with_a_tissue_is_said():
    with raises_code("not_applicable", "tissue"):
        dummydesign.predict(10, young_kPa=30, pad="cylinder:30", punch="plate", tissue="palm", fidelity="axisymmetric")
    with raises_code("implausible_unit", "young_kPa"):
        dummydesign.predict(10, young_kPa=0.025, depth_mm=[1])
    with raises_code("missing", "depth"):
        dummydesign.predict(10, young_kPa=25)
