"""The examples in docstrings are run, and the main functions have one.

They call the package as a user would, in an empty folder, and load no CAD, no finite elements and no plots.
"""

from __future__ import annotations

import doctest
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import dummydesign

PACKAGE = Path(dummydesign.__file__).parent
WITH_EXAMPLES = sorted(
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
    for path in PACKAGE.rglob("*.py")
    if ">>> " in path.read_text(encoding="utf-8")
)
MAIN = (
    "api.designs.suggest",
    "api.designs.whatif",
    "api.predictions.predict",
    "api.traces.fit",
    "api.moulds.make_mould",
    "geometry.interface.Interface.parse",
    "geometry.pad_shape.PadShape",
    "geometry.shape_registry.read_shape",
    "inference.least_squares.profile_interval",
    "inference.noise.cut",
    "pad.force_law.ForceLaw",
    "pad.tables.slab.load_table",
    "resin.model.resin_file.load_resin",
    "tissue.load_tissue",
    "tissue.model.maxwell_law.Parameters.force",
)
HEAVY = ("cadquery", "matplotlib", "pandas", "pyvista", "skfem", "trimesh")


RUN = """
import doctest, importlib, json, sys
told, tried = {}, []
for name in sys.argv[1:]:
    told[name] = []
    for test in doctest.DocTestFinder().find(importlib.import_module(name)):
        if test.examples:
            tried.append(test.name)
            doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=told[name].append)
print(json.dumps({"told": {name: "".join(text) for name, text in told.items()}, "tried": tried,
                  "loaded": sorted(name for name in sys.modules if "." not in name)}))
"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """What a fresh interpreter in an empty folder says of all examples, and what it has loaded."""
    folder = tmp_path_factory.mktemp("examples")
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run(
        [sys.executable, "-c", RUN, *WITH_EXAMPLES], capture_output=True, text=True, cwd=folder, env=environment
    )
    assert done.returncode == 0, done.stderr
    return {**json.loads(done.stdout), "left": [path.name for path in folder.iterdir()]}


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_examples_give_what_they_say(name, ran):
    assert ran["told"][name] == ""


@pytest.mark.slow
def test_the_main_functions_have_an_example(ran):
    assert {f"dummydesign.{name}" for name in MAIN} <= set(ran["tried"])


@pytest.mark.slow
def test_examples_load_no_cad_no_finite_elements_and_no_plots_and_leave_nothing(ran):
    assert [name for name in HEAVY if name in ran["loaded"]] == []
    assert ran["left"] == []


def test_an_example_that_is_wrong_is_told():
    test = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, None)
    told: list[str] = []
    doctest.DocTestRunner().run(test, out=told.append)
    assert "Expected:" in "".join(told)
