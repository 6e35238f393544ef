"""Laws that elements make of a table, at which depths they are solved, and which pads count as neighbours."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.search import fe_candidates
from dummydesign.design.search.fe_candidates import (
    BEYOND,
    SPACING,
    SPATIAL_SHARES,
    ElementsLaw,
    _inputs,
    _law,
    solve_leading,
    solved_shares,
)
from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from tests.support.refusal import raises_code


@dataclass(frozen=True)
class Table:
    """F = 2 E d^1.5 h^-1, known to half of the thickness, off by 2 %."""

    cast: bool = False
    share: float = 0.5

    @property
    def plain(self):
        return self

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return 2.0 * np.asarray(young_MPa) * np.maximum(depth_mm, 0.0) ** 1.5 / np.asarray(thickness_mm, float)

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return self.share * np.asarray(thickness_mm, float)

    def gel_mm(self, thickness_mm):
        return np.asarray(thickness_mm, float)

    def relative_error(self, depth_mm, thickness_mm, radius_mm):
        return 0.02 + 0.0 * np.asarray(depth_mm)


DEPTHS = np.array([0.5, 1.0, 2.0, 3.0])
LAW = ElementsLaw(Table(), 10.0, DEPTHS, np.log([1.0, 1.1, 1.2, 1.1]), np.array([0.01, 0.03, 0.05, 0.01]))


def test_the_force_is_the_tables_times_what_the_elements_found_and_holds_at_both_ends():
    depth = np.array([0.1, 0.5, 1.0, 2.0, 3.0, 4.0])
    ratio = LAW.force(depth, 10.0, 0.05, 7.0) / Table().force(depth, 10.0, 0.05, 7.0)
    np.testing.assert_allclose(ratio, [1.0, 1.0, 1.1, 1.2, 1.1, 1.1])
    at = np.linspace(0.5, 2.0, 99)
    between = LAW.force(at, 10.0, 1.0, 7.0) / Table().force(at, 10.0, 1.0, 7.0)
    assert np.all(np.diff(between) > 0.0) and between.max() <= 1.2 + 1e-12
    np.testing.assert_allclose(LAW.force(at, 10.0, 0.1, 7.0), 2.0 * LAW.force(at, 10.0, 0.05, 7.0))


def test_a_solve_that_stopped_limits_the_depth_in_proportion_to_the_thickness():
    np.testing.assert_allclose(LAW.depth_limit_mm(np.array([8.0, 10.0, 20.0]), 7.0), [2.4, 3.0, 6.0])
    complete = replace(LAW, complete=True)
    np.testing.assert_allclose(complete.depth_limit_mm(np.array([8.0, 10.0]), 7.0), [4.0, 5.0])
    short = replace(LAW, table=Table(share=0.2))
    np.testing.assert_allclose(short.depth_limit_mm(np.array([10.0]), 7.0), [2.0])


def test_the_error_is_that_of_the_elements_and_beyond_them_at_least_the_tables():
    depth = np.array([0.2, 1.0, 1.5, 3.0])
    np.testing.assert_allclose(LAW.relative_error(depth, 10.0, 7.0), [0.01, 0.03, 0.04, 0.01])
    np.testing.assert_allclose(LAW.relative_error(np.array([1.0, 3.0, 3.1]), 10.0, 7.0), [0.03, 0.01, 0.02])
    worse = replace(LAW, error=np.full(4, 0.06))
    np.testing.assert_allclose(worse.relative_error(np.array([1.0, 3.1]), 10.0, 7.0), 0.06)


def shaped(thickness=10.0, flat=True, axisymmetric=True, share=0.5):
    shape = SimpleNamespace(
        name="crowned", axisymmetric=axisymmetric, flat_top=flat, plain=False, check=lambda *given: None
    )
    return SimpleNamespace(
        shape=shape, thickness_mm=thickness, table=Table(cast=True, share=share), outlook=SimpleNamespace(ratio=15.0)
    )


def space(*pressed_mm, gel=0.6, **given):
    """Where a design's deepest presses are those given."""
    usual = {"base": "bonded", "extent_mm": PAD_EXTENT_MM, "edge_radius_mm": 0.0, "radius_mm": 7.0}
    targets = SimpleNamespace(limits=SimpleNamespace(gel_compression=gel), strict=False)
    return SimpleNamespace(pressed_mm=pressed_mm or (1.0, 2.0, 3.0), targets=targets, **{**usual, **given})


@pytest.fixture(autouse=True)
def pressed(monkeypatch):
    monkeypatch.setattr(
        fe_candidates,
        "candidate_of",
        lambda law, thickness, ratio, where: SimpleNamespace(depth_mm=np.array(where.pressed_mm)),
    )


