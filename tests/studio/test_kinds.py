"""Kinds side by side: rows and sentences are those of the answer."""

from __future__ import annotations

import json

import pytest

from dummydesign.cli.entry import run
from dummydesign.studio.figures import HEAD, kind_rows, kind_sentences, verdicts_of_kinds
from dummydesign.studio.slider_model import evaluator_of
from dummydesign.studio.state import State

SHAPES = [
    {"kind": "slab", "shape": "slab", "thickness_mm": 6.0, "ratio": 15.0, "total": 0.5, "after_puck": 0.3},
    {
        "kind": "crowned",
        "shape": "crowned:radius=20",
        "thickness_mm": 4.5,
        "ratio": 15.4,
        "total": 0.8,
        "after_puck": 0.9,
    },
    {"kind": "layered", "shape": "layered:2,3", "thickness_mm": 4.0, "ratio": 16.0, "total": 0.9, "after_puck": 0.6},
    {"kind": "boned", "shape": None, "reason": "too thin for a bone"},
]


def verdict(light, shortfall, over):
    return {"light": light, "shortfall": {"central": shortfall, "q95": 1.2}, "over": {"central": over, "q95": 1.3}}


def answer(**more):
    choice = {
        "next_best": "the layered pad (4 mm, ratio 16)",
        "decided_by": "after_puck",
        "text": "after one puck 90 % of its castings are usable, of the layered pad (4 mm, ratio 16) 60 %",
        **more,
    }
    best = {
        "shape": "crowned:radius=20",
        "thickness_mm": 4.5,
        "ratio": 15.5,
        "scores": {"total": 0.85},
        "conditions": [{"steady_force_N": 15.0}, {"steady_force_N": 3.0}],
    }
    return {"recommendation": best, "choice": choice, "shapes": SHAPES, "verdict": verdict("amber", 1.02, 1.1)}


def test_the_recommended_kind_is_first_and_has_its_own_numbers():
    found = kind_rows(answer(), {"slab": verdict("red", 1.4, 0.9)})
    assert [row[0] for row in found] == ["crowned", "layered", "slab"]
    assert all(len(row) == len(HEAD) for row in found)
    named = {row[0]: dict(zip(HEAD, row)) for row in found}
    assert named["crowned"] | {"pad": None} == dict(zip(HEAD, (None, "amber", 0.85, "90 %", 1.02, 1.1, 4.5, 15.5)))
    assert (
        named["slab"]["verdict"] == "red (estimate)"
        and named["slab"]["shortfall"] == 1.4
        and named["slab"]["over"] == 0.9
    )
    assert [named["layered"][key] for key in ("verdict", "shortfall", "over")] == [None, None, None]


def test_the_sentences_hold_the_numbers_of_the_choice():
    text = " ".join(kind_sentences(answer()))
    for part in ("4.5 mm", "ratio 15.5", "layered", "90 %", "60 %", "too thin for a bone"):
        assert part in text, part
    assert all(sentence.endswith(".") for sentence in kind_sentences(answer()))


def test_a_pad_that_stands_alone_names_no_other():
    assert "layered" not in kind_sentences(answer(next_best=None, decided_by=None, text=None))[0]


@pytest.mark.slow
def test_other_kinds_are_judged_as_suggest_judges(tmp_path, capsys):
    words = ["suggest", "--tissue", "forefinger", "--no-cad", "--no-verify", "--out", str(tmp_path / "out"), "--json"]
    assert run(words) == 0
    given = json.loads(capsys.readouterr().out)
    evaluator = evaluator_of(tmp_path, State("forefinger"))
    found = verdicts_of_kinds(evaluator, given)
    kinds = {row["kind"] for row in given["shapes"]}
    own = given["recommendation"]["shape"].partition(":")[0]
    assert set(found) == kinds - {own}
    assert all(row[1].partition(" ")[0] in ("green", "amber", "red") and row[4] > 0 for row in kind_rows(given, found))
    # the recommended pad judged this way is judged as the answer judges it
    turned = {**given, "recommendation": {**given["recommendation"], "shape": "none"}}
    again = verdicts_of_kinds(evaluator, turned)[own]
    assert again["level"] == given["verdict"]["level"] and again["light"] == given["verdict"]["light"]
    # the search draws 4,800 castings where 1,200 leave the level open: two standard deviations of both draws
    for name, share in given["verdict"]["castings"].items():
        spread = 2.0 * (share * (1.0 - share) * (1.0 / 1200 + 1.0 / 4800)) ** 0.5
        assert again["castings"][name] == pytest.approx(share, abs=max(spread, 1.0 / 1200)), name
    assert again["shortfall"]["central"] == pytest.approx(given["verdict"]["shortfall"]["central"], rel=1e-9)
