"""A pad's record goes with its traces: ``compare`` and ``loop`` tell what was cast."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from dummydesign import cli
from tests.measurement.test_pad_record import RECORD, save
from tests.support.answer_inputs import five_elements, motion, save_trace


@pytest.mark.slow
def test_compare_tells_the_pad_as_cast_and_what_it_missed(tmp_path, capsys):
    traces = []
    for velocity in (10.0, 250.0):
        t, x = motion(velocity, 4.0, 5.0)
        traces.append(str(tmp_path / f"v{velocity:g}.csv"))
        save_trace(tmp_path / f"v{velocity:g}.csv", t, x, five_elements(t, x))
    # Of a crown the thickness is that of its tip, not the mean of its points.
    crown = replace(
        RECORD,
        shape="crowned:21.2,2,9.4",
        thickness_mm=4.58,
        thicknesses_mm=(4.58, 2.5, 2.5, 2.5, 2.5),
        points=("tip", "corner1", "corner2", "corner3", "corner4"),
    )
    record = str(save(tmp_path, crown))
    words = ["compare", *traces, "--tissue", "palm", "--out", str(tmp_path / "c")]
    assert cli.run([*words, "--record", record, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["pad"]["thickness_mm"] == 4.58 and found["inputs"]["record"] == record
    assert "pad_not_accepted" in [one["code"] for one in found["warnings"]]
    read = json.loads((tmp_path / "c/manifest.json").read_text())["files_read"]
    assert "record.json" in [one["file"] for one in read]
    assert "mass 250 g" in (tmp_path / "c/report.html").read_text()
    assert cli.run([*words, "--record", str(tmp_path / "none.json")]) == 2
