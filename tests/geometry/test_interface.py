"""An interface is read in one place, and everything that takes one as text understands the same texts."""

from __future__ import annotations

import math

import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.sweep.spec import check_friction
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.pad.puck import UnitPuck
from dummydesign.pad.slab.sliding_faces import solve_flat

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
    message = f"base '{text}' is not bonded, sliding or friction:MU with MU from 0 to 5"
    with pytest.raises(InputError, match=f"^{message}$"):
        Interface.parse(text, "base", BASES)
    with pytest.raises(InputError, match=f"plates = '{text}' is not one of frictionless, bonded, friction:MU with MU"):
        UnitPuck(1.0, text)
    with pytest.raises(InputError, match=f"friction of condition '{text}'"):
        check_friction(text)
    with pytest.raises(InputError, match=f"^condition '{text}' is not frictionless, bonded or friction:MU"):
        solve_flat(10.0, 8.0, 0.03, [1.0], text)


def test_names_without_friction_are_refused():
    for text in ("glue", "friction", "frictional:0.3", "BONDED", ""):
        with pytest.raises(InputError, match="is not bonded, sliding or friction:MU"):
            Interface.parse(text, "base", BASES)
