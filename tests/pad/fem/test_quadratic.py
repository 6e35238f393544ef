"""Biquadratic quadrilaterals against those of scikit-fem, which they are numbered like."""

import subprocess
import sys

import numpy as np
import pytest

from dummydesign.pad.fem import mesh_axisymmetric as quadratic

POINTS = np.array([[0.0, 1.0, 2.1, 0.1, 1.0, 2.0, 0.0, 1.2, 2.2], [0.0, 0.1, 0.0, 1.0, 1.1, 0.9, 2.0, 2.2, 2.0]])
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]).T


def bent(places):
    """A map with curved sides."""
    return places + 0.05 * np.sin(2.0 * places[::-1])


def test_nodes_slopes_and_areas_are_those_of_scikit_fem():
    from skfem import Basis, ElementQuad2, MeshQuad, MeshQuad2

    flat = MeshQuad2.from_mesh(MeshQuad(POINTS, np.ascontiguousarray(QUADS), validate=False))
    basis = Basis(MeshQuad2(bent(flat.doflocs), flat.t, validate=False), ElementQuad2(), intorder=4)
    places, node = quadratic.nine_nodes(POINTS, QUADS)
    assert (node == basis.element_dofs.T).all()
    found = quadratic.integrate(bent(places), node)
    assert bent(places) == pytest.approx(basis.doflocs, abs=1e-14)
    assert pytest.approx(basis.X, abs=1e-15) == quadratic.POINTS
    assert found.area == pytest.approx(basis.dx, rel=1e-13)
    assert found.position == pytest.approx(np.asarray(basis.global_coordinates()), abs=1e-13)
    for i in range(9):
        assert found.slope[..., i] == pytest.approx(basis.basis[i][0].grad.transpose(1, 2, 0), abs=1e-12)
        assert found.value[:, i] == pytest.approx(np.asarray(basis.basis[i][0])[0], abs=1e-14)


@pytest.mark.slow
def test_sections_are_meshed_without_scikit_fem():
    code = (
        "import sys, numpy as np; from dummydesign.pad.axisymmetric.sharp_edge import solve_curve; "
        "from dummydesign.pad.pad_under_punch import Pad; "
        "solve_curve(Pad(10.0, 1.0, 7.9), np.array([0.1])); print('skfem' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
