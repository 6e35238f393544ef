"""A table of rows: on the terminal, in a page, as CSV; a first page reads its head and rows."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

Column = str | Callable[[Any], Any]
"""A key of the rows, ``key:form``, or what a function makes of a row."""


class Table(NamedTuple):
    """Head and rows of values; a row may end early.

    A form, such as ``>9.3f``, says how the numbers of a column are written; on the terminal it is also the column's
    width. Numbers without one are written with four digits. Rows in ``marked`` have the colour of what is outside.
    """

    head: Sequence[str]
    rows: Sequence[Sequence[Any]]
    forms: Sequence[str] = ()
    marked: frozenset[int] = frozenset()

    @classmethod
    def of(cls, rows: Iterable[Any], columns: Mapping[str, Column]) -> Table:
        """Make a table of rows by the headings of its columns."""
        parts = [column.partition(":") if isinstance(column, str) else (column, "", "") for column in columns.values()]
        body = [[row[key] if isinstance(key, str) else key(row) for key, _, _ in parts] for row in rows]
        return cls([*columns], body, [form for _, _, form in parts])

    def html(self) -> str:
        """The table, scrolling sideways by itself on a narrow screen."""
        from html import escape

        forms = self.forms or [""] * len(self.head)
        head = "".join(f'<th scope="col">{escape(text)}</th>' if text else "<td></td>" for text in self.head)
        cells = ("".join(f"<td>{escape(cell(*pair))}</td>" for pair in zip(row, forms)) for row in self.rows)
        rows = "".join(f"<tr>{row}</tr>" for row in cells)
        return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'

    def lines(self, forms: Sequence[str] = (), between: str = " ", indent: str = "  ") -> list[str]:
        """The table for the terminal, by its own forms or others; a dash where a value is missing."""
        forms = forms or self.forms
        wide = [re.sub(r"\+|(\.\d+)?[fg]$", "", form) for form in forms]
        rows = (
            (
                format("-" if value is None else value, width if value is None or isinstance(value, str) else form)
                for value, form, width in zip(row, forms, wide)
            )
            for row in (self.head, *self.rows)
        )
        return [f"{indent}{between.join(row)}".rstrip() for row in rows]


def cell(value: Any, form: str = "") -> str:
    """Write one value of a table in a page."""
    if value is None:
        return "–"
    return format(value, form or ".4g") if isinstance(value, float) or form else str(value)
