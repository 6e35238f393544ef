"""Grids of crowns: even shares of the pad, as near to the rim as independence allows, or the nearest that works."""

import re
from math import exp

import pytest

from dummydesign.core.errors import InputError
from dummydesign.design.crown_array import INDEPENDENT, lay_out
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request, read_sites
from dummydesign.geometry.shape_registry import read_shape
from tests.support.refusal import raises_code

CROWN = read_shape("crowned:radius=21.2,height=2,foot=9.4")
REACH_MM = 9.9


class Decaying:
    """Bounds that fall by e every 1.5 mm from 10 % at 20 mm between tips and 15 mm to the rim."""

    crown, radius_mm = CROWN, 7.9

    def stiffer(self, pitch_mm):
        return 0.1 * exp((20.0 - pitch_mm) / 1.5)

    def softer(self, rim_mm):
        return -0.1 * exp((15.0 - rim_mm) / 1.5)


def test_crowns_have_even_shares_of_a_wide_pad():
    sites = lay_out(Decaying(), (4, 3), (150.0, 120.0), REACH_MM)
    assert sites.pitch_mm == (37.5, 40.0) and sites.rim_mm == 18.7
    shape = sites.on(CROWN)
    shape.check(4.5, 150.0, 120.0)
    places = sites.to_dict(shape)["places_mm"]
    assert len(places) == 12 and places[0] == [-56.25, -40.0] and places[-1] == [56.25, 40.0]


def test_crowns_move_in_where_the_rim_is_felt_farther_than_the_neighbours():
    sites = lay_out(Decaying(), (5, 1), (150.0, 60.0), REACH_MM)
    assert sites.rim_mm >= 18.4 and sites.pitch_mm[1] == 0.0 and 23.4 <= sites.pitch_mm[0] < 30.0
    assert max(-sites.softer, sites.stiffer) <= INDEPENDENT


def test_what_does_not_fit_names_the_grid_that_does_and_the_pad_it_needs():
    with pytest.raises(InputError) as caught:
        lay_out(Decaying(), (7, 6), (150.0, 120.0), REACH_MM)
    text = str(caught.value)
    assert "\n" not in text
    fits = tuple(int(n) for n in re.search(r"; (\d+)x(\d+) fit it", text).groups())
    needed = tuple(float(n) for n in re.search(r"7x6 need ([\d.]+)x([\d.]+) mm", text).groups())
    for wanted, pad in ((fits, (150.0, 120.0)), ((7, 6), needed)):
        sites = lay_out(Decaying(), wanted, pad, REACH_MM)
        assert max(-sites.softer, sites.stiffer) <= INDEPENDENT
    with pytest.raises(InputError):
        lay_out(Decaying(), (fits[0] + 1, fits[1]), (150.0, 120.0), REACH_MM)


def test_the_punch_never_touches_a_neighbour():
    class Free(Decaying):
        def stiffer(self, pitch_mm):
            return 0.0

    with raises_code("cannot_be_made", "sites"):
        lay_out(Free(), (9, 2), (150.0, 120.0), REACH_MM)
    nearest = lay_out(Free(), (6, 2), (150.0, 120.0), REACH_MM).pitch_mm[0]
    assert nearest >= CROWN.foot_mm + REACH_MM + 1.0


@pytest.mark.parametrize("text", ["4", "4x", "0x3", "4x3x2", "21x2", "4.5x3"])
def test_what_is_no_grid_is_refused(text):
    with raises_code("malformed", "sites"):
        read_sites(text)


@pytest.mark.parametrize(
    "given, code",
    [
        ({"shape": "slab"}, "conflict"),
        ({"verify": False}, "conflict"),
        ({"shape": "crowned:10,2,6,1"}, "conflict"),
        ({"shape": "boned"}, "conflict"),
    ],
)
def test_sites_that_cannot_be_solved_are_refused_before_any_work(given, code):
    with raises_code(code):
        read_problem(Request("forefinger", sites=(2, 2), **given))


@pytest.mark.slow
def test_a_small_pad_with_sites_is_designed_and_each_crown_is_within_a_percent_of_the_one_that_was_solved(
    capsys, tmp_path, monkeypatch
):
    import json

    from dummydesign import cli

    given = ["--thickness", "4:5", "--ratio", "15:16", "--pad", "75x75", "--sites", "2x2", "--no-cad", "--json"]
    monkeypatch.chdir(tmp_path)
    assert cli.run(["suggest", "--tissue", "forefinger", *given]) == 0
    found = json.loads(capsys.readouterr().out)
    sites = found["sites"]
    assert (sites["along"], sites["across"]) == (2, 2) and len(sites["places_mm"]) == 4
    assert -INDEPENDENT <= sites["force_change"]["low"] <= 0.0 <= sites["force_change"]["high"] <= INDEPENDENT
    assert "sites_along=2,sites_across=2" in found["recommendation"]["shape"]
