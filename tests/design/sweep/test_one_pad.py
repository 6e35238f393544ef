"""One pad looked at by itself: the same verdict and depths as the search gives, at any thickness and ratio."""

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.pad_evaluator import PadEvaluator, law_of_shape, one_pad
from dummydesign.design.plot_data import force_grids
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.suggest import design
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab


@pytest.fixture(scope="module")
def inputs():
    return read_problem(Request("forefinger", shape="slab", verify=False))


@pytest.mark.slow
def test_the_recommended_pad_gets_the_verdict_and_the_curve_of_the_suggestion(inputs):
    found = design(inputs)
    best = found.best
    evaluator = PadEvaluator(inputs)
    pad = evaluator.evaluate(Slab(), best.thickness_mm, best.ratio)
    held = replace(inputs.request, thickness_mm=(best.thickness_mm,) * 2, ratio=(best.ratio,) * 2)
    assert evaluator.with_castings(Slab(), best.thickness_mm, best.ratio) == design(read_problem(held)).verdict
    grids = force_grids(found.targets.protocol)
    assert np.array_equal(pad.candidate.steady_depth_mm(grids.pad), best.steady_depth_mm(grids.pad), equal_nan=True)


def test_a_softer_pad_is_deeper_at_every_force(inputs):
    law = law_of_shape(inputs.slab_law, Slab(), 5.0)
    soft, stiff = (one_pad(law, inputs, 5.0, ratio) for ratio in (15.0, 15.4))
    assert inputs.resin.young_MPa(15.0) < inputs.resin.young_MPa(15.4)
    force = np.array([1.0, 5.0, 10.0])
    assert (soft.candidate.steady_depth_mm(force) > stiff.candidate.steady_depth_mm(force)).all()


def test_a_pad_out_of_reach_is_judged_red_and_not_refused(inputs):
    pad = one_pad(law_of_shape(inputs.slab_law, Slab(), 10.0), inputs, 10.0, 14.0)
    assert pad.verdict.level == "not_representative" and pad.verdict.not_reached == 6


def test_a_shape_that_does_not_fit_its_pad_is_refused(inputs):
    with pytest.raises(InputError):
        law_of_shape(inputs.slab_law, read_shape("crowned:20,2,9"), 3.0)
