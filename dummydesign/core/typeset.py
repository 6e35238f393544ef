"""Pages set by Typst: a template says what stands where; texts and numbers are data, so nothing in them is markup."""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

PACKAGE = Path(__file__).parents[1]
"""A template reads files below it: ``#import "/core/sheet.typ": *``."""
FONTS = Path(__file__).with_name("fonts")
"""Liberation Sans: Latin, Greek, Cyrillic and Hebrew letters, as wide as Helvetica's."""
NO_LETTERS = frozenset(map(chr, (*range(9), *range(11, 32), *range(0xD800, 0xE000), 0xFEFF)))
"""Control characters and halves of letters, which file names may have."""
UNDRAWN = re.compile(r'the text `"(?:\\u\{(\w+)\}|(.))"` could not be displayed')


def typeset(template: Path, data: Mapping[str, Any], form: Literal["pdf", "png"] = "pdf") -> bytes:
    """Set a template with its data as tagged PDF (PDF/UA-1) or as a picture; equal inputs give equal bytes.

    Parameters
    ----------
    template : Path
        A Typst file. It reads the data with ``json(bytes(sys.inputs.data))``.
    data : mapping
        Texts, numbers, and lists and mappings of them.
    form : str
        ``pdf``, or ``png`` of a single page.

    Returns
    -------
    bytes
        Letters that the package's font lacks are drawn with fonts of the machine; one that no font has is
        written as its code, such as ``[U+6307]``.
    """
    import typst

    system, refused = False, NO_LETTERS
    while True:
        fonts = typst.Fonts(include_system_fonts=system, font_paths=[FONTS])
        inputs = {"data": json.dumps(_drawable(data, refused), ensure_ascii=False, allow_nan=False)}
        try:
            return bytes(
                typst.compile(
                    template, root=PACKAGE, font_paths=fonts, format=form, sys_inputs=inputs, pdf_standards="ua-1"
                )
            )
        except typst.TypstError as problem:
            found = UNDRAWN.findall(problem.diagnostic)
            letters = {chr(int(code, 16)) if code else letter for code, letter in found} - refused
            if not letters:
                raise
            refused |= letters if system else frozenset()
            system = True


def _drawable(value: Any, refused: frozenset[str]) -> Any:
    """The value with refused letters in its texts as codes; letters and their marks are one where they can be."""
    if isinstance(value, str):
        letters = unicodedata.normalize("NFC", value)
        return "".join(f"[U+{ord(one):04X}]" if one in refused else one for one in letters)
    if isinstance(value, Mapping):
        return {name: _drawable(one, refused) for name, one in value.items()}
    return [_drawable(one, refused) for one in value] if isinstance(value, Sequence) else value
