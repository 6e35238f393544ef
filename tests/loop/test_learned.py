"""Learned effects: a remainder that follows one quantity is read off, said in closed form, kept in its range."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.progress import quiet
from dummydesign.loop import check_effect
from dummydesign.loop.calibration import Calibration, model_of, posterior_of
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects.learned import FADE, FOLLOWED, Learned, SmoothChange
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.run import replay
from dummydesign.loop.selection import nonparametric_effect
from dummydesign.loop.selection.cross_validation import errors
from dummydesign.loop.selection.nonparametric_effect import can_be_learned, closed_form, learn
from dummydesign.loop.selection.residuals import Dependence, ResidualCheck, ResidualDiagnostics, diagnose
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator, independent_generator
from tests.support.named_effects import effect_named


@pytest.fixture(scope="module")
def learnt(campaigns):
    """Base fits of a clean campaign and of one whose pads are 12 % stiffer about a depth of 1.2 mm; what is learned."""
    out = {}
    for name, effect, seed in (("clean", "none", 401), ("bumped", "stiffness_bump", 404)):
        campaign = read_campaign(campaigns(effect, seed))
        base = fit_base(make_presses(campaign), law_of(campaign), 0.03)
        out[name] = (campaign, base, learn(base))
    return out


@pytest.mark.slow
def test_a_clean_campaign_teaches_nothing(learnt):
    assert learnt["clean"][2] is None


@pytest.mark.slow
def test_a_bump_in_depth_is_found_where_it_is_and_as_high_as_it_is(learnt):
    found = learnt["bumped"][2]
    assert found.effect.name == "learned_depth_mm"
    shape = found.effect.shape
    at = np.linspace(0.5, 3.0, 251)
    curve = shape(at)
    assert at[np.argmax(curve)] == pytest.approx(1.2, abs=0.15)
    # a slope in depth is shared with the law error
    assert curve.max() - shape(np.array([0.5, 1.9])).mean() == pytest.approx(0.12, abs=0.04)
    before, after = errors(learnt["bumped"][1]).heldout_N, errors(found.fit).heldout_N
    noise = errors(learnt["clean"][1]).heldout_N
    assert after**2 - noise**2 < 0.25 * (before**2 - noise**2)
    assert found.left_out < 0.5 and "depth in mm" in found.text


@pytest.mark.slow
def test_what_was_learned_survives_its_file_and_helps_on_another_thickness(learnt, campaigns, tmp_path):
    """Pads of the thicknesses that were pressed have the waves of their law, with and without what was learned."""
    _, base, found = learnt["bumped"]
    pad = {"young_kPa_expected": 30.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    made = Calibration(
        model_of(base), model_of(found.fit), "unexplained", {}, 0.03, pad, (found.text,), posterior_of(found.fit)
    )
    again = read_calibration(write_calibration(made, tmp_path / "c.json"))
    assert again.after.active[-1].effect.shape == found.effect.shape
    other = read_campaign(campaigns("stiffness_bump", 404, held_out=True))
    one, two = replay(other, made), replay(other, again)
    assert one.total_rmse_N == pytest.approx(two.total_rmse_N, rel=1e-9)
    new = np.array([trial.thickness_mm == campaign_generator.SLABS[1] for trial in other.trials])
    after, before = (np.sqrt(np.mean(each[new] ** 2)) for each in (one.rmse_N, one.base_rmse_N))
    assert 4 <= new.sum() < len(new) and after < 0.6 * before and one.total_rmse_N < one.total_base_rmse_N
    data = json.loads((tmp_path / "c.json").read_text())
    data["after"]["effects"][-1]["knots"][1] = -5.0
    (tmp_path / "c.json").write_text(json.dumps(data))
    with pytest.raises(InputError, match="knots must hold two numbers or more that rise"):
        read_calibration(tmp_path / "c.json")


@pytest.mark.parametrize("follows", ["depth_mm", "depth_share", "force_N", "since_stop_s", "temperature_C", "age_days"])
def test_a_learned_effect_keeps_the_contract_of_effects(follows):
    learned = Learned(SmoothChange((follows,), ((0.01, 1.0, 30.0),), (0.1, -0.05, 0.02)))
    assert check_effect(learned) == ()


def test_a_curve_is_used_in_the_range_seen_and_fades_out_beyond():
    shape = SmoothChange(("depth_mm",), ((1.0, 3.0),), (0.2, 0.4))
    far = FADE * 2.0
    np.testing.assert_allclose(shape(np.array([1.0, 2.0, 3.0])), [0.2, 0.3, 0.4])
    np.testing.assert_allclose(shape(np.array([3.0 + 0.5 * far, 3.0 + far, 9.0, 1.0 - far])), [0.2, 0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("name", "curve", "said"),
    [
        pytest.param("linear", lambda u: 0.02 * u, "0.02 u", marks=pytest.mark.slow),
        pytest.param("power", lambda u: -0.003 * u**2, "-0.003 u^2", marks=pytest.mark.slow),
        pytest.param("step", lambda u: 0.1 * (u > 5.0), "0.1 beyond", marks=pytest.mark.slow),
        ("bump", lambda u: 0.2 * np.exp(-(((u - 4.0) / 1.0) ** 2)), "exp(-((u - 4"),
    ],
)
def test_a_curve_is_said_in_the_form_it_was_made_of_whatever_the_modulus(name, curve, said):
    knots = np.linspace(0.0, 10.0, 30)
    for level in (0.0, 0.07):
        form = closed_form(knots, (1.0 + level) * (1.0 + curve(knots)) - 1.0, 1e6 * np.eye(30), "depth_mm")
        assert form.name == name and said in form.text and form.lost < 0.01


@pytest.mark.parametrize("follows", [("since_stop_s",), ("thickness_mm", "since_stop_s")])
def test_what_acts_after_the_stop_keeps_its_level_and_what_acts_always_leaves_it_to_the_modulus(follows):
    step = SimpleNamespace(values=np.array([0.0, 0.1, 0.2]), information=np.diag([1.0, 2.0, 1.0]))
    after, always = (SmoothChange(names, ((0.0, 1.0, 2.0),), (0.0,) * 3) for names in (follows, ("depth_mm",)))
    assert nonparametric_effect._without_modulus(after, step) == pytest.approx([0.0, 0.1, 0.2])
    assert nonparametric_effect._without_modulus(always, step) == pytest.approx([-0.1, 0.0, 0.1])


@pytest.mark.slow
def test_a_hold_is_said_in_a_form_that_begins_at_zero():
    """After the stop a constant is seen: it is neither free nor taken out of the form, as it is of a depth."""
    knots = np.geomspace(0.002, 8.0, 30)
    scale = np.ptp(knots) * np.geomspace(0.05, 3.0, 25)[10]
    values = 0.05 * np.expm1(-knots / scale)
    form = closed_form(knots, values, 1e6 * np.eye(30), "since_stop_s")
    assert form.name == "saturation" and "-0.05 (1 - exp(-u / " in form.text and form.lost < 1e-6
    for follows, free in (("since_stop_s", False), ("depth_mm", True)):
        form = closed_form(knots, 1.08 * (1.0 + values) - 1.0, 1e6 * np.eye(30), follows)
        assert (form.lost < 1e-6) is free


def test_a_curve_of_no_simple_form_is_called_one():
    knots = np.linspace(0.0, 10.0, 30)
    assert closed_form(knots, 0.1 * np.sin(2.5 * knots), 1e6 * np.eye(30), "force_N").name == "curve"


def test_the_size_of_a_curve_is_said_where_the_data_know_nothing_of_a_constant():
    """The modulus takes up a constant: with it projected out, 1' I 1 is rounding error."""
    knots = np.linspace(0.0, 10.0, 30)
    apart = np.eye(30) - 1.0 / 30.0
    odd = np.outer(np.ones(30), 0.1 * np.sin(2.5 * knots) + 1e-3)
    form = closed_form(knots, 0.1 * np.sin(2.5 * knots), 1e6 * apart + 1e-7 * (odd + odd.T), "force_N")
    size = float(form.text.split("form, ")[1].split(" %")[0])
    assert abs(size) == pytest.approx(10.0, rel=0.15)


