"""Import a large library without parts of others that it loads and a mould never asks for; do work beside the work of
this process, in a copy of it. Child processes only.

CadQuery loads VTK for its own pictures and solvers for its assemblies, trimesh SciPy for its searches: seconds of
processor time and a hundred megabytes for nothing. They are left out while the library is loaded, no longer.
"""

from __future__ import annotations

import ctypes
import importlib
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, TypeVar

from dummydesign.core.progress import VARIABLE


class _StandIn(ModuleType):
    """A module in which every name is an empty class."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


class _StandIns(MetaPathFinder, Loader):
    def __init__(self, names: tuple[str, ...]) -> None:
        self.names = names

    def find_spec(self, fullname: str, path: Any, target: Any = None) -> ModuleSpec | None:
        if any(fullname == name or fullname.startswith(f"{name}.") for name in self.names):
            return ModuleSpec(fullname, self, is_package=True)
        return None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return _StandIn(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Nothing to run."""


@contextmanager
def _left_out(stand_ins: tuple[str, ...], missing: tuple[str, ...]) -> Iterator[None]:
    finder = _StandIns(tuple(name for name in stand_ins if name not in sys.modules))
    absent = [name for name in missing if name not in sys.modules]
    sys.meta_path.insert(0, finder)
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        for name in absent:
            del sys.modules[name]
        for name in [name for name, module in sys.modules.items() if isinstance(module, _StandIn)]:
            del sys.modules[name]


def load_cadquery() -> None:
    """Import CadQuery without VTK, and without the solvers of its assemblies and sketches."""
    with _left_out(("vtkmodules", "OCP.IVtkOCC", "OCP.IVtkVTK", "casadi", "nlopt"), ()):
        importlib.import_module("cadquery")


class _CadQuery:
    """CadQuery, loaded when a name of it is first used."""

    def __getattr__(self, name: str) -> Any:
        if "cadquery" not in sys.modules:
            load_cadquery()
        return getattr(sys.modules["cadquery"], name)


class _OpenCascade:
    """Names of Open CASCADE, each loaded when it is first used; their first part is their module: ``occ.gp_Pnt``."""

    def __getattr__(self, name: str) -> Any:
        member = getattr(importlib.import_module(f"OCP.{name.split('_')[0]}"), name)
        setattr(self, name, member)
        return member


cq: Any = _CadQuery()
occ: Any = _OpenCascade()


def load_trimesh() -> None:
    """Import trimesh without SciPy, which it does without."""
    with _left_out((), ("scipy",)):
        importlib.import_module("trimesh")


LIBRARIES = "apt-get install libgl1 libx11-6"


def cad_problem() -> str | None:
    """Say why CadQuery cannot be loaded and how to mend it, or None when it can."""
    try:
        load_cadquery()
    except ModuleNotFoundError as problem:
        return f"CadQuery is not installed ({problem.name} is missing): pip install cadquery"
    except ImportError as problem:
        text = " ".join(str(problem).split())
        return f"CadQuery cannot load a system library ({text}): {LIBRARIES}"
    return None


T = TypeVar("T")
_SIGNAL_WHEN_PARENT_ENDS = 1
"""PR_SET_PDEATHSIG of prctl(2)."""


def beside(work: Callable[[], T]) -> Callable[[], T]:
    """Begin work in a copy of this process, which has all solids already; what is returned waits for its result.

    The kernel keeps Python's lock, so that a thread would wait for it. Files that the work writes are there, anything
    else that it changes is not. An exception of the work is raised as a RuntimeError with its type and text. Where the
    system copies no process, or has no room for one, or this one has threads, the work is done once its result is
    wanted.
    """
    # typst keeps threads that Python does not count, and waits for them in a copy
    if sys.platform != "linux" or threading.active_count() > 1 or "typst" in sys.modules:
        return work
    # a copy has none of the threads that the kernel would wait for
    occ.OSD_ThreadPool.DefaultPool_s().Init(1)
    reading, writing = os.pipe()
    try:
        copy = os.fork()
    except OSError:
        os.close(reading)
        os.close(writing)
        return work
    if not copy:
        os.close(reading)
        _work_and_leave(work, writing)
    os.close(writing)

    def result() -> T:
        with os.fdopen(reading, "rb") as stream:
            answer = stream.read()
        status = os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1])
        if status < 0:  # out of its processor time, or a fault of the kernel: both end together
            signal.raise_signal(-status)
        found, fault = pickle.loads(answer)
        if fault:
            raise RuntimeError(fault)
        return found  # type: ignore[no-any-return]

    return result


def _work_and_leave(work: Callable[[], object], answer: int) -> None:
    """Do the work of a copy, write its result to a pipe and end; never returns."""
    with suppress(OSError):
        ctypes.CDLL(None).prctl(_SIGNAL_WHEN_PARENT_ENDS, signal.SIGKILL)
    os.environ.pop(VARIABLE, None)
    try:
        found: tuple[object, str] = work(), ""
    except BaseException as problem:
        found = None, f"{type(problem).__name__}: {problem}"
    try:
        with os.fdopen(answer, "wb") as stream:
            pickle.dump(found, stream)
    finally:
        os._exit(0)
