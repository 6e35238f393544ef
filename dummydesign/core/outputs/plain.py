"""Plain values of an answer, as its JSON has them."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from typing import Any

from dummydesign._version import __version__


def plain(value: Any) -> Any:
    """Turn numpy scalars and arrays into plain JSON values; a number that is not finite becomes null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return value


def json_text(command: str, result: Mapping[str, Any]) -> str:
    """Return the JSON of an answer: schema, version, inputs, warnings and sources first."""
    head = {"schema": f"dummydesign.{command}/1", "version": __version__}
    for key, empty in (("inputs", {}), ("warnings", []), ("sources", [])):
        head[key] = result.get(key, empty)
    return json.dumps(plain({**head, **result}), indent=1, allow_nan=False)
