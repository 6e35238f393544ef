"""The terms of ``materials/glossary.toml``: read, found in a page, and written for the page and the documentation."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from html import escape, unescape

from dummydesign.core.datafiles import data_folder, read_toml

NOT_READ = re.compile(r"<(script|style|title|desc)\b.*?</\1>|<[^>]+>", re.DOTALL)


@dataclass(frozen=True)
class Term:
    """A term with its definition, and the other ways in which it is written."""

    name: str
    text: str
    forms: tuple[str, ...] = ()

    @property
    def pattern(self) -> str:
        """Regular expression of the term and its plural."""
        return "|".join(rf"{re.escape(form)}s?" for form in (self.name, *self.forms))


@cache
def terms() -> dict[str, Term]:
    """Terms by lower-case name and form, in the order of the alphabet."""
    content, _ = read_toml(data_folder() / "materials" / "glossary.toml")
    found = [Term(name, entry["text"], tuple(entry.get("forms", ()))) for name, entry in content["terms"].items()]
    found.sort(key=lambda term: term.name.lower())
    return {form.lower(): term for term in found for form in (term.name, *term.forms)}


@cache
def _patterns() -> tuple[tuple[Term, re.Pattern[str]], ...]:
    every = dict.fromkeys(terms().values())
    return tuple((term, re.compile(rf"(?<![\w-])(?:{term.pattern})(?![\w-])", re.IGNORECASE)) for term in every)


def terms_in(page: str) -> list[Term]:
    """Terms that the visible words of a piece of HTML use.

    Parameters
    ----------
    page : str
        HTML.
    """
    text = " ".join(unescape(NOT_READ.sub(" ", page)).split())
    return [term for term, pattern in _patterns() if pattern.search(text)]


def folded_glossary(page: str) -> str:
    """The terms that a page uses, folded away, as HTML; empty where it uses none."""
    return _folded(terms_in(page))


def whole_glossary() -> str:
    """All terms, folded away, as HTML."""
    return _folded(list(dict.fromkeys(terms().values())))


def marked_terms(text: str) -> list[tuple[int, int, Term]]:
    """Where a text uses a term for the first time: start, end and term, in the order of the text."""
    found: list[tuple[int, int, Term]] = []
    for term, pattern in _patterns():
        hit = pattern.search(text)
        if hit:
            found.append((hit.start(), hit.end(), term))
    # of terms that overlap the longest is meant
    found.sort(key=lambda one: (one[0] - one[1], one[0]))
    kept: list[tuple[int, int, Term]] = []
    for one in found:
        if all(one[1] <= other[0] or one[0] >= other[1] for other in kept):
            kept.append(one)
    return sorted(kept, key=lambda one: one[0])


def _folded(found: list[Term]) -> str:
    if not found:
        return ""
    rows = "".join(f"<dt>{escape(term.name)}</dt><dd>{escape(term.text)}</dd>" for term in found)
    return f'<details class="terms"><summary>Terms on this page</summary><dl>{rows}</dl></details>'


def glossary_page() -> str:
    """The page of the documentation, ``docs/glossary.md``."""
    lines = ["# Glossary", "", "One line a term. Reports and the studio show the same lines.", ""]
    lines += ["| term | meaning |", "|---|---|"]
    lines += [f"| {term.name} | {term.text} |" for term in dict.fromkeys(terms().values())]
    return "\n".join(lines) + "\n"
