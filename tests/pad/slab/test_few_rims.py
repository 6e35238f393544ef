"""Slabs that the response table covers: three rims with the table's correction against six that know nothing of it."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.design.suggest import verify_design
from dummydesign.pad.axisymmetric import sharp_edge
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.sharp_edge import Samples, fit_departure, solve_curve
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import load_edge_correction, load_table


def rimmed(ratio: float, departure: np.ndarray, depth: np.ndarray, base: str = "bonded") -> Samples:
    """Values that the table's own correction carries to the table's sharp edge, times a departure."""
    table = load_table(base)
    rims = np.repeat(sharp_edge.RIMS_BY_TABLE, len(depth))
    depth, departure = np.tile(depth, 3), np.tile(departure, 3)
    samples = Samples(depth, np.full(len(depth), ratio), rims, np.ones(len(depth)))
    correction = sharp_edge._correction(samples, table.ratio_range) @ load_edge_correction(base)
    value = np.exp(table.log(depth, ratio) + departure - correction)
    return Samples(depth, samples.ratio, rims, value)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_a_departure_from_the_table_is_found(base):
    """Half a per cent at first touch, and as much less at d/h 0.5; nothing of it is drawn back to the table."""
    depth, table = np.linspace(0.1, 0.5, 12), load_table(base)
    departure = 0.005 * (1.0 - depth / 0.5)
    first = float(np.exp(table.log(0.0, 0.6) + 0.005))
    found = fit_departure(rimmed(0.6, departure, depth, base), first, table)
    off = found.log_stiffness(depth, np.array(0.6)) - table.log(depth, 0.6) - departure
    assert np.abs(off).max() < 3e-4


def test_values_that_go_up_and_down_by_half_a_per_cent_are_not_followed_as_a_departure():
    """Three depths, three terms: without the weak preference for small, smooth departures all would be met."""
    depth, table, wave = np.array([0.2, 0.35, 0.5]), load_table(), 0.005 * np.array([1.0, -1.0, 1.0])
    first = float(np.exp(table.log(0.0, 0.6)))
    found = fit_departure(rimmed(0.6, wave, depth), first, table)
    followed = (found.log_stiffness(depth, np.array(0.6)) - table.log(depth, 0.6)) / wave
    assert np.all(np.abs(followed[:2]) < 0.5) and 0.5 < followed[2] < 1.0


def test_rims_that_disagree_are_stated_as_error():
    depth, table = np.linspace(0.1, 0.5, 12), load_table()
    samples = rimmed(0.6, np.zeros(12), depth)
    first = float(np.exp(table.log(0.0, 0.6)))
    apart = samples.stiffness * np.where(samples.rim == samples.rim.max(), 1.02, 1.0)
    torn = Samples(samples.depth, samples.ratio, samples.rim, apart)
    whole, doubted = (fit_departure(one, first, table).error(np.array([0.4]), 0.6)[0] for one in (samples, torn))
    assert whole == pytest.approx(float(table.solved_error(0.4, 1.0, 0.6)), abs=1e-4)
    assert doubted > whole + 2e-3


@pytest.mark.parametrize(
    "change",
    [{"radius": 2.0}, {"extent": 3.0}, {"poisson": 0.49}, {"law": Yeoh(1.0, 0.1)}, {"condition": "frictionless"}],
)
def test_what_the_table_does_not_cover_is_solved_without_it(change):
    case = {"radius": 0.8, "extent": 7.5}
    if "radius" in change:
        change = change | {"extent": 20.0}
    assert sharp_edge._table_of(Case(**case), np.array([0.3])) is not None
    assert sharp_edge._table_of(Case(**(case | change)), np.array([0.3])) is None


def test_a_design_is_verified_without_the_table(monkeypatch):
    asked = []

    def watched(case, depths, table):
        asked.append(table)
        return {"stiffness": np.ones(len(depths)), "error": depths, "own": depths, "solver": {}, "notes": ()}

    monkeypatch.setenv("DUMMYDESIGN_CACHE", "off")
    monkeypatch.setattr(sharp_edge, "_relative_curve", watched)
    verify_design(Pad(10.0, 0.03, 7.9), [1.0, 2.0], [1.0, 2.0])
    solve_curve(Pad(10.0, 0.03, 7.9), [1.0, 2.0])
    assert asked[0] is None
    assert asked[1] is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "extent", "base"), [(0.31, 9.0, "bonded"), (0.62, 14.0, "sliding"), (1.2, 7.0, "bonded")]
)
def test_three_rims_agree_with_six_within_the_error_they_state(ratio, extent, base):
    pad, depth = Pad(1.0, 1.0, ratio, base=base, extent_mm=extent * ratio), np.linspace(0.1, 0.5, 5)
    few, six = (solve_curve(pad, depth, independent=alone) for alone in (False, True))
    assert len(few.force_N) == len(six.force_N) == 5
    assert np.all(np.abs(few.force_N / six.force_N - 1.0) < few.error_N / few.force_N)
    assert few.solver["newton_iterations"] < 0.7 * six.solver["newton_iterations"]
