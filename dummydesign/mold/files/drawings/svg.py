"""A drawing as SVG, in millimetres. No CAD."""

from __future__ import annotations

import html

from dummydesign.mold.files.drawings.sheet import CAP_SHARE, LAYERS, Drawing, Text


def to_svg(sheet: Drawing) -> str:
    """Write the sheet as SVG in the size of its paper."""
    w, h = sheet.size
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w:g}mm" height="{h:g}mm" viewBox="0 0 {w:g} {h:g}">',
        f"<title>{html.escape(sheet.title)}</title>",
        f'<rect width="{w:g}" height="{h:g}" fill="#fff"/>',
        '<g fill="none" stroke="#111" stroke-linejoin="round" stroke-linecap="round">',
    ]
    for line in sheet.lines:
        points = " ".join(f"{x:.3f},{h - y:.3f}" for x, y in line.points)
        out.append(f'<polyline stroke-width="{LAYERS[line.layer]}" points="{points}"/>')
    out.append("</g>")
    for d in sheet.dimensions:
        lines, heads = d.marks()
        drawn = "".join(f'<path d="M{p[0]:.3f} {h - p[1]:.3f}L{q[0]:.3f} {h - q[1]:.3f}"/>' for p, q in lines)
        for corners in heads:
            drawn += '<path fill="#111" d="M' + "L".join(f"{x:.3f} {h - y:.3f}" for x, y in corners) + 'Z"/>'
        out.append(f'<g stroke="#111" stroke-width="{LAYERS["dimension"]}" fill="none">{drawn}</g>')
    out += [_text(text, h) for text in (*sheet.texts, *(d.text for d in sheet.dimensions))]
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _text(text: Text, h: float) -> str:
    x, y = text.at[0], h - text.at[1]
    anchor = ' text-anchor="middle"' if text.middle else ""
    turn = f' transform="rotate(-90 {x:.3f} {y:.3f})"' if text.upright else ""
    return (
        f'<text x="{x:.3f}" y="{y:.3f}" font-family="Helvetica, Arial, sans-serif" '
        f'font-size="{text.height / CAP_SHARE:.2f}" fill="#111"{anchor}{turn}>{html.escape(text.words)}</text>'
    )
