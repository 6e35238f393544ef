"""The light set: part of what the package asks for, and enough for what needs no CAD."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LEFT_OUT = ("cadquery", "OCP", "casadi", "pyvista", "vtk", "vtkmodules", "trimesh", "networkx", "lxml", "ezdxf",
            "pandas", "xarray", "nicegui", "numba", "PIL")  # fmt: skip


def test_the_light_set_is_a_part_of_the_whole_in_the_same_versions():
    whole = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    lines = (ROOT / "requirements-light.txt").read_text(encoding="utf-8").splitlines()
    light = {line for line in lines if line and not line.startswith("#")}
    assert light < set(whole)


@pytest.mark.parametrize(
    "words",
    [
        ["suggest", "--tissue", "forefinger", "--shape", "crowned", "--no-cad", "--no-verify", "--out", "a"],
        ["whatif", "--thickness", "5,10", "--ratio", "15", "--out", "b"],
        ["campaign", "new", "c", "--young", "25", "--no-power"],
    ],
)
def test_commands_without_solids_run_on_the_light_set(words, tmp_path):
    code = f"import sys\nfor name in {LEFT_OUT!r}:\n    sys.modules[name] = None\n"
    code += f"from dummydesign.cli import run\nsys.exit(run({words!r}))"
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": path})  # fmt: skip
    assert done.returncode == 0, done.stderr
