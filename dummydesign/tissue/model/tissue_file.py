"""Read and write tissue files, with measured curves; errors name file and line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import KINDS, Quantity
from dummydesign.core.toml_schema import TomlTable, read_table
from dummydesign.core.user_library import Entry, data_folder, entries, find, toml_line
from dummydesign.tissue.model.laws import CURVES, known_words
from dummydesign.tissue.model.maxwell_law import LAWS, arms_of, law_named, speed_key
from dummydesign.tissue.model.measured_curves import DEPTH_MM, SHARES, HeldPress, MeasuredPerson, common_forces
from dummydesign.tissue.model.subject import FITTED, KIND, PRESSED, Subject
from dummydesign.tissue.model.tissue import Tissue, same_shape

KEYS = ("schema", "name", "title", "law", "sources", "notes", "subject", "inference")
PRESS_KEYS = ("velocity_mm_s", "depth_mm", "rise_force_N", "hold_time_s", "hold_force_N")


def subjects_of(people: Sequence[tuple[str, MeasuredPerson, str, str]]) -> tuple[Subject, ...]:
    """Make subjects of people with their presses."""
    every = [person for _, person, _, _ in people]
    speeds = sorted(set.intersection(*(set(one.velocities_mm_s) for one in every)))
    if not speeds:
        made = "; ".join(f"{name} at {', '.join(f'{v:g}' for v in one.velocities_mm_s)}" for name, one, _, _ in people)
        message = f"the people share no speed: {made} mm/s; press all at one speed"
        raise InputError(message, "inconsistent", "velocity_mm_s")
    hold = min(one.hold_known_s() for one in every)
    forces = common_forces(every, speeds, hold)
    if not forces:
        made = "; ".join(f"{name} {known_words([one])}" for name, one, _, _ in people)
        message = f"the people share no steady force within 20 %: {made}; press all to the same steady forces"
        raise InputError(message, "inconsistent", "force_N")
    subjects = []
    for name, person, kind, source in people:
        numbers: dict[str, Quantity] = {}
        words = f"{source}; the interval is what {DEPTH_MM:g} mm of depth make of it"
        for force in forces:
            depth = float(person.depth_mm(force, hold))
            exponent = CURVES.exponent_of([person], force, force, hold)
            numbers[f"depth_at_{force:g}N_mm"] = _number(depth, DEPTH_MM, kind, words)
            for speed in speeds:
                rise, after = person.shape_N(force, speed, hold)
                peak = float(max(rise.max(), after.max()))
                width = peak * exponent * DEPTH_MM / depth
                numbers[f"peak_at_{force:g}N_{speed:g}mm_s_N"] = _number(peak, width, kind, words)
        subjects.append(Subject(name, person, numbers))
    return tuple(sorted(subjects, key=lambda one: -float(np.mean(one.parameters.depth_mm(np.array(forces), hold)))))  # type: ignore[attr-defined]


def _number(value: float, width: float, kind: str, source: str) -> Quantity:
    return Quantity(value, max(value - width, 0.5 * value), value + width, kind, source)


def load_tissue(name_or_path: str) -> Tissue:
    """Load a tissue by name (any case) or from the path of a TOML file.

    Raises
    ------
    InputError
        For an unknown name, or with file, line and key for a fault in the file.
    """
    return read_tissue(find(KIND, "tissue", name_or_path))


def readable_tissues() -> tuple[list[Tissue], list[str]]:
    """Load all known tissues; a user's file that cannot be read gives a warning and the built-in one is taken."""
    tissues, problems = [], []
    for entry in entries(KIND).values():
        built_in = Entry(entry.name, data_folder() / KIND / f"{entry.name}.toml", "built-in")
        for one in [entry, *([built_in] if entry.origin == "user" and built_in.path.is_file() else [])]:
            try:
                tissues.append(read_tissue(one))
                break
            except InputError as problem:
                problems.append(str(problem))
    return tissues, problems


