"""A sparse matrix whose pattern is found once and filled many times."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


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
        number = np.full(size, -1, dtype=np.int64)
        number[free] = np.arange(len(free))
        self.free, self.size, self.n = free, size, len(free)
        rows, columns = [], []
        for dofs in groups:
            width = dofs.shape[1]
            rows.append(np.repeat(number[dofs], width, axis=1).ravel())
            columns.append(np.tile(number[dofs], (1, width)).ravel())
        row, column = np.concatenate(rows), np.concatenate(columns)
        self._keep = (row >= 0) & (column >= 0)
        self._row, self._column = row[self._keep], column[self._keep]
        self._order: Array | None = None
        self._arrange(np.arange(self.n))

    def _arrange(self, place: Array) -> None:
        """Number the free unknowns anew; ``place`` is where each one goes."""
        key = place[self._column] * self.n + place[self._row]
        unique, self._place = np.unique(key, return_inverse=True)
        self._indices = (unique % self.n).astype(np.int32)
        self._pointer = np.searchsorted(unique, np.arange(self.n + 1) * self.n).astype(np.int32)
        self._to = place

    def solve(self, matrices: list[Array], load: Array) -> Array:
        """Solve for the free unknowns; the others are zero in the answer, which has full length.

        The first call finds an ordering with little fill; later ones reuse it.
        """
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import splu

        values = np.concatenate([matrix.ravel() for matrix in matrices])[self._keep]
        data = np.bincount(self._place, values, minlength=len(self._indices))
        matrix = csc_matrix((data, self._indices, self._pointer), shape=(self.n, self.n))
        # The condensed tangent is symmetric with a strong diagonal: pivoting on it halves the fill.
        order = "MMD_AT_PLUS_A" if self._order is None else "NATURAL"
        factor = splu(matrix, permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        permuted = np.empty(self.n)
        permuted[self._to] = load[self.free]
        answer = np.zeros(self.size)
        answer[self.free] = factor.solve(permuted)[self._to]
        if self._order is None:
            self._order = factor.perm_c
            self._arrange(self._order.astype(np.int64))
        return answer
