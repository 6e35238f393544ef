"""From a move of a slider to the drawn plot in Chromium: ``python -m benchmarks.speed.slider_latency [MOVES]``.

Each kind of pad is moved many times. Median and 95 % quantile are printed with the load of the machine: until the
verdict of the new pad is there, until its curve is drawn in the large plot, and until all plots are drawn. A busy
machine makes all of them longer: the server's processor time a move is printed too, and the same quantile of a fixed
work of 0.02 s that is done between the moves, by the clock over its processor time.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.project.folder import make_project
from tests.support.studio import browser, processor_s, running

MOVE = """([name, value, step, before, after]) => new Promise((done) => {
    const slider = document.querySelector(`[data-test="slide-${name}"]`), low = Number(slider.ariaValueMin);
    const track = slider.querySelector('.q-slider__track-container'), span = slider.ariaValueMax - low;
    const { left, width, top } = track.getBoundingClientRect();
    // a click is on a whole pixel, which may be the next step's
    const clientX = Math.round(left + width * (value - low) / span);
    const hit = Number((low + Math.round((clientX - left) / width * span / step) * step).toFixed(2));
    if (hit === Number(slider.ariaValueNow)) return done(null);
    const label = before + hit + after;
    const start = performance.now(), times = [NaN, NaN, NaN];
    const since = () => (performance.now() - start) / 1e3;
    const [box, verdict] = ['plots', 'verdict'].map((name) => document.querySelector(`[data-test="${name}"]`));
    const curves = () => [...box.querySelectorAll('.trace')].filter((one) => one.__data__[0].trace.name === 'this pad')
        .map((one) => one.querySelector('.js-line')?.getAttribute('d'));
    const old = curves(), mine = () => verdict.querySelector('small.label')?.textContent.includes(label);
    const end = () => { clearTimeout(late); watch.disconnect(); done(times); };
    const late = setTimeout(end, 5000);
    const watch = new MutationObserver(() => {
        if (!mine()) return;
        const now = curves();
        if (isNaN(times[0])) times[0] = since();
        if (now[0] !== old[0] && isNaN(times[1])) times[1] = since();
        if (now.every((one, k) => one !== old[k])) { times[2] = since(); requestAnimationFrame(end); }
    });
    watch.observe(verdict, {childList: true, subtree: true, characterData: true});
    watch.observe(box, {childList: true, subtree: true, attributeFilter: ['d']});
    track.dispatchEvent(new MouseEvent('mousedown', { clientX, clientY: top + 5, bubbles: true }));
    document.dispatchEvent(new MouseEvent('mouseup', { clientX, clientY: top + 5, bubbles: true })); })"""
STEPS = ("the verdict", "curve of the large plot", "curves of all plots")
PADS = {
    "slab": "slab",
    "crowned": "crowned:20,2,9",
    "layered": "layered:4,1.5",
    "boned": "boned:20.57,2.2,9.3",
}
SETTLED = '[data-test="verdict"] .verdict[data-state="settled"]'


def fixed_work() -> float:
    """Do a fixed work; return its time by the clock over its processor time, 1 on an idle machine."""
    clock, processor = time.perf_counter(), time.process_time()
    sum(range(1_000_000))
    return (time.perf_counter() - clock) / (time.process_time() - processor)


def main(moves: int = 60, seed: int = 20261123) -> None:
    """Measure and print."""
    draw = np.random.default_rng(seed)
    every: list[list[float]] = []
    slowed: list[float] = []
    spent_s = 0.0
    with tempfile.TemporaryDirectory() as base:
        make_project(Path(base) / "thumb", tissue="forefinger")
        with (
            running(Path(base) / "thumb", Path(base) / "home") as studio,
            browser(viewport={"width": 1280, "height": 800}) as opened,
        ):
            page: Any = opened
            page.goto(studio.address)
            for kind, shape in PADS.items():
                page.goto(f"{studio.home}design?shape={shape}&thickness_mm=9&ratio=15")
                page.wait_for_selector(SETTLED)
                page.wait_for_timeout(800)
                taken, before_s = [], processor_s(studio.process.pid) or np.nan
                for _ in range(moves):
                    name, low, high = ("thickness", 7.0, 10.5) if draw.random() < 0.5 else ("ratio", 14.5, 18.0)
                    step = 0.1 if name == "thickness" else 0.05
                    around = (" ", " mm, ratio") if name == "thickness" else ("ratio ", ",")
                    moved = page.evaluate(MOVE, [name, float(draw.uniform(low, high)), step, *around])
                    if moved is None:  # it was there already
                        continue
                    taken.append(moved)
                    # every third move comes while the castings of the one before are counted
                    page.wait_for_timeout(int(draw.choice([30, 300, 700])))
                    slowed.append(fixed_work())
                spent_s += (processor_s(studio.process.pid) or np.nan) - before_s
                every += taken
                print(f"{kind:<8} {said(taken)}", flush=True)
    print(f"all      {said(every)}; load {os.getloadavg()[0]:.1f}")
    print(f"server   {spent_s / len(every):.3f} s of processor time a move, castings included")
    middle, most = np.quantile(slowed, (0.5, 0.95))
    print(f"machine  a fixed work took {middle:.1f} times its processor time by the clock, 95 % {most:.1f} times")


def said(taken: list[list[float]]) -> str:
    """Median and 95 % quantile of each step of some moves."""
    found = (np.nanquantile(taken, share, axis=0) for share in (0.5, 0.95))
    words = [f"{name} {middle:.3f} s, 95 % {most:.3f} s" for name, middle, most in zip(STEPS, *found)]
    missed = int(np.isnan(taken).any(axis=1).sum())
    return f"{len(taken)} moves: {'; '.join(words)}" + (f"; {missed} were not drawn" if missed else "")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
