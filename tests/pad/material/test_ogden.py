"""Ogden's law: derivatives, objectivity, limits to neo-Hookean and Mooney-Rivlin, uniaxial closed form."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.pad.axisymmetric.puck import UnitPuck, puck_problem
from dummydesign.pad.material.hyperelastic import Axisymmetric, Ogden, Spatial, Yeoh, read_law
from dummydesign.pad.solve.continuation import follow
from tests.support.energies import energy
from tests.support.refusal import raises_code

LAWS = [
    Ogden([0.7], [2.0]),
    Ogden([0.3], [6.5]),
    Ogden([0.4, -0.2], [3.1, -2.0]),
    Ogden([0.2, 0.1, -0.3], [1.3, 5.0, -1.7]),
]


def random_F(components, spread=0.25, count=40, seed=1):
    rng = np.random.default_rng(seed)
    kinematics = Axisymmetric if components == 5 else Spatial
    F = kinematics.identity + spread * rng.standard_normal((count, components))
    return F[kinematics.determinant(F) > 0.2]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("components", [5, 9])
def test_stress_and_tangent_are_the_derivatives_of_the_energy(law, components):
    F, step = random_F(components), 1e-6
    scale = np.abs(law.tangent(F)).max(axis=(1, 2))
    for k in range(components):
        up, down = F.copy(), F.copy()
        up[:, k] += step
        down[:, k] -= step
        slope = (energy(law, up) - energy(law, down)) / (2 * step)
        assert np.all(np.abs(law.stress(F)[:, k] - slope) < 1e-8 * scale)
        numeric = (law.stress(up) - law.stress(down)) / (2 * step)
        assert np.all(np.abs(law.tangent(F)[:, :, k] - numeric) < 1e-7 * scale[:, None])


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("components", [5, 9])
@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-9, 1e-5])
def test_the_tangent_holds_where_stretches_are_equal_or_nearly_so(law, components, gap):
    """F = 1, uniform dilation, and stretches that differ by less than rounding; where naive formulas fail."""
    identity = (Axisymmetric if components == 5 else Spatial).identity
    F = identity * 1.2
    F[0] += gap
    numeric = np.empty((components, components))
    step = 1e-6
    for k in range(components):
        move = np.zeros(components)
        move[k] = step
        numeric[:, k] = (law.stress(F + move) - law.stress(F - move)) / (2 * step)
    tangent = law.tangent(F)
    assert tangent == pytest.approx(numeric, abs=1e-7 * np.abs(tangent).max())
    assert np.array_equal(np.isfinite(tangent), np.ones_like(tangent, dtype=bool))


@pytest.mark.parametrize("law", LAWS)
def test_energy_and_stress_turn_with_a_rotation(law):
    rng = np.random.default_rng(2)
    F = random_F(9).reshape(-1, 3, 3)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    turned = (turn @ F).reshape(-1, 9)
    assert energy(law, turned) == pytest.approx(energy(law, F.reshape(-1, 9)), rel=1e-10, abs=1e-12)
    assert law.stress(turned) == pytest.approx((turn @ law.stress(F.reshape(-1, 9)).reshape(-1, 3, 3)).reshape(-1, 9))


@pytest.mark.parametrize("components", [5, 9])
def test_an_exponent_of_two_is_the_neo_hookean_solid(components):
    F = random_F(components)
    ogden, plain = Ogden([0.7], [2.0]), Yeoh(0.7)
    assert energy(ogden, F) == pytest.approx(energy(plain, F), rel=1e-11, abs=1e-12)
    for name in ("stress", "tangent"):
        assert getattr(ogden, name)(F) == pytest.approx(getattr(plain, name)(F), rel=1e-11, abs=1e-12)
    assert ogden.shear_MPa == plain.shear_MPa
    assert ogden.reference_stress_MPa == plain.reference_stress_MPa


def test_exponents_of_two_and_minus_two_are_mooney_and_rivlins_solid():
    """W = C1 (I1 - 3) + C2 (I2 - 3) when J = 1, with mu1 = 2 C1 and mu2 = -2 C2."""
    F = random_F(9)
    F = F / np.cbrt(Spatial.determinant(F))[:, None]
    C = np.swapaxes(F.reshape(-1, 3, 3), 1, 2) @ F.reshape(-1, 3, 3)
    first = np.trace(C, axis1=1, axis2=2)
    second = 0.5 * (first**2 - np.trace(C @ C, axis1=1, axis2=2))
    expected = 0.3 * (first - 3.0) + 0.1 * (second - 3.0)
    assert energy(Ogden([0.6, -0.2], [2.0, -2.0]), F) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_axisymmetric_components_are_the_spatial_ones_without_shear_out_of_the_plane(law):
    F5 = random_F(5)
    F5[:, 4] = np.abs(F5[:, 4]) + 0.1
    F9 = np.zeros((len(F5), 9))
    places = [0, 2, 6, 8, 4]
    F9[:, places] = F5
    assert energy(law, F5) == pytest.approx(energy(law, F9), rel=1e-10, abs=1e-12)
    assert law.stress(F5) == pytest.approx(law.stress(F9)[:, places], rel=1e-8, abs=1e-9)
    assert law.tangent(F5) == pytest.approx(law.tangent(F9)[:, places][:, :, places], rel=1e-7, abs=1e-8)


@pytest.mark.parametrize("law", LAWS)
def test_a_cylinder_between_sliding_plates_follows_the_uniaxial_closed_form(law):
    """Nominal stress sum mu (l^(-alpha/2 - 1) - l^(alpha - 1)), force on the undeformed area."""
    compression = np.array([0.1, 0.3, 0.5])
    path = follow(puck_problem(UnitPuck(1.3, "frictionless"), law), compression / 2, 0.05, 0.05, 0.005)
    stretch = 1.0 - compression
    stress = sum(m * (stretch ** (-a / 2 - 1) - stretch ** (a - 1)) for m, a in zip(law.mu_MPa, law.alpha))
    assert path.stop is None
    assert path.force == pytest.approx(np.pi * 1.3**2 * stress, rel=3e-5)


def test_laws_are_read_from_the_words_of_the_command_line():
    assert read_law("neo-hookean") == Yeoh(1.0)
    assert read_law("yeoh:0.2").c2_MPa == 0.2
    law = read_law("ogden:0.4,3;-0.2,-2")
    assert law == Ogden([0.4, -0.2], [3.0, -2.0])


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("ogden:1", "malformed"),
        ("ogden:1,2;3", "malformed"),
        ("ogden:1,x", "malformed"),
        ("ogden:1,-2", "out_of_range"),
        ("ogden:1,0", "out_of_range"),
        ("ogden:1,2;1,2;1,2;1,2", "malformed"),
        ("yeoh", "malformed"),
        ("yeoh:-1", "out_of_range"),
        ("rubber", "unknown_name"),
    ],
)
def test_laws_that_cannot_be_are_refused(text, code):
    with raises_code(code):
        read_law(text)


def test_the_convention_of_abaqus_is_the_same_energy_as_its_closed_form():
    rng = np.random.default_rng(20261128)
    for _ in range(20):
        count = int(rng.integers(1, 4))
        mu, alpha = rng.uniform(0.01, 0.5, count), rng.uniform(0.8, 9.0, count) * rng.choice([-1.0, 1.0], count)
        law = read_law("ogden-abaqus:" + ";".join(f"{m!r},{a!r}" for m, a in zip(mu.tolist(), alpha.tolist())))
        assert law.shear_MPa == pytest.approx(mu.sum())
        stretch = rng.uniform(0.5, 1.8)
        # uniaxial stress of Abaqus' form: sum 2 mu / alpha (l^(alpha-1) - l^(-alpha/2-1))
        expected = sum(2 * m / a * (stretch ** (a - 1) - stretch ** (-a / 2 - 1)) for m, a in zip(mu, alpha))
        side = stretch**-0.5
        along, across = (law.stress(np.diag([stretch, side, side]).reshape(1, 9))[0, at] for at in (0, 4))
        assert along - across * side / stretch == pytest.approx(expected)


def test_terms_in_the_other_convention_are_asked_about_and_none_that_make_the_modulus():
    rng, right = np.random.default_rng(20261129), 0
    for number in range(60):
        count, size = int(rng.integers(1, 4)), (1.0, 1e3)[number % 2]
        mu, alpha = rng.uniform(0.01, 0.1, count), rng.uniform(2.2, 9.0, count)
        typed = "ogden:" + ";".join(f"{size * m:.6g},{a:.4g}" for m, a in zip(mu, alpha))
        with raises_code("inconsistent"):
            read_law(typed, 3.0 * mu.sum())
        right += read_law(typed, 1.5 * float(mu @ alpha)).shear_MPa > 0.0
        assert read_law(typed.replace("ogden", "ogden-abaqus"), 3.0 * mu.sum()).shear_MPa == pytest.approx(
            size * mu.sum(), rel=1e-4
        )
    assert right == 60 and read_law("ogden:0.03,2", 0.09).shear_MPa == pytest.approx(0.03)


def test_a_negative_alpha_names_the_other_convention():
    with pytest.raises(InputError, match="ogden-abaqus"):
        read_law("ogden:0.4095,1.3;0.003,5;0.01,-2")
