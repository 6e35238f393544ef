"""The search over kinds on stand-ins: sieve, neighbours, misfit, who is chosen and who is near."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design import calibrated
from dummydesign.design.request import PAPER, Protocol, Request
from dummydesign.design.scoring.presses import DEPTH_SHARE, SAMPLES, Curves, Sampling, Slabs
from dummydesign.design.search import best_of_kinds as module
from MISSING.dummydesign.design.search.best_of_kinds import _near, _one_a_thickness, _pourable, choose, close_to, misfits
from dummydesign.design.assessment.decision import MISFIT_N, force_at, low_force, misfit
from dummydesign.design.search.shape_search import SearchOutcome, ShapedDesign, mixable, sieve
from dummydesign.design.search.shape_family import Designs, FamilyLaw, TableFamily
from dummydesign.design.search.slabs import DesignCandidate, SearchResult
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab


class Powers:
    """Pads with F / E = c d^p of a few powers, to half of the thickness."""

    kind = "powers"

    def candidates(self, thickness, radius):
        h, p = (grid.ravel() for grid in np.meshgrid(thickness, [1.0, 2.0, 3.0], indexing="ij"))
        return Made(h, p)

    def limit_mm(self, designs, radius):
        return 0.5 * designs.thickness_mm

    def area_mm2(self, designs, depth, radius):
        return 20.0 * depth ** designs.power[:, None]


@dataclass(frozen=True)
class Made:
    thickness_mm: np.ndarray
    power: np.ndarray
    limit_mm: np.ndarray | None = None

    def take(self, chosen):
        limit = None if self.limit_mm is None else self.limit_mm[chosen]
        return Made(self.thickness_mm[chosen], self.power[chosen], limit)

    def castable(self, pad_mm):
        return self.thickness_mm < pad_mm[0]


TARGETS = SimpleNamespace(protocol=PAPER, aim_depth_mm=lambda force: np.sqrt(np.asarray(force) / 1.2))


def test_the_sieve_finds_the_power_of_the_aim_and_its_modulus():
    """The aim is 1.2 d^2: of 20 E d^2 that is a modulus of 0.06 MPa, without any misfit."""
    def sieved(*thickness, young=(0.01, 0.1), pad_mm=(150.0, 120.0)):
        resin = SimpleNamespace(young_MPa=np.asarray)
        return prescreen(Powers(), SimpleNamespace(thickness_mm=np.array(thickness), targets=TARGETS, resin=resin,
                                                   ratio=young, radius_mm=7.9, pad_mm=pad_mm))  # fmt: skip

    found = sieved(6.0, 8.0, 10.0)
    # the aim is 3.54 mm deep at 15 N: 6 mm are too thin for half of the thickness
    assert found.power.tolist() == [2.0, 2.0] and set(found.thickness_mm) == {8.0, 10.0}
    every = Powers().candidates(np.array([8.0]), 7.9)
    misfit = misfits(Powers(), every, TARGETS, np.array([0.01, 0.1]), 7.9)
    assert misfit[every.power == 2.0] == pytest.approx(0.0, abs=1e-12) and np.argmin(misfit) == 1
    forces = PAPER.misfit_N[:: module.SIEVE_STEP]
    away = np.log(forces) - np.log(20.0 * TARGETS.aim_depth_mm(forces))
    np.testing.assert_allclose(misfit[every.power == 1.0], np.std(away), rtol=1e-6)
    # a modulus outside the resin's is taken at its end
    held = misfits(Powers(), every, TARGETS, np.array([0.05, 0.01]), 7.9)
    assert held[every.power == 2.0] == pytest.approx(np.log(0.06 / 0.05))
    with pytest.raises(NoAnswerError):
        sieved(6.0)
    with pytest.raises(NoAnswerError):
        sieved(8.0, pad_mm=(7.0, 7.0))
    assert DEPTH_SHARE >= 0.5


def test_of_each_thickness_the_first_that_can_be_cast_is_tried():
    made = Made(np.array([9.0, 9.0, 7.0, 8.0, 7.0, 6.0]), np.arange(6.0))
    assert _one_a_thickness(made, (8.5, 8.5), 9) == [2, 3, 5] and _one_a_thickness(made, (8.5, 8.5), 2) == [2, 3]


def test_thicknesses_near_a_start_are_two_steps_either_way():
    space = SimpleNamespace(thickness_mm=np.arange(3.0, 12.1, 0.5), radius_mm=7.9, pad_mm=(150.0, 120.0))
    family = TableFamily("crowned")
    near = _near(family, read_shape("crowned:radius=21.2,height=2,foot=9.4"), 5.0, space)
    assert len(near) and near.min() >= 4.0 and near.max() <= 6.0 and 5.0 in near.tolist()
    assert near.tolist() == [h for h in (4.0, 4.5, 5.0, 5.5, 6.0) if h in near.tolist()]


def test_a_curve_is_straight_in_logarithms_and_ends_at_its_deepest_point():
    force = np.array([1.0, 10.0, 100.0, 200.0])
    depth = np.array([1.0, 10.0**0.5, 10.0, np.nan])
    at = np.array([1.0, 2.0, 5.0, 10.0, 10.0 + 1e-9, 10.1])
    found = force_at(at, depth, force)
    np.testing.assert_allclose(found[:5], at[:5] ** 2, rtol=1e-6)
    assert np.isnan(found[5])


def test_the_misfit_is_the_root_mean_square_of_the_logarithm():
    aim = np.sqrt(MISFIT_N)
    wide = np.geomspace(1e-3, 150.0, 200)
    for power, factor in ((2.0, 1.0), (2.0, 1.3), (3.0, 1.0)):
        depth = (wide / factor) ** (1.0 / power)
        wanted = np.sqrt(np.mean((np.log(factor * aim**power) - np.log(MISFIT_N)) ** 2))
        assert misfit(depth, wide, aim) == pytest.approx(wanted, abs=1e-3)
    short = np.where(wide < 14.9, np.sqrt(wide), np.nan)
    assert misfit(short, wide, aim) is None and misfit(np.full(200, np.nan), wide, aim) is None


def candidate(power=2.0, young=0.06):
    depth = 6.0 * np.linspace(0.0, 1.0, SAMPLES)
    curves = Curves(np.array([9.0, 10.0]), np.array([6.0, 6.0]), np.stack([depth, 20.0 * depth**power]))
    slabs = Slabs(curves, np.array([0, 1]), np.array([1.0, young]), (1e-9,), np.zeros((2, 1)))
    evaluation = SimpleNamespace(slabs=slabs, protocol=PAPER, sampling=Sampling(), low_force_range=np.array([0.0, 0.4]),
                                 steady_state_range=np.array([0.0, 0.7]))  # fmt: skip
    return DesignCandidate(10.0, 15.0, 1, evaluation)


def test_a_design_against_the_aim_at_low_force():
    targets = SimpleNamespace(**vars(TARGETS), sampling=Sampling())
    found = low_force(candidate(), targets)
    assert found.misfit_rms_ln_force == pytest.approx(0.0, abs=0.05)
    assert (found.share_below_5N, found.share_above_5N) == (0.4, 0.7)
    assert all(value == pytest.approx(2.0, rel=0.01) for value in found.exponent_at_N.values())
    assert found.depth_over_thickness == pytest.approx(np.sqrt(15.0 / 1.2) / 10.0, rel=1e-3)
    stiff = low_force(candidate(young=0.12), targets)
    assert stiff.misfit_rms_ln_force == pytest.approx(np.log(2.0), abs=0.03)
    at, curve = np.array([1.0, 3.0, 6.5]), (candidate().steady_depth_mm(PAPER.wide_N), PAPER.wide_N)
    np.testing.assert_allclose(force_at(at, *curve)[:2], 1.2 * at[:2] ** 2, rtol=5e-3)
    assert np.isnan(force_at(at, *curve)[2])


class Soft:
    """E falls from 0.1 to 0.02 MPa over the ratios."""

    name, ratio_min, ratio_max = "soft", 12.0, 20.0

    def young_MPa(self, ratio):
        return 0.1 - 0.01 * (np.asarray(ratio) - 12.0)


@pytest.mark.parametrize(
    ("share", "ratio", "able"), [(0.5, 15.9, True), (0.5, 18.1, False), (1.2, 12.0, False), (1.2, 14.1, True),
                                 (0.2, 12.0, True), (0.19, 12.0, False)],
)  # fmt: skip
def test_a_second_resin_is_mixed_within_the_resins_ends(share, ratio, able):
    shape = SimpleNamespace(layers=lambda: (3.0, share))
    assert mixable(shape, ratio, Soft()) is able and mixable(Slab(), 99.0, Soft())


def shaped(kind, worth, solved=False, shape=None, others=()):
    best = SimpleNamespace(worth=lambda: worth, merit=lambda: worth, loss=0.0, ratio=15.0, thickness_mm=10.0, rank=2)
    own = shape or SimpleNamespace(name=kind, plain=kind == "slab", layers=lambda: None)
    law = SimpleNamespace(family=SimpleNamespace(source="table"))
    return Shaped(own, law, SearchResult(best, tuple(others), None), object() if solved else None)


@pytest.fixture
def plain(monkeypatch):
    monkeypatch.setattr(module, "with_parameters", lambda candidates, space: tuple(candidates))
    monkeypatch.setattr(module, "compare_shape", lambda one, space, by: (one.shape.name, one.worth, by))
    monkeypatch.setattr(Shaped, "table", property(lambda one: one.law))
    weights = {"resolution": 0.02}
    return SimpleNamespace(targets=SimpleNamespace(weights=weights))


def outcome(slab, *designs, asked="auto"):
    flat = None if slab is None else SearchResult(SimpleNamespace(worth=lambda: slab), (), None)
    return SearchOutcome(asked, flat and Shaped(Slab(), None, flat), "none", tuple(designs))


def test_the_best_of_all_kinds_is_chosen_and_a_slab_where_it_is_as_good(plain):
    designs = shaped("crowned", 0.5), shaped("crowned", 0.6), shaped("boned", 0.55)
    for slab, kind in ((0.59, "crowned"), (0.6, "slab"), (None, "crowned")):
        assert choose(outcome(slab, *designs), plain).shape.name == kind
    assert choose(outcome(0.9, *designs, asked="crowned"), plain).shape.name == "crowned"
    found = choose(outcome(0.1, *designs), plain)
    assert found.comparisons[1:] == (("crowned", 0.6, "table"), ("boned", 0.55, "table"))
    # one that was solved comes before any that only a table knows
    solved = choose(outcome(0.1, *designs, shaped("boned", 0.3, True)), plain)
    assert solved.shape.name == "boned" and ("boned", 0.3, "elements") in solved.comparisons
    only = choose(outcome(0.4, asked="slab"), plain)
    assert only.shape.name == "slab" and only.comparisons == ()
    assert choose(outcome(0.4), plain).shape.name == "slab"
    with pytest.raises(NoAnswerError):
        choose(outcome(None), plain)


def test_other_kinds_within_the_resolution_are_near(plain):
    designs = shaped("crowned", 0.6), shaped("boned", 0.5801), shaped("layered", 0.5799)
    every = outcome(0.5801, *designs)
    chosen = choose(every, plain)
    assert [one.shape.name for one in close_to(chosen, every, plain)] == ["crowned", "boned", "slab"]
    far = outcome(0.5799, *designs)
    assert [one.shape.name for one in close_to(choose(far, plain), far, plain)] == ["crowned", "boned"]
    asked = outcome(0.6, *designs, asked="crowned")
    assert len(close_to(choose(asked, plain), asked, plain)) == 1
    # what only a table knows is not compared with what was solved
    solved = outcome(0.1, shaped("crowned", 0.6, True), shaped("boned", 0.6))
    assert [one.shape.name for one in close_to(choose(solved, plain), solved, plain)] == ["crowned"]


def test_layered_pads_keep_the_alternatives_that_can_be_mixed():
    layered = SimpleNamespace(name="layered", layers=lambda: (3.0, 0.5))
    others = [SimpleNamespace(ratio=ratio) for ratio in (13.0, 19.0)]
    kept = _pourable(shaped("layered", 0.5, shape=layered, others=others), Soft())
    assert [one.ratio for one in kept.result.alternatives] == [13.0]
    stiff = SimpleNamespace(name="layered", layers=lambda: (3.0, 0.1))
    assert _pourable(shaped("layered", 0.5, shape=stiff), Soft()) is None
    flat = shaped("crowned", 0.5)
    assert _pourable(flat, Soft()) is flat


def test_the_forces_of_a_test_are_laid_out_from_a_tenth_of_the_lowest():
    test = Protocol((4.0, 8.0, 12.0, 16.0), (5.0, 50.0))
    assert (test.slow_mm_s, test.fast_mm_s, test.needed_N) == (5.0, 50.0, 12.0)
    assert (test.steady_grid_N[0], test.steady_grid_N[-1]) == (4.0, 16.0)
    assert test.low_grid_N[[0, -1]] == pytest.approx([0.4, 4.0])
    assert test.misfit_N[[0, -1]] == pytest.approx([0.4, 16.0])
    assert test.wide_N[0] < 0.01 * 4.0 and test.wide_N[-1] == pytest.approx(160.0)
    assert np.diff(np.log(test.misfit_N)) == pytest.approx(np.diff(np.log(test.misfit_N))[0])
    assert test.words == "4 to 16 N" and Protocol((7.0,)).words == "7 N" and Protocol((7.0,)).needed_N == 7.0
    assert len(Protocol((7.0,)).steady_grid_N) == 1 and test.exponent_at_N[-4:] == test.forces_N
    asked = Request("palm", force_N=(9.0, 3.0, 9.0), velocity_mm_s=(250.0, 10.0))
    assert asked.protocol.forces_N == (3.0, 9.0) and asked.protocol.slow_mm_s == 10.0
    assert Request("palm", punch="rectangle:20x10").punch_text == "20 x 10 mm"
    assert (Request("palm", punch="ball:10").face, Request("palm").face) == ("frictionless", "bonded")


CROWN = read_shape("crowned:radius=21.2,height=2,foot=9.4")


def test_a_family_law_keeps_or_scales_the_shape_and_is_the_same_row_by_row():
    family = TableFamily("crowned")
    cast, grown = FamilyLaw(family, CROWN, 5.0, cast=True), FamilyLaw(family, CROWN, 5.0)
    depth, h = np.array([[0.5, 1.0], [0.4, 1.2]]), np.array([[5.0], [5.2]])
    for law in (cast, grown):
        rows = law.force(depth, h, 0.03, 7.9)
        each = law.force(depth.ravel(), np.repeat(h[:, 0], 2), 0.03, 7.9).reshape(2, 2)
        np.testing.assert_allclose(rows, each, rtol=1e-9)
        np.testing.assert_allclose(law.force(depth, h, 0.06, 7.9), 2.0 * rows)
        limit = law.depth_limit_mm(np.array([5.0, 5.2]), 7.9)
        assert np.all(limit > 1.2) and np.isfinite(law.force(limit, np.array([5.0, 5.2]), 1.0, 7.9)).all()
        assert np.isnan(law.force(limit + 0.01, np.array([5.0, 5.2]), 1.0, 7.9)).all()
        assert np.all(law.relative_error(depth, h + 0.0 * depth, 7.9) > 0.0)
    # a pad poured too thick has the same top on a softer, thicker base
    same = cast.force(np.array([1.0]), np.array([5.0]), 0.03, 7.9)
    assert same == pytest.approx(grown.force(np.array([1.0]), np.array([5.0]), 0.03, 7.9))
    assert cast.force(np.array([1.0]), np.array([5.2]), 0.03, 7.9) < same
    assert cast.shape_at(6.0).parameters == CROWN.parameters and grown.shape_at(6.0).parameters != CROWN.parameters


def test_a_pad_a_little_outside_the_table_is_at_its_end_and_one_farther_out_is_not():
    family = TableFamily("crowned")
    low, high = family.table.low, family.table.high
    inputs = family._raw(Designs("crowned", np.array([5.0]), {n: np.array([v]) for n, v in CROWN.parameters}), 7.9)
    assert np.all((inputs >= low) & (inputs <= high))

    class Moved(TableFamily):
        def __init__(self, factor, place):
            super().__init__("crowned")
            self.factor, self.place = factor, place

        def _raw(self, designs, radius_mm):
            raw = np.repeat(inputs, 1, axis=0).copy()
            raw[:, self.place] = high[self.place] * self.factor
            return raw

    for place in range(len(high)):
        if high[place] <= 0.0:
            continue
        np.testing.assert_allclose(Moved(1.05, place)._inputs(None, 7.9)[0, place], high[place])
        assert Moved(1.08, place)._inputs(None, 7.9)[0, place] == pytest.approx(1.08 * high[place])


def test_numbers_of_a_calibration_are_read_with_their_share_either_way():
    one = calibrated._around(40.0, 0.1, "x")
    assert (one.value, one.low, one.high) == (40.0, 36.0, 44.0)
    assert calibrated._around(40.0, 0.0, "x").low == 40.0


def test_a_shape_that_is_named_but_unknown_is_refused():
    for text in ("pyramid", "stud"):
        with pytest.raises(InputError):
            module.kinds_of(text)
    assert module.kinds_of("auto") == module.designable_kinds() and module.kinds_of("slab") == ("slab",)
