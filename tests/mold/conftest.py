"""Moulds built once per session: the small open and lidded ones in this process, one of each by the child."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import dummydesign
from dummydesign.mold.model.preset import mould_spec
from tests.support.mould_checks import shape_spec


@pytest.fixture(scope="session")
def open_spec():
    return mould_spec(8.0, 60.0, 50.0, preset="open")


@pytest.fixture(scope="session")
def lidded_spec():
    return mould_spec(8.0, 70.0, 60.0, preset="lidded")


@pytest.fixture(scope="session")
def open_parts(open_spec):
    from dummydesign.mold.cad.build import build

    return build(open_spec)


@pytest.fixture(scope="session")
def lidded_parts(lidded_spec):
    from dummydesign.mold.cad.build import build

    return build(lidded_spec)


@pytest.fixture(scope="session")
def lidded_package(lidded_spec, tmp_path_factory):
    """Folder and answer of the command for the lidded mould, run as a user would, with a hash seed of its own."""
    pad = lidded_spec.pad
    size = ["--thickness", f"{pad.thickness_mm:g}", "--length", f"{pad.length_mm:g}", "--width", f"{pad.width_mm:g}"]
    folder = tmp_path_factory.mktemp("lidded")
    command = [sys.executable, "-m", "dummydesign", "mold", *size, "--preset", "lidded", "--out", str(folder), "--json"]
    root = str(Path(dummydesign.__file__).parents[1])
    environment = {**os.environ, "PYTHONHASHSEED": "4711", "PYTHONPATH": root}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=folder)
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    return folder, SimpleNamespace(answer=answer, **answer)


@pytest.fixture(scope="session")
def crowned():
    from dummydesign.mold.cad.build import build

    return build(shape_spec("crowned:3,8,9", 15.0))


@pytest.fixture(scope="session")
def layered():
    from dummydesign.mold.cad.build import build

    return build(shape_spec("layered:3,0.4", 8.0))


@pytest.fixture(scope="session")
def boned():
    from dummydesign.mold.cad.build import build

    return build(shape_spec("boned:20,6", 15.0))