def read_tissue(entry: Entry) -> Tissue:
    """Read and check one tissue file."""
    top = read_table(entry.path, KEYS)
    law, tables = top.string("law", choices=LAWS), top.tables("subject")
    try:
        if law_named(law).measured:
            subjects = subjects_of([_person(table) for table in tables])
        else:
            subjects = tuple(_subject(table, law) for table in tables)
        same_shape(subjects)
    except InputError as problem:
        raise problem if str(problem).startswith(entry.path.name) else problem.within(entry.path.name) from None
    if len({subject.name.lower() for subject in subjects}) < len(subjects):
        raise top.fault("subject", "has the same name twice; names must differ", "duplicate")
    name, title = top.string("name", entry.name), top.string("title", entry.name)
    return Tissue(name, title, law, subjects, top.strings("sources", ()), top.strings("notes", ()), entry.origin)


def _fault(table: TomlTable, key: str, words: str, code: str, value: object = None) -> InputError:
    """Make the error of a key whose value is too long for a line."""
    return InputError(f"{table.where(key)}: '{key}' {words}", code, f"{table.name}.{key}", value)


def _person(table: TomlTable) -> tuple[str, MeasuredPerson, str, str]:
    """Read one [[subject]] table of measured curves."""
    table.only(("name", "kind", "source", "press"))
    name, kind, source = table.string("name"), table.string("kind", choices=KINDS), table.string("source")
    return name, MeasuredPerson([_press(press) for press in table.tables("press")]), kind, source


def _press(table: TomlTable) -> HeldPress:
    table.only(PRESS_KEYS)
    speed, depth = (table.number(key, above=0.0) for key in PRESS_KEYS[:2])
    rise, time, hold = (np.array(table.numbers(key)) for key in PRESS_KEYS[2:])
    if len(rise) != len(SHARES):
        raise _fault(table, "rise_force_N", f"has {len(rise)} numbers; {len(SHARES)} are needed", "malformed")
    if len(time) != len(hold) or len(time) < 2 or time[0] != 0.0 or np.any(np.diff(time) <= 0.0):
        words = "must rise from 0 and have as many numbers as hold_force_N, at least 2"
        raise _fault(table, "hold_time_s", words, "malformed")
    if not hold[-1] > 0.0:
        words = f"ends at {hold[-1]:g}; the force at the end of a hold is above 0"
        raise _fault(table, "hold_force_N", words, "out_of_range", float(hold[-1]))
    return HeldPress(speed, depth, rise, time, hold)


def _subject(table: TomlTable, law: str) -> Subject:
    """Read one [[subject]] table of parameters."""
    name, form = table.string("name"), law_named(law)
    table.only(["name", "pressed", *form.parameter_names(max(form.elements))])
    keys = sorted(set(table.data) - {"name", "pressed"}, key=lambda key: (key[0] == "c", key))
    numbers: dict[str, Any] = {key: (_dampers if key[0] == "c" else _positive)(table, key) for key in keys}
    arms = arms_of(numbers)
    wanted = {form.steady_name} | {f"gamma{a}_N_per_mm3" for a in arms} | {f"c{a}_N_s_per_mm" for a in arms}
    whole = 1 + 2 * len(arms) in form.elements and arms == list(range(2, 2 + len(arms)))
    if not whole or set(numbers) != wanted:
        lacking = sorted(wanted - set(numbers)) or form.parameter_names(form.elements[0])[1:]
        message = f"{table.where()}: subject '{name}' lacks {lacking[0]} or has an arm too many"
        raise InputError(message, "missing", lacking[0])
    if len({tuple(numbers[f"c{arm}_N_s_per_mm"]) for arm in arms}) > 1:
        message = f"{table.where()}: subject '{name}' has dampers at different speeds in its arms"
        raise InputError(message, "inconsistent", "c_N_s_per_mm")
    return Subject.of(name, law, numbers, _pressed(table) if "pressed" in table.data else None)


