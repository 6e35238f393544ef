"""A pour sheet as plain text, for tests that look for words in it."""

from __future__ import annotations

from collections.abc import Sequence

from dummydesign.mold.files.pour_sheet import SheetBlock


def sheet_text(blocks: Sequence[SheetBlock]) -> str:
    """Headings, paragraphs, numbered steps, and tables as ``| a | b |``."""
    lines: list[str] = []
    for block in blocks:
        lines += [f"# {block.text}"] if block.kind == "head" else [block.text] if block.kind == "text" else []
        lines += [f"{number}. {item}" for number, item in enumerate(block.items, 1)]
        lines += ["| " + " | ".join(row) + " |" for row in block.rows]
        lines.append("")
    return "\n".join(lines)
