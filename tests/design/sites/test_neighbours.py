"""Crowns among others: solved bounds of what neighbours and rim change, and the solve in space between them."""

from dataclasses import dataclass

import numpy as np
import pytest

from dummydesign.design.sites.neighbours import Alone, Marked
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes import read_shape
from dummydesign.geometry.standard import PUNCH_RADIUS_MM

CROWN = read_shape("crowned:radius=21.2,height=2,foot=9.4")


@pytest.fixture(scope="module")
def alone():
    return Alone(CROWN, 4.5, PUNCH_RADIUS_MM, 1.7)


def test_a_ring_has_the_crown_inside_and_the_full_thickness_outside():
    ringed, r = Marked(CROWN, 15.0, True), np.array([0.0, 4.0, 9.4, 13.9, 15.0, 40.0])
    np.testing.assert_allclose(ringed.drop_mm(r, 0 * r)[:4], CROWN.drop_mm(r[:4], 0 * r[:4]))
    np.testing.assert_array_equal(ringed.drop_mm(r, 0 * r)[4:], 0.0)


def test_a_neighbour_stiffens_and_a_rim_softens_and_both_die_out_with_distance(alone):
    near, far = alone.stiffer(21.5), alone.stiffer(26.0)
    assert near > 0.005 > far > -1e-5
    close, away = alone.softer(13.0), alone.softer(20.0)
    assert close < -0.01 < away < 1e-5


@dataclass(frozen=True)
class Among(PadShape):
    """A crown and the eight around it."""

    name = "among"
    pitch_mm: float

    @property
    def axisymmetric(self):
        return False

    @property
    def flat_top(self):
        return False

    @property
    def relief_mm(self):
        return CROWN.relief_mm

    def lines_mm(self):
        return CROWN.lines_mm()

    def drop_mm(self, x_mm, y_mm):
        places = [(i * self.pitch_mm, j * self.pitch_mm) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        return np.min([CROWN.drop_mm(x_mm - x, y_mm - y) for x, y in places], axis=0)


@pytest.mark.slow
def test_eight_neighbours_solved_in_space_under_the_square_punch_change_less_than_the_bound(alone):
    from dummydesign.pad.shaped.spatial import solve_shaped_block

    depth = np.array([1.7])
    one, nine = (solve_shaped_block(shape, 4.5, (7.0, 7.0), 1.0, depth) for shape in (CROWN, Among(22.0)))
    change = float(nine.force_N[-1] / one.force_N[-1] - 1.0)
    assert -2e-3 < change < alone.stiffer(22.0)
