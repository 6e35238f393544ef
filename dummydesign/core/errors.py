"""The exceptions a user may meet; each message names the quantity, the value and what is allowed."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any


class DummydesignError(Exception):
    """Base of all errors raised on purpose by this package.

    Parameters
    ----------
    message : str
        What was wrong, what is allowed, what to type; one line.
    code : str
        Stable name of the fault, one of those in ``core/errors.toml``.
    quantity : str
        What the fault is about, with its unit: ``thickness_mm``, ``tissue``.
    value, allowed : object, optional
        What was given and what is allowed, where these are plain values.
    """

    def __init__(
        self,
        message: str,
        code: str = "not_specified",
        quantity: str = "",
        value: object = None,
        allowed: object = None,
    ) -> None:
        super().__init__(message)
        self.code, self.quantity, self.value, self.allowed = code, quantity, value, allowed

    def within(self, where: str, advice: str = "") -> InputError:
        """Return the same fault with the place it was found at in front: a file, a line, a subject; advice behind."""
        return InputError(f"{where}: {self}{advice}", self.code, self.quantity, self.value, self.allowed)

    def to_dict(self) -> dict[str, Any]:
        """Return the error as ``--json`` prints it."""
        return {
            "code": self.code,
            "quantity": self.quantity,
            "value": _plain(self.value),
            "allowed": _plain(self.allowed),
            "message": " ".join(str(self).split()),
        }


def _plain(value: object) -> object:
    if isinstance(value, bool | int | str | None):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else str(value)


class InputError(DummydesignError):
    """What was asked cannot be understood or is out of range (exit status 2)."""


class NoAnswerError(DummydesignError):
    """The work was understood but has no acceptable answer (exit status 1).

    Parameters
    ----------
    code : str
        One of those in ``core/errors.toml``.
    message : str
        The reason and what to try.
    result : dict, optional
        What was found; printed with ``--json``.
    quantity : str
        What has no answer.
    """

    def __init__(self, code: str, message: str, result: dict[str, Any] | None = None, quantity: str = "") -> None:
        super().__init__(message, code, quantity)
        self.result = result if result is not None else {}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.code, str(self), self.result, self.quantity)


def accepts(call: Callable[..., object], *given: Any) -> bool:
    """Whether a call takes what it is given without an ``InputError``."""
    try:
        call(*given)
    except InputError:
        return False
    return True


@contextmanager
def errors_within(where: str, advice: str = "") -> Iterator[None]:
    """Put the place they were found at in front of the errors of a ``with`` block, and advice behind."""
    try:
        yield
    except InputError as problem:
        raise problem.within(where, advice) from None


def out_of_range(
    quantity: str, value: object, low: object, high: object, advice: str = "", name: str = ""
) -> InputError:
    """Make the error for a number outside its allowed range, both ends included.

    Parameters
    ----------
    quantity : str
        What is out of range, as the user wrote it or knows it: ``thickness``, ``--ratio``.
    value, low, high : object
        The number given and the ends allowed, as they are to be printed, with their unit where they have one.
    advice : str
        What to do instead; put after a semicolon.
    name : str
        Stable name of the quantity, where ``quantity`` also names a file or a person.

    Returns
    -------
    InputError
        To be raised by the caller.
    """
    tail = f"; {advice}" if advice else ""
    message = f"{quantity} = {value} is outside the allowed range {low} to {high}{tail}"
    return InputError(message, "out_of_range", name or quantity_name(quantity), value, (low, high))


GONE = {("shape", "bumped"): "take a crown, 'crowned' or 'crowned:radius=R,height=H'"}
"""Names of earlier versions by what they are of, and what to do instead."""


def unknown_name(
    kind: str, name: str, known: Iterable[str], code: str = "unknown_name", quantity: str = ""
) -> InputError:
    """Make the error for a name that is not in the list, with the nearest known name.

    Parameters
    ----------
    kind : str
        What the name is of: ``tissue``, ``resin``, ``effect``.
    name : str
        The name as it was typed.
    known : iterable of str
        All names that are accepted.
    code, quantity : str
        Code and stable name of the quantity, where they differ from ``unknown_name`` and ``kind``.

    Returns
    -------
    InputError
        To be raised by the caller.
    """
    import difflib

    names = sorted(known)
    near = difflib.get_close_matches(name.lower(), [n.lower() for n in names], n=1, cutoff=0.5)
    hint = ""
    if near:
        match = next(n for n in names if n.lower() == near[0])
        hint = f"did you mean '{match}'? "
    if instead := GONE.get((kind, name.lower())):
        hint = f"it is gone, {instead}; "
    message = f"unknown {kind} '{name}': {hint}known names are {', '.join(names) or 'none'}"
    return InputError(message, code, quantity or quantity_name(kind), name, names)


def quantity_name(words: str) -> str:
    """Return the words of a message as a name: ``--edge-radius`` as ``edge_radius``, ``mass in kg`` as ``mass_kg``."""
    plain = words.replace("Young's modulus", "young").replace(" in ", " ").replace("%", "percent")
    return re.sub(r"\W+", "_", plain).strip("_")
