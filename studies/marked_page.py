"""Pages of the documentation whose tables a study writes between two marks."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text


@dataclass(frozen=True)
class MarkedPage:
    """A page below a repository's folder and the marks that hold what is made."""

    path: Path
    begin: str
    end: str

    def read(self, repository: Path) -> str:
        """Text of the page.

        Raises
        ------
        InputError
            When the page or its marks are missing; asked before the work starts.
        """
        path = repository / self.path
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        if self.begin not in text or self.end not in text:
            message = f"{path} with the marks '{self.begin}' and '{self.end}' is missing; run in the repository"
            raise InputError(message, "missing", "page", str(path))
        return text

    def write(self, repository: Path, made: str) -> None:
        """Put text between the marks; what stands outside them stays.

        Raises
        ------
        InputError
            As :meth:`read`.
        """
        text = self.read(repository)
        head, tail = text.split(self.begin)[0], text.split(self.end)[1]
        write_text(repository / self.path, f"{head}{self.begin}\n\n{made}\n{self.end}{tail}")
