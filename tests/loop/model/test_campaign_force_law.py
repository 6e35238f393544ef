"""Laws of set-ups without a table: each row on its own pad's curve, what changes it, and what effects may ask."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects.registry import EFFECTS
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model import campaign_pad_law
from dummydesign.loop.model.campaign_law import ROUGHNESS, SLAB_ERROR, CampaignLaw, error_priors, law_of
from dummydesign.loop.selection.residuals import dependences
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.pad import force_source as elastic
from dummydesign.pad.axisymmetric.case import PadCurve
from dummydesign.pad.tables.square import crown_factor
from tests.support.known_laws import slab_law
from tests.support.named_effects import effect_named

CROWN = read_shape("crowned:radius=20,height=3,foot=11")


def hertz(pad, depth_mm):
    """F of a cap that stiffens towards its base: 16/9 E sqrt(R) d^1.5 (1 + d / h). [N]"""
    factor = 0.8 if pad.base == "sliding" else 1.0 / (1.0 + (1.0 - 2.0 * pad.poisson) * 3.0)
    return 16 / 9 * pad.young_MPa * np.sqrt(20.0) * depth_mm**1.5 * (1.0 + depth_mm / pad.thickness_mm) * factor


@pytest.fixture
def closed_form(monkeypatch):
    """Every pad is a cap with a closed form instead of finite elements."""
    solved = []

    def points(pad, depth_mm, progress=None, cells=None):
        solved.append(pad)
        force = hertz(pad, depth_mm)
        return PadCurve(depth_mm, force, 0.02 * force, {}, ())

    monkeypatch.setattr(elastic, "solve_points", points)
    monkeypatch.setattr(campaign_pad_law, "_coarse", lambda pad, depth_mm, cells: hertz(pad, depth_mm) / pad.young_MPa)
    return solved


@pytest.fixture
def shaped(campaigns):
    """A campaign of slabs whose pads of 15 mm are declared crowned."""
    campaign = read_campaign(campaigns("none", 401))
    trials = [replace(t, geometry=CROWN) if t.thickness_mm == 15.0 else t for t in campaign.trials]
    punch = replace(campaign.punch, shape="round", side_mm=None, diameter_mm=2.0 * campaign.punch.radius_mm)
    return replace(campaign, trials=tuple(trials), punch=punch)


def asked(law, trials, share=0.2):
    h = np.array([[t.thickness_mm] for t in trials])
    return law.on(trials)(share * h, h)[:, 0]


def test_each_trial_has_the_law_of_its_own_pad(shaped, closed_form):
    law = law_of(shaped)
    assert isinstance(law, CampaignLaw) and law.shape == "shaped"
    slab = slab_law(shaped.punch.radius_mm)
    for trial, area in zip(shaped.trials, asked(law, shaped.trials)):
        h = np.array([[trial.thickness_mm]])
        if trial.geometry.plain:
            assert area == pytest.approx(slab(0.2 * h, h)[0, 0], rel=1e-12)
        else:
            pad = SimpleNamespace(base="bonded", poisson=0.5, young_MPa=1.0, thickness_mm=15.0)
            assert area == pytest.approx(hertz(pad, 3.0), rel=1e-4)
    assert len(closed_form) == 1, "one pad is solved once, whatever is pressed on it"


def test_a_square_punch_on_a_crown_has_the_crowns_factor(shaped, closed_form):
    square = replace(shaped, punch=replace(shaped.punch, shape="square", side_mm=14.0, diameter_mm=None))
    only = tuple(t for t in shaped.trials if not t.geometry.plain)[:1]
    round_, own = (asked(law_of(replace(one, trials=only)), only, 0.3)[0] for one in (shaped, square))
    factor, error = crown_factor(4.5, 15.0, 14.0 / np.sqrt(np.pi), dict(CROWN.parameters))
    assert own / round_ == pytest.approx(float(factor), rel=2e-3) and abs(factor - 1.0) > 2e-3
    assert law_of(replace(square, trials=only)).error_priors[0][0] > law_of(shaped).error_priors[0][0] and error > 0.0


def test_pads_of_one_thickness_and_two_shapes_are_two_pads(shaped, closed_form):
    trials = list(shaped.trials)
    first = next(i for i, t in enumerate(trials) if not t.geometry.plain)
    trials[first] = replace(trials[first], geometry=Slab())
    presses = make_presses(replace(shaped, trials=tuple(trials)))
    both = [pad for pad in presses.pads if pad[1] == 15.0]
    assert both == [("", 15.0), (str(CROWN), 15.0)]
    assert presses.pads[presses.pad[first]] == ("", 15.0)
    assert presses.cell[first] not in np.delete(presses.cell, first)
    assert not presses.history.earlier_depth_mm[first].any() and not presses.history.earlier_depth_mm[:, first].any()


def test_thickness_slip_and_bulk_change_a_solved_pad_as_its_solves_say(shaped, closed_form):
    only = tuple(t for t in shaped.trials if not t.geometry.plain)
    law = law_of(replace(shaped, trials=only)).on(only)
    depth = np.full((len(only), 3), [0.5, 2.0, 5.0])
    own = np.full((len(only), 1), 15.0)

    def exact(**changed):
        pad = SimpleNamespace(**{"base": "bonded", "poisson": 0.5, "young_MPa": 1.0, "thickness_mm": 15.0, **changed})
        return hertz(pad, depth)

    for thickness in (14.0, 15.0, 16.0):
        assert law(depth, own + thickness - 15.0) == pytest.approx(exact(thickness_mm=thickness), rel=2e-3)
    assert law.sliding()(depth, own) == pytest.approx(exact(base="sliding"), rel=1e-3)
    softer = 1.0 + 0.06 * law.compressibility_coefficient(depth, own)
    assert law(depth, own) / softer == pytest.approx(exact(poisson=0.47), rel=1e-3)
    assert (law(-depth, own) == 0.0).all()


def test_pads_of_nearly_one_thickness_share_a_solve_and_differ_by_it(shaped, closed_form):
    only = [replace(t, thickness_mm=15.0 + 0.1 * (i % 3)) for i, t in enumerate(shaped.trials) if t.geometry == CROWN]
    law = law_of(replace(shaped, trials=tuple(only)))
    assert len(closed_form) == 1
    area = asked(law, only)
    for trial, value in zip(only, area):
        pad = SimpleNamespace(base="bonded", poisson=0.5, young_MPa=1.0, thickness_mm=trial.thickness_mm)
        assert value == pytest.approx(hertz(pad, 0.2 * trial.thickness_mm), rel=1e-3)


def test_effects_that_a_set_up_cannot_show_are_left_out_with_a_word(shaped, closed_form):
    presses, law = make_presses(shaped), law_of(shaped)
    tilt, friction = (effect_named(name).undefined(presses, law) for name in ("punch_tilt", "plate_friction"))
    assert tilt == "needs a flat face under a flat punch on every pad"
    assert friction == "for pucks between plates only"
    assert not any(effect_named(name).undefined(presses, law) for name in ("base_slip", "compressibility"))
    slipping = replace(shaped, punch=replace(shaped.punch, contact="frictionless"))
    said = effect_named("base_slip").undefined(presses, law_of(slipping))
    assert said == "needs pads glued to their base under a glued flat punch"
    for effect in EFFECTS:
        assert effect.undefined(presses, law) or effect.untestable(presses) is not None


def test_a_measured_thickness_and_a_solves_error_widen_the_allowance():
    plain = error_priors()
    assert plain == SLAB_ERROR
    wide = error_priors(0.02, thickness=0.03)
    assert wide[0][0] == pytest.approx(np.linalg.norm([plain[0][0], 0.01, 0.03])) and wide[1][0] > plain[1][0]


def test_the_thickness_error_of_a_trial_reaches_the_allowance(campaigns):
    campaign = read_campaign(campaigns("none", 401))
    sd = tuple(replace(t, thickness_sd_mm=0.02 * t.thickness_mm) for t in campaign.trials)
    exact, measured = law_of(campaign), law_of(replace(campaign, trials=sd))
    assert exact.error_priors == SLAB_ERROR
    assert measured.error_priors[0][0] == pytest.approx(np.hypot(SLAB_ERROR[0][0], 0.02))


def test_the_depth_that_was_solved_is_known_for_every_trial(shaped, closed_form):
    law = law_of(shaped)
    limits = law.limit_of(shaped.trials)
    deepest = np.array([t.trace.displacement_mm.max() for t in shaped.trials])
    assert limits.shape == deepest.shape and (limits > deepest).all()


class Faint(Crowned):
    """A crown too low to be cast."""

    def check(self, thickness_mm, length_mm=150.0, width_mm=120.0):
        pass


def test_a_remainder_as_large_as_a_solve_is_rough_follows_nothing_and_a_larger_one_follows_depth(shaped, closed_form):
    """The residual is the force times a wave in depth, on the crowned pads alone."""
    crowned = replace(shaped, trials=tuple(t for t in shaped.trials if not t.geometry.plain))
    law, presses = law_of(crowned), make_presses(crowned)
    usual = SLAB_ERROR[3][0]
    assert law.error_priors[3][0] == pytest.approx(np.hypot(usual, ROUGHNESS))
    fit = fit_base(presses, law, 0.03)
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))

    def follows(size, rough):
        wave = np.where(presses.used, size * fit.forces * np.sin(2.0 * np.pi * depth / 1.2), 0.0)
        sizes = replace(fit.sizes, law=(*fit.sizes.law[:-1], rough))
        found = dependences(replace(fit, sizes=sizes, residual=wave))
        return next(one.excess for one in found if one.factor == "depth")

    assert follows(ROUGHNESS, ROUGHNESS) < 0.5 * follows(ROUGHNESS, 1e-6)
    assert follows(10.0 * ROUGHNESS, ROUGHNESS) > 60.0
    assert law_of(replace(shaped, trials=tuple(t for t in shaped.trials if t.geometry.plain))).shape == "slab"


@pytest.mark.slow
def test_a_crown_that_vanishes_has_the_slabs_law_and_the_loop_finds_its_modulus(campaigns, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_CACHE", "off")
    campaign = read_campaign(campaigns("none", 401))
    few = tuple(t for t in campaign.trials if t.thickness_mm == 15.0)
    round_punch = replace(campaign.punch, shape="round", side_mm=None, diameter_mm=2.0 * campaign.punch.radius_mm)
    campaign = replace(campaign, trials=few, punch=round_punch)
    presses, slab = make_presses(campaign), law_of(campaign)
    h, depth = np.full((len(few), 1), 15.0), np.full((len(few), 2), [1.5, 5.0])
    away = []
    for height in (0.3, 0.01):
        faint = Faint(radius_mm=64.0 / (2.0 * height), height_mm=height, foot_mm=8.0)
        crowned = replace(campaign, trials=tuple(replace(t, geometry=faint) for t in few))
        law = law_of(crowned)
        away.append(np.abs(law.on(crowned.trials)(depth, h) / slab(depth, h) - 1.0).max())
    # On the cells of the design a crown is stiffer than the table at the punch's edge, by less than both state there.
    assert away[1] < 0.025 and away[1] < 0.5 * away[0]
    own, other = fit_base(presses, slab, 0.03), fit_base(make_presses(crowned), law, 0.03)
    assert other.base.young_MPa == pytest.approx(own.base.young_MPa, rel=0.02)
    assert other.base.beta == pytest.approx(own.base.beta, rel=0.02)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_a_small_fillet_on_a_slab_is_near_the_sharp_edge_and_changes_as_that_does(base):
    """Round punch of 15.8 mm on 10 mm: a fillet of 0.2 mm takes off a few per cent, and the change with thickness, base
    and bulk is that of the sharp edge."""
    curve, law = slab_law(7.9, base=base, edge_radius_mm=0.2), slab_law(7.9, base=base)
    depth = np.array([[0.3, 1.0, 2.0]])
    near = curve(depth, np.array([[10.0]])) / law(depth, np.array([[10.0]]))
    assert np.all((near > 0.95) & (near < 1.02))
    thicker = law(depth, np.array([[10.5]])) / law(depth, np.array([[10.0]]))
    np.testing.assert_allclose(curve(depth, np.array([[10.5]])) / curve(depth, np.array([[10.0]])), thicker, rtol=2e-3)
    if base == "bonded":
        bulk = law.compressibility_coefficient(depth, np.array([[10.0]]))
        np.testing.assert_allclose(curve.compressibility_coefficient(depth, np.array([[10.0]])), bulk, rtol=0.01)
        # slip takes off what it takes off under this fillet, which nears that under the sharp edge
        h = np.array([[10.0]])
        np.testing.assert_allclose(
            curve.sliding()(depth, h), slab_law(7.9, base="sliding", edge_radius_mm=0.2)(depth, h), rtol=1e-4
        )
        away = [
            np.abs(own.sliding()(depth, h) / own(depth, h) / (law.sliding()(depth, h) / law(depth, h)) - 1.0).max()
            for own in (curve, slab_law(7.9, edge_radius_mm=0.05), slab_law(7.9, edge_radius_mm=0.01))
        ]
        assert away[0] > 2.0 * away[1] > 4.0 * away[2] and away[2] < 1e-3
