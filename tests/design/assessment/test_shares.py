"""Shares of one pad's castings: exclusive, of one set of draws, and as the windows of the search foresee them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from dummydesign.design.assessment.pad_castings import PadCastings, shares_of_pad, verdict_of_design
from dummydesign.design.pad_evaluator import cast_pad, law_of_shape
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.castings import FORCE_LAW, MAKING, RELAXATION, Castings
from dummydesign.design.scoring.crowns import finite_strain_of
from dummydesign.design.scoring.outlook import Match
from dummydesign.design.scoring.verdict import CLASSES, classes, deviations, ranges_of
from dummydesign.design.search.shape_search import candidate_of, outlook_for, search_shapes
from dummydesign.design.suggest import design
from dummydesign.geometry.shape_registry import read_shape

CROWN, THICKNESS_MM, YOUNG_MPA = "crowned:radius=2.4,height=3.5,foot=7.8", 11.0, 0.034
"""A pad for the palm of which about half of the castings are usable as poured."""


def cast_of(castings=None, aim="average"):
    """The castings of the palm's pad, from its table."""
    problem = read_problem(Request("palm", aim=aim, shape=CROWN, verify=False))
    space = problem
    if castings is not None:
        space = dataclasses.replace(problem, castings=Castings(problem.resin, seed=castings))
    law = law_of_shape(problem.slab_law, read_shape(CROWN), THICKNESS_MM)
    outlook = outlook_for(law, read_shape(CROWN), THICKNESS_MM, Match(np.log(YOUNG_MPA), 0.1), space, space.castings.n)
    candidate = candidate_of(law, THICKNESS_MM, outlook.ratio, space)
    tolerances = space.tolerances(read_shape(CROWN), THICKNESS_MM, outlook.ratio)
    strain = finite_strain_of(candidate.alone, read_shape(CROWN), space.base, space.targets, space.radius_mm)
    return PadCastings(space.castings, law, candidate, space, tolerances, outlook, strain)


@pytest.fixture(scope="module")
def cast():
    return cast_of()


@pytest.fixture(scope="module")
def shares(cast):
    return shares_of_pad(cast)


def test_shares_are_exclusive_and_sum_to_one(cast, shares):
    count = cast.castings.n
    for share in (shares.as_poured, shares.resin_known, shares.after_puck):
        values = [getattr(share, name) for name in CLASSES]
        assert share.usable == share.stands_for + share.with_correction == share.to_dict()["usable"]
        assert sum(values) == pytest.approx(1.0, abs=1e-12) and min(values) >= 0.0
        np.testing.assert_allclose(np.array(values) * count, np.rint(np.array(values) * count), atol=1e-6)
        assert share.standard_error == pytest.approx(np.sqrt(share.usable * (1.0 - share.usable) / count))


def test_the_windows_foresee_what_the_castings_do_within_three_points(cast, shares):
    outlook = cast.outlook
    for foreseen, share in (
        (outlook.as_poured, shares.as_poured),
        (outlook.known, shares.resin_known),
        (outlook.after_puck, shares.after_puck),
    ):
        assert foreseen == pytest.approx(share.usable, abs=0.03)
    assert outlook.stands == pytest.approx(shares.as_poured.stands_for, abs=0.03)


def test_knowing_more_never_costs_usable_castings(shares):
    assert shares.as_poured.usable < shares.after_puck.usable <= shares.resin_known.usable + 0.02
    low, high = shares.after_puck.ratio
    assert low <= shares.as_poured.ratio <= high and low < high
    assert 0.0 <= shares.after_puck.no_ratio <= 1.0 - shares.after_puck.usable + 0.03
    assert (shares.after_puck.no_ratio_reason is None) == (shares.after_puck.no_ratio == 0.0)


def test_the_factor_after_a_puck_suffices_for_95_of_100_castings_and_that_of_the_resin_s_centre_does_not(cast, shares):
    ranges, after = ranges_of(cast.space.targets), cast.after_puck
    forces = np.hstack([ranges.peak_low_N / after.peak_N, (after.depth_mm / ranges.soft_mm) ** ranges.power])
    needed = forces.max(axis=-1), np.hstack([forces, ranges.energy_low_mJ / after.energy_mJ]).max(axis=-1)
    reach = np.isfinite(needed[1])
    centre = verdict_of_design(cast).correction
    for every, factor, other in zip(
        needed,
        (shares.after_puck.force_factor, shares.after_puck.factor),
        (centre.force_after_measuring, centre.factor_after_measuring),
    ):
        assert (every[reach] <= factor * (1.0 + 1e-12)).mean() == pytest.approx(0.95, abs=0.002)
        assert (every[reach] <= other).mean() < 0.85 and factor > other


