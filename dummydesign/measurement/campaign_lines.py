"""Where a key stands in the text of campaign.toml, for messages."""

from __future__ import annotations


class CampaignLines:
    """Finds lines of keys in the text of campaign.toml for messages."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.lines = text.splitlines()
        heads = [i for i, line in enumerate(self.lines) if line.strip().startswith("[[trial]]")]
        self.blocks = list(zip(heads, [*heads[1:], len(self.lines)]))

    def trial(self, index: int, key: str = "") -> str:
        """File and line of a key of a trial, counted from 0; of the trial itself where the key is missing."""
        if index >= len(self.blocks):
            return f"{self.name}: trial {index + 1}"
        first, last = self.blocks[index]
        return f"{self.name}:{self._find(first, last, key) + 1}"

    def section(self, section: str, key: str = "") -> str:
        """File and line of a key of a section; the file alone where there is no such section."""
        heads = [i for i, line in enumerate(self.lines) if line.strip() == f"[{section}]"]
        if not heads:
            return self.name
        after = [i for i in range(heads[0] + 1, len(self.lines)) if self.lines[i].strip().startswith("[")]
        return f"{self.name}:{self._find(heads[0], after[0] if after else len(self.lines), key) + 1}"

    def _find(self, first: int, last: int, key: str) -> int:
        for index in range(first, last):
            if key and self.lines[index].split("=")[0].strip() == key:
                return index
        return first
