"""Command lines that pages, screens and answers name, and what the real parser says of each. Nothing is run.

A line that stands alone (in a block, under NEXT) is ``whole``: it has all that the command requires. What stands in
running text may be a part of one, such as a command and one option.
"""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from dummydesign.cli import entry
from dummydesign.core.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
PLACEHOLDERS = {"R": "15", "MM": "30", "S": "30", "KG": "2", "KPA": "30", "G": "50", "DEG": "0", "N": "1", "HZ": "100"}
"""Numbers that the reader puts in. Other words in capitals are names and files, which a parser takes as they are."""
NUMBER = re.compile("^(" + "|".join(PLACEHOLDERS) + r")$|(?<==)(MM)\b")
MISSING = re.compile(r" (is|are) required|expected (one|at least one) argument")
ASIDE = re.compile(r"\.\.\.|[\[\]()]")
FENCED = re.compile(r"```.*?```", re.DOTALL)
_START = r"^ *(?:\$ |.*&& |.*\"\$PWD:/work\" )?(?:\S*bin[/\\]|uv run )?dummydesign "
LINE = re.compile(_START + r"([a-z][a-z-]*(?: [^`\n]*)?)$", re.MULTILINE)
INLINE = re.compile(r"`(?:\w+ <\()?(dummydesign [a-z][^`]*|(?:" + "|".join(entry.COMMANDS) + r")(?: [^`]*)?)`")
STEP = re.compile(r"^(?:[A-Z]+ +| +)(?:\d\. )?dummydesign ([a-z].*)$", re.MULTILINE)
QUOTED = re.compile(r"'dummydesign ([a-z][^']*)'|\bdummydesign ([a-z][^;,'\"<>`]*)")


@dataclass(frozen=True)
class TypedLine:
    """A command line: where it stands, its text after ``dummydesign``, and whether it is all of it."""

    where: str
    text: str
    whole: bool = True

    @property
    def words(self) -> list[str]:
        """As a shell parts them."""
        return shlex.split(self.text)


def lines_of_page(text: str, where: str) -> list[TypedLine]:
    """Lines of the blocks of a page in their order, without comments, then those in its running text."""
    joined = re.sub(r"\\\n", " ", text)
    plain = re.sub(r"\s+", " ", FENCED.sub("", joined))
    blocks = [TypedLine(where, _bare(line)) for line in LINE.findall(joined)]
    return blocks + [
        TypedLine(where, _bare(line.removeprefix("dummydesign ")), False) for line in INLINE.findall(plain)
    ]


def _bare(line: str) -> str:
    """Without comment, and without what follows a bar in a table's cell."""
    bare = re.split(r" #| \\\| ", line)[0].strip()
    return bare.rstrip(")") if bare.count("(") < bare.count(")") else bare


def lines_of_screen(text: str, where: str) -> list[TypedLine]:
    """Commands of a printed answer: those that begin a line or a step are whole, those in a sentence may be parts."""
    # a step's command goes on over lines that end in a backslash, a sentence over indented lines
    joined = re.sub(r" \\\n +", " ", text)
    whole = re.findall(STEP, joined)
    sentences = re.sub(r"\n +", " ", re.sub(STEP, "", joined))
    parts = [_ended(one or other) for one, other in QUOTED.findall(sentences)]
    return [TypedLine(where, line) for line in whole] + [TypedLine(where, part, False) for part in parts]


def _ended(part: str) -> str:
    """A command in a sentence without what follows it there."""
    return re.split(r"\n| \(|\. | and |  ", part.strip())[0].strip(" .")


def lines_of_answer(answer: Any, where: str) -> Iterator[TypedLine]:
    """Every ``command`` of an answer's JSON."""
    if isinstance(answer, dict):
        command = answer.get("command")
        if isinstance(command, str) and command.startswith("dummydesign "):
            yield TypedLine(where, command.removeprefix("dummydesign "))
    for below in answer.values() if isinstance(answer, dict) else answer if isinstance(answer, list) else ():
        yield from lines_of_answer(below, where)


@cache
def parser_of(command: str) -> argparse.ArgumentParser:
    """The real parser, made once."""
    return entry.parser_of(command)


@cache
def options_of_all() -> frozenset[str]:
    """Long options of all commands."""
    return frozenset(option for command in entry.COMMANDS for option in entry._options(parser_of(command)))


def filled(words: Sequence[str]) -> list[list[str]]:
    """The words with numbers in place of placeholders and without ``...``; each of ``(A | B)`` once."""
    text = "\0".join(words)
    choice = re.search(r"\(([^()]*)\|([^()]*)\)", text)
    if choice:
        both = (text[: choice.start()] + one.strip("\0") + text[choice.end() :] for one in choice.groups())
        return [line for one in both for line in filled(one.split("\0"))]
    bare = [ASIDE.sub("", word) if word[:1] in "[(" or word[-1:] in "])" or "..." in word else word for word in words]
    numbers = [NUMBER.sub(lambda match: PLACEHOLDERS[match[0]], word) for word in bare]
    return [[word for word in numbers if word]]


@cache
def library() -> frozenset[str]:
    """Names of tissues, resins and presets that come with the package."""
    kinds = ("materials/tissues", "materials/resins", "molds")
    return frozenset(path.stem for kind in kinds for path in (ROOT / kind).glob("*.toml"))


def complaints(line: TypedLine, made: Collection[str] = ()) -> list[str]:
    """What the parser does not take of a line, and names that neither the library nor ``made`` has."""
    words = line.words
    if not words or words[0] not in entry.COMMANDS:
        return [f"{line.where}: no command: {line.text}"]
    out = []
    for one in filled(words):
        parser = parser_of(one[0])
        try:
            entry._check_options(parser, one[0], one[1:])
            given = vars(parser.parse_args(one[1:]))
            names = [*_unknown_names(given, made), *_unknown_choices(parser, one[0], given)]
            out += [f"{line.where}: unknown {name}: {line.text}" for name in names]
        except InputError as problem:
            part = (not line.whole or "..." in words) and MISSING.search(str(problem))
            out += [] if part else [f"{line.where}: {problem}: {line.text}"]
    return out


def _unknown_names(given: dict[str, Any], made: Collection[str]) -> list[str]:
    """Tissues, resins and presets that are neither of the library nor made nor files nor placeholders."""
    names = [given.get(key) for key in ("tissue", "resin", "preset")]
    known = {*library(), *made}
    return [one for one in names if one and re.fullmatch(r"[a-z][\w-]*", one) and one not in known]


def _unknown_choices(parser: argparse.ArgumentParser, command: str, given: dict[str, Any]) -> Iterator[str]:
    """Words that are none of those which an option's help explains."""
    for action in entry._options(parser).values():
        head = str(given.get(action.dest) or "").partition(":")[0]
        known = {word.partition(":")[0] for word in entry.meanings_of(command, action)} if action.metavar else set()
        if known and re.fullmatch(r"[a-z][a-z-]*", head) and head not in known:
            yield f"{action.dest} '{head}'"


def names_made(lines: Iterable[TypedLine]) -> set[str]:
    """Names of tissues and resins that lines make."""
    text = "\n".join(line.text for line in lines)
    return {one or other for one, other in re.findall(r"^tissues add\S* (\S+)|--name (\S+)", text, re.MULTILINE)}
