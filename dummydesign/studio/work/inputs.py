"""Whether what a command read has changed since: by the hashes in the manifest that it wrote."""

from __future__ import annotations

import json
from pathlib import Path

from dummydesign.core.outputs.manifest import sha256_of


def changed_inputs(root: Path, manifest: Path) -> list[str]:
    """Files that are gone or have another content than when a command read them.

    Parameters
    ----------
    root : Path
        The project folder, in which the command ran.
    manifest : Path
        That it wrote; without one nothing is known to have changed.
    """
    try:
        read = json.loads(manifest.read_text(encoding="utf-8"))["files_read"]
        return [str(one["name"]) for one in read if sha256_of(root / one["name"]) != one["sha256"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []
