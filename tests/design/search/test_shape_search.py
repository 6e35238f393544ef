"""Search over shapes: stands on the closed small-strain law of a cap on a layer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.assessment.decision import MISFIT_N, low_force, misfit
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.outlook import SURE
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search import shape_family as families
from dummydesign.design.search import shape_search as module
from dummydesign.design.search.shape_family import Designs, FamilyLaw
from dummydesign.design.search.shape_search import LEAST, candidate_of, kinds_of, rank, search_shapes, sieve
from dummydesign.geometry.conic import sphere_foot_mm
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.plan import least_film_mm
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin_file import save_resin
from tests.support.cast_pads import space_with
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
        return Designs(
            self.kind,
            np.asarray(wanted_mm, float),
            {"radius": shape.radius_mm / k, "height": shape.height_mm * k, "foot": np.full(len(k), shape.foot_mm)},
        )

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
    return replace(space_with(resin, targets, np.arange(4.0, 10.5, 0.5), resin.ratios()), radius_mm=RADIUS)


@pytest.fixture(scope="module")
def capped():
    """Caps in place of the tables."""
    patch = pytest.MonkeyPatch()
    patch.setattr(module, "designable_kinds", lambda: ("crowned",))
    patch.setattr(module, "load_family", lambda kind: CapFamily())
    yield
    patch.undo()


@pytest.fixture(scope="module")
def found(setting, capped):
    return search_shapes("auto", LayerLaw(), setting)


@pytest.fixture(scope="module")
def shaped(found):
    return next(one for one in found[0] if one.shape.name == "crowned")


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


def test_the_sieve_finds_the_same_misfit_and_modulus_as_a_brute_force_search(setting):
    targets, young = setting.targets, np.geomspace(0.005, 0.5, 20001)
    designs, mean, spread = sieve(CapFamily(), setting)
    depth = targets.aim_depth_mm(MISFIT_N[::3])
    for index in (0, len(mean) // 2, len(mean) - 1):
        area = CapFamily().area_mm2(designs.take(np.array([index])), depth[None], RADIUS)[0]
        rms = np.sqrt(np.mean((np.log(young[:, None] * area) - np.log(MISFIT_N[::3])) ** 2, axis=1))
        assert spread[index] == pytest.approx(rms.min(), rel=1e-4)
        assert np.exp(mean[index]) == pytest.approx(young[np.argmin(rms)], rel=1e-3)
    every = CapFamily().candidates(setting.thickness_mm, RADIUS)
    deep = CapFamily().limit_mm(every, RADIUS) >= depth[-1]
    assert len(mean) == deep.sum() and designs.thickness_mm.min() == every.thickness_mm[deep].min()


def test_every_kind_has_designs_in_one_order_and_shapes_can_be_cast(found, setting):
    assert {one.shape.name for one in found[0]} == {"slab", "crowned"} and not found[1]
    assert list(found[0]) == rank(found[0], setting)
    for one in found[0]:
        one.shape.check(one.thickness_mm)
        assert one.outlook.ratio in setting.ratio and not one.solved


def test_a_cap_comes_nearer_to_the_tissue_than_the_slab_and_is_chosen(found, setting, shaped):
    flat = next(one for one in found[0] if one.shape.name == "slab")
    assert found[0][0] is shaped and shaped.outlook.after_puck > flat.outlook.after_puck
    near, far = (
        low_force(candidate_of(one.cast, one.thickness_mm, one.outlook.ratio, setting), setting.targets)
        for one in (shaped, flat)
    )
    assert near.misfit_rms_ln_force < 0.5 * far.misfit_rms_ln_force
    assert near.exponent_at_N["0.5"] > far.exponent_at_N["0.5"] + 0.5


def test_unlike_pads_of_a_thickness_are_kept_and_alike_ones_are_not(setting, capped):
    sieved = module._sieve(CapFamily(), setting)
    lengths = [(one.thickness_mm, *dict(one.shape.parameters).values()) for one in sieved]
    for n, one in enumerate(lengths):
        for other in lengths[:n]:
            assert one[0] != other[0] or not module._alike(np.array(one), np.array(other))
    assert max(np.unique([one[0] for one in lengths], return_counts=True)[1]) <= module.A_THICKNESS


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
    sieved = module._sieve_fixed(CapFamily(), Crowned(8.0, 4.0), setting)
    assert all(one.shape == Crowned(8.0, 4.0) and one.cast.cast for one in sieved)
    assert min(one.thickness_mm for one in sieved) >= 5.5
    # one shape as it is cast on each base: its force is that of the pad itself
    for one in sieved[::3]:
        pad = Designs("crowned", np.array([one.thickness_mm]), {n: np.array([v]) for n, v in one.shape.parameters})
        direct = CapFamily().area_mm2(pad, np.array([[1.0]]), RADIUS).item()
        assert float(one.cast.force(1.0, one.thickness_mm, 1.0, RADIUS)) == pytest.approx(direct)
    with raises_code("out_of_range", "crown_height_mm"):
        module._sieve_fixed(CapFamily(), Crowned(30.0, 12.0), setting)


def test_no_shape_when_the_pads_are_too_thin_for_the_tissue(setting, capped):
    soft = make_targets(make_tissue((0.002, 0.003, 0.004)), "average", SAMPLING)
    with raises_code("no_feasible_design", "pad"):
        search_shapes("crowned", LayerLaw(), replace(setting, targets=soft, thickness_mm=np.array([3.0, 4.0])))


def test_a_kind_that_is_refused_is_missing_with_its_reason_and_alone_an_error(setting, capped):
    thin = replace(setting, thickness_mm=np.array([6.0]))
    found = search_shapes("auto", LayerLaw(), thin, {"crowned": "no glue"})
    assert {one.shape.name for one in found[0]} == {"slab"} and found[1] == {"crowned": "no glue"}
    with raises_code("unsupported", "shape"):
        search_shapes("crowned", LayerLaw(), thin, {"crowned": "no glue"})


def test_a_pad_that_cannot_be_made_is_left_out_with_its_reason_and_its_error_stands_where_it_was_named(setting, capped):
    """Whatever is wrong with one pad; another of its kind, or another kind, takes its place."""
    space = replace(setting, thickness_mm=np.array([6.0, 7.0]))

    def refusing(refused):
        def tolerances(shape, thickness, ratio):
            if refused(shape, thickness):
                raise InputError(f"no mould of {thickness:g} mm", "cannot_be_made", "thickness_mm", thickness)
            return setting.tolerances(shape, thickness, ratio)

        return replace(space, tolerances=tolerances)

    designs, missing = search_shapes("auto", LayerLaw(), refusing(lambda shape, thickness: not shape.plain))
    assert {one.shape.name for one in designs} == {"slab"}
    assert list(missing) == ["crowned"] and missing["crowned"].startswith("no mould of")
    thicker, none = search_shapes("auto", LayerLaw(), refusing(lambda shape, thickness: thickness == 6.0))
    assert {one.thickness_mm for one in thicker} == {7.0} and none == {}
    with raises_code("cannot_be_made", "thickness_mm"):
        search_shapes("crowned", LayerLaw(), refusing(lambda shape, thickness: True))
    with raises_code("no_feasible_design", "pad"):
        search_shapes("auto", LayerLaw(), refusing(lambda shape, thickness: True))


@pytest.mark.parametrize("number", [3, *(pytest.param(n, marks=pytest.mark.slow) for n in range(24) if n != 3)])
def test_narrow_ratios_of_a_measured_batch_have_an_answer_of_pads_that_can_be_made(number, tmp_path):
    """By the tables, of all kinds, tissues in turn; a layered pad's base is to be mixed at every ratio it may have."""
    rng, resin = np.random.default_rng([20611, number]), load_resin()
    numbers = dict(resin.numbers)
    factor = float(np.exp(rng.normal(0.0, 0.15)))
    young = numbers["young_ref_kPa"]
    ends = {"value": factor * young.value, "low": 0.95 * factor * young.value, "high": 1.05 * factor * young.value}
    batch = replace(resin, name="batch", numbers={**numbers, "young_ref_kPa": replace(young, **ends)})
    low = round(float(rng.uniform(15.2, 15.9)), 1)
    request = Request(
        tissue=("forefinger", "palm", "thenar")[number % 3],
        resin=str(save_resin(batch, tmp_path / "batch.toml")),
        ratio=(low, low + float(rng.choice([0.0, 0.1]))),
    )
    problem = read_problem(request)
    try:
        designs, missing = search_shapes("auto", problem.slab_law, problem)
    except NoAnswerError as none:  # a batch too soft or too stiff in its window
        designs, missing = [], {"none": none.code}
        assert none.code == "no_feasible_design"
    for one in designs:
        for ratio in {one.outlook.ratio, one.outlook.known_ratio, *one.outlook.ratios.tolist()}:
            mould_spec(
                one.thickness_mm, resin=problem.resin, ratio=ratio, kind=one.shape.name, parameters=one.shape.parameters
            )
    assert {one.shape.name for one in designs}.isdisjoint(missing) and all(missing.values())


