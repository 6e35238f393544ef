"""Shaped pads in space: layer theory, round pads in a meridian plane, slabs, symmetry, caps apart, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.axisymmetric.shaped_problem import shaped_problem as round_problem
from dummydesign.pad.axisymmetric.shaped_problem import solve_path
from dummydesign.pad.fem.mesh_axisymmetric import lines_by_size
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.spatial.shaped_pad import GridFineness, Load, shaped_problem, solve_shaped_block
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)
RADIUS = 14.0 / np.sqrt(np.pi)
COARSE = GridFineness(3, slope=1.0, height_growth=2.0)


def load(shape, thickness, half=(7.0, 7.0), offset=(0.0, 0.0), condition="bonded", slab=(150.0, 120.0), first=0.05):
    """A rectangular punch, or a round one of radius ``half``."""
    sides = half if isinstance(half, tuple) else (half, half)
    return Load(
        tuple(s / thickness for s in sides),
        tuple(0.5 * s / thickness for s in slab),
        condition=condition,
        shape=shape,
        thickness_mm=thickness,
        is_round=not isinstance(half, tuple),
        offset=tuple(s / thickness for s in offset),
        first=first,
    )


def first_stiffness(shape, thickness, half, grid=COARSE, **other):
    """Force per depth at first touch of a flat-topped pad, in shear moduli times thickness."""
    here = load(shape, thickness, half, **other)
    return here.multiplicity * shaped_problem(here, grid).stiffness()


def pressed(shape, thickness, depths, half=(7.0, 7.0), grid=COARSE, **other):
    """Force at relative depths over shear modulus times thickness^2."""
    here = load(shape, thickness, half, first=depths[0], **other)
    path = follow(shaped_problem(here, grid), depths, 0.25 * depths[0], 0.05 * here.scale, depths[0] / 64.0)
    assert path.stop is None
    return here.multiplicity * path.force


def test_grid_lines_meet_their_marks_and_follow_the_wanted_size():
    lines = lines_by_size(-2.0, 3.0, (0.0, 0.7, 9.0), lambda x: 0.1 + 0.2 * np.abs(x - 0.7), 0.3)
    assert {-2.0, 0.0, 0.7, 3.0} <= set(lines.tolist())
    sizes, middles = np.diff(lines), 0.5 * (lines[1:] + lines[:-1])
    assert np.all(sizes < 1.3 * (0.1 + 0.2 * np.abs(middles - 0.7)))


@pytest.mark.slow
@pytest.mark.parametrize("shape", [Boned(12.0, 4.0), Layered(6.0, 4.0)])
def test_a_flat_top_over_its_slab_is_that_of_the_axisymmetric_solve(shape):
    """Round punch, the same bead, d/h 0.03: within 1.5 % on a coarse grid that does not follow the circle."""
    press = Case(RADIUS / 12.0, np.sqrt(150 * 120 / np.pi) / 12.0, shape=shape, thickness_mm=12.0)
    pair = [solve_path(press, np.array([0.03]), 12, 0.1, twin).force[0] for twin in (False, True)]
    here = load(shape, 12.0, RADIUS, first=0.03)
    forces = [
        follow(shaped_problem(item, COARSE), [0.03], 0.015, 0.03, 1e-3).force[0]
        for item in (here, replace(here, homogeneous=True))
    ]
    assert forces[0] / forces[1] == pytest.approx(pair[0] / pair[1], rel=0.015)


@pytest.mark.slow
def test_layers_of_one_modulus_are_a_slab_on_another_grid_and_a_stiff_one_below_stiffens():
    slab = first_stiffness(Slab(), 10.0, (7.0, 7.0))
    assert first_stiffness(Layered(4.0, 1.0), 10.0, (7.0, 7.0)) == pytest.approx(slab, rel=0.02)
    stiff, soft = (first_stiffness(Layered(4.0, ratio), 10.0, (7.0, 7.0)) for ratio in (4.0, 0.25))
    assert soft < 0.8 * slab < slab < 0.8 * stiff


@pytest.mark.slow
def test_a_shallow_cap_follows_the_theory_of_a_layer_at_small_depth():
    """F = 16/9 E sqrt(R) d^1.5 f(sqrt(R d)/h), f of the integral equation to 0.3 %; coarse grid, d/h 0.02: 5 %."""
    radius, thickness, depth = 40.0, 40.0, 0.8
    c = np.sqrt(radius * depth) / thickness
    factor = 1.0 + 1.133 * c + 1.497 * c**2 + 1.469 * c**3 + 0.755 * c**4
    theory = 16.0 / 9.0 * 3.0 * np.sqrt(radius) * depth**1.5 * factor
    cap = Crowned(radius, 6.0)
    found = pressed(cap, thickness, [depth / thickness], (14.0, 14.0), COARSE, condition="frictionless")
    assert found[0] * thickness**2 == pytest.approx(theory, rel=0.05)


@pytest.mark.slow
def test_a_punch_beside_the_apex_finds_the_same_pad_on_either_side():
    crown, depths, wide = Crowned(10.0, 2.0), [0.06], (130.0, 130.0)
    right, back = (pressed(crown, 5.0, depths, offset=offset, slab=wide)[0] for offset in ((1.5, 0.0), (0.0, -1.5)))
    assert right == pytest.approx(back, rel=1e-6)


@pytest.mark.slow
def test_half_and_quarter_of_a_pad_make_the_same_whole():
    crown = Crowned(10.0, 2.0)
    quarter = pressed(crown, 5.0, [0.06])[0]
    assert pressed(crown, 5.0, [0.06], offset=(1e-7, 0.0))[0] == pytest.approx(quarter, rel=1e-4)


@pytest.mark.slow
def test_a_ridge_is_stiffer_than_a_crown_and_softer_than_the_slab():
    crown, ridge = (pressed(Crowned(10.0, 2.0, ridge=flag), 5.0, [0.1])[0] for flag in (0.0, 1.0))
    slab = 0.1 * first_stiffness(Slab(), 5.0, (7.0, 7.0))
    assert crown < 0.8 * ridge < ridge < 0.8 * slab


@pytest.mark.slow
def test_a_tall_crown_is_softer_beside_its_apex():
    """h 15, c 8, R 3, foot 8 under a punch that lands 3 mm off, d/h 0.05: the cap bends aside, less than a fifth."""
    tall = Crowned(3.0, 8.0, 8.0)
    centred, beside = (pressed(tall, 15.0, [0.05], offset=offset)[0] for offset in ((0.0, 0.0), (3.0, 0.0)))
    assert 0.8 * centred < beside < 1.02 * centred


@pytest.mark.slow
def test_a_crown_in_space_carries_what_it_does_in_a_meridian_plane():
    """Round punch, h 5, R 10, c 2, the same bead: cells and steps in space leave out 1.6 % at d/h 0.3, 2.4 % at 0.4."""
    depths = np.array([0.1, 0.2, 0.3, 0.4])
    press = Case(RADIUS / 5.0, np.sqrt(150 * 120 / np.pi) / 5.0, shape=Crowned(10.0, 2.0), thickness_mm=5.0, first=0.1)
    flat = follow(round_problem(press, 24, 0.1), depths, 0.02, 0.01, 3e-4).force
    space = pressed(Crowned(10.0, 2.0), 5.0, depths, RADIUS, GridFineness(5))
    assert space[:2] == pytest.approx(flat[:2], rel=0.01) and space[2:] == pytest.approx(flat[2:], rel=0.03)


@pytest.mark.slow
def test_a_crown_on_large_cells_in_space_is_within_its_error_of_one_under_a_sharp_edge():
    """Pointed, past the punch's edge: 5 % were left out at d/h 0.4 by cells and fillet, 1 % stated."""
    pad, depth = Pad(10.0, 1.0, RADIUS, geometry=Crowned(2.6, 3.2, 7.8)), np.array([1.0, 2.5, 4.0])
    space = solve_shaped_block(pad, depth, GridFineness(4, slope=1.0, height_growth=2.0))
    flat = solve_shaped_pad(pad, depth)
    assert np.all(np.abs(space.force_N / flat.force_N - 1.0) < space.error_N / space.force_N)
    assert space.force_N[1:] == pytest.approx(flat.force_N[1:], rel=0.025)


