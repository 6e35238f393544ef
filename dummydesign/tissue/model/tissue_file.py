"""Tissue files: read with errors that name file and line, and written so that they can be read again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import Entry, data_folder, entries, find, read_toml, toml_line
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import Quantity, line_of, read_quantity
from dummydesign.tissue.model.curves_file import press_lines, read_people
from dummydesign.tissue.model.laws import LAWS, law_named
from dummydesign.tissue.model.maxwell_law import arms_of
from dummydesign.tissue.model.parameters import Parameters, speed_key
from dummydesign.tissue.model.tissue import Subject, Tissue, same_shape

KIND = "materials/tissues"
_TOP = ("schema", "name", "title", "law", "sources", "notes", "subject", "inference")


def tissue_entries() -> dict[str, Entry]:
    """List the known tissues by lower-case name, the user's own winning over the built-in ones."""
    return entries(KIND)


def load_tissue(name_or_path: str) -> Tissue:
    """Load a tissue by name (any case) or from the path of a TOML file.

    Raises
    ------
    InputError
        For an unknown name, or with file, line and key for a fault in the file.
    """
    entry = find(KIND, "tissue", name_or_path)
    content, text = read_toml(entry.path)
    return parse_tissue(content, text, entry)


def readable_tissues() -> tuple[list[Tissue], list[str]]:
    """Load all known tissues; a user's file that cannot be read gives a warning and the built-in one is taken."""
    found, problems = [], []
    for entry in tissue_entries().values():
        places = [entry]
        if entry.origin == "user":
            built_in = data_folder() / KIND / f"{entry.name}.toml"
            places += [Entry(entry.name, built_in, "built-in")] if built_in.is_file() else []
        for place in places:
            try:
                content, text = read_toml(place.path)
                found.append(parse_tissue(content, text, place))
                break
            except InputError as problem:
                problems.append(str(problem))
    return found, problems


def parse_tissue(content: dict[str, Any], text: str, entry: Entry) -> Tissue:
    """Check the content of a tissue file and make the Tissue.

    Parameters
    ----------
    content : dict
        The file as TOML gives it.
    text : str
        The file's text, from which the line in a message is taken.
    entry : Entry
        Name, path and origin of the file.

    Raises
    ------
    InputError
        With file and line, for a key or number that the schema or the law does not allow.
    """
    path = entry.path
    for key in content:
        if key not in _TOP:
            problem = unknown_name("key", key, _TOP)
            raise InputError(f"{path.name}:{line_of(text, key)}: {problem}")
    if content.get("schema") != 1:
        raise InputError(f"{path.name}: schema = {content.get('schema')!r}; this version reads schema = 1")
    law = content.get("law")
    if law not in LAWS:
        raise InputError(f"{path.name}:{line_of(text, 'law')}: {unknown_name('law', str(law), LAWS)}")
    raw = content.get("subject")
    if not isinstance(raw, list) or not raw:
        raise InputError(f"{path.name}: needs at least one [[subject]]")
    if law_named(law).measured:
        subjects = read_people(raw, path)
    else:
        subjects = tuple(_subject(item, law, path, text, number) for number, item in enumerate(raw, start=1))
    names = [subject.name.lower() for subject in subjects]
    if len(set(names)) != len(names):
        raise InputError(f"{path.name}: two subjects have the same name; names must differ")
    try:
        same_shape(subjects)
    except InputError as problem:
        raise InputError(f"{path.name}: {problem}") from None
    return Tissue(
        str(content.get("name", entry.name)),
        str(content.get("title", entry.name)),
        law,
        subjects,
        _texts(content, "sources", path, text),
        _texts(content, "notes", path, text),
        entry.origin,
    )


def _texts(content: dict[str, Any], key: str, path: Path, text: str) -> tuple[str, ...]:
    value = content.get(key, [])
    if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
        raise InputError(f"{path.name}:{line_of(text, key)}: {key} must be a list of texts")
    return tuple(value)


