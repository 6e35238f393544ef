"""What stands on the pages of a PDF of Typst: each run of letters with its place, size and width."""

from __future__ import annotations

import math
import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

MM = 25.4 / 72.0
OBJECT = re.compile(rb"(\d+) 0 obj\s*(.*?)endobj", re.S)
INNER = rb"(?:[^()\\]|\\.|\((?:[^()\\]|\\.)*\))*"
TOKEN = re.compile(rb"\(" + INNER + rb"\)|/[\w.+-]+|[\[\]]|[^\s\[\]()/<>]+", re.S)
SIGNS = {b"n": 10, b"r": 13, b"t": 9, b"b": 8, b"f": 12}


@dataclass(frozen=True)
class Placed:
    """Letters, the first end of their base line from the upper left of the paper, their size on paper, their length.

    Upright ones run up the paper.
    """

    words: str
    x_mm: float
    y_mm: float
    size_pt: float
    width_mm: float
    page: int = 0
    upright: bool = False

    @property
    def end_mm(self) -> tuple[float, float]:
        """The other end of the base line."""
        if self.upright:
            return self.x_mm, self.y_mm - self.width_mm
        return self.x_mm + self.width_mm, self.y_mm


def objects(data: bytes) -> dict[int, bytes]:
    """Objects by number; streams are unpacked."""
    found = {}
    for number, body in OBJECT.findall(data):
        head, stream, packed = body.partition(b"stream")
        if b"/FlateDecode" in head and stream:
            body = head + stream + zlib.decompressobj().decompress(packed.strip(b"\r\n"))
        found[int(number)] = body
    return found


def placed_texts(data: bytes) -> list[Placed]:
    """All runs of letters, page by page, in their order; those that adjoin are one."""
    parts = objects(data)
    pages = [body for body in parts.values() if re.search(rb"/Type/Page\b", body)]
    merged: list[Placed] = []
    for one in (one for number, page in enumerate(pages) for one in _page(parts, page, number)):
        last = merged[-1] if merged else None
        if last and (one.page, one.size_pt, one.upright) == (last.page, last.size_pt, last.upright):
            if math.dist((one.x_mm, one.y_mm), last.end_mm) < 0.05:
                wide = math.dist(one.end_mm, (last.x_mm, last.y_mm))
                merged[-1] = replace(last, words=last.words + one.words, width_mm=wide)
                continue
        merged.append(one)
    return merged


def pdf_texts(data: bytes) -> list[str]:
    """The words of all runs."""
    return [one.words for one in placed_texts(data)]


def pdf_text(data: bytes) -> str:
    """All words in their order, with single spaces."""
    return " ".join(" ".join(pdf_texts(data)).split())


def _reference(body: bytes, name: bytes) -> int:
    return int(re.search(rb"/" + name + rb"\s*(\d+) 0 R", body)[1])


def _page(parts: dict[int, bytes], page: bytes, number: int) -> Iterator[Placed]:
    high = float(re.search(rb"/MediaBox\s*\[\s*0 0 [\d.]+ ([\d.]+)", page)[1])
    resources = parts[_reference(page, b"Resources")] if re.search(rb"/Resources \d", page) else page
    yield from _content(parts, parts[_reference(page, b"Contents")], resources, np.diag([1, 1, 1.0]), high, number)


def _content(parts, body, resources, matrix, high, number):
    fonts = {name: _font(parts, int(at)) for name, at in re.findall(rb"/(f\d+) (\d+) 0 R", resources)}
    forms = {name: int(at) for name, at in re.findall(rb"/(x\d+) (\d+) 0 R", resources)}
    stack, operands, (letters, widths), size = [], [], ({}, {}), 1.0
    for token in TOKEN.findall(body.partition(b"stream")[2]):
        if token == b"q":
            stack.append(matrix)
        elif token == b"Q":
            matrix = stack.pop()
        elif token in (b"cm", b"Tm"):
            a, b, c, d, e, f = map(float, operands[-6:])
            moved = np.array([[a, b, 0], [c, d, 0], [e, f, 1]]) @ matrix
            matrix, text = (moved, None) if token == b"cm" else (matrix, moved)
        elif token == b"Tf":
            (letters, widths), size = fonts[operands[-2][1:]], float(operands[-1])
        elif token in (b"TJ", b"Tj"):
            codes = [code for one in operands if one[:1] == b"(" for code in _codes(one[1:-1])]
            kerned = sum(float(one) for one in operands if re.fullmatch(rb"-?[\d.]+", one)) if token == b"TJ" else 0.0
            wide = (sum(widths.get(code, 0.0) for code in codes) - kerned) / 1000.0 * size
            x, y = text[2, 0] * MM, (high - text[2, 1]) * MM
            scale = float(np.hypot(*text[0, :2]))
            upright = abs(float(text[0, 1])) > abs(float(text[0, 0]))
            yield Placed("".join(letters[c] for c in codes), x, y, scale * size, scale * wide * MM, number, upright)
        elif token == b"Do" and operands[-1][1:] in forms:
            form = parts[forms[operands[-1][1:]]]
            inner = parts[_reference(form, b"Resources")] if re.search(rb"/Resources \d", form) else form
            yield from _content(parts, form, inner, matrix, high, number)
        else:
            operands.append(token)
            continue
        operands = []


def _codes(packed: bytes) -> list[int]:
    """Two bytes a letter."""

    def sign(match: re.Match[bytes]) -> bytes:
        return bytes([int(match[1], 8) if match[1].isdigit() else SIGNS.get(match[1], match[1][0])])

    raw = re.sub(rb"\\([0-7]{1,3}|.)", sign, packed, flags=re.S)
    return [256 * high + low for high, low in zip(raw[::2], raw[1::2])]


@cache
def _packed(names: bytes, widths: bytes) -> tuple[dict[int, str], dict[int, float]]:
    letters = {}
    for block in re.findall(rb"beginbfchar(.*?)endbfchar", names, re.S):
        for code, text in re.findall(rb"<(\w+)>\s*<(\w+)>", block):
            letters[int(code, 16)] = bytes.fromhex(text.decode()).decode("utf-16-be")
    for block in re.findall(rb"beginbfrange(.*?)endbfrange", names, re.S):
        for first, last, text in re.findall(rb"<(\w+)>\s*<(\w+)>\s*<(\w+)>", block):
            for step in range(int(last, 16) - int(first, 16) + 1):
                letters[int(first, 16) + step] = chr(int(text, 16) + step)
    wide: dict[int, float] = {}
    for first, row, low, high, one in re.findall(rb"(\d+)\s*\[([^\]]*)\]|(\d+) (\d+) ([\d.]+)", widths):
        wide |= {int(first) + step: float(value) for step, value in enumerate(row.split())}
        wide |= dict.fromkeys(range(int(low), int(high) + 1), float(one)) if one else {}
    return letters, wide


def _font(parts: dict[int, bytes], number: int) -> tuple[dict[int, str], dict[int, float]]:
    """Letters and widths by code."""
    font = parts[number]
    below = parts[int(re.search(rb"/DescendantFonts\s*\[(\d+)", font)[1])]
    widths = re.search(rb"/W\s*\[(.*)\]", below, re.S)
    return _packed(parts[_reference(font, b"ToUnicode")], widths[1] if widths else b"")