def _pressed(table: TomlTable) -> dict[str, Quantity]:
    """Read the range of the presses of a subject: all of it."""
    entry = table.data["pressed"]
    if not isinstance(entry, dict) or set(entry) - {FITTED} != set(PRESSED):
        raise _fault(table, "pressed", f"must have {', '.join(PRESSED)} and nothing else but {FITTED}", "malformed")
    flat = replace(table, data={f"pressed.{key}": one for key, one in entry.items()})
    return {key: _positive(flat, f"pressed.{key}") for key in entry}


def _dampers(table: TomlTable, key: str) -> dict[str, Quantity]:
    """Read dampers given per speed: {10 = {...}, 250 = {...}}."""
    entry = table.data[key]
    if not isinstance(entry, dict) or not entry or "value" in entry:
        raise _fault(table, key, f"must be given per speed in mm/s, such as {key}.10 and {key}.250", "malformed")
    speeds = {}
    for speed in entry:
        try:
            speeds[speed] = float(speed)
        except ValueError:
            speeds[speed] = -1.0
        if not speeds[speed] > 0:
            raise _fault(table, key, f"has speed '{speed}'; a speed in mm/s above 0 is needed", "malformed", speed)
    flat = replace(table, data={f"{key}.{speed}": number for speed, number in entry.items()})
    ordered = sorted((number, speed) for speed, number in speeds.items())
    return {speed_key(number): _positive(flat, f"{key}.{speed}") for number, speed in ordered}


def _positive(table: TomlTable, key: str) -> Quantity:
    quantity = table.quantity(key)
    if not quantity.low > 0:
        raise _fault(table, key, f"has low = {quantity.low}; it must be above 0", "out_of_range", quantity.low)
    return quantity


def tissue_toml(tissue: Tissue, extra: str = "") -> str:
    """Write a tissue as the text of a TOML file; ``extra`` is appended (such as an [inference] table)."""
    lines = ["schema = 1", f"name = {toml_line(tissue.name)}", f"title = {toml_line(tissue.title)}"]
    lines += [f"law = {toml_line(tissue.law)}", _list("sources", tissue.sources), _list("notes", tissue.notes)]
    for subject in tissue.subjects:
        lines += ["", "[[subject]]", f"name = {toml_line(subject.name)}"]
        if isinstance(subject.parameters, MeasuredPerson):
            lines += _press_lines(subject, subject.parameters)
            continue
        for key, entry in subject.numbers.items():
            if isinstance(entry, dict):
                speeds = {speed: speed if speed.isdigit() else f'"{speed}"' for speed in entry}
                lines += [f"{key}.{speeds[speed]} = {_inline(q)}" for speed, q in entry.items()]
            else:
                lines.append(f"{key} = {_inline(entry)}")
        lines += [f"pressed.{key} = {_inline(entry)}" for key, entry in subject.pressed.items()]
    return "\n".join(lines) + "\n" + (f"\n{extra.rstrip()}\n" if extra else "")


def _press_lines(subject: Subject, person: MeasuredPerson) -> list[str]:
    """Lines of a subject's kind, source and presses, after its name."""
    first = next(iter(subject.numbers.values()))
    source = first.source.partition("; the interval is ")[0]
    lines = [f"kind = {toml_line(first.kind)}", f"source = {toml_line(source)}"]
    for press in person.presses:
        lines += ["", "[[subject.press]]"]
        lines += [f"velocity_mm_s = {press.velocity_mm_s:g}", f"depth_mm = {press.depth_mm:.6g}"]
        rows = zip(PRESS_KEYS[2:], (press.rise_N, press.time_s, press.hold_N))
        for key, values in rows:
            lines.append(f"{key} = [{', '.join(f'{value:.6g}' for value in values)}]")
    return lines


def _inline(quantity: Quantity) -> str:
    numbers = ", ".join(f"{name} = {getattr(quantity, name):.5g}" for name in ("value", "low", "high"))
    return f"{{ {numbers}, kind = {toml_line(quantity.kind)}, source = {toml_line(quantity.source)} }}"


def _list(key: str, texts: tuple[str, ...]) -> str:
    if not texts:
        return f"{key} = []"
    return f"{key} = [\n" + "".join(f"  {toml_line(text)},\n" for text in texts) + "]"
