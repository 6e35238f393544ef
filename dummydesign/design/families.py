"""The families of shapes that can be designed with, each bound to its response surface."""

from __future__ import annotations

from functools import lru_cache

from dummydesign.design.shape_family import Family
from dummydesign.errors import unknown_name

FAMILIES = ("crowned",)


@lru_cache
def load_family(kind: str) -> Family:
    """Load the family of one kind.

    Raises
    ------
    InputError
        For a kind without a response surface.
    """
    if kind not in FAMILIES:
        raise unknown_name("family of shapes", kind, FAMILIES)
    from dummydesign.design.crowned import CrownedFamily

    return CrownedFamily()
