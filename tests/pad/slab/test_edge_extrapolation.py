"""A step between two rims is carried on to the sharp edge by the power with which their effect vanishes."""

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.shaped_pad import LEFT, LEFT_TO_SHARP
from dummydesign.pad.axisymmetric.sharp_edge import RIM_POWER, extrapolate_to_sharp

SHARP, WEIGHT = np.array([1.0, 3.0]), np.array([0.2, -0.1])


def with_rim(rim):
    return SHARP * np.exp(-WEIGHT * rim**RIM_POWER)


@pytest.mark.parametrize("rim", [0.1, 0.4])
def test_the_limit_of_a_power_law_is_exact_from_either_rim(rim):
    rough, fine = with_rim(rim), with_rim(0.5 * rim)
    step = np.log(fine / rough)
    assert extrapolate_to_sharp(fine, step, LEFT) == pytest.approx(SHARP, rel=1e-12)
    assert extrapolate_to_sharp(rough, step, 1.0 + LEFT) == pytest.approx(SHARP, rel=1e-12)


def test_the_share_of_shaped_pads_is_the_same_power_rounded():
    """0.42 for 2^-1.25; of a step of 1 %, what it carries on differs by 1e-5."""
    assert LEFT_TO_SHARP == pytest.approx(LEFT, rel=2e-3)
    assert extrapolate_to_sharp(1.0, 0.01, LEFT_TO_SHARP) == pytest.approx(
        extrapolate_to_sharp(1.0, 0.01, LEFT), abs=2e-5
    )
