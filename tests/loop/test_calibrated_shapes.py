"""Designs of every shape with a calibration: what it changes of a shaped pad, and what an answer says of it."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.design.calibrated import CalibratedFamily
from dummydesign.design.search import fe_candidates
from dummydesign.design.search.shape_family import Designs, FamilyLaw, load_family
from dummydesign.design.search.shape_search import ShapedDesign
from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.loop.calibration_file import write_calibration
from dummydesign.loop.corrected_law import Correction
from dummydesign.loop.effects.learned import Learned, SmoothChange
from dummydesign.loop.model.forward_model import Active
from tests.support.made_calibration import calibration, effect

RADIUS, CROWN = 14.0 / np.sqrt(np.pi), "crowned:radius=20,height=3,foot=11"
TARGETS = SimpleNamespace(limits=SimpleNamespace(gel_compression=0.6))
SPACE = SimpleNamespace(radius_mm=RADIUS, base="bonded", extent_mm=PAD_EXTENT_MM, edge_radius_mm=0.0, targets=TARGETS)


def law_of(*active, shape=CROWN, **options):
    plain = load_family(read_shape(shape).name)
    family = CalibratedFamily(plain, Correction(calibration(*active, **options)))
    return FamilyLaw(family, read_shape(shape), 10.0, cast=True)


D, H = np.array([0.5, 1.5, 3.0]), np.full(3, 10.0)


@pytest.mark.parametrize("shape", [CROWN, "boned:radius=12,height=4"])
def test_without_effects_a_shaped_pad_is_as_without_a_calibration_and_stiffening_acts_by_its_law(shape):
    law, stiff = law_of(shape=shape), law_of(effect("strain_stiffening", coefficient=2.0), shape=shape)
    assert np.array_equal(law.force(D, H, 0.025, RADIUS), law.plain.force(D, H, 0.025, RADIUS))
    ratio = stiff.force(D, H, 0.025, RADIUS) / law.force(D, H, 0.025, RADIUS)
    np.testing.assert_allclose(ratio, 1.0 + 2.0 * (D / H) ** 2, rtol=1e-12)


def test_effects_of_the_laboratory_change_no_shaped_pad():
    law = law_of(
        effect("contact_offset", offset_mm=0.1), effect("force_bias", bias_N=0.2), effect("punch_tilt", tilt_deg=2.0)
    )
    assert np.array_equal(law.force(D, H, 0.025, RADIUS), law.plain.force(D, H, 0.025, RADIUS))
    assert law.notes == ()


def test_a_search_that_leaves_out_lengths_of_usual_value_finds_the_shape_that_was_pressed():
    """Candidates of the search say nothing of a ridge, which the campaign's shape has as 0."""
    family = CalibratedFamily(load_family("crowned"), Correction(calibration(shapes=(CROWN,), level=0.03)))
    lengths = {"radius": [20.0, 19.0], "height": [3.0, 3.0], "foot": [11.0, 11.0]}
    designs = Designs("crowned", np.full(2, 10.0), {name: np.array(values) for name, values in lengths.items()})
    ratio = family.area_mm2(designs, np.full((2, 1), 1.5), RADIUS) / family.plain.area_mm2(
        designs, np.full((2, 1), 1.5), RADIUS
    )
    np.testing.assert_allclose(ratio[:, 0], [1.03, 1.0])


def test_the_law_error_is_that_of_the_shape_that_was_pressed():
    pressed = law_of(shapes=(CROWN,), level=0.03)
    np.testing.assert_allclose(pressed.force(D, H, 1.0, RADIUS), 1.03 * pressed.plain.force(D, H, 1.0, RADIUS))
    for other in (
        law_of(shapes=("",), level=0.03),
        law_of(shapes=("crowned:radius=19,height=3,foot=11",), level=0.03),
        law_of(shapes=(CROWN,), level=0.03, pad={"contact": "frictionless"}),
        law_of(shapes=(CROWN,), level=0.03, pad={"base": "sliding"}),
    ):
        assert np.array_equal(other.force(D, H, 1.0, RADIUS), other.plain.force(D, H, 1.0, RADIUS))


