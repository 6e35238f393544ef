"""A randomised, balanced plan of presses: pads, speeds, forces or depths, repeats, days, rests, ways back."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from dummydesign.core.errors import InputError, out_of_range, quantity_name

FRESH_REST_S = 3600.0
"""Rest of a pad before its first press of a day. [s]"""
MOST = 2000
UNLOADING_SHARE = 1.0 / 3.0


@dataclass(frozen=True)
class Planned:
    """One press to be made; ``target`` is a force in N or, with ``by_depth``, a depth in mm."""

    file: str
    thickness_mm: float
    velocity_mm_s: float
    target: float
    by_depth: bool
    repeat: int
    sequence: int
    age_days: float
    rest_s: float
    hold_s: float
    unload: bool


@dataclass(frozen=True)
class PlanSettings:
    """What a plan is made of: every pad at every speed to every target, ``repeats`` times, over the days.

    Usual are the pads of the blind study (docs/evidence.md), and the speeds and steady forces of the data on people,
    which a verdict needs. The loop reads low forces in the rise of each press: it detects as many effects as with
    presses to 3, 7 and 12 N.
    """

    pads_mm: tuple[float, ...] = (5.0, 15.0, 20.0)
    velocities_mm_s: tuple[float, ...] = (10.0, 250.0)
    targets: tuple[float, ...] = (5.0, 10.0, 15.0)
    by_depth: bool = False
    repeats: int = 2
    ages_days: tuple[float, ...] = (9.0, 14.0, 29.0)
    rest_s: float = 60.0
    hold_s: float = 10.0
    seed: int = 1

    def check(self) -> None:
        """Refuse what cannot be pressed (InputError)."""
        ranges = {
            "pad thickness in mm": (self.pads_mm, 0.5, 200.0),
            "velocity in mm/s": (self.velocities_mm_s, 0.001, 5000.0),
            "age in days": (self.ages_days, 0.0, 36500.0),
            "rest in s": ((self.rest_s,), 0.0, 1e9),
            "hold in s": ((self.hold_s,), 0.0, 1e5),
            "repeats": ((self.repeats,), 1, 100),
            "seed": ((self.seed,), 0, 2**31 - 1),
            "depth in mm" if self.by_depth else "force in N": (self.targets, 0.01, 200.0 if self.by_depth else 2000.0),
        }
        for name, (values, low, high) in ranges.items():
            if not values:
                raise InputError(f"{name}: give at least one", "missing", quantity_name(name))
            for value in values:
                if not low <= value <= high:
                    raise out_of_range(name, value, low, high)
            if len(set(values)) != len(values):
                raise InputError(
                    f"{name}: {', '.join(f'{v:g}' for v in values)} holds a value twice; give each once",
                    "duplicate",
                    quantity_name(name),
                    values,
                )
        count = len(self.pads_mm) * len(self.velocities_mm_s) * len(self.targets) * self.repeats
        if not 2 <= count <= MOST:
            raise out_of_range("number of presses", count, 2, MOST, "give two forces or speeds, or --repeats 2")
        if self.by_depth and max(self.targets) > 0.6 * min(self.pads_mm):
            depth = f"depth in mm = {max(self.targets):g} is more than 0.6 of the {min(self.pads_mm):g} mm pad"
            raise InputError(f"{depth}; press less deep, or plan forces", "out_of_range", "depth_mm", max(self.targets))


def make_plan(design: PlanSettings) -> tuple[Planned, ...]:
    """Put the presses in order.

    Repeats of a condition fall on different days and every day has as many presses of each pad, speed and target
    as can be; the order within a day is drawn, pad by pad, so that a pad is not changed between presses. One press
    in three records the way back, as even over pads, speeds and targets as can be. The first press of a pad on a day
    finds it at rest for an hour.
    """
    design.check()
    draw = np.random.default_rng([design.seed, 16])
    days: list[list[tuple[float, float, float]]] = [[] for _ in design.ages_days]
    for pad in design.pads_mm:
        cells = [(pad, v, t) for v, t in product(design.velocities_mm_s, design.targets)]
        first = int(draw.integers(len(days)))
        for at, number in enumerate(draw.permutation(len(cells))):
            for repeat in range(design.repeats):
                days[(first + at + repeat) % len(days)].append(cells[int(number)])
    rows: list[Planned] = []
    repeats: Counter[tuple[float, float, float]] = Counter()
    for age, cells in zip(design.ages_days, days):
        for pad in draw.permutation(design.pads_mm):
            own = [cell for cell in cells if cell[0] == pad]
            for number, at in enumerate(draw.permutation(len(own))):
                cell = own[int(at)]
                repeats[cell] += 1
                name = file_name(*cell, repeats[cell], design.by_depth)
                rest = design.rest_s if number else FRESH_REST_S
                order = repeats[cell], len(rows) + 1
                rows.append(Planned(name, *cell, design.by_depth, *order, age, rest, design.hold_s, False))
    # a third, taken in turn from the presses sorted by pad, speed and target
    drawn = {row.sequence: draw.random() for row in rows}
    ordered = sorted(rows, key=lambda r: (r.thickness_mm, r.velocity_mm_s, r.target, drawn[r.sequence]))
    count = max(round(UNLOADING_SHARE * len(rows)), 1)
    unloading = np.floor((np.arange(count) + draw.random()) * len(rows) / count).astype(int)
    back = {ordered[at].sequence for at in unloading}
    return tuple(replace(row, unload=row.sequence in back) for row in rows)


def file_name(thickness_mm: float, velocity_mm_s: float, target: float, repeat: int, by_depth: bool = False) -> str:
    """Name to save a press under: ``t05_v010_f03_1.csv``; ``d`` stands for a depth."""
    kind = "d" if by_depth else "f"
    return f"t{_digits(thickness_mm, 2)}_v{_digits(velocity_mm_s, 3)}_{kind}{_digits(target, 2)}_{repeat}.csv"


def _digits(value: float, width: int) -> str:
    whole, dot, rest = f"{value:g}".partition(".")
    return whole.zfill(width) + dot + rest
