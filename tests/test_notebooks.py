"""The notebooks of examples/ run from top to bottom, with the answers of the commands; outputs are not kept."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import dummydesign

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))
RUN = """
import sys, nbformat
from nbclient import NotebookClient
book = nbformat.read(sys.argv[1], 4)
NotebookClient(book, timeout=None, kernel_name="python3").execute()
nbformat.write(book, "ran.ipynb")
"""


def cells(path):
    return [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


def test_there_are_three_and_none_keeps_an_output():
    assert [path.stem for path in NOTEBOOKS] == ["campaign_plan", "design", "loop"]
    for path in NOTEBOOKS:
        assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells(path)), path.name


def ran(name, folder):
    """Run a notebook in a copy of the folder; return the text of each cell's outputs."""
    pytest.importorskip("nbclient", reason="no nbclient here: pip install nbclient ipykernel")
    shutil.copytree(ROOT / "examples", folder / "examples")
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, "-c", RUN, f"{name}.ipynb"],
        cwd=folder / "examples",
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path, "DUMMYDESIGN_HOME": str(folder / "home")},
    )
    assert done.returncode == 0, done.stderr[-3000:]
    texts = []
    for cell in cells(folder / "examples" / "ran.ipynb"):
        parts = [one.get("text") or one.get("data", {}).get("text/plain", "") for one in cell["outputs"]]
        texts.append("".join("".join(part) for part in parts))
    return texts


@pytest.mark.slow
def test_the_design_notebook_gives_the_slab_of_the_command(tmp_path):
    texts = ran("design", tmp_path)
    best = dummydesign.suggest("forefinger", shape="slab", verify=False).recommendation
    wanted = f"({best['thickness_mm']},{best['ratio']},[{{'name':'polyol','mass_g':"
    assert "".join(texts[3].split()).startswith(wanted)
    assert len(texts[1]) < 3000 and "score.total" in texts[6]


@pytest.mark.slow
def test_the_plan_notebook_plans_sixteen_presses(tmp_path):
    texts = ran("campaign_plan", tmp_path)
    assert texts[3] == "(16, [])"
    assert (tmp_path / "examples" / "my-dummy" / "sheet.html").is_file()


@pytest.mark.slow
def test_the_loop_notebook_finds_that_its_campaign_misses_nothing(tmp_path):
    """The example campaign is simulated by the base model."""
    texts = ran("loop", tmp_path)
    assert texts[0].startswith("Nothing is missing") and texts[1] == "{}"
    before, after, floor = (float(word) for word in texts[2].strip("()").split(","))
    assert after == before < 1.3 * floor
    assert (tmp_path / "examples" / "loop" / "calibration.json").is_file()
