"""What a resin is, as far as mould, release and cure depend on it."""

from __future__ import annotations

import re

CHEMISTRIES = ("polyurethane", "platinum silicone", "tin silicone", "silicone", "gelatin", "other")
"""Values of the key ``chemistry`` of a resin file."""

_WORDS = (
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
    return next((kind for kind, pattern in _WORDS if re.search(pattern, text)), "")