@dataclass(frozen=True, eq=False)
class Shares:
    """An outlook by its level and its shares batch by batch."""

    number: int
    chances: np.ndarray
    poured: np.ndarray
    misfit: float = 0.1
    beyond: float = 0.0
    ratio: float = 15.0

    after_puck = property(lambda self: float(self.chances.mean()))
    as_poured = property(lambda self: float(self.poured.mean()))

    def level(self, limits, strict):
        return self.number

    ties = module.Outlook.ties


def ranked(*outlooks):
    space = SimpleNamespace(targets=SimpleNamespace(limits=None, strict=False, tissue=SimpleNamespace(subjects="abc")))
    designs = [SimpleNamespace(outlook=one, number=n) for n, one in enumerate(outlooks)]
    return [one.number for one in rank(designs, space)]


FEW = np.full(160, 0.5)


def test_pads_are_ordered_by_level_then_share_after_a_puck_then_as_poured_then_misfit():
    assert ranked(Shares(2, FEW + 0.4, FEW), Shares(1, FEW, FEW), Shares(3, FEW + 0.5, FEW)) == [1, 0, 2]
    assert ranked(Shares(2, FEW, FEW + 0.4), Shares(2, FEW + 0.01, FEW)) == [1, 0]
    assert ranked(Shares(2, FEW, FEW, 0.1), Shares(2, FEW, FEW + 0.01, 0.9)) == [1, 0]
    assert ranked(Shares(2, FEW, FEW, 0.3), Shares(2, FEW, FEW, 0.1), Shares(2, FEW, FEW, 0.2)) == [1, 2, 0]


