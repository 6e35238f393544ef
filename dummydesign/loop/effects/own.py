"""Effects of your own: from a file, or installed under the entry point group ``dummydesign.effects``."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256
from importlib.metadata import entry_points
from pathlib import Path

from dummydesign.core.errors import DummydesignError, InputError
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.effects import EFFECTS, also, foreign_effects
from dummydesign.loop.effects.check import check_effect, faults_on, told
from dummydesign.loop.model.base_law import SetupLaw
from dummydesign.loop.model.effect import Effect, effect_classes

GROUP = "dummydesign.effects"


@contextmanager
def own_effects(files: Sequence[str | Path] = ()) -> Iterator[None]:
    """Know the effects of some files for a while, and answer for what effects of others do.

    Parameters
    ----------
    files : sequence of path
        Python files with one effect class each. They are run, so they must be trusted.

    Raises
    ------
    InputError
        When a file cannot be read or run, holds no effect or several, breaks the contract, has a name that is known,
        or raises anything while it is used; it names file and line.
    """
    with also(tuple(read_effect(file) for file in files)):
        try:
            yield
        except DummydesignError:
            raise
        except (Exception, SystemExit) as problem:
            fault = _fault_of_others(problem)
            if fault is None:
                raise
            raise InputError(fault) from None


def read_effect(path: str | Path) -> Effect:
    """Run a file and make the one effect that it holds; see :func:`own_effects`."""
    path = Path(path)
    if not path.is_file():
        raise InputError(f"effect file '{path}' does not exist")
    # two files of one name in two folders are two modules
    name = f"dummydesign_own_effect_{path.stem}_{sha256(str(path.resolve()).encode()).hexdigest()[:12]}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise InputError(f"effect file '{path}' is not a Python file: its name must end in .py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as problem:
        raise InputError(f"effect file '{path}' cannot be run: {told(problem)}") from None
    found = effect_classes(module)
    if len(found) != 1:
        names = ", ".join(one.__name__ for one in found) or "none"
        raise InputError(f"effect file '{path}' must hold one class derived from dummydesign.loop.Effect, not {names}")
    return _kept(found[0], f"effect file '{path}'")


def load_installed() -> tuple[Effect, ...]:
    """Effects of the entry point group, by name; see :func:`dummydesign.loop.effects.installed_effects`."""
    found: list[Effect] = []
    for entry in sorted(entry_points(group=GROUP), key=lambda one: one.name):
        source = f"installed effect '{entry.name}' ({entry.value})"
        try:
            loaded = entry.load()
        except (Exception, SystemExit) as problem:
            raise InputError(f"{source} cannot be loaded: {told(problem)}; uninstall or mend it") from None
        effect = _kept(loaded, source)
        if any(effect.name == other.name for other in (*EFFECTS, *found)):
            raise InputError(f"{source}: an effect named '{effect.name}' is known already; uninstall one of them")
        found.append(effect)
    return tuple(found)


def refuse_unsound(effects: Sequence[Effect], presses: Presses, law: SetupLaw) -> None:
    """Refuse effects of others that keep the contract on the reference presses and break it on these.

    Parameters
    ----------
    effects : sequence of Effect
        Those that are used; those of this package are taken as they are.
    presses : Presses
        T trials.
    law : SetupLaw

    Raises
    ------
    InputError
    """
    foreign = foreign_effects()
    for effect in effects:
        faults = faults_on(effect, presses, law) if effect in foreign else ()
        if faults:
            raise InputError(f"effect '{effect.name}' breaks the contract of an effect on these trials: {faults[0]}")


def _kept(loaded: type[Effect] | Effect, source: str) -> Effect:
    """An instance of an effect that keeps the contract."""
    faults = check_effect(loaded)
    if faults:
        more = f" (and {len(faults) - 1} more: dummydesign.loop.check_effect lists them)" if len(faults) > 1 else ""
        raise InputError(f"{source} breaks the contract of an effect: {faults[0]}{more}")
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
