"""Laws of the long-term modulus against the mixing ratio, one line in :data:`LAWS` each, and what a ratio counts.

A law has no numbers of its own: its parameters come as a mapping of name to value or to an array of draws, so that
one formula serves the central curve, the posterior and the update.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.toml_schema import TomlTable

Parameters = Mapping[str, ArrayLike]


@dataclass(frozen=True)
class ModulusLaw:
    """A law: its name, its parameters (unit in the name), and formulas that take these after their first argument.

    ``direction`` is +1 when the modulus grows with the ratio and -1 when it falls. ``modulus`` maps a ratio to kPa,
    ``inverse`` back; ``makes_sense`` tells where the parameters do from a lowest ratio upwards.
    """

    name: str
    parameters: tuple[str, ...]
    direction: int
    modulus: Callable[..., NDArray]
    inverse: Callable[..., NDArray]
    makes_sense: Callable[..., NDArray]

    @property
    def way(self) -> str:
        """What the modulus does with the ratio."""
        return "grow" if self.direction > 0 else "fall"

    def young_kPa(self, ratio: ArrayLike, parameters: Parameters) -> NDArray:
        """Long-term Young's modulus [kPa]; ``ratio`` and parameters broadcast."""
        return self.modulus(np.asarray(ratio, float), *self._values(parameters))

    def ratio(self, young_kPa: ArrayLike, parameters: Parameters) -> NDArray:
        """Ratio that gives a modulus, the inverse of :meth:`young_kPa`; NaN where none does."""
        return self.inverse(np.asarray(young_kPa, float), *self._values(parameters))

    def valid(self, lowest_ratio: float, parameters: Parameters) -> NDArray:
        """Tell where the parameters make sense from ``lowest_ratio`` upwards."""
        return self.makes_sense(lowest_ratio, *self._values(parameters))

    def _values(self, parameters: Parameters) -> list[NDArray]:
        return [np.asarray(parameters[name], float) for name in self.parameters]


def _gel_young(ratio: NDArray, young_ref: NDArray, ref: NDArray, share: NDArray, exponent: NDArray) -> NDArray:
    """Network below stoichiometry: E = E_ref ((r - r_c) / (r_ref - r_c))^t, zero at the gel point r_c and below.

    Exponent t is 3 in mean field and about 1.7 to 2.7 in percolation.

    References
    ----------
    Stauffer, Coniglio and Adam, Adv. Polym. Sci. 44 (1982) 103 (modulus near the gel point);
    Macosko and Miller, Macromolecules 9 (1976) 199 (ideal network, mean field).
    """
    gel = share * ref
    return young_ref * (np.maximum(ratio - gel, 0.0) / (ref - gel)) ** exponent


def _gel_ratio(young: NDArray, young_ref: NDArray, ref: NDArray, share: NDArray, exponent: NDArray) -> NDArray:
    gel = share * ref
    return gel + (ref - gel) * (young / young_ref) ** (1.0 / exponent)


def _fraction_young(ratio: NDArray, neat: NDArray, exponent: NDArray) -> NDArray:
    """Network thinned by an inert liquid: E = E_0 phi^n with phi = 100 / (100 + r), r parts of thinner.

    References
    ----------
    Obukhov, Rubinstein and Colby, Macromolecules 27 (1994) 3191 (modulus against polymer fraction).
    """
    return neat * (100.0 / (100.0 + ratio)) ** exponent


LAWS = {
    law.name: law
    for law in (
        ModulusLaw(
            "gel_point",
            ("young_ref_kPa", "ratio_ref", "gel_ratio_over_ref", "exponent"),
            1,
            _gel_young,
            _gel_ratio,
            # the gel point lies below the lowest ratio and below the reference
            lambda lowest, _, ref, share, power: (share * ref < lowest) & (share < 1.0) & (share > 0.0) & (power > 0),
        ),
        ModulusLaw(
            "polymer_fraction",
            ("young_neat_kPa", "exponent"),
            -1,
            _fraction_young,
            lambda young, neat, exponent: 100.0 * ((young / neat) ** (-1.0 / exponent) - 1.0),
            lambda _, neat, exponent: exponent > 0,
        ),
        # one mix with one modulus, for a product that is mixed at one ratio only
        ModulusLaw(
            "fixed",
            ("young_kPa",),
            1,
            lambda ratio, young: young + np.zeros(np.shape(ratio)),
            lambda other, young: np.full(np.shape(other), np.nan),
            lambda _, young: young > 0,
        ),
    )
}
"""Known laws by the name used in resin files."""


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
