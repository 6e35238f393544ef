"""Parts of force laws against closed forms: curves of solved pads, their changes, thickness, pads' own factors."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.api.predictions import pad_of_inputs
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.progress import quiet
from dummydesign.core.quantity import Quantity
from dummydesign.geometry.punch import ball_profile
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.loop.effects.learned import FADE, Learned, SmoothChange, at_nodes, fading, followed
from dummydesign.loop.model import campaign_law, campaign_pad_law
from dummydesign.loop.model.campaign_law import ROUGHNESS, ROUND_ERROR, SLAB_ERROR, CampaignLaw, error_priors
from dummydesign.loop.model.campaign_pad_law import DENSE, POINTS, THICKER, CampaignPadLaw
from dummydesign.loop.pad_scatter import carried_share, pad_scatter, recorded_ln, recorded_spread
from dummydesign.loop.result import worth_of
from dummydesign.pad.first_touch import interpolate_curve, low_end
from dummydesign.pad.force_law import PadCurve
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin_file import save_resin
from tests.support import puck_presses as pucks
from tests.support.known_laws import puck_law, slab_law
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit

CROWN = read_shape("crowned:radius=20,height=3,foot=11")


class Known(CampaignPadLaw):
    """A crowned pad whose force is 3 d^1.5 (1 + d / 10) h^-0.8, as if it had been solved."""

    @staticmethod
    def area(depth, thickness):
        return 3.0 * depth**1.5 * (1.0 + 0.1 * depth) * (10.0 / thickness) ** 0.8

    @cached_property
    def curve(self):
        force = self.pad.young_MPa * self.area(self.depths_mm, self.pad.thickness_mm)
        solved = PadCurve(self.depths_mm, force, np.linspace(0.01, 0.03, POINTS) * force, {})
        return interpolate_curve(solved, low_end(self.pad, self.depths_mm, force, np.full(POINTS, 0.01)))


@pytest.fixture
def curve(monkeypatch):
    """Its changes are known too: under a ball whose first touch it has."""

    def ratio(self, **change):
        depth = np.maximum(self.dense_mm, 1e-9)
        if "thickness_mm" in change:
            return np.log(self.area(depth, change["thickness_mm"]) / self.area(depth, self.pad.thickness_mm))
        return np.log(0.9) + 0.0 * depth if "base" in change else -np.log1p(0.04 * (2.0 + depth))

    monkeypatch.setattr(Known, "_log_ratio", ratio)
    ball = ball_profile(2.0 * (3.0 * 9.0 / 16.0) ** 2)
    return Known(Pad(10.0, 1.0, 7.0, profile_mm=ball, condition="frictionless"), 3.0)


def test_a_solved_curve_gives_its_force_at_every_depth_and_goes_on_with_its_last_secant(curve):
    depth, h = np.linspace(0.05, 3.0, 40)[None], np.array([[10.0]])
    assert curve.power == 1.5 and curve.limit_mm == pytest.approx(3.0) and curve.pad.radius_mm == 7.0
    np.testing.assert_allclose(curve(depth, h), Known.area(depth, 10.0), rtol=1e-4)
    beyond = np.array([[4.0, 5.0]])
    np.testing.assert_allclose(curve(beyond, h), Known.area(3.0, 10.0) * (beyond / 3.0) ** 1.5, rtol=1e-6)
    assert not curve(np.array([[-1.0, 0.0]]), h).any()
    assert curve.relative_error == pytest.approx(0.02)
    assert len(curve.dense_mm) == DENSE and curve.dense_mm[0] < 1e-5 and curve.dense_mm[-1] == pytest.approx(3.0)
    assert np.all(np.diff(curve.depths_mm, 2) > 0.0) and curve.depths_mm[0] < 0.05


def test_the_change_with_thickness_is_its_first_and_second_derivative(curve):
    first, second = curve.with_thickness
    np.testing.assert_allclose(first, -0.8, rtol=1e-9)
    np.testing.assert_allclose(second, 0.0, atol=1e-9)
    depth = np.array([[0.5, 2.0]])
    for h in (9.0, 10.7, 12.0):
        np.testing.assert_allclose(curve(depth, np.array([[h]])), Known.area(depth, h), rtol=2e-4)


def test_a_bend_with_thickness_is_followed_to_what_was_solved_and_goes_on_straight(curve, monkeypatch):
    monkeypatch.setattr(Known, "_log_ratio", lambda self, thickness_mm: 0.0 * self.dense_mm + _bent(thickness_mm))
    depth = np.array([[1.0]])
    own = curve(depth, np.array([[10.0]]))[0, 0]

    def change(h):
        return float(np.log(curve(depth, np.array([[h]]))[0, 0] / own))

    for h in (10.0 / THICKER, 9.5, 10.5, 10.0 * THICKER):
        assert change(h) == pytest.approx(_bent(h), rel=1e-6)
    end = np.log(THICKER)
    slope = -0.8 + 2.0 * 0.5 * end
    assert change(10.0 * THICKER**2) == pytest.approx(_bent(10.0 * THICKER) + slope * end, rel=1e-6)


def _bent(h):
    x = np.log(h / 10.0)
    return -0.8 * x + 0.5 * x**2


@pytest.mark.parametrize("fails", [1, -1])
def test_where_one_side_cannot_be_solved_the_other_gives_the_slope(curve, monkeypatch, fails):
    def ratio(self, thickness_mm):
        if (thickness_mm > 10.0) == (fails > 0):
            raise NoAnswerError("no_convergence", "stopped")
        return 0.0 * self.dense_mm + _bent(thickness_mm)

    monkeypatch.setattr(Known, "_log_ratio", ratio)
    first, second = curve.with_thickness
    side = 10.0 * THICKER**-fails
    assert first[0] == pytest.approx(_bent(side) / np.log(side / 10.0)) and not second.any()


def test_sliding_and_bulk_change_the_force_by_what_was_solved(curve):
    depth, h = np.array([[0.5, 2.0]]), np.array([[10.0]])
    law = CampaignLaw({("c", 10.0): curve})
    np.testing.assert_allclose(law.sliding()(depth, h), 0.9 * curve(depth, h), rtol=1e-9)
    np.testing.assert_allclose(law.compressibility_coefficient(depth, h), 2.0 + depth, rtol=1e-4)


def test_a_rounded_tip_begins_as_hertz_and_powers_are_those_of_the_touch():
    pad = Pad(10.0, 1.0, 7.0, geometry=CROWN)
    known = Known(pad, 3.0)
    secant = known.log_secant
    if CROWN.tip_radius_mm:
        assert secant[0] == pytest.approx(np.log(16.0 / 9.0 * np.sqrt(CROWN.tip_radius_mm)), abs=1e-4)
    assert known.power == CROWN.first_exponent
    assert Known(Puck(10.0, 1.0, 20.0), 3.0).power == 1.0
    np.testing.assert_allclose(np.diff(Known(Puck(10.0, 1.0, 20.0), 3.0).dense_mm), 3.0 / (DENSE - 1), rtol=1e-3)
    slides = replace(pad, condition="frictionless")
    assert Known(slides, 3.0).depths_mm[0] == pytest.approx(0.18) and len(Known(slides, 3.0).depths_mm) == POINTS


def test_changes_of_thickness_of_solved_pads_follow_a_slab_whose_thicknesses_are_known(monkeypatch):
    """A slab as if it had been solved: within 15 % its change with thickness is that of the table to 0.1 %."""
    known = slab_law(7.9)
    for h in (6.0, 10.0, 20.0):
        law, depth = known.law_of(("", h)), h * np.array([[0.05, 0.2, 0.35]])
        first, second = law.with_thickness
        for other in (h / 1.15, 0.93 * h, 1.06 * h, 1.14 * h):
            change = np.log(other / h)
            found = law.read(first, depth) * change + law.read(second, depth) * change**2
            wanted = np.log(known(depth, np.array([[other]])) / known(depth, np.array([[h]])))
            np.testing.assert_allclose(found, wanted, atol=1e-3)


def test_changes_of_shaped_pads_are_smoothed_ratios_of_coarse_solves(monkeypatch):
    """The scatter of a contact that grows cell by cell goes; finer cells follow where too little was reached."""
    used = []

    def coarse(pad, depth, cells):
        used.append(cells)
        count = len(depth) if cells > 10 else 12
        scatter = 0.01 * (-1.0) ** np.arange(count)
        factor = 1.0 if pad.base == "bonded" else np.exp(-0.2 + 0.1 * depth[:count] + scatter)
        return factor * depth[:count] ** 1.5

    monkeypatch.setattr(campaign_pad_law, "_coarse", coarse)
    known = Known(Pad(10.0, 1.0, 7.0, geometry=CROWN), 3.0)
    found = known._log_ratio(base="sliding")
    assert set(used) == {10, 13}
    inside = known.dense_mm > 0.1
    np.testing.assert_allclose(found[inside], (-0.2 + 0.1 * known.dense_mm)[inside], atol=0.009)
    monkeypatch.setattr(campaign_pad_law, "_coarse", lambda pad, depth, cells: depth[:12])
    with pytest.raises(NoAnswerError, match="another base"):
        known._log_ratio(base="sliding")


def test_a_coarse_solve_is_in_millimetres_and_per_unit_of_youngs_modulus(monkeypatch):
    from dummydesign.pad.axisymmetric import shaped_problem

    asked = {}

    def path(case, shares, cells, rim):
        asked.update(shares=shares, cells=cells, first=case.first)
        return SimpleNamespace(force=2.0 * shares)

    monkeypatch.setattr(shaped_problem, "solve_path", path)
    depth = np.array([0.2, 1.0, 2.0, 7.0])
    for poisson in (0.5, 0.48):
        pad = Pad(10.0, 1.0, 7.0, geometry=CROWN, poisson=poisson)
        area = campaign_pad_law._solve_coarse(pad, depth, 13)["area_mm2"]
        np.testing.assert_allclose(area, 2.0 * depth[:3] / 10.0 * 100.0 / (2.0 * (1.0 + poisson)))
        np.testing.assert_allclose(asked["shares"], depth[:3] / 10.0)
        assert asked["first"] == pytest.approx(0.02) and asked["cells"] == 13


def test_a_law_of_several_pads_takes_each_on_its_own_and_a_new_one_as_the_nearest_in_ratio(curve):
    thin, thick = replace(curve), Known(replace(curve.pad, thickness_mm=20.0), 6.0)
    law = CampaignLaw({("", 10.0): thin, ("", 20.0): thick, ("c", 11.0): thick})
    for h, own in ((10.0, thin), (13.9, thin), (14.4, thick), (90.0, thick), (1.0, thin)):
        assert law.law_of(("", h)) is own
    assert law.law_of(("c", 1.0)) is thick and law.offers == frozenset() and law.shape == "shaped"
    trials = [SimpleNamespace(pad=("", h), thickness_mm=h) for h in (20.0, 10.0, 20.0)]
    np.testing.assert_allclose(law.limit_of(trials), [6.0, 3.0, 6.0])
    bound = law.on(trials)
    depth, h = np.array([[1.0, 2.0], [0.5, 1.0], [2.0, 3.0]]), np.array([[20.0], [10.0], [20.0]])
    np.testing.assert_allclose(bound(depth, h), Known.area(depth, h), rtol=2e-4)
    np.testing.assert_allclose(bound.sliding()(depth, h), 0.9 * bound(depth, h), rtol=1e-9)
    np.testing.assert_allclose(bound.compressibility_coefficient(depth, h), 2.0 + depth, rtol=1e-3)


def test_errors_of_a_law_add_in_squares():
    (level, a), (slope, b), (curved, c), (wave, d) = error_priors(0.02, True, 0.03, True)
    own = [size for size, _ in SLAB_ERROR]
    assert level == pytest.approx(np.sqrt(own[0] ** 2 + 0.01**2 + 0.01**2 + 0.03**2))
    assert slope == pytest.approx(np.sqrt(own[1] ** 2 + 0.01**2 + 0.01**2))
    assert curved == pytest.approx(np.hypot(own[2], 0.005)) and wave == pytest.approx(np.hypot(own[3], ROUGHNESS))
    assert (a, b, c, d) == tuple(spread for _, spread in SLAB_ERROR)
    assert error_priors() == SLAB_ERROR


def trial(thickness=10.0, sd=None, factor_sd=0.0, depth=2.0, geometry=CROWN, factor=1.0, **more):
    trace = SimpleNamespace(displacement_mm=np.array([0.0, depth]))
    given = {"witness_kPa": None, "weighed_ratio": None, "design_thickness_mm": None, **more}
    return SimpleNamespace(
        thickness_mm=thickness,
        thickness_sd_mm=sd,
        young_factor_sd=factor_sd,
        young_factor=factor,
        pad=(str(geometry), thickness),
        geometry=geometry,
        trace=trace,
        **given,
    )


def test_what_is_not_known_of_a_pads_level_is_its_gauge_and_its_modulus():
    assert campaign_law.level_error(trial()) == 0.0
    assert campaign_law.level_error(trial(8.0, 0.2)) == pytest.approx(0.025)
    assert campaign_law.level_error(trial(8.0, 0.2, 0.06)) == pytest.approx(0.065)


def set_up(base="bonded", contact="bonded", side_mm=None):
    """A campaign's pad and punch of 7.9 mm, without its trials."""
    punch = SimpleNamespace(
        profile_mm=None, contact=contact, radius_mm=7.9, edge_radius_mm=0.0, side_mm=side_mm, shape="square"
    )
    pad = SimpleNamespace(
        base=base,
        shape="slab",
        length_mm=60.0,
        width_mm=50.0,
        diameter_mm=None,
        resin=None,
        ratio=None,
        young_kPa_nominal=30.0,
    )
    return SimpleNamespace(pad=pad, punch=punch)


