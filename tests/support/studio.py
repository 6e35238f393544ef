"""A studio that runs as a user starts it, and a browser that looks at it."""

from __future__ import annotations

import csv
import http.client
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.support.browser import chromium

PACKAGE = Path(__file__).parents[2]


@dataclass(frozen=True)
class Running:
    """A studio at work: the address that it printed, the one its pages lie under, and the cookie they need."""

    process: subprocess.Popen[str]
    address: str
    home: str
    cookie: str

    @property
    def key(self) -> str:
        return self.address.partition("key=")[2]


COMMAND_MS = 900_000
"""For what a command does that a page started, on a busy machine. [ms]"""


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "dummydesign", "studio", *words, "--no-browser"]


def surroundings(home: Path) -> dict[str, str]:
    """The environment: this checkout, an empty folder of the user's own data."""
    path = os.pathsep.join(filter(None, (str(PACKAGE), os.environ.get("PYTHONPATH"))))
    return {**os.environ, "PYTHONPATH": path, "DUMMYDESIGN_HOME": str(home)}


@contextmanager
def running(folder: Path, home: Path, *words: str) -> Iterator[Running]:
    """Start a studio on a folder and end it by its own process id."""
    process = subprocess.Popen(
        command(str(folder), *words), stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=surroundings(home)
    )
    try:
        line = process.stderr.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/\?key=\S+", line)
        assert found, line + process.stderr.read()
        _answers(found[0])
        yield Running(process, found[0], *welcomed(found[0]))
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            process.communicate(timeout=120)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def welcomed(address: str) -> tuple[str, str]:
    """Open the address that a studio printed; return where its pages lie, and the cookie."""
    parts = urlsplit(address)
    link = http.client.HTTPConnection(parts.netloc, timeout=60)
    try:
        link.request("GET", f"/?{parts.query}")
        answer = link.getresponse()
        assert answer.status == 303, answer.status
        home = f"http://{parts.netloc}{answer.headers['location']}"
        return home, answer.headers["set-cookie"].partition(";")[0]
    finally:
        link.close()


def _answers(address: str) -> None:
    import urllib.error
    import urllib.request

    for _ in range(2400):
        try:
            urllib.request.urlopen(address.partition("?")[0], timeout=5)
        except urllib.error.HTTPError as said:
            assert said.code == 403
            return
        except OSError:
            time.sleep(0.25)
    raise AssertionError("the studio does not answer")


@contextmanager
def browser(**options: object) -> Iterator[object]:
    """A page of a fresh Chromium; requests to anywhere but this machine are kept in ``page.outside``."""
    playwright = pytest.importorskip("playwright.sync_api", reason="no Playwright here: pip install playwright")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        context = opened.new_context(accept_downloads=True, **options)
        page = context.new_page()
        page.outside, page.broken = [], []
        page.on("request", lambda asked: _note(page, asked.url))
        page.on("pageerror", lambda error: page.broken.append(str(error)))
        page.set_default_timeout(240_000)
        try:
            yield page
        finally:
            opened.close()


def _note(page: object, url: str) -> None:
    if not re.match(r"(http://127\.0\.0\.1:\d+/|data:|blob:|about:)", url):
        page.outside.append(url)


def processor_s(number):
    """Processor seconds of a process so far, user and system; None where the system does not tell."""
    try:
        words = Path(f"/proc/{number}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return None
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def test_id(name: str) -> str:
    return f'[data-test="{name}"]'


test_id.__test__ = False


def live(page):
    """Wait until a page is connected to its studio: what is done before is lost."""
    page.wait_for_selector("h1")
    page.wait_for_function("window.did_handshake === true")


def opened(page, studio, path):
    """Open a page of a studio and its root."""
    page.goto(f"{studio[0].home}{path}")
    live(page)


def until(true, page=None, seconds=600.0):
    """Wait until something is true, ``seconds`` at most, and return it; a page goes on meanwhile."""
    deadline = time.monotonic() + seconds
    while not (found := true()) and time.monotonic() < deadline:
        page.wait_for_timeout(50) if page else time.sleep(0.05)
    return found


def settled(page) -> None:
    """Wait until the page has been the same for a second, 20 seconds at most."""
    before = ""
    for _ in range(20):
        now = page.evaluate("document.body.innerHTML")
        if now == before:
            return
        before = now
        page.wait_for_timeout(1000)


def unfold(page, test):
    """Open a folded part."""
    page.locator(f"{test_id(test)} > .q-expansion-item__container > .q-item").click()


def choose(page, test, name):
    """Choose what a field offers."""
    page.locator(test_id(test)).click()
    page.get_by_role("option", name=name, exact=True).click()


def saved(page, place, kind):
    """Save the first plot of a place as ``csv`` or ``png``; return the content of the file."""
    page.wait_for_selector(f"{place} {test_id(f'save-{kind}')}")
    with page.expect_download() as found:
        page.locator(f"{place} {test_id(f'save-{kind}')}").first.click()
    return found.value.path().read_bytes()


def saved_series(page, place):
    """Number of points of each series in the CSV of the first plot of a place."""
    rows = list(csv.reader(saved(page, place, "csv").decode("utf-8").splitlines()))[1:]
    assert all(math.isfinite(float(number)) for row in rows for number in row[1:] if number)
    return Counter(row[0] for row in rows)
