"""A headless Chromium for the tests: opens a page, gives its final DOM, console messages and requests."""

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")


@dataclass(frozen=True)
class Visit:
    """What a page did."""

    dom: str
    console: list[str]
    requests: list[str]


def chromium() -> str:
    """Path of the browser, or skip the test and say so."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip("no Chromium here: the page is not tested in a browser (Debian: apt-get install chromium)")
    return found


def visit(url: str, folder: Path, *more: str) -> Visit:
    """Open a page in a fresh profile and read what it did once its scripts have run."""
    log = folder / "net.json"
    command = [
        chromium(),
        "--headless=new",
        "--no-sandbox",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--disable-features=NetworkTimeServiceQuerying,OptimizationHints",
        "--no-first-run",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        f"--user-data-dir={folder / 'profile'}",
        f"--log-net-log={log}",
        "--enable-logging=stderr",
        "--virtual-time-budget=3000",
        "--dump-dom",
        *more,
        url,
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-2000:]
    console = [line for line in done.stderr.splitlines() if ":CONSOLE" in line]
    return Visit(done.stdout, console, _requests(log))


def _requests(log: Path) -> list[str]:
    """Addresses that the network stack was asked for on behalf of a page."""
    # one event a line; the last lines are missing when the browser ends before it closes the log
    lines = (line.rstrip(",") for line in log.read_text(encoding="utf-8").splitlines())
    events = [json.loads(line) for line in lines if line.startswith('{"params"') and line.endswith("}")]
    assert events, "the browser kept no log of its requests"
    asked = [event["params"] for event in events if "url" in event["params"] and "initiator" in event["params"]]
    # the browser's own errands (its clock, its updates) have no origin
    found = [params["url"] for params in asked if params["initiator"] != "not an origin"]
    return sorted({url for url in found if not url.startswith(("file:", "data:"))})
