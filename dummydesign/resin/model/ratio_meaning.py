"""What words of a resin file say: what its ratio counts, and what the resin is as far as mould and cure depend on it.

A ratio is by weight or by volume, to 100 parts of the other components or of the whole mix.
"""

from __future__ import annotations

import re

from dummydesign.core.toml_schema import TomlTable

RATIO_BY = ("weight", "volume")
"""What the parts of a recipe are measured by."""
BY_VOLUME = "by volume"
RATIO_PER = ("others", "mix")
"""Whether the ratio is to the parts of the other components, or parts in 100 of the whole mix."""

_WEIGHT = re.compile(
    r"\bweigh|\bwt\b|\bmass\b|\bmasse|gewicht|\bgew\b|\bpoids|\bpeso\b|\bphr\b|\bw\s?[/:]\s?w\b|\bm\s?[/:]\s?m\b"
    r"|\bk?g\b|\bgrams?\b|\bgrammes?\b|\bpbw\b|重量|質量|质量|重さ|вес|масс",
    re.IGNORECASE,
)
_VOLUME = re.compile(
    r"\bvol(?!at|unt)|volum|\bv\s?[/:]\s?v\b|\bpbv\b|\b[mcd]l\b|millilit|\blit(er|re)s?\b|\bcc\b|\bccm\b|\bcm\s?(3|³|\^3)"
    r"|\bfl\.?\s?oz|fluid ounce|\bgallon|\bpints?\b|\bcups?\b|体積|容積|容量|体积|容积|объ[её]м|부피",
    re.IGNORECASE,
)
_WEIGHT_IN_VOLUME = re.compile(
    r"\b(w|m|wt|g|kg|grams?|weight|mass)\s?(/|per)\s?(\d+\s*)?(v|vol(ume)?|ml|l|dl|cc|cm\s?(3|³|\^3)|lit(er|re))\b",
    re.IGNORECASE,
)
_OF_THE_MIX = re.compile(
    r"%|per\s?cent|\bprozent|\b(of|in|per)\s+(100\s+(parts\s+)?(of\s+)?)?(the\s+)?(whole|total|mix(ture)?|blend|batch"
    r"|solution)\b(?!\w)",
    re.IGNORECASE,
)
_TO_OTHERS = re.compile(r"\bper\s+100\s+(?!(parts\s+)?(of\s+)?(the\s+)?(whole|total|mix|blend|batch|solution))", re.I)


def read_ratio_meaning(top: TomlTable, also: str = "") -> tuple[str, str, str]:
    """Read the meaning, ``ratio_by`` and ``ratio_per``; refuse words that contradict, and volume not declared.

    Parameters
    ----------
    top : Table
        The resin file; ``ratio_meaning`` is its free text.
    also : str
        Other texts that may name volume, such as the title and the components' names.

    Returns
    -------
    tuple of str
        The meaning in words, one of :data:`RATIO_BY` and one of :data:`RATIO_PER`.

    Raises
    ------
    InputError
        When the words name volume, or parts of the whole mix, and the file does not declare which is meant.
    """
    text = top.string("ratio_meaning")
    by = top.string("ratio_by", choices=RATIO_BY) if "ratio_by" in top else ""
    per = top.string("ratio_per", choices=RATIO_PER) if "ratio_per" in top else ""
    weight, volume = bool(_WEIGHT.search(text)), bool(_VOLUME.search(text))
    if _is_weight_in_volume(text):
        raise top.fault(
            "ratio_meaning",
            "is a weight in a volume; state parts by weight, or parts by volume of both",
            "unsupported",
            RATIO_BY,
        )
    if by and (weight, volume) in ((True, False), (False, True)) and volume != (by == "volume"):
        raise top.fault("ratio_by", f"contradicts ratio_meaning = {text!r}; correct one of them", "inconsistent")
    if not by and (volume or (not weight and _VOLUME.search(also))):
        said = f"{text!r} names" if volume else "title or components name"
        raise top.fault(
            "ratio_by",
            f'is missing, and {said} volume: write ratio_by = "volume" if the parts are volumes, '
            'ratio_by = "weight" if they are weights',
            "missing",
            RATIO_BY,
        )
    if not per and _OF_THE_MIX.search(text) and not _TO_OTHERS.search(text):
        raise top.fault(
            "ratio_per",
            f'is missing, and {text!r} may count parts of the whole mix: write ratio_per = "mix" if the ratio '
            'is in 100 parts of the mix, ratio_per = "others" if it is to the parts of the other components',
            "missing",
            RATIO_PER,
        )
    if by == "volume" and BY_VOLUME not in text:
        text = f"{text}, {BY_VOLUME}"
    return text, by or "weight", per or "others"


def _is_weight_in_volume(text: str) -> bool:
    """Whether one side of "per" is a weight and the other a volume."""
    if _WEIGHT_IN_VOLUME.search(text):
        return True
    first, _, last = text.partition(" per ")
    sides = {(bool(_WEIGHT.search(one)), bool(_VOLUME.search(one))) for one in (first, last)}
    return sides == {(True, False), (False, True)}


def ratio_words(meaning: str, by: str) -> str:
    """The meaning with what it is measured by, where its own words do not name that."""
    return meaning if (_VOLUME if by == "volume" else _WEIGHT).search(meaning) else f"{meaning}, by {by}"


CHEMISTRIES = ("polyurethane", "platinum silicone", "tin silicone", "silicone", "gelatin", "other")
"""Values of the key ``chemistry`` of a resin file."""

_CHEMISTRY_WORDS = (
    ("polyurethane", r"isocyanate|polyol|urethane"),
    ("tin silicone", r"(\btin\b|tin[- ]cur|condensation).*silicon|silicon.*(\btin\b|tin[- ]cur|condensation)"),
    (
        "platinum silicone",
        r"ecoflex|dragon\s?skin|(platinum|addition[- ]cur).*silicon|silicon.*(platinum|addition[- ]cur)",
    ),
    ("silicone", r"silicone|\bpdms\b|polydimethylsiloxane"),
    ("polyurethane", r"\bpur?\b"),
    ("gelatin", r"gelatine?\b|\bagar"),
)


def guessed_chemistry(*texts: str) -> str:
    """One of :data:`CHEMISTRIES` by the words of name, title and components; empty where none of them says it."""
    text = " ".join(texts).lower().replace("_", " ")
    return next((kind for kind, pattern in _CHEMISTRY_WORDS if re.search(pattern, text)), "")
