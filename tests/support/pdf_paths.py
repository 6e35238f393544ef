"""What a PDF really draws: straight paths and rectangles of its pages, in millimetres on the paper."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator

import numpy as np

MM = 25.4 / 72.0


def pages_mm(data: bytes) -> list[tuple[float, float]]:
    """Width and height of every page. [mm]"""
    boxes = re.findall(rb"/MediaBox ?\[ ?0 0 ([\d.]+) ([\d.]+) ?\]", data)
    return [(float(w) * MM, float(h) * MM) for w, h in boxes]


def contents(data: bytes) -> Iterator[str]:
    """The drawing operators of every page."""
    for stream in re.findall(rb"/Filter ?/FlateDecode[^>]*>>\s*stream\r?\n(.*?)endstream", data, re.S):
        text = zlib.decompressobj().decompress(stream)
        if text.isascii() and b" cm" in text and b" l\n" in text:
            yield text.decode("latin-1")


def paths_mm(content: str) -> list[np.ndarray]:
    """Runs of straight lines, shape (n, 2), and rectangles by their four corners. [mm on paper]"""
    matrix, stack, run, found = np.eye(3), [], [], []
    words: list[str] = []

    def on_paper(x: float, y: float) -> np.ndarray:
        return (np.array([x, y, 1.0]) @ matrix)[:2] * MM

    for word in content.replace("/", " /").split():
        if word in ("q", "Q", "cm", "m", "l", "re", "S", "f", "f*", "B", "n", "h"):
            numbers = [float(one) for one in words[-6:] if re.fullmatch(r"-?[\d.]+", one)]
            if word == "q":
                stack.append(matrix)
            elif word == "Q":
                matrix = stack.pop()
            elif word == "cm":
                a, b, c, d, e, f = numbers
                matrix = np.array([[a, b, 0], [c, d, 0], [e, f, 1]]) @ matrix
            elif word == "m":
                found += [np.array(run)] if len(run) > 1 else []
                run = [on_paper(*numbers[-2:])]
            elif word == "l":
                run.append(on_paper(*numbers[-2:]))
            elif word == "re":
                x, y, w, h = numbers[-4:]
                found.append(np.array([on_paper(x, y), on_paper(x + w, y), on_paper(x + w, y + h), on_paper(x, y + h)]))
            else:
                found += [np.array(run)] if len(run) > 1 else []
                run = []
            words = []
        else:
            words.append(word)
    return found
