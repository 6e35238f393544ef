"""The laws of soft tissue that are known: each module here offers instances of ``MaxwellLaw``.

A new law is one module here.
"""

from __future__ import annotations

import importlib
import pkgutil

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.tissue.model.maxwell_law import MaxwellLaw


def _find() -> dict[str, MaxwellLaw]:
    laws: dict[str, MaxwellLaw] = {}
    for entry in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{entry.name}")
        laws |= {value.name: value for value in vars(module).values() if isinstance(value, MaxwellLaw)}
    return laws


LAWS: dict[str, MaxwellLaw] = _find()
"""Laws by name."""

DEFAULT = "ode"
"""Law that follows any motion, of the built-in tissues."""


def law_named(name: str) -> MaxwellLaw:
    """Find a law by its name, or raise InputError with the nearest known one."""
    if name not in LAWS:
        raise unknown_name("law", name, LAWS)
    return LAWS[name]


def fitted_law(name: str) -> MaxwellLaw:
    """Find a law that is fitted to traces, or raise InputError."""
    law = law_named(name)
    if not law.fitted:
        message = f"law = {name} is not fitted to traces: it is {law.words}; fit ode, consistent or published"
        raise InputError(message, "unsupported", "law", name)
    return law
