"""One HTML file: every trial measured, base and corrected, residual maps, ranking, next measurement."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.output import result_dict
from dummydesign.loop.run import LoopResult

WIDTH, HEIGHT = 250, 130
_STYLE = """body{font:15px system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0}td,th{padding:.25em .8em;border-bottom:1px solid #ddd;text-align:right}
td:first-child,th:first-child{text-align:left}.grid{display:flex;flex-wrap:wrap;gap:10px}figure{margin:0}
figcaption{font-size:12px;color:#555}.verdict{font-size:1.4em;font-weight:600}svg{background:#fafafa}
.m{stroke:#999}.b{stroke:#d9822b}.a{stroke:#1f6fb4}"""


def html_report(result: LoopResult) -> str:
    """Make the report; no script and nothing loaded from elsewhere."""
    data = result_dict(result)
    parts = [
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{escape(result.campaign.name)}</title>",
        f"<style>{_STYLE}</style><h1>{escape(result.campaign.name)}</h1>",
        f"<p class=verdict>Verdict: {data['verdict']}</p>",
        *(f"<p>Unexplained: {escape(reason)}.</p>" for reason in data["residual"]["unexplained_because"]),
        _effects(data), _errors(data), _ranking(data), _following(data), _where(data),
        "<h2>Trials</h2><p><span style='color:#777'>measured</span>, <span style='color:#d9822b'>base</span>, "
        "<span style='color:#1f6fb4'>corrected</span>; below each the residual of both (±3 noise floors grey). "
        "Time runs from contact on a logarithmic axis.</p><div class=grid>",
        *(_trial(result, row) for row in range(len(result.presses.trials))),
        "</div><h2>Notes</h2><ul>",
        *(f"<li>{escape(w['message'])}</li>" for w in data["warnings"]),
        *(f"<li>not tested: {escape(name)} ({escape(why)})</li>" for name, why in data["untested"].items()),
        "</ul></html>",
    ]  # fmt: skip
    return "\n".join(parts) + "\n"


def _cell(value: Any, form: str = ".4g") -> str:
    return "<td>-</td>" if value is None else f"<td>{value:{form}}</td>"


def _effects(data: dict[str, Any]) -> str:
    out = []
    for effect in data["effects"]:
        out.append(f"<h2>{effect['name'].replace('_', ' ')}</h2><p>Evidence {effect['evidence']:.0f}, "
                   f"needed {effect['threshold']:.0f}; acts at the {effect['stage']}.</p><table>")  # fmt: skip
        out.append("<tr><th>parameter<th>value<th>95 % low<th>95 % high</tr>")
        for name, p in effect["parameters"].items():
            out.append(f"<tr><td>{name}</td>{_cell(p['value'])}{_cell(p['low'])}{_cell(p['high'])}</tr>")
        out.append("</table>")
        if effect["confounded_with"]:
            out.append(f"<p>Explains the data as well: {', '.join(effect['confounded_with'])}.</p>")
        if effect["family"]:
            out.append(f"<p>Acts alike in this campaign: {', '.join(effect['family'])}.</p>")
    return "\n".join(out)


def _errors(data: dict[str, Any]) -> str:
    out = ["<h2>Error, N rms</h2><table><tr><th>model<th>fitted<th>left-out conditions<th>noise floor<th>lack of fit p"]
    for label in ("base", "after"):
        e = data[label]["error"]
        cells = "".join(_cell(e[k]) for k in ("train_rmse_N", "heldout_rmse_N", "noise_floor_N", "lack_of_fit_p"))
        out.append(f"<tr><td>{label}</td>{cells}</tr>")
    out.append("</table><table><tr><th>parameter<th>base<th>corrected<th>95 % low<th>95 % high</tr>")
    for name, p in data["after"]["parameters"].items():
        base = data["base"]["parameters"][name]["value"]
        out.append(f"<tr><td>{name}</td>" + "".join(map(_cell, (base, p["value"], p["low"], p["high"]))) + "</tr>")
    return "\n".join(out) + "</table>"


def _ranking(data: dict[str, Any]) -> str:
    top = max((row["evidence"] for row in data["ranking"]), default=0.0)
    out = ["<h2>Evidence of each effect alone</h2><table>"]
    for row in data["ranking"]:
        length = 300 * np.sqrt(max(row["evidence"], 0.0) / top) if top > 0 else 0.0
        bar = f"<svg width=300 height=12><rect width={length:.0f} height=12 fill='#1f6fb4'/></svg>"
        out.append(f"<tr><td>{row['name']}</td><td>{row['evidence']:.1f}</td><td>{bar}</td></tr>")
    return "\n".join(out) + "</table><p>Bars go as the square root.</p>"


def _following(data: dict[str, Any]) -> str:
    plan = data["next_measurement"]
    if plan is None:
        return ""
    rows = "".join(f"<li>{escape(text)} ({gain:.1f})</li>" for text, gain in plan["alternatives"])
    return (
        f"<h2>Next measurement</h2><p>{escape(plan['text'])}: separates {' and '.join(plan['separates'])} by "
        f"{plan['expected_gain']:.1f} in chi-square. Then:</p><ul>{rows}</ul>"
    )


def _where(data: dict[str, Any]) -> str:
    after = {row["factor"]: row for row in data["residual"]["where_after"]}
    out = ["<h2>What the residual depends on</h2><table><tr><th>factor<th>base: excess chi2<th>corrected</tr>"]
    for row in data["residual"]["where"]:
        left = after.get(row["factor"])
        out.append(f"<tr><td>{row['factor']}</td>{_cell(row['excess'], '.0f')}"
                   f"{_cell(left['excess'] if left else None, '.0f')}</tr>")  # fmt: skip
    checks = "".join(f"<li>{c['name']}: {escape(c['text'])}</li>" for c in data["residual"]["checks"])
    return "\n".join(out) + f"</table><ul>{checks}</ul>"


def _line(x: NDArray, y: NDArray, kind: str) -> str:
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
    return f"<polyline points='{points}' fill=none stroke-width=1.3 class={kind} />"


def _trial(result: LoopResult, row: int) -> str:
    presses, trial = result.presses, result.presses.trials[row]
    use = presses.used[row]
    middle = 0.5 * (presses.bins.start[row] + presses.bins.end[row])[use] - presses.contact_s[row]
    shown = middle > 0
    time = np.log10(np.maximum(middle[shown], 1e-3))
    x = 5 + (WIDTH - 10) * (time - time.min()) / max(np.ptp(time), 1e-9)
    measured = presses.force_N[row, use][shown]
    base, after = (stage.fit.forces[row, use][shown] for stage in (result.base, result.after))
    top = max(measured.max(), base.max(), after.max(), 1e-6)
    low = min(measured.min(), 0.0)

    def place(force: NDArray) -> NDArray:
        return HEIGHT - 5 - (HEIGHT - 10) * (force - low) / (top - low)

    floor = result.after.fit.sizes.floor_N
    reach = max(6 * floor, float(np.abs(measured - base).max()), float(np.abs(measured - after).max()))
    middle_y, scale = HEIGHT + 30, 28.0 / reach
    band = 3 * floor * scale
    return (
        f"<figure><svg width={WIDTH} height={HEIGHT + 60}>"
        f"<rect x=0 y={middle_y - band:.1f} width={WIDTH} height={2 * band:.1f} fill='#e6e6e6'/>"
        + _line(x, place(measured), "m") + _line(x, place(base), "b") + _line(x, place(after), "a")
        + _line(x, middle_y - scale * (measured - base), "b") + _line(x, middle_y - scale * (measured - after), "a")
        + f"</svg><figcaption>{escape(trial.file)}: {trial.thickness_mm:g} mm, {trial.velocity_mm_s:g} mm/s, peak "
        f"{measured.max():.2f} N<br>rms {1e3 * result.base.errors.by_trial_N[row]:.0f} &rarr; "
        f"{1e3 * result.after.errors.by_trial_N[row]:.0f} mN</figcaption></figure>"
    )  # fmt: skip
