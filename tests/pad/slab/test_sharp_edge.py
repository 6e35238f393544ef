"""The slab under a round punch, against the layer solution, limits, equilibrium and invariances."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.case import Case, first_stiffness, rimmed_problem
from dummydesign.pad.axisymmetric.sharp_edge import Samples, fit_limit, solve_curve, solve_path, solve_rims
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.tables.slab import load_table
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)
# kappa of the layer solution (Hayes et al. 1972), frictionless flat punch, recomputed from the integral equation.
LAYER = {
    0.5: {0.2: 1.281, 0.4: 1.684, 1.0: 3.619, 2.0: 9.149, 3.0: 18.157},
    0.45: {0.4: 1.599, 1.0: 3.091, 2.0: 6.421},
    0.3: {0.4: 1.473, 1.0: 2.484, 2.0: 4.353},
}


@pytest.mark.parametrize(
    ("poisson", "ratio", "kappa"), [(nu, a, k) for nu, row in LAYER.items() for a, k in row.items()]
)
def test_first_touch_agrees_with_the_layer_solution(poisson, ratio, kappa):
    """F = 2 a E d kappa / (1 - nu^2) on a bonded base, frictionless punch, to 0.1 %."""
    slab = Case(ratio, ratio + 12.0, "bonded", "frictionless", poisson=poisson)
    stiffness = first_stiffness(slab)  # in units of 3 mu a, and E = 2 mu (1 + nu)
    expected = 2.0 * kappa / (1.0 - poisson**2) * (2.0 * (1.0 + poisson)) / 3.0
    assert stiffness == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("ratio", "kappa"), [(0.2, 1.171), (0.4, 1.385), (1.0, 2.199)])
def test_first_touch_on_a_sliding_base_agrees_with_the_layer_solution(ratio, kappa):
    slab = Case(ratio, ratio + 40.0, "sliding", "frictionless")
    assert first_stiffness(slab) == pytest.approx(2.0 * kappa / 0.75, rel=2e-3)


def test_a_thick_pad_approaches_the_half_space():
    """2 a E d / (1 - nu^2) at a / h to 0; linear in a / h, so two thin punches extrapolate to it."""
    values = [first_stiffness(Case(a, 40.0, "bonded", "frictionless")) for a in (0.05, 0.1)]
    assert 2.0 * values[0] - values[1] == pytest.approx(2.0 / 0.75, rel=2e-2)
    assert values[0] == pytest.approx(2.0 / 0.75, rel=8e-2)


def test_a_thin_pad_approaches_the_confined_layer():
    """Lubrication limit of a bonded incompressible layer: F = (pi/2) mu a^4 d / h^3 * 3 for a / h to infinity.

    A glued punch on a glued base squeezes a parabolic flow: p = 3 mu d (a^2 - r^2) / h^3, so the force is
    (3 pi / 2) mu a^4 d / h^3. The edge adds a relative correction of order h / a.
    """
    found = []
    for ratio in (6.0, 12.0):
        slab = Case(ratio, ratio + 8.0)
        limit = 1.5 * np.pi * ratio**4  # mu = h = d = 1
        found.append(first_stiffness(slab) * 3.0 * ratio / limit)
    assert found[1] < found[0]
    assert 2.0 * found[1] - found[0] == pytest.approx(1.0, abs=0.06)


def test_small_strain_force_converges_with_the_mesh():
    slab = Case(1.0, 8.0, "bonded", "bonded")
    meshes = ((1, 2.0), (2, 1.5), (4, 1.22))
    values = [first_stiffness(slab, resolution=Resolution(cells, growth)) for cells, growth in meshes]
    steps = np.abs(np.diff(values))
    assert steps[1] < steps[0] / 2.5
    assert steps[1] / values[-1] < 2e-3


def test_a_glued_face_is_stiffer_than_a_frictionless_one_by_the_published_share():
    """No difference on a thick pad, growing as the pad gets thin."""
    shares = []
    for ratio in (0.4, 1.0, 2.0):
        pair = [first_stiffness(Case(ratio, ratio + 10.0, "bonded", face)) for face in ("bonded", "frictionless")]
        shares.append(pair[0] / pair[1] - 1.0)
    assert shares[0] == pytest.approx(0.005, abs=0.003)
    assert shares[1] == pytest.approx(0.10, abs=0.02)
    assert shares[2] == pytest.approx(0.39, abs=0.03)


def test_the_punch_pushes_as_hard_as_the_base_pushes_back():
    """Equilibrium: the reaction of the base equals what contact and driven nodes put in, at finite depth."""
    slab = Case(1.0, 6.0)
    problem = rimmed_problem(slab, 0.1, Resolution(cells=2))
    states = []
    problem.force = lambda state: states.append(state) or float(state.internal_force[problem.base].sum())
    path = follow(problem, [0.1, 0.2], 0.05, 0.05, 0.002)
    vertical = states[-1].internal_force[1::2]
    base = np.zeros(len(vertical), dtype=bool)
    base[problem.base // 2] = True
    assert path.force[-1] == pytest.approx(-vertical[~base].sum(), rel=1e-6)
    assert path.force[-1] > 0.0


def test_the_force_approaches_its_sharp_edge_limit_from_below_as_the_rim_shrinks():
    slab = Case(1.0, 8.0)
    forces = [solve_path(slab, np.array([0.2]), rim, Resolution()).force[0] for rim in (0.05, 0.025, 0.0125)]
    first, second = np.diff(forces)
    assert 0.0 < second < first
    assert second < first / 1.8


@pytest.mark.slow
def test_the_extrapolated_limit_foresees_what_finer_rims_give():
    """From rims 0.1 to 0.025 alone, the limit lies above a rim of 0.00625 by that rim's share, to the stated error."""
    slab = Case(1.0, 9.58)
    depths = np.array([0.14, 0.18, 0.22, 0.26, 0.3])
    coarse, _ = solve_rims(slab, depths, (0.1, 0.05, 0.025), Resolution())
    first = np.array([first_stiffness(slab)])
    limit = fit_limit(coarse, np.array([1.0]), first, (0.0, 0.3), None, (4, 1))
    fine, _ = solve_rims(slab, depths[:4], (0.00625,), Resolution())
    above = np.exp(limit.log_stiffness(fine.depth, 1.0)) / fine.stiffness - 1.0
    own_share = 0.65 * fine.psi
    assert np.all(above > 0.0)
    assert np.all(above < own_share + limit.error(fine.depth, 1.0))


