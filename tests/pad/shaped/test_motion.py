"""Shaped pads in motion at finite strain, beside the quick law and its stated error."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.finite_strain import nodes_of_motion, solve_ratio
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import predict_motion
from tests.support.refusal import raises_code

ARMS = (PronyTerm(0.02, 0.8), PronyTerm(0.4, 0.4))
CROWN = Crowned(20.0, 2.0, 9.0)
RADIUS_MM = 7.9


def solved(shape, depth, arms=ARMS, thickness_mm=8.0, speed=60.0, cells=8):
    motion = ramp_and_hold(speed, depth * thickness_mm, 1.0)
    nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / thickness_mm, arms)
    press = Case(RADIUS_MM / thickness_mm, 75.0 / thickness_mm, shape=shape, thickness_mm=thickness_mm)
    return solve_ratio(press, arms, *nodes, cells=cells)


def test_a_crown_that_does_not_relax_carries_what_the_quick_law_says_to_the_last_bit():
    path = solved(CROWN, 0.1, (PronyTerm(0.1, 0.0),))
    assert np.array_equal(path.force, path.separable)


@pytest.mark.slow
def test_at_small_strain_the_quick_law_holds_for_every_shape():
    for shape, within in ((CROWN, 5e-4), (Layered(4.0, 2.5), 4e-3)):
        path = solved(shape, 0.02, cells=12)
        assert path.ratio[int(np.argmax(path.separable))] == pytest.approx(1.0, abs=within)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [Layered(4.0, 3.0), Boned(14.0, 2.5, 7.0)], ids=lambda shape: shape.name)
def test_smaller_cells_under_a_flat_top_move_the_departure_by_a_hundredth_of_the_force_at_most(shape):
    coarse, fine = (solved(shape, 0.3, cells=cells) for cells in (12, 24))
    peak = int(np.argmax(fine.separable))
    assert fine.ratio[peak] > 1.02
    assert coarse.ratio[peak] == pytest.approx(fine.ratio[peak], abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [CROWN, Layered(5.0, 0.4), Boned(14.0, 2.5, 7.0)], ids=lambda shape: shape.name)
def test_the_finite_strain_force_lies_in_the_interval_of_the_quick_one(shape):
    pad = Pad(8.0, 0.04, RADIUS_MM, ARMS, geometry=shape)
    motion = ramp_and_hold(90.0, 0.25 * 8.0, 1.0)
    quick, full = (predict_motion(pad, motion, fidelity) for fidelity in ("axisymmetric", "viscoelastic"))
    moving = quick.time_s > 0.2 * quick.peak_time_s
    assert full.fidelity == "viscoelastic"
    assert np.all(full.force_N[moving] <= quick.force_high_N[moving] * 1.001)
    assert np.all(full.force_N[moving] >= quick.force_low_N[moving] * 0.999)
    assert full.steady_force_N == pytest.approx(quick.steady_force_N, rel=5e-3)


def test_a_pad_that_is_not_round_says_what_to_do_for_a_motion():
    pad = Pad(8.0, 0.04, RADIUS_MM, ARMS, geometry=Crowned(10.0, 2.0, ridge=1.0), sides_mm=(14.0, 14.0))
    with raises_code("unsupported", "shape"):
        predict_motion(pad, ramp_and_hold(50.0, 1.0, 0.5), "viscoelastic")


@pytest.mark.slow
def test_a_crown_that_folds_under_a_motion_is_refused_by_the_run_itself_with_the_time_and_the_depth():
    """Too steep to be cast, so that it folds early: at d/h 0.3 to 0.4."""
    with pytest.raises(NoAnswerError, match=r"the crown folds on to the pad .* depths 0\.3\d+ and .*; at 0\.0"):
        solved(Crowned(2.0, 6.0, 2.2), 0.45, thickness_mm=10.0, cells=16)
