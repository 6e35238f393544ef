"""From the bytes of a file, or a workbook, to text."""

from __future__ import annotations

import codecs
import datetime
import io
import itertools
import json
import re
import zipfile

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.measurement.importing.cells import parse
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.vocabulary import ROLES, is_known_word, roles_of_name, split_name

_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
_PAGES = ("cp1252", "cp932", "mac_roman", "cp850", "euc_jp", "cp1250", "cp1251", "gb18030", "cp949", "big5")
"""Code pages that are tried, likeliest first: Western and Japanese Windows, old Macs, DOS, Unix, Central Europe,
Cyrillic, Chinese, Korean."""
_HEADER_ROWS = 60
"""Rows of a sheet among which the names of columns are looked for."""
_CONTAINERS = {
    b"%PDF": "a PDF",
    b"\x89PNG": "a picture",
    b"\xff\xd8\xff": "a picture",
    b"GIF8": "a picture",
    b"\x89HDF": "an HDF5 file: export with h5py and numpy.savetxt, or HDFView, as CSV",
    b"\x0e\x03\x13\x01": "an HDF4 file: export the test as CSV",
    b"HDF": "an HDF file: export the test as CSV",
    b"MATLAB": "a MATLAB file (.mat): export with writetable or writematrix as CSV",
    b"TDSm": "a TDMS file: export with 'tdms to CSV' of LabVIEW or DIAdem, or npTDMS as CSV",
    b"\x93NUMPY": "a NumPy array (.npy): export with numpy.savetxt as CSV",
    b"PAR1": "a Parquet file: export with pandas to_csv",
    b"ARROW1": "a Feather file: export with pandas to_csv",
    b"SQLite format 3": "a database (SQLite, or a ROS 2 bag): export the topic or table as CSV",
    b"#ROSBAG": "a ROS bag: export the topic with 'rostopic echo -b FILE -p TOPIC' as CSV",
    b"\x89MCAP": "a ROS 2 bag (MCAP): export the topic as CSV",
    b"\x1f\x8b": "a gzip archive: unpack it first",
    b"7z\xbc\xaf": "a 7-Zip archive: unpack it first",
    b"Rar!": "a RAR archive: unpack it first",
    b"<?xml": "an XML file: export the test as CSV",
    b"<html": "a web page (some programs name it .xls): open it in a spreadsheet and save it as .xlsx or CSV",
    b"<!DOCTYPE": "a web page: open it in a spreadsheet and save it as .xlsx or CSV",
}
"""First bytes of files that are no text table: what each is, and how to export it."""


def decode(data: bytes, log: ImportLog) -> str:
    """Decode the bytes of a file."""
    if not data.strip(b"\x00\r\n\t \xef\xbb\xbf\xff\xfe"):
        raise log.fault("is empty; export the test again", "not_enough_data", "file")
    if container := _container(data):
        export = "" if ":" in container else ": export time, displacement and force as CSV or text"
        raise log.fault(f"is {container}{export}", "file_unreadable", "file")
    return _without_padding(_decode_text(data, log), log)


def _container(data: bytes) -> str:
    """What a file is that is no text; empty where it may be text."""
    if is_workbook(data):
        return "a workbook (.xlsx, .xls or .ods): save the table as CSV"
    if data.startswith(b"PK\x03\x04"):
        arrays = any(name.endswith(".npy") for name in _names_in(data))
        return "NumPy arrays (.npz): export with numpy.savetxt as CSV" if arrays else "a ZIP archive: unpack it first"
    if data[:2000].lstrip(b"\xef\xbb\xbf \r\n\t")[:1] in (b"{", b"["):
        try:
            json.loads(data)
            return "a JSON file: export with pandas to_csv, or write its arrays as the columns of a CSV"
        except ValueError:
            return ""
    return next((what for magic, what in _CONTAINERS.items() if data[: len(magic)].lower() == magic.lower()), "")


def _without_padding(text: str, log: ImportLog) -> str:
    """Leave out zero bytes at the end, of a file made larger than its content, and the line that they cut."""
    kept = text.rstrip("\x00")
    if "\x00" in kept:
        line = kept[: kept.index("\x00")].count("\n") + 1
        message = "holds zero bytes within its text: it is damaged, or no text; export the test as CSV or text"
        raise log.fault(message, "file_unreadable", "file", line=line)
    if len(kept) == len(text):
        return text
    whole = kept[: max(kept.rfind("\n"), kept.rfind("\r")) + 1]
    cut = f", and the line '{kept[len(whole) :].strip()[:40]}' that they cut" if kept[len(whole) :].strip() else ""
    log.warn(
        "padded",
        f"{len(text) - len(kept)} zero bytes at its end were left out{cut}: the logger lost its power "
        "or was not closed; check that the recording is complete",
    )
    return whole


