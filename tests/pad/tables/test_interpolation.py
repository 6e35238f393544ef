"""Grids with held ends: exact on the grid, on straight lines between, the end's value outside."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.interpolation import between, locate_on_grid

GRID = np.array([1.0, 2.0, 4.0, 8.0])


def test_grid_points_are_met_and_ends_are_held():
    low, part = locate_on_grid(GRID, np.array([-3.0, 1.0, 2.0, 3.0, 8.0, 9.0]))
    assert low + part == pytest.approx([0.0, 0.0, 1.0, 1.5, 3.0, 3.0], abs=1e-15)
    assert low.max() == 2 and part.max() == 1.0


def test_a_bilinear_function_is_exact_inside_and_held_outside():
    x, y = np.array([0.0, 0.5, 1.7, 3.0]), np.array([1.0, 5.0, 7.0])
    values = 2.0 + 3.0 * x - y[:, None] + 0.5 * x * y[:, None]
    rng = np.random.default_rng(4)
    at, over = rng.uniform(-1.0, 4.0, (6, 5)), rng.uniform(0.0, 9.0, (6, 5))
    u, v = np.clip(at, 0.0, 3.0), np.clip(over, 1.0, 7.0)
    assert between(at, over, x, y, values) == pytest.approx(2.0 + 3.0 * u - v + 0.5 * u * v, rel=1e-13)
