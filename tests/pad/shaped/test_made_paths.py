"""What becomes of followed paths: sharp edges, slabs, ends and errors, on forces known in closed form."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.pad.axisymmetric import shaped_pad
from dummydesign.pad.axisymmetric.case import Case, first_stiffness
from dummydesign.pad.axisymmetric.shaped_pad import (
    GLUED_ERROR,
    SLIDING_ERROR,
    least_fillet_mm,
    solve_flat,
    solve_ratio,
    solve_shaped_pad,
)
from dummydesign.pad.axisymmetric.shaped_problem import grids
from dummydesign.pad.force_law import NO_COST, PadCurve
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath
from dummydesign.pad.tables.slab import load_table

DEPTHS = np.array([0.02, 0.1, 0.3])
POWER = 1.25


def rimmed(monkeypatch, reach: dict[float, int], ratio: float = 0.8):
    """``_follow_rim`` with forces that miss of a sharp edge what a power of the fillet takes; what it was asked."""
    asked = []

    def follow_rim(case, depths, slides):
        asked.append((case, slides))
        rim = case.edge / case.scale
        glued = (case.base, case.condition) == ("bonded", "bonded")
        force = 5.0 * depths * (1.0 if glued else ratio) * np.exp(-(0.4 if glued else 1.0) * rim**POWER)
        count = reach.get(round(rim, 9), len(depths))
        stop = None if count == len(depths) else f"ends under {rim:.2g}"
        return ForcePath(depths[:count], force[:count], np.ones(count), 9, 1, 2, 0.1, stop)

    monkeypatch.setattr(shaped_pad, "_follow_rim", follow_rim)
    return asked


@pytest.mark.parametrize("radius", [0.5, 1.7])
@pytest.mark.parametrize("kind", [{"condition": "frictionless"}, {"base": "sliding"}])
def test_the_ratio_to_the_glued_slab_is_carried_to_the_sharp_edge_and_its_rest_stated(monkeypatch, radius, kind):
    asked = rimmed(monkeypatch, {})
    found = solve_ratio(Case(radius, 9.0, **kind), DEPTHS)
    assert found["ratio"] == pytest.approx(np.full(3, 0.8), rel=1e-12) and found["notes"] == ()
    # What the extrapolation added to the smaller fillet is doubted as a whole.
    added = 0.6 * 0.05**POWER
    slides = "condition" in kind
    assert found["error"] == pytest.approx((SLIDING_ERROR if slides else GLUED_ERROR) + added, rel=1e-9)
    assert found["solver"]["newton_iterations"] == 2 * len(asked) == 8
    assert [one.edge for one, _ in asked] == pytest.approx(min(radius, 1.0) * np.array([0.1, 0.1, 0.05, 0.05]))
    assert {flag for _, flag in asked} == {slides} and all(one.condition == "bonded" for one, _ in asked[::2])


def test_where_the_small_fillet_ends_its_last_step_is_held_and_doubted_as_a_whole(monkeypatch):
    rimmed(monkeypatch, {0.05: 1})
    found = solve_ratio(Case(0.8, 9.0, condition="frictionless"), DEPTHS)
    assert found["ratio"] == pytest.approx(np.full(3, 0.8), rel=1e-12)
    added = np.array([0.05, 0.1, 0.1]) ** POWER * 0.6
    assert found["error"] == pytest.approx(SLIDING_ERROR + added, rel=1e-9)
    rimmed(monkeypatch, {0.1: 2, 0.05: 2})
    short = solve_ratio(Case(0.8, 9.0, condition="frictionless"), DEPTHS)
    assert len(short["ratio"]) == 2 and all(one in short["notes"][0] for one in ("0.100", "0.300", "ends under 0.1"))
    assert short["error"] == pytest.approx(np.full(2, SLIDING_ERROR + 0.6 * 0.05**POWER), rel=1e-9)


def test_a_base_with_friction_adds_what_its_regularised_slip_leaves_at_small_depth(monkeypatch):
    rimmed(monkeypatch, {})
    plain, resting = (solve_ratio(Case(0.8, 9.0, base), DEPTHS)["error"] for base in ("sliding", "friction:0.3"))
    extra = resting - plain
    assert np.all(extra > 0.0) and extra * DEPTHS == pytest.approx(np.full(3, extra[0] * DEPTHS[0]))
    assert extra[0] < 0.003


def test_a_slab_that_slides_is_the_glued_one_times_its_ratio_and_their_errors_add_up(monkeypatch):
    solved = []

    def glued(pad, depth_mm):
        solved.append(pad)
        depth = np.asarray(depth_mm)[:2]
        return PadCurve(depth, 3.0 * depth, 0.03 * depth, dict(NO_COST, load_steps=4), ("glued ends",))

    monkeypatch.setattr(shaped_pad, "solve_curve", glued)
    rimmed(monkeypatch, {})
    found = solve_flat(Pad(10.0, 0.03, 8.0, condition="frictionless", base="sliding"), 10.0 * DEPTHS)
    depth = 10.0 * DEPTHS[:2]
    assert found.depth_mm == pytest.approx(depth) and found.force_N == pytest.approx(2.4 * depth)
    share = 0.01 + SLIDING_ERROR + 0.6 * 0.05**POWER
    assert found.error_N / found.force_N == pytest.approx(np.full(2, share))
    assert found.notes == ("glued ends",) and found.solver["load_steps"] == 8
    assert (solved[0].base, solved[0].condition) == ("bonded", "bonded")


@pytest.mark.parametrize("kind", [{"condition": "frictionless"}, {"base": "sliding"}])
def test_the_ratio_at_a_small_depth_is_that_of_first_touch(monkeypatch, kind):
    """By wide fillets on a small slab, against the sharp edge's own elements."""
    monkeypatch.setattr(shaped_pad, "RIMS", (0.3, 0.15))
    slab = Case(0.8, 2.4, **kind)
    found = solve_ratio(slab, np.array([0.04]))
    first = first_stiffness(slab) / first_stiffness(Case(0.8, 2.4))
    assert first < 0.95
    assert found["ratio"][0] == pytest.approx(first, rel=0.03)


