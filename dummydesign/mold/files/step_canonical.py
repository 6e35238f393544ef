"""Make a STEP file reproducible: one text for one model, whatever the kernel's counters and hash order.

Entities are hashed by content with the hashes of what they refer to (a Merkle tree over the file's
acyclic graph), roots and unordered lists are sorted by hash, and everything is numbered anew depth first.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass

_STATEMENT = re.compile(r"#(\d+)\s*=\s*((?:[^;']++|'(?:[^']|'')*')*);")
_STRING_OR_SPACE = re.compile(r"('(?:[^']|'')*')|\s+")
_STRING_OR_REFERENCE = re.compile(r"('(?:[^']|'')*')|#(\d+)")
_REFERENCE = re.compile(r"#(\d+)")
_PIECE = re.compile(r"(?:'(?:[^']|'')*'|[^,'])*,?")
_OCCURRENCE = re.compile(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*',('(?:[^']|'')*')")
_BEYOND_ASCII = re.compile(r"[^\x00-\x7f]+")
_LINE = 78


@dataclass(frozen=True)
class Header:
    """What the header says: file name, description, time stamp and organisation."""

    name: str
    description: str
    time_stamp: str
    organisation: str


def canonical_step(text: str, header: Header) -> str:
    """Return the same model with a fixed header, in an order and a numbering that depend on content alone.

    Parameters
    ----------
    text : str
        STEP file (ISO 10303-21) whose entities refer to each other without cycles.
    header : Header
        Replaces the writer's own.

    Raises
    ------
    ValueError
        When the text has no data section or an entity refers to one that is not there.
    """
    text = _in_ascii(text)
    start, schema = text.find("DATA;"), re.search(r"FILE_SCHEMA\s*\(\s*\(\s*('[^']*')", text)
    if start < 0 or schema is None:
        raise ValueError("not a STEP file: no DATA section or no FILE_SCHEMA")
    entities = {int(number): _without_spaces(body) for number, body in _STATEMENT.findall(text, start)}
    _repair_density_unit(entities)
    for number, body in entities.items():
        if body.startswith("NEXT_ASSEMBLY_USAGE_OCCURRENCE"):
            entities[number] = _OCCURRENCE.sub(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE(\1,\1", body)
    parts = {number: _split(body) for number, body in entities.items()}
    digests = _digests(parts)
    for number, body in entities.items():
        if body.startswith("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"):
            entities[number] = _sorted_items(body, digests)
            parts[number] = _split(entities[number])
    references = {number: refers for number, (_, refers) in parts.items()}
    order = _depth_first(entities, references, digests)
    renumbered = {old: f"#{new}" for new, old in enumerate(order, 1)}
    lines = [_wrapped(f"{renumbered[old]}={_joined(parts[old], renumbered)};") for old in order]
    return "\n".join([*_header_lines(header, schema.group(1)), *lines, "ENDSEC;", "END-ISO-10303-21;", ""])


def _is_plain(body: str) -> bool:
    """Whether all strings of an entity are empty, as most are: nothing in it has to be left alone."""
    return "'" not in body.replace("''", "")


def _without_spaces(body: str) -> str:
    if _is_plain(body):
        return "".join(body.split())
    return _STRING_OR_SPACE.sub(lambda hit: hit.group(1) or "", body)


def _split(body: str) -> tuple[list[str], list[int]]:
    """What stands before, between and after the references of an entity, and the numbers they refer to."""
    if _is_plain(body):
        pieces = _REFERENCE.split(body)
        return pieces[::2], [int(number) for number in pieces[1::2]]
    texts, refers, start = [], [], 0
    for hit in _STRING_OR_REFERENCE.finditer(body):
        if hit.group(2):
            texts.append(body[start : hit.start()])
            refers.append(int(hit.group(2)))
            start = hit.end()
    return [*texts, body[start:]], refers


def _joined(parts: tuple[list[str], list[int]], names: dict[int, str]) -> str:
    """An entity with a name for each number that it refers to."""
    texts, refers = parts
    if not refers:
        return texts[0]
    return texts[0] + "".join([names[number] + text for number, text in zip(refers, texts[1:])])


def _references(body: str) -> list[int]:
    return _split(body)[1]


def _digests(parts: dict[int, tuple[list[str], list[int]]]) -> dict[int, str]:
    """Content hash of every entity, children first."""
    found: dict[int, str] = {}
    for first in parts:
        stack = [first]
        while stack:
            number = stack[-1]
            if number in found:
                stack.pop()
                continue
            if number not in parts:
                raise ValueError(f"entity #{number} is referred to but not in the file")
            missing = [child for child in parts[number][1] if child not in found]
            if missing:
                stack.extend(missing)
                continue
            found[number] = hashlib.blake2b(_joined(parts[number], found).encode(), digest_size=12).hexdigest()
            stack.pop()
    return found


def _sorted_items(body: str, digests: dict[int, str]) -> str:
    """Sort the list of styled items, whose order means nothing, by hash."""
    head, items, tail = re.match(r"(.*?\(')(?:.*?)',\(([^)]*)\)(.*)", body, re.S).group(1, 2, 3)
    numbers = sorted((int(item[1:]) for item in items.split(",")), key=lambda n: digests[n])
    return f"{head}',({','.join(f'#{n}' for n in numbers)}){tail}"


def _depth_first(entities: dict[int, str], references: dict[int, list[int]], digests: dict[int, str]) -> list[int]:
    """Order of entities, each before what it refers to, from the roots sorted by type and hash."""
    children = {child for row in references.values() for child in row}
    roots = [number for number in entities if number not in children]
    roots.sort(key=lambda n: (entities[n].split("(")[0], digests[n]))
    seen: dict[int, None] = {}
    stack = roots[::-1]
    while stack:
        number = stack.pop()
        if number not in seen:
            seen[number] = None
            stack.extend(reversed(references[number]))
    return list(seen)


def _repair_density_unit(entities: dict[int, str]) -> None:
    """Write densities in g cm^-3: the kernel's writer gives its unit the exponents 3 and 2."""
    masses = {number for number, body in entities.items() if "MASS_UNIT()" in body}
    for body in list(entities.values()):
        if not body.startswith("DERIVED_UNIT("):
            continue
        elements = _references(body)
        if len(elements) == 2 and any(_references(entities[n])[0] in masses for n in elements):
            for n in elements:
                unit = _references(entities[n])[0]
                entities[n] = f"DERIVED_UNIT_ELEMENT(#{unit},{'1.' if unit in masses else '-3.'})"


