"""From the bytes of a file to its text: byte order mark, UTF-8, UTF-16, or the code page whose words are known."""

from __future__ import annotations

import codecs
import re

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes
from dummydesign.measurement.importing.core.vocabulary import is_known_word

_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_PAGES = ("cp1252", "cp932", "mac_roman", "cp850", "euc_jp", "cp1250")
"""Code pages that are tried, likeliest first: Western and Japanese Windows, old Macs, DOS, Unix, Central Europe."""
_NO_TEXT = {
    b"%PDF": "a PDF",
    b"\x89PNG": "a picture",
    b"\xff\xd8\xff": "a picture",
    b"GIF8": "a picture",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook (.xls): save it as .xlsx or CSV",
    b"PK\x03\x04": "a ZIP archive: unpack it first",
    b"\x1f\x8b": "a gzip archive: unpack it first",
    b"HDF": "an HDF file: export the test as text",
    b"\x89HDF": "an HDF file: export the test as text",
    b"TDSm": "a TDMS file: export the test as text",
}


def decode(file: str, data: bytes, encoding: str | None, notes: Notes) -> str:
    """Decode a file.

    Parameters
    ----------
    file : str
        Name for messages.
    data : bytes
        The whole file.
    encoding : str, optional
        What the user says it is.
    notes : Notes
        Receives the decision.

    Raises
    ------
    InputError
        When it is empty, no text, or not in the encoding that the user named.
    """
    if not data.strip(b"\x00\r\n\t \xef\xbb\xbf\xff\xfe"):
        raise InputError(f"{file}: is empty; export the test again")
    for magic, what in _NO_TEXT.items():
        if data.startswith(magic):
            raise InputError(f"{file}: is {what}, not a table of text; export the test as CSV or text")
    if encoding is not None:
        return _as_told(file, data, encoding, notes)
    for mark, name in _MARKS:
        if data.startswith(mark):
            text = _try(data, name)
            if text is None:
                raise InputError(f"{file}: begins as {name} but does not go on as such; say --encoding NAME")
            notes.decide("encoding", name, "byte order mark at the start")
            return text
    wide = _wide(data)
    if wide is not None:
        text = _try(data, wide)
        if text is not None:
            notes.decide("encoding", wide, "every second byte is zero")
            return text
    if b"\x00" in data:
        raise InputError(f"{file}: holds zero bytes, so it is no text; export the test as CSV or text")
    text = _try(data, "utf-8")
    if text is not None:
        if not data.isascii():
            notes.decide("encoding", "utf-8", "all of it is valid UTF-8")
        return text
    return _by_words(file, data, notes)


def _as_told(file: str, data: bytes, encoding: str, notes: Notes) -> str:
    try:
        codecs.lookup(encoding)
        b"".decode(encoding)
    except LookupError:
        raise InputError(
            f"--encoding {encoding} is not known; known are utf-8, utf-16, latin-1, cp1252, cp932 and others"
        ) from None
    text = _try(data, encoding)
    if text is None:
        raise InputError(f"{file}: is not text in the encoding {encoding}; leave --encoding out to have it found")
    notes.decide("encoding", encoding, "given by --encoding")
    return text.removeprefix("\ufeff")


def _try(data: bytes, name: str) -> str | None:
    try:
        text = data.decode(name)
    except (UnicodeError, ValueError):
        return None
    return None if "\x00" in text else text


def _wide(data: bytes) -> str | None:
    """UTF-16 without a mark: text that is nearly all ASCII has a zero in every second byte."""
    head = data[:4096]
    half = max(len(head) // 2, 1)
    if head[1::2].count(0) > 0.7 * half and head[0::2].count(0) < 0.1 * half:
        return "utf-16-le"
    if head[0::2].count(0) > 0.7 * half and head[1::2].count(0) < 0.1 * half:
        return "utf-16-be"
    return None


def _by_words(file: str, data: bytes, notes: Notes) -> str:
    """Take the code page in which most column names are known words.

    Some twenty letters beyond ASCII stand in such a file, all of them in its header: too few for statistics of
    letters, enough for a vocabulary.
    """
    best: tuple[int, str, str] | None = None
    for page in _PAGES:
        text = _try(data, page)
        if text is None:
            continue
        known = _known_words(text)
        if best is None or known > best[0]:
            best = (known, page, text)
    if best is None:
        text = data.decode("latin-1")
        if sum(not (letter.isprintable() or letter in "\r\n\t") for letter in text[:4096]) > 0.05 * len(text[:4096]):
            raise InputError(f"{file}: is no text in any encoding tried; export it as UTF-8 or say --encoding NAME")
        best = (0, "latin-1", text)
    known, page, text = best
    why = f"not UTF-8; {known} words of its header are known in it" if known else "not UTF-8; numbers read alike in all"
    notes.decide("encoding", page, why)
    return text


def _known_words(text: str) -> int:
    """Words beyond ASCII, in the lines before the numbers, that are known as names of columns."""
    found = 0
    for line in text[:20000].splitlines()[:200]:
        if not line.isascii():
            words = re.split(r"[\s;,\t\"()\[\]/|_]+", line)
            found += sum(is_known_word(word) for word in words if not word.isascii())
    return found
