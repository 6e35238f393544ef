import numpy as np
import pytest

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.case import Case, rimmed_problem
from dummydesign.pad.axisymmetric.shaped_problem import shaped_problem
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.solve import equilibrium, sparse
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.sparse import BandLayout, Pattern, symmetric
from tests.support.residuals import added_up, backward_error, rounding


def test_a_band_solves_what_a_dense_matrix_solves_whatever_its_numbering():
    rng = np.random.default_rng(4)
    n = 60
    near = np.where(np.abs(np.subtract.outer(np.arange(n), np.arange(n))) < 4, rng.normal(size=(n, n)), 0.0)
    matrix = near @ near.T + np.eye(n)
    mixed = rng.permutation(n)
    matrix, load = matrix[mixed][:, mixed], rng.normal(size=n)
    row, column = np.nonzero(matrix)
    band = BandLayout(row, column, n)
    assert band.width < 14
    assert band.factorise([matrix[row, column]])(load) == pytest.approx(np.linalg.solve(matrix, load), rel=1e-9)


def test_a_grid_is_numbered_along_its_columns_where_that_is_narrower():
    press = Case(0.79, 6.0, shape=Crowned(10.0, 2.0), thickness_mm=10.0)
    problem = shaped_problem(press)
    mesh, free = problem.solid.mesh, problem.pattern.free
    groups = [mesh.dofs, problem.surface.dofs]
    levels, columns = (Pattern(groups, free, mesh.size, *nodes)._band for nodes in ([], [mesh.nodes]))
    assert columns.width < 0.6 * levels.width
    load = np.random.default_rng(2).standard_normal(mesh.size)
    tangent = problem.solid.linearise(problem.solid.state(*problem.start()))
    matrices = [tangent.stiffness, *problem.pressed(0.0 * load, 0.0)[1]()]
    whole = added_up(groups, matrices, mesh.size)
    for nodes in ([], [mesh.nodes]):
        answer = Pattern(groups, free, mesh.size, *nodes).solve(matrices, load)
        assert backward_error(whole, free, answer, load) < rounding(free)


def test_a_band_goes_on_from_the_first_column_that_changed_as_if_it_began_anew():
    rng, n = np.random.default_rng(6), 90
    near = np.where(np.abs(np.subtract.outer(np.arange(n), np.arange(n))) < 4, rng.normal(size=(n, n)), 0.0)
    whole, load = near @ near.T + np.eye(n), rng.normal(size=n)
    row, column = np.nonzero(whole)
    dofs = np.arange(70, 76)
    rows, columns = (np.concatenate([at, more.ravel()]) for at, more in zip((row, column), np.meshgrid(dofs, dofs)))
    band = BandLayout(rows, columns, n, late=dofs)
    solid, before = whole[row, column], -1
    for stiffness in (np.zeros((6, 6)), 3.0 * np.eye(6), np.diag([0.0, 0.0, 9.0, 9.0, 0.0, 0.0])):
        matrix = whole.copy()
        matrix[np.ix_(dofs, dofs)] += stiffness
        if before >= 0:
            kept = band._factor[:before].copy()
        answer = band.factorise([solid, stiffness])(load)
        assert answer == pytest.approx(np.linalg.solve(matrix, load), rel=1e-9)
        if before >= 0:
            assert np.array_equal(kept, band._factor[:before])
        before = 30 * (band.width + 1)


def test_a_band_says_when_a_matrix_is_not_positive_definite():
    row = np.arange(3)
    assert BandLayout(row, row, 3).factorise([np.array([1.0, -1.0, 2.0])]) is None


def test_matrices_of_friction_are_seen_not_to_be_symmetric():
    even = np.array([[[1.0, 2.0], [2.0, 1.0]]])
    assert symmetric([even]) and not symmetric([even, even + np.array([[0.0, 1e-6], [0.0, 0.0]])])


def _follow(depths):
    problem = rimmed_problem(Case(0.79, 7.5), 0.1, Resolution(cells=2))
    return follow(problem, depths, 0.05, 0.05, 0.005)


def test_a_tangent_used_again_changes_no_force_and_saves_factorisations(monkeypatch):
    depths = np.linspace(0.0, 0.3, 7)[1:]
    again = _follow(depths)
    monkeypatch.setattr(equilibrium, "REUSE_BELOW", 0.0)
    always = _follow(depths)
    assert again.force == pytest.approx(always.force, rel=2e-5)
    assert again.newton_iterations < 0.9 * always.newton_iterations


def test_the_band_and_the_sparse_factorisation_give_one_force(monkeypatch):
    depths = np.array([0.05, 0.1])
    band = _follow(depths)
    monkeypatch.setattr(sparse, "WIDEST", -1)
    assert _follow(depths).force == pytest.approx(band.force, rel=1e-6)
