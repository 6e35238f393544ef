"""A drawn part of the closed world: presses that ``predict`` wrote lack nothing, whatever elastic law pucks showed."""

from __future__ import annotations

import pytest

from benchmarks.accuracy.loop_closed_world import run

SEED, COUNT = 6200, 6


@pytest.mark.slow
@pytest.mark.parametrize("elastic", [False, True])
def test_presses_that_predict_wrote_are_as_designed(elastic, tmp_path, monkeypatch):
    """Two of each kind (slabs, one crown, three crowns); of 100 campaigns one may end otherwise."""
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    rows = [run(number, SEED, tmp_path / f"{number}", elastic) for number in range(COUNT)]
    assert [row.verdict for row in rows].count("none") >= COUNT - 1
    assert sum(row.low_kPa <= row.young_kPa <= row.high_kPa for row in rows) >= COUNT - 1
