"""Columns that a file does not have: by their names, time, displacement or force is not among them."""

from __future__ import annotations

from collections.abc import Sequence

from dummydesign.measurement.importing.core.units import split_name
from dummydesign.measurement.importing.core.vocabulary import ROLES, roles_of_name


def absent_roles(titles: Sequence[str], roles: Sequence[str] = ROLES) -> tuple[str, ...]:
    """Return the roles that no column can have: no name speaks for them, and too few other columns are left.

    Parameters
    ----------
    titles : sequence of str
        Names of the columns.
    roles : sequence of str
        Roles that are needed, among ``time``, ``displacement`` and ``force``.
    """
    speaks = [roles_of_name(split_name(title)[0]) & set(ROLES) for title in titles]
    absent = tuple(role for role in roles if not any(role in said for said in speaks))
    return absent if sum(not said for said in speaks) < len(absent) else ()


def absent_words(absent: Sequence[str], titles: Sequence[str], roles: Sequence[str] = ROLES) -> str:
    """Say which columns are missing and what to do.

    Parameters
    ----------
    absent : sequence of str
        From :func:`absent_roles`.
    titles : sequence of str
        Names of the columns; those of many are left out from the twelfth on.
    roles : sequence of str
        Roles that are needed.
    """
    shown = ", ".join(f"'{title[:40]}'" if title else f"column {at}" for at, title in enumerate(titles[:12], 1))
    return (
        f"no column is {' or '.join(absent)} (there are {shown}); {', '.join(roles[:-1])} and {roles[-1]} are needed: "
        "export the test again with them"
    )