class MadePaths:
    """Paths by cells and fillet: what a fillet takes by its power, and 2 % more on the larger cells."""

    touched = ()

    def climb(self, case, deepest, grid, twin, sound_J=0.0):
        return MadePath(*grid, DEPTHS[1] if grid == (16, 0.05) else deepest)


@dataclass
class MadePath:
    cells: int
    rim: float
    reached: float

    def at(self, depths):
        depths = depths[depths <= self.reached]
        force = 3.0 * depths**1.5 * np.exp(-0.8 * self.rim**POWER + 0.02 * (self.cells < 16))
        stop = "ends" if (self.cells, self.rim) == (16, 0.05) else None
        return ForcePath(depths, force, np.ones(len(depths)), 9, 1, 2, 0.1, stop, doubt=np.full(len(depths), 1e-4))


def test_a_crown_is_carried_to_the_sharp_edge_and_states_what_that_and_its_cells_leave_open():
    pad, depth = Pad(8.0, 0.03, 7.0, geometry=read_shape("crowned:20,2,9")), 8.0 * DEPTHS
    found = solve_shaped_pad(pad, depth, solved=MadePaths())
    assert found.depth_mm == pytest.approx(depth) and found.notes == () and found.solver["load_steps"] == 3
    # Where the fine cells have ended, the larger ones carry on from there.
    assert found.force_N == pytest.approx(3.0 * DEPTHS**1.5 * 0.01 * 64.0, rel=1e-3)
    added = np.expm1(0.8 * 0.05**POWER)
    share = shaped_pad.LEAST_ERROR + shaped_pad.EDGE_ERROR * added + shaped_pad.MESH_ERROR * 0.02 + 1e-4
    assert found.error_N / found.force_N == pytest.approx(np.full(3, share), rel=0.01)
    plain = Pad(8.0, 0.03, 7.0, geometry=read_shape("crowned:20,2,9"), edge_radius_mm=0.35)
    real = solve_shaped_pad(plain, depth[:2], solved=MadePaths())
    own = 3.0 * DEPTHS[:2] ** 1.5 * np.exp(-0.8 * 0.05**POWER)
    assert real.force_N == pytest.approx(own * 0.01 * 64.0, rel=1e-9)
    least = shaped_pad.LEAST_ERROR + shaped_pad.MESH_ERROR * 0.02 + 1e-4
    assert real.error_N / real.force_N == pytest.approx(np.full(2, least))


def test_a_fillet_smaller_than_the_smallest_followed_lies_on_the_power_law_between_both(monkeypatch):
    """Forces that a fillet lowers by its power 1.25: any fillet between is then met exactly."""
    pad = Pad(8.0, 0.03, 7.0, geometry=read_shape("crowned:20,2,9"))
    least, whole = least_fillet_mm(pad), solve_shaped_pad
    assert least == pytest.approx(0.015 * 7.0) and least_fillet_mm(replace(pad, thickness_mm=5.0)) < least

    def between(own, depth_mm, *rest):
        if 0.0 < own.edge_radius_mm < least:
            return whole(own, depth_mm, *rest)
        depth = np.asarray(depth_mm)[: 3 if own.edge_radius_mm else 2]
        force = 2.0 * depth * np.exp(-0.3 * own.edge_radius_mm**POWER)
        return PadCurve(depth, force, (0.02 if own.edge_radius_mm else 0.01) * force, dict(NO_COST, load_steps=1))

    monkeypatch.setattr(shaped_pad, "solve_shaped_pad", between)
    for share in (0.2, 0.7):
        found = whole(replace(pad, edge_radius_mm=share * least), [0.5, 1.0, 1.5])
        exact = np.array([1.0, 2.0]) * np.exp(-0.3 * (share * least) ** POWER)
        assert found.force_N == pytest.approx(exact, rel=1e-9) and found.depth_mm == pytest.approx([0.5, 1.0])
        assert found.error_N == pytest.approx(0.02 * exact) and found.solver["load_steps"] == 2


