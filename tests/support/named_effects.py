"""Effects by their public names."""

from __future__ import annotations

from dummydesign.loop.effects.registry import known_effects
from dummydesign.loop.model.effect import Effect


def effect_named(name: str) -> Effect:
    """The effect of this name; KeyError where there is none."""
    return {effect.name: effect for effect in known_effects()}[name]
