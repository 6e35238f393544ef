"""Fields of caps under the square punch: grid lines, and an eighth against a quarter on another grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.shapes.bumped import Bumped
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.spatial.shaped_pad import (
    HALF_SIDE_MM,
    GridFineness,
    Load,
    field_lines,
    press_field,
    shaped_problem,
)


@pytest.mark.parametrize("pitch", [3.5, 5.0, 7.3])
def test_lines_lie_over_caps_and_between_them_and_beside_the_punchs_edge(pitch):
    lines = field_lines(pitch, 0.5, 2)
    assert lines[0] == 0.0 and lines[-1] == pytest.approx(0.5 * PAD_WIDTH_MM) and np.all(np.diff(lines) > 0.0)
    apart = [np.abs(lines - place).min() for place in (0.5 * pitch, HALF_SIDE_MM - 0.5, HALF_SIDE_MM + 0.5)]
    assert max(apart) < 1e-9
    inside = np.diff(lines)[lines[1:] < HALF_SIDE_MM]
    assert inside.max() < 0.3 * pitch


@pytest.mark.slow
def test_an_eighth_of_a_field_carries_an_eighth_of_what_a_quarter_on_another_grid_finds():
    """Caps of the middle and of the first ring touched, d/h 0.1, 150 x 120 mm: 3 %, what the cells change."""
    field, h = Bumped.proportioned(5.0, 0.3), 8.0
    _, (area,), stop = press_field(field, h, np.array([0.1]), 2)
    half = tuple(0.5 * side / h for side in (PAD_LENGTH_MM, PAD_WIDTH_MM))
    load = replace(Load(field, h, (HALF_SIDE_MM / h,) * 2, half), first=0.1)
    path = follow(shaped_problem(load, GridFineness(8, slope=0.8)), [0.1], 0.025, 0.04, 1e-3)
    assert stop is None and area == pytest.approx(4.0 * path.force[0] / 3.0 * h**2, rel=0.03)
