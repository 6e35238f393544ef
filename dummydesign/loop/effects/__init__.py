"""The effects that the loop knows: those in the folders here, those installed by others, and those given as a file.

A new effect is one file in ``rig``, ``material``, ``history`` or ``sensor``: nothing else names it.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.loop.model.effect import Effect, members

ROOMS = ("rig", "material", "history", "sensor")


def _find() -> tuple[Effect, ...]:
    found: list[Effect] = []
    for room in ROOMS:
        package = importlib.import_module(f"{__name__}.{room}")
        for entry in sorted(pkgutil.iter_modules(package.__path__), key=lambda one: one.name):
            found += members(importlib.import_module(f"{package.__name__}.{entry.name}"))
    return tuple(found)


EFFECTS: tuple[Effect, ...] = _find()
"""The effects of this package."""

_given: ContextVar[tuple[Effect, ...]] = ContextVar("effects_given_as_files", default=())
"""Those given as files belong to the call that was given them: other threads do not see them."""


@lru_cache(maxsize=1)
def installed_effects() -> tuple[Effect, ...]:
    """Effects that other packages offer under the entry point group ``dummydesign.effects``.

    Raises
    ------
    InputError
        When one of them cannot be loaded or breaks the contract; it names the entry point and the fault.
    """
    from dummydesign.loop.effects.own import load_installed

    return load_installed()


def known_effects() -> tuple[Effect, ...]:
    """All effects: of this package, installed by others, given as files; in this order."""
    return (*EFFECTS, *installed_effects(), *_given.get())


def foreign_effects() -> tuple[Effect, ...]:
    """Effects that are not of this package, as far as they have been loaded."""
    return (*(installed_effects() if installed_effects.cache_info().currsize else ()), *_given.get())


@contextmanager
def also(effects: tuple[Effect, ...]) -> Iterator[None]:
    """Know further effects for a while.

    Raises
    ------
    InputError
        When one has the name of another that is known.
    """
    before = _given.get()
    try:
        for effect in effects:
            if any(effect.name == other.name for other in known_effects()):
                raise InputError(f"effect '{effect.name}' is known already: give another name")
            _given.set((*_given.get(), effect))
        yield
    finally:
        _given.set(before)


def effect_named(name: str) -> Effect:
    """Find an effect by its public name."""
    known = known_effects()
    for effect in known:
        if effect.name == name:
            return effect
    raise unknown_name("effect", name, [effect.name for effect in known])
