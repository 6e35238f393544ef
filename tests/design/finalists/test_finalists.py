"""Finalists on elements: who cannot win is not solved, and who turns out worse does not win."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import Readings
from dummydesign.design.search import finalists as resolved_by_fem
from dummydesign.design.search.finalists import ElementsLaw, near, solve_leading
from tests.support.judged_pads import away, ranges


@dataclass(frozen=True)
class Table:
    """Stands for the table's law of a pad."""

    cast: bool = False


ELEMENTS = ElementsLaw(Table(), 10.0, np.array([1.0, 4.0]), np.zeros(2), np.zeros(2))


@dataclass(frozen=True)
class Pad:
    """Stands for a design: what it is worth by its table, on the coarse grid, solved, and by a neighbour's solve.

    Pads of one radius are nearly the same; without one they differ. ``just`` is one that is just beyond a limit.
    """

    kind: str
    by_table: float
    rough: float
    full: float
    acceptable: bool = True
    just: bool = False
    elements: object | None = None
    complete: bool = True
    radius: float = 0.0
    by_neighbour: float = 0.0
    table: Table = Table()

    @property
    def shape(self):
        lengths = (("radius", self.radius or 2.0 ** (100.0 * self.full)),)
        return SimpleNamespace(name=self.kind, axisymmetric=True, of=(self.kind, self.full), parameters=lengths)

    @property
    def worth(self):
        return self.by_table if self.acceptable else 0.01 * self.by_table

    merit = property(lambda self: self.by_table)

    @property
    def result(self):
        return SimpleNamespace(best=SimpleNamespace(rank=int(self.acceptable), thickness_mm=10.0))


@pytest.fixture
def solved(monkeypatch):
    """Names of what was solved to the end, with the solves replaced by what each pad says of itself."""
    done = []

    def on_elements(pad, space, kept=None):
        done.append((pad.kind, pad.by_table))
        if pad.full < 0.0:
            raise NoAnswerError("no_convergence", "stop")
        return replace(pad, by_table=pad.full, elements=ELEMENTS)

    def with_law(pad, law, space):
        return replace(pad, by_table=pad.by_neighbour if isinstance(law, ElementsLaw) else pad.rough)

    monkeypatch.setattr(resolved_by_fem, "rough_law", lambda pad, *_: SimpleNamespace(complete=pad.complete))
    monkeypatch.setattr(resolved_by_fem, "with_law", with_law)
    monkeypatch.setattr(resolved_by_fem, "on_elements", on_elements)
    monkeypatch.setattr(resolved_by_fem, "_nearly", lambda pad, _: pad.acceptable or pad.just)
    return done


SPACE = SimpleNamespace(radius_mm=7.9)


def best(designs):
    return max((pad for pad in designs if pad.elements), key=lambda pad: pad.worth)


def test_only_the_winner_is_solved_when_it_stays_ahead(solved):
    pads = [Pad("crowned", 0.9, 0.91, 0.9), Pad("crowned", 0.88, 0.86, 0.85), Pad("layered", 0.4, 0.5, 0.99)]
    found = solve_leading(pads, SPACE)
    assert solved == [("crowned", 0.9)] and best(found).full == 0.9
    assert {pad.kind for pad in found} == {"crowned", "layered"}, "what was not solved stays with its table"


def test_the_next_is_solved_where_the_first_turns_out_worse(solved):
    pads = [Pad("crowned", 0.9, 0.91, 0.7), Pad("crowned", 0.88, 0.86, 0.85)]
    assert best(solve_leading(pads, SPACE)).full == 0.85 and len(solved) == 2


def test_a_pad_that_the_coarse_grid_cannot_carry_counts_by_its_table(solved):
    pads = [Pad("boned", 0.8, 0.8, 0.5), Pad("boned", 0.78, 0.0, 0.76, complete=False)]
    assert best(solve_leading(pads, SPACE)).full == 0.76


def test_a_pad_that_cannot_be_solved_falls_away_and_the_next_wins(solved):
    pads = [Pad("crowned", 0.9, 0.9, -1.0), Pad("crowned", 0.7, 0.88, 0.6)]
    found = solve_leading(pads, SPACE)
    assert [pad.full for pad in found] == [0.6]


@pytest.mark.parametrize("just", [True, False])
def test_what_is_not_representative_by_its_table_is_pressed_coarsely_where_it_is_just_beyond_a_limit(
    solved, monkeypatch, just
):
    pressed = []
    monkeypatch.setattr(resolved_by_fem, "rough_law", lambda pad, *_: pressed.append(pad.kind) or SimpleNamespace(
        complete=True))  # fmt: skip
    pads = [Pad("boned", 0.4, 0.4, 0.4), Pad("crowned", 0.9, 0.9, 0.9, acceptable=False, just=just)]
    solve_leading(pads, SPACE)
    assert ("crowned" in pressed) == just
    assert ("crowned", 0.9) not in solved, "on the coarse grid it is not representative either"


def test_a_pad_just_beyond_a_limit_by_its_table_wins_where_its_elements_keep_it(solved, monkeypatch):
    def with_law(pad, law, space):
        return replace(pad, by_table=pad.rough, acceptable=True)

    monkeypatch.setattr(resolved_by_fem, "with_law", with_law)
    monkeypatch.setattr(resolved_by_fem, "on_elements", lambda pad, *_: replace(
        pad, by_table=pad.full, elements=ELEMENTS, acceptable=True))  # fmt: skip
    pads = [Pad("boned", 0.4, 0.4, 0.4), Pad("crowned", 0.9, 0.9, 0.9, acceptable=False, just=True)]
    assert best(solve_leading(pads, SPACE)).kind == "crowned"


