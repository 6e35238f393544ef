"""The loop as a whole on campaigns made by other code: no effect, an effect, and one it does not know."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.result import answer_of, result_dict, worth_of
from dummydesign.loop.run import close_loop, replay
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.report.loop import write_loop_report
from dummydesign.report.page import figure_values
from dummydesign.studio.figures import measured_presses
from tests.support.browser import visit
from tests.support.drawn_plots import figures_of
from tests.support.refusal import raises_code


@pytest.fixture(scope="module")
def results(campaigns):
    made = {}

    def make(effect, seed, strength=1.0):
        key = (effect, seed, strength)
        if key not in made:
            made[key] = close_loop(read_campaign(campaigns(effect, seed, strength)))
        return made[key]

    return make


@pytest.mark.slow
def test_without_an_effect_the_verdict_is_none_and_the_base_is_at_the_noise(results):
    result = results("none", 401)
    assert result.verdict == "none" and result.effects == ()
    assert result.base.errors.heldout_N < 1.5 * result.base.fit.sizes.floor_N
    assert result.base.fit.sizes.noise.white_N == pytest.approx(0.03, rel=0.05)
    # 0.02 N of slow noise beside the rounding of the position, 0.005 mm, felt through the pad's stiffness; over ten
    # campaigns what is found scatters by 7 % about that
    fit = result.base.fit
    held = (fit.problem.presses.label >= 200) & fit.problem.presses.used
    rounding = 0.005 / np.sqrt(12.0) * np.sqrt(np.mean(fit.slope[held] ** 2))
    assert fit.sizes.noise.slow_N == pytest.approx(np.hypot(0.02, rounding), rel=0.2)


def test_an_effect_is_named_sized_and_lowers_the_error_on_a_second_campaign(results, campaigns):
    result = results("temperature", 402)
    assert result.verdict == "effect"
    assert result.effects[0].candidate.effect.name == "temperature"
    value = result_dict(result)["effects"][0]["parameters"]["modulus_loss_per_K"]
    # three standard errors of the stated 95 % interval, which is a few per cent wide
    assert abs(abs(value["value"]) - 0.008) < 3.0 * (value["high"] - value["low"]) / 3.92
    assert value["low"] < value["value"] < value["high"] < value["low"] + 0.0012
    assert result.after.errors.heldout_N < 0.6 * result.base.errors.heldout_N
    held_out = read_campaign(campaigns("temperature", 402, held_out=True))
    predicted = replay(held_out, calibration_of(result))
    assert predicted.total_rmse_N < 0.8 * predicted.total_base_rmse_N


@pytest.mark.slow
def test_a_search_out_of_work_returns_its_best_so_far_and_says_so(results, campaigns):
    """Without iterations one effect is fitted, and none in its place."""
    whole = results("temperature", 402)
    assert "search_stopped" not in {one["code"] for one in whole.warnings}
    result = close_loop(read_campaign(campaigns("temperature", 402)), most_iterations=0)
    (warning,) = [one for one in result.warnings if one["code"] == "search_stopped"]
    assert warning and result.budget.stopped and 0 < result.budget.iterations < whole.budget.iterations
    assert [one.candidate.effect.name for one in result.effects] == ["temperature"]
    assert len(result.selection.ranking) == 1 < len(whole.selection.ranking)
    assert len(result.effects[0].ranking) == 1
    assert result.after.fit.score == pytest.approx(whole.after.fit.score, abs=1.0)


@pytest.mark.slow
def test_ringing_is_not_in_the_vocabulary_and_called_unexplained(results):
    result = results("ringing", 403, 2.0)
    assert result.verdict == "unexplained"
    assert any("oscillation" in reason or "line" in reason for reason in result.remainder.reasons)


def test_the_output_holds_what_the_contract_names(results):
    data = result_dict(results("temperature", 402))
    assert {"base", "verdict", "effects", "after", "residual", "next_measurement", "warnings"} <= set(data)
    for label in ("base", "after"):
        assert {"train_rmse_N", "heldout_rmse_N", "noise_floor_N", "lack_of_fit_p"} <= set(data[label]["error"])
    effect = data["effects"][0]
    assert {"name", "class", "parameters", "heldout_rmse_N", "evidence", "confounded_with"} <= set(effect)
    assert len(effect["confounded_with"]) <= 2
    assert len(data["residual"]["by_trial"]) == 36
    assert data["next_measurement"]["expected_gain"] >= 0 and len(data["next_measurement"]["separates"]) == 2


def test_the_report_is_one_page_with_a_figure_a_condition_and_loads_nothing(results, tmp_path):
    result = results("temperature", 402)
    files = write_loop_report(tmp_path, result)
    page = (tmp_path / "report.html").read_text()
    figures = figure_values(files["report_values"])
    presses = [name for name in figures if name.startswith("press-")]
    assert len(presses) == len(np.unique(result.presses.cell))
    assert page.count("<figure>") == len(figures)
    assert (
        " src=" not in page.partition("<script>")[0]
        and page.count("<script") == 2
        and page.count("href=") == page.count('href="#') > 5
    )
    drawn = measured_presses(tmp_path / files["report_values"])
    assert len(drawn) == len(presses) and all(" mm pad, " in plot.title for plot in drawn)
    assert all({"base", "corrected"} <= {one.label.partition(", ")[0] for one in plot.series} for plot in drawn)
    effect = result_dict(result)["effects"][0]
    for part in ("temperature", f"{effect['evidence']:.0f}", "Residual by trial", result.next.text[1:]):
        assert part in page


@pytest.mark.slow
def test_the_report_opens_in_a_browser_without_errors_and_asks_nothing_of_the_outside(results, tmp_path):
    write_loop_report(tmp_path, results("temperature", 402))
    (tmp_path / "visit").mkdir()
    seen = visit((tmp_path / "report.html").as_uri(), tmp_path / "visit")
    assert seen.console == [] and seen.requests == []


def test_the_report_draws_the_residual_of_every_trial_before_and_after(results, tmp_path):
    result = results("temperature", 402)
    files = write_loop_report(tmp_path, result)
    rows = figure_values(files["report_values"])["by-trial"]
    for series, key in (("base", "base_rmse_N"), ("corrected", "rmse_N")):
        drawn = [float(row["y"]) for row in rows if row["series"] == series]
        assert drawn == pytest.approx([row[key] for row in result_dict(result)["residual"]["by_trial"]], rel=1e-5)


def test_the_answer_says_what_was_found_what_it_is_worth_and_what_to_do(results):
    result = results("temperature", 402)
    said = answer_of(result)
    assert "temperature" in said[0] and "the residual is noise" in said[0]
    assert "Usual cause: " in said[1] and said[1].endswith(".")
    assert any("error on presses left out of the fit falls from" in text for text in said)
    assert said[-1].startswith("Next: ")
    effect = next(found.candidate.effect for found in result.effects if found.candidate.effect.name == "temperature")
    worth = worth_of(result, effect)
    assert abs(worth.most_N) >= abs(worth.change_N) and worth.most_file
    loss = next(one.values for one in result.after.fit.active if one.effect is effect)["modulus_loss_per_K"]
    warm = next(trial.temperature_C for trial in result.presses.trials if trial.file == worth.file) - 23.0
    # the force is linear in the modulus; the shift of relaxation times adds little
    assert worth.change_N == pytest.approx(worth.force_N * (1.0 - 1.0 / (1.0 - loss * warm)), rel=0.02)
    assert f"({worth.force_N:.3g} N) by {worth.change_N:+.2g} N" in said[1]


def test_residuals_are_drawn_pad_by_pad_in_two_colours_named_at_the_curves(results, tmp_path):
    result = results("temperature", 402)
    files = write_loop_report(tmp_path, result)
    pads = [name for name in figure_values(files["report_values"]) if name.startswith("residual")]
    assert len(pads) == len(result.presses.pads) == 3
    page = (tmp_path / "report.html").read_text()
    figures = figures_of(page)
    for name in pads:
        words = {one["text"][0]: one["textfont"]["color"] for one in figures[name]["data"] if one["mode"] == "text"}
        assert words == {"base": "var(--aim)", "corrected": "var(--main)"}
    assert "fitted from 2 on" in page


def test_a_calibration_survives_its_file_and_damage_is_refused(results, campaigns, tmp_path):
    result = results("temperature", 402)
    calibration = calibration_of(result)
    path = write_calibration(calibration, tmp_path / "calibration.json")
    again = read_calibration(path)
    campaign = read_campaign(campaigns("temperature", 402, held_out=True))
    one, two = replay(campaign, calibration), replay(campaign, again)
    np.testing.assert_allclose(one.rmse_N, two.rmse_N, rtol=1e-12)
    data = json.loads(path.read_text())
    del data["after"]["base"]["tau_1_s"]
    path.write_text(json.dumps(data))
    with raises_code("malformed", "calibration"):
        read_calibration(path)
    path.write_text("{}")
    with raises_code("file_unreadable", "calibration"):
        read_calibration(path)
    with raises_code("file_not_found", "calibration"):
        read_calibration(tmp_path / "nothing.json")


@pytest.mark.slow
def test_replaying_the_fitted_campaign_gives_the_fitted_error(results, campaigns):
    result = results("none", 401)
    predicted = replay(read_campaign(campaigns("none", 401)), calibration_of(result))
    assert predicted.total_base_rmse_N == predicted.total_rmse_N
    assert predicted.total_rmse_N == pytest.approx(result.after.errors.train_N, rel=0.05)


@pytest.mark.slow
def test_without_repeats_the_loop_runs_and_says_what_it_cannot_test(campaigns, tmp_path):
    source = campaigns("none", 401)
    head, *blocks = (source / "campaign.toml").read_text().split("[[trial]]")
    kept = [b for b in blocks if "repeat = 1" in b and "thickness_mm = 15.0" not in b]
    for block in kept:
        name = block.split('file = "')[1].split('"')[0]
        (tmp_path / name).write_bytes((source / name).read_bytes())
    (tmp_path / "campaign.toml").write_text("[[trial]]".join([head, *kept]))
    result = close_loop(read_campaign(tmp_path))
    assert "no_repeats" in {w["code"] for w in result.warnings}
    assert result.base.lack.p is None and result.verdict == "none"


def test_effects_that_the_campaign_cannot_test_are_listed_with_the_reason(results):
    assert "plate_friction" in results("none", 401).untested


def test_a_calibration_changes_the_resin_that_is_designed_with(results, tmp_path):
    """The batch's modulus and relaxation enter; an effect of the sensor or the robot leaves the force law alone."""
    from dummydesign.design.calibrated import with_calibration
    from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
    from dummydesign.resin import load_resin

    result = results("temperature", 402)
    path = write_calibration(calibration_of(result), tmp_path / "calibration.json")
    before = load_resin("polyurethane-nagoya")
    made = with_calibration(before, str(path))
    resin, law, calibration = made.resin, made.law, made.calibration
    young = calibration.after.base.young_MPa
    assert resin.young_MPa(15.0) == pytest.approx(young, rel=0.03)
    spread = [one.modulus_kPa(15.0) for one in (before, resin)]
    assert spread[1].high / spread[1].low < 0.2 * (spread[0].high / spread[0].low - 1.0) + 1.0
    assert [arm.beta.value for arm in resin.arms] == pytest.approx([term.beta for term in calibration.prony()])
    own = law.force(np.array([1.0, 2.0]), np.array([10.0, 10.0]), 0.025, PUNCH_RADIUS_MM)
    assert np.all(np.isfinite(own)) and np.all(np.diff(own) > 0.0)


def test_what_is_no_calibration_is_refused(tmp_path):
    from dummydesign.design.calibrated import with_calibration
    from dummydesign.resin import load_resin

    torn = tmp_path / "calibration.json"
    torn.write_text('{"schema": ')
    with raises_code("file_unreadable", "calibration"):
        with_calibration(load_resin("polyurethane-nagoya"), str(torn))
