"""Which column is time, displacement and force: by name and unit, and where those leave it open by what it does."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.measurement.importing.core.decisions import Notes, Settings, question
from dummydesign.measurement.importing.core.units import KIND_OF_ROLE, OTHER, Unit, find_unit, split_name
from dummydesign.measurement.importing.core.vocabulary import ROLES, roles_of_name
from dummydesign.measurement.importing.text.layout import Layout

_BEHAVIOUR = {
    "time": "the only one that always rises",
    "displacement": "stands still in holds",
    "force": "moves on in holds",
}


@dataclass(frozen=True)
class Column:
    """A column with its name, what the name speaks for, and its unit if it states one."""

    index: int
    title: str
    kind: str
    roles: frozenset[str]
    unit: Unit | None

    @property
    def label(self) -> str:
        """How it is called in messages and in ``--columns``."""
        return self.title or str(self.index + 1)

    @property
    def short(self) -> str:
        """Title for a message: what a damaged file takes for a title can be as long as the file."""
        return self.title if len(self.title) <= 40 else f"{self.title[:40]}..."


def describe_columns(layout: Layout) -> list[Column]:
    """Read names and units of all columns."""
    found = []
    for index, kind in enumerate(layout.kinds):
        name, unit = split_name(layout.names[index])
        below = find_unit(layout.units[index])
        found.append(Column(index, layout.names[index], kind, roles_of_name(name), below or unit))
    return found


def candidates(layout: Layout, columns: Sequence[Column], settings: Settings) -> dict[str, list[Column]]:
    """Columns that may be time, displacement and force.

    A name and a unit that agree outweigh a name or a unit alone. A column whose name speaks for one thing and
    whose unit for another (a deformation in per cent) is neither.

    Parameters
    ----------
    layout : Layout
        The table.
    columns : sequence of Column
        Name, unit and place of each.
    settings : Settings
        Columns that the user named.

    Returns
    -------
    dict
        Candidates of each role: columns whose name and unit agree, else those where one of the two does.

    Raises
    ------
    InputError
        When ``--columns`` names a column that is not there, or one twice.
    """
    named = {role: _named(layout, columns, role, word) for role, word in settings.columns.items()}
    taken = [column.index for column in named.values()]
    if len(set(taken)) < len(taken):
        raise InputError(f"{layout.file}: --columns names the same column for two roles")
    found: dict[str, list[Column]] = {}
    for role in ROLES:
        if role in named:
            found[role] = [named[role]]
            continue
        ranked: dict[int, list[Column]] = {2: [], 1: []}
        for column in columns:
            rank = _rank(column, role)
            if rank and column.index not in taken:
                ranked[rank].append(column)
        found[role] = ranked[2] or ranked[1]
    return found


def _rank(column: Column, role: str) -> int:
    """2 where name and unit agree, 1 where one of them speaks and the other is silent, else 0."""
    if column.kind not in ("number", "stamp") or (column.kind == "stamp" and role != "time"):
        return 0
    if column.kind == "stamp":
        return 1
    says = role in column.roles
    if column.unit is None:
        return int(says)
    if column.unit.kind == OTHER:
        # A load in volts is a load; what one volt is must be asked. A position in degrees is none.
        return int(says and column.unit.text.lower() in ("v", "mv", "a", "ma", "-"))
    if column.unit.kind != KIND_OF_ROLE[role]:
        return 0
    return 2 if says else int(not column.roles)


def _named(layout: Layout, columns: Sequence[Column], role: str, word: str) -> Column:
    alike = [column for column in columns if column.title.strip().lower() == word.strip().lower()]
    alike = alike or [
        column for column in columns if split_name(column.title)[0].lower() == word.strip().lower() and column.title
    ]
    if not alike and word.strip().isdigit() and 1 <= int(word) <= len(columns):
        alike = [columns[int(word) - 1]]
    if not alike:
        titles = [column.short for column in columns[:12] if column.title] or [f"1 to {len(columns)}"]
        raise InputError(f"{layout.file}: --columns {role}: {unknown_name('column', word, titles)}")
    if len(alike) > 1:
        places = ", ".join(str(column.index + 1) for column in alike)
        raise question(
            layout.file, f"the name '{word}' stands over columns {places}", f"--columns {role}={alike[0].index + 1}"
        )
    if alike[0].kind not in ("number", "stamp"):
        raise InputError(f"{layout.file}: --columns {role}={word}: this column holds no numbers")
    return alike[0]


def wanted(found: Mapping[str, Sequence[Column]], columns: Sequence[Column]) -> list[int]:
    """Columns whose numbers are needed to decide: the candidates, or all numbers where a role has none."""
    if all(found[role] for role in ROLES):
        return sorted({column.index for role in ROLES for column in found[role]})
    return [column.index for column in columns if column.kind in ("number", "stamp")]


def choose(
    layout: Layout,
    columns: Sequence[Column],
    found: Mapping[str, Sequence[Column]],
    values: Mapping[int, NDArray],
    settings: Settings,
    notes: Notes,
) -> dict[str, Column]:
    """Choose one column for each role.

    Parameters
    ----------
    layout, columns
        The table and its columns.
    found : mapping
        From :func:`candidates`.
    values : mapping of int to ndarray, shape (rows,)
        Numbers of each column that is looked at, by index.
    settings, notes
        What the user settled; receives the decisions.

    Raises
    ------
    InputError
        When a role has no column.
    QuestionError
        When several columns may be meant, or only their behaviour speaks for one.
    """
    chosen: dict[str, Column] = {}
    for role in ROLES:
        if found[role]:
            column, why = _one_of(layout, role, found[role], values, settings)
            chosen[role] = column
            notes.decide(f"{role} column", column.label, why)
    missing = [role for role in ROLES if role not in chosen]
    if missing:
        chosen |= _by_behaviour(layout, columns, chosen, missing, values, settings, notes)
    if len({column.index for column in chosen.values()}) < len(ROLES):
        names = ", ".join(f"{role} {column.label}" for role, column in chosen.items())
        raise question(layout.file, f"one column would have two meanings ({names})", "--columns ROLE=NAME,...")
    return chosen


def _one_of(
    layout: Layout, role: str, found: Sequence[Column], values: Mapping[int, NDArray], settings: Settings
) -> tuple[Column, str]:
    """The one among the candidates, when they differ in nothing that matters."""
    if role in settings.columns:
        return found[0], "given by --columns"
    why = _reason(found[0], role)
    if len(found) == 1:
        return found[0], why
    moving = [column for column in found if float(np.ptp(values[column.index])) > 0]
    if role == "time":
        moving = [column for column in moving if bool(np.all(np.diff(values[column.index]) > 0))] or moving
        numbers = [column for column in moving if column.kind == "number"]
        moving = numbers or moving
    if not moving:
        return found[0], why
    first = moving[0]
    rivals = [column for column in moving[1:] if not _same(values[first.index], values[column.index], role)]
    if rivals:
        names = " or ".join(f"'{column.label}'" for column in (first, *rivals))
        option = f"--columns {shlex.quote(f'{role}={_pick(first, found)}')}"
        raise question(layout.file, f"{role} may be {names}", option)
    others = ", ".join(f"'{column.label}'" for column in found if column is not first)
    return first, f"{why}; {others} hold the same or nothing"


def _pick(column: Column, found: Sequence[Column]) -> str:
    """How to name a column so that it is the only one: its number where others have its name."""
    alone = [one.title for one in found].count(column.title) == 1 and column.title
    return column.title if alone and not set(column.title) & set(",=") else str(column.index + 1)


def _same(one: NDArray, other: NDArray, role: str) -> bool:
    """Whether two columns differ by an offset and a sign at most (a machine's compressive copy of a channel)."""
    a, b = one - one[0], other - other[0]
    reach = 1e-4 * max(float(np.ptp(one)), 1e-300)
    return bool(np.max(np.abs(a - b)) <= reach or (role != "time" and np.max(np.abs(a + b)) <= reach))


def _reason(column: Column, role: str) -> str:
    if column.kind == "stamp":
        return "clock times"
    unit = f"unit {column.unit.text}" if column.unit else "no unit"
    return f"name '{column.title}', {unit}" if role in column.roles else unit


def _by_behaviour(
    layout: Layout,
    columns: Sequence[Column],
    chosen: Mapping[str, Column],
    missing: Sequence[str],
    values: Mapping[int, NDArray],
    settings: Settings,
    notes: Notes,
) -> dict[str, Column]:
    """Roles of columns that neither name nor unit speaks for: what rises is time, what stands in a hold is position."""
    free = [
        column
        for column in columns
        if column.index in values
        and column.index not in {one.index for one in chosen.values()}
        and not column.roles
        and column.unit is None
        and float(np.ptp(values[column.index])) > 0
    ]
    guess: dict[str, Column] = {}
    if "time" in missing:
        rising = [column for column in free if bool(np.all(np.diff(values[column.index]) > 0))]
        if len(rising) == 1:
            guess["time"] = rising[0]
            free = [column for column in free if column is not rising[0]]
    rest = [role for role in missing if role != "time"]
    certain = "time" not in missing or "time" in guess
    if len(rest) == len(free) == 2:
        order = sorted(free, key=lambda column: -_held(values[column.index]))
        most, least = (_held(values[column.index]) for column in order)
        certain = certain and most > 0.03 and most > 5.0 * least
        if certain:
            guess |= {"displacement": order[0], "force": order[1]}
    elif len(rest) == len(free) == 1:
        guess[rest[0]] = free[0]
    absent = [role for role in missing if role not in guess]
    if absent:
        shown = ", ".join(f"'{one.short}'" if one.title else f"column {one.index + 1}" for one in columns[:12])
        option = f"--columns {','.join(f'{role}=NAME' for role in absent)}"
        raise InputError(
            f"{layout.file}: no column is {' or '.join(absent)} (there are {shown}); say {option}, or export it"
        )
    # Without the units the answer would be a guess; with them the user has said what kinds of numbers these are.
    if not certain or any(role not in settings.units for role in missing):
        option = "--columns " + shlex.quote(",".join(f"{role}={guess[role].label}" for role in missing))
        option += " --units " + ",".join(
            f"{role}={settings.units.get(role, {'time': 's', 'displacement': 'mm', 'force': 'N'}[role])}"
            for role in missing
        )
        listed = ", ".join(f"{role} may be column {guess[role].label}" for role in missing)
        which = " or ".join(missing)
        raise question(
            layout.file, f"neither names nor units say which column is {which}; by what they do {listed}", option
        )
    for role in missing:
        notes.decide(f"{role} column", guess[role].label, _BEHAVIOUR[role])
    return guess


def _held(values: NDArray) -> float:
    """Share of samples near the end of the range that is farther from the first: there a position stands."""
    near = 0.02 * float(np.ptp(values))
    if values.max() - values[0] >= values[0] - values.min():
        return float(np.mean(values > values.max() - near))
    return float(np.mean(values < values.min() + near))
