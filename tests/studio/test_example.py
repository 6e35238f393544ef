"""The example project of an empty folder: what it holds, and the way through its first steps by clicks."""

from __future__ import annotations

import pytest

from dummydesign.measurement.campaign_presses import check_campaign
from dummydesign.measurement.trace import read_trace
from dummydesign.project.folder import make_example, read_project
from tests.support.studio import browser, running
from tests.support.studio import test_id as by


def test_the_example_holds_presses_of_the_forefinger_and_a_campaign_that_is_pressed(tmp_path):
    make_example(tmp_path)
    assert read_project(tmp_path).tissue == "forefinger"
    peaks = {}
    for path in (tmp_path / "measured").glob("*.csv"):
        trace = read_trace(path)
        speed, force = (float(part[1:]) for part in path.stem.split("_")[1:])
        assert trace.force_N[-200:].mean() == pytest.approx(force, rel=0.02)
        peaks[speed, force] = trace.force_N.max()
    assert len(peaks) == 6 and all(peaks[250.0, force] > peaks[10.0, force] for force in (5.0, 10.0, 15.0))
    assert check_campaign(tmp_path / "campaigns" / "example").ready


@pytest.mark.slow
def test_one_click_opens_it_and_the_next_buttons_stay_in_sight(tmp_path):
    with (
        running(tmp_path / "new", tmp_path / "home") as studio,
        browser(viewport={"width": 1280, "height": 800}) as page,
    ):
        page.goto(studio.address)
        page.locator(by("example")).click()
        page.wait_for_selector(by("next"))

        def in_sight(test):
            page.wait_for_selector(by(test))
            box = page.locator(by(test)).first.bounding_box()
            assert 0 <= box["y"] and box["y"] + box["height"] <= 800, (test, box)

        page.goto(f"{studio.home}campaign")
        in_sight("learn")
        page.goto(f"{studio.home}measured")
        page.wait_for_selector(by("run-import"))
        page.locator(by("all-files")).click()
        page.wait_for_function("document.querySelectorAll('.q-chip').length === 6")
        page.locator(by("run-import")).click()
        in_sight("to-tissue")
        assert page.locator(by("doubts")).count() == 0
        assert page.outside == [] and page.broken == []
