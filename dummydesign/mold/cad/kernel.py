"""Import a large library without parts of others that it loads and a mould never asks for. Child processes only.

CadQuery loads VTK for its own pictures and solvers for its assemblies, trimesh SciPy for its searches: seconds of
processor time and a hundred megabytes for nothing. They are left out while the library is loaded, no longer.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any


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
