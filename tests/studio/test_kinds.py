"""Kinds side by side: rows and sentences are those of the answer."""

from __future__ import annotations

import json

import pytest

from dummydesign.cli.entry import run
from dummydesign.studio.figures import HEAD, kind_rows, kind_sentences, verdicts_of_kinds
from dummydesign.studio.slider_model import evaluator_of
from dummydesign.studio.state import State

SHAPES = [
    {"kind": "slab", "shape": "slab", "thickness_mm": 6.0, "ratio": 15.0, "total": 0.5, "merit": 0.3},
    {"kind": "crowned", "shape": "crowned:radius=20", "thickness_mm": 4.5, "ratio": 15.4, "total": 0.8, "merit": 0.9},
    {"kind": "bumped", "shape": "bumped:pitch=5", "thickness_mm": 4.0, "ratio": 16.0, "total": 0.9, "merit": 0.6},
    {"kind": "boned", "shape": None, "reason": "too thin for a bone"},
]


def verdict(light, shortfall, over):
    return {"light": light, "shortfall": {"central": shortfall, "q95": 1.2}, "over": {"central": over, "q95": 1.3}}


def answer(**more):
    ends = {"kind": "slab", "thickness_mm": 6.0, "ratio": 15.0}
    choice = {
        "next_best": "the bumped pad (4 mm, ratio 16)", "decided_by": "low_aim", "expected_total": 0.55,
        "total_low": 0.25, "terms": {"aim": 0.05, "low_aim": 0.3, "force_variation_range": -0.05},
        "weights": {"low_aim": 0.4}, "expectation": {"differs": False, "middle": ends}, **more,
    }  # fmt: skip
    best = {"shape": "crowned:radius=20", "thickness_mm": 4.5, "ratio": 15.5, "scores": {"total": 0.85},
            "conditions": [{"steady_force_N": 15.0}, {"steady_force_N": 3.0}]}  # fmt: skip
    return {"recommendation": best, "choice": choice, "shapes": SHAPES, "verdict": verdict("amber", 1.02, 1.1)}


def test_the_recommended_kind_is_first_and_has_its_own_numbers():
    found = kind_rows(answer(), {"slab": verdict("red", 1.4, 0.9)})
    assert [row[0] for row in found] == ["crowned", "bumped", "slab"]
    assert all(len(row) == len(HEAD) for row in found)
    named = {row[0]: dict(zip(HEAD, row)) for row in found}
    assert named["crowned"] | {"pad": None} == dict(zip(HEAD, (None, "amber", 0.85, 0.9, 1.02, 1.1, 4.5, 15.5)))
    assert named["slab"]["verdict"] == "red" and named["slab"]["shortfall"] == 1.4 and named["slab"]["over"] == 0.9
    assert [named["bumped"][key] for key in ("verdict", "shortfall", "over")] == [None, None, None]


def test_the_sentences_hold_the_numbers_of_the_choice():
    text = " ".join(kind_sentences(answer()))
    for part in ("4.5 mm", "ratio 15.5", "bumped", "below 3 N", "+0.30 of +0.30", "(-0.05)", "60 %", "40 %", "0.55",
                 "0.25", "too thin for a bone"):  # fmt: skip
        assert part in text, part
    for sentence in kind_sentences(answer()):
        assert sentence.endswith(".") and len(sentence.split()) <= 20


def test_the_other_grounds_of_a_choice():
    alone = answer(next_best=None, terms={}, decided_by=None)
    assert "bumped" not in kind_sentences(alone)[0]
    judged = " ".join(kind_sentences(answer(decided_by="verdict")))
    assert "not representative" in judged and "+0.30" not in judged
    differs = answer(expectation={"differs": True, "middle": {"kind": "slab", "thickness_mm": 6.0, "ratio": 15.0}})
    assert any("slab pad, 6 mm" in one for one in kind_sentences(differs))


def test_other_kinds_are_judged_as_suggest_judges(tmp_path, capsys):
    words = ["suggest", "--tissue", "forefinger", "--no-cad", "--no-verify", "--out", str(tmp_path / "out"), "--json"]
    assert run(words) == 0
    given = json.loads(capsys.readouterr().out)
    evaluator = evaluator_of(tmp_path, State("forefinger"))
    found = verdicts_of_kinds(evaluator, given)
    kinds = {row["kind"] for row in given["shapes"]}
    own = given["recommendation"]["shape"].partition(":")[0]
    assert set(found) == kinds - {own}
    assert all(row[1] in ("green", "amber", "red") and row[4] > 0 for row in kind_rows(given, found))
    # the recommended pad judged this way is judged as the answer judges it
    turned = {**given, "recommendation": {**given["recommendation"], "shape": "none"}}
    again = verdicts_of_kinds(evaluator, turned)[own]
    assert again["text"] == given["verdict"]["text"]
    assert again["shortfall"]["central"] == pytest.approx(given["verdict"]["shortfall"]["central"], rel=1e-9)
