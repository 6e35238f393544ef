"""From a move of a slider to the new plots, by the clock in Chromium: ``python -m benchmarks.speed.slider_latency``.

Each kind of pad is moved many times; the middle and the 95 % quantile are printed with the load of the machine.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.project.folder import make_project
from tests.support.studio import browser, running

MOVE = """([name, value]) => new Promise((done) => {
    const plots = document.querySelector('[data-test="plots"]'), start = performance.now();
    const end = () => { watch.disconnect(); done((performance.now() - start) / 1e3); };
    const watch = new MutationObserver(end);
    setTimeout(end, 5000);
    watch.observe(plots, {childList: true, subtree: true, characterData: true});
    const slider = document.querySelector(`[data-test="slide-${name}"]`);
    slider.value = value; slider.dispatchEvent(new Event('input', {bubbles: true})); })"""
PADS = {
    "slab": "slab",
    "crowned": "crowned:20,2,9",
    "bumped": "bumped:5.5,3.2,1.36,0.48",
    "layered": "layered:4,1.5",
    "boned": "boned:20.57,2.2,9.3",
}
SETTLED = '[data-test="verdict"] .verdict[data-state="settled"]'


def main(moves: int = 60, seed: int = 20261123) -> None:
    """Measure and print."""
    draw = np.random.default_rng(seed)
    every: list[float] = []
    with tempfile.TemporaryDirectory() as base:
        make_project(Path(base) / "thumb", tissue="forefinger")
        with running(Path(base) / "thumb", Path(base) / "home") as studio, browser() as opened:
            page: Any = opened
            page.goto(studio.address)
            for kind, shape in PADS.items():
                page.goto(f"{studio.home}design?shape={shape}&thickness_mm=9&ratio=15")
                page.wait_for_selector(SETTLED)
                page.wait_for_timeout(800)
                taken = []
                for _ in range(moves):
                    name, low, high = ("thickness", 7.0, 10.5) if draw.random() < 0.5 else ("ratio", 14.5, 18.0)
                    step = 0.1 if name == "thickness" else 0.05
                    value = round(round(float(draw.uniform(low, high)) / step) * step, 2)
                    if page.locator(f'[data-test="slide-{name}"]').input_value() == f"{value:g}":
                        continue
                    taken.append(page.evaluate(MOVE, [name, value]))
                    # every third move comes while the castings of the one before are counted
                    page.wait_for_timeout(int(draw.choice([30, 300, 700])))
                every += taken
                print(
                    f"{kind:<8} {len(taken)} moves: {np.median(taken):.3f} s in the middle, 95 % within "
                    f"{np.quantile(taken, 0.95):.3f} s, longest {max(taken):.3f} s",
                    flush=True,
                )
    print(
        f"all      {len(every)} moves: {np.median(every):.3f} s, 95 % within {np.quantile(every, 0.95):.3f} s; "
        f"load {os.getloadavg()[0]:.1f}"
    )


if __name__ == "__main__":
    main()