def test_lines_steps_and_noise_are_not_learned_and_single_trials_only_by_what_is_declared_of_them():
    quiet, loud = (ResidualCheck("spectral line", 1.0, 2.0, exceeded, "") for exceeded in (False, True))
    names = ("depth", "single trials", "oscillation after the stop")
    depth, trials, ringing = (Dependence(name, 500.0, 3, 0.5, "") for name in names)
    assert can_be_learned(ResidualDiagnostics([depth, trials], [quiet])) == tuple(FOLLOWED)
    assert can_be_learned(ResidualDiagnostics([trials, depth], [quiet])) == ("temperature_C", "age_days")
    for checks, where in (([quiet, loud], [depth]), ([quiet], []), ([quiet], [ringing, depth])):
        assert can_be_learned(ResidualDiagnostics(where, checks)) == ()


def test_a_function_whose_place_named_effects_take_is_no_answer(monkeypatch):
    def model(score):
        fit = SimpleNamespace(problem=SimpleNamespace(effects=(effect_named("temperature"),)), score=score)
        return SimpleNamespace(fit=fit)

    monkeypatch.setattr(nonparametric_effect, "learn", lambda *args: SimpleNamespace(fit=None, cost=0.0))
    monkeypatch.setattr(nonparametric_effect, "assess", lambda fit: fit)
    monkeypatch.setattr(
        nonparametric_effect, "search", lambda *_, **options: SimpleNamespace(after=model(0.0), effects=())
    )
    seen = ResidualDiagnostics([Dependence("depth", 500.0, 3, 0.5, "")], [])
    assert nonparametric_effect.learned_first(model(2000.0), seen, model(1000.0), (), quiet) is None


