"""Gel over a bone, or between punch and base, is pressed to 0.6 of its own thickness and no further."""

import dataclasses

import numpy as np
import pytest

from dummydesign.design.assessment.pad_castings import verdict_of_design
from dummydesign.design.pad_evaluator import law_of_shape, one_pad
from dummydesign.design.scoring.castings import FORCE_LAW, MODULUS, RELAXATION, Tolerances
from dummydesign.design.scoring.press_simulation import designed_depth_mm, make_curves
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.search.shape_family import Designs, FamilyLaw, load_family
from dummydesign.design.suggestion import condition_rows
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import read_shape, shape_kind
from tests.support.cast_pads import cast_pad, evaluated, kinds_of, space_of

BONED = "boned:radius=38.2,height=2.4,foot=13.4"
CROWNED = "crowned:radius=5.1,height=3.8,foot=7.8"
SHARE = 0.6


@pytest.fixture(scope="module")
def forefinger():
    return space_of("forefinger")


def limits(forefinger, text, thickness, gel_compression=SHARE):
    space, slab_law, _ = forefinger
    law = law_of_shape(slab_law, read_shape(text), thickness)
    return float(make_curves(law, [thickness], space.radius_mm, gel_compression).limit_mm[0])


def test_over_a_bone_the_limit_is_that_of_the_gel_that_is_left(forefinger):
    assert limits(forefinger, BONED, 6.0) == pytest.approx(SHARE * (6.0 - 2.4))
    assert limits(forefinger, BONED, 6.5) == pytest.approx(SHARE * (6.5 - 2.4))


def test_a_crown_and_a_slab_are_limited_at_their_thickness_at_the_tip(forefinger):
    for text in (CROWNED, "slab"):
        assert limits(forefinger, text, 10.0) <= SHARE * 10.0 + 1e-12
    assert limits(forefinger, "slab", 10.0) == pytest.approx(SHARE * 10.0)
    family, shape = load_family("crowned"), read_shape(CROWNED)
    designs = Designs("crowned", np.array([10.0]), {name: np.array([v]) for name, v in shape.parameters})
    assert type(shape).gel_mm(designs.thickness_mm, designs.parameters)[0] == 10.0
    assert family.limit_mm(designs, forefinger[0].radius_mm)[0] <= SHARE * 10.0


def test_a_stricter_file_limits_every_shape(forefinger, tmp_path, monkeypatch):
    from dummydesign.core.user_library import data_folder

    text = (data_folder() / "materials" / "verdict.toml").read_text()
    (tmp_path / "materials").mkdir()
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    (tmp_path / "materials" / "verdict.toml").write_text(text.replace("value = 0.6\n", "value = 0.3\n"))
    assert verdict_limits().gel_compression == 0.3
    own = space_of("forefinger")[0].targets.limits.gel_compression
    assert limits(forefinger, BONED, 6.0, own) == pytest.approx(0.3 * 3.6)
    assert limits(forefinger, "slab", 10.0, own) == pytest.approx(3.0)


@pytest.mark.parametrize("kind", ["slab", "crowned", "layered", "boned"])
def test_the_gel_of_every_kind_is_its_thickness_less_its_bone(kind):
    text = {"boned": BONED, "crowned": CROWNED}.get(kind)
    shapes = [read_shape(text)] if text else []
    if not shapes and kind not in ("slab",):
        thickness, parameters = shape_kind(kind).candidates(np.array([10.0]), 7.9)
        row = {name: values[0] for name, values in parameters.items()}
        assert shape_kind(kind).gel_mm(thickness[:1], {n: v[:1] for n, v in parameters.items()})[0] == pytest.approx(
            thickness[0] - shape_kind(kind).of(row).bone_height_mm
        )
    for shape in shapes:
        parameters = {name: np.array([value]) for name, value in shape.parameters}
        assert shape.gel_mm(np.array([10.0]), parameters)[0] == pytest.approx(10.0 - shape.bone_height_mm)


@dataclasses.dataclass(frozen=True)
class Ridged(PadShape):
    """A shape of one's own with a bone: a bar of a height that falls off sideways."""

    name = "ridged"
    height_mm: float
    width_mm: float

    def bone_mm(self, x, y):
        return self.height_mm * np.exp(-((np.asarray(x, float) / self.width_mm) ** 2)) + 0.0 * np.asarray(y, float)


@dataclasses.dataclass(frozen=True)
class Bare(PadShape):
    """A shape of one's own without a bone."""

    name = "bare"
    radius_mm: float


