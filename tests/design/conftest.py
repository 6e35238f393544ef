"""Fixtures of the design tests."""

import pytest

from tests.support.slab_by_formula import LayerLaw, make_tissue


@pytest.fixture(scope="session")
def layer_law():
    return LayerLaw()


@pytest.fixture(scope="session")
def finger():
    return make_tissue()
