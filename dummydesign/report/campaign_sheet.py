"""The sheet one presses from: a page to print with every press, its pad, speed, target, rest, and room to write."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import groupby

from dummydesign.measurement.planning.plan import FRESH_REST_S, Planned

_STYLE = """
@page { size: A4; margin: 9mm }
body { font: 9.5px/1.2 system-ui, sans-serif; color: #111; margin: 1em auto; max-width: 190mm }
h1 { font-size: 15px; margin: 0 0 2px } p { margin: 2px 0 }
table { border-collapse: collapse; width: 100% }
th, td { border: 0.5px solid #777; padding: 1.2px 4px; text-align: left }
th { background: #eee } td.n { text-align: right } tr.day td { background: #ddd; font-weight: bold }
td.free { min-width: 16mm } .tight td, .tight th { padding: 0.3px 3px; font-size: 8.5px }
"""


def sheet_html(name: str, plan: Sequence[Planned], set_up: dict[str, str], seed: int) -> str:
    """Write the sheet as one HTML page, to be printed on one side for up to about fifty presses.

    Parameters
    ----------
    name : str
        Of the campaign.
    plan : sequence of Planned
        The presses, in their order.
    set_up : dict of str
        What stands above the table, by its heading.
    seed : int
        By which the order was drawn, for the heading.

    Returns
    -------
    str
        HTML.
    """
    head = "".join(f"<p><b>{escape(key)}</b> {escape(value)}</p>" for key, value in set_up.items())
    rows = []
    for age, day in groupby(plan, key=lambda row: row.age_days):
        rows.append(
            f'<tr class="day"><td colspan="9">age {age:g} days &nbsp; date ____________ &nbsp; '
            "by ____________</td></tr>"
        )
        rows += [_row(row) for row in day]
    target = "depth mm" if plan[0].by_depth else "force N"
    columns = ("", "pad mm", "mm/s", target, "hold s", "rest before", "way back", "save as", "°C, remarks")
    heads = "".join(f"<th>{text}</th>" for text in columns)
    tight = " class=tight" if len(plan) > 40 else ""
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(name)}</title><style>{_STYLE}</style>'
        f"<h1>{escape(name)}: {len(plan)} presses in this order (seed {seed})</h1>{head}"
        "<p>Start above the surface and record from there. Hold, do not follow the force. Write down the temperature "
        "of the pad at every press. A press that failed: strike it out, rest the pad, press it again, say so here.</p>"
        f"<table{tight}><tr>{heads}</tr>{''.join(rows)}</table></html>\n"
    )


def _row(row: Planned) -> str:
    rest = "fresh, 1 h" if row.rest_s >= FRESH_REST_S else f"{row.rest_s:g} s"
    cells = (
        f"{row.sequence}", f"{row.thickness_mm:g}", f"{row.velocity_mm_s:g}", f"{row.target:g}", f"{row.hold_s:g}",
        rest,
        "record" if row.unload else "",
    )  # fmt: skip
    numbers = "".join(f'<td class="n">{cell}</td>' for cell in cells)
    return f'<tr>{numbers}<td>{row.file}</td><td class="free"></td></tr>'
