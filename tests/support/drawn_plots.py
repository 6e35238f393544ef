"""What plotly.js is given by a page, and what a browser then shows."""

from __future__ import annotations

import json
import re
from html import unescape


def figures_of(text: str) -> dict[str, dict]:
    """Data and layout of the plots of a page, by their names."""
    found = re.findall(r'<div class="plot" [^>]*?data-name="([^"]*)"[^>]*? data-plot=\'([^\']*)\'', text)
    return {unescape(name): json.loads(unescape(spec)) for name, spec in found}


def wait_until_drawn(page, count: int) -> None:
    """Return when all plots are drawn; the pages' policy forbids Playwright's own waiting for a function."""
    for _ in range(200):
        if page.locator("div.js-plotly-plot .main-svg").count() >= 2 * count:
            return
        page.wait_for_timeout(50)
    raise AssertionError("the plots were not drawn within ten seconds")


def read_at(page, index: int, share_x: float, share_y: float) -> list[str]:
    """Words beside the pointer at shares of the frame of a plot, the first those of the pointer itself."""
    page.locator("div.plot").nth(index).scroll_into_view_if_needed()
    page.mouse.move(*place(page, index, share_x, share_y))
    page.wait_for_timeout(150)
    return shown(page, index)


def place(page, index: int, share_x: float, share_y: float) -> list[float]:
    """A place in the window by shares of the frame of a plot."""
    return page.evaluate(
        """([k, sx, sy]) => { const div = document.querySelectorAll('div.plot')[k];
        const r = div.querySelector('.nsewdrag').getBoundingClientRect();
        return [r.left + sx * r.width, r.top + (1 - sy) * r.height]; }""",
        [index, share_x, share_y],
    )


def shown(page, index: int) -> list[str]:
    """Words of the box beside the pointer."""
    box = page.locator("div.plot").nth(index).locator(".hoverlayer text")
    return [text.strip() for text in box.all_text_contents() if text.strip()]


def axis_range(page, index: int, side: str = "x") -> list[float]:
    """Ends of an axis as they are drawn; logarithms on a logarithmic one."""
    return page.evaluate(
        f"(k) => document.querySelectorAll('div.plot')[k]._fullLayout.{side}axis.range.map(Number)", index
    )
