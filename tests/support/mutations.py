"""Files damaged at random, as copying, editing and crashes damage them. Seeded."""

from __future__ import annotations

import numpy as np


def mutate(data: bytes, seed: int) -> bytes:
    """Apply one to four random faults to the bytes of a file."""
    draw = np.random.default_rng([seed, 7])
    for _ in range(int(draw.integers(1, 5))):
        data = _FAULTS[int(draw.integers(len(_FAULTS)))](draw, data)
    return data


def _place(draw, data: bytes) -> int:
    """A place, more often near the start, where the header is."""
    end = len(data) if draw.random() < 0.6 else min(len(data), 400)
    return int(draw.integers(0, max(end, 1)))


def _cut(draw, data):
    return data[: _place(draw, data)]


def _behead(draw, data):
    return data[_place(draw, data) :]


def _flip(draw, data):
    out = bytearray(data)
    for _ in range(int(draw.integers(1, 20))):
        if out:
            out[_place(draw, data)] = int(draw.integers(256))
    return bytes(out)


def _drop(draw, data):
    at = _place(draw, data)
    return data[:at] + data[at + int(draw.integers(1, 200)) :]


def _insert(draw, data):
    words = (
        b"NaN",
        b"inf",
        b"\x00",
        b"\n",
        b",,,",
        b";;",
        b'"',
        b"1e999",
        b"-",
        b"\xff\xfe",
        b"text,text",
        b"\r",
        b"  ",
        "変位".encode(),
        b"9" * 400,
        b"\x1a",
        b"=1/0",
        b"#REF!",
        b"1.2.3",
        b"1,2,3",
        b"--",
        b"1e-400",
        b"\t\t\t",
    )
    at = _place(draw, data)
    return data[:at] + words[int(draw.integers(len(words)))] + data[at:]


def _double(draw, data):
    a, b = sorted((_place(draw, data), _place(draw, data)))
    return data[:b] + data[a:]


def _lines(draw, data):
    lines = data.split(b"\n")
    kind = int(draw.integers(4))
    if kind == 0:
        draw.shuffle(lines)
    elif kind == 1:
        lines = lines[::-1]
    elif kind == 2:
        del lines[int(draw.integers(len(lines))) :: 2]
    else:
        at = int(draw.integers(len(lines)))
        lines[at:at] = lines[: int(draw.integers(1, 5))]
    return b"\n".join(lines)


def _replace(draw, data):
    pairs = ((b",", b";"), (b".", b","), (b";", b","), (b"\t", b" "), (b"0", b""), (b"-", b""), (b"\n", b""),
             (b"e", b"E"), (b"s", b"ms"), (b"mm", b"m"), (b"N", b"kg"), (b"1", b"x"), (b"\n", b"\n\n"), (b",",
             b""))  # fmt: skip
    old, new = pairs[int(draw.integers(len(pairs)))]
    return data.replace(old, new, int(draw.choice([1, 50, -1])))


def _constant(draw, data):
    """One column of every line becomes the same."""
    for sign in (b";", b"\t", b","):
        lines = data.split(b"\n")
        if sum(sign in line for line in lines) > len(lines) // 2:
            column, word = int(draw.integers(3)), (b"0", b"1.5", b"", b"nan", b"1e308")[int(draw.integers(5))]
            rows = [line.split(sign) for line in lines]
            for row in rows:
                if len(row) > column:
                    row[column] = word
            return b"\n".join(sign.join(row) for row in rows)
    return data


_FAULTS = (_cut, _behead, _flip, _drop, _insert, _insert, _double, _lines, _replace, _replace, _constant)
