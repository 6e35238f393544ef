"""Which column is time, displacement and force, and in which unit."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.measurement.importing import vocabulary as known
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.layout import TableLayout
from dummydesign.measurement.importing.vocabulary import BASE, KIND_OF_ROLE, ROLES, Unit

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
    def name(self) -> str:
        """Title without its unit, which the next file of the machine may state otherwise."""
        return known.split_name(self.title)[0]

    @property
    def short(self) -> str:
        """Title for a message: what a damaged file takes for a title can be as long as the file."""
        return self.title if len(self.title) <= 40 else f"{self.title[:40]}..."

    @property
    def counts(self) -> bool:
        """Whether its name says that it counts the samples."""
        return self.numeric and "counter" in known.meanings_of(self.title)

    @property
    def numeric(self) -> bool:
        """Whether it holds numbers or clock times."""
        return self.kind in ("number", "stamp", "measure")


Candidates = Mapping[str, Sequence[Column]]
Chosen = Mapping[str, Column]
Values = Mapping[int, NDArray]
"""Numbers of a column by its place in the table."""


def describe_columns(layout: TableLayout) -> list[Column]:
    """Read names and units of all columns."""
    read = zip(layout.kinds, layout.names, map(known.split_name, layout.names), layout.units)
    return [
        Column(index, title, kind, known.roles_of_name(name), known.find_unit(below) or unit)
        for index, (kind, title, (name, unit), below) in enumerate(read)
    ]


def find_candidates(columns: Sequence[Column], timeless: bool, log: ImportLog) -> Candidates:
    """Find the columns that may be time, displacement and force; ``timeless`` where a rate takes the time's place."""
    named = {role: _named(columns, role, word, log) for role, word in log.settings.columns.items()}
    taken = {column.index for column in named.values()}
    if len(taken) < len(named):
        raise log.fault("--columns names the same column for two roles", "duplicate", "columns")
    free = [column for column in columns if column.numeric and column.index not in taken]
    candidates: dict[str, list[Column]] = {}
    for role in ROLES:
        ranks = [_rank(column, role) for column in free]
        best = max(ranks, default=1) or 1
        candidates[role] = [column for column, rank in zip(free, ranks) if rank == best]
    candidates |= {role: [column] for role, column in named.items()}
    absent = [role for role in ROLES if not candidates[role] and not (timeless and role == "time")]
    taken = {column.index for role in ROLES for column in candidates[role]}
    _ask_for_size(absent, columns, log)
    if sum(column.numeric and column.index not in taken for column in columns) < len(absent):
        raise log.fault(known.absent_words(absent, [column.title for column in columns]), "missing", absent[0])
    return candidates


def _rank(column: Column, role: str) -> int:
    """2 where name and unit agree, 1 where one of them speaks and the other is silent, else 0."""
    if column.kind == "stamp":
        return int(role == "time")
    # "Time Load" is the time of the load
    named = role in column.roles and (role == "time" or "time" not in column.roles)
    if column.unit is None:
        return int(named)
    if column.unit.kind == known.OTHER:
        # A load in volts is a load; what one volt is must be asked. A position in degrees is none.
        return int(named and column.unit.text.lower() in ("v", "mv", "a", "ma", "-"))
    if column.unit.kind != KIND_OF_ROLE[role]:
        return 0
    return 2 if named else int(not column.roles)


def _named(columns: Sequence[Column], role: str, word: str, log: ImportLog) -> Column:
    wanted = word.strip().lower()
    alike = [column for column in columns if column.title.strip().lower() == wanted]
    # a profile of another file of the machine: the unit in the name may differ
    plain = (wanted, known.split_name(word)[0].lower())
    alike = alike or [one for one in columns if one.title and known.split_name(one.title)[0].lower() in plain]
    if not alike and wanted.isdigit() and 1 <= int(wanted) <= len(columns):
        alike = [columns[int(wanted) - 1]]
    if not alike:
        titles = [column.short for column in columns[:12] if column.title] or [f"1 to {len(columns)}"]
        raise log.fault(
            f"--columns {role}: {unknown_name('column', word, titles)}", "unknown_name", "columns", word, titles
        )
    if len(alike) > 1:
        numbers = ", ".join(str(column.index + 1) for column in alike)
        raise log.question(f"columns {numbers} are named '{word}'", f"--columns {role}={alike[0].index + 1}")
    if not alike[0].numeric:
        raise log.fault(f"--columns {role}={word}: this column holds no numbers", "not_a_number", "columns", word)
    return alike[0]


_SHARE = {"%": 0.01, "mm/mm": 1.0, "in/in": 1.0, "-": 1.0, "um/m": 1e-6}
_PRESSURE = {"pa": 1e-6, "kpa": 1e-3, "mpa": 1.0, "n/mm2": 1.0, "n/mm^2": 1.0, "bar": 0.1, "psi": 6.894757e-3}
"""How many N/mm2 a unit of stress is."""


