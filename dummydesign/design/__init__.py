"""Design: scores, search, tolerance, what-if; does not know how a number was made.

``suggest`` and ``whatif`` are the documented calls. Imports are lazy.
"""

from __future__ import annotations

import importlib
from typing import Any

_PLACES = {"suggest": "suggest", "Request": "suggest", "Suggestion": "suggest", "whatif": "sweep.run"}


def __getattr__(name: str) -> Any:
    if name in _PLACES:
        return getattr(importlib.import_module(f"dummydesign.design.{_PLACES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
