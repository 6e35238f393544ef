"""Presses deeper than the force law of their pad leave a fit, and are named."""

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.model.campaign_law import BEYOND, within_reach
from dummydesign.measurement.campaign_file import read_campaign
from tests.support.refusal import raises_code


def ends_at(share: float) -> SimpleNamespace:
    """A law that holds to a share of every pad's thickness."""
    return SimpleNamespace(limit_of=lambda trials: share * np.array([trial.thickness_mm for trial in trials]))


@pytest.fixture(scope="module")
def read(campaigns):
    campaign = read_campaign(campaigns("none", 431))
    return campaign, make_presses(campaign)


def test_a_law_that_holds_every_press_leaves_the_campaign_as_it_is(read):
    campaign, presses = read
    assert within_reach(campaign, presses, ends_at(1.0)) == (campaign, presses, "")


def test_presses_deeper_than_their_law_leave_and_are_named(read):
    campaign, presses = read
    share = presses.depth_mm / presses.thickness_mm
    end = float(np.median(share)) / BEYOND
    own, kept, said = within_reach(campaign, presses, ends_at(end))
    deep = share > BEYOND * end
    assert 0 < deep.sum() < len(deep) and len(own.trials) == len(kept.trials) == (~deep).sum()
    assert (kept.depth_mm / kept.thickness_mm <= BEYOND * end).all()
    assert said.startswith(f"{deep.sum()} of {len(deep)} presses are left out")
    assert all((trial.file in said) == out for trial, out in zip(presses.trials, deep))


def test_a_campaign_that_is_all_too_deep_is_refused_in_one_line(read):
    campaign, presses = read
    with raises_code("out_of_range", "displacement_mm") as refused:
        within_reach(campaign, presses, ends_at(0.01))
    assert "\n" not in str(refused.value) and "press less deep" in str(refused.value)