def test_thicknesses_within_six_per_cent_share_a_curve(monkeypatch):
    """The end belongs to it: 26.5 mm is solved with 25 mm."""
    monkeypatch.setattr(campaign_law, "curve_without_solve", lambda pad: None)
    trials = [trial(thickness) for thickness in (10.0, 10.59, 10.61, 25.0, 26.5)]
    laws = campaign_law._laws(set_up(), trials, quiet)
    groups: dict[int, list[float]] = {}
    for one in trials:
        groups.setdefault(id(laws[one.pad]), []).append(one.thickness_mm)
    assert list(groups.values()) == [[10.0, 10.59], [10.61], [25.0, 26.5]]


@pytest.fixture
def stated(monkeypatch):
    """Every pad that is solved states an error of 2 %."""
    monkeypatch.setattr(CampaignPadLaw, "relative_error", 0.02)


@pytest.mark.parametrize(("depth", "share"), [(2.70, 0.3), (2.75, 0.45), (4.05, 0.45), (4.2, None)])
def test_a_pad_is_solved_to_the_first_depth_beyond_what_was_pressed_by_a_tenth(stated, depth, share):
    square, trials = set_up(side_mm=14.0), [trial(9.0, depth=0.1), trial(9.0, depth=0.9 * depth)]
    (law,) = set(campaign_law._laws(square, trials, quiet).values())
    wanted = share or campaign_law.MAX_DEPTH_OVER_THICKNESS
    assert law.deepest_mm == pytest.approx(9.0 * wanted)
    assert campaign_law._error_of([law], trials) == error_priors(0.02, rough=True)
    # a square on a pad whose own factor is not tabulated is taken for the circle of its area
    layered = [trial(9.0, geometry=read_shape("layered:top=3,modulus_ratio=0.3"))]
    for side_mm in (14.0, None):
        own = list(campaign_law._laws(set_up(side_mm=side_mm), layered, quiet).values())
        usual = ROUND_ERROR if side_mm is None else SLAB_ERROR
        assert campaign_law._error_of(own, layered) == error_priors(0.02, side_mm is not None, usual=usual)


