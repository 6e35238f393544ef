"""Checks of single numbers, with messages that name the quantity, its value and what is allowed."""

from __future__ import annotations

import math

from dummydesign.core.errors import InputError


def positive(quantity: str, value: float) -> None:
    """Refuse a number that is not finite and above zero."""
    if not (isinstance(value, int | float) or hasattr(value, "dtype")) or not math.isfinite(value) or value <= 0.0:
        raise InputError(f"{quantity} = {value} must be a finite number above 0")
