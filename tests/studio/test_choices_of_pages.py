"""What pages offer and keep: pucks among the measured files, and whether what was read has changed since."""

from __future__ import annotations

import json

from dummydesign.core.manifest import sha256_of
from dummydesign.studio.jobs import changed_inputs
from dummydesign.studio.pages.pucks import pucks

HEAD = "time_s,displacement_mm,force_N\n"


def test_pucks_are_imported_presses_and_files_that_are_traces_as_they_are(tmp_path):
    (tmp_path / "measured" / "import-a").mkdir(parents=True)
    texts = {
        "import-a/a_1.csv": HEAD,
        "plain.csv": HEAD,
        "order.csv": "\ufeffforce_N, note,time_s,displacement_mm\n",
        "machine.csv": "Zeit;Weg;Kraft\n",
        "part.csv": "time_s,force_N\n",
    }
    for name, text in texts.items():
        (tmp_path / "measured" / name).write_text(text, encoding="utf-8")
    (tmp_path / "measured" / "binary.csv").write_bytes(b"\xff\xfe\x00")
    assert set(pucks(tmp_path)) == {"measured/import-a/a_1.csv", "measured/plain.csv", "measured/order.csv"}


def test_files_that_changed_or_went_since_they_were_read_are_named(tmp_path):
    read = []
    for name in ("a.csv", "b.csv", "c.csv"):
        (tmp_path / name).write_text(name)
        read.append({"name": name, "file": name, "sha256": sha256_of(tmp_path / name)})
    manifest = tmp_path / "manifest.json"
    manifest.write_text(json.dumps({"files_read": read}))
    assert changed_inputs(tmp_path, manifest) == []
    (tmp_path / "b.csv").write_text("other")
    (tmp_path / "c.csv").unlink()
    assert changed_inputs(tmp_path, manifest) == ["b.csv", "c.csv"]
    assert changed_inputs(tmp_path, tmp_path / "none.json") == []