@pytest.mark.parametrize("thickness_mm", [8.0, 15.0])
def test_the_law_under_a_round_punch_is_known_as_the_table_states_it(thickness_mm):
    """Slope and curvature together at d/h = 0.4: wider than what the table states, by less than the square takes."""
    pad = Pad(thickness_mm, 1.0, 8.0)
    law = CampaignPadLaw(pad, 0.6 * thickness_mm)
    _, (slope, _), (curve, _), _ = campaign_law._error_of([law], [trial(thickness_mm)])
    stated = float(law.curve.relative_error(np.array([0.4 * thickness_mm]))[0])
    assert stated < 2.0 * np.hypot(slope, curve) < 2.5 * stated


@pytest.mark.parametrize("text", ["slab", "crowned:3.6,4.6,9.4"])
def test_pads_of_a_resin_that_stiffens_are_pressed_as_predict_presses_them(text):
    base = load_resin()
    save_resin(replace(base, name="stiffens", ogden_alpha=Quantity(3.4, 3.0, 3.9, "fitted", "two pucks")))
    own = set_up(side_mm=14.0)
    own.pad.resin, own.pad.ratio, own.punch.radius_mm = "stiffens", 15.5, 14.0 / np.sqrt(np.pi)
    pad = campaign_law.pad_of(own, 10.5, 1.0, read_shape(text))
    said = pad_of_inputs(
        {"thickness_mm": 10.5, "shape": text, "resin": "stiffens", "ratio": 15.5, "young_kPa": None, "prony": None}
        | {"pad": "slab:60x50", "punch": "square:14", "base": "bonded", "condition": "bonded", "poisson": 0.5}
        | {"edge_radius_mm": 0.0, "law": "neo-hookean"}
    )[0]
    assert said.law == pad.law
    if text != "slab":  # it is solved
        return
    law, plain = (CampaignPadLaw(one, 4.5) for one in (pad, replace(pad, law=None)))
    depth = np.array([1.0, 2.5, 4.2])
    force = elastic_curve(said, "table").force(depth)
    np.testing.assert_allclose(law.curve.force(depth) * said.young_MPa, force, rtol=1e-9)
    assert np.all(np.diff(law.curve.force(depth) / plain.curve.force(depth)) > 0.01)
    # what is not known of the exponent bends the law, its level stays
    alphas = None, Quantity(3.4, 3.0, 3.9, "fitted", "two pucks")
    free, held = (campaign_law._error_of([law], [trial(10.5)], alpha) for alpha in alphas)
    assert held[0] == free[0] and held[1][0] > 1.5 * free[1][0] and held[3] == free[3]


