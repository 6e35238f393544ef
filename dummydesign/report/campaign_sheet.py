"""The sheet one presses from: a page to print with every press, its pad, speed, target, rest, and room to write."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from itertools import groupby

from dummydesign.core.parsing import twin_of
from dummydesign.loop.planning import Expected
from dummydesign.measurement.campaign_plan import FRESH_REST_S, Planned

_STYLE = """
@page { size: A4; margin: 9mm }
body { font: 9.5px/1.2 system-ui, sans-serif; color: #111; margin: 1em auto; max-width: 190mm }
h1 { font-size: 15px; margin: 0 0 2px } p { margin: 2px 0 }
table { border-collapse: collapse; width: 100% }
th, td { border: 0.5px solid #777; padding: 1.2px 4px; text-align: left }
th { background: #eee } td.n { text-align: right } tr.day td { background: #ddd; font-weight: bold }
td.free { min-width: 16mm } .tight td, .tight th { padding: 0.3px 3px; font-size: 8.5px }
"""


def sheet_html(
    name: str,
    plan: Sequence[Planned],
    set_up: dict[str, str],
    seed: int,
    expected: Sequence[Expected] = (),
    units: str = "mm",
) -> str:
    """Write the sheet as one HTML page, to be printed on one side for up to about fifty presses.

    With ``units`` "in" presses are in inches, inches a second and pounds-force; the set-up is as in the campaign file.
    """
    head = "".join(f"<p><b>{escape(key)}</b> {escape(value)}</p>" for key, value in set_up.items())
    rows, expected_of = [], dict(zip((row.sequence for row in plan), expected))
    length = twin_of("_mm", units)[0].removeprefix("_")
    columns = [
        "",
        f"pad {length}",
        f"{length}/s",
        *_targets(plan[0].by_depth, bool(expected), units),
        "hold s",
        "rest before",
        "unloading",
        "save as",
        "°C, remarks",
    ]
    for age, day in groupby(plan, key=lambda row: row.age_days):
        rows.append(
            f'<tr class="day"><td colspan="{len(columns)}">age {age:g} days &nbsp; date ____________ &nbsp; '
            "by ____________</td></tr>"
        )
        rows += [_row(row, expected_of.get(row.sequence), units) for row in day]
    heads = "".join(f"<th>{text}</th>" for text in columns)
    drive = _hold(plan[0].by_depth, expected_of.values())
    tight = " class=tight" if len(plan) > 40 else ""
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(name)}</title><style>{_STYLE}</style>'
        f"<h1>{escape(name)}: {len(plan)} presses in this order (seed {seed})</h1>{head}"
        f"<p>Start above the surface and record from there. {drive} Write down the temperature "
        "of the pad at every press. A press that failed: strike it out, rest the pad, press it again, note it here.</p>"
        f"<table{tight}><tr>{heads}</tr>{''.join(rows)}</table></html>\n"
    )


def _targets(by_depth: bool, both: bool, units: str) -> list[str]:
    """Headings of what is pressed to, and of what is expected beside it."""
    depth, force = (twin_of(name, units)[0].replace("_", " ") for name in ("depth_mm", "steady_force_N"))
    planned, other = (depth, f"{force} (95 %)") if by_depth else (force, f"{depth} (95 %)")
    return [planned, other] if both else [planned]


def _hold(by_depth: bool, expected: Iterable[Expected]) -> str:
    """How a press is driven, by force or by position."""
    presses = list(expected)
    words = "Hold the position; do not control the force."
    if presses and not by_depth:
        words = f"If your machine controls position, press to the depth in the next column. {words}"
    if not by_depth:
        words = f"The steady force is that at the end of the hold; the peak before it is larger. {words}"
    if any(one.beyond or one.may_go_beyond for one in presses):
        words += " <b>!</b> is deeper than 0.6 of the pad's thickness, or than the model reaches: stop at that depth."
    return words


def _row(row: Planned, expected: Expected | None, units: str) -> str:
    length, force = (twin_of(name, units)[1] for name in ("_mm", "_N"))
    planned, other = (length, force) if row.by_depth else (force, length)
    form = "g" if units == "mm" else ".4g"
    rest = "fresh, 1 h" if row.rest_s >= FRESH_REST_S else f"{row.rest_s:g} s"
    cells = (
        f"{row.sequence}",
        f"{row.thickness_mm / length:{form}}",
        f"{row.velocity_mm_s / length:{form}}",
        f"{row.target / planned:{form}}",
        *([] if expected is None else [_expected_text(expected, other)]),
        f"{row.hold_s:g}",
        rest,
        "record" if row.unload else "",
    )
    numbers = "".join(f'<td class="n">{cell}</td>' for cell in cells)
    return f'<tr>{numbers}<td>{row.file}</td><td class="free"></td></tr>'


def _expected_text(one: Expected, size: float) -> str:
    """The other quantity with its interval in a unit of a size; an end that is out of reach is the limit, marked."""
    value, low, high = (None if end is None else f"{end / size:.3g}" for end in (one.value, one.low, one.high))
    limit = f"over {one.limit_mm / size:.3g} !"
    reach = "beyond the model !" if one.by_depth else limit
    if value is None:
        return reach if low is None else f"{reach} (from {low})"
    return f"{value} ({low} to {limit if high is None else high})"
