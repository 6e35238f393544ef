"""Closed forms of the mould room against independent numbers and limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import Outline, drafted_volume_mm3, edge_fillet_volume_mm3, slab_volume_mm3
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.plan import batch_of, pour_plan, split_batch


def _volume_by_slices(base: Outline, height: float, draft_deg: float, radius: float, n: int = 20000) -> float:
    """Stack of thin slices whose outline follows wall and fillet: shares nothing with the closed form."""
    a = math.radians(draft_deg)
    inside = math.pi / 2 + a
    tangent = radius / math.tan(inside / 2)
    top = tangent * math.sin(inside)
    z = (np.arange(n) + 0.5) * height / n
    out = z * math.tan(a)
    low = z < top
    # Circle of the fillet, its centre a radius above the floor and a tangent length inwards.
    out[low] = -(tangent - np.sqrt(radius**2 - (radius - z[low]) ** 2))
    area = [base.grown(d).area_mm2 for d in out]
    return float(np.sum(area) * height / n)


@pytest.mark.parametrize("draft", [0.0, 2.0, 6.0])
@pytest.mark.parametrize("radius", [0.0, 1.5, 4.0])
def test_slab_volume_is_the_sum_of_its_slices(draft, radius):
    base = Outline(150, 120, 5)
    exact = slab_volume_mm3(base, 20, draft, radius)
    assert exact == pytest.approx(_volume_by_slices(base, 20, draft, radius), rel=2e-7)


def test_drafted_slab_of_the_notes_has_the_known_volume():
    assert drafted_volume_mm3(Outline(150, 120, 5), 20, 2) == pytest.approx(363292.503, abs=1e-3)


def test_cylinder_with_quarter_round_edge_is_pappus_by_hand():
    r, radius = 2.0, 25.0
    section = r * r * (1 - math.pi / 4)
    centroid = r * (1 - (5 / 6 - math.pi / 4) / (1 - math.pi / 4))
    lost = 2 * math.pi * (radius - (r - centroid)) * section
    # Centroid of a spandrel lies (10 - 3 pi) / (12 - 3 pi) r from its straight sides.
    from_side = r * (10 - 3 * math.pi) / (12 - 3 * math.pi)
    lost = 2 * math.pi * (radius - from_side) * section
    assert edge_fillet_volume_mm3(Outline(50, 50, 25), r, 0.0) == pytest.approx(lost, rel=1e-12)


def test_fillet_volume_vanishes_with_its_radius_squared():
    base = Outline(150, 120, 5)
    small, smaller = (edge_fillet_volume_mm3(base, r, 2.0) for r in (1e-3, 5e-4))
    assert small / smaller == pytest.approx(4.0, rel=1e-3)


def test_parallel_outlines_obey_steiner():
    base = Outline(80, 50, 4)
    for d in (0.5, 3.0):
        assert base.grown(d).area_mm2 == pytest.approx(base.area_mm2 + base.perimeter_mm * d + math.pi * d * d)


def test_tenth_of_a_degree_tilts_150_mm_by_a_quarter_millimetre():
    assert formula.tilt_error_mm(150, 0.1) == pytest.approx(0.2618, abs=1e-4)


def test_level_tolerance_is_a_fixed_share_of_thin_pads_and_never_above_its_cap():
    for t in (3, 5, 10):
        assert formula.tilt_error_mm(150, formula.level_tolerance_deg(t, 150)) == pytest.approx(0.025 * t)
    assert formula.level_tolerance_deg(30, 150) == formula.level_tolerance_deg(15, 150)


def test_meniscus_of_water_on_clean_glass_is_nearly_4_mm():
    # Textbook value: sqrt(2) capillary lengths of 2.73 mm.
    assert formula.meniscus_height_mm(0.0728, 0.998, 0.0) == pytest.approx(3.857, abs=0.01)
    assert formula.meniscus_height_mm(0.0728, 0.998, 90.0) == pytest.approx(0.0, abs=1e-6)


def test_meniscus_volume_balances_the_pull_of_the_wall():
    volume = formula.meniscus_volume_mm3(0.035, 1.04, 60.0, 540.0)
    weight_N = volume * 1.04e-6 * formula.GRAVITY_M_PER_S2
    assert weight_N == pytest.approx(0.035 * math.cos(math.radians(60)) * 0.540, rel=1e-12)


def test_wall_deflection_solves_the_beam_equation():
    depth, wall, young, density = 30.0, 12.0, 0.73, 1.04
    stiffness = young * wall**3 / 12
    z = np.linspace(0, depth, 4001)
    load = density * 1e-6 * formula.GRAVITY_M_PER_S2 * (depth - z)
    step = z[1] - z[0]

    def integral(f):
        return np.concatenate([[0.0], np.cumsum((f[1:] + f[:-1]) / 2) * step])

    shear = integral(load)[-1] - integral(load)
    moment = integral(shear)[-1] - integral(shear)
    bent = integral(integral(moment / stiffness))
    assert formula.wall_deflection_mm(depth, wall, young, density) == pytest.approx(bent[-1], rel=1e-5)
    assert formula.wall_deflection_mm(2 * depth, wall, young, density) == pytest.approx(32 * bent[-1], rel=1e-5)


def test_peeling_needs_thousands_of_times_less_force_than_a_pull_against_air_pressure():
    assert formula.peel_force_N(120, 5.0) == pytest.approx(0.6)
    assert formula.suction_force_N(150 * 120) == pytest.approx(1824, abs=1)


@pytest.mark.parametrize("resolution", [0.01, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("total", [37.3, 111.43, 442.0])
def test_split_batch_is_whole_steps_and_states_an_error_that_holds(total, resolution):
    shares = (("polyol", 100 / 115), ("isocyanate", 15 / 115))
    masses, error = split_batch(total, shares, resolution)
    for _, mass in masses:
        assert mass / resolution == pytest.approx(round(mass / resolution), abs=1e-6)
    whole = sum(mass for _, mass in masses)
    for (_, share), (_, mass) in zip(shares, masses):
        assert abs(mass / whole / share - 1) * 100 <= error


@pytest.mark.parametrize("resolution", [0.01, 0.1, 0.5])
def test_the_ratio_of_the_weights_is_within_half_a_step_of_the_largest_component(resolution):
    """Any ratio, total and number of liquids: the smallest is not rounded by itself (palm: 15.239 for 15.2)."""
    rng = np.random.default_rng()
    for _ in range(200):
        ratio, total = rng.uniform(4.0, 40.0), rng.uniform(30.0, 500.0)
        parts = (100.0, ratio) if rng.random() < 0.5 else (50.0, 50.0, ratio)
        shares = tuple((str(i), part / sum(parts)) for i, part in enumerate(parts))
        masses = [mass for _, mass in split_batch(total, shares, resolution)[0]]
        made = 100.0 * masses[-1] / sum(masses[:-1])
        allowed = 0.5 * resolution * (len(parts) - 1) / (total / (1.0 + ratio / 100.0))
        assert abs(made / ratio - 1.0) <= 1.05 * allowed + 1e-12, (ratio, total, parts)
        assert -1e-9 <= sum(masses) - total <= resolution * (2.0 + sum(parts) / min(parts))


def test_the_weights_state_the_ratio_that_they_make_and_no_hash_depends_on_it():
    spec = mould_spec(10.0, 150.0, 120.0, ratio=15.2)
    plan = pour_plan(spec)
    masses = dict(plan.components)
    made = 100.0 * masses["isocyanate"] / masses["polyol"]
    assert plan.weighed_ratio == pytest.approx(made, rel=1e-12) == pytest.approx(15.2, rel=1e-3)
    batch = batch_of(spec, spec.pour, plan).to_dict()
    assert batch["ratio"] == pytest.approx(15.2, rel=1e-3)
    older = replace(spec, pour=replace(spec.pour, ratio_component=""))
    assert older.hash == spec.hash and pour_plan(older).weighed_ratio is None


def test_finer_balance_makes_a_smaller_ratio_error():
    shares = (("polyol", 100 / 115), ("isocyanate", 15 / 115))
    errors = [split_batch(111.43, shares, resolution)[1] for resolution in (1.0, 0.1, 0.01)]
    assert errors[0] > errors[1] > errors[2]
