"""Campaigns from the independent generator, made once for all tests of the loop."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def campaigns(tmp_path_factory):
    """A function that writes (once) a campaign with an effect and returns its folder."""
    from tests.support import campaign_generator as generator

    made = {}

    def make(effect: str, seed: int, strength: float = 1.0, held_out: bool = False) -> Path:
        key = (effect, seed, strength, held_out)
        if key not in made:
            folder = tmp_path_factory.mktemp("campaign") / effect
            size = {**generator.SIZES, **generator.UNKNOWN}.get(effect, 0.0) * strength
            generator.write_campaign(folder, effect, size, seed, held_out)
            made[key] = folder
        return made[key]

    return make


@pytest.fixture(scope="session")
def plain(campaigns):
    """Presses and law of a campaign without an effect."""
    from dummydesign.loop.data.trials import make_presses
    from dummydesign.loop.model.campaign_law import law_of
    from dummydesign.measurement.campaign_file import read_campaign

    campaign = read_campaign(campaigns("none", 401))
    return make_presses(campaign), law_of(campaign)
