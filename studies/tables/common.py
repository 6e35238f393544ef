"""What every builder of a table writes into its file: the command as run, sources, versions, seed, time and date."""

from __future__ import annotations

import hashlib
import json
import shlex
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from dummydesign._version import __version__
from dummydesign.core.cache import package_folder, sources
from dummydesign.core.files import write_text

LIBRARIES = ("numpy", "scipy", "scikit-fem")


@dataclass(frozen=True)
class Build:
    """One run of a builder: its command line and the clock when it began (seconds of the wall clock)."""

    command: str
    began_s: float

    @staticmethod
    def begin(module: str, arguments: Sequence[str] | None = None) -> Build:
        """Note the command and the time; ``arguments`` are those of the process when None.

        Of an absolute path only the name is kept: where it lies on one machine says nothing on another.
        """
        given = sys.argv[1:] if arguments is None else arguments
        words = [Path(word).name if Path(word).is_absolute() else word for word in given]
        return Build(shlex.join(["python", "-m", module, *words]), time.time())

    def provenance(self, seed: int | None = None) -> dict[str, Any]:
        """Where a file comes from.

        Parameters
        ----------
        seed : int, optional
            Seed of what was drawn; None when nothing was.

        Returns
        -------
        dict
            ``command`` as run, ``version`` of the package, ``sources`` (hash), ``libraries`` by name, ``seed``,
            ``seconds`` of the wall clock, ``date`` (UTC).
        """
        return {
            "command": self.command,
            "version": __version__,
            "sources": sources_hash(),
            "libraries": {name: release for name in LIBRARIES if (release := _version(name))},
            "seed": seed,
            "seconds": round(time.time() - self.began_s),
            "date": datetime.now(UTC).date().isoformat(),
        }


def sources_hash() -> str:
    """SHA-256 over names and bytes of the package's Python sources, the studies included."""
    root = package_folder()
    digest = hashlib.sha256()
    for path in sources():
        if path.suffix == ".py":
            name = path.relative_to(root).as_posix()
            digest.update(f"{name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def write_table(path: Path, content: dict[str, Any], build: Build, seed: int | None = None) -> None:
    """Write a table as one line of JSON with its provenance; what the content says of itself there stays.

    Parameters
    ----------
    path : Path
        The JSON file that is written.
    content : dict
        The table.
    build : Build
        The run that made it: command, sources, time.
    seed : int, optional
        Of the random numbers, where there were any.
    """
    made = {**content, "provenance": {**content.get("provenance", {}), **build.provenance(seed)}}
    write_text(path, json.dumps(made) + "\n")


def _version(library: str) -> str | None:
    try:
        return version(library)
    except PackageNotFoundError:
        return None
