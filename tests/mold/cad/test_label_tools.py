"""Solids of the label: each letter once, and what they are for."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.mold.cad import build
from dummydesign.mold.cad.label import label_bars, label_text
from dummydesign.mold.model.layout import layout


def strokes_mm3(spec, deep_mm):
    """Volume of the union of all strokes, counted on a grid of points."""
    bars, step = label_bars(spec), 0.02
    ends = np.array([(bar.x0_mm, bar.y0_mm, bar.x1_mm, bar.y1_mm) for bar in bars])
    low, high = ends.reshape(-1, 2).min(axis=0) - 1.0, ends.reshape(-1, 2).max(axis=0) + 1.0
    x, y = np.meshgrid(*(np.arange(a, b, step) for a, b in zip(low, high)), indexing="ij")
    inside = np.zeros(x.shape, dtype=bool)
    for bar in bars:
        turn, (mx, my) = np.radians(bar.angle_deg), bar.middle
        along = (x - mx) * np.cos(turn) + (y - my) * np.sin(turn)
        across = (y - my) * np.cos(turn) - (x - mx) * np.sin(turn)
        inside |= (np.abs(along) < bar.length_mm / 2) & (np.abs(across) < bar.width_mm / 2)
    return inside.sum() * step**2 * deep_mm


@pytest.mark.slow
def test_a_letter_that_comes_again_is_not_made_again(open_spec, monkeypatch):
    made = []
    whole = build._letter
    monkeypatch.setattr(build, "_letter", lambda *words: made.append(words) or whole(*words))
    tools = build.label_tools(open_spec, layout(open_spec))
    text = label_text(open_spec)
    assert len(made) == len(set(text)) < len(text)
    # No letter touches the one beside it, and each is one piece or more.
    assert len(tools) >= len(text.replace(" ", ""))
    total = sum(tool.Volume() for tool in tools)
    assert total == pytest.approx(strokes_mm3(open_spec, open_spec.body.label_depth_mm + 1.0), rel=5e-3)


def test_letters_that_were_moved_stand_where_their_strokes_do(open_spec):
    tools = build.label_tools(open_spec, layout(open_spec))
    for bar in label_bars(open_spec):
        place = (*bar.middle, layout(open_spec).land_mm)
        assert any(tool.isInside(place) for tool in tools)
