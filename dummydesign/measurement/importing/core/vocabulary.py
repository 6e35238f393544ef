"""What test machines call time, displacement and force in English, German, French and Japanese."""

from __future__ import annotations

import re
import unicodedata

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
    "other": (
        *("応力", "ひずみ", "歪", "温度", "速度", "トルク", "圧力"),
        *("番号", "サイクル", "指令", "目標", "電圧", "日付"),
    ),
    "time": ("時間", "時刻", "経過"),
    "displacement": ("変位", "位置", "ストローク", "押込", "押し込み", "深さ", "圧縮量", "たわみ", "伸び", "移動量"),
    "force": ("荷重", "試験力", "押付力", "反力", "力"),
}  # fmt: skip
_COMPOUND: dict[str, tuple[str, ...]] = {
    "other": (
        "soll",
        "spannung",
        "geschwindigkeit",
        "temperatur",
        "dehnung",
        "setpoint",
        "velocity",
        "stress",
        "strain",
    ),
    "time": ("zeit", "timestamp"),
    "displacement": ("weg", "verschiebung", "displacement", "extension", "eindring"),
    "force": ("kraft", "force"),
}
_SETS = {role: frozenset(words.split()) for role, words in _WORDS.items()}


def words_of(name: str) -> list[str]:
    """Lower-case words of a name without accents; capitals inside a word and underscores part words."""
    apart = re.sub(r"(?<=[a-zà-ÿ])(?=[A-Z])", " ", name)
    plain = unicodedata.normalize("NFKD", apart.lower().replace("ß", "ss"))
    plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
    return re.findall(r"[a-z]+|[^\x00-\x7f]+", plain)


def roles_of_name(name: str) -> frozenset[str]:
    """Roles that a column's name speaks for, among time, displacement, force and ``other``.

    ``other`` is a word for something else (stress, temperature, a commanded value) and outweighs the rest:
    "Kraft Sollwert" is no measured force. Empty where the name says nothing.
    """
    kanji = unicodedata.normalize("NFKC", name)
    for role, signs in _KANJI.items():
        if any(sign in kanji for sign in signs):
            return frozenset([role])
    words = words_of(name)
    found = {role for role, known in _SETS.items() if known & set(words)}
    for role, parts in _COMPOUND.items():
        if any(word.startswith(part) or word.endswith(part) for word in words for part in parts):
            found.add(role)
    if len(words) == 1 and len(words[0]) == 1:
        found |= {"t": {"time"}, "f": {"force"}, "s": {"displacement"}, "d": {"displacement"}}.get(words[0], set())
    if "other" in found:
        # "Load cell temperature", "Position setpoint": the word for something else decides. "Sample time" and
        # "Cycle elapsed time" are times all the same.
        return frozenset(["time"]) if found == {"other", "time"} else frozenset(["other"])
    return frozenset(found)


def is_known_word(word: str) -> bool:
    """Whether a single word, as a whole, is one that columns are named by."""
    kanji = unicodedata.normalize("NFKC", word)
    if any(sign in kanji for signs in _KANJI.values() for sign in signs):
        return True
    words = words_of(word)
    return len(words) == 1 and any(words[0] in known for known in _SETS.values())