def _subject(item: dict[str, Any], law: str, path: Path, text: str, number: int) -> Subject:
    """Read one [[subject]] table."""
    name = item.get("name")
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"{path.name}: subject {number} has no name")
    # line numbers are searched from this subject's own name on
    rest = "\n" * (line_of(text, f'"{name}"') - 1) + text.split("\n", line_of(text, f'"{name}"') - 1)[-1]
    form = law_named(law)
    known = form.parameter_names(max(form.elements))
    numbers: dict[str, Any] = {}
    for key, value in item.items():
        if key == "name":
            continue
        if key not in known:
            last = max(form.elements) // 2 + 1
            allowed = f"gamma1_N_per_mm3 .. gamma{last}_N_per_mm3, c2_N_s_per_mm .. c{last}_N_s_per_mm"
            allowed = allowed if last > 1 else form.steady_name
            raise InputError(f"{path.name}:{line_of(rest, key)}: unknown key '{key}'; known are name, {allowed}")
        if key.startswith("gamma") or key == form.steady_name:
            numbers[key] = read_quantity(item, key, path, rest)
        else:
            numbers[key] = _dampers(value, key, path, rest)
        _positive(numbers[key], key, path, rest)
    arms = arms_of(numbers)
    wanted = {form.steady_name} | {f"gamma{a}_N_per_mm3" for a in arms} | {f"c{a}_N_s_per_mm" for a in arms}
    whole = 1 + 2 * len(arms) in form.elements and arms == list(range(2, 2 + len(arms)))
    if not whole or set(numbers) != wanted:
        lacking = sorted(wanted - set(numbers)) or form.parameter_names(form.elements[0])[1:]
        raise InputError(f"{path.name}: subject '{name}' lacks {lacking[0]} or has an arm too many")
    speeds = {tuple(sorted(numbers[f"c{arm}_N_s_per_mm"], key=float)) for arm in arms}
    if arms and len(speeds) != 1:
        raise InputError(f"{path.name}: subject '{name}' has dampers at different speeds in its arms")
    plain = {
        key: {speed: q.value for speed, q in entry.items()} if isinstance(entry, dict) else entry.value
        for key, entry in numbers.items()
    }
    ordered = {key: numbers[key] for key in sorted(numbers, key=lambda k: (k[0] == "c", k))}
    return Subject(name, Parameters.from_dict(law, plain), ordered)


def _dampers(value: Any, key: str, path: Path, text: str) -> dict[str, Quantity]:
    """Read dampers given per speed: {10 = {...}, 250 = {...}}."""
    where = f"{path.name}:{line_of(text, key)}: "
    if not isinstance(value, dict) or not value or "value" in value:
        raise InputError(f"{where}'{key}' must be given per speed in mm/s, such as {key}.10 and {key}.250")
    found = {}
    for speed in value:
        try:
            number = float(speed)
        except ValueError:
            number = -1.0
        if not number > 0:
            raise InputError(f"{where}'{key}' has speed '{speed}'; a speed in mm/s above 0 is needed")
        try:
            found[speed_key(number)] = read_quantity(value, speed, path)
        except InputError as problem:
            raise InputError(f"{where}{str(problem).removeprefix(path.name + ': ')} in '{key}'") from None
    return dict(sorted(found.items(), key=lambda pair: float(pair[0])))


def _positive(entry: Any, key: str, path: Path, text: str) -> None:
    for quantity in entry.values() if isinstance(entry, dict) else [entry]:
        if not quantity.low > 0:
            raise InputError(f"{path.name}:{line_of(text, key)}: '{key}' low = {quantity.low}; it must be above 0")


def tissue_toml(tissue: Tissue, extra: str = "") -> str:
    """Write a tissue as the text of a TOML file; ``extra`` is appended (such as an [inference] table)."""
    lines = ["schema = 1", f"name = {toml_line(tissue.name)}", f"title = {toml_line(tissue.title)}"]
    lines += [f"law = {toml_line(tissue.law)}", _list("sources", tissue.sources), _list("notes", tissue.notes)]
    for subject in tissue.subjects:
        lines += ["", "[[subject]]", f"name = {toml_line(subject.name)}"]
        if tissue.measured:
            lines += press_lines(subject)
            continue
        for key, entry in subject.numbers.items():
            if isinstance(entry, dict):
                lines += [f"{key}.{_speed(speed)} = {_inline(q)}" for speed, q in entry.items()]
            else:
                lines.append(f"{key} = {_inline(entry)}")
    return "\n".join(lines) + "\n" + (f"\n{extra.rstrip()}\n" if extra else "")


def _speed(speed: str) -> str:
    return speed if speed.isdigit() else f'"{speed}"'


def _inline(quantity: Quantity) -> str:
    numbers = ", ".join(f"{name} = {getattr(quantity, name):.5g}" for name in ("value", "low", "high"))
    return f"{{ {numbers}, kind = {toml_line(quantity.kind)}, source = {toml_line(quantity.source)} }}"


def _list(key: str, texts: tuple[str, ...]) -> str:
    if not texts:
        return f"{key} = []"
    return f"{key} = [\n" + "".join(f"  {toml_line(text)},\n" for text in texts) + "]"
