"""What an import decided and why, what the user settled beforehand, and the questions that are left."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from dummydesign.core.errors import InputError


@dataclass(frozen=True)
class Decision:
    """One thing that the file does not say in so many words: what, the value taken, and why."""

    what: str
    value: str
    why: str

    def to_dict(self) -> dict[str, str]:
        """The three as a plain dictionary."""
        return {"what": self.what, "value": self.value, "why": self.why}


@dataclass(frozen=True)
class Settings:
    """What the user settled; None (or empty, or ``auto``) is left to the file.

    Attributes
    ----------
    columns : dict
        Role (time, displacement, force) to a column's name, or its number from 1.
    units : dict
        Role to a unit, as ``mm`` or ``0.002s`` (what one count is).
    separator, decimal, encoding : str, optional
    skip : int, optional
        Lines of the file to leave out at its start.
    flip : frozenset of str, optional
        Which of displacement and force are to be negated; None leaves it to what the file does.
    tare : str
        ``auto``, ``none`` or the reading at no force, with the file's own sign. [N]
    contact : str
        ``auto``, ``none`` or the reading at contact, with the file's own sign and zero. [mm]
    split : str
        ``auto`` or ``none``.
    """

    columns: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None
    skip: int | None = None
    flip: frozenset[str] | None = None
    tare: str = "auto"
    contact: str = "auto"
    split: str = "auto"

    def __post_init__(self) -> None:
        """Refuse what no file can be read with.

        Raises
        ------
        InputError
        """
        if self.decimal not in (None, ".", ","):
            raise InputError(f"--decimal {self.decimal} is neither . nor ,")
        if self.split not in ("auto", "none"):
            raise InputError(f"--split {self.split} is neither auto nor none")
        wrong = sorted((self.flip or frozenset()) - {"displacement", "force"})
        if wrong:
            raise InputError(f"--flip '{wrong[0]}' is not displacement, force, both with a comma between, or none")

    def to_dict(self) -> dict[str, Any]:
        """All settings as plain values."""
        return {**asdict(self), "flip": None if self.flip is None else sorted(self.flip)}


class QuestionError(InputError):
    """A decision that the file leaves open; the message ends with the option that settles it."""


class NoTableError(InputError):
    """A file without any table of numbers: an error by itself, something to leave out in a folder."""


def question(file: str, doubt: str, option: str) -> QuestionError:
    """Make the question: what is not sure, and what to type.

    Parameters
    ----------
    file : str
        Name for messages.
    doubt : str
        What the file leaves open.
    option : str
        What to type.

    Returns
    -------
    QuestionError
        To be raised by the caller.
    """
    return QuestionError(f"{file}: {doubt}; say {option}")


@dataclass
class Notes:
    """Decisions and warnings of one file, in the order they were made."""

    decisions: list[Decision] = field(default_factory=list)
    warnings: list[dict[str, Any]] = field(default_factory=list)

    def decide(self, what: str, value: str, why: str) -> None:
        """Keep a decision.

        Parameters
        ----------
        what : str
            What was decided: ``unit of force``, ``tare``, ...
        value : str
            The decision, as it is printed.
        why : str
            The reason, as it is printed.
        """
        self.decisions.append(Decision(what, value, why))

    def warn(self, code: str, message: str) -> None:
        """Keep a warning; its message says what to do."""
        self.warnings.append({"code": code, "message": message})
