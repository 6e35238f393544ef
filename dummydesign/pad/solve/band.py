"""Symmetric matrices whose unknowns lie near each other: the narrowest band found once, Cholesky in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

Array = np.ndarray

# Wider bands are left to the sparse factorisation: the work grows with the square of the width.
WIDEST = 250
# Relative asymmetry that is rounding.
ASYMMETRY = 1e-12


class Band:
    """Places of entries in the lower band of a symmetric matrix, after Cuthill and McKee's ordering or a narrower one.

    Parameters
    ----------
    row, column : ndarray of int, shape (entries,)
        Where the entries stand; several may share a place and are added, those with a negative row or column left out.
    n : int
        Rows of the matrix.
    orders : sequence of ndarray of int, shape (n,)
        Other orderings to try: columns of a grid one after the other are a third narrower than Cuthill and McKee's
        levels, which begin in a corner.
    """

    def __init__(self, row: Array, column: Array, n: int, orders: Sequence[Array] = ()) -> None:
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        inside = np.nonzero((row >= 0) & (column >= 0))[0]
        row, column = row[inside], column[inside]
        levels = reverse_cuthill_mckee(csr_matrix((np.ones(len(row)), (row, column)), shape=(n, n)), True)
        places = [np.argsort(order) for order in (levels, *orders)]
        self._to = min(places, key=lambda to: int((to[row] - to[column]).max(initial=0)))
        below = self._to[row] - self._to[column]
        self.width, self._n = int(below.max(initial=0)), n
        lower = np.nonzero(below >= 0)[0]
        self._lower = inside[lower]
        # LAPACK's lower band storage, column by column.
        self._place = self._to[column[lower]] * (self.width + 1) + below[lower]

    @property
    def narrow(self) -> bool:
        """Whether the band is worth its work."""
        return self.width <= WIDEST

    def factorise(self, values: Array) -> Callable[[Array], Array] | None:
        """Give what solves for a load, shape (n,); None when the matrix is not positive definite.

        Parameters
        ----------
        values : ndarray, shape (entries,)
            In the order of ``row`` and ``column``; symmetric.
        """
        from scipy.linalg.lapack import dpbtrf, dpbtrs

        data = np.bincount(self._place, values[self._lower], minlength=self._n * (self.width + 1))
        factor, info = dpbtrf(data.reshape(self._n, self.width + 1).T, lower=1, overwrite_ab=1)
        if info:
            return None

        def solve(load: Array) -> Array:
            permuted = np.empty(self._n)
            permuted[self._to] = load
            return dpbtrs(factor, permuted, lower=1)[0][self._to]

        return solve


def symmetric(matrices: list[Array]) -> bool:
    """Whether element matrices, shape (elements, n, n) each, equal their transposes but for rounding."""
    for matrix in matrices:
        largest = np.abs(matrix).max(initial=0.0)
        if np.abs(matrix - matrix.transpose(0, 2, 1)).max(initial=0.0) > ASYMMETRY * largest:
            return False
    return True
