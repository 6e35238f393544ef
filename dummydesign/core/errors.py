"""The exceptions a user may meet; each message names the quantity, the value and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


class DummydesignError(Exception):
    """Base of all errors raised on purpose by this package."""


class InputError(DummydesignError):
    """What was asked cannot be understood or is out of range (exit status 2)."""


class NoAnswerError(DummydesignError):
    """The work was understood but has no acceptable answer (exit status 1).

    Parameters
    ----------
    code : str
        Short stable name of the reason, for scripts: ``"no_feasible_design"``, ``"cad_unavailable"``, ...
    message : str
        The reason and what to try.
    result : dict, optional
        What was found all the same; printed with ``--json``.
    """

    def __init__(self, code: str, message: str, result: dict[str, Any] | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.result = result if result is not None else {}


def out_of_range(quantity: str, value: object, low: object, high: object, advice: str = "") -> InputError:
    """Make the error for a number outside its allowed range, both ends included.

    Parameters
    ----------
    quantity : str
        What is out of range, as the user wrote it or knows it: ``thickness``, ``--ratio``.
    value, low, high : object
        The number given and the ends allowed, as they are to be printed, with their unit where they have one.
    advice : str
        What to do instead; put after a semicolon.

    Returns
    -------
    InputError
        To be raised by the caller.
    """
    tail = f"; {advice}" if advice else ""
    return InputError(f"{quantity} = {value} is outside the allowed range {low} to {high}{tail}")


def unknown_name(kind: str, name: str, known: Iterable[str]) -> InputError:
    """Make the error for a name that is not in the list, with the nearest known name.

    Parameters
    ----------
    kind : str
        What the name is of: ``tissue``, ``resin``, ``effect``.
    name : str
        The name as it was typed.
    known : iterable of str
        All names that are accepted.

    Returns
    -------
    InputError
        To be raised by the caller.
    """
    names = sorted(known)
    near = difflib.get_close_matches(name.lower(), [n.lower() for n in names], n=1, cutoff=0.5)
    hint = ""
    if near:
        match = next(n for n in names if n.lower() == near[0])
        hint = f"did you mean '{match}'? "
    return InputError(f"unknown {kind} '{name}': {hint}known names are {', '.join(names) or 'none'}")
