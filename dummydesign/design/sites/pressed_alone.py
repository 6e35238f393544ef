"""What is said where one of several crowns is pressed as if it were alone."""

from __future__ import annotations

from collections.abc import Sequence


def pressed_alone(places: Sequence[int]) -> list[dict[str, str]]:
    """One warning for pads with several crowns each, or none.

    Parameters
    ----------
    places : sequence of int
        Crowns of each pad.

    Examples
    --------
    >>> [item["code"] for item in pressed_alone([1, 12, 4])], pressed_alone([1])
    (['several_sites'], [])
    """
    several = sorted({count for count in places if count > 1})
    if not several:
        return []
    counts = " or ".join(f"{count}" for count in several)
    message = f"one of {counts} crowns is pressed as if it were alone; 'suggest --sites' solves what the others change"
    return [{"code": "several_sites", "message": message}]
