"""Search over shapes: stands on the closed small-strain law of a cap on a layer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search import best_of_kinds as best_of_kinds_module
from dummydesign.design.search import shape_family as families
from MISSING.dummydesign.design.search.best_of_kinds import TRIED, best_of_kinds, choose, misfits, search_fixed
from dummydesign.design.assessment.decision import MISFIT_N, low_force, misfit
from dummydesign.design.search.shape_search import kinds_of, sieve, search_shapes
from dummydesign.design.search.shape_family import Designs, FamilyLaw
from dummydesign.design.search.slabs import SearchSpace, search
from dummydesign.geometry.conic import sphere_foot_mm
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.resin import load_resin
from tests.support.refusal import raises_code
from tests.support.slab_by_formula import LayerLaw, make_tissue

RADIUS = 7.9
SAMPLING = Sampling()


class CapFamily:
    """Spherical caps by F = 16/9 E sqrt(R) d^1.5 (1 + 1.133 c + 1.497 c^2 + 1.469 c^3 + 0.755 c^4), c^2 = R d / h^2."""

    kind = "crowned"
    source = "law"

    def candidates(self, thickness_mm, radius_mm):
        h, r = (x.ravel() for x in np.meshgrid(thickness_mm, np.array([4.0, 8.0, 12.0, 20.0]), indexing="ij"))
        height = np.round(np.minimum(0.6 * h, 0.4 * r), 1)
        foot = np.array([sphere_foot_mm(a, b) for a, b in zip(r, height)])
        return Designs(self.kind, h, {"radius": r, "height": height, "foot": foot})

    def check(self, shape):
        assert shape.name == self.kind

    def at_thickness(self, shape, thickness_mm, wanted_mm):
        k = np.asarray(wanted_mm, float) / thickness_mm
        return Designs(self.kind, np.asarray(wanted_mm, float),
                       {"radius": shape.radius_mm / k, "height": shape.height_mm * k,
                        "foot": np.full(len(k), shape.foot_mm)})  # fmt: skip

    def area_mm2(self, designs, depth_mm, radius_mm):
        r, h = designs.parameters["radius"][:, None], designs.thickness_mm[:, None]
        d = np.maximum(depth_mm, 0.0)
        c = np.sqrt(r * d) / h
        f = 1 + 1.133 * c + 1.497 * c**2 + 1.469 * c**3 + 0.755 * c**4
        return 16.0 / 9.0 * np.sqrt(r) * d**1.5 * f

    def limit_mm(self, designs, radius_mm):
        return 0.55 * designs.thickness_mm

    def relative_error(self, designs, depth_mm, radius_mm):
        return np.full(depth_mm.shape, 0.05)


@pytest.fixture(scope="module")
def setting():
    tissue, resin = make_tissue((0.5, 0.8, 1.3)), load_resin("polyurethane-nagoya")
    targets = make_targets(tissue, "average", SAMPLING)
    return SearchSpace(resin, targets, np.arange(4.0, 10.5, 0.5), resin.ratios(), RADIUS, SAMPLING)


@pytest.fixture(scope="module")
def shaped(setting):
    return search_shapes([CapFamily()], setting)[0][0]


def test_misfit_of_the_aims_own_curve_is_zero_and_of_another_power_is_closed_form():
    aim = np.cbrt(MISFIT_N / 0.7)
    force = np.geomspace(0.01, 50.0, 200)
    assert misfit(np.cbrt(force / 0.7), force, aim) == pytest.approx(0.0, abs=1e-9)
    # a straight line F = k x meets the cube with rms of (ln F_i - mean) (1 - 1/3), when k is the best one
    k = np.exp(np.mean(np.log(MISFIT_N) - np.log(aim)))
    expected = np.std(np.log(MISFIT_N)) * 2.0 / 3.0
    assert misfit(force / k, force, aim) == pytest.approx(expected, rel=1e-6)


def test_misfit_has_no_value_when_the_pad_ends_before_the_aims_depth():
    force = np.geomspace(0.01, 50.0, 200)
    assert misfit(np.where(force < 5.0, force, np.nan), force, np.cbrt(MISFIT_N / 0.01)) is None


def test_sieve_finds_the_same_misfit_and_modulus_as_a_brute_force_search(setting):
    targets, thickness = setting.targets, setting.thickness_mm
    designs, young = CapFamily().candidates(thickness, RADIUS), np.geomspace(0.005, 0.5, 20001)
    depth = targets.aim_depth_mm(MISFIT_N[::3])
    designs = designs.take(CapFamily().limit_mm(designs, RADIUS) >= depth[-1])
    found = misfits(CapFamily(), designs, targets, young, RADIUS)
    for index in (0, int(np.argmin(found)), len(found) - 1):
        area = CapFamily().area_mm2(designs.take(np.array([index])), depth[None], RADIUS)[0]
        rms = np.sqrt(np.mean((np.log(young[:, None] * area) - np.log(MISFIT_N[::3])) ** 2, axis=1))
        assert found[index] == pytest.approx(rms.min(), rel=1e-4)


def test_the_best_of_each_thickness_is_the_same_as_among_all_that_can_be_cast(setting):
    few, every = prescreen(CapFamily(), setting), CapFamily().candidates(setting.thickness_mm, RADIUS)
    deepest = setting.targets.aim_depth_mm(MISFIT_N[-1:])
    every = every.take((CapFamily().limit_mm(every, RADIUS) >= deepest) & every.castable(setting.pad_mm))
    known = CapFamily(), setting.targets, setting.resin.young_MPa(setting.ratio)
    misfit, kept = (misfits(known[0], designs, *known[1:], RADIUS) for designs in (every, few))
    best = {h: misfit[every.thickness_mm == h].min() for h in set(every.thickness_mm.tolist())}
    assert kept.tolist() == sorted(best.values())[: len(kept)] and len(kept) == min(len(best), TRIED)
    assert [best[h] for h in few.thickness_mm.tolist()] == kept.tolist()


def test_a_cap_comes_nearer_to_the_tissue_than_the_slab_by_the_same_rule(setting, shaped):
    targets = setting.targets
    flat = search(LayerLaw(), setting, setting.targets.weights.low_aim).best
    best = shaped.result.best
    assert best.merit() > flat.merit()
    assert low_force(best, targets).misfit_rms_ln_force < 0.5 * low_force(flat, targets).misfit_rms_ln_force
    assert low_force(best, targets).exponent_at_N["0.5"] > low_force(flat, targets).exponent_at_N["0.5"] + 0.5


def test_the_shape_found_can_be_cast_and_is_given_in_tenths_of_a_millimetre(shaped):
    shape = shaped.shape
    shape.check(shaped.result.best.thickness_mm)
    assert shape.radius_mm == round(shape.radius_mm, 1) and shape.height_mm == round(shape.height_mm, 1)


def test_cast_law_keeps_the_top_and_proportional_law_stretches_it():
    shape = Crowned(10.0, 2.0)
    kept, stretched = FamilyLaw(CapFamily(), shape, 5.0, cast=True), FamilyLaw(CapFamily(), shape, 5.0)
    at = (1.0, 6.0, 0.05, RADIUS)
    assert stretched.force(1.0, 5.0, 0.05, RADIUS) == pytest.approx(float(kept.force(1.0, 5.0, 0.05, RADIUS)))
    pad = Designs("crowned", np.array([6.0]), {"radius": np.array([10.0])})
    direct = CapFamily().area_mm2(pad, np.array([[1.0]]), RADIUS)
    assert float(kept.force(*at)) == pytest.approx(0.05 * direct.item())
    assert float(stretched.force(*at)) < float(kept.force(*at))


def test_a_given_shape_is_kept_and_only_thicknesses_that_hold_it_are_searched(setting):
    found = search_fixed(CapFamily(), Crowned(8.0, 4.0), setting)
    assert found.shape == Crowned(8.0, 4.0)
    assert found.result.score_map.thickness_mm.min() >= 5.5
    with raises_code("out_of_range", "crown_height_mm"):
        search_fixed(CapFamily(), Crowned(30.0, 12.0), setting)


def test_no_shape_when_the_pads_are_too_thin_for_the_tissue(setting):
    soft = make_targets(make_tissue((0.002, 0.003, 0.004)), "average", SAMPLING)
    with raises_code("no_feasible_design", "pad"):
        raise search_shapes([CapFamily()], replace(setting, targets=soft, thickness_mm=np.array([3.0, 4.0])))[0]


def test_auto_takes_the_best_merit_of_all_kinds_and_lists_the_slab_beside(setting, monkeypatch):
    monkeypatch.setattr(best_of_kinds_module, "designable_kinds", lambda: ("crowned",))
    monkeypatch.setattr(best_of_kinds_module, "load_family", lambda kind: CapFamily())
    chosen = choose(best_of_kinds("auto", LayerLaw(), setting), setting)
    merit = {item.kind: item.candidate.merit() for item in chosen.comparisons}
    assert set(merit) == {"slab", "crowned"}
    assert chosen.shape.name == max(merit, key=merit.get)
    assert chosen.result.best.merit() == max(merit.values())


@pytest.mark.parametrize(("text", "code"), [("crownd", "unknown_name"), ("crowned:3", "missing")])
def test_unknown_or_incomplete_shapes_are_refused(text, code):
    with raises_code(code):
        kinds_of(text)


def test_all_pads_of_a_law_at_once_have_the_forces_of_one_after_the_other():
    shape, thickness = Crowned(21.2, 2.0, 9.4), np.array([4.0, 4.5, 5.0])
    law = FamilyLaw(families.load_family("crowned"), shape, 4.5)
    depth = law.depth_limit_mm(thickness, 7.9)[:, None] * np.linspace(0.0, 1.02, 30)
    together = law.force(depth, thickness[:, None], 0.04, 7.9)
    alone = np.stack([law.force(row, float(value), 0.04, 7.9) for row, value in zip(depth, thickness)])
    np.testing.assert_allclose(together, alone, rtol=1e-9)
    assert np.isnan(together[:, -1]).all() and (together[:, 0] == 0.0).all()