def _ask_for_size(absent: Sequence[str], columns: Sequence[Column], log: ImportLog) -> None:
    """Ask for height or area of the specimen where a file has strain for displacement, or stress for force."""
    named: list[tuple[str, str, float]] = []
    for role, meaning, table in (("displacement", "strain", _SHARE), ("force", "stress", _PRESSURE)):
        for column in columns if role in absent else ():
            unit = column.unit.text.lower() if column.unit and column.unit.kind == known.OTHER else ""
            if unit in table and (meaning == "strain" or meaning in known.meanings_of(column.title)):
                named.append((role, column.label, table[unit]))
                break
    if not named:
        return
    doubt, sizes, rules = [], [], []
    for role, label, count in named:
        what, of, of_unit, size, unit = _SIZED[role]
        true = ", and a true one needs the section at that strain: export the force, as no size holds for all of it"
        doubt.append(f"'{label}' is {what}{true if 'true' in label.lower() else ''}")
        sizes.append(f"{role}={count * size:g}{unit}")
        rules.append(f"for {of} of {size} {of_unit}: one count is {count:g} x the {of.split()[-1]} in {of_unit}")
    option = "--columns " + shlex.quote(",".join(f"{role}={label}" for role, label, _ in named))
    raise log.question(" and ".join(doubt), f"{option} --units {','.join(sizes)} ({'; '.join(rules)})")


_SIZED = {
    "displacement": ("a strain, not a displacement", "a height", "mm", 30, "mm"),
    "force": ("a stress, not a force", "an area", "mm2", 1000, "N"),
}


def check_apart(chosen: Chosen, log: ImportLog) -> None:
    """Refuse one column in two roles."""
    if len({column.index for column in chosen.values()}) < len(chosen):
        names = ", ".join(f"{role} {column.label}" for role, column in chosen.items())
        raise log.question(f"one column would have two meanings ({names})", "--columns ROLE=NAME,...")


def choose_one(role: str, candidates: Sequence[Column], values: Values, log: ImportLog) -> Column:
    """Choose the one among the candidates, when they differ in nothing that matters."""
    first = candidates[0]
    why = f"unit {first.unit.text}" if first.unit else "no unit"
    why = f"name '{first.title}', {why}" if role in first.roles else why
    why = "clock times" if first.kind == "stamp" else why
    why = "given by --columns" if role in log.settings.columns else why
    moving = [one for one in candidates if len(candidates) > 1 and float(np.ptp(values[one.index])) > 0]
    if role == "time":
        moving = [one for one in moving if _rises(values[one.index])] or moving
        moving = [one for one in moving if one.kind == "number"] or moving
    if moving:
        first = moving[0]
        own = _counts(first, role, values)
        if rivals := [one for one in moving[1:] if not _same(own, _counts(one, role, values), role)]:
            names = " or ".join(f"'{one.label}'" for one in (first, *rivals))
            # by its number where another one has its name
            alone = [one.title for one in candidates].count(first.title) == 1 and not set(first.title) & set(",=")
            label = first.title if first.title and alone else str(first.index + 1)
            raise log.question(f"{role} may be {names}", f"--columns {shlex.quote(f'{role}={label}')}")
        others = ", ".join(f"'{one.label}'" for one in candidates if one is not first)
        why = f"{why}; {others} hold the same or nothing"
    log.decide(f"{role} column", first.label, why)
    return first


def _counts(column: Column, role: str, values: Values) -> NDArray:
    """Numbers of a column, in the unit that it states."""
    stated = column.unit is not None and column.unit.kind == KIND_OF_ROLE[role]
    return values[column.index] * column.unit.factor if stated and column.unit else values[column.index]


def _rises(values: NDArray) -> bool:
    return bool(np.all(np.diff(values) > 0))


def _same(one: NDArray, other: NDArray, role: str) -> bool:
    """Whether two columns differ by an offset and a sign at most (a machine's compressive copy of a channel)."""
    a, b = one - one[0], other - other[0]
    reach = 1e-4 * max(float(np.ptp(one)), 1e-300)
    return bool(np.max(np.abs(a - b)) <= reach or (role != "time" and np.max(np.abs(a + b)) <= reach))


