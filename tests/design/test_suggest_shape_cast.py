"""A shaped recommendation is judged by the law of the pad as it is cast, not by that of the search."""

import numpy as np
import pytest

from dummydesign.design.plot_data import press_pictures, reactions
from dummydesign.design.request import Request
from dummydesign.design.search.shape_family import FamilyLaw
from dummydesign.design.suggest import suggest
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.report.suggest import write_suggestion

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def crowned():
    """A crowned pad for the forefinger by its response table."""
    limits = {"thickness_mm": (4.0, 5.0), "ratio": (15.0, 16.0)}
    return suggest(Request("forefinger", shape="crowned", verify=False, **limits))


def bars(found):
    return {item.name: (item.depth_percent, item.peak_percent) for item in found}


@pytest.mark.slow
def test_the_law_of_the_cast_pad_comes_with_the_answer(crowned):
    assert isinstance(crowned.law, FamilyLaw) and not crowned.law.cast
    assert isinstance(crowned.cast, FamilyLaw) and crowned.cast.cast and crowned.cast.shape == crowned.shape
    thicker = crowned.best.thickness_mm + 0.2
    depth = 0.3 * crowned.best.thickness_mm
    force = [float(law.force(depth, thicker, 0.04, PUNCH_RADIUS_MM)) for law in (crowned.law, crowned.cast)]
    assert abs(force[0] / force[1] - 1.0) > 1e-3


def test_the_reports_bars_are_those_of_the_cast_pad(crowned, tmp_path):
    cast, searched = (bars(reactions(crowned, law)) for law in (crowned.cast, crowned.law))
    (name,) = (name for name in cast if name.startswith("thickness"))
    assert not np.allclose(cast[name], searched[name], atol=0.05)
    result = {
        **crowned.to_dict(),
        "inputs": crowned.request.to_dict(),
        "warnings": [],
        "files": {},
        "next": [{"do": "cast the pad", "command": ""}],
    }
    pictures = press_pictures(crowned)
    write_suggestion(tmp_path, crowned, result, pictures)
    page = (tmp_path / "report.html").read_text()
    low, high = cast[name][0]
    assert f"Change of depth at 10 N, 10 mm/s: {name} {low:.1f} to {high:.1f} %" in page


def test_a_slab_is_cast_as_it_was_searched():
    answer = suggest(Request("forefinger", shape="slab", verify=False, thickness_mm=(5.0, 5.0), ratio=(15.0, 16.0)))
    assert answer.cast is answer.law
