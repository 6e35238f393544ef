"""The light sets: parts of what the package asks for, and enough for what they are for."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LEFT_OUT = (
    "cadquery",
    "OCP",
    "casadi",
    "pyvista",
    "vtk",
    "vtkmodules",
    "trimesh",
    "networkx",
    "lxml",
    "ezdxf",
    "pandas",
    "xarray",
    "nicegui",
    "numba",
)


def lines_of(name):
    lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
    return {line for line in lines if line and not line.startswith("#")}


def whole():
    return set(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"])


def test_the_light_set_is_a_part_of_the_whole_in_the_same_versions():
    assert lines_of("requirements-light.txt") < whole()


def test_the_light_set_with_moulds_lacks_pyvista_alone_and_names_what_cadquery_needs():
    light = lines_of("requirements-mould-light.txt")
    assert {line.split(">")[0] for line in whole() - light} == {"cadquery", "pyvista"}
    assert {line.split(">")[0] for line in light - whole()} == {
        "cadquery-ocp-novtk",
        "multimethod",
        "runtype",
        "pyparsing",
    }


@pytest.mark.slow
def test_solids_need_neither_vtk_nor_solvers_of_assemblies(tmp_path):
    """Where CadQuery's other requirements are not installed, as with the light set with moulds."""
    absent = ("vtk", "vtkmodules", "pyvista", "casadi", "nlopt", "numba", "llvmlite", "trame", "pandas", "nicegui")
    code = f"""
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {absent!r}:
            raise ModuleNotFoundError(f"no {{name}}", name=name)
sys.meta_path.insert(0, Absent())
from dummydesign.mold.cad.kernel import cad_problem, cq
print(cad_problem(), cq.Workplane().box(30, 20, 10).edges().fillet(1).val().Volume() < 6000)
"""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert done.stdout.split() == ["None", "True"], done.stderr


@pytest.mark.slow
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
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
    )
    assert done.returncode == 0, done.stderr
