"""Excel workbooks (.xlsx) as text with tabs, so that the reader of text reads them too. Needs the extra ``xlsx``."""

from __future__ import annotations

import datetime
import io
import zipfile

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes

MOST_BYTES = 1_000_000_000
"""Largest unpacked size that is read."""


def is_workbook(data: bytes) -> bool:
    """Whether bytes are an .xlsx workbook."""
    if not data.startswith(b"PK\x03\x04"):
        return False
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            return "xl/workbook.xml" in packed.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, EOFError, NotImplementedError):
        return False


def workbook_text(file: str, data: bytes, notes: Notes) -> str:
    """Write the sheets that hold a table as lines of cells parted by tabs, one sheet after the other.

    Parameters
    ----------
    file : str
        Name for messages.
    data : bytes
        The whole file.
    notes : Notes
        Receives which sheets are read.

    Raises
    ------
    InputError
        When openpyxl is not installed, or the workbook cannot be read or holds no numbers.
    """
    try:
        import openpyxl
    except ImportError:
        raise InputError(
            f"{file}: is an Excel workbook; install the reader with: pip install 'dummydesign[xlsx]', or save it as CSV"
        ) from None
    sheets: dict[str, list[str]] = {}
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            if sum(part.file_size for part in packed.infolist()) > MOST_BYTES:
                raise InputError(f"{file}: unpacks to more than {MOST_BYTES // 10**6} MB; save the sheet as CSV")
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
        for sheet in book.worksheets:
            lines = ["\t".join(_cell(value) for value in row).rstrip("\t") for row in sheet.iter_rows(values_only=True)]
            if sum(_numeric(line) for line in lines) >= 3:
                sheets[sheet.title] = lines
    except InputError:
        raise
    except Exception as problem:  # openpyxl raises whatever the XML made of it
        raise InputError(
            f"{file}: cannot be read as an Excel workbook ({type(problem).__name__}); save it again, or as CSV"
        ) from None
    if not sheets:
        raise InputError(f"{file}: no sheet holds a table of numbers; export time, displacement and force as columns")
    notes.decide("sheets", ", ".join(sheets), "the sheets that hold rows of numbers")
    return "\n".join(line for lines in sheets.values() for line in lines) + "\n"


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, datetime.datetime):
        return value.isoformat(sep=" ", timespec="microseconds")
    if isinstance(value, datetime.time):
        return value.isoformat(timespec="microseconds")
    if isinstance(value, datetime.timedelta):
        return repr(value.total_seconds())
    return repr(value) if isinstance(value, float) else " ".join(str(value).split())


def _numeric(line: str) -> bool:
    cells = [cell for cell in line.split("\t") if cell]
    digits = sum(cell[0] in "+-0123456789.,−" for cell in cells)
    return len(cells) >= 2 and digits >= 2
