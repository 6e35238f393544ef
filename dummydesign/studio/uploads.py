"""Files that come in: stored under a plain name, known again by their content, never over another file."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.outputs.manifest import sha256_of
from dummydesign.studio import bin
from dummydesign.studio.server import files


@dataclass(frozen=True)
class Stored:
    """What became of a file that was sent.

    Attributes
    ----------
    name : str
        Of the file in the folder that holds its content now.
    outcome : str
        new, same (the content is there, under this name), numbered (another file has its name), or replaced.
    sent : str
        Its name as it was sent.
    gone : Deleted, optional
        The file whose place it took.
    """

    name: str
    outcome: str
    sent: str
    gone: bin.Deleted | None = None

    @property
    def text(self) -> str:
        """The same in a sentence."""
        return {
            "new": f"{self.name} was added.",
            "same": f"{self.sent} is there already: not copied." if self.name == self.sent
            else f"{self.sent} is the same as {self.name}, which is there: not copied.",
            "numbered": f"{self.sent} differs from the {self.sent} that is there. It was added as {self.name}.",
            "replaced": f"{self.name} was added. It replaces the earlier {self.name}.",
        }[self.outcome]  # fmt: skip


def store(root: Path, folder: Path, name: str, content: bytes, replace: bool = False) -> Stored:
    """Store a file that was sent.

    Parameters
    ----------
    root, folder : Path
        The project folder, and the one in it that the file goes to.
    name : str
        As sent.
    content : bytes
        The whole file.
    replace : bool
        Whether it takes the place of another file of its name, which goes to the bin.

    Raises
    ------
    InputError
        For a name that is not plain, a folder that cannot be written, or one that is in use by a running command.
    """
    files.plain_name(name)
    files.inside(root, folder.relative_to(root).as_posix())
    same = twin(folder, name, content)
    if same is not None:
        return Stored(same, "same", name)
    if replace and (folder / name).is_file():
        gone = bin.delete(root, (folder / name).relative_to(root).as_posix(), "replaced")
        with bin.undone_if_refused(root, gone):
            files.keep(folder, name, content)
        return Stored(name, "replaced", name, gone)
    kept = files.keep(folder, name, content).name
    return Stored(kept, "new" if kept == name else "numbered", name)


def twin(folder: Path, name: str, content: bytes) -> str | None:
    """Name of the file of a folder with the same content; the one of this name first.

    Parameters
    ----------
    folder : Path
    name : str
        As sent.
    content : bytes
        The whole file.
    """
    size, sum = len(content), hashlib.sha256(content).hexdigest()
    found = sorted(folder.glob("*"), key=lambda path: (path.name != name, path.name))
    for path in found:
        if not path.name.startswith(".") and path.is_file() and path.stat().st_size == size and sha256_of(path) == sum:
            return path.name
    return None


def take_place(root: Path, folder: Path, kept: str, name: str) -> Stored:
    """Let a file that got a number take the place of the one whose name it was sent with.

    Parameters
    ----------
    root, folder : Path
        The project folder, and the one in it with both files.
    kept, name : str
        Its name now, and the one it takes.
    """
    place = folder.relative_to(root).as_posix()
    bin.check_idle(root, f"{place}/{kept}")
    gone = bin.delete(root, f"{place}/{name}", "replaced")
    with bin.undone_if_refused(root, gone):
        bin.rename(root, f"{place}/{kept}", name)
    return Stored(name, "replaced", name, gone)
