"""What a direct solver leaves of a load: a right answer shows there, however many digits its matrix lets it have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix

from dummydesign.pad.solve.equilibrium import ContactProblem

Array = np.ndarray


def added_up(groups: Sequence[Array], matrices: Sequence[Array], size: int) -> csr_matrix:
    """Element matrices (elements, n, n) of dofs (elements, n), added up."""
    parts = [
        (matrix.ravel(), np.repeat(dofs, dofs.shape[1], axis=1).ravel(), np.tile(dofs, (1, dofs.shape[1])).ravel())
        for dofs, matrix in zip(groups, matrices)
    ]
    value, row, column = (np.concatenate(part) for part in zip(*parts))
    return csr_matrix((value, (row, column)), shape=(size, size))


def backward_error(matrix: csr_matrix, free: Array, answer: Array, load: Array) -> float:
    """Largest residual over |A| |x| + |b|, row by row: the relative change of A and b that makes the answer exact.

    References
    ----------
    W. Oettli, W. Prager, Numer. Math. 6 (1964) 405.
    """
    residual, terms = np.abs(matrix @ answer - load), abs(matrix) @ np.abs(answer) + np.abs(load)
    return float((residual[free] / terms[free]).max())


def rounding(free: Array) -> float:
    """The relative change of the matrix that a Cholesky or LU solve of n unknowns may amount to, 3 n u.

    References
    ----------
    N. J. Higham, Accuracy and Stability of Numerical Algorithms, theorems 9.4 and 10.4.
    """
    return 1.5 * len(free) * float(np.finfo(float).eps)


def out_of_balance(problem: ContactProblem) -> float:
    """Forces that the free unknowns of a problem without contact are left with at first touch, over its stiffness.

    Punch and base carry the same but for these, so this is how far the stiffness is known.
    """
    mesh, move = problem.solid.mesh, problem.direction()[0]
    tangent = problem.solid.linearise(problem.solid.state(*problem.start()))
    left = added_up([mesh.dofs], [tangent.stiffness], mesh.size) @ move
    return float(np.abs(left[problem.pattern.free]).sum() / problem.stiffness())
