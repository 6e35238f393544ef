"""Column names and units as test machines write them, in four languages."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

ROLES = ("time", "displacement", "force")

_WORDS: dict[str, str] = {
    "time": (
        "time elapsed timestamp seconds secs clock "
        "zeit prufzeit pruefzeit testzeit messzeit laufzeit versuchszeit zeitstempel uhrzeit sekunden "
        "temps duree horodatage secondes heure"
    ),
    "displacement": (
        "displacement disp extension position pos depth indentation travel stroke crosshead deflection penetration "
        "deformation compression lvdt distance z "
        "weg standardweg traversenweg kolbenweg prufweg pruefweg verschiebung abstand eindringtiefe eindringung "
        "eindruckweg "
        "tiefe hub verformung stauchung stauchweg langenanderung laengenaenderung "
        "deplacement course profondeur enfoncement allongement fleche ecrasement"
    ),
    "force": (
        "force load fz "
        "kraft standardkraft prufkraft pruefkraft druckkraft normalkraft presskraft last belastung "
        "charge effort"
    ),
    "other": (
        "stress strain strength modulus temperature torque moment speed velocity rate energy work pressure voltage "
        "cycle cycles step sample samples index count segment status mode channel nr no number date datum id specimen "
        "error flow width diameter area acceleration frequency setpoint tx ty tz mx my mz rx ry rz "
        "spannung dehnung temperatur drehmoment geschwindigkeit arbeit energie druck zyklus zyklen schritt "
        "messwert probe breite flache flaeche modul "
        "contrainte temperature couple vitesse travail pression cycle cycles echantillon module "
        "target command commanded reference demand desired cmd soll sollwert sollweg sollkraft fuhrungsgrosse vorgabe "
        "consigne"
    ),
}  # fmt: skip
_KANJI: dict[str, tuple[str, ...]] = {
    "other": tuple("応力 ひずみ 歪 温度 速度 トルク 圧力 番号 サイクル 指令 目標 電圧 日付".split()),
    "time": tuple("時間 時刻 経過".split()),
    "displacement": tuple("変位 位置 ストローク 押込 押し込み 深さ 圧縮量 たわみ 伸び 移動量".split()),
    "force": tuple("荷重 試験力 押付力 反力 力".split()),
}
_COMPOUND: dict[str, tuple[str, ...]] = {
    "other": tuple("soll spannung geschwindigkeit temperatur dehnung setpoint velocity stress strain".split()),
    "time": ("zeit", "timestamp"),
    "displacement": ("weg", "verschiebung", "displacement", "extension", "eindring"),
    "force": ("kraft", "force"),
}
_LETTERS = {"t": "time", "f": "force", "s": "displacement", "d": "displacement"}
"""Names of a single letter."""
_SETS = {role: frozenset(words.split()) for role, words in _WORDS.items()}


def words_of(name: str) -> list[str]:
    """Return the lower-case words of a name without accents; capitals in a word and underscores separate words."""
    spaced = re.sub(r"(?<=[a-zà-ÿ])(?=[A-Z])", " ", name).lower().replace("ß", "ss")
    plain = "".join(letter for letter in unicodedata.normalize("NFKD", spaced) if not unicodedata.combining(letter))
    return re.findall(r"[a-z]+|[^\x00-\x7f]+", plain)


def _sign_in(name: str) -> str | None:
    """Return the role of a name by the Chinese characters in it."""
    wide = unicodedata.normalize("NFKC", name)
    return next((role for role, signs in _KANJI.items() if any(sign in wide for sign in signs)), None)


def roles_of_name(name: str) -> frozenset[str]:
    """Return the roles that a column's name speaks for, among time, displacement, force and ``other``.

    ``other`` is a word for something else (stress, temperature, a commanded value) and outweighs the rest:
    "Kraft Sollwert" is no measured force. Empty where the name says nothing.
    """
    if sign := _sign_in(name):
        return frozenset([sign])
    words = words_of(name)
    roles = {role for role, known in _SETS.items() if known & set(words)}
    roles |= {role for role, parts in _COMPOUND.items() if any(w.startswith(parts) or w.endswith(parts) for w in words)}
    if len(words) == 1 and words[0] in _LETTERS:
        roles.add(_LETTERS[words[0]])
    # "Load cell temperature", "Position setpoint": the word for something else decides. "Sample time" is a time.
    if "other" in roles:
        return frozenset(roles - {"other"} if roles == {"other", "time"} else ["other"])
    return frozenset(roles)


def is_known_word(word: str) -> bool:
    """Whether a single word, as a whole, is one that columns are named by."""
    words = words_of(word)
    return _sign_in(word) is not None or (len(words) == 1 and any(words[0] in known for known in _SETS.values()))


KIND_OF_ROLE = {"time": "time", "displacement": "length", "force": "force"}
BASE = {"time": "s", "length": "mm", "force": "N"}
OTHER = "other"

_G = 9.80665e-3
"""Weight of one gram at standard gravity. [N]"""
_FACTORS: dict[str, dict[str, float]] = {
    "time": {
        "s": 1.0, "sec": 1.0, "secs": 1.0, "sek": 1.0, "second": 1.0, "seconds": 1.0, "sekunde": 1.0, "sekunden": 1.0,
        "seconde": 1.0, "secondes": 1.0, "秒": 1.0, "ms": 1e-3, "msec": 1e-3, "msek": 1e-3, "millisecond": 1e-3,
        "milliseconds": 1e-3, "ミリ秒": 1e-3, "us": 1e-6, "usec": 1e-6, "ns": 1e-9, "min": 60.0, "mins": 60.0,
        "minute": 60.0, "minutes": 60.0, "minuten": 60.0, "分": 60.0, "h": 3600.0, "hr": 3600.0, "hours": 3600.0,
        "d": 86400.0, "days": 86400.0,
    },
    "length": {
        "mm": 1.0, "millimeter": 1.0, "millimeters": 1.0, "millimetre": 1.0, "millimetres": 1.0, "ミリ": 1.0,
        "m": 1e3, "meter": 1e3, "metre": 1e3, "meters": 1e3, "metres": 1e3, "cm": 10.0, "dm": 100.0, "um": 1e-3,
        "micron": 1e-3, "microns": 1e-3, "micrometer": 1e-3, "nm": 1e-6, "in": 25.4, "inch": 25.4, "inches": 25.4,
        "zoll": 25.4, '"': 25.4, "mil": 0.0254, "mils": 0.0254, "thou": 0.0254, "ft": 304.8,
    },
    "force": {
        "N": 1.0, "newton": 1.0, "newtons": 1.0, "ニュートン": 1.0, "mN": 1e-3, "millinewton": 1e-3, "uN": 1e-6,
        "kN": 1e3, "kilonewton": 1e3, "cN": 1e-2, "dN": 0.1, "daN": 10.0, "gf": _G, "g": _G, "gram": _G, "grams": _G,
        "kgf": 1e3 * _G, "kg": 1e3 * _G, "kp": 1e3 * _G, "p": _G, "lbf": 4.4482216152605, "lb": 4.4482216152605,
        "lbs": 4.4482216152605, "ozf": 0.27801385095378125, "oz": 0.27801385095378125, "dyn": 1e-5,
    },
}  # fmt: skip
_ELSEWHERE = (
    "% mpa kpa pa gpa hpa bar n/mm2 n/mm² n/mm^2 kn/m2 mm/mm mm/s mm/min m/s n/s n/mm n/m v mv a ma °c c degc k °f °"
    " deg rad nm/rad nmm ncm n·m n.m n*m j mj hz khz rpm - -/- 1/s u/min kg/m3"
).split()
_ALIKE = str.maketrans("µμ［］（）〔〕／", "uu[]()()/")
_BRACKETS = re.compile(r"\[([^\[\]]*)\]|\(([^()]*)\)|<([^<>]*)>|\{([^{}]*)\}")
_TAIL = re.compile(r"^(.*?)(?:_|\s*/\s*|\s+in\s+|\s+en\s+|\s*:\s*|\s*,\s*|\s+)([A-Za-zµμ%\"°秒分]+)\.?$")


@dataclass(frozen=True)
class Unit:
    """A unit: its ``kind`` (time, length, force or other) and how many s, mm or N it is."""

    kind: str
    factor: float
    text: str


_UNITS = {name: Unit(kind, factor, name) for kind, table in _FACTORS.items() for name, factor in table.items()}


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
    return (
        f"no column is {' or '.join(absent)} (there are {shown}); {', '.join(roles[:-1])} and {roles[-1]} are needed: "
        "export the test again with them"
    )
