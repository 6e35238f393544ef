"""What pucks of one shape cannot tell apart, and what two heights tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.forward_model import Active
from dummydesign.loop.next_measurement import LUBRICATED, options
from dummydesign.loop.result import answer_of, result_dict
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.explanations import explain, one_shape, repeat_difference_N, usual_sizes
from dummydesign.pad.tables.puck import shape_range
from tests.support import puck_presses
from tests.support.drawn_pucks import DIAMETER_MM, Rubber, draw_rubber, press_pucks
from tests.support.known_laws import puck_law
from tests.support.named_effects import effect_named

FAMILY = tuple(map(effect_named, ("plate_friction", "strain_stiffening", "sensor_curve")))
RUBBED = Rubber("ogden", 2.0, 0.05, 0.3)


@pytest.fixture(scope="module")
def rubbed(tmp_path_factory):
    """Base fit of two specimens of one height whose plates rub."""
    from dummydesign.loop.data.trials import make_presses

    campaign = press_pucks(tmp_path_factory.mktemp("pucks") / "one", RUBBED, (30.0,), np.random.default_rng(71))
    return fit_base(make_presses(campaign), puck_law(DIAMETER_MM), 0.04)


def test_the_difference_of_repeats_is_their_standard_deviation(rubbed):
    residual = np.zeros_like(rubbed.residual)
    residual[0], residual[1] = 0.3, -0.1
    apart = replace(rubbed, residual=residual)
    assert repeat_difference_N(apart) == pytest.approx(np.std([0.3, -0.1], ddof=1), rel=1e-9)


def test_pucks_within_a_tenth_of_height_are_of_one_shape(rubbed):
    presses = rubbed.problem.presses
    assert one_shape(presses)
    assert one_shape(replace(presses, thickness_mm=np.array([30.0, 32.9])))
    assert not one_shape(replace(presses, thickness_mm=np.array([30.0, 33.1])))


def test_the_noise_of_specimens_holds_their_scatter_and_four_thousandths_of_the_force(rubbed):
    sizes, force = usual_sizes(rubbed), rubbed.problem.presses.force_N
    differ = repeat_difference_N(rubbed)
    assert sizes.noise.slow_N == pytest.approx(np.hypot(differ, 0.004 * force.max()))
    mean = np.sqrt(np.mean(force[rubbed.problem.presses.used] ** 2))
    assert sizes.law[0] == pytest.approx(np.hypot(rubbed.problem.law.error_priors[0][0], differ / mean))


def test_on_one_shape_friction_and_stiffening_stay_in_doubt_whichever_fits_better(rubbed):
    found = explain(rubbed, FAMILY, single=True)
    assert set(found.names) >= {"plate_friction", "strain_stiffening"}
    gains = [one.gain for one in found.found]
    assert gains == sorted(gains, reverse=True) and found.found[0].names == ("plate_friction",)
    friction = found.found[0].fit.active[0].values["friction"]
    assert friction == pytest.approx(RUBBED.friction, abs=0.15)


def test_a_change_that_is_no_function_of_depth_is_left_to_the_search(rubbed):
    presses = rubbed.problem.presses
    middle = 0.5 * (presses.bins.start + presses.bins.end)
    waves = 0.2 * presses.force_N.max() * np.sin(40.0 * middle)
    bent = replace(
        rubbed.problem, presses=replace(presses, force_N=presses.force_N + np.where(presses.used, waves, 0.0))
    )
    assert explain(replace(rubbed, problem=bent), FAMILY, single=True) is None


def test_the_next_press_may_be_of_another_height_or_between_lubricated_plates():
    presses = puck_presses.planned()
    offered = options(presses, puck_presses.LAW)
    new = {one.thickness_mm for one in offered if not one.known}
    low, high = (puck_presses.DIAMETER_MM / ratio for ratio in reversed(shape_range()))
    assert new and all(low <= height <= high and height not in presses.thickness_mm for height in new)
    assert [one.circumstance for one in offered].count(LUBRICATED) == 1
    assert next(one for one in offered if one.circumstance == LUBRICATED).text.endswith(LUBRICATED)


def test_lubricated_plates_take_friction_out_of_a_prediction(rubbed):
    from dummydesign.loop.next_measurement import _without_friction

    problem = rubbed.problem.plus(effect_named("plate_friction"))
    vector = np.insert(rubbed.vector, 5, 1.0)
    oiled = _without_friction(replace(rubbed, problem=problem, vector=vector))
    np.testing.assert_allclose(oiled.problem.predict(oiled.vector), rubbed.problem.predict(rubbed.vector), rtol=1e-9)
    assert oiled.active == (Active(effect_named("plate_friction"), {"friction": 0.0}),)


@pytest.mark.slow
def test_the_loop_says_what_one_height_cannot_tell_and_names_it_with_two(tmp_path):
    one = close_loop(press_pucks(tmp_path / "one", RUBBED, (30.0,), np.random.default_rng(72)))
    assert one.verdict == "ambiguous" and {"plate_friction", "strain_stiffening"} <= set(one.among.names)
    said = answer_of(one)
    assert "cannot tell" in said[0] and "Press pucks of another height" in said[0]
    assert any(text.startswith("Plate friction (friction = 0.3") for text in said)
    data = result_dict(one)["ambiguity"]
    assert {row["effects"][0]["name"] for row in data["explanations"]} == set(one.among.names)
    assert all(row["residual_N"] < data["base_residual_N"] for row in data["explanations"][:1])
    two = close_loop(press_pucks(tmp_path / "two", RUBBED, (30.0, 15.0), np.random.default_rng(72)))
    assert two.verdict == "effect" and [row.candidate.effect.name for row in two.effects] == ["plate_friction"]
    low, high = (two.after.to_dict()["parameters"]["young_kPa"][end] for end in ("low", "high"))
    assert low <= 1e3 * RUBBED.young_MPa <= high


@pytest.mark.slow
def test_pucks_of_one_height_without_a_cause_are_said_to_hide_friction_and_those_of_two_are_not(tmp_path):
    plain = replace(RUBBED, friction=0.0)
    for heights, said in (((30.0,), True), ((30.0, 15.0), False)):
        found = close_loop(press_pucks(tmp_path / str(len(heights)), plain, heights, np.random.default_rng(73)))
        assert found.verdict == "none"
        assert ("friction_hidden" in [one["code"] for one in found.warnings]) is said


@pytest.mark.slow
def test_drawn_pucks_of_one_height_have_their_cause_in_the_answer(tmp_path):
    """New rubbers in every run: of eight that rub, stiffen or do both, one may fail."""
    seed = int(np.random.SeedSequence().entropy % 2**31)
    wrong = []
    for number, kind in enumerate(("none", "friction", "stiffening", "both") * 2):
        chance = np.random.default_rng([seed, number])
        rubber = draw_rubber(kind, chance)
        campaign = press_pucks(tmp_path / str(number), rubber, (30.0,), chance)
        from dummydesign.loop.data.trials import make_presses

        found = explain(fit_base(make_presses(campaign), puck_law(DIAMETER_MM), 0.04), FAMILY, single=True)
        causes = {"friction": {"plate_friction"}, "stiffening": {"strain_stiffening"}}
        if found is None or (found.names and not causes.get(kind, set()) <= set(found.names)):
            wrong.append((kind, rubber, None if found is None else found.names))
    assert len(wrong) <= 1, (seed, wrong)
