"""Tissue laws, their parameters, bands and ranges, and tissue files."""

from dummydesign.tissue.model import laws

__all__ = ["laws"]
