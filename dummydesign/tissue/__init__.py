"""Tissue: the nonlinear five-element law, bands of subjects, their ranges, and the fit of traces."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dummydesign.tissue.model.tissue import Tissue

__all__ = ["load_tissue"]


def load_tissue(name_or_path: str) -> Tissue:
    """Load a tissue by name or from a TOML file; see :func:`dummydesign.tissue.model.tissue_file.load_tissue`.

    Examples
    --------
    >>> tissue = load_tissue("forefinger")
    >>> tissue.law, len(tissue.subjects), tissue.velocities_mm_s
    ('ode', 5, (10.0, 250.0))
    """
    from dummydesign.tissue.model.tissue_file import load_tissue as load

    return load(name_or_path)
