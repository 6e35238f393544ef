"""Sparse matrices with a fixed pattern: banded Cholesky and SuperLU."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

Array = np.ndarray

# Wider bands are left to the sparse factorisation: the work grows with the square of the width.
WIDEST = 250
# Relative asymmetry that is rounding.
ASYMMETRY = 1e-12


class BandLayout:
    """Places of entries in the lower band of a symmetric matrix, after Cuthill and McKee's order or a narrower one.

    The unknowns ``late`` come in its second half: when entries between them change, columns before stay as they were
    factorised.
    """

    def __init__(
        self, row: Array, column: Array, n: int, orders: Sequence[Array] = (), late: Array | None = None
    ) -> None:
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        inside = np.nonzero((row >= 0) & (column >= 0))[0]
        row, column = row[inside], column[inside]
        levels = reverse_cuthill_mckee(csr_matrix((np.ones(len(row)), (row, column)), shape=(n, n)), True)
        places = [np.argsort(order) for order in (levels, *orders)]
        self._to = min(places, key=lambda to: int((to[row] - to[column]).max(initial=0)))
        if late is not None and len(late) and self._to[late].mean() < 0.5 * n:
            self._to = n - 1 - self._to
        below = self._to[row] - self._to[column]
        self.width, self._n = int(below.max(initial=0)), n
        lower = np.nonzero(below >= 0)[0]
        self._lower = inside[lower]
        self._takes: list[Array] = []
        self._first: Array | None = None
        self._factor: Array | None = None
        self._added = np.array([])
        # LAPACK's lower band storage, column by column.
        self._slot = self._to[column[lower]] * (self.width + 1) + below[lower]

    def factorise(self, groups: list[Array]) -> Callable[[Array], Array] | None:
        """Give what solves for a load, shape (n,); None when the matrix is not positive definite.

        ``groups`` are the element matrices whose entries, one group after the other, have the rows and columns.
        """
        from scipy.linalg.lapack import dpbtrf, dpbtrs

        if len(self._takes) != len(groups):
            ends = np.cumsum([matrix.size for matrix in groups])
            cuts = np.searchsorted(self._lower, ends)
            self._takes = [
                part - end + matrix.size for part, end, matrix in zip(np.split(self._lower, cuts[:-1]), ends, groups)
            ]
        first, wide = groups[0], self.width + 1
        count = len(self._takes[0])
        rest = [matrix.ravel().take(take) for matrix, take in zip(groups[1:], self._takes[1:])]
        added, slots = np.concatenate([np.array([]), *rest]), self._slot[count:]
        start = 0
        if first is not self._first:
            values = first.ravel().take(self._takes[0])
            self._data, self._first = np.bincount(self._slot[:count], values, minlength=self._n * wide), first
        elif self._factor is not None:
            start = min(int(slots[added != self._added].min(initial=self._n * wide)) // wide, self._n - self.width)
        if self._factor is None or start < self.width:
            start, self._factor = 0, np.empty(self._n * wide)
        tail = self._factor[start * wide :]
        tail[:] = self._data[start * wide :]
        inside = slots >= start * wide
        np.add.at(tail, slots[inside] - start * wide, added[inside])
        if start:
            # Rows of the columns before, and below the diagonal of those after, lie in squares of the band's storage.
            square, before = self.width**2, (start - self.width) * wide + self.width
            rows = np.tril(self._factor[before : before + square].reshape(self.width, -1))
            tail[:square] -= np.triu(rows.T @ rows).ravel()
        _, info = dpbtrf(tail.reshape(-1, wide).T, lower=1, overwrite_ab=1)
        if info:
            self._factor = None
            return None
        self._added, factor = added, self._factor.reshape(self._n, wide).T

        def solve(load: Array) -> Array:
            permuted = np.empty(self._n)
            permuted[self._to] = load
            return dpbtrs(factor, permuted, lower=1)[0][self._to]

        return solve


def symmetric(matrices: list[Array]) -> bool:
    """Whether element matrices, shape (elements, n, n) each, equal their transposes but for rounding."""
    skew = ((matrix - matrix.transpose(0, 2, 1), matrix) for matrix in matrices)
    return not any(np.abs(part).max(initial=0.0) > ASYMMETRY * np.abs(whole).max(initial=0.0) for part, whole in skew)


class Pattern:
    """Adds element matrices of fixed connectivity into one sparse matrix over the free unknowns."""

    # A factorised tangent is used again while that brings the residual below the first share; uses that do not bring it
    # below the second are undone.
    contraction = (0.3, 1.0)

    def __init__(self, groups: list[Array], free: Array, size: int, nodes: Array | None = None) -> None:
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
        orders = [] if nodes is None else _sweeps(nodes[:, self._kept // len(nodes)])
        late = np.concatenate([np.array([], dtype=int), *(number[dofs].ravel() for dofs in groups[1:])])
        self._band = BandLayout(row, column, len(self._kept), orders, late[late >= 0])
        self._order: Array | None = None
        self._to: Array | None = None
        self._whole: Array | None = None

    def _arrange(self, order: Array) -> None:
        """Number the unknowns anew; ``order`` is where each one goes."""
        n = len(self._kept)
        key = order[self._column] * n + order[self._row]
        unique, self._slot = np.unique(key, return_inverse=True)
        self._indices = (unique % n).astype(np.int32)
        self._pointer = np.searchsorted(unique, np.arange(n + 1) * n).astype(np.int32)
        self._to = order

    def solve(self, matrices: list[Array], load: Array) -> Array:
        """Solve for the free unknowns; the others are zero in the answer, which has full length.

        The first matrices, those of ``groups[0]``, are symmetric.
        """
        whole, shared = matrices[0], self._shared
        if whole is not self._whole:
            self._whole = whole
            self._inner_inverse, coupling = _inverse(whole[:, shared:, shared:]), whole[:, shared:, :shared]
            self._onto = self._inner_inverse @ coupling
            self._condensed = whole[:, :shared, :shared] - coupling.transpose(0, 2, 1) @ self._onto
        groups = [self._condensed, *matrices[1:]]
        factor = self._band.factorise(groups) if self._band.width <= WIDEST and symmetric(matrices[1:]) else None
        self._factor = factor or self._sparse(np.concatenate([matrix.ravel() for matrix in groups])[self._keep])
        return self.again(load)

    def again(self, load: Array) -> Array:
        """Solve for another load with the matrices of the last :meth:`solve`."""
        inside = load[self._inner][:, :, None]
        moved = (self._onto.transpose(0, 2, 1) @ inside)[:, :, 0]
        rest = load - np.bincount(self._outer.ravel(), moved.ravel(), minlength=self.size)
        answer = np.zeros(self.size)
        answer[self._kept] = self._factor(rest[self._kept])
        inner = self._inner_inverse @ inside - self._onto @ answer[self._outer][:, :, None]
        answer[self._inner] = inner[:, :, 0]
        return answer

    def _sparse(self, values: Array) -> Callable[[Array], Array]:
        """By SuperLU: the first call finds an ordering with little fill, later ones reuse it."""
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import splu

        n = len(self._kept)
        if self._to is None:
            self._arrange(np.arange(n))
        data = np.bincount(self._slot, values, minlength=len(self._indices))
        matrix = csc_matrix((data, self._indices, self._pointer), shape=(n, n))
        matrix.has_canonical_format = True
        # The condensed tangent is symmetric with a strong diagonal: pivoting on it halves the fill.
        order = "MMD_AT_PLUS_A" if self._order is None else "NATURAL"
        factor, to = splu(matrix, permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True}), self._to
        if self._order is None:
            self._order = factor.perm_c
            self._arrange(self._order.astype(np.int64))

        def solve(load: Array) -> Array:
            permuted = np.empty(n)
            permuted[to] = load
            return factor.solve(permuted)[to]

        return solve


def _sweeps(places: Array) -> list[Array]:
    """Orderings of places (dimension, n) along each direction, those alike in it along the next one."""
    alike = np.round(places / np.ptp(places), 9)
    return [np.lexsort(np.roll(alike, -axis, axis=0)[::-1]) for axis in range(len(places))]


def _inverse(blocks: Array) -> Array:
    """Inverses of small matrices, shape (elements, n, n); those of two rows in closed form."""
    if blocks.shape[-1] != 2:
        return np.linalg.inv(blocks)
    a, b, c, d = blocks[:, 0, 0], blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1]
    adjugate = np.stack([d, -b, -c, a], axis=-1).reshape(-1, 2, 2)
    return adjugate / (a * d - b * c)[:, None, None]
