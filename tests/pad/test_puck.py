"""Pucks between plates: closed forms, published apparent moduli, limits of friction, contact of the side."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.axisymmetric.puck import UnitPuck, compress, puck_problem, solve_puck
from dummydesign.pad.material.hyperelastic import Ogden, Yeoh
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.predict import predict_motion, predict_static
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)
RADIUS = 25.0 / 30.0
AREA = np.pi * RADIUS**2


@pytest.mark.parametrize(
    ("shape_factor", "apparent"), [(0.1, 1.070), (0.25, 1.196), (0.417, 1.404), (1.0, 2.956), (2.0, 8.76)]
)
def test_bonded_pucks_have_the_published_apparent_modulus(shape_factor, apparent):
    """E_app / E of incompressible discs between bonded plates; shape factor = diameter / (4 height)."""
    radius = 2.0 * shape_factor
    problem = puck_problem(UnitPuck(radius, "bonded"), LAW, corner=0.004 * min(radius, 1.0))
    # The plate's depth is half of the compression.
    assert problem.stiffness() / 2.0 / (3.0 * np.pi * radius**2) == pytest.approx(apparent, rel=2e-3)


def test_plates_without_friction_give_the_uniaxial_closed_form_to_60_percent():
    compression = np.array([1.0, 6.0, 12.0, 18.0])
    curve = solve_puck(Puck(30.0, 0.03, 50.0, law=Yeoh(1.0, 0.1)), compression)
    stretch = 1.0 - compression / 30.0
    stress = 0.01 * (1.0 + 0.4 * (stretch**2 + 2 / stretch - 3)) * (1 / stretch**2 - stretch)
    assert curve.force_N == pytest.approx(np.pi * 625.0 * stress, rel=5e-5)
    assert curve.notes == ()


@pytest.fixture(scope="module")
def bonded():
    return compress(UnitPuck(RADIUS, "bonded"), LAW, np.array([0.1, 0.3, 0.45]))


def test_friction_to_zero_and_to_infinity_are_the_frictionless_and_the_bonded_puck(bonded):
    compression = np.array([0.1, 0.3])
    little, less, much = (
        compress(UnitPuck(RADIUS, f"friction:{mu}"), LAW, compression, corner=0.02).force for mu in (0.02, 0.01, 2.0)
    )
    stretch = 1.0 - compression
    free = AREA * (1.0 / stretch**2 - stretch)
    assert np.all(little > less)
    # Small friction adds in proportion to itself; friction power on a disc: mu 2 R / (3 h) of the mean pressure.
    assert (little - free) / (less - free) == pytest.approx(2.0, abs=0.05)
    slab = 2.0 * 0.01 * RADIUS * stretch**-1.5 / 3.0
    assert less / free - 1.0 == pytest.approx(slab, rel=0.12)
    assert much == pytest.approx(bonded.force[:2], rel=5e-3)


@pytest.mark.slow
def test_friction_raises_the_force(bonded):
    compression = np.array([0.1, 0.3, 0.45])
    middle = compress(UnitPuck(RADIUS, "friction:0.3"), LAW, compression, corner=0.02)
    stretch = 1.0 - compression
    assert np.all(middle.force > 1.1 * AREA * (1.0 / stretch**2 - stretch))
    assert np.all(middle.force < bonded.force * 1.001)


def test_the_side_that_comes_to_lie_on_the_plates_carries_load():
    """Beyond about 45 % the bulge of a bonded puck lies on the plates: its apparent modulus rises again."""
    compression = np.array([0.35, 0.45, 0.55])
    path = compress(UnitPuck(RADIUS, "bonded"), LAW, compression)
    stretch = 1.0 - compression
    apparent = path.force / (AREA * (1.0 / stretch**2 - stretch))
    assert path.stop is None
    assert apparent[2] > apparent[1] * 1.08
    assert apparent[0] < 1.4


@pytest.mark.slow
def test_half_the_cell_and_half_the_slip_scale_change_little():
    compression = np.array([0.1, 0.3])
    puck = UnitPuck(RADIUS, "friction:0.3")
    force = compress(puck, LAW, compression).force
    assert compress(puck, LAW, compression, corner=0.02).force == pytest.approx(force, rel=5e-3)
    assert compress(puck, LAW, compression, slip_scale=1e-4).force == pytest.approx(force, rel=2e-3)


@pytest.mark.slow
def test_a_puck_is_the_same_in_metres_and_of_any_law_up_to_its_modulus():
    law = Ogden([0.3], [4.0])
    mm = solve_puck(Puck(30.0, 0.03, 50.0, plates="friction:0.2", law=law), [0.0, 9.0])
    metre = solve_puck(Puck(0.03, 0.03e6, 0.05, plates="friction:0.2", law=law.scaled(7.0)), [0.0, 0.009])
    assert mm.force_N == pytest.approx(metre.force_N, rel=1e-6)
    assert mm.force_N[0] == 0.0


def test_a_predicted_puck_is_the_solved_one_and_slips_unless_said():
    slipping, held = (
        predict_static(Puck(30.0, 0.03, 50.0, plates=p), [3.0, 6.0], "axisymmetric").force_N
        for p in ("frictionless", "friction:0.5")
    )
    assert np.array_equal(slipping, predict_static(Puck(30.0, 0.03, 50.0), [3.0, 6.0], "axisymmetric").force_N)
    stretch = 1.0 - np.array([3.0, 6.0]) / 30.0
    assert slipping == pytest.approx(0.01 * np.pi * 625.0 * (stretch**-2 - stretch), rel=2e-3)
    assert held == pytest.approx(
        solve_puck(Puck(30.0, 0.03, 50.0, plates="friction:0.5"), [3.0, 6.0]).force_N, rel=2e-3
    )


def test_a_puck_is_not_followed_at_finite_strain_as_if_it_were_a_slab():
    """The ratio of a slab under a punch is not that of a cylinder between plates."""
    puck = Puck(30.0, 0.03, 50.0, (PronyTerm(0.1, 0.5),))
    with raises_code("unsupported", "fidelity"):
        predict_motion(puck, ramp_and_hold(10.0, 3.0, 1.0), "viscoelastic")


@pytest.mark.parametrize("name", ["thickness_mm", "young_MPa", "diameter_mm"])
def test_a_puck_without_size_or_modulus_is_refused(name):
    with pytest.raises(InputError, match=name):
        Puck(**{"thickness_mm": 30.0, "young_MPa": 0.03, "diameter_mm": 50.0, name: 0.0})


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"compression_mm": [18.5]}, "out_of_range"),
        ({"compression_mm": [-1.0]}, "out_of_range"),
        ({"thickness_mm": 0.0}, "out_of_range"),
        ({"plates": "glued"}, "unknown_name"),
        ({"plates": "friction:-0.1"}, "unknown_name"),
        ({"diameter_mm": 2000.0}, "out_of_range"),
    ],
)
def test_bad_input_is_refused(change, code):
    values = {"diameter_mm": 50.0, "thickness_mm": 30.0, "young_MPa": 0.03, "compression_mm": [1.0], **change}
    compression_mm = values.pop("compression_mm")
    with raises_code(code):
        solve_puck(Puck(**values), compression_mm)