def test_the_limit_of_made_up_values_is_recovered_with_outliers_among_them():
    """Values made by a law with another exponent than the regression assumes, a tenth of them off by 2 %."""
    rng = np.random.default_rng(5)
    depth, rim = (grid.ravel() for grid in np.meshgrid(np.linspace(0.05, 0.5, 20), 0.1 * 0.5 ** np.arange(6)))
    keep = depth >= 0.8 * np.sqrt(rim)
    depth, rim = depth[keep], rim[keep]
    sharp = 10.0 * np.exp(0.9 * depth + 0.3 * depth**2)
    value = sharp * (1.0 - 0.6 * rim**1.15 * depth**-0.5) * (1.0 + 1e-4 * rng.standard_normal(len(depth)))
    value[rng.random(len(depth)) < 0.1] *= 1.02
    samples = Samples(depth, np.ones(len(depth)), rim, value)
    limit = fit_limit(samples, np.array([1.0]), np.array([10.0]), (0.0, 0.5), None, (6, 1))
    at = np.linspace(0.0, 0.5, 11)
    assert np.exp(limit.log_stiffness(at, 1.0)) == pytest.approx(10.0 * np.exp(0.9 * at + 0.3 * at**2), rel=4e-3)


@pytest.fixture(scope="module")
def curve():
    return solve_curve(Pad(10.0, 0.025, 7.9), [0.5, 1.0, 2.0, 3.0])


