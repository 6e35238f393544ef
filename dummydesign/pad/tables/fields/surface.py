"""The response surface of a field of caps: ln of the force over what punch and field overlap by, in three pieces.

The overlap (:func:`dummydesign.pad.tables.fields.overlap.overlap`) has the kinks where rings of caps and the flat
between them come under the punch; what is left is smooth. The first two pieces are functions of d / c (depth over the
caps' height), until the flat carries, the last of d / h. Caps that are just touched carry as Hertz says, later more
nearly by the volume they are pressed in by; that is what the first two pieces differ in. Pieces fade into each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.pad.tables.fields.overlap import HEIGHT_OVER_PITCH, overlap
from dummydesign.pad.tables.response_surface import Response

Array = np.ndarray

# Depths over the caps' height, but no less than over the thickness, between which each piece fades into the next.
CAPS_BEGIN = (0.3, 0.48)
PAD_BEGINS = (1.15, 0.15), (1.5, 0.21)
# How much of the overlap is Hertz's, of the first and of the later pieces.
FIRST, LATER = 3.0, 0.1
# Depth over the punch's radius below which the overlap is that of the middle tip.
NOTHING = 1e-9


def field_inputs(inputs: Array) -> Array:
    """Coordinates (n, 3) of the pieces: ln of the gel below the caps over a, ln pitch/a and grade over height."""
    below = np.exp(inputs[:, 0]) - HEIGHT_OVER_PITCH * np.exp(inputs[:, 1])
    return np.column_stack([np.log(np.maximum(below, 1e-3)), inputs[:, 1:]])


@dataclass(frozen=True)
class FieldResponse:
    """Surfaces over the coordinates of :func:`field_inputs`.

    Attributes
    ----------
    touched, caps : Response
        ln(F / (16/9 E sqrt(R) d^1.5)) - ln of the overlap, at levels of d / c.
    pad : Response
        The same at levels of d / h.
    """

    touched: Response
    caps: Response
    pad: Response

    def limit(self, inputs: Array) -> Array:
        """d / h to which inputs (n, 3) may be trusted; see :meth:`Response.limit`."""
        return self.pad.limit(field_inputs(inputs))

    def along(self, inputs: Array, place: Array, x: Array) -> tuple[Array, Array]:
        """ln(F / (16/9 E sqrt(R) d^1.5)) and its derivative by d / h.

        Parameters
        ----------
        inputs : ndarray, shape (n, 3)
            ln h/a, ln pitch/a, grade over height.
        place : ndarray of int
            Which of them each depth belongs to; any shape.
        x : ndarray
            d / h of the same shape, >= 0.
        """
        shape, place, x = x.shape, place.ravel(), np.maximum(x, 0.0).ravel()
        coordinates, thick = field_inputs(inputs), np.exp(inputs[:, 0])[place]
        cap = HEIGHT_OVER_PITCH * np.exp(inputs[:, 1])[place] / thick
        first, later = overlap(inputs[place], np.maximum(x * thick, NOTHING), FIRST, LATER)
        caps, pad = (end * cap for end in CAPS_BEGIN), (np.maximum(c * cap, h) for c, h in PAD_BEGINS)
        nowhere, everywhere, one = np.full(len(x), -1.0), np.full(len(x), np.inf), np.ones(len(x))
        begins, ends = ((nowhere, *pair, everywhere) for pair in zip(caps, pad))
        value, slope = np.zeros(len(x)), np.zeros(len(x))
        for k, (surface, (ratio, steep), unit) in enumerate(
            ((self.touched, first, cap), (self.caps, later, cap), (self.pad, later, one))
        ):
            # Between where its own share begins and the next one's is whole.
            on = np.nonzero((x > begins[k]) & (x < ends[k + 1]))[0]
            at = x[on] / unit[on]
            y, climb = surface.along(surface.at_levels(coordinates), place[on], at)
            y = y + np.log(ratio[on])
            climb = climb / (2.0 * np.sqrt(np.maximum(at, 1e-12)) * unit[on]) + steep[on] / ratio[on] * thick[on]
            part, grows = _fade(x[on], begins[k][on], ends[k][on]) if k else (1.0, 0.0)
            slope[on] += part * (climb - slope[on]) + grows * (y - value[on])
            value[on] += part * (y - value[on])
        return value.reshape(shape), slope.reshape(shape)


def _fade(x: Array, start: Array, end: Array) -> tuple[Array, Array]:
    """Share from 0 at ``start`` to 1 at ``end``, and its derivative."""
    t = np.clip((x - start) / (end - start), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / (end - start)
