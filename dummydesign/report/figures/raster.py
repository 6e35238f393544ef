"""Colours of maps, and maps of many cells as a small PNG inside the page."""

from __future__ import annotations

import base64
import struct
import zlib

import numpy as np
from numpy.typing import NDArray

# Dark violet to yellow with even steps of lightness, readable without colour vision.
STOPS = np.array(
    [(68, 1, 84), (70, 50, 127), (54, 92, 141), (39, 127, 142), (31, 161, 135), (74, 194, 109), (159, 218, 58),
     (253, 231, 37)], float,
)  # fmt: skip


def colours(share: NDArray) -> NDArray:
    """Colours (..., 3) from 0 to 255 of shares between 0 and 1."""
    place = np.clip(np.nan_to_num(share), 0.0, 1.0) * (len(STOPS) - 1)
    return np.stack([np.interp(place, np.arange(len(STOPS)), STOPS[:, band]) for band in range(3)], axis=-1)


def css(share: float) -> str:
    """One colour as CSS."""
    red, green, blue = colours(np.array(share)).round().astype(int)
    return f"#{red:02x}{green:02x}{blue:02x}"


def png_uri(share: NDArray) -> str:
    """Map (rows, columns) of shares as a data URI, first row at the bottom, cells without a value transparent.

    Parameters
    ----------
    share : ndarray, shape (rows, columns)
        0 to 1, NaN for transparent.

    References
    ----------
    W3C, Portable Network Graphics (second edition), chapters 10 and 11.
    """
    opaque = np.where(np.isfinite(share), 255, 0)[..., None]
    pixels = np.concatenate([colours(share).round(), opaque], axis=-1).astype(np.uint8)[::-1]
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", share.shape[1], share.shape[0], 8, 6, 0, 0, 0)
    parts = [chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows, 9)), chunk(b"IEND", b"")]
    return "data:image/png;base64," + base64.b64encode(b"\x89PNG\r\n\x1a\n" + b"".join(parts)).decode("ascii")