@pytest.mark.parametrize(("aim", "shortfall", "over", "nearly"), [
    ("average", 1.10 * 1.05, None, True), ("average", 1.10 * 1.07, None, False), ("average", None, 1.25 * 1.05, True),
    ("average", None, 1.25 * 1.07, False), ("average", 1.0, 1.0, True), ("safe-side", 1.01 * 1.05, None, True),
    ("safe-side", 1.01 * 1.07, None, False), ("safe-side", None, 2.0, True),
])  # fmt: skip
def test_just_beyond_is_within_what_solving_moves_forces(monkeypatch, aim, shortfall, over, nearly):
    band = replace(ranges(), strict=aim == "safe-side")
    readings = away(shortfall, over)
    if aim == "safe-side":
        readings = Readings(1.02 * band.peak_high_N, band.energy_high_mJ, 0.99 * band.stiff_mm)
        readings.peak_N[1] = band.peak_high_N[1] / (shortfall or 1.0)
        readings.peak_N[4] = band.peak_high_N[4] * (over or 1.0)
    monkeypatch.setattr(resolved_by_fem, "ranges_of", lambda _: band)
    found = SimpleNamespace(best=SimpleNamespace(rank=0, readings=readings))
    space = SimpleNamespace(targets=SimpleNamespace(aim=aim, limits=verdict_limits()))
    assert resolved_by_fem._nearly(SimpleNamespace(result=found), space) == nearly


def test_pads_that_are_nearly_the_same_are_judged_by_the_elements_of_the_first(solved):
    same = [Pad("boned", 0.8 - 0.01 * n, 0.8, 0.7, radius=20.0 + n, by_neighbour=0.705) for n in range(3)]
    assert near(*same[:2]) and not near(same[0], replace(same[1], radius=30.0))
    assert best(solve_leading(same, SPACE)).full == 0.7 and solved == [("boned", 0.8)]


def test_a_neighbour_that_these_elements_make_the_better_one_is_solved_itself(solved):
    same = [Pad("boned", 0.8, 0.8, 0.5, radius=20.0), Pad("boned", 0.79, 0.8, 0.75, radius=21.0, by_neighbour=0.74)]
    assert best(solve_leading(same, SPACE)).full == 0.75 and len(solved) == 2


def test_a_pad_that_is_near_to_a_neighbour_but_not_to_the_first_is_pressed_itself(solved):
    row = [Pad("boned", 0.8 - 0.01 * n, 0.8, 0.6 + 0.1 * n, radius=20.0 * 1.09**n) for n in range(3)]
    assert near(*row[:2]) and near(*row[1:]) and not near(row[0], row[2])
    assert best(solve_leading(row, SPACE)).full == pytest.approx(0.8)


def test_a_neighbour_of_a_pad_that_cannot_be_solved_is_solved_before_a_worse_kind_wins(solved):
    boned = [Pad("boned", 0.8, 0.8, -1.0, radius=20.0), Pad("boned", 0.79, 0.8, 0.75, radius=21.0)]
    assert best(solve_leading([*boned, Pad("layered", 0.78, 0.78, 0.4)], SPACE)).full == 0.75


@pytest.mark.parametrize(("more", "count"), [(0.0095, 1), (0.0105, 2)])
def test_a_neighbour_is_solved_where_it_is_worth_a_hundredth_more(solved, more, count):
    same = [Pad("boned", 0.8, 0.8, 0.7, radius=20.0), Pad("boned", 0.79, 0.8, 0.75, radius=21.0,
                                                         by_neighbour=0.7 + more)]  # fmt: skip
    solve_leading(same, SPACE)
    assert len(solved) == count


@pytest.mark.parametrize(("behind", "pressed"), [(0.029, True), (0.031, False)])
def test_a_pad_is_pressed_coarsely_within_the_tables_doubt_of_the_best(solved, monkeypatch, behind, pressed):
    """Three hundredths: twice the most by which solving moved a design of the built-in tissues, 0.014, rounded up."""
    seen = []
    monkeypatch.setattr(resolved_by_fem, "rough_law", lambda pad, *_: seen.append(pad.by_table) or SimpleNamespace(
        complete=True))  # fmt: skip
    solve_leading([Pad("boned", 0.8, 0.8, 0.7), Pad("boned", 0.8 - behind, 0.7, 0.6)], SPACE)
    assert (len(seen) == 2) is pressed


def test_of_the_best_kind_three_are_in_question_and_of_each_other_one(solved, monkeypatch):
    seen = []
    monkeypatch.setattr(resolved_by_fem, "rough_law", lambda pad, *_: seen.append((pad.kind, pad.by_table)) or
                        SimpleNamespace(complete=True))  # fmt: skip
    pads = [Pad("boned", 0.8 - 0.001 * n, 0.1, 0.1 + 0.1 * n) for n in range(4)]
    others = [Pad("crowned", 0.79 - 0.001 * n, 0.1, 0.5 + 0.1 * n) for n in range(2)]
    solve_leading([*others, *pads], SPACE)
    assert sorted(seen) == [("boned", 0.798), ("boned", 0.799), ("boned", 0.8), ("crowned", 0.79)]
