"""Moulds built once per session: the small open and lidded ones in this process, one of each by the child."""

from __future__ import annotations

import pytest

from dummydesign.mold.preset import mould_spec


@pytest.fixture(scope="session")
def open_spec():
    return mould_spec(8.0, 60.0, 50.0, preset="open")


@pytest.fixture(scope="session")
def lidded_spec():
    return mould_spec(8.0, 70.0, 60.0, preset="lidded")


@pytest.fixture(scope="session")
def open_parts(open_spec):
    from dummydesign.mold.build import build

    return build(open_spec)


@pytest.fixture(scope="session")
def lidded_parts(lidded_spec):
    from dummydesign.mold.build import build

    return build(lidded_spec)


@pytest.fixture(scope="session")
def lidded_package(lidded_spec, tmp_path_factory):
    """Folder and result of a lidded mould made by the child process with a hash seed of its own."""
    import os

    from dummydesign.mold.runner import make_mold

    folder = tmp_path_factory.mktemp("lidded")
    before = os.environ.get("PYTHONHASHSEED")
    os.environ["PYTHONHASHSEED"] = "4711"
    try:
        return folder, make_mold(lidded_spec, folder)
    finally:
        os.environ.pop("PYTHONHASHSEED")
        if before is not None:
            os.environ["PYTHONHASHSEED"] = before