@pytest.mark.slow
def test_the_force_is_the_same_in_metres_and_pascals(curve):
    si = solve_curve(Pad(0.01, 0.025e6, 0.0079, extent_mm=0.0756940), [0.0005, 0.001, 0.002, 0.003])
    assert si.force_N == pytest.approx(curve.force_N, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("depths", [[0.1, 0.3], [0.02], [0.6]])
def test_a_curve_to_a_small_depth_agrees_with_the_table_and_lies_above_first_touch(depths):
    """Few beads are of use there: the curve is solved further than it was asked."""
    from dummydesign.pad.tables.slab import load_table

    found = solve_curve(Pad(10.0, 0.03, 10.0), depths)
    table = load_table()
    stated = found.solved_error_N / found.force_N + table.solved_error(found.depth_mm, 10.0, 10.0)
    expected = table.force(found.depth_mm, 10.0, 0.03, 10.0)
    assert np.all(np.abs(found.force_N / expected - 1.0) < stated)
    assert np.all(found.force_N > 0.999 * 0.3 * found.depth_mm * first_stiffness(Case(1.0, 7.569)))


@pytest.mark.slow
def test_the_curve_stiffens_and_its_stated_error_is_small(curve):
    assert np.all(np.diff(curve.force_N / curve.depth_mm) > 0.0)
    assert np.all(curve.error_N / curve.force_N < 0.01)
    assert curve.solver["newton_iterations"] > 0


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"depth_mm": [7.0]}, "out_of_range"),
        ({"depth_mm": [-1.0]}, "out_of_range"),
        ({"thickness_mm": 0.0}, "out_of_range"),
        ({"young_MPa": float("nan")}, "out_of_range"),
        ({"base": "glued"}, "unknown_name"),
        ({"radius_mm": 60.0}, "out_of_range"),
        ({"poisson": 0.7}, "out_of_range"),
    ],
)
def test_bad_input_is_refused_with_the_allowed_range(change, code):
    values = {"thickness_mm": 10.0, "radius_mm": 7.9, "young_MPa": 0.025, "depth_mm": [1.0], **change}
    with raises_code(code):
        depth = values.pop("depth_mm")
        solve_curve(Pad(**values), depth)


@pytest.mark.parametrize(
    ("thickness_mm", "deepest"),
    [(10.0, 0.1), *(pytest.param(*case, marks=pytest.mark.slow) for case in ((5.0, 0.1), (10.0, 0.5)))],
)
def test_a_curve_at_small_depths_does_not_depend_on_how_deep_it_goes(thickness_mm, deepest):
    """Against the table, whose own regression runs over many slabs; losing the smallest bead puts 2 % here."""
    depth = np.array([0.025, 0.05, deepest]) * thickness_mm
    curve = solve_curve(Pad(thickness_mm, 0.025, 7.9), depth.tolist())
    table = load_table().force(depth[:2], thickness_mm, 0.025, 7.9)
    assert curve.force_N[:2] == pytest.approx(table, rel=3e-3)


@pytest.mark.slow
def test_a_thin_pad_is_followed_to_half_its_thickness_and_what_carries_the_path_on_leaves_the_rest():
    # The corner cell under the largest fillet inverts at d/h 0.43, whatever the load steps; smaller cells go on.
    depth = 7.9 / 2.7 * np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    whole = solve_curve(Pad(7.9 / 2.7, 1.0, 7.9), depth)
    assert whole.notes == () and len(whole.force_N) == 5
    short = solve_curve(Pad(7.9 / 2.7, 1.0, 7.9), depth[:3])
    assert whole.force_N[:3] == pytest.approx(short.force_N, rel=2e-3)
    # Force over depth goes on rising as it did: an end of another mesh would show as a jump.
    rise = np.diff(np.log(whole.force_N / depth))
    assert np.all(np.abs(np.diff(rise)) < 0.02)
