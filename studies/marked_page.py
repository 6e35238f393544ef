"""Pages of the documentation that a study writes: tables between two marks, and prose in lines of 120 characters."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text


@dataclass(frozen=True)
class MarkedPage:
    """A page below a repository's folder and the marks that hold what is made."""

    path: Path
    begin: str
    end: str

    def read(self, repository: Path) -> str:
        """Text of the page.

        Raises
        ------
        InputError
            When the page or its marks are missing; asked before the work starts.
        """
        path = repository / self.path
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        if self.begin not in text or self.end not in text:
            message = f"{path} with the marks '{self.begin}' and '{self.end}' is missing; run in the repository"
            raise InputError(message, "missing", "page", str(path))
        return text

    def write(self, repository: Path, made: str) -> None:
        """Put text between the marks; what stands outside them stays.

        Raises
        ------
        InputError
            As :meth:`read`.
        """
        text = self.read(repository)
        head, tail = text.split(self.begin)[0], text.split(self.end)[1]
        write_text(repository / self.path, f"{head}{self.begin}\n\n{made}\n{self.end}{tail}")


WIDTH = 120
ITEM = re.compile(r"( *(?:[-*]|\d+\.) +)")
AS_IT_IS = ("#", "|", "!", "<!--", "    ")
"""Beginnings of lines that are kept: headings, tables, pictures, marks, code."""


def wrapped(markdown: str) -> str:
    """Markdown with paragraphs and list items in lines of at most 120 characters; tables, code and headings stay."""
    lines: list[str] = []
    words: list[str] = []
    first = rest = ""
    fenced = False

    def end() -> None:
        if words:
            lines.extend(_lines(words, first, rest))
            words.clear()

    for line in markdown.splitlines():
        item = ITEM.match(line)
        fence = line.startswith("```")
        if fence or fenced or not line.strip() or line.startswith(AS_IT_IS):
            end()
            fenced = fenced != fence
            lines.append(line)
        elif item:
            end()
            first, rest = item[1], " " * len(item[1])
            words += line[len(first) :].split()
        else:
            if not words or (rest and not line.startswith(rest)):
                end()
                first = rest = line[: len(line) - len(line.lstrip())]
            words += line.split()
    end()
    return "\n".join(lines) + "\n"


def _lines(words: list[str], first: str, rest: str) -> list[str]:
    """Words in lines; a word that would make a line a list item or a heading stays on the line before."""
    out = [first + words[0]]
    for word in words[1:]:
        if len(out[-1]) + 1 + len(word) > WIDTH and not re.fullmatch(r"[-*+]|\d+[.)]|[#>|].*", word):
            out.append(rest + word)
        else:
            out[-1] += " " + word
    return out
