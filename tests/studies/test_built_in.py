"""The tables of the built-in tissues say what the answers say."""

from __future__ import annotations

from pathlib import Path

from studies import built_in


def answer(level="not_settled"):
    excess = {"central": 1.02, "quantity": "peak"}
    return {
        "recommendation": {"shape": "crowned:radius=2.4,height=3.5,foot=7.8", "thickness_mm": 11.0, "ratio": 15.2},
        "shares": {
            "as_poured": {"usable": 0.61, "out_of_reach": 0.28},
            "resin_known": {"usable": 1.0},
            "after_puck": {"usable": 0.949},
        },
        "verdict": {
            "level": level,
            "not_reached": 0,
            "shortfall": excess,
            "over": {"central": 1.69, "quantity": "energy"},
            "correction": {"factor_central": 1.0, "factor": 1.161, "factor_after_measuring": None},
        },
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
        "100 %",
        "94.9 %",
        "28 %",
        "1.00, 1.16, -",
        "Do not use it: energy 69 % too high",
    ]
    assert cells(built_in.design_table([("palm", answer(), None)]))[-1] == "none reaches the presses"


def test_the_page_has_the_marks():
    built_in.DESIGNS.read(Path(__file__).parents[2])