@pytest.mark.parametrize("flat", [True, False])
def test_a_design_is_solved_in_even_steps_to_a_third_beyond_its_deepest_press(flat):
    shares = solved_shares(shaped(flat=flat), space())
    step = SPACING[flat]
    np.testing.assert_allclose(np.diff(shares), step)
    assert shares[0] == pytest.approx(step)
    # the first step at or beyond 1.3 x 0.3
    assert BEYOND * 0.3 <= shares[-1] + 1e-9 < BEYOND * 0.3 + step
    deep = solved_shares(shaped(flat=flat), space(1.0, 4.5))
    assert deep[-1] == pytest.approx(0.5) and np.diff(deep).max() <= step + 1e-12
    out_of_reach = solved_shares(shaped(flat=flat), space(1.0, np.nan))
    assert out_of_reach[-1] == pytest.approx(0.5)
    exact = solved_shares(shaped(thickness=1.0, flat=flat), space(20.0 * step / BEYOND))
    assert len(exact) == 20
    # the gel may end it before the table does
    held = solved_shares(shaped(flat=flat), space(1.0, np.nan, gel=0.3))
    assert held[-1] == pytest.approx(0.3)


def test_what_is_not_round_is_solved_at_sixteen_shares_of_the_last_depth():
    shares = solved_shares(shaped(axisymmetric=False), space())
    np.testing.assert_allclose(shares, SPATIAL_SHARES * BEYOND * 0.3)
    assert len(shares) == 16 and shares[0] == pytest.approx(0.04 * shares[-1])


def test_only_what_differs_from_the_tables_is_asked_of_a_solve():
    inputs, pad = _inputs(shaped(), space())
    assert list(inputs) == ["shape", "thickness", "radius", "depth"]
    assert inputs["thickness"] == pad.thickness_mm == 10.0 and inputs["radius"] == pad.radius_mm == 7.0
    np.testing.assert_allclose(inputs["depth"], 10.0 * solved_shares(shaped(), space()))
    full, pad = _inputs(shaped(), space(base="sliding", extent_mm=40.0, edge_radius_mm=0.5))
    own = {"base": "sliding", "extent_mm": 40.0, "edge_radius_mm": 0.5}
    assert full.items() >= own.items() and {name: getattr(pad, name) for name in own} == own
    assert not _inputs(shaped(axisymmetric=False), space(edge_radius_mm=0.5))[0].keys() & own.keys()


def test_a_law_is_the_logarithm_of_elements_over_table_at_unit_modulus():
    depth = np.array([1.0, 2.0, 4.0])
    force = 1.3 * Table().force(depth, 10.0, 1.0, 7.0)
    made = {"depth_mm": depth, "force_N": force, "error_N": 0.02 * force, "notes": ("first", "second")}
    law = _law(shaped(), made, 3, 7.0)
    np.testing.assert_allclose(law.log_factor, np.log(1.3))
    np.testing.assert_allclose(law.error, 0.02)
    assert law.complete and law.end == "" and law.touch is None and law.table.cast and law.thickness_mm == 10.0
    part = _law(shaped(), {**made, "touch": [[0.1, 0.2], [1.0, 2.0]]}, 4, 7.0)
    assert not part.complete and part.end == "first; second" and part.touch is not None
    with pytest.raises(NoAnswerError):
        _law(shaped(), {name: values[:1] for name, values in made.items()}, 3, 7.0)
    two = _law(shaped(), {name: values[:2] for name, values in made.items()}, 3, 7.0)
    assert len(two.depth_mm) == 2


def test_a_round_solve_keeps_where_the_face_has_touched_in_millimetres(monkeypatch):
    from dummydesign.pad.axisymmetric import shaped_pad

    def solve(pad, depth, solved):
        return SimpleNamespace(depth_mm=depth, force_N=depth, error_N=0.0 * depth)

    monkeypatch.setattr(shaped_pad, "solve_shaped_pad", solve)
    solved = SimpleNamespace(touched=[(0.1, 0.3), (0.2, 0.9)])
    made = fe_candidates._solve_round(_inputs(shaped(), space())[1], np.array([1.0, 2.0]), solved)
    np.testing.assert_allclose(made["touch"], [[1.0, 2.0], [3.0, 7.0]])


def test_what_is_not_round_is_solved_under_the_square_of_fourteen_millimetres(monkeypatch):
    from dummydesign.pad.spatial import shaped_pad

    asked = []
    monkeypatch.setattr(shaped_pad, "solve_shaped_block", lambda pad, depth: asked.append(pad) or SimpleNamespace(a=1))
    monkeypatch.setattr(fe_candidates, "Pad", lambda *given, **more: SimpleNamespace(given=given, **more))
    pad = SimpleNamespace(geometry=None, thickness_mm=8.0)
    assert fe_candidates._solve_in_space(pad, np.array([0.8])) == {"a": 1}
    assert asked[0].sides_mm == (14.0, 14.0) and asked[0].given[:2] == (8.0, 1.0)


def law_of_outlook(level=2, after=0.5, kind="crowned", solved=False, plain=False, axisymmetric=True):
    """A design by its level and its share after a puck."""
    shape = Shape(kind, plain, axisymmetric)
    outlook = SimpleNamespace(level=lambda limits, strict: level, after_puck=after, number=level - after)
    return Design(shape, outlook, solved)


