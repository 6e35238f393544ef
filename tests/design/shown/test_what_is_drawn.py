"""What a report draws of a suggestion, against closed forms: reactions, grids, exponents and pictures."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design import plot_data as module
from dummydesign.design.plot_data import (
    COLUMNS,
    REACH,
    THICKNESS_GRID_MM,
    PressedPad,
    _drawn,
    _on_pixels,
    _pressed,
    _under_punch,
    exponent_over_thickness,
    force_grids,
    press_pictures,
    ratio_error,
    reactions,
    relative_force,
)
from dummydesign.design.request import NAGOYA_PROTOCOL
from dummydesign.design.scoring.press_simulation import SAMPLES, PadBatch, Sampling, SlabCurves
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.search.slabs import DesignCandidate
from dummydesign.pad.fem.mesh_axisymmetric import nine_nodes
from tests.support.exact_law import ExactLaw

POWER = 2.0


class PowerLaw(ExactLaw):
    """F = 900 E (d / h)^2 mm2 to half of the thickness."""

    ratio_range = (0.3, 2.0)

    def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
        return 900.0 * np.asarray(young_MPa) * (np.asarray(depth_mm, float) / thickness_mm) ** POWER

    def depth_limit_mm(self, thickness_mm, radius_mm):
        return 0.5 * np.asarray(thickness_mm, float)


def quantity(value, low=None, high=None):
    return SimpleNamespace(value=value, low=value if low is None else low, high=value if high is None else high)


class Resin:
    """E = 0.1 MPa (ratio / 15)^-6 within 10 % either way, one fast arm that is known within a half."""

    arms = (SimpleNamespace(tau_s=quantity(0.05), beta=quantity(0.4, 0.2, 0.6)),)
    tau_s, pressed_force = (0.05,), None
    ratio_min, ratio_max = 12.0, 15.01
    liquids = (
        SimpleNamespace(name="base", parts=None),
        SimpleNamespace(name="hardener", parts=1.0),
        SimpleNamespace(name="dye", parts=0.1),
    )

    def young_MPa(self, ratio):
        return 0.1 * (np.asarray(ratio) / 15.0) ** -6.0

    def modulus_kPa(self, ratio):
        value = float(1e3 * self.young_MPa(ratio))
        return quantity(value, 0.9 * value, 1.1 * value)

    def strengths(self, ratio):
        return np.full((len(ratio), 1), 0.4)


def answer(tolerance=0.2, weighing=0.1, **more):
    masses = {"base": 150.0, "hardener": 10.0, "dye": 1.0}
    components = [{"name": name, "mass_g": mass} for name, mass in masses.items()]
    given = {
        "resin": Resin(),
        "radius_mm": 7.9,
        "best": SimpleNamespace(ratio=15.0, thickness_mm=10.0),
        "request": None,
        "castings": SimpleNamespace(tolerances=SimpleNamespace(thickness_mm=tolerance, weighing_g=weighing)),
        "batch": {"components": components},
        "targets": SimpleNamespace(protocol=NAGOYA_PROTOCOL, sampling=Sampling(), limits=verdict_limits()),
    }
    return SimpleNamespace(**{**given, **more})


def test_the_ratio_is_off_most_where_both_are_weighed_off_in_opposite_ways():
    assert ratio_error(answer()) == pytest.approx(15.0 * ((150.1 / 150.0) / (10.9 / 11.0) - 1.0))
    assert ratio_error(answer(weighing=0.0)) == 0.0
    only = {"components": [{"name": "hardener", "mass_g": 10.0}]}
    assert ratio_error(answer(batch=only)) == 0.0
    without = {"components": [{"name": "base", "mass_g": 10.0}]}
    assert ratio_error(answer(batch=without)) == 0.0


def test_depth_and_peak_react_as_the_power_law_says():
    """Depth goes with the thickness and with E^-1/2; the peak over a steady force with the relaxation alone."""
    bars = {bar.name.split(",")[0].split(" ")[0]: bar for bar in reactions(answer(), PowerLaw())}
    assert bars["thickness"].name == "thickness ± 0.2 mm"
    assert bars["thickness"].depth_percent == pytest.approx((-2.0, 2.0), abs=0.02)
    assert bars["modulus"].depth_percent == pytest.approx(
        (100.0 * (1.1**-0.5 - 1.0), 100.0 * (0.9**-0.5 - 1.0)), abs=0.02
    )
    off = ratio_error(answer())
    # the rich end is held at the resin's largest ratio
    lean = (15.0 - off, 15.01)
    wanted = [100.0 * ((ratio / 15.0) ** 3.0 - 1.0) for ratio in lean]
    assert bars["weighing"].depth_percent == pytest.approx(tuple(wanted), abs=0.02)
    assert bars["relaxation"].depth_percent == pytest.approx((0.0, 0.0), abs=1e-6)
    low, high = bars["relaxation"].peak_percent
    # half more or less of an arm that adds up to 0.4 of the force
    assert low == pytest.approx(-high, rel=0.02) and 3.0 < high < 100.0 * 0.2 / 1.4
    assert bars["modulus"].peak_percent[1] < 0.5 * high


def test_an_end_out_of_reach_has_no_number_and_a_note():
    class Soft(Resin):
        def young_MPa(self, ratio):
            return 0.047 + 0.0 * np.asarray(ratio)

    soft = answer(resin=Soft())
    bars = reactions(soft, PowerLaw())
    noted = [bar for bar in bars if bar.name.endswith(" *")]
    assert all(np.isfinite(bar.depth_percent).all() for bar in bars)
    nominal = 900.0 * 0.047 * 0.25
    assert nominal > 10.0 > 0.9 * nominal and [bar.name for bar in noted] == ["modulus, 95 % *"]
    assert noted[0].depth_percent[1] == 0.0 > noted[0].depth_percent[0]


def test_thicknesses_are_held_to_what_the_law_knows():
    thick = answer(tolerance=20.0)
    bars = reactions(thick, PowerLaw())
    low, high = bars[0].depth_percent
    assert low == pytest.approx(100.0 * (7.9 / 2.0 / 10.0 - 1.0), abs=0.3)
    assert high == pytest.approx(100.0 * (7.9 / 0.3 / 10.0 - 1.0), abs=0.3)


def test_forces_are_drawn_from_almost_none_to_the_tests_ends():
    grids = force_grids(NAGOYA_PROTOCOL)
    assert len(grids.pad) == 65 and np.all(np.diff(grids.pad) > 0.0)
    assert grids.pad[0] == pytest.approx(0.02 * 5.0) and grids.pad[24] == 5.0 and grids.pad[-1] == 15.0
    assert grids.pad[25] == pytest.approx(5.0 + 0.025 * 10.0)
    assert (grids.extrapolated[0], grids.extrapolated[-1]) == (0.0, 5.0)
    assert (grids.measured[0], grids.measured[-1], len(grids.measured)) == (5.0, 15.0, 41)
    assert (grids.aim[0], grids.aim[-1]) == (0.0, 15.0)
    assert grids.relative[0] == pytest.approx(0.3) and grids.relative[-1] == pytest.approx(15.0)
    single = force_grids(SimpleNamespace(forces_N=(7.0,)))
    assert len(single.pad) == 25 and single.measured.tolist() == [7.0]


def power_slabs(limit=5.0, power=POWER):
    depth = limit * np.linspace(0.0, 1.0, SAMPLES)
    curves = SlabCurves(np.array([10.0]), np.array([limit]), 3.0 * 100.0 * (depth / 10.0)[None] ** power)
    return PadBatch(curves, np.array([0]), np.array([0.5]), (0.01,), np.array([[0.2]]))


def candidate_of(slabs):
    evaluation = SimpleNamespace(slabs=slabs, protocol=NAGOYA_PROTOCOL, sampling=Sampling())
    return DesignCandidate(10.0, 15.0, 0, evaluation)


def test_a_relative_force_is_the_pads_at_the_aims_depth():
    """The aim carries 0.3 d^3 N, the pad 150 (d/10)^2 N."""
    targets = SimpleNamespace(aim_depth_mm=lambda force: np.cbrt(np.asarray(force) / 0.3))
    grids = force_grids(NAGOYA_PROTOCOL)
    found = relative_force(candidate_of(power_slabs()), targets, grids)
    aim = np.cbrt(grids.relative / 0.3)
    own = 150.0 * (aim / 10.0) ** 2
    known = np.isfinite(found)
    inside = (own >= grids.pad[0]) & (own <= 15.0)
    np.testing.assert_array_equal(known, inside)
    np.testing.assert_allclose(found[known], (own / grids.relative)[known], rtol=2e-3)


def test_the_exponent_over_thickness_is_the_laws_where_it_holds():
    found = exponent_over_thickness(answer(law=PowerLaw()), PowerLaw(), force_grids(NAGOYA_PROTOCOL))
    assert found.shape == (len(THICKNESS_GRID_MM), 3)
    ratio = 7.9 / THICKNESS_GRID_MM
    held = (ratio >= 0.3) & (ratio <= 2.0)
    np.testing.assert_array_equal(np.isfinite(found[:, 0]), held)
    reached = np.isfinite(found[held])
    np.testing.assert_allclose(found[held][reached], POWER, rtol=2e-3)
    # 900 x 0.1 x 0.4^2 N are reached with certainty on every thickness
    assert reached[:, :2].all()


def cells_over(x, y):
    """Places and cells of an even grid."""
    corner = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    quads = np.stack([corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]]).reshape(4, -1)
    places, node = nine_nodes(np.stack(np.meshgrid(x, y, indexing="ij")).reshape(2, -1), quads)
    return places.T, node


def test_pixels_have_the_mean_of_cells_of_any_size_and_nothing_where_there_is_none():
    places, cells = cells_over(np.array([0.0, 0.2, 1.0, 5.0]), np.array([0.0, 0.3, 2.0]))
    value = 2.0 + 3.0 * places[:, 0] - 5.0 * places[:, 1]
    found = _on_pixels(places, value, cells, 0.1, (30, 41))
    assert np.isfinite(found[:20]).all() and np.isnan(found[20:]).all()
    out, up = np.meshgrid(0.1 * np.arange(41), 0.1 * (np.arange(20) + 0.5))
    # places of a cell are no finer than half a pixel, and the pixels at the axis lie on one side of it
    np.testing.assert_allclose(found[:20, 1:], (2.0 + 3.0 * out - 5.0 * up)[:, 1:], atol=0.25 * 0.1 * (3.0 + 5.0))


def test_a_picture_is_even_cells_about_the_axis_inside_the_pad_and_above_its_bone():
    points, cells = cells_over(np.linspace(0.0, 40.0, 81), np.linspace(0.0, 8.0, 33))
    face = np.array([[0.0, 6.0], [7.0, 6.0], [12.0, 8.0], [40.0, 8.0]])
    stress = 10.0 + points[:, 0] + 2.0 * points[:, 1]
    state = {
        "place_mm": points,
        "cells": cells,
        "stress_kPa": stress,
        "face_mm": face,
        "force_N": 9.0,
        "depth_mm": 2.0,
        "punch_mm": face[:2],
        "contact": {"contact_radius_mm": 7.0},
    }
    bone = SimpleNamespace(name="boned", bone_mm=lambda x, y: np.where(np.asarray(x) < 3.0, 1.0, 0.0))
    one = _drawn(SimpleNamespace(radius_mm=7.0, geometry=bone), 10.0, state)
    size = 2.0 * REACH * 7.0 / COLUMNS
    assert len(one.radius_mm) == COLUMNS and np.diff(one.radius_mm) == pytest.approx(size)
    np.testing.assert_allclose(one.radius_mm, -one.radius_mm[::-1], atol=1e-12)
    assert one.radius_mm[-1] + 0.5 * size == pytest.approx(REACH * 7.0)
    assert one.height_mm[0] == pytest.approx(0.5 * size)
    assert one.height_mm[-1] + 0.5 * size >= 8.0 > one.height_mm[-1] - size
    out, up = np.meshgrid(np.abs(one.radius_mm), one.height_mm)
    inside = (up <= np.interp(out, face[:, 0], face[:, 1])) & (up >= np.where(out < 3.0, 1.0, 0.0))
    np.testing.assert_array_equal(np.isfinite(one.stress_kPa), inside)
    np.testing.assert_allclose(one.stress_kPa[inside], (10.0 + out + 2.0 * up)[inside], atol=0.25 * size * 3.0)
    assert (one.force_N, one.static_N, one.depth_mm) == (10.0, 9.0, 2.0)


def test_the_scale_of_stress_is_that_of_nearly_all_under_the_contact():
    radius = np.linspace(-11.0, 11.0, 111)
    stress = np.tile(np.abs(radius), (5, 1))
    stress[0] = np.nan
    pad = PressedPad("", 1.0, 1.0, 1.0, radius, np.arange(5.0), stress, None, None, {"contact_radius_mm": 10.0})
    inside = np.abs(radius)[np.abs(radius) < 9.0]
    level = _under_punch(pad)
    # nearly all: between nineteen and ninety-nine of a hundred
    assert np.quantile(inside, 0.95) < level < np.quantile(inside, 0.99)
    nothing = PressedPad(
        "", 1.0, 1.0, 1.0, radius, np.arange(5.0), np.full_like(stress, np.nan), None, None, {"contact_radius_mm": 10.0}
    )
    assert _under_punch(nothing) == 1.0


def test_a_pad_is_solved_at_the_forces_it_reaches_with_its_own_modulus(monkeypatch):
    asked = []

    def pad(request, punch, thickness, young):
        from dummydesign.pad.pad_under_punch import Pad

        asked.append((thickness, young))
        return Pad(thickness, young, 7.9)

    monkeypatch.setattr(module, "pad_of_request", pad)
    monkeypatch.setattr(module, "_solved", lambda pad, depth: {"states": [{"depth": d} for d in depth]})
    monkeypatch.setattr(module, "_drawn", lambda pad, force, state: (force, state["depth"]))
    evaluation = SimpleNamespace(depth_mm=np.array([[9.0] * 6, [1.5, 2.5, np.nan, 1.4, 2.4, np.nan]]))
    candidate = DesignCandidate(8.123, 14.0, 1, evaluation)
    from dummydesign.geometry.shapes.slab import Slab

    found = _pressed(answer(punch=None, resin=Resin()), candidate, Slab())
    assert found == ((5.0, 1.5), (10.0, 2.5))
    assert asked == [(8.123, pytest.approx(float(Resin().young_MPa(14.0))))]
    quick = SimpleNamespace(request=SimpleNamespace(verify=False))
    assert press_pictures(quick).pads == () and "not requested" in press_pictures(quick).left_out


def test_solved_states_are_drawn_where_the_pad_is_with_stress_in_kilopascal(monkeypatch):
    from dummydesign.pad import fields

    asked = []

    def solve(pad, depths, coarse):
        asked.append((depths, coarse))
        face = SimpleNamespace(radius_mm=np.array([0.0, 1.0]), height_mm=np.array([8.0, 9.0]))
        ones = np.ones((3, 2))
        return [
            SimpleNamespace(
                depth_mm=d,
                force_N=2.0 * d,
                rest_mm=ones,
                displacement_mm=-0.25 * ones,
                cells=np.array([[0, 1, 2]]),
                von_mises_MPa=np.array([0.01, 0.02, 0.03]),
                punch_mm=face,
                contact=lambda: {"a": 1},
                face=face,
            )
            for d in depths
        ], None

    monkeypatch.setattr(fields, "solve_fields", solve)
    first, second = module._solved(None, np.array([2.0, 1.5]))["states"]
    # depths never fall from one force to the next
    assert asked == [([2.0, 2.0], True)] and (first["force_N"], second["depth_mm"]) == (4.0, 2.0)
    np.testing.assert_allclose(first["stress_kPa"], [10.0, 20.0, 30.0])
    np.testing.assert_allclose(first["place_mm"], 0.75)
    np.testing.assert_allclose(first["face_mm"], [[0.0, 8.0], [1.0, 9.0]])
