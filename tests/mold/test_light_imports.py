"""What is left out while a library is loaded is there again afterwards; the library does its work without it."""

from __future__ import annotations

import subprocess
import sys

import pytest


def _run(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_cadquery_is_loaded_without_vtk_and_vtk_can_be_loaded_afterwards():
    assert _run(
        "import sys\n"
        "from dummydesign.mold.cad.kernel import load_cadquery\n"
        "load_cadquery()\n"
        "assert not any(name.startswith(('vtkmodules', 'casadi', 'nlopt')) for name in sys.modules)\n"
        "import cadquery as cq\n"
        "box = cq.Solid.makeBox(1, 2, 3).cut(cq.Solid.makeCylinder(0.2, 5))\n"
        "import vtkmodules.vtkCommonDataModel as vtk\n"
        "print(round(box.Volume(), 3), vtk.vtkPolyData().GetNumberOfPoints())"
    ).split() == ["5.906", "0"]


def test_trimesh_is_loaded_without_scipy_and_scipy_can_be_loaded_afterwards():
    assert _run(
        "import sys\n"
        "from dummydesign.mold.cad.kernel import load_trimesh\n"
        "load_trimesh()\n"
        "assert 'scipy' not in sys.modules\n"
        "import trimesh, scipy.spatial\n"
        "box = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],"
        " [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])\n"
        "print(box.is_watertight, round(6 * box.volume, 6))"
    ).split() == ["True", "1.0"]
