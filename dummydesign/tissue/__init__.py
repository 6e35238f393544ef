"""Tissue: the nonlinear five-element law, bands of subjects, their ranges, and the fit of traces."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dummydesign.tissue.band import Tissue

__all__ = ["load_tissue"]


def load_tissue(name_or_path: str) -> Tissue:
    """Load a tissue by name or from a TOML file; see :func:`dummydesign.tissue.store.load_tissue`."""
    from dummydesign.tissue.store import load_tissue as load

    return load(name_or_path)
