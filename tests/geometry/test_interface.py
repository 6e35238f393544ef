"""An interface is read in one place, and everything that takes one as text understands the same texts."""

from __future__ import annotations

import math

import pytest

from dummydesign.design.sweep.spec import check_friction
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.pad.axisymmetric.puck import UnitPuck
from dummydesign.pad.axisymmetric.shaped_pad import solve_flat
from dummydesign.pad.pad_under_punch import Pad
from tests.support.refusal import raises_code

BAD = ("friction:-0.1", "friction:5.1", "friction:nan", "friction:inf", "friction:", "friction:rough", "friction:0.3:1")


@pytest.mark.parametrize("text", [*BASES, *CONDITIONS, "friction:0", "friction:0.3", "friction:5"])
def test_a_text_is_read_and_written_back(text):
    assert str(Interface.parse(text, "base", (*BASES, *CONDITIONS))) == text


def test_friction_lies_between_sliding_and_glued():
    values = [Interface.parse(text, "face", CONDITIONS).friction for text in ("frictionless", "friction:0.3", "bonded")]
    assert values == [0.0, 0.3, math.inf]


def test_a_face_that_rubs_without_friction_is_not_a_driven_one():
    assert Interface.parse("friction:0", "base", BASES).coulomb == 0.0
    assert Interface.parse("sliding", "base", BASES).coulomb is None


@pytest.mark.parametrize("text", BAD)
def test_everything_that_takes_friction_refuses_the_same_texts(text):
    assert Interface.find(text, CONDITIONS) is None
    with raises_code("unknown_name", "base"):
        Interface.parse(text, "base", BASES)
    with raises_code("unknown_name", "plates"):
        UnitPuck(1.0, text)
    with raises_code("out_of_range", "friction"):
        check_friction(text)
    with raises_code("unknown_name", "condition"):
        solve_flat(Pad(10.0, 0.03, 8.0, condition=text), [1.0])


def test_names_without_friction_are_refused():
    for text in ("glue", "friction", "frictional:0.3", "BONDED", ""):
        with raises_code("unknown_name", "base"):
            Interface.parse(text, "base", BASES)