def test_a_bulk_that_gives_softens_a_shaped_pad_as_a_slab_and_says_so():
    law = law_of(effect("compressibility", poisson_ratio=0.49))
    ratio = law.force(D, H, 1.0, RADIUS) / law.plain.force(D, H, 1.0, RADIUS)
    assert np.all((ratio > 0.85) & (ratio < 1.0))
    assert any("as on a slab" in note for note in law.notes)


def test_what_was_learned_is_used_where_it_follows_depth_and_named_where_it_does_not():
    rise = Active(Learned(SmoothChange(("depth_mm",), ((0.0, 6.0),), (0.1, 0.1))), {"size": 1.0})
    cell = Active(Learned(SmoothChange(("force_N",), ((0.0, 12.0),), (0.0, -0.1))), {"size": 1.0})
    law = law_of(rise, cell)
    np.testing.assert_allclose(law.force(D, H, 1.0, RADIUS), 1.1 * law.plain.force(D, H, 1.0, RADIUS))
    said = "; ".join(law.notes)
    assert "learned_depth_mm" in said and "learned_force_n" in said and "not in this design" in said


def test_a_solved_shape_carries_the_correction_once(monkeypatch):
    """Elements 5 % off the table: the corrected force is elements times correction."""
    law = replace(law_of(effect("strain_stiffening", coefficient=2.0)), cast=True)
    depth = np.array([0.5, 1.5, 3.0])
    plain = law.plain.force(depth, 10.0, 1.0, RADIUS)
    monkeypatch.setattr(
        fe_candidates, "cached", lambda *_: {"depth_mm": depth, "force_N": 1.05 * plain, "error_N": 0.01 * plain}
    )

    pressed = SimpleNamespace(depth_mm=np.array([1.0, 2.0, 3.0]))
    monkeypatch.setattr(fe_candidates, "candidate_of", lambda *_: pressed)
    shaped = ShapedDesign(read_shape(CROWN), 10.0, law, law, None, SimpleNamespace(ratio=15.0))
    solved = fe_candidates.solve_law(shaped, SPACE)
    np.testing.assert_allclose(solved.force(depth, 10.0, 1.0, RADIUS), 1.05 * plain * (1.0 + 2.0 * (depth / 10.0) ** 2))


@pytest.fixture
def suggest(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def run(known, *more):
        path = write_calibration(known, tmp_path / "calibration.json")
        words = ["suggest", "--tissue", "forefinger", "--calibration", str(path), "--no-cad", "--no-verify", *more]
        assert cli.run(words) in (0, 1)
        return capsys.readouterr().out

    return run


@pytest.mark.slow
def test_suggest_takes_a_calibration_for_every_shape_and_says_first_what_it_left(suggest):
    known = calibration(effect("strain_stiffening", coefficient=0.3), verdict="unexplained", because=("line at 50 Hz",))
    answer = json.loads(suggest(known, "--json"))
    kinds = {row["kind"] for row in answer["shapes"] if row["shape"] is not None}
    assert {"slab", "crowned"} <= kinds
    used = answer["calibration"]
    assert used["verdict"] == "unexplained" and used["left_N"]["rise"] == 0.041 and used["noise_floor_N"] == 0.036
    first = " ".join(" ".join(suggest(known).splitlines()[:8]).split()).partition("PAD")[0]
    for part in ("verdict unexplained (strain_stiffening)", "0.041 N rise", "line at 50 Hz"):
        assert part in first


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pad", "code", "said"),
    [
        ({"resin": "ecoflex-0030"}, "calibration_resin", "pads of ecoflex-0030"),
        ({"base": "sliding"}, "calibration_base", "base = sliding"),
        ({"base": "friction:0.3"}, "calibration_base", "base = friction:0.3"),
        ({"contact": "frictionless"}, "calibration_contact", "contact = frictionless"),
    ],
)
def test_a_campaign_of_something_else_is_warned_of(pad, code, said, suggest):
    answer = json.loads(suggest(calibration(pad=pad), "--shape", "slab", "--json"))
    own = [w for w in answer["warnings"] if w["code"].startswith("calibration_")]
    assert [w["code"] for w in own] == [code] and said in own[0]["message"]


@pytest.mark.slow
def test_a_campaign_of_the_same_is_not_warned_of(suggest):
    answer = json.loads(suggest(calibration(), "--shape", "slab", "--json"))
    assert not [w for w in answer["warnings"] if w["code"].startswith("calibration")]
