"""Shares in per cent."""

from __future__ import annotations

import pytest

from dummydesign.core.serialise import percent_below_limit


@pytest.mark.parametrize(
    ("share", "limit", "text"),
    [
        (0.9475, 0.95, "94.7 %"),
        (0.94999, 0.95, "94.9 %"),
        (0.95, 0.95, "95 %"),
        (0.3, 0.95, "30 %"),
        (0.9475, None, "95 %"),
        (1.0, 0.95, "100 %"),
    ],
)
def test_a_share_below_its_limit_is_not_rounded_up_to_it(share, limit, text):
    assert percent_below_limit(share, limit) == text
