"""Round pads under a punch with a fillet, as campaigns take them: GetFEM, limits, what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.loop.model import campaign_pad_law
from dummydesign.loop.model.campaign_law import CampaignLaw, law_of
from dummydesign.loop.model.campaign_pad_law import CampaignPadLaw
from dummydesign.measurement.campaign import check_edge
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.pad.axisymmetric.shaped_pad import least_fillet_mm, solve_shaped_pad
from dummydesign.pad.pad_under_punch import Pad
from studies.verification.contact import GLUED_CROWN_N
from tests.support.refusal import raises_code

CROWN = Crowned(20.0, 3.0, 11.0)
RADIUS_MM = 7.9


@pytest.fixture
def campaign(campaigns):
    """A campaign of slabs under a square of 14 mm."""
    return read_campaign(campaigns("none", 401))


def unit(pad: Pad, deepest: float, share) -> np.ndarray:
    """F / E of a pad at depths over its thickness."""
    depth = pad.thickness_mm * np.array(share)
    return CampaignPadLaw(pad, deepest * pad.thickness_mm)(depth[None], np.array([[pad.thickness_mm]]))[0]


@pytest.mark.slow
def test_a_campaign_s_law_of_a_crown_under_a_fillet_agrees_with_getfem():
    pad = Pad(4.5, 1.0, RADIUS_MM, extent_mm=75.7, edge_radius_mm=0.5, geometry=Crowned(21.2, 2.0, 9.4))
    force = 0.03 * unit(pad, 0.32, list(GLUED_CROWN_N))
    np.testing.assert_allclose(force, list(GLUED_CROWN_N.values()), rtol=0.01)


@pytest.mark.slow
def test_under_a_small_fillet_a_crown_is_as_under_the_sharp_edge_and_under_a_large_one_softer_where_it_touches_it():
    curves = [
        solve_shaped_pad(Pad(7.0, 1.0, RADIUS_MM, geometry=CROWN, edge_radius_mm=edge), [0.4, 1.4, 2.1], cells=8)
        for edge in (0.0, 0.01, 1.0)
    ]
    sharp, small, large = (curve.force_N for curve in curves)
    np.testing.assert_allclose(small, sharp, rtol=1e-3)
    stated = curves[0].error_N + curves[2].error_N
    assert abs(large[0] - sharp[0]) < stated[0], "the contact has not come to the edge"
    assert sharp[2] - large[2] > max(stated[2], 0.05 * sharp[2])


@pytest.mark.slow
@pytest.mark.parametrize("geometry", [CROWN, Layered(3.0, 0.3)], ids=["crowned", "layered"])
def test_fillets_smaller_than_can_be_followed_join_those_that_are_without_a_jump(geometry):
    pad = Pad(10.0, 1.0, RADIUS_MM, geometry=geometry)
    depth, least = [1.0, 2.0], least_fillet_mm(pad)
    below, above = (
        solve_shaped_pad(replace(pad, edge_radius_mm=edge), depth, cells=8).force_N
        for edge in (least * (1 - 1e-6), least)
    )
    np.testing.assert_allclose(below, above, rtol=1e-5)


@pytest.mark.slow
def test_what_effects_change_of_a_crown_under_a_fillet_is_solved_with_the_fillet(monkeypatch):
    """On a base that slides a crown under a large fillet is softer, by another share than under the sharp edge."""
    # Before the contact is at the edge the shares differ by 0.8 %; the usual (10, 13) cells add 0.3 %.
    monkeypatch.setattr(campaign_pad_law, "RATIO_CELLS", (16, 20))
    share = {}
    for edge in (0.0, 2.0):
        pad = Pad(7.0, 1.0, RADIUS_MM, geometry=CROWN, edge_radius_mm=edge)
        curve = CampaignLaw({(str(CROWN), 7.0): CampaignPadLaw(pad, 2.1)})
        depth, h = np.array([[0.5, 2.0]]), np.array([[7.0]])
        share[edge] = (curve.sliding()(depth, h) / curve(depth, h))[0]
    assert np.all(share[2.0] < 0.9)
    assert share[2.0][0] == pytest.approx(share[0.0][0], rel=0.01)
    assert abs(share[2.0][1] / share[0.0][1] - 1.0) > 0.02


@pytest.mark.slow
def test_a_campaign_with_a_declared_fillet_takes_the_law_with_it(campaign):
    punch = replace(campaign.punch, shape="round", side_mm=None, diameter_mm=2.0 * RADIUS_MM)
    trials = tuple(replace(t, geometry=CROWN, thickness_mm=10.0) for t in campaign.trials[:2])
    depth, h = np.full((2, 1), 3.0), np.full((2, 1), 10.0)
    sharp, filleted = (
        law_of(replace(campaign, trials=trials, punch=replace(punch, edge_radius_mm=edge))).on(trials)(depth, h)
        for edge in (0.0, 1.0)
    )
    assert np.all(filleted < 0.98 * sharp)


BOWL = Boned(20.0, 3.0, 9.0)


@pytest.mark.parametrize(
    ("base", "contact", "shape", "solved"),
    [
        ("bonded", "bonded", CROWN, True),
        ("sliding", "bonded", CROWN, True),
        ("sliding", "bonded", Layered(3.0, 0.3), True),
        ("bonded", "bonded", BOWL, True),
        ("sliding", "bonded", BOWL, False),
        ("bonded", "frictionless", CROWN, False),
        ("bonded", "friction:0.3", CROWN, False),
        ("friction:0.3", "bonded", CROWN, False),
        ("bonded", "bonded", Crowned(10.0, 2.0, ridge=1.0), False),
    ],
)
def test_a_fillet_is_taken_where_the_elements_solve_it_and_refused_elsewhere(campaign, base, contact, shape, solved):
    pad, punch = replace(campaign.pad, base=base), replace(campaign.punch, contact=contact, edge_radius_mm=0.5)
    if solved:
        check_edge(pad, punch, [shape])
        made = Pad(10.0, 1.0, punch.radius_mm, base=base, condition=contact, geometry=shape, edge_radius_mm=0.5)
        assert np.all(solve_shaped_pad(made, [0.3, 0.6], cells=6).force_N > 0.0)
        return
    with raises_code("unsupported", "edge_radius_mm"):
        check_edge(pad, punch, [shape])
