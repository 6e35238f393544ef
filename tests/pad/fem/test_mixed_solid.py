"""The mixed solid: tangents, objectivity, homogeneous closed forms, patch test, convergence of Newton's method."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.fem.mixed_solid import Solid, lame_ratio
from dummydesign.pad.material.hyperelastic import Axisymmetric, Spatial, Yeoh
from dummydesign.pad.solve import equilibrium
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import ContactProblem
from tests.support.energies import energy
from tests.support.refusal import raises_code

LAWS = [Yeoh(0.7), Yeoh(0.7, 0.2)]


def cylinder(law, radius=1.3, held_ends=False, poisson=0.5, resolution=None, slabs=4):
    """A cylinder of unit height between rigid plates: sliding ends, or bonded ones."""
    resolution = resolution or Resolution()
    r = np.unique(np.concatenate([np.linspace(0, radius, 5), radius - radius * 0.5 ** np.arange(1, 7)]))
    z = np.linspace(-1.0, 0.0, 2 * slabs + 1)
    if held_ends:
        z = np.unique(np.concatenate([z, -(0.5 ** np.arange(1, 7)), 0.5 ** np.arange(1, 7) - 1.0]))
    number = np.arange(len(r) * len(z)).reshape(len(r), len(z))
    points = np.array([(x, y) for x in r for y in z]).T
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]).reshape(4, -1)
    mesh = meshes.discretise(points, quads)
    top, base = (np.nonzero(on)[0] for on in (meshes.on_top(mesh), meshes.on_base(mesh, 1.0)))
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    held[2 * base + 1] = True
    if held_ends:
        held[2 * base] = held[2 * top] = True
    return ContactProblem(Solid(mesh, law, poisson), held, 2 * top + 1, 2 * base + 1)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("components", [5, 9])
def test_stress_and_tangent_are_the_derivatives_of_the_energy(law, components):
    rng = np.random.default_rng(1)
    F = (Axisymmetric if components == 5 else Spatial).identity + 0.3 * rng.standard_normal((4, components))
    step = 1e-6
    for k in range(components):
        up, down = F.copy(), F.copy()
        up[:, k] += step
        down[:, k] -= step
        slope = (energy(law, up) - energy(law, down)) / (2 * step)
        assert law.stress(F)[:, k] == pytest.approx(slope, rel=1e-7, abs=1e-8)
        numeric = (law.stress(up) - law.stress(down)) / (2 * step)
        assert law.tangent(F)[:, :, k] == pytest.approx(numeric, rel=1e-7, abs=1e-8)


@pytest.mark.parametrize("law", LAWS)
def test_energy_does_not_see_a_rotation(law):
    rng = np.random.default_rng(2)
    F = np.eye(3) + 0.4 * rng.standard_normal((5, 3, 3))
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    assert energy(law, (turn @ F).reshape(5, 9)) == pytest.approx(energy(law, F.reshape(5, 9)), rel=1e-12)


@pytest.mark.parametrize("kinematics", [Axisymmetric, Spatial])
def test_cofactor_and_second_derivative_are_those_of_the_determinant(kinematics):
    rng = np.random.default_rng(3)
    components = len(kinematics.identity)
    F = kinematics.identity + 0.3 * rng.standard_normal((3, components))
    second = np.zeros((3, components, components))
    kinematics.add_second(second, np.ones(3), F)
    step = 1e-6
    for k in range(components):
        up, down = F.copy(), F.copy()
        up[:, k] += step
        down[:, k] -= step
        slope = (kinematics.determinant(up) - kinematics.determinant(down)) / (2 * step)
        assert kinematics.cofactor(F)[:, k] == pytest.approx(slope, abs=1e-9)
        numeric = (kinematics.cofactor(up) - kinematics.cofactor(down)) / (2 * step)
        assert second[:, :, k] == pytest.approx(numeric, abs=1e-9)


@pytest.mark.parametrize("law", [Yeoh(1.0), Yeoh(1.0, 0.3)])
@pytest.mark.parametrize("poisson", [0.45, 0.5])
def test_assembled_tangent_is_the_derivative_of_the_residual(law, poisson):
    """The condensed tangent against central differences of the condensed residual; neo-Hookean has its own way."""
    problem = cylinder(law, poisson=poisson, slabs=1)
    solid = problem.solid
    r, z = solid.mesh.nodes
    u = np.stack([0.1 * r * (1 + z) - 0.05 * r**3, 0.08 * z - 0.1 * r**2 * z], axis=1).ravel()
    direction = np.stack([r * np.cos(3 * z), np.sin(2 * r) * z + r**2], axis=1).ravel()
    _, p = problem.start()

    def residual(at):
        # pressure that satisfies its own equation at this displacement
        state = solid.state(at, p)
        pressure = p - np.einsum("eab,eb->ea", solid.inverse, state.pressure_residual)
        return solid.state(at, pressure).internal_force, pressure

    step = 1e-6
    numeric = (residual(u + step * direction)[0] - residual(u - step * direction)[0]) / (2 * step)
    state = solid.state(u, residual(u)[1])
    local = (solid.linearise(state).stiffness @ direction[solid.mesh.dofs][:, :, None])[:, :, 0]
    exact = np.bincount(solid.mesh.dofs.ravel(), local.ravel(), minlength=solid.mesh.size)
    assert exact == pytest.approx(numeric, rel=1e-5, abs=1e-5 * np.abs(exact).max())


@pytest.mark.parametrize("law", LAWS)
def test_assembled_tangent_in_space_is_the_derivative_of_the_residual(law):
    """On two skewed cells; a neo-Hookean law has a way of its own."""
    x, y, z = np.array([0.0, 0.4, 1.0]), np.array([0.0, 0.7]), np.array([-1.0, 0.0])
    mesh = space.discretise(
        space.extrude(*space.rectangle_plan(x, y), z), lambda at: at + 0.1 * at[[1, 2, 0]] * at[[2, 0, 1]]
    )
    solid, rng = Solid(mesh, law), np.random.default_rng(5)
    u, p = 0.02 * rng.standard_normal(mesh.size), rng.standard_normal((2, 4))
    du, step, tangent = rng.standard_normal(mesh.size), 1e-6, solid.linearise(solid.state(u, p))
    local = du[mesh.dofs][:, :, None]
    dilation = np.einsum("eqc,eqcd->eqd", mesh.kinematics.cofactor(solid.deformation(u)), mesh.gradient)
    coupling = np.einsum("eqd,eq,qp->edp", dilation, mesh.weight, mesh.pressure_basis)
    assert tangent.coupling == pytest.approx(coupling, rel=1e-12)
    # The tangent is condensed: what the pressure adds to it is taken off again.
    alone = tangent.stiffness + coupling @ solid.inverse @ coupling.transpose(0, 2, 1)
    expected = np.bincount(mesh.dofs.ravel(), (alone @ local).ravel(), minlength=mesh.size)
    high, low = (solid.state(u + s * du, p).internal_force for s in (step, -step))
    assert (high - low) / (2.0 * step) == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("law", LAWS)
def test_patch_a_cylinder_between_sliding_plates_is_compressed_uniformly(law):
    """Uniaxial closed form: nominal stress = (mu + 4 c2 (I1 - 3)) (1/l^2 - l) at stretch l."""
    problem = cylinder(law)
    depths = np.array([0.1, 0.3, 0.5])
    path = follow(problem, depths, 0.1, 0.1, 0.01)
    stretch = 1.0 - depths
    excess = stretch**2 + 2.0 / stretch - 3.0
    stress = (law.shear_MPa + 4.0 * law.c2_MPa * excess) * (1.0 / stretch**2 - stretch)
    # The bulk is 1e6 times stiffer than the shear, not infinite: the volume gives way by stress / (1e6 mu).
    assert path.force == pytest.approx(np.pi * 1.3**2 * stress, rel=2e-5)
    assert path.smallest_J == pytest.approx(1.0, abs=2e-5)


@pytest.mark.parametrize("poisson", [0.3, 0.45])
def test_a_compressible_cylinder_between_sliding_plates_has_the_modulus_of_its_poisson_ratio(poisson):
    problem = cylinder(Yeoh(1.0), poisson=poisson)
    assert problem.stiffness() == pytest.approx(2.0 * (1.0 + poisson) * np.pi * 1.3**2, rel=1e-9)


@pytest.mark.parametrize(
    ("shape_factor", "apparent"), [(0.1, 1.070), (0.25, 1.196), (0.417, 1.404), (1.0, 2.956), (2.0, 8.76)]
)
def test_bonded_pucks_have_the_published_apparent_modulus(shape_factor, apparent):
    """E_app / E of incompressible discs between bonded plates; shape factor = diameter / (4 height)."""
    radius = 2.0 * shape_factor
    problem = cylinder(Yeoh(1.0), radius=radius, held_ends=True)
    assert problem.stiffness() / (3.0 * np.pi * radius**2) == pytest.approx(apparent, rel=2e-3)


def test_newtons_method_with_a_new_tangent_each_time_converges_quadratically(monkeypatch):
    monkeypatch.setattr(equilibrium, "REUSE_BELOW", 0.0)
    residuals = []

    def visit(depth, solution):
        residuals.extend(solution.residuals)

    path = follow(cylinder(Yeoh(1.0, 0.2), held_ends=True, slabs=2), [0.2], 0.2, 0.2, 0.05, visit=visit)
    last = [r for r in residuals if r > 1e-13]
    orders = [np.log(c) / np.log(b) for b, c in zip(last[-2:-1], last[-1:])]
    assert path.stop is None
    assert max(orders) > 1.7


def test_a_path_that_cannot_go_on_says_where_and_why():
    """A pad compressed to nearly nothing must stop with a reason, never with a silent wrong curve."""
    path = follow(cylinder(Yeoh(1.0), held_ends=True), [0.05, 0.95], 0.05, 0.1, 0.01)
    assert len(path.depth) == 1
    assert "stopped at relative depth" in path.stop
    assert "worst element" in path.stop


@pytest.mark.parametrize("poisson", [0.0, -0.2, 0.6, float("nan")])
def test_poisson_ratios_outside_the_range_are_refused(poisson):
    with raises_code("out_of_range", "poisson"):
        lame_ratio(poisson)


@pytest.mark.parametrize("moduli", [(0.0, 0.0), (-1.0, 0.0), (1.0, -0.1)])
def test_laws_without_a_stable_solid_are_refused(moduli):
    with pytest.raises(InputError):
        Yeoh(*moduli)
