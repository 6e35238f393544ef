"""The list of studies is complete, and every command that a file or page names is on it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from dummydesign.pad.pad_under_punch import Pad
from studies.data_files import FOLDER, PAGE, origins, page
from studies.registry import DATA_FILES, PACKAGE, STUDIES
from studies.tables.common import Build, sources_hash, write_table

ROOT = Path(__file__).parents[2]
NAMED = re.compile(rf"python -m ({re.escape(PACKAGE)}(?:\.\w+)+)")


def test_every_shipped_table_is_made_by_exactly_one_study():
    made = [file for study in STUDIES for file in study.files if file.startswith("materials/tables/")]
    shipped = [f"materials/tables/{path.name}" for path in (ROOT / "materials" / "tables").glob("*.json")]
    assert sorted(made) == sorted(shipped)


def test_every_file_that_a_study_makes_is_there():
    missing = [file for study in STUDIES for file in study.files if not (ROOT / file).is_file()]
    assert missing == []


def test_every_data_file_is_there_and_listed_once_with_its_origin():
    listed = [file.removeprefix(FOLDER) for study in STUDIES for file in study.files if file.startswith(FOLDER)]
    listed = [name for name in listed if name.endswith(".csv")] + [one.name for one in DATA_FILES]
    assert sorted(listed) == sorted(path.name for path in (ROOT / FOLDER).glob("*.csv"))
    assert all(one.command or "by hand" in one.origin for one in DATA_FILES)
    assert (ROOT / PAGE).read_text(encoding="utf-8") == page()


@pytest.mark.parametrize("name", [name for name, (command, _) in origins().items() if command])
def test_the_command_of_a_data_file_is_a_program_of_the_repository(name):
    words = origins()[name][0].split()
    path = words[1] if words[1] != "-m" else words[2].replace(".", "/") + ".py"
    assert words[0] == "python" and (ROOT / path).is_file()


@pytest.mark.parametrize("module", sorted({study.module for study in STUDIES}))
def test_a_study_can_be_run_as_a_module(module):
    found = find_spec(f"{PACKAGE}.{module}")
    assert found is not None
    source = Path(found.origin or "")
    main = source.parent / "__main__.py" if source.name == "__init__.py" else source
    assert '__name__ == "__main__"' in main.read_text(encoding="utf-8")


def test_every_command_that_a_page_or_a_data_file_names_is_a_study():
    modules = {f"{PACKAGE}.{study.module}" for study in STUDIES}
    pages = [ROOT / "README.md", ROOT / "VERIFICATION.md", *(ROOT / "docs").glob("*.md")]
    pages += [path for path in (ROOT / "materials").rglob("*") if path.suffix in (".toml", ".json")]
    named = {(path.name, found) for path in pages for found in NAMED.findall(path.read_text(encoding="utf-8"))}
    assert len(named) > 10
    assert {(page, command) for page, command in named if command not in modules} == set()


def test_the_list_is_printed_with_what_each_makes():
    done = subprocess.run([sys.executable, "-m", PACKAGE], capture_output=True, text=True, cwd=ROOT, check=True)
    for study in STUDIES:
        assert f"{study.command} " in done.stdout and study.makes in done.stdout


def test_a_table_says_how_it_was_made(tmp_path):
    build = Build.begin(f"{PACKAGE}.tables.slab", ["--base", "bonded", "--out", "a folder"])
    write_table(tmp_path / "t.json", {"values": [1.0], "provenance": {"law": "neo-Hookean"}}, build, seed=4)
    said = json.loads((tmp_path / "t.json").read_text())["provenance"]
    assert said["command"] == f"python -m {PACKAGE}.tables.slab --base bonded --out 'a folder'"
    assert said["law"] == "neo-Hookean" and said["seed"] == 4 and said["sources"] == sources_hash()
    assert set(said) >= {"version", "libraries", "seconds", "date"}


@pytest.mark.slow
def test_one_row_of_the_tables_of_pucks_is_found_again():
    from dummydesign.pad.tables.puck import load_shapes
    from studies.tables.puck import build

    table = load_shapes()[0]
    alpha, friction = float(table.alpha[1]), 0.3
    again = build(table.radius_over_height, [alpha], [friction])
    shallow = again.compression <= 0.3
    # one law and one friction are no grid to interpolate in: the row itself
    found = again.log_factor[0, 1, shallow]
    stored = np.log(table.factor(alpha, float(again.grip[1]), again.compression[shallow]))
    assert np.max(np.abs(found - stored)) < 0.005


@pytest.mark.slow
def test_one_value_of_the_error_of_the_quick_prediction_is_found_again():
    from studies.tables.separability import measure_single

    rows = json.loads((ROOT / "materials" / "tables" / "quick-error.json").read_text())["single"]
    row = next(r for r in rows if (r["base"], r["thickness_mm"], r["relative_depth"]) == ("bonded", 10.0, 0.2))
    again = measure_single("bonded", 10.0, 0.2, row["rise_over_tau"])
    assert again["error_at_peak"] == pytest.approx(row["error_at_peak"], abs=0.002)


@pytest.mark.slow
def test_one_row_of_the_table_of_compressible_slabs_is_found_again():
    from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
    from dummydesign.pad.tables.slab import load_compressibility

    table, ratio, depths = load_compressibility(), 0.79, np.array([0.1, 0.2])
    pads = (Pad(1.0, 1.0, ratio, poisson=p, extent_mm=ratio + 8.0) for p in (0.48, 0.5))
    soft, hard = (solve_curve(pad, depths, independent=True) for pad in pads)
    found = (np.asarray(hard.force_N) / np.asarray(soft.force_N) - 1.0) / 0.04
    stored = table.coefficient(depths[:, None], np.full((2, 1), ratio))[:, 0]
    assert found == pytest.approx(stored, rel=0.03)


@pytest.mark.parametrize("name", ["pad-sharp-error", "pad-square", "pad-quick-error"])
def test_figures_that_are_read_from_tables_are_those_of_the_tables(name):
    from studies.pad_figures import text_of

    assert (ROOT / FOLDER / f"{name}.csv").read_text(encoding="utf-8") == text_of(name)
