"""Figures of :mod:`benchmarks.accuracy.laboratories` from its rows."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.accuracy.laboratory_draws import OF_MATERIAL, SAME_SIZE

USABLE = ("stands_for", "usable_with_correction")


def of(cases: list[bool]) -> str:
    """How many of how many."""
    return f"{sum(cases)} of {len(cases)}"


def summary(rows: list[dict[str, Any]]) -> str:
    """The figures; a laboratory counts in each line that it came to."""

    def known(row: dict[str, Any]) -> bool:
        return "truth" in row and bool(np.isfinite(row["truth"]["short"]))

    def size_inside(row: dict[str, Any]) -> bool:
        found = row["loop"]["size"]
        return bool(found["low"] <= next(iter(row["put"].values())) <= found["high"])

    # where the study's own elements jump its curve ends, and nobody knows whether people are within the limits
    cast, looped = [row for row in rows if known(row)], [row for row in rows if "loop" in row]
    compared = [row for row in cast if row.get("compare")]
    rig = [row for row in compared if row["put"] and not set(row["put"]) & OF_MATERIAL]
    clean = [row for row in compared if row not in rig]
    quiet, planted = ([row for row in looped if bool(row["put"]) is put] for put in (False, True))
    # alone it leaves three noise floors or more to the refitted material
    seen = [row for row in planted if row["loop"]["base_N"] >= 3.0 * row["loop"]["floor_N"]]
    sized = [size_inside(row) for row in planted if set(row["put"]) & SAME_SIZE & set(row["loop"]["names"])]
    turned = [row for row in looped if row.get("next_error") is not None and row.get("next_error_before") is not None]

    def agrees(row: dict[str, Any], said: str) -> bool:
        return (said in USABLE) == row["truth"]["usable"]

    def named(row: dict[str, Any]) -> bool:
        return row["loop"]["names"][:1] == [*row["put"]]

    def told(row: dict[str, Any]) -> bool:
        rivals = [name for names in row["loop"]["confounded"] for name in names or ()]
        return set(row["put"]) <= {*row["loop"]["names"], *rivals}

    def wrong(row: dict[str, Any]) -> bool:
        # half of the batches follow Yeoh's law, which stiffens
        return bool(set(row["loop"]["names"]) - {*row["put"], *(["strain_stiffening"] if row["yeoh"] else [])})

    every = [row["loop"] for row in looped]
    alike = [row for row in turned if row.get("alike_error") is not None]
    broken = sum(len(row["broken"]) for row in rows)
    ends: dict[str, int] = {}
    for row in rows:
        ends[row.get("stopped", "whole way")] = ends.get(row.get("stopped", "whole way"), 0) + 1
    lines = [
        f"laboratories: {len(rows)}; " + ", ".join(f"{count} {end}" for end, count in ends.items()),
        f"puck's modulus inside: {of([r['puck']['low'] <= r['puck']['true_kPa'] <= r['puck']['high'] for r in cast])}",
        f"usable after the puck said as true: {of([agrees(row, row['light_after_puck']) for row in cast])}",
        f"said usable and is not: {of([not r['truth']['usable'] for r in cast if r['light_after_puck'] in USABLE])}",
        f"compare says usable as true: {of([agrees(row, row['compare']) for row in clean])}; "
        f"through an undeclared rig {of([agrees(row, row['compare']) for row in rig])}",
        f"nothing undeclared: none in {of([row['loop']['verdict'] == 'none' for row in quiet])}, a name in "
        f"{of([bool(row['loop']['names']) for row in quiet])}",
        f"one effect: first in {of([named(row) for row in planted])}, above three floors {of([named(r) for r in seen])}"
        f"; told, or as good as what is told, in {of([told(row) for row in planted])} and {of([told(r) for r in seen])}"
        f"; another name in {of([wrong(row) for row in planted])}; size inside {of(sized)}",
        f"verdicts: {', '.join(sorted(one['verdict'] for one in every))}",
        f"modulus inside: {of([one['inside'] for one in every])}",
        *(
            f"{words} after the loop at most 2 % worse: {of([r[key] <= r[f'{key}_before'] + 0.02 for r in these])}"
            f"; better in {of([row[key] < row[f'{key}_before'] for row in these])}"
            for words, key, these in (
                ("next pad", "next_error", turned),
                ("one poured alike", "alike_error", alike),
            )
        ),
        f"commands: {sum(len(row['commands']) for row in rows)}, ended in an error: {broken}",
    ]
    return "\n".join(lines)
