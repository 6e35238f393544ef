"""Closing the loop: a measured campaign, its residual, the effects the model lacks, and the corrected model.

For effects of your own: :class:`Effect`, :class:`Parameter`, :func:`wrap`, :func:`check_effect`.
"""

from __future__ import annotations

from typing import Any

_FACE = {
    "Effect": "dummydesign.loop.model.effect",
    "Parameter": "dummydesign.loop.model.effect",
    "Arm": "dummydesign.loop.model.effect",
    "wrap": "dummydesign.loop.model.effect",
    "check_effect": "dummydesign.loop.effects.contract_check",
}

__all__ = ["Arm", "Effect", "Parameter", "check_effect", "wrap"]


def __getattr__(name: str) -> Any:
    """Import the few names that are for others on first use."""
    if name not in _FACE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_FACE[name]), name)
