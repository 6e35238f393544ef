"""Slabs pressed in one's own way agree with what is solved directly."""

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.fe_force_law import SlabLawForTest, Solved, near_rim, own_slab_law, solve_over_table
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import load_table

RADIUS = 7.9


def pad(**more):
    return Pad(**({"thickness_mm": 10.0, "young_MPa": 1.0, "radius_mm": RADIUS, "extent_mm": 75.7} | more))


def test_between_solved_thicknesses_a_factor_that_is_a_power_law_is_exact():
    share = np.geomspace(0.03, 0.6, 6)
    solved = tuple(Solved(h, share, 0.3 * np.log(h) + 0.1 * np.log(share), np.full(6, 0.01)) for h in (4.0, 8.0, 20.0))
    table = load_table("bonded")
    law = SlabLawForTest(table, solved, 0.0)
    depth, h = np.array([0.2, 1.0, 3.0]), np.array([5.0, 11.0, 17.0])
    wanted = table.force(depth, h, 1.0, RADIUS) * h**0.3 * (depth / h) ** 0.1
    np.testing.assert_allclose(law.force(depth, h, 1.0, RADIUS), wanted, rtol=1e-9)
    np.testing.assert_allclose(law.relative_error(depth, h, RADIUS), 0.01)


def test_only_a_rim_that_is_felt_is_solved():
    assert not near_rim(pad(), 10.0) and not near_rim(pad(extent_mm=60.0), 5.0)
    assert near_rim(pad(extent_mm=20.0), 10.0) and not near_rim(pad(extent_mm=20.0), 2.0)


@pytest.mark.slow
def test_a_small_pad_is_softer_by_what_the_whole_solve_says():
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve

    table, small = load_table("bonded"), pad(extent_mm=2.2 * RADIUS)
    found = solve_over_table(table, small, 8.0)
    depth = np.array([0.15, 0.3]) * 8.0
    pads = (Pad(8.0, 1.0, RADIUS, extent_mm=e) for e in (2.2 * RADIUS, 75.7))
    own, large = (solve_curve(one, depth, independent=True).force_N for one in pads)
    factor = np.exp(np.interp(np.log([0.15, 0.3]), np.log(found.share), found.log_factor))
    np.testing.assert_allclose(factor, own / large, rtol=0.004)
    assert factor[0] < 0.97


def test_at_a_solved_depth_the_law_of_a_filleted_punch_is_its_own_solve_in_millimetres(monkeypatch):
    monkeypatch.setattr("dummydesign.pad.fe_force_law.SHARES", np.array([0.03, 0.06]))
    law = own_slab_law(load_table("bonded"), pad(edge_radius_mm=0.5), np.array([8.0]))
    depth = np.array([0.03, 0.06]) * 8.0
    direct = solve_under_fillet(pad(thickness_mm=8.0, young_MPa=0.05, edge_radius_mm=0.5), depth)
    np.testing.assert_allclose(law.force(depth, 8.0, 0.05, RADIUS), direct.force_N, rtol=1e-6)
    np.testing.assert_allclose(law.relative_error(depth, 8.0, RADIUS), direct.error_N / direct.force_N, rtol=1e-6)


def test_what_a_near_rim_takes_is_smooth_in_depth_and_its_error_counts_the_table_s():
    table = load_table("bonded")
    found = solve_over_table(table, pad(extent_mm=2.2 * RADIUS), 8.0)
    # under a fillet whose points are held one by one it went up and down by half a per cent
    slope = np.diff(found.log_factor) / np.diff(found.share)
    assert (slope > 0.0).all() and slope.max() < 2.0 * slope.min()
    # as deep as the table goes
    assert found.share[-1] * 8.0 == pytest.approx(float(table.depth_limit_mm(8.0, RADIUS)), rel=1e-6)
    assert (found.error > table.relative_error(found.share * 8.0, 8.0, RADIUS)).all()


@pytest.mark.slow
def test_a_fillet_between_solved_thicknesses_is_that_of_a_direct_solve():

    law = own_slab_law(load_table("bonded"), pad(edge_radius_mm=0.5), np.array([4.0, 12.0]))
    depth = np.array([1.0, 2.0])
    direct = solve_under_fillet(Pad(6.4, 1.0, RADIUS, edge_radius_mm=0.5), depth).force_N
    np.testing.assert_allclose(law.force(depth, 6.4, 1.0, RADIUS), direct, rtol=0.01)


@pytest.mark.slow
def test_a_ball_starts_softer_than_a_flat_punch_of_its_width():
    from dummydesign.geometry.punch import read_punch

    ball = read_punch("ball:20")
    table = load_table("bonded")
    made = pad(radius_mm=ball.radius_mm, profile_mm=ball.profile_mm, condition="frictionless")
    law = own_slab_law(table, made, np.array([8.0]))
    depth = np.array([0.1, 0.5, 2.0])
    ratio = law.force(depth, 8.0, 1.0, ball.radius_mm) / table.force(depth, 8.0, 1.0, ball.radius_mm)
    assert (np.diff(ratio) > 0).all() and ratio[0] < 0.3


@pytest.mark.slow
def test_a_face_that_slides_under_a_fillet_is_that_of_a_direct_solve_and_softer_than_a_glued_one():
    from dummydesign.pad.force_source import solve_points

    table, h, depth = load_table("bonded"), 6.4, np.array([0.6, 1.5, 2.6])
    slides = pad(edge_radius_mm=0.7, condition="frictionless")
    law = own_slab_law(table, slides, np.array([5.0, 8.0]))
    direct = solve_points(pad(thickness_mm=h, edge_radius_mm=0.7, condition="frictionless"), depth)
    found = law.force(depth, h, 1.0, RADIUS)
    stated = law.relative_error(depth, h, RADIUS) + direct.error_N / direct.force_N
    assert (np.abs(found / direct.force_N - 1.0) < stated).all() and stated.max() < 0.06
    glued = own_slab_law(table, pad(edge_radius_mm=0.7), np.array([5.0, 8.0])).force(depth, h, 1.0, RADIUS)
    assert (found < 0.95 * glued).all()