def _decode_text(data: bytes, log: ImportLog) -> str:
    if log.settings.encoding is not None:
        return _decode_as(data, log.settings.encoding, log)
    marked = next((name for mark, name in _MARKS.items() if data.startswith(mark)), None)
    for name, why in (
        (marked, "byte order mark at the start"),
        (_wide(data), "every second byte is zero"),
        ("utf-8", "all of it is valid UTF-8"),
    ):
        if name and (text := _try(data, name)) is not None:
            if name != "utf-8" or not data.isascii():
                log.decide("encoding", name, why)
            return text
        if marked:
            message = f"begins as {marked} but does not go on as such; say --encoding NAME"
            raise log.fault(message, "file_unreadable", "encoding", marked)
    return _decode_by_words(data, log)


def _decode_as(data: bytes, encoding: str, log: ImportLog) -> str:
    try:
        "".encode(encoding)
    except LookupError:
        message = f"--encoding {encoding} is not known; known are utf-8, utf-16, latin-1, cp1252, cp932 and others"
        raise InputError(message, "unknown_name", "encoding", encoding) from None
    text = _try(data, encoding)
    if text is None:
        message = f"is not text in the encoding {encoding}; leave --encoding out to have it found"
        raise log.fault(message, "inconsistent", "encoding", encoding)
    log.decide("encoding", encoding, "given by --encoding")
    return text.removeprefix("\ufeff")


def _try(data: bytes, name: str) -> str | None:
    try:
        return data.decode(name)
    except ValueError:
        return None