@dataclass(frozen=True, eq=False)
class Shape:
    """Stands for the shape of one design."""

    name: str
    plain: bool
    axisymmetric: bool


@dataclass(frozen=True, eq=False)
class Design:
    """Stands for a design in the order of its level and share."""

    shape: object
    outlook: object
    solved: bool = False


@pytest.fixture
def leading(monkeypatch):
    """``solve_leading`` on designs, with solves replaced by (level, share) of each or None where one fails."""

    def run(*rows):
        found = {id(design): after for design, after in rows}
        order = []

        def on_elements(design, where):
            order.append(design)
            if found[id(design)] is None:
                raise NoAnswerError("no_convergence", "stopped")
            if isinstance(found[id(design)], Exception):
                raise found[id(design)]
            level, after = found[id(design)]
            return replace(law_of_outlook(level, after), shape=design.shape, solved=True)

        monkeypatch.setattr(fe_candidates, "on_elements", on_elements)

        def feasible(design, where):
            if design.outlook.after_puck < 0.0:
                raise NoAnswerError("no_feasible_design", "too soft")
            return design

        monkeypatch.setattr(fe_candidates, "feasible", feasible)
        monkeypatch.setattr(fe_candidates, "rank", lambda some, where: sorted(some, key=lambda one: one.outlook.number))
        run.faults = {}
        designs = solve_leading([design for design, _ in rows], space(), run.faults)
        return designs, [next(n for n, (design, _) in enumerate(rows) if design is one) for one in order]

    return run


def test_only_the_first_is_solved_where_it_stays_ahead(leading):
    first, second = law_of_outlook(2, 0.8), law_of_outlook(2, 0.79)
    designs, order = leading((first, (2, 0.775)), (second, (2, 0.9)))
    assert order == [0] and designs[0].solved and designs[1] is second


@pytest.mark.parametrize(("share", "count"), [(0.761, 1), (0.759, 2)])
def test_the_next_is_solved_where_the_first_falls_behind_it_by_more_than_solving_moves_a_share(leading, share, count):
    designs, order = leading((law_of_outlook(2, 0.8), (2, share)), (law_of_outlook(2, 0.79), (2, 0.7)))
    assert len(order) == count and designs[0].outlook.after_puck == share


def test_a_level_that_is_lost_by_solving_goes_to_the_next(leading):
    designs, order = leading((law_of_outlook(2, 0.8), (3, 0.8)), (law_of_outlook(2, 0.5), (2, 0.5)))
    assert order == [0, 1] and designs[0].outlook.after_puck == 0.5


def test_at_most_three_are_solved_and_the_best_of_these_comes_first(leading):
    rows = [(law_of_outlook(2, 0.9 - 0.01 * n), (3, 0.1 + 0.1 * n)) for n in range(5)]
    designs, order = leading(*rows)
    assert order == [0, 1, 2] and designs[0].solved and designs[0].outlook.after_puck == pytest.approx(0.3)


def test_a_pad_that_cannot_be_solved_or_no_longer_reaches_its_force_falls_away(leading):
    rows = (law_of_outlook(2, 0.9), None), (law_of_outlook(2, 0.8), (2, -1.0)), (law_of_outlook(2, 0.7), (2, 0.7))
    designs, order = leading(*rows)
    assert order == [0, 1, 2] and designs[0].outlook.after_puck == 0.7 and designs[0].solved
    assert leading.faults == {"crowned": "stopped"}


def test_a_pad_whose_solve_is_refused_falls_away_where_there_is_another_and_alone_it_is_the_answer(leading):
    refused = InputError("not this one", "out_of_range", "pad_mm")
    designs, order = leading((law_of_outlook(2, 0.9, "boned"), refused), (law_of_outlook(2, 0.8), (2, 0.8)))
    assert order == [0, 1] and designs[0].solved and leading.faults == {"boned": "not this one"}
    with raises_code("out_of_range", "pad_mm"):
        leading((law_of_outlook(2, 0.9, "boned"), refused))


def test_a_slab_is_designed_by_its_table_and_wins_unsolved(leading):
    slab = law_of_outlook(2, 0.9, "slab", plain=True)
    designs, order = leading((law_of_outlook(2, 0.8), (2, 0.8)), (slab, (0, 1.0)))
    assert order == [] and designs[0] is slab
    behind = law_of_outlook(2, 0.5, "slab", plain=True)
    designs, order = leading((law_of_outlook(2, 0.8), (2, 0.1)), (behind, None))
    assert order == [0] and designs[0] is behind


def test_fields_of_caps_are_solved_where_no_round_pad_was_searched(leading):
    caps = law_of_outlook(1, 0.9, "lattice", axisymmetric=False)
    designs, order = leading((caps, (1, 0.9)), (law_of_outlook(2, 0.5), (2, 0.5)))
    assert order == [1] and designs[0].solved and designs[-1] is caps
    assert leading((caps, (1, 0.8)))[1] == [0]
