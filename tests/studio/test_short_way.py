"""From an empty folder to the files of a mould: the clicks, and the seconds by the clock."""

from __future__ import annotations

import os
import time
import zipfile

import pytest

from tests.support.studio import browser, live, running, settled, until
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow
MOST_CLICKS = 8


def test_from_an_empty_folder_to_the_files_of_a_mould(tmp_path):
    """A tissue of the library, the best of all shapes, its mould, one archive; the clock is printed, not tested."""
    clicks = 0
    with running(tmp_path / "thumb", tmp_path / "home") as studio, browser() as page:

        def click(place):
            nonlocal clicks
            clicks += 1
            place.first.click()

        start = time.monotonic()
        page.goto(studio.address)
        click(page.locator(by("tissue")))
        click(page.get_by_role("option", name="forefinger (built-in)", exact=True))
        click(page.locator(by("make")))
        click(page.locator(by("next")))
        page.wait_for_selector('[data-test="verdict"] .verdict')
        click(page.locator(by("run-suggest")))
        page.wait_for_selector(f"{by('next-of-pad')} {by('mould')}")
        searched = time.monotonic() - start
        click(page.locator(f"{by('next-of-pad')} {by('mould')}"))
        click(page.locator(by("run-mould")))
        page.wait_for_selector(f"{by('found-mould')} {by('zip')}")
        with page.expect_download() as download:
            click(page.locator(f"{by('found-mould')} {by('zip')}"))
        download.value.save_as(tmp_path / "mould.zip")
        spent = time.monotonic() - start
        load = os.getloadavg()[0]
        print(f"{clicks} clicks, {spent:.0f} s by the clock, {searched:.0f} s of them to the pad, load {load:.1f}")
        assert page.outside == [] and page.broken == []
    with zipfile.ZipFile(tmp_path / "mould.zip") as archive:
        names = [name.rpartition("/")[2] for name in archive.namelist()]
    assert any(name.endswith(".step") for name in names) and any(name.endswith(".pdf") for name in names)
    assert clicks <= MOST_CLICKS


def test_the_short_way_goes_by_the_keyboard_alone(tmp_path):
    """Tab, Enter and arrows from the empty folder to the archive; the focus is never lost, and no control keeps it."""
    with running(tmp_path / "thumb", tmp_path / "home") as studio, browser() as page:

        def focused():
            return page.evaluate("document.activeElement !== document.body && document.activeElement.isConnected")

        def tab_to(selector):
            page.wait_for_selector(selector)
            for _ in range(600):
                page.keyboard.press("Tab")
                if page.evaluate("(words) => document.activeElement.matches(words)", selector):
                    return
            raise AssertionError(f"Tab does not reach {selector}")

        def opened(title):
            page.wait_for_selector(f"h1 >> text={title}")
            live(page)
            page.keyboard.press("Tab")
            assert page.evaluate("document.activeElement.textContent") == "to the content", title
            page.keyboard.press("Enter")
            assert page.evaluate("document.activeElement.id") == "body", title

        page.goto(studio.address)
        opened("New project")
        tab_to(f"{by('tissue')}, {by('tissue')} input, label:has({by('tissue')}) input")
        page.keyboard.press("Enter")
        for _ in range(20):
            if "forefinger (built-in)" in page.locator('[role="option"].q-manual-focusable--focused').all_inner_texts():
                break
            page.keyboard.press("ArrowDown")
            page.wait_for_timeout(200)
        page.keyboard.press("Enter")
        page.wait_for_selector(".q-menu", state="detached")
        assert focused()
        tab_to(by("make"))
        page.keyboard.press("Enter")
        page.wait_for_selector(by("next"))
        opened("Overview")
        tab_to(by("next"))
        page.keyboard.press("Enter")
        page.wait_for_selector('[data-test="verdict"] .verdict')
        opened("Design")
        tab_to(by("number-thickness"))
        page.keyboard.type("7")
        page.keyboard.press("Enter")
        page.wait_for_selector(f"{by('verdict')} [data-state=settled] >> text=slab, 7 mm")
        assert page.evaluate("(words) => document.activeElement.matches(words)", by("number-thickness"))
        tab_to(by("run-suggest"))
        page.keyboard.press("Enter")
        page.wait_for_selector(f"{by('found-suggest')} {by('why')}")
        page.wait_for_selector(f"{by('verdict')} [data-state=settled]")
        assert until(focused, page, 30)
        tab_to(f"{by('next-of-pad')} {by('mould')}")
        page.keyboard.press("Enter")
        opened("Mould")
        tab_to(by("run-mould"))
        page.keyboard.press("Enter")
        page.wait_for_selector(f"{by('found-mould')} {by('zip')}")
        assert until(focused, page, 30)
        tab_to(f"{by('found-mould')} {by('zip')}")
        with page.expect_download() as download:
            page.keyboard.press("Enter")
        assert download.value.suggested_filename.endswith(".zip")
        wide = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
        for path in ("design", "mould"):
            page.set_viewport_size({"width": 390, "height": 844})
            page.goto(f"{studio.home}{path}")
            live(page)
            settled(page)
            assert page.evaluate(wide) <= 0, path
