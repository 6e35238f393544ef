"""Kinds side by side: rows and sentences are those of the answer."""

from __future__ import annotations

import json

import pytest

from dummydesign.cli.entry import run
from dummydesign.core.levels import LEVELS, level_name
from dummydesign.core.tables import Table
from dummydesign.studio.figures import KIND_COLUMNS, kind_rows


def row(kind, thickness_mm, ratio, level, after_puck, misfit):
    """The best pad of a kind as an answer holds it."""
    pad = {"kind": kind, "shape": f"{kind}:1", "thickness_mm": thickness_mm, "ratio": ratio}
    return pad | {"by": "table", "level": level, "after_puck": after_puck, "misfit_rms_ln_force": misfit}


SHAPES = [
    row("slab", 6.0, 15.0, "not_representative", 0.0008601, 0.5),
    row("crowned", 4.5, 15.4, "stands_for", 0.9, 0.2),
    row("layered", 4.0, 16.0, "not_settled", 0.6, 0.1),
    {"kind": "boned", "shape": None, "reason": "too thin for a bone"},
]


def answer():
    best = {"shape": "crowned:1", "thickness_mm": 4.5, "ratio": 15.5}
    return {"recommendation": best, "shapes": SHAPES, "verdict": {"level": "not_settled"}}


def test_the_recommended_kind_is_first_with_its_final_verdict_and_the_others_have_those_of_the_search():
    table = Table.of(kind_rows(answer()), KIND_COLUMNS)
    assert table.rows == [
        ["crowned", level_name("not_settled"), 0.2, "90 %", 4.5, 15.5],
        ["layered", f"{level_name('not_settled')} (estimate)", 0.1, "60 %", 4.0, 16.0],
        ["slab", f"{level_name('not_representative')} (estimate)", 0.5, "0 %", 6.0, 15.0],
        ["boned: too thin for a bone", "", None, None, None, None],
    ]


@pytest.mark.slow
def test_every_kind_of_a_search_has_a_row_with_the_level_of_the_command(tmp_path, capsys):
    words = ["suggest", "--tissue", "forefinger", "--no-cad", "--no-verify", "--out", str(tmp_path / "out"), "--json"]
    assert run(words) == 0
    given = json.loads(capsys.readouterr().out)
    found = kind_rows(given)
    assert {one["kind"] for one in found} == {one["kind"] for one in given["shapes"]}
    assert found[0]["kind"] == given["recommendation"]["shape"].partition(":")[0]
    assert found[0]["level"] == given["verdict"]["level"]
    assert {one["level"] for one in found if one["shape"] is not None} <= set(LEVELS)
