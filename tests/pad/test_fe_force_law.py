"""Laws of slabs that are solved: which solve, polynomials and their misfit, thicknesses between, what is doubted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS
from dummydesign.geometry.punch import ball_profile
from dummydesign.pad import fe_force_law, force_source
from dummydesign.pad.fe_force_law import (
    DEGREE,
    SLAB_SHARES,
    SLIDING_DEGREE,
    SlabLawForTest,
    Solved,
    SolvedSlab,
    corners_known,
    in_table,
    law_of,
    near_rim,
    own_slab_law,
    solve_over_table,
    solve_slab,
)
from dummydesign.pad.force_law import NO_COST, PadCurve, curve_at
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve import continuation
from dummydesign.pad.solve.continuation import ForcePath
from dummydesign.pad.tables.slab import load_table
from tests.support.refusal import raises_code

RADIUS = 7.9
TABLE = load_table("bonded")


def pad(**more) -> Pad:
    return Pad(**({"thickness_mm": 10.0, "young_MPa": 1.0, "radius_mm": RADIUS, "extent_mm": 75.7} | more))


@pytest.mark.parametrize(
    ("change", "known"),
    [
        ({}, True),
        ({"sides_mm": (14.0, 14.0)}, True),
        ({"sides_mm": (14.0, 10.0)}, False),
        ({"sides_mm": (14.0, 10.0), "fidelity": "3d"}, True),
        ({"sides_mm": (14.0, 14.0), "condition": "frictionless"}, False),
        ({"sides_mm": (14.0, 14.0), "law": Yeoh(1.0, 0.1)}, False),
    ],
)
def test_corners_are_known_of_round_punches_in_space_and_of_glued_squares_in_the_table(change, known):
    own, fidelity = dict(change), change.get("fidelity", "axisymmetric")
    own.pop("fidelity", None)
    assert corners_known(Pad(10.0, 1.0, RADIUS, **own), fidelity) == known
    if not known:
        with raises_code("unsupported", "punch"):
            solve_slab(Pad(10.0, 1.0, RADIUS, **own), fidelity)


@pytest.mark.parametrize(
    ("condition", "fidelity", "by"),
    [("bonded", "axisymmetric", "curve"), ("frictionless", "axisymmetric", "points"), ("frictionless", "3d", "curve")],
)
def test_a_slab_is_solved_at_shares_of_its_thickness_as_far_as_its_curve_goes(monkeypatch, condition, fidelity, by):
    asked = []

    def curve(own, fidelity, deepest, depth):
        asked.append(("curve", depth, deepest))
        whole = curve_at(TABLE, own.thickness_mm, own.young_MPa, own.radius_mm)
        return replace(whole, limit_mm=0.35 * 8.0, notes=("n",))

    def points(own, depth):
        asked.append(("points", depth, depth[-1]))
        return PadCurve(depth[:5], 2.0 * depth[:5], 0.1 * depth[:5], dict(NO_COST), ("n",))

    monkeypatch.setattr(force_source, "elastic_curve", curve)
    monkeypatch.setattr(force_source, "solve_points", points)
    sides = (14.0, 14.0) if fidelity == "3d" else None
    found = solve_slab(Pad(8.0, 1.0, RADIUS, condition=condition, sides_mm=sides), fidelity)
    name, depth, deepest = asked[0]
    assert name == by and depth == pytest.approx(8.0 * np.array(SLAB_SHARES)) and deepest == pytest.approx(4.8)
    assert found.notes == ("n",)
    if by == "points":
        assert found.area_mm2 == pytest.approx(2.0 * found.depth_mm) and found.error == pytest.approx(np.full(5, 0.05))
    else:
        assert found.depth_mm == pytest.approx(depth[depth <= 2.8 + 1e-9]) and len(found.depth_mm) == 9
        assert found.area_mm2 == pytest.approx(TABLE.force(found.depth_mm, 8.0, 1.0, RADIUS))
        assert found.error == pytest.approx(TABLE.relative_error(found.depth_mm, 8.0, RADIUS))


def slab(thickness: float, condition: str = "bonded", count: int = 14, off: float = 0.0) -> SolvedSlab:
    """F = a d exp(0.2 + x + 0.5 x^2) of unit modulus at relative depths x, one value off."""
    share = np.array(SLAB_SHARES)[:count]
    area = RADIUS * share * thickness * np.exp(0.2 + share + 0.5 * share**2)
    area[3] *= np.exp(off)
    error = np.full(count, 1e-3)
    error[3] = 1.0 if off else 1e-3
    return SolvedSlab(Pad(thickness, 1.0, RADIUS, condition=condition), share * thickness, area, error, ("ends",))


@pytest.mark.parametrize("condition", ["bonded", "frictionless"])
def test_a_law_of_slabs_is_its_curve_for_every_thickness_and_modulus(condition):
    law, h = law_of([slab(8.0, condition), slab(12.0, condition, 9)]), np.array([[8.0], [12.0]])
    depth = np.array([0.5, 1.5, 3.0])
    exact = 0.03 * RADIUS * depth * np.exp(0.2 + depth / h + 0.5 * (depth / h) ** 2)
    assert law.force(depth, h, 0.03, RADIUS) == pytest.approx(exact, rel=1e-9)
    assert law.depth_limit_mm([8.0, 12.0], RADIUS) == pytest.approx([4.8, 12.0 * SLAB_SHARES[8]])
    assert law.relative_error(depth, h, RADIUS) == pytest.approx(1e-3, rel=1e-6)
    degree = DEGREE if condition == "bonded" else SLIDING_DEGREE
    assert [len(one) for one in law.polynomials.values()] == [degree + 1] * 2
    assert law.notes == ("slab of 8 mm: ends", "slab of 12 mm: ends")
    assert law_of([slab(8.0, condition, degree + 1)]).radius_mm == RADIUS
    with pytest.raises(NoAnswerError):
        law_of([slab(8.0, condition, degree)])


def test_a_value_that_lies_off_and_is_doubted_hardly_moves_a_law_and_is_stated():
    law, depth = law_of([slab(8.0, off=0.05)]), 8.0 * np.array(SLAB_SHARES)
    plain = law_of([slab(8.0)]).force(depth, 8.0, 1.0, RADIUS)
    assert law.force(depth, 8.0, 1.0, RADIUS) == pytest.approx(plain, rel=1e-4)
    assert law.relative_error(depth, 8.0, RADIUS)[3] == pytest.approx(1.05, abs=1e-3)
    with pytest.raises(ValueError, match="radius"):
        law.force(1.0, 8.0, 1.0, 1.01 * RADIUS)


def test_one_solved_thickness_answers_all_and_several_end_where_their_neighbours_do():
    share = np.array([0.1, 0.2, 0.4])
    one = SlabLawForTest(TABLE, (Solved(8.0, share, np.array([0.1, 0.2, 0.3]), np.full(3, 0.01)),), 0.002)
    depth = np.array([0.4, 1.6, 3.2, 3.9])
    over = one.force(depth, 8.0, 1.0, RADIUS) / TABLE.force(depth, 8.0, 1.0, RADIUS)
    assert np.log(over) == pytest.approx([0.1, 0.2, 0.3, 0.3])
    assert one.relative_error(depth, 8.0, RADIUS) == pytest.approx(np.full(4, 0.012))
    assert one.depth_limit_mm(8.0, RADIUS) == pytest.approx(3.2) and one.ratio_range == TABLE.ratio_range
    two = SlabLawForTest(TABLE, (one.solved[0], Solved(16.0, share[:2], np.array([0.3, 0.4]), np.full(2, 0.03))), 0.0)
    middle = np.sqrt(128.0)
    assert two.depth_limit_mm(middle, RADIUS) == pytest.approx(0.3 * middle)
    assert two.relative_error(0.1 * middle, middle, RADIUS) == pytest.approx(0.02)
    between = two.force(0.1 * middle, middle, 1.0, RADIUS) / TABLE.force(0.1 * middle, middle, 1.0, RADIUS)
    assert np.log(between) == pytest.approx(0.2)
    for error, at in ((0.01, 6.0), (0.01, 8.0), (0.03, 16.0), (0.03, 20.0)):
        assert two.relative_error(0.1 * at, at, RADIUS) == pytest.approx(error)
    three = SlabLawForTest(TABLE, (*two.solved, Solved(24.0, share, np.full(3, 0.9), np.full(3, 0.05))), 0.0)
    for error, at in ((0.015, 8.0 * 2.0**0.25), (0.035, 16.0 * 1.5**0.25), (0.05, 24.0)):
        assert three.relative_error(0.1 * at, at, RADIUS) == pytest.approx(error)


def test_below_the_first_share_the_factor_is_held():
    share, factor = np.array([0.1, 0.2, 0.4]), 0.5 * np.log([0.1, 0.2, 0.4])
    law = SlabLawForTest(TABLE, (Solved(8.0, share, factor, np.full(3, 0.01)),), 0.0)
    over = law.force(0.16, 8.0, 1.0, RADIUS) / TABLE.force(0.16, 8.0, 1.0, RADIUS)
    assert np.log(over) == pytest.approx(factor[0])
    assert law.relative_error(0.16, 8.0, RADIUS) == pytest.approx(0.01)


def test_a_ball_over_the_table_is_hertz_over_six_decades_of_depth(monkeypatch):
    ball = ball_profile(2.0 * 9.0)

    def points(own, depth):
        force = hertz(depth, own.thickness_mm)
        return PadCurve(depth, force, 0.002 * force, dict(NO_COST))

    def hertz(depth, h):
        c = np.sqrt(9.0 * depth) / h
        return 16.0 / 9.0 * 3.0 * depth**1.5 * (1.0 + 1.133 * c + 1.283 * c**2 + 0.769 * c**3)

    monkeypatch.setattr(force_source, "solve_points", points)
    own = pad(profile_mm=ball, condition="frictionless", radius_mm=RADIUS)
    law = own_slab_law(TABLE, own, np.array([6.0, 14.0]))
    for h in (6.0, 8.7, 14.0):
        depth = h * np.geomspace(1e-7, 0.05, 40)
        force = law.force(depth, h, 1.0, RADIUS)
        assert force == pytest.approx(hertz(depth, h), rel=0.02)
        assert np.all(np.abs(np.log(force / hertz(depth, h))) < law.relative_error(depth, h, RADIUS) + 1e-3)


def test_what_lies_between_nodes_is_doubted_by_a_quarter_of_what_leaving_one_out_changes():
    """A factor of (ln h)^2: at even steps in ln h the middle one lies half of the second difference off."""
    share = np.array([0.1, 0.3])
    nodes = tuple(
        Solved(float(h), share, 0.1 * np.log(h) ** 2 + np.zeros(2), np.zeros(2)) for h in np.exp([1.0, 1.5, 2.0, 2.5])
    )
    assert fe_force_law._doubt(nodes) == pytest.approx(0.25 * 0.1 * 0.25) and fe_force_law._doubt(nodes[:2]) == 0.0
    # Only as deep as both neighbours reach, and there to the end.
    deep, bent = np.array([0.1, 0.3, 0.5]), np.array([0.0, 0.2, 0.8])
    first, last = (Solved(float(h), deep[:2], np.zeros(2), np.zeros(2)) for h in np.exp([1.0, 2.0]))
    assert fe_force_law._doubt((first, Solved(float(np.exp(1.5)), deep, bent, bent), last)) == pytest.approx(0.25 * 0.2)
    wide = [replace(one, share=deep, log_factor=np.zeros(3)) for one in (first, last)]
    assert fe_force_law._doubt((wide[0], Solved(float(np.exp(1.5)), deep, bent, bent), wide[1])) == pytest.approx(0.2)
    line = tuple(replace(one, log_factor=np.log(one.thickness_mm) + np.zeros(2)) for one in nodes)
    assert fe_force_law._doubt(line) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("change", "inside"),
    [
        ({}, True),
        ({"base": "sliding"}, True),
        ({"base": "friction:0.3"}, False),
        ({"edge_radius_mm": 0.5}, False),
        ({"condition": "frictionless"}, False),
        ({"profile_mm": ((0.0, 3.0, 6.0), (0.0, 0.3, 1.0))}, False),
    ],
)
def test_a_table_s_own_punch_and_base_need_no_solve(monkeypatch, change, inside):
    assert in_table(pad(**change)) == inside
    asked = []

    def solve(table, own, h):
        asked.append(h)
        return Solved(h, np.array([0.1, 0.2]), np.zeros(2), np.zeros(2))

    monkeypatch.setattr(fe_force_law, "solve_over_table", solve)
    law = own_slab_law(TABLE, pad(**change), np.array([5.0, 20.0]))
    assert (law is TABLE) == inside
    if not inside:
        assert asked == pytest.approx(np.geomspace(5.0, 20.0, len(asked)).tolist()) and len(asked) == fe_force_law.NODES
        own_slab_law(TABLE, pad(**change), np.array([5.0]))
        assert len(asked) == fe_force_law.NODES + 1


def test_a_rim_counts_by_its_way_to_the_punch_over_the_thickness():
    """0.5 exp(-1.5 way / h) of the force, a change of 0.2 % is solved."""
    table_way = (EXTENT_OVER_RADIUS - 1.0) * RADIUS
    for h in (5.0, 12.0):
        taken = 0.5 * np.exp(-1.5 * table_way / h)
        edge = -h / 1.5 * np.log((0.002 + taken) / 0.5)
        assert near_rim(pad(extent_mm=RADIUS + 0.98 * edge), h) and not near_rim(pad(extent_mm=RADIUS + 1.02 * edge), h)


def test_what_is_solved_over_the_table_ends_with_either_and_has_the_solve_s_error(monkeypatch):
    asked = []

    def points(own, depth):
        asked.append((own, depth))
        force = TABLE.force(depth, own.thickness_mm, 1.0, own.radius_mm) * np.exp(0.01 * np.arange(len(depth)))
        return PadCurve(depth, force, 0.02 * force, dict(NO_COST))

    monkeypatch.setattr(force_source, "solve_points", points)
    own = pad(edge_radius_mm=0.5, young_MPa=0.03, sides_mm=(14.0, 14.0))
    found = solve_over_table(TABLE, own, 4.0)
    limit = float(TABLE.depth_limit_mm(4.0, RADIUS))
    solved, depth = asked[0]
    assert (solved.thickness_mm, solved.young_MPa, solved.sides_mm) == (4.0, 1.0, None)
    assert depth == pytest.approx(4.0 * fe_force_law.SHARES[4.0 * fe_force_law.SHARES <= limit * (1.0 + 1e-9)])
    from_first = found.share >= depth[0] / 4.0 * (1.0 - 1e-9)
    assert found.share[from_first] == pytest.approx(depth / 4.0)
    assert found.log_factor[from_first] == pytest.approx(0.01 * np.arange(len(depth)))
    assert found.error[from_first] == pytest.approx(np.full(len(depth), 0.02))
    assert found.error.max() < 0.1 and found.thickness_mm == 4.0
    monkeypatch.setattr(force_source, "solve_points", lambda own, depth: PadCurve(depth[:1], depth[:1], depth[:1], {}))
    with pytest.raises(NoAnswerError):
        solve_over_table(TABLE, own, 4.0)


def test_what_a_near_rim_takes_is_doubted_besides_what_the_table_is_off_by(monkeypatch):
    share = np.array([0.1, 0.3, 0.5])
    made = {"share": share, "log_factor": np.zeros(3), "error": np.array([0.01, 0.02, 0.03])}
    monkeypatch.setattr(fe_force_law, "_by_rim", lambda own, wanted: made)
    found = solve_over_table(TABLE, pad(extent_mm=20.0), 12.0)
    assert found.error == pytest.approx(made["error"] + TABLE.relative_error(12.0 * share, 12.0, RADIUS))


def test_a_near_rim_is_compared_with_the_table_s_own_extent_on_the_same_cells(monkeypatch):
    asked = []

    def follow(problem, share, *steps):
        extent = problem.solid.mesh.nodes[0].max()
        asked.append((extent, steps))
        count = len(share) - (extent < 6.0)
        force = (0.9 if extent < 6.0 else 1.0) * share[:count]
        return ForcePath(share[:count], force, force, 9, 1, 2, 0.1, None)

    monkeypatch.setattr(continuation, "follow", follow)
    found = fe_force_law._by_rim(pad(extent_mm=20.0), np.array([0.1, 0.2, 0.3]))
    assert [one for one, _ in asked] == pytest.approx([2.0, EXTENT_OVER_RADIUS * 0.79])
    assert found["share"] == pytest.approx([0.1, 0.2]) and found["log_factor"] == pytest.approx(np.log([0.9, 0.9]))
    assert found["error"] == pytest.approx(fe_force_law.SCATTER + 0.01)
    first, largest, smallest = asked[0][1]
    assert smallest < first < largest <= 0.05 * 0.79 * (1.0 + 1e-9)
