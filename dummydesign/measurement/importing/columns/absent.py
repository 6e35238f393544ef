"""Tables in which a column of time, displacement or force is missing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.columns.roles import Column
from dummydesign.measurement.importing.core.absent import absent_words
from dummydesign.measurement.importing.core.vocabulary import ROLES
from dummydesign.measurement.importing.text.layout import Layout


def refuse_absent(layout: Layout, columns: Sequence[Column], found: Mapping[str, Sequence[Column]]) -> None:
    """Refuse a table in which too few columns are left for the roles without a candidate.

    Parameters
    ----------
    layout : Layout
        The table.
    columns : sequence of Column
        Name, unit and place of each.
    found : mapping
        Candidates of each role.

    Raises
    ------
    InputError
        With the roles, and the columns that there are.
    """
    absent = [role for role in ROLES if not found[role]]
    taken = {column.index for role in ROLES for column in found[role]}
    spare = [column for column in columns if column.kind in ("number", "stamp") and column.index not in taken]
    if len(spare) < len(absent):
        raise InputError(f"{layout.file}: {absent_words(absent, [column.title for column in columns])}")
