"""Column names and units as test machines write them, in many languages: ``materials/machine-words.toml``."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from dummydesign.core.user_library import data_folder, read_toml

ROLES = ("time", "displacement", "force")
ELSE = frozenset({"stress", "strain", "counter", "other"})
"""What a name may mean that is none of them."""

_DATA = read_toml(data_folder() / "materials" / "machine-words.toml")[0]
_WORDS = {role: frozenset(" ".join(languages.values()).split()) for role, languages in _DATA["words"].items()}
_SIGNS, _PARTS = (
    sorted(((one, role) for role, text in _DATA[key].items() for one in text.split()), key=lambda pair: -len(pair[0]))
    for key in ("signs", "parts")
)
"""Parts of names with their role, the longest first."""
_SAMPLING, _FILTERS = (tuple(_DATA["sampling"][key].split()) for key in ("words", "filters"))
_RATES = {name: float(hertz) for hertz, names in _DATA["sampling"]["rates"].items() for name in names.split()}
_LETTERS = {"t": "time", "f": "force", "s": "displacement", "d": "displacement"}
"""Names of a single letter."""
_PLAIN = str.maketrans({"ß": "ss", "ł": "l", "ø": "o", "đ": "d", "ı": "i"})


def words_of(name: str) -> list[str]:
    """Return the lower-case words of a name without accents; capitals in a word and underscores separate words."""
    spaced = re.sub(r"(?<=[a-zà-ÿ])(?=[A-Z])", " ", name).lower().translate(_PLAIN)
    plain = "".join(letter for letter in unicodedata.normalize("NFKD", spaced) if not unicodedata.combining(letter))
    return re.findall(r"[^\W\d_]+", plain)


def _signs_in(name: str) -> set[str]:
    """Return the roles of the Chinese, Japanese and Korean signs in a name; a sign within a longer one is none."""
    wide, found = unicodedata.normalize("NFKC", name), set[str]()
    for sign, role in _SIGNS if not name.isascii() else ():
        if sign in wide:
            wide = wide.replace(sign, " ")
            found.add(role)
    return found


@lru_cache(4096)
def meanings_of(name: str) -> frozenset[str]:
    """Return all that a column's name speaks for: time, displacement, force, stress, strain, counter and ``other``."""
    words, found = words_of(name), _signs_in(name)
    for word in sorted(words, key=len, reverse=True):
        exact = {role for role, known in _WORDS.items() if word in known}
        part = next((role for one, role in _PARTS if word.startswith(one) or word.endswith(one)), None)
        # the z of "force.z" is an axis
        found |= (exact or ({part} if part else set())) if len(word) > 1 or not found else set()
    # libfranka's O_T_EE_d, and pose_d: the letter is that of "desired"
    if "d" in words and {"ee", "pose"} & set(words):
        found.add("other")
    if len(words) == 1 and words[0] in _LETTERS:
        found.add(_LETTERS[words[0]])
    return frozenset(found)


def roles_of_name(name: str) -> frozenset[str]:
    """Return the roles that a column's name speaks for, among time, displacement, force and ``other``.

    ``other`` is a word for something else (stress, temperature, a commanded value) and outweighs the rest:
    "Kraft Sollwert" is no measured force. Empty where the name says nothing.
    """
    found = meanings_of(name)
    # "Load cell temperature", "Position setpoint": the word for something else decides. "Sample time" is a time.
    if found & ELSE:
        return frozenset(["time"] if found - ELSE == {"time"} else ["other"])
    return found


def is_known_word(word: str) -> bool:
    """Whether a single word, as a whole, is one that columns are named by."""
    words = words_of(word)
    return bool(_signs_in(word)) or (len(words) == 1 and any(words[0] in known for known in _WORDS.values()))


def sampling_rate_in(line: str) -> float | None:
    """Return the sampling rate that a line above a table states, from its frequency or its interval. [Hz]"""
    words = words_of(line)
    sampled = any(word.startswith(_SAMPLING) for word in words) or any(one in line for one in _SAMPLING)
    if not sampled or any(word.startswith(_FILTERS) for word in words):
        return None
    numbers = re.findall(r"(?<![\w.])\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?(?![\d:])", line)
    value = float(numbers[0].replace(",", ".")) if len(numbers) == 1 else 0.0
    for word in re.split(r"[\s;,|\[\](){}:=\"\d]+", line) if value > 0.0 else ():
        if word.lower() in _RATES:
            return value * _RATES[word.lower()]
        unit = find_unit(word) if len(word) > 1 or word == "s" else None
        if unit is not None and unit.kind == "time":
            return 1.0 / (value * unit.factor)
    return None


