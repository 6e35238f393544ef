"""Levels of a verdict, the best first: what people read for each, and its light."""

from __future__ import annotations

LEVEL_NAMES = {
    "stands_for": "Use it",
    "usable_with_correction": "Usable with a correction",
    "not_settled": "Measure first",
    "not_representative": "Do not use it",
}
LEVELS = tuple(LEVEL_NAMES)
LIGHTS = dict(zip(LEVELS, ("green", "amber", "amber", "red")))


def level_name(level: object) -> str:
    """Return what people read for a level; another word, such as the verdict of a loop, as it is."""
    return LEVEL_NAMES.get(str(level), str(level))
