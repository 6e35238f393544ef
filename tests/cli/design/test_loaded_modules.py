"""What a quick suggestion of a slab loads of the package: nothing that it does not run."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
MOST = 150
ABSENT = (
    "loop",
    "pad.axisymmetric",
    "pad.spatial",
    "pad.fields",
    "pad.fem",
    "pad.contact",
    "pad.solve",
    "pad.tables.shape",
    "pad.tables.crowned",
    "mold.cad",
    "mold.checks",
    "mold.produce",
    "core.cache",
    "design.search.fe_candidates",
    "design.calibrated",
)
WORDS = ["suggest", "--tissue", "forefinger", "--shape", "slab", "--no-cad", "--no-verify", "--out", "slab"]


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    code = (
        f"import json, sys\nfrom dummydesign.cli import run\nrun({WORDS!r})\n"
        "print(json.dumps([name for name in sys.modules if name.partition('.')[0] == 'dummydesign']))"
    )
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    env = {**os.environ, "PYTHONPATH": path}
    folder = tmp_path_factory.mktemp("slab")
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, env=env, capture_output=True, text=True, check=True)
    assert (folder / "slab" / "report.html").is_file()
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
def test_a_suggestion_of_a_slab_loads_few_modules(loaded):
    assert len(loaded) <= MOST, "\n".join(sorted(loaded))


@pytest.mark.slow
@pytest.mark.parametrize("room", ABSENT)
def test_what_a_slab_does_not_need_is_not_loaded(loaded, room):
    assert not [name for name in loaded if f"{name}.".startswith(f"dummydesign.{room}.")]
