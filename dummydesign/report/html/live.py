"""The live part of the what-if page: controls, numbers and two figures, computed by the page's own scripts."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.report.html.page import Section, script_json

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

FORCES_N, VELOCITIES_MM_S, SIZES_MM = (0.5, 15.0), (1.0, 500.0), (8.0, 24.0)


def live_section(data: dict[str, Any], resin: Resin, tissue: Tissue | None, start: dict[str, Any]) -> Section:
    """Sliders, numbers and two figures.

    Parameters
    ----------
    data : dict
        What the page computes from, see :func:`dummydesign.design.sweep.live_data.live_data`.
    resin : Resin
    tissue : Tissue or None
    start : dict
        ratio, thickness_mm, size_mm, shape, base, velocity_mm_s, force_N.
    """
    from dummydesign.design.search.slabs import THICKNESS_MM

    step = resin.ratio_step / 2
    sliders = [
        ("ratio", f"ratio ({resin.ratio_meaning})", resin.ratio_min, resin.ratio_max, step, start["ratio"]),
        ("thickness", "thickness", *THICKNESS_MM, 0.1, start["thickness_mm"]),
        ("size", "punch side or diameter", *SIZES_MM, 0.5, start["size_mm"]),
        ("velocity", "speed", *(math.log10(v) for v in VELOCITIES_MM_S), "any", math.log10(start["velocity_mm_s"])),
        ("force", "steady force", *FORCES_N, 0.1, start["force_N"]),
    ]
    controls = "".join(
        f'<label>{escape(text)} <output id="out-{name}"></output><input type="range" id="in-{name}" min="{low:.6g}" '
        f'max="{high:.6g}" step="{step if isinstance(step, str) else f"{step:.6g}"}" value="{value:.6g}"></label>'
        for name, text, low, high, step, value in sliders
    )
    controls += _select("shape", "punch", ("square", "round"), start["shape"])
    controls += _select("base", "base", ("bonded", "sliding"), start["base"])
    numbers = [
        ("young_kPa", "modulus"),
        ("depth_mm", "relaxed depth"),
        ("depth_over_thickness", "depth over thickness"),
        ("stiffness_N_per_mm", "tangent stiffness"),
        ("exponent", "local exponent d ln F / d ln x"),
        ("peak_force_N", "peak force"),
        ("peak_over_steady", "peak over steady"),
    ]
    if tissue is not None and data["tissue"] is not None:
        numbers += [
            ("inside_fraction", f"fraction of the press in the range of {tissue.name}"),
            ("tissue_depth", f"depth of {tissue.name}"),
            ("tissue_peak", f"peak of {tissue.name}"),
        ]
    boxes = "".join(
        f'<div class="fact"><b id="v-{name}">–</b><span>{escape(text)}</span></div>' for name, text in numbers
    )
    figures = "".join(
        f'<figure><svg class="plot" id="live-{name}" viewBox="0 0 440 310" role="img" aria-label="{title}"></svg>'
        f"<figcaption><strong>{title}</strong><small>{note}</small></figcaption></figure>"
        for name, title, note in (
            ("depth", "Relaxed force over depth", "blue: pad; area: subjects of the tissue, where one is given"),
            ("time", "Force over time", f"ramp, {_held(data['protocol'])}; area: subjects"),
        )
    )
    html = (
        f'<div class="controls noprint">{controls}</div><p id="live-limit" role="status"></p>'
        f'<div class="facts">{boxes}</div><div class="plots">{figures}</div>'
        f'<script type="application/json" id="live-data">{script_json(data)}</script>'
    )
    text = (
        "Everything here is computed in this page from the response table and the tissue's numbers inside it, by "
        "the formulas of the package."
    )
    return Section("Try it", text, html=html)


def _held(protocol: dict[str, Any]) -> str:
    """Braking and hold of the presses in words."""
    return f"braking at {protocol['deceleration_mm_s2'] / 1e3:g} m/s2, hold of {protocol['hold_s']:g} s"


def _select(name: str, text: str, options: tuple[str, ...], chosen: str) -> str:
    items = "".join(f"<option{' selected' if item == chosen else ''}>{item}</option>" for item in options)
    return f'<label>{text}<select id="in-{name}">{items}</select></label>'


def live_scripts() -> list[str]:
    """The page's computing and its controls."""
    folder = Path(__file__).parent
    return [(folder / name).read_text(encoding="utf-8") for name in ("live.js", "sliders.js")]