@pytest.mark.parametrize("seed", [4711, 815, 90210])
def test_shares_are_tied_by_what_they_differ_batch_by_batch(seed):
    """What batches have in common is no error: two pads that differ alike in every batch are never tied."""
    chance = np.random.default_rng(seed)
    common, own = 0.3 * chance.standard_normal((2, 160))
    own -= own.mean()
    best = Shares(2, 0.5 + common, FEW, 0.5)
    assert ranked(best, Shares(2, best.chances - 0.001, FEW, 0.1)) == [0, 1]
    error = own.std() / np.sqrt(160.0)
    for times, tied in ((0.95, True), (1.05, False)):
        other = Shares(2, best.chances - own - times * SURE * error, FEW, 0.1)
        assert other.ties(best) is tied
        assert ranked(best, other) == ([1, 0] if tied else [0, 1])
        poured = Shares(2, FEW, best.chances, 0.5), Shares(2, FEW, other.chances, 0.1)
        assert ranked(*poured) == ([1, 0] if tied else [0, 1])


def test_of_pads_that_are_never_usable_the_one_least_beyond_the_limits_comes_first():
    none = np.full(160, 0.5 * LEAST)
    pads = [Shares(3, none, none, 0.1, 0.5), Shares(3, none, none, 0.4, 0.2), Shares(3, none, none, 0.3, 0.2)]
    assert ranked(*pads) == [2, 1, 0]
    assert ranked(*pads, Shares(3, none + 0.1, none, 0.9, 0.9))[0] == 3


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


def test_a_search_lists_no_crown_whose_foot_is_thinner_than_the_least_film() -> None:
    thin = Designs(
        "crowned",
        np.array([4.5, 4.5]),
        {"radius": np.array([21.5, 21.2]), "height": np.array([2.8, 2.0]), "foot": np.array([11.2, 9.4])},
    )
    assert thin.castable((150.0, 120.0)).all()
    assert thin.castable((150.0, 120.0), least_film_mm(mould_spec(4.5))).tolist() == [False, True]
