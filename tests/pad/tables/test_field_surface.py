"""Fields of caps: what punch and field overlap by, and forces that grow with depth all over the table."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM, PUNCH_SIDE_MM
from dummydesign.geometry.shapes.bumped import Bumped
from dummydesign.pad.tables.bumped import RIM, fall_at_edge, overlap
from dummydesign.pad.tables.shape import TabulatedShapeLaw, load_shape_table, ratios
from studies.tables.designs import designs

DESIGN = designs()["bumped"]
HALF = 0.5 * PUNCH_SIDE_MM


def volume(shape, thickness, depth):
    """What the filleted punch and the undeformed field have in common, summed over a fine grid. [mm3]"""
    line = (np.arange(350) + 0.5) * HALF / 350.0
    x, y = np.meshgrid(line, line)
    rim = RIM * min(thickness, HALF)
    over = np.hypot(np.maximum(x - HALF + rim, 0.0), np.maximum(y - HALF + rim, 0.0))
    rise = rim - np.sqrt(np.maximum(rim**2 - over**2, 0.0))
    inside = np.where(over < rim, np.maximum(depth - shape.drop_mm(x, y) - rise, 0.0), 0.0)
    return 4.0 * inside.sum() * (HALF / 350.0) ** 2


@pytest.mark.slow
def test_the_overlap_is_the_volume_that_punch_and_field_have_in_common():
    """Without Hertz's term; a cap at the edge counts by a share of its own: within 4 % at the median and 25 %."""
    off = []
    for point in DESIGN.fresh(12, 5):
        shape, h = DESIGN.shape(point)
        for share in (0.3, 0.6, 0.95, 1.4):
            depth, tiny = share * shape.height_mm / PUNCH_RADIUS_MM, 1e-6
            ((ratio, _),) = overlap(point, np.array(depth), tiny)
            tip = tiny * np.exp(point[1]) * np.sqrt(shape.radius_mm / PUNCH_RADIUS_MM) * depth**1.5
            off.append(ratio * tip * PUNCH_RADIUS_MM**3 / volume(shape, h, share * shape.height_mm) - 1.0)
    assert np.median(np.abs(off)) < 0.04 and np.max(np.abs(off)) < 0.25


def test_the_slope_of_the_overlap_is_its_derivative():
    points = np.repeat(DESIGN.fresh(40, 6), 9, axis=0)
    depth, step = np.random.default_rng(2).uniform(1e-3, 0.4, len(points)), 1e-7
    for here, up, down in zip(*(overlap(points, depth + by, 0.1, 3.0) for by in (0.0, step, -step))):
        assert here[1] == pytest.approx((up[0] - down[0]) / (2.0 * step), rel=1e-4, abs=1e-4)


def test_the_overlap_starts_as_the_middle_cap_alone():
    points = DESIGN.fresh(20, 7)
    assert overlap(points, np.full(len(points), 1e-9), 3.0)[0][0] == pytest.approx(1.0, abs=1e-3)


def test_forces_of_fields_grow_with_depth_all_over_the_table():
    for point in DESIGN.fresh(60, 8):
        shape, h = DESIGN.shape(point)
        law = TabulatedShapeLaw(shape)
        depth = np.linspace(0.005, 1.0, 200) * float(law.depth_limit_mm(h, PUNCH_RADIUS_MM))
        assert np.all(np.diff(law.force(depth, h, 0.03, PUNCH_RADIUS_MM)) > 0.0)


def test_fields_start_between_a_cap_on_a_half_space_and_a_fifth_above_it():
    """d = 0.003 to 0.08 cap heights; the gel below stiffens a cap, and nothing there softens it."""
    for point in DESIGN.fresh(40, 10):
        shape, h = DESIGN.shape(point)
        depth = np.array([0.003, 0.01, 0.03, 0.06]) * shape.height_mm
        hertz = 16.0 / 9.0 * np.sqrt(shape.radius_mm) * depth**1.5
        early = depth < 0.9 * max(shape.grade_mm, 1e-9)
        over = (TabulatedShapeLaw(shape).force(depth, h, 1.0, PUNCH_RADIUS_MM) / hertz)[early]
        assert np.all(over > 0.97) and np.all(over < 1.25)


def test_a_field_alone_and_among_others_has_the_same_force():
    table, points = load_shape_table("bumped"), np.array([DESIGN.plain(point) for point in DESIGN.fresh(30, 9)])
    x = np.random.default_rng(3).uniform(0.01, 0.55, (30, 7))
    together = table.log_factor(points, np.repeat(np.arange(30)[:, None], 7, axis=1), x)
    for i in range(30):
        alone = table.log_factor(points[i : i + 1], np.zeros(7, dtype=int), x[i])
        assert alone[0] == pytest.approx(together[0][i], abs=1e-9)
        assert alone[1] == pytest.approx(together[1][i], abs=1e-6)


def test_the_slope_of_a_field_is_the_derivative_of_its_force_also_where_pieces_fade_into_each_other():
    table, points = load_shape_table("bumped"), np.array([DESIGN.plain(point) for point in DESIGN.fresh(40, 11)])
    x = np.random.default_rng(4).uniform(0.02, 0.55, (40, 30))
    row, step = np.repeat(np.arange(40)[:, None], 30, axis=1), 1e-6
    slope = table.log_factor(points, row, x)[1]
    up, down = (table.log_factor(points, row, x + sign * step)[0] for sign in (1.0, -1.0))
    off = np.abs(slope - (up - down) / (2.0 * step)) / (1.0 + np.abs(slope))
    # Within a step of a cap's first touch there is no one slope.
    assert np.quantile(off, 0.99) < 1e-4


@pytest.mark.parametrize("grade", [0.1, 0.6])
@pytest.mark.parametrize("pitch", [4.5, 5.5, 6.9])
def test_a_field_doubts_its_force_from_where_the_punchs_edge_comes_near_a_cap(pitch, grade):
    """Least fall along the edge by the shape itself; the solves have a fillet, and that of a slab takes 12 to 17 %."""
    shape, h = Bumped.proportioned(pitch, grade), 9.0
    table = load_shape_table("bumped")
    inputs = table.coordinates(ratios(shape, np.array([h]), np.array([PUNCH_RADIUS_MM])))
    along = np.linspace(0.0, 7.0, 400)
    fall = float(shape.drop_mm(np.full(400, 7.0), along).min()) / h
    assert fall_at_edge(inputs) == pytest.approx(fall, rel=0.06)  # a paraboloid for the cap
    doubt = table.response.doubt(inputs, np.zeros(4, int), np.array([0.4 * fall, 1.01 * fall, 0.25, 0.58]))
    assert doubt == pytest.approx([0.0, 0.15, 0.15, 0.0369], abs=1e-3)
    law = TabulatedShapeLaw(shape)
    assert law.relative_error(0.25 * h, h, PUNCH_RADIUS_MM) > 0.15 > 3.0 * law.relative_error(0.4 * fall * h, h, 7.9)
