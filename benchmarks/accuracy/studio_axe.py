"""What axe-core says of the studio's pages: ``python -m benchmarks.accuracy.studio_axe --axe axe.min.js``

``npm pack axe-core`` brings the file (MPL-2.0; it is run, not shipped). Every page of a project half-way through is
looked at in light and dark, on a screen and on a phone; each finding is printed with its first element.
"""

from __future__ import annotations

import argparse
from itertools import product
from pathlib import Path
from typing import Any

from benchmarks.rows import scratch
from tests.support.lab_project import lab_project
from tests.support.studio import browser, running

PAGES = ("", "measured", "tissue", "design", "resin", "mould", "cast", "campaign", "learn")
SIZES = ({"width": 1280, "height": 900}, {"width": 390, "height": 844})
SETTLE_MS = 2500
RUN = """axe.run(document).then((found) => ({rules: found.passes.length, faults: found.violations.map(
    (one) => [one.id, one.impact, one.nodes.length, one.nodes[0].html.slice(0, 120)])}))"""


def main() -> None:
    """Print what is found, and how many rules had something to look at."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--axe", type=Path, required=True)
    script = parser.parse_args().axe.read_text(encoding="utf-8")
    looked, faults = [], 0
    with scratch("axe-") as base, running(lab_project(base / "thumb"), base / "home") as studio:
        for scheme, size in product(("light", "dark"), SIZES):
            with browser(viewport=size, color_scheme=scheme) as tab:
                page: Any = tab
                page.goto(studio.address)
                for name in PAGES:
                    page.goto(studio.home + name)
                    page.wait_for_selector("h1")
                    page.wait_for_timeout(SETTLE_MS)
                    page.evaluate(script)
                    found = page.evaluate(RUN)
                    looked.append(found["rules"])
                    faults += len(found["faults"])
                    for fault in found["faults"]:
                        print(scheme, size["width"], name or "overview", *fault)
    print(f"{faults} findings on {len(looked)} views; {min(looked)} to {max(looked)} rules had something to look at")


if __name__ == "__main__":
    main()
