"""The posterior of a campaign: what its covariance holds, its file, and what a design makes of it."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.calibrated import with_calibration
from dummydesign.loop.calibration import Calibration, Model, Posterior, posterior_of
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.forward_model import Active, BaseParameters
from dummydesign.loop.model.material import UNDECLARED
from dummydesign.loop.selection.cross_validation import jackknife
from dummydesign.measurement.campaign import PadSpec
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.resin import load_resin
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

BASE_NAMES = ("log young_kPa", "log tau_1_s", "log beta_1", "log tau_2_s", "log beta_2")


def made(level=0.004, young=0.01):
    """A calibration with one effect of two parameters and a posterior."""
    base = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))
    recovery = effect_named("incomplete_recovery")
    found = Active(recovery, {"fraction": 0.02, "tau_s": 100.0, "adding": 0.0})
    after = Model(base, (found,), (("", 5.0),), np.zeros((3, 1)))
    names = (*BASE_NAMES, "incomplete_recovery.fraction", "log incomplete_recovery.tau_s", "incomplete_recovery.adding")
    mean = np.r_[np.log([30.0, 0.05, 0.3, 1.2, 0.2]), 0.02, np.log(100.0), 0.0]
    spread = np.array([young, 0.02, 0.03, 0.02, 0.04, 0.001, 0.2, 0.1])
    covariance = np.outer(spread, spread) * (0.7 * np.eye(8) + 0.3)
    known = Posterior(names, mean, covariance, (level, 0.015, 0.008))
    pad = {"young_kPa_expected": 30.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    return Calibration(after, after, "effect", {}, 0.03, pad, (), known)


def test_a_posterior_survives_its_file(tmp_path):
    again = read_calibration(write_calibration(made(), tmp_path / "c.json")).posterior
    assert again.names == made().posterior.names and again.pads == made().posterior.pads
    np.testing.assert_array_equal(again.mean, made().posterior.mean)
    np.testing.assert_array_equal(again.covariance, made().posterior.covariance)
    low, high = again.interval("log young_kPa")
    assert np.log(high / low) == pytest.approx(2 * 1.96 * 0.01, rel=1e-4) and low < 30.0 < high


@pytest.mark.slow
def test_a_file_without_a_posterior_is_read_and_designed_with(tmp_path):
    path = write_calibration(replace(made(), posterior=None), tmp_path / "c.json")
    assert "posterior" not in json.loads(path.read_text()) and read_calibration(path).posterior is None
    with_calibration(load_resin("polyurethane-nagoya"), str(path))


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda p: p.update(names=p["names"][:-1]), "malformed"),
        (lambda p: p.update(mean=p["mean"][:-1]), "malformed"),
        (lambda p: p["covariance"][0].__setitem__(1, 9.0), "malformed"),
        (lambda p: p["covariance"][2].__setitem__(2, -1.0), "malformed"),
        (lambda p: p["covariance"][3].__setitem__(3, "much"), "malformed"),
        (lambda p: p["pad_to_pad"].pop("slope"), "malformed"),
    ],
)
def test_a_damaged_posterior_is_refused_with_its_place(change, code, tmp_path):
    path = write_calibration(made(), tmp_path / "c.json")
    data = json.loads(path.read_text())
    change(data["posterior"])
    path.write_text(json.dumps(data))
    with raises_code(code):
        read_calibration(path)


@pytest.mark.slow
def test_a_design_takes_its_intervals_from_the_posterior_and_the_scatter_of_pads(tmp_path):
    resin = load_resin("polyurethane-nagoya")
    widths = []
    for number, (level, young) in enumerate([(0.0, 0.006), (0.03, 0.006), (0.0, 0.03)]):
        path = write_calibration(made(level, young), tmp_path / f"c{number}.json")
        updated = with_calibration(resin, str(path)).resin
        modulus = updated.modulus_kPa(15.0)
        widths.append(np.log(modulus.high / modulus.low))
        strengths = [arm.beta for arm in updated.arms]
        for strength, spread in zip(strengths, (0.03, 0.04)):
            # normal in the logarithm, as the posterior is
            ends = np.array([strength.low, strength.high]) / strength.value
            np.testing.assert_allclose(np.log(ends), [-1.96 * spread, 1.96 * spread], rtol=1e-4)
    assert widths[0] < 0.7 * widths[1] and widths[0] < 0.7 * widths[2]


def test_strengths_are_drawn_with_the_modulus_that_they_are_known_with(tmp_path):
    """Draws at the campaign's ratio have the posterior's correlations; pad to pad scatter is of the modulus alone."""
    path = write_calibration(made(level=0.02, young=0.02), tmp_path / "c.json")
    calibrated = with_calibration(load_resin("polyurethane-nagoya"), str(path))
    drawn = calibrated.resin.draw(40000)
    young = np.log(drawn.young_MPa(15.0))
    logs = np.column_stack([young, np.log(drawn.beta(15.0))])
    known = calibrated.calibration.posterior
    rows = [known.names.index(name) for name in ("log young_kPa", "log beta_1", "log beta_2")]
    wanted = known.covariance[np.ix_(rows, rows)].copy()
    # the modulus as drawn: that of a new pad, a little narrower by what the resin's law knew before
    wanted[0, 0] = known.new_pad_spread**2
    found = np.cov(logs.T)
    assert 0.85 < found[0, 0] / wanted[0, 0] < 1.05
    # slopes on the modulus, and what is left when it is known
    slope, left = wanted[1:, 0] / wanted[0, 0], wanted[1:, 1:] - np.outer(wanted[1:, 0], wanted[0, 1:]) / wanted[0, 0]
    np.testing.assert_allclose(found[1:, 0] / found[0, 0], slope, atol=0.03)
    own = logs[:, 1:] - np.outer(young, slope)
    np.testing.assert_allclose(np.cov(own.T), left, atol=0.03 * left.max())
    np.testing.assert_allclose(np.median(drawn.beta(15.0), axis=0), [0.3, 0.2], rtol=0.01)


@pytest.mark.slow
def test_the_modulus_is_known_no_better_than_the_number_of_pads_lets_it(campaigns):
    """With a level error of each pad of known size and little else the variance of the mean is that over the pads."""
    campaign = read_campaign(campaigns("none", 401))
    presses, law = make_presses(campaign), law_of(campaign)
    found = fit_base(presses, law, 0.03)
    known = posterior_of(found)
    # three pads with what is known of pads beforehand: Student's t of some seven degrees
    assert known.young_spread > 1.1 * found.sizes.law[0] / np.sqrt(len(found.problem.presses.pads))
    assert known.pads[0] > 1.1 * found.sizes.law[0]
    assert known.new_pad_spread == pytest.approx(np.hypot(known.young_spread, known.pads[0]))
    assert known.mean[0] == pytest.approx(np.log(1e3 * found.base.young_MPa))
    assert np.linalg.eigvalsh(known.covariance)[0] > 0.0
    np.testing.assert_allclose(posterior_of(found, 1.4).covariance, 1.4 * known.covariance, rtol=1e-12)
    np.testing.assert_allclose(posterior_of(found, 0.5).covariance, known.covariance, rtol=1e-12)


@pytest.mark.slow
def test_what_a_model_misses_widens_the_intervals_by_what_leaving_conditions_out_changes(campaigns):
    """A law that grows stiffer with depth, fitted without: the bins of a press share the misfit, conditions show it."""
    campaign = read_campaign(campaigns("none", 401))
    presses, law = make_presses(campaign), law_of(campaign)
    stiffer = 1.0 + 0.3 * (presses.depth_mm / presses.thickness_mm)[:, None] ** 4 / 0.4**4
    found = fit_base(replace(presses, force_N=presses.force_N * stiffer), law, 0.03)
    added = posterior_of(found, 2.0).covariance - 2.0 * posterior_of(found, 1.0).covariance
    count = len(added)
    np.testing.assert_allclose(added, jackknife(found)[:count, :count], rtol=1e-6, atol=1e-12)
    plain = jackknife(fit_base(presses, law, 0.03))
    assert added[0, 0] > 3.0 * plain[0, 0] > 0.0


def test_units_of_an_effect_are_those_of_its_parameters(monkeypatch):
    tilt = effect_named("contact_offset")
    step = tilt.parameters[0].typical
    covariance = np.diag([1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 4.0, 1e-4])
    fit = SimpleNamespace(
        vector=np.r_[np.zeros(5), 2.0, 0.0],
        covariance=covariance,
        sizes=SimpleNamespace(law=(0.1, 0.2, 0.3)),
        active=(Active(tilt, {tilt.parameters[0].name: tilt.parameters[0].to_value(2.0)}),),
        joined=True,
        problem=SimpleNamespace(presses=SimpleNamespace(trials=()), base_count=5, prior=UNDECLARED),
    )
    monkeypatch.setattr("dummydesign.loop.calibration.pad_spreads", lambda found: found.sizes.law)
    known = posterior_of(fit)
    assert known.spread(known.names[-1]) == pytest.approx(2.0 * abs(step)) and len(known.names) == 6


def test_a_calibration_is_carried_to_pads_of_another_ratio_along_the_law_of_the_resin(tmp_path):
    """a calibration that found the resin's own numbers at 15.5 finds them at 15.8, as a design with it does"""
    resin, known = load_resin("polyurethane-nagoya"), made(level=0.0, young=0.005)
    arms = resin.prony(15.5)
    base = BaseParameters(resin.young_MPa(15.5), tuple(a.tau_s for a in arms), tuple(a.beta for a in arms))
    plain = replace(known.after, base=base, active=())
    known = replace(known, base=plain, after=plain, pad={**known.pad, "resin": resin.name, "ratio": 15.5})
    pads = PadSpec(None, resin.name, 15.8, "slab", 100.0, 100.0, None, "bonded")
    carried, wanted = known.at_ratio_of(pads), resin.prony(15.8)
    for model in (carried.base, carried.after):
        assert model.base.young_MPa == pytest.approx(resin.young_MPa(15.8), rel=0.01)
        assert model.base.beta == pytest.approx([arm.beta for arm in wanted], rel=0.01)
    assert carried.after.base.young_MPa > 1.05 * base.young_MPa
    own = replace(known, posterior=None)
    made_of = with_calibration(resin, str(write_calibration(own, tmp_path / "calibration.json"))).resin
    assert own.at_ratio_of(pads).after.base.young_MPa == pytest.approx(made_of.young_MPa(15.8), rel=0.002)
    for same in (replace(pads, ratio=15.5), replace(pads, resin=None), replace(pads, ratio=None)):
        assert known.at_ratio_of(same) is known
