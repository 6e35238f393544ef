"""The linear solver of sections: a band where the matrix allows it, a sparse factorisation where it does not."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.solve import sparse
from dummydesign.pad.solve.sparse import Pattern

ELEMENTS, WIDTH = 40, 4
DOFS = np.arange(ELEMENTS)[:, None] * 2 + np.arange(WIDTH)
SIZE = int(DOFS.max()) + 1


def stiffness(seed: int) -> np.ndarray:
    """Element matrices of a chain, symmetric and positive."""
    root = np.random.default_rng(seed).standard_normal((ELEMENTS, WIDTH, WIDTH))
    return root @ root.transpose(0, 2, 1) + 0.5 * np.eye(WIDTH)


def dense(matrices, free):
    whole = np.zeros((SIZE, SIZE))
    for dofs, matrix in zip(DOFS, sum(matrices[1:], matrices[0])):
        whole[np.ix_(dofs, dofs)] += matrix
    return whole[np.ix_(free, free)]


@pytest.mark.parametrize("kind", ["positive", "indefinite", "friction"])
def test_band_and_sparse_solve_what_a_dense_solve_gives(kind):
    free = np.setdiff1d(np.arange(SIZE), [0, 5])
    solid, contact = stiffness(1), 0.1 * stiffness(2)
    if kind == "indefinite":
        solid = solid - 3.0 * np.eye(WIDTH)
    if kind == "friction":
        contact = np.random.default_rng(3).standard_normal(contact.shape)
    pattern = Pattern([DOFS, DOFS], free, SIZE)
    load = np.random.default_rng(4).standard_normal(SIZE)
    expected = np.linalg.solve(dense([solid, contact], free), load[free])
    for _ in range(2):
        answer = pattern.solve([solid, contact], load)
        assert answer[free] == pytest.approx(expected, rel=1e-8, abs=1e-8 * np.abs(expected).max())
        assert not answer[[0, 5]].any()


def test_a_narrow_symmetric_matrix_needs_no_sparse_factorisation(monkeypatch):
    monkeypatch.setattr(Pattern, "_sparse", None)
    Pattern([DOFS], np.arange(SIZE), SIZE).solve([stiffness(1)], np.ones(SIZE))
    monkeypatch.setattr(sparse, "WIDEST", -1)
    with pytest.raises(TypeError):
        Pattern([DOFS], np.arange(SIZE), SIZE).solve([stiffness(1)], np.ones(SIZE))


@pytest.mark.parametrize("kind", ["positive", "indefinite"])
def test_another_load_is_solved_with_the_matrices_of_before(kind):
    free = np.setdiff1d(np.arange(SIZE), [0, 5])
    solid = stiffness(1) - (3.0 * np.eye(WIDTH) if kind == "indefinite" else 0.0)
    pattern = Pattern([DOFS], free, SIZE)
    first, second = np.random.default_rng(4).standard_normal((2, SIZE))
    pattern.solve([solid], first)
    expected = np.linalg.solve(dense([solid], free), second[free])
    assert pattern.again(second)[free] == pytest.approx(expected, rel=1e-8, abs=1e-8 * np.abs(expected).max())