def test_learned_changes_interpolate_between_knots_and_fade_evenly():
    knots = (1.0, 2.0, 4.0, 8.0)
    at = np.array([1.0, 1.25, 3.0, 7.0, 8.0])
    np.testing.assert_allclose(SmoothChange(("depth_mm",), (knots,), knots)(at), at)
    assert not SmoothChange(("depth_mm",), (knots,), knots)(np.array([-9.0, 99.0])).any()
    reach = FADE * 7.0
    np.testing.assert_allclose(
        fading(np.array([1.0, 8.0, 8.0 + 0.25 * reach, 1.0 - 0.75 * reach, 8.0 + 2.0 * reach]), (1.0, 8.0)),
        [1.0, 1.0, 0.75, 0.25, 0.0],
    )
    pair = SmoothChange(("depth_mm", "age_days"), ((0.0, 1.0, 3.0), (0.0, 4.0)), ((0.0, 1.0), (1.0, 2.0), (3.0, 4.0)))
    x, y = np.meshgrid([0.0, 0.5, 2.0, 3.0], [0.0, 1.0, 4.0])
    np.testing.assert_allclose(pair(x, y), x + y / 4.0)


def test_a_learned_pair_acts_on_the_force_where_both_are_defined():
    presses = pucks.planned()
    pair = Learned(SmoothChange(("depth_mm", "since_stop_s"), ((0.0, 5.0), (0.0, 5.0)), ((0.1, 0.1), (0.1, 0.1))))
    force = np.ones_like(presses.time_s)
    out = pair.surface(presses, np.maximum(presses.displacement_mm, 0.0), force, {"size": 0.5})
    after = presses.time_s > presses.stop_s[:, None]
    seen = after & (presses.time_s < presses.stop_s[:, None] + 4.9)
    np.testing.assert_allclose(out[seen], 1.05)
    np.testing.assert_array_equal(out[~after], 1.0)
    np.testing.assert_allclose(
        at_nodes("since_stop_s", presses, force, force)[after], (presses.time_s - presses.stop_s[:, None])[after]
    )
    share = at_nodes("depth_share", presses, presses.displacement_mm, force)
    np.testing.assert_allclose(share, np.maximum(presses.displacement_mm, 0.0) / presses.thickness_mm[:, None])
    for name in ("temperature_C", "age_days"):
        np.testing.assert_array_equal(at_nodes(name, presses, force, force)[:, 3], getattr(presses.history, name))


