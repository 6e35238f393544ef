"""Readers of traces, motions and campaigns: whatever a file holds, the answer is data or a named fault."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dummydesign.core.errors import DummydesignError
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.measurement.trace import read_motion, read_trace

MANY = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
TIME = np.linspace(0.0, 2.0, 40)
ROWS = "\n".join(f"{t:.3f},{min(t, 1.0):.4f},{2.0 * min(t, 1.0):.4f}" for t in TIME)
TRACE = f"time_s,displacement_mm,force_N\n{ROWS}\n"
CAMPAIGN = (
    'schema = 1\n[pad]\nyoung_kPa_nominal = 25.0\n[punch]\nshape = "square"\nside_mm = 14.0\n'
    "[sensor]\nlowpass_hz = 35.0\n"
    '[[trial]]\nfile = "a.csv"\nthickness_mm = 5.0\nvelocity_mm_s = 1.0\n'
    '[[trial]]\nfile = "b.csv"\nthickness_mm = 5.0\nvelocity_mm_s = 1.0\n'
)
PIECES = st.one_of(
    st.sampled_from(["", "nan", "inf", "-1", "1e400", '"', "'", "[", "]]", "=", "\0", "\ufeff", "é", "0x10", "1_000"]),
    st.text(max_size=6),
)


@st.composite
def damaged(draw: st.DrawFn, text: str) -> bytes:
    """A text with some stretches replaced, cut or doubled, in some encoding."""
    for _ in range(draw(st.integers(1, 4))):
        begin = draw(st.integers(0, len(text)))
        end = draw(st.integers(begin, min(begin + 30, len(text))))
        text = text[:begin] + draw(PIECES) * draw(st.integers(0, 2)) + text[end:]
    raw = text.encode(draw(st.sampled_from(["utf-8", "utf-16", "latin-1"])), errors="replace")
    return raw[: draw(st.integers(0, len(raw)))] if draw(st.booleans()) else raw


@pytest.mark.parametrize(
    "read", [pytest.param(read_trace, marks=pytest.mark.slow), read_motion], ids=["trace", "motion"]
)
@MANY
@given(raw=damaged(TRACE))
def test_a_damaged_table_is_read_or_refused_by_name(tmp_path: Path, read, raw):
    path = tmp_path / "t.csv"
    path.write_bytes(raw)
    try:
        found = read(path)
    except DummydesignError as problem:
        assert "t.csv" in str(problem)
    else:
        assert np.all(np.diff(found.time_s) > 0) and np.all(np.isfinite(found.displacement_mm))


@MANY
@given(raw=damaged(CAMPAIGN))
def test_a_damaged_campaign_is_read_or_refused_by_name(tmp_path: Path, raw):
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text(TRACE)
    (tmp_path / "campaign.toml").write_bytes(raw)
    try:
        assert len(read_campaign(tmp_path).trials) >= 2
    except DummydesignError as problem:
        assert str(problem)


def test_the_undamaged_files_are_read(tmp_path):
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text(TRACE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    assert len(read_campaign(tmp_path).trials) == 2
    assert read_trace(tmp_path / "a.csv").time_s == pytest.approx(TIME, abs=1e-3)
