"""A solved design's law: how deep it is solved, and what holds deeper."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.search import fe_candidates
from dummydesign.design.search.fe_candidates import BEYOND, ElementsLaw, solved_shares
from dummydesign.design.search.shape_family import FamilyLaw, load_family
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.axisymmetric.shaped_problem import FLAT_STEP, LARGEST_STEP

RADIUS, H = 7.9, 6.0
SHAPES = {"crowned": "crowned:radius=21.2,height=2,foot=9.4", "layered": "layered:top=3,modulus_ratio=5"}
STEP = {"crowned": 2.0 * LARGEST_STEP, "layered": FLAT_STEP}


def law(kind):
    return FamilyLaw(load_family(kind), read_shape(SHAPES[kind]), H, cast=True)


SPACE = SimpleNamespace(radius_mm=RADIUS, targets=SimpleNamespace(limits=SimpleNamespace(gel_compression=0.6)))


@pytest.fixture
def shares(monkeypatch):
    """Depths over the thickness at which a pad is solved whose presses go to the given depths."""

    def found(shape, table, thickness, *pressed_mm):
        candidate = SimpleNamespace(depth_mm=np.array(pressed_mm))
        monkeypatch.setattr(fe_candidates, "candidate_of", lambda *given: candidate)
        outlook = SimpleNamespace(ratio=15.0)
        design = SimpleNamespace(shape=read_shape(shape), table=table, thickness_mm=thickness, outlook=outlook)
        return solved_shares(design, SPACE)

    return found


@pytest.mark.parametrize("kind", SHAPES)
def test_a_design_is_solved_somewhat_beyond_its_deepest_press_at_ends_of_load_steps(shares, kind):
    share = shares(SHAPES[kind], law(kind), H, 0.5, 1.5, 2.0)
    assert BEYOND * 2.0 <= share[-1] * H < BEYOND * 2.0 + 0.05 * H
    np.testing.assert_allclose(share / STEP[kind], np.round(share / STEP[kind]), atol=1e-9)
    assert share[0] * H < 0.3


@pytest.mark.parametrize("kind", SHAPES)
def test_a_design_whose_presses_come_near_the_table_s_end_is_solved_to_it(shares, kind):
    limit = law(kind).depth_limit_mm(H, RADIUS) / H
    assert shares(SHAPES[kind], law(kind), H, 1.0, 3.3)[-1] == pytest.approx(limit)
    # a press that is not reached may be with elements
    assert shares(SHAPES[kind], law(kind), H, 1.0, np.nan)[-1] == pytest.approx(limit)


def test_deeper_than_was_asked_the_table_goes_on_with_the_last_factor_and_its_own_error():
    table, depth = law("crowned"), np.array([0.5, 1.0, 2.0])
    solved = ElementsLaw(table, H, depth, np.array([0.0, 0.01, 0.02]), np.full(3, 0.001), complete=True)
    deeper = np.array([2.4, 3.0])
    assert solved.depth_limit_mm(H, RADIUS) == table.depth_limit_mm(H, RADIUS)
    plain = table.force(deeper, H, 1.0, RADIUS)
    np.testing.assert_allclose(solved.force(deeper, H, 1.0, RADIUS), np.exp(0.02) * plain)
    np.testing.assert_allclose(solved.relative_error(deeper, H, RADIUS), table.relative_error(deeper, H, RADIUS))
    np.testing.assert_allclose(solved.relative_error(depth, H, RADIUS), 0.001)
    failed = replace(solved, complete=False)
    assert failed.depth_limit_mm(H, RADIUS) == pytest.approx(2.0), "where the solve failed nothing is known deeper"


def test_a_design_that_could_not_be_solved_deep_enough_says_why():
    from dummydesign.design.suggest import of_shape

    table, depth = law("crowned"), np.array([0.5, 1.0, 2.0])
    solved = ElementsLaw(table, H, depth, np.array([0.0, 0.01, 0.02]), np.full(3, 0.001), end="the face folds")
    assert of_shape(solved, 0.03, RADIUS).notes[-1] == "the face folds"
    assert len(of_shape(replace(solved, end=""), 0.03, RADIUS).notes) == 1