@pytest.mark.slow
def test_a_load_cell_that_saturates_is_learned_though_the_modulus_has_imitated_it(campaigns):
    campaign = read_campaign(campaigns("saturation", 419))
    found = learn(fit_base(make_presses(campaign), law_of(campaign), 0.03))
    assert found.effect.shape.name == "force_N" and found.left_out < 0.25


@pytest.fixture(scope="module")
def of_anindependent_generator(tmp_path_factory):
    """A function: base fit of a campaign of the other generator with one effect."""

    def make(effect, size, seed):
        folder = tmp_path_factory.mktemp("mind")
        independent_generator.write_campaign(folder / effect, ((effect, size),), seed)
        campaign = read_campaign(folder / effect)
        return fit_base(make_presses(campaign), law_of(campaign), 0.03)

    return make


@pytest.mark.slow
def test_a_creep_in_the_hold_is_learned_as_large_as_it_is_and_without_a_jump_at_the_stop(of_anindependent_generator):
    """The force falls by 6 % a decade of 1 + t / s: what is learned begins at zero though nothing pins it there."""
    found = learn(of_anindependent_generator("creeping_hold", 0.06, 1240000))
    assert found.effect.name == "learned_since_stop_s" and found.left_out < 0.7
    at = np.array([0.003, 1.0, 3.0, 7.0])
    np.testing.assert_allclose(found.effect.shape(at), -0.06 * np.log10(1.0 + at), atol=0.012)


@pytest.mark.slow
def test_a_step_with_temperature_is_learned(of_anindependent_generator):
    """9 % stiffer below a temperature, within 0.4 K: a line over temperature is neither enough nor what is learned."""
    base = of_anindependent_generator("cold_stiffening", 0.09, 1240001)
    seen = diagnose(base)
    assert seen.where[0].factor == "temperature" and "temperature_C" in can_be_learned(seen)
    found = learn(base, can_be_learned(seen))
    assert found.effect.name == "learned_temperature_c" and found.left_out < 0.2
    cold, warm = (1.0 + found.effect.shape(np.array(ends)) for ends in ([20.0, 21.0], [23.5, 25.5]))
    assert cold / warm == pytest.approx(1.09, abs=0.015)


@pytest.mark.slow
def test_gains_that_scatter_from_press_to_press_are_no_function_of_temperature_or_age(campaigns):
    """Repeats show the scatter: it is noise of the presses, of which nothing is learned."""
    for seed in (431, 432):
        campaign = read_campaign(campaigns("gain_scatter", seed))
        base = fit_base(make_presses(campaign), law_of(campaign), 0.03)
        assert base.sizes.gain == pytest.approx(0.02, rel=0.4)
        assert learn(base, ("temperature_C", "age_days")) is None
