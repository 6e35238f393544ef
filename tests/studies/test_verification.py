"""VERIFICATION.md: its quick checks hold now, and the document shows what they find."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from studies.verification.check import Check
from studies.verification.document import document, run

DOCUMENT = Path(__file__).parents[2] / "VERIFICATION.md"


@pytest.fixture(scope="module")
def checks():
    return run(fast=True)


def test_the_quick_checks_pass(checks):
    failed = [check for check in checks if not check.passed]
    assert not failed
    assert {check.group for check in checks} >= {"Bonded pucks", "Convergence orders", "Relaxation"}


def test_the_document_shows_what_is_found_now(checks):
    if not DOCUMENT.is_file():
        pytest.skip("VERIFICATION.md is not part of this installation")
    lines = [line for line in DOCUMENT.read_text().splitlines() if line.startswith("|")]
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    number = r"[-+]?\d[\d.]*(e[-+]\d+)?"
    found = {row[0]: float(row[2]) for row in rows if len(row) == 7 and re.fullmatch(number, row[2])}
    for check in checks:
        assert found[check.name] == pytest.approx(check.computed, rel=2e-3, abs=1e-6), check.name


def test_the_document_has_no_failed_check():
    if not DOCUMENT.is_file():
        pytest.skip("VERIFICATION.md is not part of this installation")
    text = DOCUMENT.read_text()
    assert re.search(r"^\d+ checks, 0 failed\.$", text, re.MULTILINE)
    assert "FAIL" not in text


@pytest.mark.parametrize(
    ("found", "kind", "passed"),
    [
        (1.001, {}, True),
        (0.98, {}, False),
        (1.02, {}, False),
        (1.5, {"one_sided": True}, True),
        (0.98, {"one_sided": True}, False),
        (1.02, {"absolute": True}, False),
    ],
)
def test_a_check_can_fail_and_then_says_so(found, kind, passed):
    check = Check("group", "name", 1.0, found, 0.01, "source", **kind)
    assert check.passed is passed
    assert ("FAIL" in document([check])) is not passed


@pytest.mark.slow
def test_all_checks_run_and_pass():
    checks = run(fast=False)
    assert [check.name for check in checks if not check.passed] == []
    assert {check.group for check in checks} >= {"Shaped pads"}