def test_the_grids_of_a_solve_are_two_fillets_and_twice_the_cells_and_a_real_fillet_is_its_own():
    sharp = grids(16, Case(0.5, 9.0))
    assert [cells for cells, _ in sharp] == [16, 8, 16] and 2.0 * sharp[0][1] == 2.0 * sharp[1][1] == sharp[2][1]
    for radius in (0.5, 2.0):
        real = grids(16, Case(radius, 9.0, edge=0.07))
        assert [cells for cells, _ in real] == [16, 8]
        assert [rim * min(radius, 1.0) for _, rim in real] == pytest.approx([0.07, 0.07])
    assert min(cells for cells, _ in grids(6, Case(0.5, 9.0))) == 4


def slab_curve(monkeypatch, **kind):
    """What the slab under a shaped pad's edge is solved by, if not taken from a table, and with which lengths."""
    asked = []

    def solved(name):
        def solve(*words, **more):
            pad, depth_mm = (words[1], words[2]) if name == "solve_on_lattice" else (words[0], words[1])
            asked.append((name, pad, np.asarray(depth_mm)))
            return PadCurve(asked[-1][2], asked[-1][2], asked[-1][2], dict(NO_COST))

        return solve

    for name in ("solve_on_lattice", "solve_curve", "solve_flat"):
        monkeypatch.setattr(shaped_pad, name, solved(name))
    pad = Pad(**{"thickness_mm": 10.0, "young_MPa": 0.03, "radius_mm": 7.9, "geometry": Layered(5.0, 2.0)} | kind)
    return pad, shaped_pad._slab_curve(pad, Case.of(pad), DEPTHS), asked


@pytest.mark.parametrize(
    "kind", [{}, {"base": "sliding"}, {"edge_radius_mm": 0.8}, {"extent_mm": 1.005 * PAD_EXTENT_MM}]
)
def test_the_slab_under_a_flat_top_is_taken_from_the_table_of_its_edge(monkeypatch, kind):
    tables = []
    monkeypatch.setattr(shaped_pad, "slab_table", lambda *words: tables.append(words) or load_table(words[0]))
    pad, curve, asked = slab_curve(monkeypatch, **kind)
    assert tables == [(pad.base, pytest.approx(pad.edge_radius_mm), pytest.approx(7.9))]
    assert not asked and curve.depth_mm == pytest.approx(10.0 * DEPTHS) and curve.notes == ()
    law = load_table(pad.base)
    assert curve.force_N == pytest.approx(law.force(10.0 * DEPTHS, 10.0, 0.03, 7.9), rel=1e-9)
    assert curve.error_N / curve.force_N == pytest.approx(law.relative_error(10.0 * DEPTHS, 10.0, 7.9), rel=1e-9)


def test_the_slab_of_a_table_ends_where_it_does_and_says_so():
    pad = Pad(4.0, 0.03, 7.9, geometry=Layered(2.0, 2.0))
    limit, deep = float(load_table("bonded").depth_limit(7.9 / 4.0)), np.array([0.1, 0.3, 0.599])
    curve = shaped_pad._slab_curve(pad, Case.of(pad), np.append(deep[deep < limit], 1.01 * limit))
    assert curve.depth_mm == pytest.approx(4.0 * deep[deep < limit]) and len(curve.notes) == 1


@pytest.mark.parametrize(
    ("kind", "by"),
    [
        ({"poisson": 0.49}, "solve_curve"),
        ({"law": Yeoh(1.0, 0.2)}, "solve_curve"),
        ({"extent_mm": 60.0}, "solve_curve"),
        ({"condition": "frictionless"}, "solve_flat"),
        ({"poisson": 0.49, "edge_radius_mm": 0.8}, "solve_on_lattice"),
        ({"radius_mm": 31.0, "extent_mm": PAD_EXTENT_MM}, "solve_curve"),
    ],
)
def test_a_slab_that_no_table_holds_is_solved_in_millimetres(monkeypatch, kind, by):
    pad, curve, asked = slab_curve(monkeypatch, **kind)
    ((name, own, depth),) = asked
    assert name == by and depth == pytest.approx(10.0 * DEPTHS) and curve.depth_mm == pytest.approx(depth)
    assert own.geometry != pad.geometry and own.thickness_mm == 10.0
    assert (own.radius_mm, own.edge_radius_mm) == pytest.approx((pad.radius_mm, pad.edge_radius_mm))
    assert own.extent_mm == pytest.approx(kind.get("extent_mm", PAD_EXTENT_MM))
