"""Errors by their code and quantity, so that their sentences may change."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from dummydesign.core.errors import DummydesignError
from studies.errors import CODES


@contextmanager
def raises_code(code: str, quantity: str | None = None) -> Iterator[pytest.ExceptionInfo[DummydesignError]]:
    """Hold that the block ends in an error with the code, and about the quantity where one is given."""
    assert code in CODES
    with pytest.raises(DummydesignError) as caught:
        yield caught
    assert caught.value.code == code, f"{caught.value.code}: {caught.value}"
    assert quantity is None or caught.value.quantity == quantity, f"{caught.value.quantity}: {caught.value}"
