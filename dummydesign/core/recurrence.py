"""First-order linear recurrences along the last axis, the core of relaxation, Maxwell arms and filters."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

MANY = 32
"""Curves from which on single steps are cheaper than blocks."""


def linear_recurrence(factor: ArrayLike, addend: ArrayLike, start: ArrayLike = 0.0) -> NDArray:
    """Compute y[n] = factor[n] y[n-1] + addend[n] with y[-1] = start, along the last axis.

    Many curves are stepped through side by side. For few the axis is cut into about sqrt(n) blocks that are run
    side by side and then joined, so that the cost in Python is two loops of sqrt(n) steps.
    """
    factor, addend = np.asarray(factor), np.asarray(addend)
    count = max(factor.shape[-1], addend.shape[-1])
    if count == 0:
        return np.zeros(np.broadcast_shapes(factor.shape, addend.shape))
    leading = np.broadcast_shapes(factor.shape[:-1], addend.shape[:-1], np.shape(start))
    if np.prod(leading, dtype=int) >= MANY:
        return _stepped(factor, addend, start, leading, count)
    width = int(np.ceil(np.sqrt(count)))
    blocks = -(-count // width)

    def in_blocks(values: NDArray, fill: float) -> NDArray:
        padded = np.full((*values.shape[:-1], blocks * width), fill, dtype=np.result_type(values, float))
        padded[..., :count] = values
        return padded.reshape(*values.shape[:-1], blocks, width)

    product = in_blocks(factor, 1.0)
    kind = np.result_type(factor, addend, float)
    value = np.broadcast_to(in_blocks(addend, 0.0), (*leading, blocks, width)).astype(kind, copy=True)
    for column in range(1, width):
        value[..., column] += product[..., column] * value[..., column - 1]
        product[..., column] *= product[..., column - 1]
    carry = np.broadcast_to(np.asarray(start, dtype=kind), leading)
    for block in range(blocks):
        value[..., block, :] += product[..., block, :] * carry[..., None]
        carry = value[..., block, -1]
    return value.reshape(*leading, blocks * width)[..., :count]


def _stepped(factor: NDArray, addend: NDArray, start: ArrayLike, leading: tuple[int, ...], count: int) -> NDArray:
    """The recurrence step by step, with the axis of the steps first in memory."""
    kind = np.result_type(factor, addend, float)
    value = np.empty((count, *leading), dtype=kind)
    value[...] = np.moveaxis(addend, -1, 0)[(slice(None), *(None,) * (len(leading) + 1 - addend.ndim))]
    shape = (factor.shape[-1], *(1,) * (len(leading) + 1 - factor.ndim), *factor.shape[:-1])
    turned = np.ascontiguousarray(np.moveaxis(factor, -1, 0)).reshape(shape)
    turned = np.broadcast_to(turned, (count, *shape[1:]))
    before, product = np.broadcast_to(np.asarray(start, dtype=kind), leading), np.empty(leading, dtype=kind)
    for now, multiplier in zip(value, turned):
        np.multiply(multiplier, before, out=product)
        now += product
        before = now
    return np.moveaxis(value, 0, -1)
