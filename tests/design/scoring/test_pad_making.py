"""How well any pad is made: the built-in file, an older copy that lacks it, and bounds."""

from __future__ import annotations

import pytest

from dummydesign.core.user_library import data_folder
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.settings import PadMaking, crown_making, pad_making
from dummydesign.geometry.shapes.slab import Slab
from tests.support.refusal import raises_code

FILE = "materials/making.toml"
WEIGHING = "[weighing_g]\nvalue = 0.1"


def test_a_copy_of_an_earlier_edition_has_the_usual_errors(own_folder):
    built_in, crown = pad_making(), crown_making()
    text = (data_folder() / FILE).read_text()
    new = text[text.index("# Castings that are drawn") : text.index("[crown_height_mm.print]")]
    own_folder(FILE, new, "")
    assert pad_making() == built_in == PadMaking() and crown_making() == crown


def test_errors_and_castings_of_the_users_own_file_are_those_of_the_pad(own_folder):
    own_folder(FILE, WEIGHING, "[weighing_g]\nvalue = 0.05")
    problem = read_problem(Request("palm", shape="slab", verify=False))
    made = problem.tolerances(Slab(), 10.0, 15.5)
    assert (made.weighing_g, made.thickness_mm, problem.castings.n) == (0.05, 0.2, 1200)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        (f"{WEIGHING}\nlow = 0.0\nhigh = 0.5", "[weighing_g]\nvalue = 2.1\nlow = 0.0\nhigh = 2.5", "out_of_range"),
        ("[thickness_mm]\nvalue = 0.2\nlow = 0.0", "[thickness_mm]\nvalue = -0.1\nlow = -0.2", "out_of_range"),
        ("castings = 1200", "castings = 1.5", "out_of_range"),
        ("castings = 1200", "castings = 1199", "out_of_range"),
    ],
)
def test_errors_above_two_and_too_few_castings_are_refused(old, new, code, own_folder):
    own_folder(FILE, old, new)
    with raises_code(code):
        read_problem(Request("palm", shape="slab", verify=False))