@pytest.mark.slow
def test_a_curve_states_what_its_grid_leaves_open():
    curve = solve_shaped_block(
        Pad(5.0, 0.03, 7.9, geometry=Crowned(10.0, 2.0), sides_mm=(14.0, 14.0)), [0.5, 1.0, 1.5], grid=GridFineness(5)
    )
    finer = solve_shaped_block(
        Pad(5.0, 0.03, 7.9, geometry=Crowned(10.0, 2.0), sides_mm=(14.0, 14.0)), [0.5, 1.0, 1.5], grid=GridFineness(7)
    )
    assert curve.notes == ()
    assert np.all(np.abs(finer.force_N - curve.force_N) < curve.error_N + 0.005 * curve.force_N)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"condition": "oiled"}, "unknown_name"),
        ({"base": "glued"}, "unknown_name"),
        ({"offset_mm": (70.0, 0.0)}, "out_of_range"),
        ({"sides_mm": (14.0, 0.0)}, "out_of_range"),
        ({"depth_mm": [4.0]}, "out_of_range"),
    ],
)
def test_what_cannot_be_solved_is_refused(change, code):
    given = {"depth_mm": [1.0], "offset_mm": (0.0, 0.0), "sides_mm": (14.0, 14.0), **change}
    depth, offset = given.pop("depth_mm"), given.pop("offset_mm")
    with raises_code(code):
        solve_shaped_block(Pad(5.0, 0.03, 7.9, **given), depth, offset_mm=offset)


def test_a_bone_cannot_slide_on_its_base():
    with raises_code("unsupported", "base"):
        solve_shaped_block(
            Pad(12.0, 0.03, 7.9, base="sliding", geometry=Boned(12.0, 4.0), sides_mm=(14.0, 14.0)), [1.0]
        )