def _wide(data: bytes) -> str | None:
    """UTF-16 without a mark: text that is nearly all ASCII has a zero in every second byte."""
    head = data[:4096]
    half = max(len(head) // 2, 1)
    low, high = head[0::2].count(0) / half, head[1::2].count(0) / half
    if high > 0.7 and low < 0.1:
        return "utf-16-le"
    return "utf-16-be" if low > 0.7 and high < 0.1 else None


def _decode_by_words(data: bytes, log: ImportLog) -> str:
    """Take the code page in which most column names are known words.

    Some twenty letters beyond ASCII stand in such a file, all of them in its header: too few for statistics of
    letters, enough for a vocabulary.
    """
    heads = {page: _known_words(data[:20000].decode(page, "ignore")) for page in _PAGES}
    pages = sorted(_PAGES, key=lambda name: -heads[name])
    # two of the pages have a letter for every byte
    page, text = next((page, text) for page in pages if (text := _try(data, page)) is not None)
    known = f"{heads[page]} words of its header are known in it" if heads[page] else "numbers read alike in all"
    log.decide("encoding", page, f"not UTF-8; {known}")
    return text


def _known_words(text: str) -> int:
    """Words beyond ASCII, in the lines before the numbers, that are known as names of columns."""
    words = (re.split(r"[\s;,\t\"()\[\]/|_]+", line) for line in text.splitlines()[:200])
    return sum(is_known_word(word) for line in words for word in line if not word.isascii())


MOST_BYTES = 1_000_000_000
"""Largest unpacked size that is read."""


def is_workbook(data: bytes) -> bool:
    """Whether bytes are a workbook: .xlsx, .xls or .ods."""
    parts = _names_in(data) if data.startswith(b"PK\x03\x04") else []
    return data.startswith(b"\xd0\xcf\x11\xe0") or bool({"xl/workbook.xml", "content.xml"} & set(parts))


def _names_in(data: bytes) -> list[str]:
    """Names of the files in a ZIP archive."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            return packed.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, EOFError, NotImplementedError):
        return []


def workbook_texts(data: bytes, log: ImportLog) -> dict[str, str]:
    """Return the sheets that hold a table as lines of cells separated by tabs.

    By the sheet's title where several sheets are tests of their own; else one sheet after the other, without a title.
    """
    try:
        from python_calamine import CalamineWorkbook
    except ImportError:
        message = "is a workbook; save it as CSV, or install the reader: pip install 'dummydesign[xlsx]'"
        raise log.fault(message, "program_missing", "python-calamine") from None
    if data.startswith(b"PK"):
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            if sum(part.file_size for part in packed.infolist()) > MOST_BYTES:
                raise log.fault(
                    f"unpacks to more than {MOST_BYTES // 10**6} MB; save the sheet as CSV", "too_large", "workbook"
                )
    try:
        book = CalamineWorkbook.from_filelike(io.BytesIO(data))
        read = {
            title: [list(map(_cell, row)) for row in book.get_sheet_by_name(title).to_python()]
            for title in book.sheet_names
        }
    except Exception as problem:  # of calamine's own kinds, by what is wrong with the file
        raise log.fault(
            f"cannot be read as a workbook ({type(problem).__name__}); save it again without a password, or as CSV",
            "file_unreadable",
            "workbook",
        ) from None
    sheets = {title: rows for title, rows in read.items() if sum(map(_numeric, rows)) >= 3}
    if not sheets:
        message = "no sheet holds a table of numbers; export time, displacement and force as columns"
        raise log.fault(message, "nothing_found", "table")
    if log.settings.sheets is not None:
        sheets = {title: sheets[title] for title in chosen_sheets(log.settings.sheets, list(sheets), log.file)}
    tests = _sheets_of_tests(sheets, log)
    log.decide("sheets", ", ".join(tests), "the sheets that hold rows of numbers")
    texts = {title: "".join("\t".join(row).rstrip("\t") + "\n" for row in rows) for title, rows in tests.items()}
    return texts if len(texts) > 1 and _time_begins_again(list(tests.values())) else {"": "".join(texts.values())}


LEFT_OUT = "not:"
"""Prefix of ``--sheets`` that reads all sheets but those named."""


def chosen_sheets(option: str, titles: list[str], file: str) -> list[str]:
    """Return the titles that ``--sheets`` reads, in the order of the workbook; a title may contain commas."""
    by_name, named = {title.strip().casefold(): title for title in titles}, set[str]()
    parts = option.removeprefix(LEFT_OUT).split(",")
    while parts:
        names = [",".join(parts[:count]).strip() for count in range(len(parts), 0, -1)]
        longest = next((at for at, name in enumerate(names) if name.casefold() in by_name), None)
        if longest is None:
            raise unknown_name("sheet", names[-1], titles, quantity="sheets").within(file)
        named.add(by_name[names[longest].casefold()])
        parts = parts[len(parts) - longest :]
    kept = [title for title in titles if (title in named) != option.startswith(LEFT_OUT)]
    if not kept:
        message = f"{file}: --sheets {option} leaves out every sheet with a table ({', '.join(titles)})"
        raise InputError(message, "nothing_found", "sheets", option, tuple(titles))
    return kept


def _time_begins_again(tests: list[list[list[str]]]) -> bool:
    """Whether the time of every sheet begins before that of the sheet before it ended: each is a test of its own."""
    spans = []
    for rows in tests:
        cells = ((row, at, cell) for row, line in enumerate(rows[:_HEADER_ROWS]) for at, cell in enumerate(line))
        heads = [(row, at) for row, at, cell in cells if cell and "time" in roles_of_name(split_name(cell)[0])]
        if not heads:
            return False
        head, at = heads[0]
        times = [time for row in rows[head:] if at < len(row) and (time := parse(row[at], ".")) is not None]
        spans.append((times[0], times[-1]) if times else (0.0, 0.0))
    return all(begin < before_end for (_, before_end), (begin, _) in itertools.pairwise(spans))


def _sheets_of_tests(sheets: dict[str, list[list[str]]], log: ImportLog) -> dict[str, list[list[str]]]:
    """Leave out, where some sheets name time, displacement and force, the other sheets and the cells beside the table.

    Test programs write a sheet of results and a sheet a specimen; people then calculate beside the columns.
    """
    widths = {title: width for title, rows in sheets.items() if (width := _named_width(rows))}
    if not widths:
        return sheets
    if others := [title for title in sheets if title not in widths]:
        log.decide("sheets left out", ", ".join(others), "other sheets name time, displacement and force; these do not")
    if wider := [title for title in widths if any(any(row[widths[title] :]) for row in sheets[title])]:
        log.decide(
            "cells left out", ", ".join(wider), "cells to the right of the last named column are no part of the table"
        )
    return {title: [row[:width] for row in sheets[title]] for title, width in widths.items()}


def _named_width(rows: list[list[str]]) -> int:
    """Columns before the first one without a name, where the first rows name time, displacement and force; else 0."""
    for row in rows[:_HEADER_ROWS]:
        known = [roles_of_name(split_name(cell)[0]) & set(ROLES) for cell in row]
        if frozenset[str]().union(*known) >= set(ROLES):
            last = max(at for at, roles in enumerate(known) if roles)
            nameless = (at for at in range(last + 1, len(row)) if not row[at] or parse(row[at], ".") is not None)
            return next(nameless, len(row))
    return 0


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, datetime.datetime):
        return value.isoformat(sep=" ", timespec="microseconds")
    if isinstance(value, datetime.time):
        return value.isoformat(timespec="microseconds")
    if isinstance(value, datetime.timedelta):
        return repr(value.total_seconds())
    return repr(value) if isinstance(value, float) else " ".join(str(value).split())


def _numeric(row: list[str]) -> bool:
    return sum(cell[0] in "+-0123456789.,−" for cell in row if cell) >= 2
