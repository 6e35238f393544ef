"""The live page of measured curves against Python: ranges between the presses that were made, and what was not."""

import json
import re

import numpy as np
import pytest

from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.sweep.live_data import live_data
from dummydesign.report.page import script_json
from dummydesign.report.whatif import live_scripts
from dummydesign.resin import load_resin
from dummydesign.tissue import load_tissue
from dummydesign.tissue.adding.from_curves import add_curves
from tests.support.browser import visit
from tests.support.fung_people import PEOPLE, write_table

STATES = [(5.0, 10.0), (10.0, 250.0), (12.3, 250.0), (7.7, 60.0), (15.0, 12.0), (3.0, 10.0), (10.0, 500.0)]
"""Steady force and speed; the last two were not pressed. [N, mm/s]"""


@pytest.fixture(scope="module", params=[10.0, 2.0], ids=["hold of 10 s", "hold of 2 s"])
def computed(request, tmp_path_factory):
    """What the page computes of each state, the people, and the hold."""
    folder = tmp_path_factory.mktemp("live")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DUMMYDESIGN_HOME", str(folder / "home"))
        table = folder / "fung.csv"
        write_table(table, PEOPLE)
        add_curves("fung", str(table), "none", "5")
        people = load_tissue("fung")
    data = live_data(load_resin(), people, Sampling(hold_s=request.param))
    states = [
        {"ratio": 15.0, "thickness_mm": 8.0, "radius_mm": 7.9, "square": True, "velocity_mm_s": v, "force_N": f,
         "base": "bonded"} for f, v in STATES
    ]  # fmt: skip
    script = (
        f"const data = {script_json(data)}, at = [0.003, 0.01, 0.1, 1];"
        f"const out = {script_json(states)}.map((s) => {{ const r = DD.compute(data, s), b = r.range;"
        "if (b) r.ends = at.map((t) => [DD.interp(t, b.grid, b.low), DD.interp(t, b.grid, b.high)]);"
        "r.rest = [0, 0.5, 1.5].map((x) => data.tissue.subjects.map((p) => DD.restForce(data.tissue.law, p, x)));"
        "delete r.press; delete r.range; delete r.curve; return r; });"
        "document.getElementById('out').textContent = JSON.stringify(out);"
    )
    page = folder / "check.html"
    page.write_text(f"<pre id=out></pre><script>{live_scripts()[0]}</script><script>{script}</script>")
    seen = visit(page.as_uri(), folder)
    assert not seen.console
    return json.loads(re.search(r"<pre id=\"out\">(.*?)</pre>", seen.dom, re.S)[1]), people, request.param


@pytest.mark.parametrize("index", range(5))
def test_page_and_python_have_the_same_ranges(computed, index):
    found, people, hold = computed
    force, speed = STATES[index]
    band, page = people.force_range(force, speed, hold), found[index]
    assert page["tissue_peak_low_N"] == pytest.approx(band.peak_low_N, rel=1e-4)
    assert page["tissue_peak_high_N"] == pytest.approx(band.peak_high_N, rel=1e-4)
    assert [page["tissue_depth_low_mm"], page["tissue_depth_high_mm"]] == pytest.approx(
        [band.depth_mm.min(), band.depth_mm.max()], rel=1e-4
    )
    at = [0.003, 0.01, 0.1, 1.0]
    ends = np.stack([np.interp(at, band.time_s, band.low_N), np.interp(at, band.time_s, band.high_N)], axis=1)
    np.testing.assert_allclose(page["ends"], ends, rtol=1e-3)
    assert 0.0 <= page["inside_fraction"] <= 1.0


def test_a_press_that_was_not_made_has_no_range_and_says_what_was(computed):
    for page in computed[0][5:]:
        assert "ends" not in page and "all were pressed --force within" in page["tissue_limit"]
        assert page["peak_force_N"] > 0.0


def test_the_steady_curves_of_the_page_are_those_of_the_people(computed):
    found, people, hold = computed
    rest = [[float(one.steady_N(x, hold)) for one in people.parameter_sets] for x in (0.5, 1.5)]
    wanted = [[0.0] * len(rest[0]), *rest]
    np.testing.assert_allclose(found[0]["rest"], wanted, rtol=1e-6)
