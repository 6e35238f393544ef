"""What is counted as a form of a question, and as a room above another."""

from __future__ import annotations

from argparse import Namespace

from dummydesign.design.search.slabs import DesignCandidate
from studies.call_traces import Forms, room_of


def test_rooms_are_told_by_their_innermost_name_and_others_have_none():
    assert room_of("dummydesign.cli.entry") < room_of("dummydesign.design.suggest")
    assert room_of("dummydesign.design.suggest") < room_of("dummydesign.design.search.slabs")
    assert room_of("dummydesign.report.page") == room_of("dummydesign.designs") == room_of("json") == -1


def test_a_form_holds_three_values_of_the_question_or_two_of_the_pad_or_a_form():
    forms = Forms(("crowned:10.0,2.0", 6.0, 15.5))
    typed = {"hold": "11.37", "deceleration": "31234.5", "pad": "151x121"}
    assert forms.form_of(Namespace(**typed)) == "Namespace" and forms.form_of(list(typed.values())) == "words"
    assert forms.form_of({"hold": "11.37", "deceleration": "31234.5"}) is None
    assert forms.form_of({"hold_s": 11.37, "deceleration_mm_s2": 31234.5, "base": "bonded"}) == frozenset(
        ("hold_s", "deceleration_mm_s2", "base")
    )
    pad, other = (DesignCandidate(6.0, ratio, 0, None) for ratio in (15.5, 14.0))
    assert forms.form_of(pad) == forms.form_of(DesignCandidate(8.0, 14.0, 0, pad)) == "DesignCandidate"
    assert forms.form_of(DesignCandidate(8.0, 14.0, 0, other)) is None
    assert forms.form_of('{"hold_s": 11.37, "deceleration_mm_s2": 31234.5}') == "JSON"


def test_a_dict_that_gains_keys_is_the_same_form_and_one_inside_another_is_a_part():
    forms = Forms(("crowned:10.0,2.0", 6.0, 15.5))
    small = {"hold_s": 11.37, "deceleration_mm_s2": 31234.5, "base": "bonded"}
    for value in (small, small | {"out": None}, {"inputs": {"force_N": 1, **small}}):
        forms.first.setdefault(forms.form_of(value), "here")
    assert forms.count() == ["dict (here)", "dict (here)"]
