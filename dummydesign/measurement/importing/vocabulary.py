"""Column names and units as test machines write them, in four languages: ``materials/machine-words.toml``."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

from dummydesign.core.library import data_folder, read_toml

ROLES = ("time", "displacement", "force")

_DATA = read_toml(data_folder() / "materials" / "machine-words.toml")[0]
_WORDS = {role: frozenset(" ".join(languages.values()).split()) for role, languages in _DATA["words"].items()}
_SIGNS, _PARTS = ({role: tuple(one.split()) for role, one in _DATA[key].items()} for key in ("signs", "parts"))
_LETTERS = {"t": "time", "f": "force", "s": "displacement", "d": "displacement"}
"""Names of a single letter."""


def words_of(name: str) -> list[str]:
    """Return the lower-case words of a name without accents; capitals in a word and underscores separate words."""
    spaced = re.sub(r"(?<=[a-zà-ÿ])(?=[A-Z])", " ", name).lower().replace("ß", "ss")
    plain = "".join(letter for letter in unicodedata.normalize("NFKD", spaced) if not unicodedata.combining(letter))
    return re.findall(r"[a-z]+|[^\x00-\x7f]+", plain)


def _sign_in(name: str) -> str | None:
    """Return the role of a name by the Japanese signs in it."""
    wide = unicodedata.normalize("NFKC", name)
    return next((role for role, signs in _SIGNS.items() if any(sign in wide for sign in signs)), None)


def roles_of_name(name: str) -> frozenset[str]:
    """Return the roles that a column's name speaks for, among time, displacement, force and ``other``.

    ``other`` is a word for something else (stress, temperature, a commanded value) and outweighs the rest:
    "Kraft Sollwert" is no measured force. Empty where the name says nothing.
    """
    if sign := _sign_in(name):
        return frozenset([sign])
    words = words_of(name)
    roles = {role for role, known in _WORDS.items() if known & set(words)}
    roles |= {role for role, parts in _PARTS.items() if any(w.startswith(parts) or w.endswith(parts) for w in words)}
    if len(words) == 1 and words[0] in _LETTERS:
        roles.add(_LETTERS[words[0]])
    # "Load cell temperature", "Position setpoint": the word for something else decides. "Sample time" is a time.
    if "other" in roles:
        return frozenset(roles - {"other"} if roles == {"other", "time"} else ["other"])
    return frozenset(roles)


def is_known_word(word: str) -> bool:
    """Whether a single word, as a whole, is one that columns are named by."""
    words = words_of(word)
    return _sign_in(word) is not None or (len(words) == 1 and any(words[0] in known for known in _WORDS.values()))


KIND_OF_ROLE = {"time": "time", "displacement": "length", "force": "force"}
BASE = {"time": "s", "length": "mm", "force": "N"}
OTHER = "other"

_ELSEWHERE = _DATA["elsewhere"]["units"].split()
_ALIKE = str.maketrans("µμ［］（）〔〕／", "uu[]()()/")
_BRACKETS = re.compile(r"\[([^\[\]]*)\]|\(([^()]*)\)|<([^<>]*)>|\{([^{}]*)\}")
_TAIL = re.compile(r"^(.*?)(?:_|\s*/\s*|\s+in\s+|\s+en\s+|\s*:\s*|\s*,\s*|\s+)([A-Za-zµμ%\"°秒分]+)\.?$")


@dataclass(frozen=True)
class Unit:
    """A unit: its ``kind`` (time, length, force or other) and how many s, mm or N it is."""

    kind: str
    factor: float
    text: str


_UNITS = {
    name: Unit(kind, float(factor), name)
    for kind, factors in _DATA["units"].items() for factor, names in factors.items() for name in names.split()
}  # fmt: skip


def find_unit(text: str) -> Unit | None:
    """Look a unit up as written, brackets or not; None where it is none that is known.

    ``mN`` and ``MN``, ``mm`` and ``Mm`` differ, so letters are taken as written first. In other letters a unit
    counts only when no other one of its kind is written alike.
    """
    word = text.translate(_ALIKE).strip().strip(".").strip()
    if _BRACKETS.fullmatch(word):
        word = word[1:-1].strip()
    if word in _UNITS:
        return _UNITS[word]
    if word.lower() in _ELSEWHERE:
        return Unit(OTHER, 1.0, word)
    # MN and MS are mega-units or sloppy capitals: a factor of a thousand million is nothing to guess at.
    if word in ("MN", "Mn", "mn", "M", "MS", "Ms", "G", "MIN"):
        return None
    alike = [unit for name, unit in _UNITS.items() if name.lower() == word.lower()]
    return alike[0] if len(alike) == 1 else None


def scaled_unit(text: str, kind: str) -> Unit | None:
    """Like :func:`find_unit` for one kind, with an optional number before it: ``0.002s`` a count, ``10um``."""
    parts = re.fullmatch(r"\s*([0-9.]+(?:[eE][+-]?\d+)?)?\s*\*?\s*(\S.*?)\s*", text)
    if parts is None:
        return None
    unit = find_unit(parts[2])
    try:
        count = float(parts[1] or 1.0)
    except ValueError:
        return None
    if unit is None or unit.kind != kind or not 0 < count < float("inf"):
        return None
    return Unit(kind, count * unit.factor, text.strip())


USUAL_UNITS = {"time": "s, ms, us, min, h", "length": "mm, um, cm, m, in", "force": "N, mN, cN, kN, gf, kgf, lbf"}
"""The usual units of a kind, for messages."""


def split_name(cell: str) -> tuple[str, Unit | None]:
    """Separate a column's name from the unit in it: ``Weg [mm]``, ``Kraft in N``, ``time_s``, ``t/s``, ``mm``."""
    text = cell.translate(_ALIKE).strip().strip('"').strip()
    for inner in _BRACKETS.finditer(text):
        unit = find_unit(inner[0])
        if unit is not None:
            return (text[: inner.start()] + " " + text[inner.end() :]).strip(), unit
    alone = find_unit(text)
    if alone is not None and (len(text) > 1 or text in "sN"):
        return "", alone
    tail = _TAIL.match(text)
    if tail is not None:
        unit = find_unit(tail[2])
        # A last letter such as the g of "force g" or the h of "Kanal h" is no unit unless it is set apart as one.
        if unit is not None and (len(tail[2]) > 1 or tail[2] in "smN"):
            return tail[1].strip(), unit
    return text, None


def absent_roles(titles: Sequence[str], roles: Sequence[str] = ROLES) -> tuple[str, ...]:
    """Return the roles that no column can have: no name speaks for them, and too few other columns are left."""
    speaks = [roles_of_name(split_name(title)[0]) & set(ROLES) for title in titles]
    absent = tuple(role for role in roles if not any(role in named for named in speaks))
    return absent if sum(not named for named in speaks) < len(absent) else ()


def absent_words(absent: Sequence[str], titles: Sequence[str], roles: Sequence[str] = ROLES) -> str:
    """Return the words of an error: which columns are missing and what to do."""
    shown = ", ".join(f"'{title[:40]}'" if title else f"column {at}" for at, title in enumerate(titles[:12], 1))
    return (f"no column is {' or '.join(absent)} (there are {shown}); {', '.join(roles[:-1])} and {roles[-1]} are "
            "needed: export the test again with them")  # fmt: skip
