"""A rounded edge that is not declared: the force by another code's curves, and campaigns made of them."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.cross_validation import effect_intervals
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import independent_generator
from tests.support.known_laws import slab_law
from tests.support.named_effects import effect_named

FILLET_MM, RADIUS_MM = 0.5, 7.9  # of the punch of GetFEM's curves


@pytest.mark.parametrize("thickness_mm", [6.0, 10.0, 16.0])
def test_the_force_under_a_rounded_edge_is_that_of_another_code(thickness_mm):
    law, h = slab_law(RADIUS_MM), np.array([[thickness_mm]])
    depth = thickness_mm * np.array([[0.005, 0.02, 0.05, 0.1, 0.15, 0.2]])
    sharp = law(depth, h)
    other = independent_generator._layer(thickness_mm, depth[0])
    rounded = effect_named("punch_edge").law(law, {"edge_radius_mm": FILLET_MM})(depth, h)
    assert np.abs(sharp[0] / other - 1.0)[0] > 0.1
    np.testing.assert_allclose(rounded[0], other, rtol=0.003)


def test_a_smaller_edge_is_nearer_to_the_sharp_one_and_none_is_none():
    law, h = slab_law(RADIUS_MM), np.array([[8.0]])
    depth = np.linspace(0.01, 1.6, 40)[None]
    factors = [law.edge_factor(edge, depth, h) for edge in (0.0, 0.05, 0.2, 0.6, 2.0)]
    assert np.all(factors[0] == 1.0)
    assert np.all(np.diff(np.stack(factors), axis=0) < 0.0)


@pytest.mark.slow
def test_it_is_undefined_where_the_edge_is_declared_and_defined_where_it_is_not(tmp_path):
    from dummydesign.loop.data.trials import stack
    from dummydesign.loop.model.campaign_law import law_of

    campaign = undeclared(tmp_path, 961001)
    presses, law = stack(campaign.trials, campaign.lowpass), law_of(campaign)
    assert effect_named("punch_edge").undefined(presses, law) == ""
    assert "sharp edge" in effect_named("punch_edge").undefined(
        presses, type("Declared", (), {"shape": "slab", "offers": frozenset({"flat_faces"})})()
    )


def undeclared(folder, seed):
    independent_generator.write_campaign(folder / "a", (), seed)
    plan = folder / "a" / "campaign.toml"
    text = plan.read_text()
    assert f"edge_radius_mm = {FILLET_MM}\n" in text
    plan.write_text(text.replace(f"edge_radius_mm = {FILLET_MM}\n", ""))
    return read_campaign(folder / "a")


@pytest.mark.slow
def test_a_rounded_edge_that_is_not_declared_is_named_and_sized(tmp_path):
    result = close_loop(undeclared(tmp_path, 961000))
    assert [one.candidate.effect.name for one in result.effects] == ["punch_edge"]
    assert result.verdict == "effect"
    found = effect_intervals(result.after, effect_named("punch_edge"))["edge_radius_mm"]["value"]
    assert found == pytest.approx(FILLET_MM, rel=0.3)
