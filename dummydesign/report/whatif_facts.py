"""What a study's answer states on one screen and on its report's first page: the best designs, or depths in a plane."""

from __future__ import annotations

from typing import Any

BEST, ACROSS = 10, 7
VARIED = ("shape", "punch", "condition", "base", "edge_radius_mm")
Rows = list[dict[str, Any]]
Table = tuple[list[str], list[list[str]], int]
"""Head, rows, and how many designs or thicknesses are left out."""


def best_first(rows: Rows) -> Rows:
    """Rows by falling score, those of equal score as they were; as they are without scores."""
    if not rows or "score" not in rows[0]:
        return rows
    return sorted(rows, key=lambda row: -row["score"]["total"])


def varied(rows: Rows) -> dict[str, list[Any]]:
    """The values of each setting beside thickness and ratio, in their order."""
    return {name: list(dict.fromkeys(row[name] for row in rows)) for name in VARIED}


def fixed_texts(rows: Rows) -> list[str]:
    """Settings that all designs share."""
    return [f"{name.removesuffix('_mm').replace('_', ' ')} {values[0]}" for name, values in varied(rows).items()
            if len(values) == 1 and values[0]]  # fmt: skip


def in_plane(rows: Rows) -> bool:
    """Whether thickness and ratio alone differ, and no tissue ranks the designs."""
    return "score" not in rows[0] and all(len(values) == 1 for values in varied(rows).values())


def plane_text(rows: Rows) -> str:
    """What the cells of :func:`plane_table` hold."""
    return f"depth in mm at {_middle(rows)} N steady ('-': not reached), peak over steady at the highest speed"


def _middle(rows: Rows) -> str:
    forces = list(rows[0]["depth_mm_at_N"])
    return forces[len(forces) // 2]


def plane_table(rows: Rows) -> Table:
    """Depth at one force and peak over steady, thickness across, ratio down."""
    force = _middle(rows)
    across = sorted({row["thickness_mm"] for row in rows})
    shown = across if len(across) <= ACROSS else [across[round(i * (len(across) - 1) / (ACROSS - 1))]
                                                  for i in range(ACROSS)]  # fmt: skip
    at = {(row["ratio"], row["thickness_mm"]): row for row in rows}
    body = []
    for ratio in sorted({row["ratio"] for row in rows}):
        cells = []
        for thickness in shown:
            row = at.get((ratio, thickness))
            depth = None if row is None else row["depth_mm_at_N"][force]
            peak = None if row is None else list(row["peak_over_steady"].values())[-1]
            cells.append("-" if depth is None else f"{depth:.2f}" + ("" if peak is None else f", {peak:.2f}"))
        young = next(row["young_kPa"] for row in rows if row["ratio"] == ratio)
        body.append([f"{ratio:g}", f"{young:.3g}", *cells])
    return ["ratio", "kPa", *(f"{thickness:g} mm" for thickness in shown)], body, len(across) - len(shown)


def first_table(rows: Rows) -> Table:
    """The best designs, all where no tissue ranks them, with what differs between them."""
    forces = list(rows[0]["depth_mm_at_N"])
    shown = forces if len(forces) <= 3 else [forces[0], forces[len(forces) // 2], forces[-1]]
    differ = [name for name, values in varied(rows).items() if len(values) > 1]
    score = "score" in rows[0]
    body = []
    for row in rows[:BEST] if score else rows:
        depths = (row["depth_mm_at_N"][force] for force in shown)
        body.append([*([f"{row['score']['total']:.2f}"] if score else []), f"{row['thickness_mm']:g}",
                     f"{row['ratio']:g}", f"{row['young_kPa']:.3g}",
                     *("-" if depth is None else f"{depth:.2f}" for depth in depths),
                     ", ".join(str(row[name]) for name in differ)])  # fmt: skip
    head = [*(["score"] if score else []), "mm", "ratio", "kPa", *(f"at {force} N" for force in shown)]
    return [*head, ", ".join(differ)], body, len(rows) - BEST if score else 0
