"""The example scripts run, and there is one of every call."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
# The whole way with its mould takes minutes; the first command of the README is the same.
LONG = [pytest.mark.slow]
LONG_EXAMPLES = ("suggest_forefinger",)


@pytest.mark.slow
@pytest.mark.parametrize(
    "path", [pytest.param(path, marks=LONG * (path.stem in LONG_EXAMPLES), id=path.stem) for path in EXAMPLES]
)
def test_every_example_runs_and_prints(path, tmp_path):
    environment = {"PYTHONPATH": str(ROOT), "PATH": ""}
    done = subprocess.run([sys.executable, str(path)], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) >= 3 and "nan" not in done.stdout


def test_there_is_an_example_of_every_call():
    text = "".join(path.read_text() for path in EXAMPLES)
    assert all(f"dummydesign.{name}(" in text for name in ("suggest", "whatif", "fit"))
