"""How a witness puck is pressed so that its modulus and relaxation can be read; what is typed then."""

from __future__ import annotations

from collections.abc import Sequence

SPEEDS_MM_S = (10.0, 50.0)
"""Of the two presses: by drawn pucks both show terms from 0.01 s on (benchmarks/accuracy/puck_batches.py); at 0.5 mm/s
terms of 0.02 s are hidden."""
DEPTH_SHARE, HOLD_S, RATE_HZ, REST_MIN = 0.3, 10.0, 1000.0, 5.0
PLATE_SHARE = 1.5
"""Least width of the plates over the puck's diameter: it bulges by a fifth at a compression of 30 %."""


BATCH = "my-batch"
"""Name that is proposed for a batch that is measured."""


def trace_names(tag: str, number: int = 1, count: int = 1) -> tuple[str, ...]:
    """Files of the two presses of a puck."""
    puck = f"puck{tag}" if count == 1 else f"puck{tag}-{number}"
    return tuple(f"{puck}-v{speed:g}.csv" for speed in SPEEDS_MM_S)


def command(
    names: Sequence[str], diameter: str, height: str, ratio: float, resin: str, name: str = BATCH, mass: str = ""
) -> str:
    """What is typed when the presses are saved, with the weighed mass where there is one."""
    return (
        f"dummydesign resins add-compression {' '.join(names)} --diameter {diameter} --height {height} "
        f"{f'--mass {mass} ' if mass else ''}--friction lubricated --name {name} --ratio {ratio:.6g} --resin {resin}"
    )


def press_rows(names: Sequence[str], height_mm: float) -> list[tuple[str, ...]]:
    """Table of the presses of a puck; the first row is the head."""
    head = ("file to save", "speed, mm/s", "compress by, mm", "hold, s", "samples a second")
    depth = DEPTH_SHARE * height_mm
    return [
        head,
        *(
            (name, f"{speed:g}", f"{depth:.1f} ({100 * DEPTH_SHARE:.0f} %)", f"{HOLD_S:g}", f"{RATE_HZ:g}")
            for name, speed in zip(names, SPEEDS_MM_S)
        ),
    ]


def protocol_steps(diameter_mm: float, age_days: float, mark: str = "") -> tuple[str, ...]:
    """The work from the cured puck to its traces, in order."""
    return (
        f"Wait {age_days:g} days{mark} after the cure. Test at room temperature, on one day with the pad if there is "
        "one.",
        "Measure diameter and height again on this day; the command needs what was measured, not what was planned.",
        f"Use two flat, stiff, parallel plates at least {PLATE_SHARE * diameter_mm:.0f} mm wide. Wipe the puck dry. "
        "Spread a fresh film of silicone oil on both plates (on a silicone puck: glycerine). Or glue both faces to the "
        "plates and type --friction bonded.",
        "Centre the puck. Zero the force with the upper plate free. Start recording about 1 mm above the "
        "puck; displacement is 0 where the plate touches it.",
        "Press at the speeds of the table to one depth, stop, hold the position (not the force), then lift off. "
        "If the machine is slower, use its fastest speed: the command says which terms it hides.",
        f"Renew the film and rest the puck {REST_MIN:g} minutes between the presses.",
        "Save each press as CSV with columns time_s, displacement_mm, force_N (compression positive), not filtered. "
        "Other machine files: dummydesign import.",
    )
