"""A sparse matrix whose pattern is found once and filled many times.

Where the matrix is symmetric and its band narrow, as in a section of a pad, it is factorised as a band by Cholesky's
method, a quarter of the time of the sparse factorisation, which is left for all others and for a tangent that is not
positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray

MOST_BAND_WORK = 1e8
"""Unknowns times the square of the bandwidth up to which the band is factorised; beyond it the sparse way is faster."""


class Pattern:
    """Adds element matrices of fixed connectivity into one sparse matrix over the free unknowns.

    Parameters
    ----------
    groups : list of ndarray, shape (elements, element dofs)
        Connectivity of each kind of element (solid, contact edge); matrices are given in this order.
    free : ndarray of int
        Unknowns that are solved for; the others are prescribed.
    size : int
        Number of all unknowns.
    """

    def __init__(self, groups: list[Array], free: Array, size: int) -> None:
        self.free, self.size, self.n = free, size, len(free)
        moves = np.zeros(size, dtype=bool)
        moves[free] = True
        uses = np.bincount(np.concatenate([dofs.ravel() for dofs in groups]), minlength=size)
        # The last unknowns of the elements, if no other element has them, are eliminated before the factorisation.
        alone = ((uses == 1) & moves)[groups[0]].all(axis=0)
        self._shared = len(alone) if alone.all() else int(np.max(np.nonzero(~alone)[0])) + 1
        self._inner, self._outer = groups[0][:, self._shared :], groups[0][:, : self._shared]
        self._kept = np.setdiff1d(free, self._inner)
        number = np.full(size, -1, dtype=np.int64)
        number[self._kept] = np.arange(len(self._kept))
        rows, columns = [], []
        for dofs in [self._outer, *groups[1:]]:
            width = dofs.shape[1]
            rows.append(np.repeat(number[dofs], width, axis=1).ravel())
            columns.append(np.tile(number[dofs], (1, width)).ravel())
        row, column = np.concatenate(rows), np.concatenate(columns)
        self._keep = (row >= 0) & (column >= 0)
        self._row, self._column = row[self._keep], column[self._keep]
        self._order: Array | None = None
        self._arrange(np.arange(len(self._kept)))
        self._band = self._lay_band()

    def _arrange(self, place: Array) -> None:
        """Number the unknowns anew; ``place`` is where each one goes."""
        n = len(self._kept)
        key = place[self._column] * n + place[self._row]
        unique, self._place = np.unique(key, return_inverse=True)
        self._indices = (unique % n).astype(np.int32)
        self._pointer = np.searchsorted(unique, np.arange(n + 1) * n).astype(np.int32)
        self._to = place

    def _lay_band(self) -> _Band | None:
        """Order that makes the band narrow, and where every value goes in it; None where the band is too wide."""
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        n = len(self._kept)
        pattern = csr_matrix((np.ones(len(self._indices)), self._indices, self._pointer), shape=(n, n))
        order = reverse_cuthill_mckee(pattern, symmetric_mode=True)
        place = np.empty(n, dtype=np.int64)
        place[order] = np.arange(n)
        row, column = place[self._row], place[self._column]
        width = int(np.abs(row - column).max(initial=0))
        if n * width**2 > MOST_BAND_WORK:
            return None
        lower = np.nonzero(row >= column)[0]
        return _Band(width, place, lower, column[lower] * (width + 1) + row[lower] - column[lower])

    def _by_band(self, values: Array, rest: Array, contact: list[Array]) -> Array | None:
        """Solution by the band; None where the matrix is not symmetric or not positive."""
        from scipy.linalg.lapack import dpbtrf, dpbtrs

        band, n = self._band, len(self._kept)
        if band is None or any(_uneven(matrix) for matrix in contact):
            return None
        stored = np.bincount(band.place, values[band.lower], minlength=n * (band.width + 1))
        factor, problem = dpbtrf(stored.reshape(n, band.width + 1).T, lower=1, overwrite_ab=1)
        if problem:
            return None
        permuted = np.empty(n)
        permuted[band.order] = rest
        return dpbtrs(factor, permuted, lower=1)[0][band.order]

    def solve(self, matrices: list[Array], load: Array) -> Array:
        """Solve for the free unknowns; the others are zero in the answer, which has full length.

        The first matrices, those of ``groups[0]``, are symmetric. The first call finds an ordering with little fill;
        later ones reuse it.
        """
        whole, shared = matrices[0], self._shared
        inverse, coupling = np.linalg.inv(whole[:, shared:, shared:]), whole[:, shared:, :shared]
        onto = inverse @ coupling
        condensed = whole[:, :shared, :shared] - coupling.transpose(0, 2, 1) @ onto
        values = np.concatenate([matrix.ravel() for matrix in [condensed, *matrices[1:]]])[self._keep]
        moved = (onto.transpose(0, 2, 1) @ load[self._inner][:, :, None])[:, :, 0]
        rest = (load - np.bincount(self._outer.ravel(), moved.ravel(), minlength=self.size))[self._kept]
        found = self._by_band(values, rest, matrices[1:])
        answer = np.zeros(self.size)
        answer[self._kept] = self._by_superlu(values, rest) if found is None else found
        inside = inverse @ load[self._inner][:, :, None] - onto @ answer[self._outer][:, :, None]
        answer[self._inner] = inside[:, :, 0]
        return answer

    def _by_superlu(self, values: Array, rest: Array) -> Array:
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import splu

        data = np.bincount(self._place, values, minlength=len(self._indices))
        n = len(self._kept)
        matrix = csc_matrix((data, self._indices, self._pointer), shape=(n, n))
        matrix.has_canonical_format = True
        # The condensed tangent is symmetric with a strong diagonal: pivoting on it halves the fill.
        order = "MMD_AT_PLUS_A" if self._order is None else "NATURAL"
        factor = splu(matrix, permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        permuted = np.empty(n)
        permuted[self._to] = rest
        found = factor.solve(permuted)[self._to]
        if self._order is None:
            self._order = factor.perm_c
            self._arrange(self._order.astype(np.int64))
        return found


@dataclass(frozen=True)
class _Band:
    """A band of lower diagonals: its width, where every unknown goes, and which values go where in it."""

    width: int
    order: Array
    lower: Array
    place: Array


def _uneven(matrix: Array) -> bool:
    """Whether small matrices, shape (m, k, k), are not symmetric beyond rounding."""
    return bool(np.abs(matrix - matrix.transpose(0, 2, 1)).max(initial=0.0) > 1e-12 * np.abs(matrix).max(initial=0.0))
