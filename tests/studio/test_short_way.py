"""From an empty folder to the files of a mould: the clicks, and the seconds by the clock."""

from __future__ import annotations

import os
import time
import zipfile

import pytest

from tests.support.studio import browser, running
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow
MOST_CLICKS = 10


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
        page.wait_for_selector(f"{by('found-suggest')} {by('mould')}")
        searched = time.monotonic() - start
        click(page.locator(f"{by('found-suggest')} {by('mould')}"))
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
