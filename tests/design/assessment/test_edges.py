"""A best design at the end of a range: advice that can be followed."""

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.assessment.warnings import _edges
from dummydesign.resin.model.resin_file import load_resin


@pytest.mark.parametrize(
    ("resin", "ratios", "best", "thickness", "words"),
    [
        ("polyurethane-nagoya", (14.0, 20.0), 14.0, 10.0, ["softer resin"]),
        ("polyurethane-nagoya", (14.0, 20.0), 20.0, 10.0, ["stiffer resin"]),
        ("polyurethane-nagoya", (14.5, 16.0), 14.5, 10.0, ["widen --ratio"]),
        ("ecoflex-00-10", (0.0, 100.0), 0.0, 10.0, ["stiffer resin"]),  # thinner softens
        ("ecoflex-00-10", (0.0, 100.0), 100.0, 10.0, ["softer resin"]),
        ("polyurethane-nagoya", (14.0, 20.0), 15.0, 4.0, ["widen --thickness"]),
        ("polyurethane-nagoya", (14.0, 20.0), 15.0, 12.0, ["no thicker pad"]),  # a wider range is refused
        ("polyurethane-nagoya", (14.0, 20.0), 15.0, 10.0, []),
    ],
)
def test_the_advice_is_possible(resin, ratios, best, thickness, words):
    space = SimpleNamespace(
        resin=load_resin(resin),
        ratio=np.array([ratios[0], 15.0, ratios[1]]),
        thickness_mm=np.array([4.0, 10.0, 12.0]),
        allowed_mm=(3.0, 12.0),
    )
    notes = _edges(SimpleNamespace(ratio=best, thickness_mm=thickness), space)
    assert [code for code, _ in notes] == ["at_edge"] * len(words)
    assert all(word in text for word, (_, text) in zip(words, notes))
    ends = {"softer": min, "stiffer": max}
    for word in (name for name in ends if words and name in words[0]):
        own = [float(space.resin.young_MPa(end)) for end in ratios]
        assert float(space.resin.young_MPa(best)) == ends[word](own)
