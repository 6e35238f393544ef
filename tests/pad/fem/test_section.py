"""Elements of a section by products with constant matrices: what they give is what the nodes' slopes give."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_problem import shaped_problem
from dummydesign.pad.fem.mixed_solid import SectionElements


@pytest.fixture(scope="module")
def solid():
    return shaped_problem(Case(0.79, 6.0, shape=Crowned(10.0, 2.0), thickness_mm=10.0), cells=4).solid


def test_slopes_and_forces_are_those_of_the_gradient(solid):
    mesh, rng = solid.mesh, np.random.default_rng(3)
    section = SectionElements(mesh, solid.inverse, 1.0)
    u = 1e-3 * rng.standard_normal(mesh.size)
    F = np.einsum("eqcd,ed->eqc", mesh.gradient, u[mesh.dofs]) + mesh.kinematics.identity
    assert section.deformation(u) == pytest.approx(F, abs=1e-12)
    stress = rng.standard_normal(F.shape)
    local = np.einsum("eqcd,eqc->ed", mesh.gradient, stress)
    whole = np.bincount(mesh.dofs.ravel(), local.ravel(), minlength=mesh.size)
    assert section.forces(stress) == pytest.approx(whole, abs=1e-10 * np.abs(whole).max())


def test_the_tangent_is_that_of_all_components(solid):
    """By the moduli of each point and the element's own slopes, pressures eliminated."""
    mesh, rng = solid.mesh, np.random.default_rng(4)
    state = solid.state(1e-4 * rng.standard_normal(mesh.size), rng.standard_normal((len(mesh.weight), 3)))
    F, cofactor, slope = state.at
    moduli = np.broadcast_to(solid.law.shear_MPa * np.eye(5), (*F.shape, 5)) * mesh.weight[..., None, None]
    moduli = np.ascontiguousarray(moduli)
    mesh.kinematics.add_second(moduli, slope * mesh.weight, F)
    curvature = (solid.law.reference_stress_MPa / state.J**2 + solid.stabilisation) * mesh.weight
    moduli += curvature[..., None, None] * cofactor[..., :, None] * cofactor[..., None, :]
    whole = np.einsum("eqcd,eqck,eqkf->edf", mesh.gradient, moduli, mesh.gradient, optimize=True)
    dilation = np.einsum("eqc,eqcd->eqd", cofactor, mesh.gradient)
    coupling = np.einsum("eqd,eq,qm->edm", dilation, mesh.weight, mesh.pressure_basis)
    tangent = solid.linearise(state)
    assert tangent.coupling == pytest.approx(coupling, abs=1e-12 * np.abs(coupling).max())
    whole -= coupling @ solid.inverse @ coupling.transpose(0, 2, 1)
    assert np.abs(tangent.stiffness - whole).max() < 1e-12 * np.abs(whole).max()