def _quoted(text: str) -> str:
    return "'" + _in_ascii(text).replace("'", "''") + "'"


def _in_ascii(text: str) -> str:
    """Write letters beyond ASCII as ISO 10303-21 does in every edition, which all readers understand."""
    return _BEYOND_ASCII.sub(_hexadecimal, text)


def _hexadecimal(hit: re.Match[str]) -> str:
    letters = hit.group()
    if max(letters) > "\uffff":
        return rf"\X4\{letters.encode('utf-32-be').hex().upper()}\X0" + "\\"
    return rf"\X2\{letters.encode('utf-16-be').hex().upper()}\X0" + "\\"


def _header_lines(header: Header, schema: str) -> list[str]:
    name, what = _quoted(header.name), _quoted(header.description)
    who = _quoted(header.organisation)
    return [
        "ISO-10303-21;",
        "HEADER;",
        f"FILE_DESCRIPTION(({what}),'2;1');",
        f"FILE_NAME({name},{_quoted(header.time_stamp)},({who}),({who}),{who},{who},'');",
        f"FILE_SCHEMA(({schema}));",
        "ENDSEC;",
        "DATA;",
    ]


def _wrapped(statement: str) -> str:
    """Break a long statement after commas outside strings."""
    if len(statement) <= _LINE:
        return statement
    lines, row = [], ""
    for piece in filter(None, _PIECE.findall(statement)):
        if row and len(row) + len(piece) > _LINE:
            lines.append(row)
            row = ""
        row += piece
    return "\n".join([*lines, row])
