"""The doctor sees what is missing, and only a machine that cannot work fails."""

from __future__ import annotations

import json
import os

import pytest

from dummydesign.api import health
from dummydesign.cli import run


def by_name(found):
    return {check.name: check for check in found.checks}


def test_a_machine_that_runs_these_tests_is_ready(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = health.check_machine(solid=False)
    assert found.ready and by_name(found)["solve"].status == "ok"
    assert by_name(found)["cache"].status == "missing"  # tests solve what they test


def test_a_missing_part_is_told_with_the_command_that_brings_it(monkeypatch):
    version = health._version
    monkeypatch.setattr(health, "_version", lambda name: None if name == "python-calamine" else version(name))
    part = by_name(health.Health(tuple(health._parts()), True))["xlsx"]
    assert part.status == "missing" and "python-calamine" in part.value and "xlsx" in part.advice


@pytest.mark.slow
def test_a_needed_package_that_is_missing_fails(monkeypatch, capsys):
    version = health._version
    monkeypatch.setattr(health, "_version", lambda name: None if name == "scipy" else version(name))
    assert run(["doctor", "--no-cad", "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["error"]["code"] == "machine_unfit" and not answer["ready"]


def test_a_wrong_solve_fails(monkeypatch):
    monkeypatch.setattr(health, "SOLVE_LIMIT", 1e-9)
    assert health._solve().status == "failed"


def test_a_kernel_that_dies_is_a_missing_part(monkeypatch):
    monkeypatch.setattr(health, "SOLID", "import os; os.abort()")
    check = health._solid()
    assert check.status == "missing" and "apt-get" in check.advice


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="rights mean nothing here")
def test_a_folder_without_rights_fails(tmp_path):
    tmp_path.chmod(0o500)
    assert health._writable("x", tmp_path / "new", "advice").status == "failed"


def test_a_folder_that_cannot_be_made_fails(tmp_path):
    (tmp_path / "file").write_text("")
    assert health._writable("x", tmp_path / "file" / "new", "advice").status == "ok"  # the folder above can be used


def test_a_solid_without_its_packages_is_told_what_to_install(monkeypatch):
    reason = "CadQuery is not installed (OCP is missing): pip install cadquery"
    monkeypatch.setattr(health, "SOLID", f"import sys; sys.exit({reason!r})")
    check = health._solid()
    assert (check.status, check.advice) == ("missing", "pip install cadquery")
