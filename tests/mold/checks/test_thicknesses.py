"""Material behind points of a surface, along the inward normal."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.mold.checks.release import thicknesses_mm
from tests.mold.files.test_picture import box


def test_a_plate_is_as_thick_as_it_is_on_seams_of_its_triangles_too():
    corners, faces = box((0.0, 0.0, -3.0), (10.0, 10.0, 2.0))
    # On the diagonal of the square, on its middle, on an edge of the grid and off all of them.
    points = np.array([(2.0, 2.0, 2.0), (5.0, 5.0, 2.0), (0.5, 9.5, 2.0), (3.3, 7.1, 2.0)])
    up = np.tile((0.0, 0.0, 1.0), (4, 1))
    thick, exits = thicknesses_mm(corners[faces], points, up)
    assert thick == pytest.approx(np.full(4, 5.0), abs=2e-4)
    assert exits[:, 2] == pytest.approx(np.full(4, -3.0), abs=2e-4)


def test_rays_of_many_directions_meet_a_ball_where_geometry_says():
    """Chords of a ball through its surface, each along a direction of its own and one shared by all."""
    turn, rise = np.meshgrid(np.linspace(0, 2 * np.pi, 61), np.linspace(0, np.pi, 31), indexing="ij")
    grid = np.stack([np.sin(rise) * np.cos(turn), np.sin(rise) * np.sin(turn), np.cos(rise)], axis=-1) * 4.0
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    triangles = np.concatenate([np.stack(some, axis=2).reshape(-1, 3, 3) for some in ((a, b, c), (a, c, d))])
    points = triangles[::37].mean(axis=1)
    radius = np.linalg.norm(points, axis=1)
    thick, _ = thicknesses_mm(triangles, points, points / radius[:, None])
    assert thick == pytest.approx(np.full(len(points), 8.0), rel=0.01)
    low = points[points[:, 2] > 0.5]
    thick, _ = thicknesses_mm(triangles, low, np.tile((0.0, 0.0, 1.0), (len(low), 1)))
    assert thick == pytest.approx(2.0 * low[:, 2], rel=0.02)


def test_a_ray_that_meets_nothing_says_so():
    corners, faces = box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    thick, _ = thicknesses_mm(corners[faces], np.array([(5.0, 5.0, 1.0)]), np.array([(0.0, 0.0, 1.0)]))
    assert np.isinf(thick).all()