def test_the_window_is_about_the_modulus_that_is_poured(cast, shares):
    low, high = shares.window_kPa
    wanted = 1e3 * float(cast.space.resin.young_MPa(shares.resin_known.ratio))
    assert low < wanted < high


def test_the_window_holds_the_batches_of_this_ratio_that_are_usable(cast, shares):
    """All else known, a batch is usable if and only if its modulus is in the window."""
    low, high = shares.window_kPa
    young = 1e3 * cast.castings.batches.young_MPa(shares.as_poured.ratio)
    targets = cast.space.targets
    read = cast.readings((MAKING, FORCE_LAW, RELAXATION))
    usable = np.isin(classes(deviations(ranges_of(targets), read), targets.limits), (0, 1))
    # a modulus may lie between two steps of half a percent
    near = np.minimum(np.abs(np.log(young / low)), np.abs(np.log(young / high))) < 0.006
    inside = (young >= low) & (young <= high)
    assert (usable == inside)[~near].all() and 0.005 < 1.0 - inside.mean() < 0.5


@pytest.mark.slow
def test_castings_of_an_answer_are_the_shares_as_poured():
    answer = design(read_problem(Request("forefinger", shape="slab", thickness_mm=(5.0, 6.0), verify=False)))
    told = answer.to_dict()
    for name in CLASSES:
        assert told["shares"]["as_poured"][name] == answer.verdict.castings[name]
    assert told["shares"]["as_poured"]["n"] == answer.castings.castings.n and "window_kPa" not in told["shares"]
    assert told["window_kPa"] == (None if answer.shares.window_kPa is None else list(answer.shares.window_kPa))
    assert told["recommendation"]["ratio"] == told["shares"]["as_poured"]["ratio"]


MOVED = ("stands_shortfall", "stands_over", "stands_inside", "shortfall", "over", "share")


def settled(problem, castings=None, limits=None):
    """Shares of the pad that is chosen by its tables."""
    if castings is not None:
        problem = dataclasses.replace(problem, castings=Castings(problem.resin, seed=castings))
    if limits is not None:
        problem = dataclasses.replace(problem, targets=dataclasses.replace(problem.targets, limits=limits))
    chosen = search_shapes("crowned", problem.slab_law, problem)[0][0]
    found = shares_of_pad(cast_pad(problem, chosen))
    return {
        "pad": (str(chosen.shape), chosen.thickness_mm),
        "as_poured": found.as_poured.usable,
        "resin_known": found.resin_known.usable,
        "after_puck": found.after_puck.usable,
    }


# Of palm's pad one limit moved by 1 % moves a share by 3.4 to 3.7 points, and another pad wins: not met yet.
NOT_MET = pytest.mark.xfail(reason="palm: 3.7 points instead of 2; thenar not measured to the end", strict=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    "tissue", ["forefinger", pytest.param("palm", marks=NOT_MET), pytest.param("thenar", marks=NOT_MET)]
)
def test_limits_moved_by_one_per_cent_and_another_seed_move_no_share_of_the_chosen_pad_by_more_than_two_points(tissue):
    problem = read_problem(Request(tissue, shape="crowned", verify=False))
    problem = dataclasses.replace(problem, castings=Castings(problem.resin, 4800))
    limits, first = problem.targets.limits, settled(problem)
    rows = {f"seed {seed}": settled(problem, seed) for seed in (101, 202)}
    for name in MOVED:
        for factor in (0.99, 1.01):
            if name in ("stands_shortfall",) and factor < 1.0:
                continue
            rows[f"{name} x {factor}"] = settled(problem, limits=limits.moved(name, factor))
    far = {}
    for what, row in rows.items():
        moved = {name: round(row[name] - first[name], 3) for name in ("as_poured", "resin_known", "after_puck")}
        if max(abs(value) for value in moved.values()) > 0.02:
            far[what] = (row["pad"], moved)
    assert not far, (first, far)