def choose_by_behaviour(
    columns: Sequence[Column], chosen: Chosen, missing: Sequence[str], values: Values, log: ImportLog
) -> dict[str, Column]:
    """Choose columns that neither name nor unit speaks for: what rises is time, what stands in a hold is position."""
    free = [
        column
        for column in columns
        if column.index in values
        and column not in chosen.values()
        and not column.roles
        and column.unit is None
        and float(np.ptp(values[column.index])) > 0
    ]
    guess: dict[str, Column] = {}
    rising = [column for column in free if _rises(values[column.index])]
    if "time" in missing and len(rising) == 1:
        guess["time"] = rising[0]
        free.remove(rising[0])
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
    if absent := [role for role in missing if role not in guess]:
        shown = ", ".join(f"'{one.short}'" if one.title else f"column {one.index + 1}" for one in columns[:12])
        option = f"--columns {','.join(f'{role}=NAME' for role in absent)}"
        rate = ", or --rate HZ where the samples are evenly spaced" if absent == ["time"] else ""
        message = f"no column is {' or '.join(absent)} (there are {shown}); say {option}{rate}, or export it"
        raise log.fault(message, "missing", absent[0])
    # Without the units the answer would be a guess; with them the user has said what kinds of numbers these are.
    units = log.settings.units
    if not certain or any(role not in units for role in missing):
        option = "--columns " + shlex.quote(",".join(f"{role}={guess[role].label}" for role in missing))
        option += " --units " + ",".join(f"{role}={units.get(role, BASE[KIND_OF_ROLE[role]])}" for role in missing)
        listed = ", ".join(f"{role} may be column {guess[role].label}" for role in missing)
        raise log.question(
            f"neither names nor units say which column is {' or '.join(missing)}; by what they do {listed}", option
        )
    for role in missing:
        log.decide(f"{role} column", guess[role].label, _BEHAVIOUR[role])
    return guess


def _held(values: NDArray) -> float:
    """Share of samples near the end of the range that is farther from the first: there a position stands."""
    near = 0.02 * float(np.ptp(values))
    if values.max() - values[0] >= values[0] - values.min():
        return float(np.mean(values > values.max() - near))
    return float(np.mean(values < values.min() + near))


_SINCE_1970 = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_YEARS = (9.4e8, 2.3e9)
"""Seconds since 1970 of the years 2000 and 2042."""
_EXCEL_DAYS = (36500.0, 52000.0)
"""Days since 1900 of the same years."""


def find_factors(chosen: Chosen, values: Mapping[str, NDArray], log: ImportLog) -> dict[str, float]:
    """Find how many s, mm and N one count of each chosen column is."""
    units = {role: _unit(role, chosen[role], values[role], log) for role in ROLES if role in chosen}
    if missing := [role for role, unit in units.items() if unit is None]:
        parts = []
        for role in missing:
            unit = chosen[role].unit
            stated = f"is in '{unit.text}', which is not a unit of {KIND_OF_ROLE[role]}" if unit else "states no unit"
            low, high = float(values[role].min()), float(values[role].max())
            parts.append(f"{role} ('{chosen[role].label}', {low:.4g} to {high:.4g}) {stated}")
        option = ",".join(f"{role}={BASE[KIND_OF_ROLE[role]]}" for role in missing)
        raise log.question("; ".join(parts), f"--units {option}, or the units that these are in")
    return {role: unit.factor for role, unit in units.items() if unit}


def _unit(role: str, column: Column, values: NDArray, log: ImportLog) -> Unit | None:
    kind, stated, given = KIND_OF_ROLE[role], column.unit, log.settings.units.get(role)
    if given is not None:
        unit = known.scaled_unit(given, kind)
        if unit is None:
            usual = f"known are {known.USUAL_UNITS[kind]}, or a count such as 0.5{BASE[kind]}"
            raise InputError(f"--units {role}={given} is not a unit of {kind}; {usual}", "unknown_unit", "units", given)
        log.decide(f"{role} unit", unit.text, "given by --units")
        if stated is not None and stated.kind == kind and stated.factor != unit.factor:
            log.warn(
                "unit_overridden",
                f"the header says that {role} is in {stated.text}; it is taken in {unit.text}, "
                "as --units or the profile says: leave that out if the header is right",
            )
        return unit
    if column.kind == "stamp":
        log.decide("time unit", "s", "clock times, counted from the first")
        return Unit("time", 1.0, "s")
    if stated is not None and stated.kind == kind:
        factor = "" if stated.text == BASE[kind] else f"; 1 {stated.text} is {stated.factor:.6g} {BASE[kind]}"
        log.decide(f"{role} unit", stated.text, f"stated in the header{factor}")
        return stated
    if role == "time" and log.settings.rate:
        log.decide("time unit", f"counts at {log.settings.rate:g} Hz", "given by --rate")
        return Unit("time", 1.0 / log.settings.rate, f"1/{log.settings.rate:g} s")
    return _absolute(values, log) if role == "time" else None


def _absolute(values: NDArray, log: ImportLog) -> Unit | None:
    """Times that count from 1970 or 1900 show their unit by their size alone."""
    first, last = float(values[0]), float(values[-1])
    for name, factor in _SINCE_1970.items():
        if _YEARS[0] < first * factor < _YEARS[1] and 0 <= (last - first) * factor < 86400.0:
            log.decide("time unit", name, f"counts {name} since 1970 ({first:.14g})")
            return Unit("time", factor, name)
    in_days = _EXCEL_DAYS[0] < first < _EXCEL_DAYS[1] and 0 <= last - first < 1.0
    if in_days and float(np.median(np.diff(values))) < 1e-3:
        log.decide("time unit", "days", f"counts days since 1900 ({first:.10g}), as spreadsheets do")
        return Unit("time", 86400.0, "d")
    return None
