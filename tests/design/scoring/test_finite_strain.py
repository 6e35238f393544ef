"""What finite strain makes of castings: none where nothing relaxes, else what a prediction of the same press allows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.design.assessment.budget import budget_of_castings
from dummydesign.design.pad_evaluator import law_of_shape, one_pad
from dummydesign.design.scoring.castings import FORCE_LAW, GROUPS, Castings, Tolerances
from dummydesign.design.scoring.crowns import DEVIATES, EXACT, finite_strain_of
from dummydesign.design.scoring.press_simulation import press_to_depth
from dummydesign.design.scoring.verdict import Readings
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.measurement.motion import Motion
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.predict import departure, predict_motion
from tests.support.cast_pads import CROWNED, cast_pad, space_of

PADS = [
    ("slab", 12.0, 15.2),
    CROWNED,
    ("layered:top=2.2,modulus_ratio=0.2", 11.0, 17.5),
    ("boned:radius=6,height=2.4", 9.0, 15.0),
]


@pytest.fixture(scope="module")
def palm():
    return space_of()


def pressed(space, slab_law, kind, thickness_mm, ratio):
    """The shape, one design of it at central numbers, and what finite strain makes of it."""
    shape = read_shape(kind)
    pad = one_pad(law_of_shape(slab_law, shape, thickness_mm), space, thickness_mm, ratio).candidate
    return shape, pad, finite_strain_of(pad.alone, shape, space.base, space.targets, space.radius_mm)


def rise_of(space, pad, number):
    """The rise of one press of the test, as a motion."""
    condition = space.targets.conditions[number]
    press = press_to_depth(pad.alone, pad.depth_mm[[number]], condition.velocity_mm_s, space.targets.sampling)
    end = press.stopped + 1
    return Motion(press.time_s[0, :end], press.displacement_mm[0, :end])


def as_predicted(space, shape, pad):
    """The same pad as ``predict`` has it."""
    prony = tuple(space.resin.prony(pad.ratio))
    return Pad(pad.thickness_mm, float(pad.alone.young_MPa[0]), space.radius_mm, prony, geometry=shape)


@pytest.mark.parametrize("kind", PADS, ids=[pad[0].partition(":")[0] for pad in PADS])
def test_the_ends_of_95_percent_are_what_a_prediction_of_the_same_press_allows_for(palm, kind):
    space, slab_law, _ = palm
    shape, pad, found = pressed(space, slab_law, *kind)
    known = np.flatnonzero(np.isfinite(pad.depth_mm))
    assert len(known) >= 4
    for number in known:
        motion = rise_of(space, pad, number)
        own = as_predicted(space, shape, pad)
        made, curve = predict_motion(own, motion), elastic_curve(own, "table")
        time_s, depth_mm, force = motion.time_s, motion.displacement_mm, made.force_N
        place = own.radius_mm / own.thickness_mm, depth_mm / own.thickness_mm
        off = departure("bonded", *place, time_s, curve.force(depth_mm), own.prony, shape, own.thickness_mm)
        at = int(np.argmax(force))
        ends = [found.peak[0, number] + side * HALF_WIDTH * found.peak[1, number] for side in (-1.0, 1.0)]
        np.testing.assert_allclose(ends, 1.0 + off[:, at] / force[at], rtol=3e-3)
        # an interval that holds the quick force itself
        error = force * curve.relative_error(np.maximum.accumulate(depth_mm))
        predicted = [made.force_low_N[at] + error[at], made.force_high_N[at] - error[at]] / force[at]
        np.testing.assert_allclose([min(ends[0], 1.0), max(ends[1], 1.0)], predicted, rtol=3e-3)
        works = [np.trapezoid(values, depth_mm) for values in (*off, force)]
        ends = [found.energy[0, number] + side * HALF_WIDTH * found.energy[1, number] for side in (-1.0, 1.0)]
        np.testing.assert_allclose(ends, 1.0 + np.array(works[:2]) / works[2], rtol=5e-3)


@pytest.mark.parametrize("change", ["no strength", "slow arms"])
def test_a_pad_that_does_not_relax_in_the_press_has_none(palm, change):
    space, slab_law, _ = palm
    _, pad, found = pressed(space, slab_law, *CROWNED)
    assert found.peak[0].max() > 1.03
    alone = pad.alone
    stiff = (
        replace(alone, beta=0.0 * alone.beta) if change == "no strength" else replace(alone, tau_s=(1e9, 1e10, 1e11))
    )
    none = finite_strain_of(stiff, read_shape("slab"), space.base, space.targets, space.radius_mm)
    for values in (none.peak, none.energy):
        np.testing.assert_allclose(values, np.array([[1.0], [0.0]]) + 0.0 * values, atol=1e-6)


def test_readings_are_multiplied_by_one_deviate_a_casting_and_depths_stay(palm):
    _, _, castings = palm
    _, pad, found = pressed(*palm[:2], *CROWNED)
    deviates = castings.pours(10.0, 15.3, Tolerances(60.0)).finite_strain
    quick = Readings(*(np.tile(values, (len(deviates), 1)) for values in vars(pad.readings).values()))
    read = found.judged(quick, deviates)
    np.testing.assert_array_equal(read.depth_mm, quick.depth_mm)
    for name, (middle, spread) in (("peak_N", found.peak), ("energy_mJ", found.energy)):
        factor = getattr(read, name) / getattr(quick, name)
        np.testing.assert_allclose(factor.mean(axis=0), middle, atol=4.0 * spread.max() / np.sqrt(len(factor)))
        inside = np.abs(factor - middle) <= HALF_WIDTH * spread
        assert (inside == inside[:, :1]).all() and inside[:, 0].mean() == pytest.approx(0.95, abs=0.025)
    for name, values in vars(EXACT.judged(quick, deviates)).items():
        np.testing.assert_array_equal(values, getattr(quick, name))


def test_the_deviate_is_its_own_and_known_with_the_force_law(palm):
    castings = Castings(palm[0].resin, seed=77)
    pours = [castings.pours(10.0, 15.3, Tolerances(60.0), 0.1, known) for known in ((), (FORCE_LAW,))]
    drawn, none = (one.finite_strain for one in pours)
    assert abs(drawn.mean()) < 0.1 and drawn.std() == pytest.approx(1.0, abs=0.06) and not none.any()
    others = [castings._drawn["law"], np.log(pours[1].young_MPa), pours[0].thickness_mm, *pours[0].beta.T]
    assert max(abs(np.corrcoef(drawn, one)[0, 1]) for one in others) < 0.1
    # the draws that castings had before: each group's first
    law = np.random.default_rng(77).spawn(3)[2].standard_normal(castings.n)
    np.testing.assert_array_equal(castings._drawn["law"], law)


def test_a_few_deviates_stand_for_a_normal_distribution():
    assert DEVIATES[0] == 0.0 and np.mean(DEVIATES) == pytest.approx(0.0) and np.std(DEVIATES) == pytest.approx(1.0)


def test_castings_and_the_force_law_of_their_budget_hold_it(palm):
    cast = cast_pad(*palm)
    exact = replace(cast, finite_strain=EXACT)
    everything = frozenset(GROUPS)
    alone = cast.readings(everything - {FORCE_LAW}).peak_N / exact.readings(everything - {FORCE_LAW}).peak_N
    np.testing.assert_allclose(alone.std(axis=0), cast.finite_strain.peak[1], rtol=0.06)
    for known in ((), everything):
        ratio = cast.readings(known).peak_N / exact.readings(known).peak_N
        np.testing.assert_allclose(np.nanmean(ratio, axis=0), cast.finite_strain.peak[0], rtol=0.01)
    parts, bare = (
        {one.name: one.standard_percent for one in budget_of_castings(own).components} for own in (cast, exact)
    )
    assert parts["force law"] > bare["force law"]
    assert all(parts[name] == pytest.approx(bare[name], rel=0.02) for name in ("resin relaxation", "making"))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_a_drawn_pad_solved_at_finite_strain_lies_within_what_its_castings_may_read(palm, seed):
    rng, (space, slab_law, _) = np.random.default_rng(9000 + seed), palm
    radius, height, foot = rng.uniform(2.5, 8.0), rng.uniform(2.0, 4.0), 7.8
    kind = f"crowned:radius={radius:.2f},height={height:.2f},foot={foot}", rng.uniform(9.0, 13.0), 15.4
    shape, pad, found = pressed(space, slab_law, *kind)
    number = int(rng.choice(np.flatnonzero(np.isfinite(pad.depth_mm))))
    motion = rise_of(space, pad, number)
    quick, solved = (predict_motion(as_predicted(space, shape, pad), motion, how) for how in ("table", "viscoelastic"))
    ratios = [solved.peak_force_N / quick.peak_force_N]
    ratios.append(
        np.trapezoid(solved.force_N, motion.displacement_mm) / np.trapezoid(quick.force_N, motion.displacement_mm)
    )
    # the solve's elastic force differs from the table's by no more than the table states
    law = law_of_shape(slab_law, shape, pad.thickness_mm)
    error = float(law.relative_error(pad.depth_mm[number], pad.thickness_mm, space.radius_mm))
    for ratio, (middle, spread) in zip(ratios, (found.peak[:, number], found.energy[:, number])):
        assert abs(ratio - middle) <= HALF_WIDTH * spread + error, (kind, number)
