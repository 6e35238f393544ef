"""Which import profiles there are; nothing heavy is loaded to list them."""

from __future__ import annotations

from dummydesign.core.datafiles import Entry, entries

KIND = "profiles"
"""Folder of the profiles in the user's own one."""


def list_profiles() -> list[Entry]:
    """The profiles that are known, by name."""
    return [entry for _, entry in sorted(entries(KIND).items())]
