"""The search over kinds on stand-ins: sieve, neighbours, misfit, who is chosen and who is near."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design import calibrated
from dummydesign.design.assessment.decision import MISFIT_N, force_at, low_force, misfit
from dummydesign.design.request import NAGOYA_PROTOCOL, Protocol, Request
from dummydesign.design.scoring.press_simulation import DEPTH_SHARE, SAMPLES, PadBatch, Sampling, SlabCurves
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.search import shape_search as module
from dummydesign.design.search.shape_family import Designs, FamilyLaw, TableFamily
from dummydesign.design.search.shape_search import match_of, mixable, sieve
from dummydesign.design.search.slabs import DesignCandidate
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

    @property
    def gel_mm(self):
        return self.thickness_mm

    def take(self, chosen):
        limit = None if self.limit_mm is None else self.limit_mm[chosen]
        return Made(self.thickness_mm[chosen], self.power[chosen], limit)

    def castable(self, pad_mm):
        return self.thickness_mm < pad_mm[0]


TARGETS = SimpleNamespace(
    protocol=NAGOYA_PROTOCOL, aim_depth_mm=lambda force: np.sqrt(np.asarray(force) / 1.2), limits=verdict_limits()
)


def sieved(*thickness, young=(0.01, 0.1), gel=0.6):
    targets = SimpleNamespace(**{**vars(TARGETS), "limits": SimpleNamespace(gel_compression=gel)})
    space = SimpleNamespace(
        thickness_mm=np.array(thickness),
        targets=targets,
        radius_mm=7.9,
        pad_mm=(150.0, 120.0),
        resin=SimpleNamespace(young_MPa=np.asarray),
        ratio=np.array(young),
    )
    return sieve(Powers(), space)


def test_the_sieve_puts_the_power_of_the_aim_first_with_its_modulus_and_misfit():
    """The aim is 1.2 d^2: of 20 E d^2 that is a modulus of 0.06 MPa, without any misfit."""
    found, mean, spread = sieved(6.0, 8.0, 10.0)
    # the aim is 3.54 mm deep at 15 N: 6 mm are too thin for half of the thickness
    assert set(found.thickness_mm) == {8.0, 10.0} and found.power[:2].tolist() == [2.0, 2.0]
    np.testing.assert_allclose(np.exp(mean[:2]), 0.06)
    np.testing.assert_allclose(spread[:2], 0.0, atol=1e-12)
    forces = NAGOYA_PROTOCOL.misfit_N[:: module.SIEVE_STEP]
    away = np.log(forces) - np.log(20.0 * TARGETS.aim_depth_mm(forces))
    np.testing.assert_allclose(spread[found.power == 1.0], np.std(away), rtol=1e-6)
    np.testing.assert_allclose(mean[found.power == 1.0], np.mean(away), rtol=1e-6)
    with pytest.raises(NoAnswerError):
        sieved(6.0)
    assert DEPTH_SHARE >= 0.5


def test_a_resin_that_has_no_pad_of_the_best_modulus_orders_pads_by_what_it_has():
    """With moduli from 0.5 MPa on, stiffer than the aim, a softer power comes nearer."""
    forces = NAGOYA_PROTOCOL.misfit_N[:: module.SIEVE_STEP]
    depth, order = TARGETS.aim_depth_mm(forces), sieved(10.0, young=(0.02, 0.03))[0].power.tolist()
    away = {p: np.log(forces) - np.log(20.0 * depth**p) for p in (1.0, 2.0, 3.0)}
    rms = {p: np.sqrt(np.mean((one - np.clip(one.mean(), np.log(0.02), np.log(0.03))) ** 2)) for p, one in away.items()}
    assert order == sorted(rms, key=rms.get)


def test_a_stricter_limit_of_the_gel_leaves_thicker_pads():
    assert set(sieved(8.0, 10.0, 12.0, gel=0.4)[0].thickness_mm) == {10.0, 12.0}
    assert set(sieved(8.0, 10.0, 12.0, gel=0.3)[0].thickness_mm) == {12.0}


def test_the_match_of_a_pad_is_the_modulus_that_fits_best_and_what_it_leaves():
    chance = np.random.default_rng(86)
    forces, area = np.geomspace(0.5, 15.0, 12), np.exp(chance.normal(size=(5, 12)))
    area[3, 8:] = np.nan
    mean, spread = match_of(forces, area)
    for row, own in enumerate(area):
        known = np.isfinite(own)

        def rms(log_young, own=own, known=known):
            return np.sqrt(np.mean((np.log(forces[known]) - np.log(own[known]) - log_young) ** 2))

        assert rms(mean[row]) == pytest.approx(spread[row])
        assert min(rms(mean[row] - 0.01), rms(mean[row] + 0.01)) > spread[row]
    # a pad of another stiffness has another modulus and the same misfit
    again, same = match_of(forces, 3.0 * area)
    np.testing.assert_allclose(again, mean - np.log(3.0))
    np.testing.assert_allclose(same, spread, atol=1e-12)
    assert np.isnan(match_of(forces, np.full((1, 12), np.nan))[0]).all()


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
    curves = SlabCurves(np.array([9.0, 10.0]), np.array([6.0, 6.0]), np.stack([depth, 20.0 * depth**power]))
    slabs = PadBatch(curves, np.array([0, 1]), np.array([1.0, young]), (1e-9,), np.zeros((2, 1)))
    evaluation = SimpleNamespace(
        slabs=slabs,
        protocol=NAGOYA_PROTOCOL,
        sampling=Sampling(),
        low_force_range=np.array([0.0, 0.4]),
        steady_state_range=np.array([0.0, 0.7]),
    )
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
    at, curve = np.array([1.0, 3.0, 6.5]), (candidate().steady_depth_mm(NAGOYA_PROTOCOL.wide_N), NAGOYA_PROTOCOL.wide_N)
    np.testing.assert_allclose(force_at(at, *curve)[:2], 1.2 * at[:2] ** 2, rtol=5e-3)
    assert np.isnan(force_at(at, *curve)[2])


class Soft:
    """E falls from 0.1 to 0.02 MPa over the ratios."""

    name, ratio_min, ratio_max = "soft", 12.0, 20.0

    def young_MPa(self, ratio):
        return 0.1 - 0.01 * (np.asarray(ratio) - 12.0)


@pytest.mark.parametrize(
    ("share", "ratio", "able"),
    [
        (0.5, 15.9, True),
        (0.5, 18.1, False),
        (1.2, 12.0, False),
        (1.2, 14.1, True),
        (0.2, 12.0, True),
        (0.19, 12.0, False),
    ],
)
def test_a_second_resin_is_mixed_within_the_resins_ends(share, ratio, able):
    shape, resin = SimpleNamespace(layers=lambda: (3.0, share)), Soft()
    ratios = np.array([ratio, 15.0, ratio])
    assert mixable(shape, resin, ratios).tolist() == [able, share >= 0.3, able]
    assert mixable(Slab(), resin, ratios).all()


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
    one = calibrated.fitted_around(40.0, 0.1, "x")
    assert (one.value, one.low, one.high) == pytest.approx((40.0, 40.0 * np.exp(-0.1), 40.0 * np.exp(0.1)))
    assert calibrated.fitted_around(40.0, 0.0, "x").low == 40.0


def test_a_shape_that_is_named_but_unknown_is_refused():
    for text in ("pyramid", "stud"):
        with pytest.raises(InputError):
            module.kinds_of(text)
    assert set(module.kinds_of("auto")) == {"slab", *module.designable_kinds()} and module.kinds_of("slab") == ("slab",)
