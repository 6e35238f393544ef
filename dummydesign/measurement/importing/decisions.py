"""What the user settled beforehand, what an import decided and why, its warnings, faults and questions."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.serialise import Serialised


@dataclass(frozen=True)
class Decision(Serialised):
    """One thing that the file does not state: what, the value taken, and why."""

    what: str
    value: str
    why: str


@dataclass(frozen=True)
class Settings:
    """What the user settled; None (or empty, or ``auto``) is left to the file."""

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
    sheets: str | None = None
    """Sheets of a workbook to read, comma-separated; ``not:`` before them reads all others."""
    rate: float | None = None
    """Sampling rate of evenly spaced samples. [Hz]"""
    delay: float | None = None
    """Time by which the force is later than the displacement. [s]"""

    def __post_init__(self) -> None:
        wrong = min((self.flip or frozenset()) - {"displacement", "force"}, default=None)
        for option, value, allowed, valid in (
            ("decimal", self.decimal, (".", ","), self.decimal in (None, ".", ",")),
            ("split", self.split, ("auto", "none"), self.split in ("auto", "none")),
            ("flip", wrong, ("displacement", "force", "none"), wrong is None),
        ):
            if not valid:
                raise InputError(
                    f"--{option} '{value}' is not one of {' '.join(allowed)}", "unknown_name", option, value, allowed
                )

    def to_dict(self) -> dict[str, Any]:
        """Return all settings as plain values."""
        return {**asdict(self), "flip": None if self.flip is None else sorted(self.flip)}


class QuestionError(InputError):
    """A decision that the file leaves open; the message ends with the option that settles it."""


class NoTableError(InputError):
    """A file without any table of numbers: an error by itself, something to leave out in a folder."""


@dataclass
class ImportLog:
    """Import of one file: what the user settled, and decisions and warnings in the order they were made."""

    file: str
    settings: Settings = field(default_factory=Settings)
    decisions: list[Decision] = field(default_factory=list)
    warnings: list[dict[str, Any]] = field(default_factory=list)

    def decide(self, what: str, value: str, why: str) -> None:
        """Add a decision."""
        self.decisions.append(Decision(what, value, why))

    def warn(self, code: str, message: str, name: str = "") -> None:
        """Add a warning about the file, or a press called ``name``; its message ends with what to do."""
        self.warnings.append({"code": code, "message": f"{name or self.file}: {message}"})

    def fault(
        self, message: str, code: str, quantity: str, value: object = None, allowed: object = None, line: int = 0
    ) -> InputError:
        """Make the error of the file, or of one of its lines."""
        where = f"{self.file}:{line}" if line else self.file
        return InputError(f"{where}: {message}", code, quantity, value, allowed)

    def no_table(self, message: str, code: str = "nothing_found", value: object = None) -> NoTableError:
        """Make the error of a file without a table."""
        return NoTableError(f"{self.file}: {message}", code, "table", value)

    def question(self, doubt: str, option: str, allowed: object = None) -> QuestionError:
        """Make the question: what is not sure, what to type, and what the file allows."""
        name = option.split()[0].removeprefix("--")
        return QuestionError(f"{self.file}: {doubt}; say {option}", "needs_decision", name, None, allowed)
