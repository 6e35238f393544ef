"""The tables of the built-in tissues say what the answers say."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies import built_in


def answer(level="not_settled", **more):
    excess = {"central": 1.02, "quantity": "peak"}
    return {
        "recommendation": {"shape": "crowned:radius=2.4,height=3.5,foot=7.8", "thickness_mm": 11.0, "ratio": 15.2},
        "castings": {"usable": 0.61, "out_of_reach": 0.28},
        "verdict": {
            "level": level,
            "not_reached": 0,
            "shortfall": excess,
            "over": {"central": 1.69, "quantity": "energy"},
            "correction": {"factor_central": 1.0, "factor": 1.161, "factor_after_measuring": None},
        },
        "measure_first": {
            "group": "relaxation",
            "acceptable_means": "usable",
            "acceptable_now": 0.61,
            "acceptable_if_known": {"modulus": 0.7, "relaxation": 0.9, "modulus+relaxation": 0.9496},
        },
        **more,
    }


def cells(table, row=-1):
    return [cell.strip() for cell in table.strip().splitlines()[row].strip("|").split("|")]


def test_a_row_has_the_pad_its_castings_its_factors_and_the_slab():
    table = built_in.design_table([("palm", answer(), answer("not_representative"))])
    assert cells(table) == [
        "palm",
        "Measure first",
        "crowned:2.4,3.5,7.8, 11 mm, 15.2",
        "61 %",
        "28 %",
        "1.00, 1.16, -",
        "Do not use it: energy 69 % too high",
    ]
    assert cells(built_in.design_table([("palm", answer(), None)]))[-1] == "none reaches the presses"


def test_the_shares_have_columns_where_every_answer_states_them():
    shares = (("resin_known", 1.0), ("after_puck", 0.949))
    known = {name: {"usable": share} for name, share in shares}
    table = built_in.design_table([("palm", answer(shares=known), None)])
    assert cells(table, 0)[4:6] == ["average batch", "after a puck"] and cells(table)[4:6] == ["100 %", "94.9 %"]
    mixed = built_in.design_table([("palm", answer(shares=known), None), ("thenar", answer(), None)])
    assert "average batch" not in cells(mixed, 0)


def test_what_to_measure_first_is_bold_and_a_share_near_the_limit_has_a_decimal():
    assert cells(built_in.measure_table([("palm", answer(), None)])) == [
        "palm",
        "`usable`",
        "61 %",
        "70 %",
        "**90 %**",
        "95.0 %",
    ]


@pytest.mark.parametrize("page", [built_in.DESIGNS, built_in.MEASURE_FIRST])
def test_the_page_has_the_marks(page):
    page.read(Path(__file__).parents[2])