def test_a_shape_of_ones_own_with_a_bone_has_the_gel_over_its_bone():
    thickness = np.array([8.0, 10.0, 12.0])
    parameters = {"height": np.array([1.0, 2.5, 4.0]), "width": np.array([5.0, 6.0, 7.0])}
    np.testing.assert_allclose(Ridged.gel_mm(thickness, parameters), thickness - parameters["height"])
    np.testing.assert_array_equal(Bare.gel_mm(thickness, {"radius": np.ones(3)}), thickness)


class Wide:
    """A law of one's own that holds to any depth."""

    def at_thickness(self, shape, thickness_mm, wanted_mm):
        return Designs(shape.name, wanted_mm, {name: np.full(len(wanted_mm), v) for name, v in shape.parameters})

    def limit_mm(self, designs, radius_mm):
        return 0.9 * designs.thickness_mm


@pytest.mark.parametrize("cast", [True, False])
def test_a_law_of_ones_own_that_goes_deeper_is_limited_by_the_gel_over_the_bone(cast):
    law = FamilyLaw(Wide(), Ridged(2.5, 6.0), 10.0, cast)
    np.testing.assert_allclose(law.depth_limit_mm(np.array([9.0, 10.0]), 7.9), [8.1, 9.0])
    np.testing.assert_allclose(law.gel_mm(np.array([9.0, 10.0])), [6.5, 7.5])
    for share in (SHARE, 0.35):
        found = designed_depth_mm(law, np.array([9.0, 10.0]), 7.9, share)
        np.testing.assert_allclose(found, [share * 6.5, share * 7.5])
    # where the gel would give more than the law, the law ends it
    np.testing.assert_allclose(designed_depth_mm(law, np.array([40.0]), 7.9, 1.0), [36.0])


def test_the_generic_gel_of_a_boned_pad_is_the_one_it_says_itself():
    boned = read_shape(BONED)
    parameters = {name: np.full(2, value) for name, value in boned.parameters}
    thickness = np.array([6.0, 9.0])
    generic = PadShape.gel_mm.__func__(type(boned), thickness, parameters)
    np.testing.assert_allclose(generic, type(boned).gel_mm(thickness, parameters))


def test_a_pad_that_bottoms_out_is_out_of_reach_and_red(forefinger):
    space, slab_law, _ = forefinger
    law = law_of_shape(slab_law, read_shape(BONED), 6.0)
    pads = [one_pad(law, space, 6.0, ratio) for ratio in (14.0, 14.3, 14.7, 15.2)]
    missing = [pad.verdict.not_reached for pad in pads]
    assert missing == sorted(missing, reverse=True) and missing[0] > 0 == missing[-1]
    for pad in pads:
        deepest = np.nanmax(pad.candidate.evaluation.depth_mm, initial=0.0)
        assert deepest <= SHARE * 3.6 + 1e-9
        assert pad.verdict.light == "red" or not pad.verdict.not_reached
        rows = condition_rows(pad.candidate, space.targets, read_shape(BONED))
        for row in rows:
            assert (row["depth_mm"] is None) == (row["gel_compression"] is None) == (row["out_of_reach"] is not None)
            if row["depth_mm"] is not None:
                assert row["gel_compression"] == pytest.approx(row["depth_mm"] / 3.6)
                assert row["gel_compression"] <= SHARE + 1e-9
    tied = [bool(pad.verdict.limits_that_bind) for pad in pads]
    assert tied[0]


def test_castings_that_cross_the_limit_count_as_out_of_reach(forefinger):
    """of one resin they are those that are thinner or softer than what just reaches the largest force"""
    space, slab_law, castings = forefinger
    cast = cast_pad(space, slab_law, castings, (BONED, 6.0, 14.7), Tolerances(60.0, 0.1, 0.2))
    kinds = kinds_of(cast)
    found = verdict_of_design(cast)
    assert 0.05 < found.castings["out_of_reach"] == pytest.approx((kinds == 4).mean())
    depth = evaluated(cast).depth_mm
    np.testing.assert_array_equal(kinds == 4, ~np.isfinite(depth).all(axis=-1))
    gel = evaluated(cast).slabs.thickness_mm - 2.4
    assert np.nanmax(depth / gel[:, None]) <= SHARE + 1e-6
    young = cast.pours().young_MPa
    assert np.median(young[kinds == 4]) < np.median(young[kinds != 4])
    thin = evaluated(cast, (MODULUS, RELAXATION, FORCE_LAW))
    assert np.isfinite(thin.depth_mm).all(axis=-1).mean() > 0.5
