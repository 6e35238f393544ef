"""The effects that the loop knows: those in the folders here, those installed by others, and those given as a file.

A new effect is one file in ``rig``, ``material``, ``history`` or ``sensor``: nothing else names it.
"""

from __future__ import annotations

import importlib
import importlib.util
import pkgutil
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from hashlib import sha256
from importlib.metadata import entry_points
from pathlib import Path

from dummydesign.core.errors import DummydesignError, InputError
from dummydesign.core.files import check_file
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.effects.contract_check import check_effect, faults_on, problem_text
from dummydesign.loop.model.effect import Effect, SetupLaw, effect_classes, members

ROOMS = ("rig", "material", "history", "sensor")
GROUP = "dummydesign.effects"


def _find() -> tuple[Effect, ...]:
    effects: list[Effect] = []
    for room in ROOMS:
        package = importlib.import_module(f"{__package__}.{room}")
        for entry in sorted(pkgutil.iter_modules(package.__path__), key=lambda one: one.name):
            effects += members(importlib.import_module(f"{package.__name__}.{entry.name}"))
    return tuple(effects)


EFFECTS: tuple[Effect, ...] = _find()  # the effects of this package

_given: ContextVar[tuple[Effect, ...]] = ContextVar("effects_given_as_files", default=())
"""Those given as files belong to the call that was given them: other threads do not see them."""


@lru_cache(maxsize=1)
def installed_effects() -> tuple[Effect, ...]:
    """Effects that other packages offer under the entry point group ``dummydesign.effects``, by name."""
    effects: list[Effect] = []
    for entry in sorted(entry_points(group=GROUP), key=lambda one: one.name):
        source = f"installed effect '{entry.name}' ({entry.value})"
        try:
            loaded = entry.load()
        except (Exception, SystemExit) as problem:
            message = f"{source} cannot be loaded: {problem_text(problem)}; uninstall or fix it"
            raise InputError(message, "program_failed", "effect", entry.name) from None
        effect = _sound(loaded, source)
        if effect.name in [other.name for other in (*EFFECTS, *effects)]:
            message = f"{source}: an effect named '{effect.name}' is known already; uninstall one of them"
            raise InputError(message, "duplicate", "effect", effect.name)
        effects.append(effect)
    return tuple(effects)


def known_effects() -> tuple[Effect, ...]:
    """All effects: of this package, installed by others, given as files; in this order."""
    return (*EFFECTS, *installed_effects(), *_given.get())


def foreign_effects() -> tuple[Effect, ...]:
    """Effects that are not of this package, as far as they have been loaded."""
    return (*(installed_effects() if installed_effects.cache_info().currsize else ()), *_given.get())


@contextmanager
def own_effects(files: Sequence[str | Path] = ()) -> Iterator[None]:
    """Know the effects of some files for a while, and answer for what effects of others do."""
    before = _given.get()
    try:
        for effect in [read_effect(file) for file in files]:
            if effect.name in [other.name for other in known_effects()]:
                message = f"effect '{effect.name}' is known already: give another name"
                raise InputError(message, "duplicate", "effect", effect.name)
            _given.set((*_given.get(), effect))
        yield
    except DummydesignError:
        raise
    except (Exception, SystemExit) as problem:
        fault = _fault_of_others(problem)
        if fault is None:
            raise
        raise InputError(fault, "program_failed", "effect") from None
    finally:
        _given.set(before)


def read_effect(path: str | Path) -> Effect:
    """Run a file and make the one effect that it holds; see :func:`own_effects`."""
    path = Path(path)
    what = f"effect file '{path}'"
    check_file("effect file", path, "effect")
    # two files of one name in two folders are two modules
    name = f"dummydesign_own_effect_{path.stem}_{sha256(str(path.resolve()).encode()).hexdigest()[:12]}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        message = f"{what} is not a Python file: its name must end in .py"
        raise InputError(message, "file_unreadable", "effect", str(path))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as problem:
        message = f"{what} cannot be run: {problem_text(problem)}"
        raise InputError(message, "program_failed", "effect", str(path)) from None
    classes = effect_classes(module)
    if len(classes) != 1:
        names = ", ".join(one.__name__ for one in classes) or "none"
        message = f"{what} must hold one class derived from dummydesign.loop.Effect, not {names}"
        raise InputError(message, "malformed", "effect", str(path))
    return _sound(classes[0], what)


def refuse_unsound(effects: Sequence[Effect], presses: Presses, law: SetupLaw) -> None:
    """Refuse effects of others that keep the contract on the reference presses and break it on these."""
    foreign = foreign_effects()
    for effect in effects:
        faults = faults_on(effect, presses, law) if effect in foreign else ()
        if faults:
            message = f"effect '{effect.name}' breaks the contract of an effect on these trials: {faults[0]}"
            raise InputError(message, "program_failed", "effect", effect.name)


def _sound(loaded: type[Effect] | Effect, source: str) -> Effect:
    """An instance of an effect that keeps the contract."""
    faults = check_effect(loaded)
    if faults:
        more = f" (and {len(faults) - 1} more: dummydesign.loop.check_effect lists them)" if len(faults) > 1 else ""
        message = f"{source} breaks the contract of an effect: {faults[0]}{more}"
        raise InputError(message, "program_failed", "effect")
    return loaded() if isinstance(loaded, type) else loaded


def _fault_of_others(problem: BaseException) -> str | None:
    """Which effect that is not of this package a failure went through, with its line; None when it was none."""
    frames = traceback.extract_tb(problem.__traceback__)
    for effect in foreign_effects():
        file = getattr(sys.modules.get(type(effect).__module__), "__file__", None)
        lines = [frame.lineno for frame in frames if file is not None and frame.filename == file]
        if lines:
            text = " ".join(str(problem).split())
            return f"effect '{effect.name}' failed in line {lines[-1]} of {file}: {type(problem).__name__}: {text}"
    return None
