"""FreeCAD, a program of its own with an older kernel, reads every part of all five shapes as it was written."""

from __future__ import annotations

import os
import re
import shutil
import subprocess

import pytest

from dummydesign.mold.checks.files import check_second_reader
from dummydesign.mold.files.step import step_text
from tests.support.mould_checks import shape_spec

FREECAD = next((found for name in ("freecadcmd", "FreeCADCmd") if (found := shutil.which(name))), None)
SHAPES = (
    ("slab", 5.0, "lidded"),
    ("crowned:12,2.4", 8.0, "printed"),
    ("layered:4,0.4", 8.0, "open"),
    ("boned:20,3", 12.5, "open"),
)
READ = """
import Part
for line in open({listed!r}):
    shape = Part.Shape()
    shape.read(line.strip())
    print("READ", line.strip(), len(shape.Solids), shape.isValid(), "%.12g" % shape.Volume)
"""


@pytest.mark.slow
@pytest.mark.skipif(FREECAD is None, reason="FreeCAD is not installed (Debian: apt-get install freecad-python3)")
@pytest.mark.parametrize("shape, thickness_mm, preset", SHAPES)
def test_freecad_reads_every_part_as_one_valid_solid_of_its_volume(shape, thickness_mm, preset, tmp_path):
    from dummydesign.mold.cad.build import build

    made = build(shape_spec(shape, thickness_mm, preset=preset))
    parts = made.parts
    for name, part in parts.items():
        (tmp_path / f"{name}.step").write_text(step_text([part], name, "test"), encoding="ascii")
    listed = tmp_path / "listed.txt"
    listed.write_text("\n".join(str(tmp_path / f"{name}.step") for name in parts))
    script = tmp_path / "read.py"
    script.write_text(READ.format(listed=str(listed)))
    environment = {**os.environ, "HOME": str(tmp_path), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run([FREECAD, str(script)], capture_output=True, text=True, env=environment, timeout=600)
    rows = re.findall(r"READ \S*?([a-z_]+)\.step (\d+) (\w+) (\S+)", done.stdout)
    assert {name for name, *_ in rows} == set(parts), done.stdout + done.stderr
    for name, solids, valid, volume in rows:
        assert (solids, valid) == ("1", "True"), name
        assert float(volume) == pytest.approx(parts[name].volume_mm3, rel=1e-6), name
    assembly = tmp_path / "assembly.step"
    assembly.write_text(step_text(list(parts.values()), "assembly", "test"), encoding="ascii")
    found = check_second_reader(assembly, sum(part.volume_mm3 for part in parts.values()), len(parts))
    assert found.status == "pass" and found.note.startswith("FreeCAD")