def test_learned_effects_act_by_one_plus_size_times_the_change():
    presses, values = pucks.planned(), {"size": 0.5}
    force = np.full_like(presses.time_s, 4.0)
    for name, act in (("force_N", "sensor"), ("reading_N", "reading")):
        effect = Learned(SmoothChange((name,), ((0.0, 8.0),), (0.0, 0.4)))
        np.testing.assert_allclose(getattr(effect, act)(presses, force, values), 4.0 * 1.1)
    depth, h = np.array([[1.0, 2.0]]), np.array([[8.0]])
    for name, at in (("depth_mm", depth), ("depth_share", depth / h)):
        effect = Learned(SmoothChange((name,), ((0.0, 4.0),), (0.0, 0.4)))
        law = effect.law(pucks.LAW, values)
        np.testing.assert_allclose(law(depth, h), pucks.LAW(depth, h) * (1.0 + 0.05 * at))
    warm = Learned(SmoothChange(("temperature_C",), ((20.0, 30.0),), (0.0, 0.4)))
    scale = warm.scale(presses, force, values)
    np.testing.assert_allclose(scale[:, 0], 1.0 + 0.02 * (presses.history.temperature_C - 20.0))


def test_what_can_be_followed_is_read_off_bins_that_carry_force():
    found = clean_fit()
    presses = found.problem.presses
    seen = followed(presses, found.forces)
    depth = presses.measure(presses.displacement_mm)
    loaded = presses.used & (depth > 0.0) & (found.forces > 0.02 * found.forces.max())
    np.testing.assert_allclose(np.sort(seen["depth_mm"]), np.sort(depth[loaded]))
    np.testing.assert_allclose(np.sort(seen["depth_share"]), np.sort((depth / presses.thickness_mm[:, None])[loaded]))
    assert seen["force_N"].min() > 0.02 * found.forces.max() and seen["force_N"].max() == found.forces[loaded].max()
    assert 0.0 < seen["since_stop_s"].min() < 0.01 and seen["since_stop_s"].max() == pytest.approx(2.2, abs=0.2)
    even = replace(presses.history, temperature_C=np.full(16, 21.0), age_days=np.full(16, np.nan))
    silent = followed(replace(presses, history=even), found.forces)
    assert not {"temperature_C", "age_days"} & set(silent) and "thickness_mm" in silent