KIND_OF_ROLE = {"time": "time", "displacement": "length", "force": "force"}
BASE = {"time": "s", "length": "mm", "force": "N"}
OTHER = "other"

_ELSEWHERE = _DATA["elsewhere"]["units"].split()
_ALIKE = str.maketrans("µμ［］（）〔〕／", "uu[]()()/")
_BRACKETS = re.compile(r"\[([^\[\]]*)\]|\(([^()]*)\)|<([^<>]*)>|\{([^{}]*)\}")
_TAIL = re.compile(r"^(.*?)(?:_|\s*/\s*|\s+in\s+|\s+en\s+|\s*:\s*|\s*,\s*|\s+|(\.))((?:[^\W\d_]|[%\"°*·⋅])+)\.?$")
_PRODUCT = re.compile(r"[kmuM]?N ?[*·⋅.]? ?(?:s|mm|cm|m)")
"""Of a force with a time or a length: an impulse or a moment, which in other letters is a unit of its own."""
_RATIO = re.compile(r"[_\s:,]([^\s_:,/]+/[^\s_:,/]+)$")


@dataclass(frozen=True)
class Unit:
    """A unit: its ``kind`` (time, length, force or other) and how many s, mm or N it is."""

    kind: str
    factor: float
    text: str


_UNITS = {
    name: Unit(kind, float(factor), name)
    for kind, factors in _DATA["units"].items()
    for factor, names in factors.items()
    for name in names.split()
}
_LOWER = Counter(name.lower() for name in _UNITS)
_ALIKE_UNITS = {name.lower(): unit for name, unit in _UNITS.items() if _LOWER[name.lower()] == 1}
"""Units that no other one is written like in other letters."""


@lru_cache(4096)
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
    if word.lower() in _ELSEWHERE or _PRODUCT.fullmatch(word):
        return Unit(OTHER, 1.0, word)
    # MN and MS are mega-units or sloppy capitals: a factor of a thousand million is nothing to guess at.
    if word in ("MN", "Mn", "mn", "M", "MS", "Ms", "G", "MIN"):
        return None
    return _ALIKE_UNITS.get(word.lower())


def scaled_unit(text: str, kind: str) -> Unit | None:
    """Like :func:`find_unit` for one kind, with an optional number before it: ``0.002s`` a count, ``10um``."""
    parts = re.fullmatch(r"\s*((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?\d+)?)?\s*\*?\s*([^\s.].*?)\s*", text)
    unit = find_unit(parts[2]) if parts else None
    if parts is None or unit is None or unit.kind != kind:
        return None
    count = float(parts[1] or 1.0)
    return Unit(kind, count * unit.factor, text.strip()) if 0 < count < float("inf") else None


USUAL_UNITS = {"time": "s, ms, us, min, h", "length": "mm, um, cm, m, in", "force": "N, mN, cN, kN, gf, kgf, lbf"}
"""The usual units of a kind, for messages."""


@lru_cache(4096)
def split_name(cell: str) -> tuple[str, Unit | None]:
    """Separate a column's name from the unit in it: ``Weg [mm]``, ``Kraft in N``, ``time_s``, ``t/s``, ``mm``."""
    text = cell.translate(_ALIKE).strip().strip('"').strip()
    for inner in _BRACKETS.finditer(text):
        if unit := find_unit(inner[0]):
            return (text[: inner.start()] + " " + text[inner.end() :]).strip(), unit
    alone = find_unit(text)
    if alone is not None and (len(text) > 1 or text in "sNсН秒"):
        return "", alone
    ratio = _RATIO.search(text)
    if ratio is not None and (unit := find_unit(ratio[1])):
        return text[: ratio.start()].strip(), unit
    if tail := _TAIL.match(text):
        unit = find_unit(tail[3])
        # A last letter such as the g of "force g" or the h of "Kanal h" is no unit unless it is set apart as one.
        if unit is not None and (len(tail[3]) > 1 or (tail[3] in "smNсН秒牛" and not tail[2])):
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
    ways = "export the test again with them"
    if list(absent) == ["time"] or ("time" in absent and len(titles) == 2):
        ways += "; 'import --rate HZ' reads evenly spaced samples, 'tissues add-points' steady forces over depth"
    return (
        f"no column is {' or '.join(absent)} (there are {shown}); {', '.join(roles[:-1])} and {roles[-1]} are "
        f"needed: {ways}"
    )
