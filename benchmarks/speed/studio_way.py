"""Where the seconds go from an empty folder to a mould's archive: ``python -m benchmarks.speed.studio_way``.

Clicks as a user does, in Chromium. Of each command: the time from the click until its process was started, until it
ran, until it ended, and until its answer was on the page, by the clock. All steps are listed with when they began.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from pathlib import Path
from threading import Event, Thread
from typing import Any

from tests.support.studio import browser, running
from tests.support.studio import test_id as by


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as base:
        folder, home = Path(base) / "thumb", Path(base) / "home"
        with running(folder, home) as studio, browser(viewport={"width": 1280, "height": 800}) as opened:
            page: Any = opened
            steps, ended = Steps(folder), Event()
            watch = Thread(target=steps.watch, args=(ended,), daemon=True)
            watch.start()
            start = time.time()

            def note(words: str) -> None:
                print(f"{time.time() - start:6.1f} s  {words}", flush=True)

            page.goto(studio.address)
            page.locator(by("tissue")).click()
            page.get_by_role("option", name="forefinger (built-in)", exact=True).click()
            page.locator(by("make")).click()
            page.locator(by("next")).click()
            page.wait_for_selector('[data-test="verdict"] .verdict')
            note("the design page has a verdict")
            for name, found in (("suggest", ("next-of-pad", "mould")), ("mould", ("found-mould", "zip"))):
                page.locator(by(f"run-{name}")).click()
                clicked = time.time()
                note(f"{name} was clicked")
                page.wait_for_selector(f"{' '.join(map(by, found))}")
                seen = time.time()
                note(f"{name}: its answer is on the page")
                for job in (folder / ".studio" / "jobs").glob(f"*-{name}"):
                    asked, status = (json.loads((job / one).read_text()) for one in ("command.json", "status.json"))
                    times = asked["start"] - clicked, status["start"] - asked["start"], status["end"] - status["start"]
                    words = "{:.2f} s to the job, {:.2f} s to its process, {:.2f} s at work".format(*times)
                    print(f"          {words}, {seen - status['end']:.2f} s to the page")
                page.locator(f"{' '.join(map(by, found))}").first.click()
            note("the archive is asked for")
            ended.set()
            watch.join()
            for moment, words in steps.seen:
                print(f"{moment - start:6.1f} s    {words}")
            print(f"load {os.getloadavg()[0]:.1f}")


class Steps:
    """What the commands write on their progress."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.seen = folder, [(time.time(), "start")]

    def watch(self, ended: Event) -> None:
        """Look often, until the end."""
        while not ended.wait(0.05):
            for path in sorted((self.folder / ".studio" / "jobs").glob("*/progress.txt"))[-1:]:
                words = f"{path.parent.name}: {path.read_text(encoding='utf-8').rpartition(', about')[0]}"
                if words != self.seen[-1][1]:
                    self.seen.append((time.time(), words))


if __name__ == "__main__":
    main()