def scattered(level, *trials):
    pads = tuple(dict.fromkeys(one.pad for one in trials))
    presses = SimpleNamespace(trials=trials, pads=pads)
    problem = SimpleNamespace(presses=presses, law=puck_law(30.0))
    return SimpleNamespace(problem=problem, sizes=SimpleNamespace(law=(level,)))


def test_a_pads_factor_is_what_its_record_says_of_modulus_and_thickness():
    trials = (
        trial(10.0, factor=1.1, factor_sd=0.02, witness_kPa=30.0, design_thickness_mm=9.5),
        trial(12.0),
        trial(14.0, factor=0.9, factor_sd=0.02, weighed_ratio=15.0),
    )
    stated, known = recorded_ln(scattered(0.02, *trials).problem.presses)
    np.testing.assert_allclose(stated, [np.log(1.1) - np.log(10.0 / 9.5), 0.0, np.log(0.9)])
    assert known.tolist() == [True, False, True]
    spread = recorded_spread(scattered(0.02, *trials).problem.presses)
    assert spread == pytest.approx(np.std(np.log([1.1, 0.9]), ddof=1))
    found = pad_scatter(scattered(0.02, *trials))
    size = np.hypot(2.0, 100.0 * np.std(stated[known], ddof=1))
    assert (found.pads, found.recorded, found.left_percent) == (3, 2, 2.0)
    assert found.size_percent == pytest.approx(size) and found.explained == pytest.approx(1.0 - (2.0 / size) ** 2)
    alone = pad_scatter(scattered(0.02, trials[0], trials[1]))
    assert alone.explained is None and alone.size_percent == 2.0
    assert recorded_spread(scattered(0.02, trials[0], trials[1]).problem.presses) == 0.0


