"""HTML whose values are escaped, unless they are HTML themselves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from markupsafe import Markup


def filled(template: str, *values: object) -> Markup:
    """Fill the places of a piece of HTML of our own with values."""
    return Markup(template).format(*values)


def joined(template: str, rows: Iterable[Sequence[object]]) -> Markup:
    """Fill a piece of HTML with each row, one behind the other."""
    return Markup().join(filled(template, *row) for row in rows)
