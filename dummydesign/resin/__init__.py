"""Resin: ratio to modulus, relaxation and liquid properties; batches of the user.

``load_resin(name)`` gives a :class:`~dummydesign.resin.model.resin.Resin`. Imports are lazy.
"""

from __future__ import annotations

import importlib
from typing import Any

_PLACES = {
    "load_resin": "model.resin_file",
    "read_resin": "model.resin_file",
    "Resin": "model.resin",
    "Component": "model.resin",
    "update_resin": "update",
}


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(importlib.import_module(f"dummydesign.resin.{_PLACES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