def test_errors_of_readings_are_root_mean_squares_and_named_where_they_make_half_of_the_rest():
    trials = (
        trial(10.0, sd=0.3, factor=1.1, factor_sd=0.01, witness_kPa=30.0),
        trial(20.0, sd=0.8, factor=0.9, factor_sd=0.03, witness_kPa=30.0),
    )
    found = pad_scatter(scattered(0.05, *trials))
    thick = 100.0 * np.sqrt(0.5 * (0.03**2 + 0.04**2))
    assert found.errors == pytest.approx({"thickness": thick, "modulus": 100.0 * np.sqrt(0.5 * (0.01**2 + 0.03**2))})
    for level, named in ((0.01 * thick * np.sqrt(2.0) * 0.99, True), (0.01 * thick * np.sqrt(2.0) * 1.01, False)):
        assert ("thickness" in pad_scatter(scattered(level, *trials)).lower_it) is named


def test_beyond_what_the_law_can_have_a_level_is_the_pads_own():
    median, spread = puck_law(30.0).error_priors[0]
    limit = median * np.exp(1.959964 * spread)
    assert limit == pytest.approx(2.0 * median, rel=0.02)
    plain = trial()
    assert carried_share(scattered(0.9 * limit, plain)) == 1.0
    assert carried_share(scattered(2.0 * limit, plain)) == pytest.approx(0.25)
    read = trial(factor_sd=0.6 * median)
    assert carried_share(scattered(2.0 * limit, read)) == pytest.approx(0.25 * 0.64)
    assert carried_share(scattered(limit, trial(factor_sd=2.0 * median))) == 0.0


def test_the_worth_of_an_effect_is_what_it_changes_at_the_largest_force_and_at_most():
    found = clean_fit()
    effect = effect_named("temperature")
    problem = found.problem.plus(effect)
    size = [p.to_coordinate(0.01) if n == 0 else p.to_coordinate(p.null) for n, p in enumerate(effect.parameters)]
    vector = np.insert(found.vector, 5, size)
    forces = problem.predict(vector)
    fit = replace(found, problem=problem, vector=vector, forces=forces)
    presses = problem.presses
    worth = worth_of(SimpleNamespace(after=SimpleNamespace(fit=fit), presses=presses), effect)
    row, column = np.unravel_index(np.argmax(presses.force_N), presses.force_N.shape)
    assert worth.file == presses.trials[row].file and worth.force_N == forces[row, column]
    change = forces - problem.predict(np.insert(found.vector, 5, [p.to_coordinate(p.null) for p in effect.parameters]))
    assert worth.change_N == pytest.approx(change[row, column])
    most, at = np.unravel_index(np.argmax(np.abs(change) * presses.used), change.shape)
    assert worth.most_N == pytest.approx(change[most, at]) and worth.most_file == presses.trials[most].file
    assert abs(worth.most_N) >= abs(worth.change_N) > 0.01


SLIPS, GIVES, FLAT = "base_that_can_slip", "bulk_that_gives", "flat_faces"


@pytest.mark.parametrize(
    ("shape", "base", "contact", "offers", "grows"),
    [
        ("layered:top=3,modulus_ratio=0.3", "bonded", "bonded", {SLIPS, GIVES, FLAT}, False),
        ("boned:height=3,radius=20,foot=9", "bonded", "bonded", {GIVES, FLAT}, False),
        ("crowned:radius=20,height=3,foot=11", "bonded", "bonded", {SLIPS, GIVES}, True),
        ("layered:top=3,modulus_ratio=0.3", "bonded", "frictionless", {FLAT}, True),
        ("layered:top=3,modulus_ratio=0.3", "sliding", "bonded", {FLAT}, False),
        ("layered:top=3,modulus_ratio=0.3", "friction:0.3", "bonded", {FLAT}, True),
    ],
)
def test_a_solved_pad_offers_what_its_faces_and_its_base_allow(stated, shape, base, contact, offers, grows):
    """Slip where it is glued on a whole base, a bulk where it is glued, flat faces where it is flat; a contact that
    grows cell by cell is rough."""
    pressed = trial(9.0, geometry=read_shape(shape))
    (law,) = campaign_law._laws(set_up(base, contact), [pressed], quiet).values()
    assert law.offers == offers and law.grows is grows
    assert (campaign_law._error_of([law], [pressed])[3][0] > SLAB_ERROR[3][0]) is grows
    # on a base that rubs the modulus decides how the pad slides: 30 kPa
    assert law.pad.young_MPa == pytest.approx(0.03 if base.startswith("friction") else 1.0)
