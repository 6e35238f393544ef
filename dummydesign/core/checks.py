"""Checks of single numbers, and numbers with their unit: a bare one a thousand off for its purpose is refused."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

from dummydesign.core.errors import InputError, out_of_range


def positive(quantity: str, value: float) -> None:
    """Refuse a number that is not finite and above zero."""
    if not (isinstance(value, int | float) or hasattr(value, "dtype")) or not math.isfinite(value) or value <= 0.0:
        raise InputError(f"{quantity} = {value} must be a finite number above 0")


UNITS: dict[str, dict[str, float]] = {
    "mm": {"um": 1e-3, "µm": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1000.0},
    "mm/s": {"mm/s": 1.0, "cm/s": 10.0, "m/s": 1000.0},
    "mm/s2": {"mm/s2": 1.0, "m/s2": 1000.0},
    "N": {"mN": 1e-3, "N": 1.0, "kN": 1000.0},
    "N/mm": {"N/m": 1e-3, "N/cm": 0.1, "N/mm": 1.0, "kN/m": 1.0},
    "kPa": {"Pa": 1e-3, "kPa": 1.0, "MPa": 1000.0},
    "s": {"ms": 1e-3, "s": 1.0, "min": 60.0},
    "g": {"mg": 1e-3, "g": 1.0, "kg": 1000.0},
    "kg": {"g": 1e-3, "kg": 1.0, "t": 1000.0},
}
"""Units that are understood for each unit a number is wanted in, with their size in it."""
NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*$")


@dataclass(frozen=True)
class Purpose:
    """What a number is for.

    Attributes
    ----------
    quantity : str
        As messages call it, with the unit: ``velocity in mm/s``.
    unit : str
        In which it is wanted, one of :data:`UNITS`.
    usual : (float, float)
        Between which a bare number is taken as it stands.
    """

    quantity: str
    unit: str
    usual: tuple[float, float]


FORCE = Purpose("force in N", "N", (0.05, 1000.0))
VELOCITY = Purpose("velocity in mm/s", "mm/s", (1.0, 5000.0))
ROBOT_VELOCITY = Purpose("robot velocity in mm/s", "mm/s", (1.0, 10_000.0))
HOLD = Purpose("hold in s", "s", (0.05, 3600.0))
DECELERATION = Purpose("deceleration in mm/s2", "mm/s2", (100.0, 1e7))
YOUNG = Purpose("Young's modulus in kPa", "kPa", (0.5, 5000.0))
YOUNG_KPA = 0.01, 1e6
"""Smallest and largest modulus that is allowed. [kPa]"""
THICKNESS = Purpose("thickness in mm", "mm", (0.3, 300.0))
MASS = Purpose("robot mass in kg", "kg", (0.02, 5000.0))
BALANCE = Purpose("balance in g", "g", (0.0, 2.0))
TOLERANCE = Purpose("thickness tolerance in mm", "mm", (0.0, 2.0))
DEPTH = Purpose("depth in mm", "mm", (0.0, math.inf))
THICKNESSES = Purpose("thickness in mm", "mm", (0.0, math.inf))
LENGTH = Purpose("length in mm", "mm", (0.0, math.inf))
WIDTH = Purpose("width in mm", "mm", (0.0, math.inf))
EDGE = Purpose("edge radius in mm", "mm", (0.0, 50.0))


def read_number(value: float | str, purpose: Purpose) -> float:
    """Read a number: bare in the unit of its purpose, or text with a unit.

    Parameters
    ----------
    value : float or str
        ``0.25``, ``"250"``, ``"0.25m/s"``, ``"0.25 m/s"``.
    purpose : Purpose

    Returns
    -------
    float
        In the unit of the purpose.

    Raises
    ------
    InputError
        For what is no number, an unknown unit, and a bare number outside the usual range that lies inside it in
        another unit: then with that unit.

    Examples
    --------
    >>> read_number("0.25m/s", VELOCITY), read_number("25kPa", YOUNG), read_number(10, VELOCITY)
    (250.0, 25.0, 10.0)
    """
    unit = ""
    if isinstance(value, str):
        found = NUMBER.match(value)
        if found is None:
            shown = value.strip() or repr(value)
            raise InputError(f"{purpose.quantity} = {shown} is not a number, or one with a unit such as "
                             f"{_examples(purpose)}")  # fmt: skip
        number, unit = float(found[1]), found[2]
    else:
        number = float(value)
    known = UNITS[purpose.unit]
    if unit:
        if unit not in known:
            raise InputError(f"{purpose.quantity} = '{value}': unit '{unit}' is not one of {', '.join(known)}")
        scaled = number * known[unit]
        return float(f"{scaled:.12g}") if math.isfinite(scaled) else scaled
    _likely(number, purpose)
    return number


def read_count(value: int | str, quantity: str) -> int:
    """Read a whole number.

    Raises
    ------
    InputError
        For what is none.
    """
    try:
        return int(str(value))
    except ValueError:
        raise InputError(f"{quantity} = {value} is not a whole number") from None


def _likely(number: float, purpose: Purpose) -> None:
    """Refuse a bare number that another unit explains."""
    low, high = purpose.usual
    if not (math.isfinite(number) and number > 0.0) or low <= number <= high:
        return
    for unit, size in sorted(UNITS[purpose.unit].items(), key=lambda item: abs(math.log(item[1]))):
        meant = number * size
        if abs(math.log10(size)) >= 3.0 and low <= meant <= high:
            raise InputError(
                f"{purpose.quantity} = {number:g} looks like {unit}: give {meant:g}, or {number:g}{purpose.unit} if "
                "that is what you mean"
            )


def read_numbers(values: float | str | Iterable[float | str], purpose: Purpose) -> tuple[float, ...]:
    """Read several numbers: text with commas between, one, or a list; see :func:`read_number`.

    Parameters
    ----------
    values : float, str or iterable
        ``"5,10,15"``, ``"0.01m/s,0.25m/s"``, ``[5, 10]``.
    purpose : Purpose
    """
    return tuple(read_number(part, purpose) for part in parts_of(values))


def parts_of(values: float | str | Iterable[float | str]) -> list[float | str]:
    """Split several numbers: text at its commas, a list into its members; one number is alone.

    Parameters
    ----------
    values : float, str or iterable
        As for :func:`read_numbers`.
    """
    if isinstance(values, str):
        return list(values.split(","))
    try:
        return list(values) if isinstance(values, Iterable) else [values]
    except TypeError:  # an array without dimensions
        return [float(values)]  # type: ignore[arg-type]


def read_allowed(value: float | str, purpose: Purpose, low: float, high: float) -> float:
    """Read a number as :func:`read_number` does and refuse it outside a range.

    Parameters
    ----------
    value : float or str
        As it was typed.
    purpose : Purpose
    low, high : float
        Smallest and largest that are allowed, in the unit of the purpose.

    Raises
    ------
    InputError
        Naming the quantity with its unit, the value in it, and the range.
    """
    number = read_number(value, purpose)
    if not low <= number <= high:
        raise out_of_range(purpose.quantity, f"{number:g}", *(f"{end:.10g}" for end in (low, high)))
    return number


def read_size(value: str | tuple[float, float], quantity: str) -> tuple[float, float]:
    """Read ``LxW`` in mm, or two numbers.

    Raises
    ------
    InputError
        For anything else.
    """
    parts = value.removeprefix("slab:").split("x") if isinstance(value, str) else list(value)
    try:
        length, width = (float(part) for part in parts)
    except (TypeError, ValueError):
        raise InputError(f"{quantity} = '{value}' is not LENGTHxWIDTH in mm, such as 150x120") from None
    return length, width


def _examples(purpose: Purpose) -> str:
    units = list(UNITS[purpose.unit])
    return " or ".join(f"1{unit}" for unit in (purpose.unit, units[-1]))
