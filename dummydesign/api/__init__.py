"""The calls for scripts; each result has ``to_dict()``, what the command of the same name prints with ``--json``.

    import dummydesign
    answer = dummydesign.suggest("forefinger")
    answer.design.thickness_mm, answer.verdict.level

The command line calls these functions, with the same defaults, and prints what they return. A module is imported
when one of its calls is requested, heavy packages when a function runs.
"""

from __future__ import annotations

import importlib
from typing import Any

_MODULES = {
    "Answer": "api.answers",
    "Fitted": "api.answers",
    "Predicted": "api.answers",
    "Result": "api.answers",
    "Rows": "api.answers",
    "calibrate": "api.campaigns",
    "replay": "api.campaigns",
    "suggest": "api.designs",
    "make_mould": "api.moulds",
    "record_pad": "api.moulds",
    "predict": "api.predictions",
    "whatif": "api.designs",
    "compare": "api.traces",
    "fit": "api.traces",
    "import_traces": "api.traces",
    "on_person": "api.traces",
    "load_resin": "resin",
    "load_tissue": "tissue",
}
__all__ = sorted([*_MODULES, "close_loop"])


def __getattr__(name: str) -> Any:
    if name == "close_loop":
        name = "calibrate"
    if name in _MODULES:
        return getattr(importlib.import_module(f"dummydesign.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
