"""How a puck is pressed: what the sheet says is what the command understands and what the reader can see."""

from __future__ import annotations

import shlex

import pytest

from dummydesign.cli.entry import parser_of
from dummydesign.mold.puck.plan import (
    DEPTH_SHARE,
    PLATE_SHARE,
    SPEEDS_MM_S,
    command,
    press_rows,
    protocol_steps,
    trace_names,
)


def test_each_puck_has_two_files_of_its_own():
    assert trace_names("A") == ("puckA-v10.csv", "puckA-v50.csv")
    names = [name for number in (1, 2, 3) for name in trace_names("A", number, 3)]
    assert len(set(names)) == 6 and names[2] == "puckA-2-v10.csv"


def test_the_command_of_the_sheet_is_read_by_the_command():
    words = shlex.split(command(trace_names("B"), "30", "15.2", 15.25, "polyurethane-nagoya"))
    assert words[:2] == ["dummydesign", "resins"]
    options = parser_of("resins").parse_args(words[2:])
    assert (options.diameter, options.height, options.ratio) == (30.0, 15.2, 15.25)
    assert (options.friction, options.name, options.resin) == ("lubricated", "my-batch", "polyurethane-nagoya")


@pytest.mark.parametrize("height", [10.0, 15.3])
def test_the_table_compresses_by_the_share_of_the_height_at_both_speeds(height):
    head, *rows = press_rows(trace_names("A"), height)
    assert len(rows) == len(SPEEDS_MM_S) and all(len(row) == len(head) for row in rows)
    for row, speed in zip(rows, SPEEDS_MM_S):
        assert row[0].endswith(f"v{speed:g}.csv") and float(row[1]) == speed
        assert float(row[2].split()[0]) == pytest.approx(DEPTH_SHARE * height, abs=0.05)


def test_plates_are_wider_than_the_bulging_puck_and_the_age_is_that_of_the_resin():
    steps = protocol_steps(40.0, 7.0, " (assumed)")
    assert "Wait 7 days (assumed)" in steps[0]
    assert f"{PLATE_SHARE * 40.0:.0f} mm wide" in steps[2]
    # an incompressible puck at this compression is wider by the root of what is left
    assert (1.0 - DEPTH_SHARE) ** -0.5 < PLATE_SHARE
