"""The limits of the verdict come from one file that a reader can change, and a damaged file is refused in one line."""

import re

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.user_library import data_folder
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.press_simulation import make_curves
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import verdict
from tests.support.judged_pads import away, ranges
from tests.support.refusal import raises_code

BUILT_IN = (data_folder() / "materials" / "verdict.toml").read_text()


@pytest.fixture
def own_file(tmp_path, monkeypatch):
    """Writes a file of limits into a user's own folder."""
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    (tmp_path / "materials").mkdir()

    def write(text):
        (tmp_path / "materials" / "verdict.toml").write_text(text)

    return write


def changed(table, old, new):
    """The built-in file with one entry of a table changed."""
    start = BUILT_IN.index(f"[{table}]")
    assert old in BUILT_IN[start:]
    return BUILT_IN[:start] + BUILT_IN[start:].replace(old, new, 1)


def line_of_table(text, table):
    return text.splitlines().index(f"[{table}]") + 1


def test_the_built_in_limits_are_those_of_the_rule():
    found = verdict_limits()
    assert (found.stands_shortfall, found.stands_over, found.stands_inside) == (1.01, 1.10, 0.5)
    assert (found.shortfall, found.over, found.beyond_people) == (1.20, 1.25, 2.0)
    assert (found.share, found.gel_compression) == (0.95, 0.6)
    assert len(re.findall(r'kind = "choice"', BUILT_IN)) == len(re.findall(r"(?m)^value = ", BUILT_IN)) == 8


def test_a_file_of_ones_own_is_read_and_decides(own_file):
    assert verdict(ranges(), away(1.25)).level == "not_representative"
    own_file(changed("usable.shortfall", "value = 1.20", "value = 1.30"))
    assert verdict_limits().shortfall == 1.30 and verdict_limits().over == 1.25
    assert verdict(ranges(), away(1.25)).level == "usable_with_correction"
    own_file(changed("stands_for.over", "value = 1.10", "value = 1.00"))
    assert verdict(ranges(), away(None, 1.05)).level == "usable_with_correction"
    own_file(BUILT_IN)
    assert verdict(ranges(), away(None, 1.05)).level == "stands_for"


def test_the_limit_of_the_gels_compression_is_that_of_every_curve(own_file):
    def limit():
        inputs = read_problem(Request("forefinger", shape="slab", verify=False))
        gel = inputs.targets.limits.gel_compression
        return make_curves(inputs.slab_law, [10.0], inputs.radius_mm, gel).limit_mm

    np.testing.assert_allclose(limit(), 6.0)
    own_file(changed("bottoming_out.gel_compression", "value = 0.6", "value = 0.4"))
    np.testing.assert_allclose(limit(), 4.0)


DAMAGED = [
    ("usable.over", "value = 1.25", "value = 1.25.3", None),
    ("usable.over", "[usable.over]", "[usable.ower]", "usable.ower"),
    ("castings.share", "[castings.share]", "[casting.share]", "casting.share"),
    ("usable.over", "value = 1.25\nlow = 1.0\nhigh = 1.60", "value = 3.5\nlow = 1.0\nhigh = 4.0", "usable.over"),
    ("usable.shortfall", "value = 1.20\nlow = 1.0", "value = 0.9\nlow = 0.8", "usable.shortfall"),
    ("castings.share", "value = 0.95\nlow = 0.8\nhigh = 0.99", "value = 1.0\nlow = 0.8\nhigh = 1.0", "castings.share"),
    (
        "bottoming_out.gel_compression",
        "value = 0.6\nlow = 0.3\nhigh = 0.6",
        "value = 0.7\nlow = 0.3\nhigh = 0.8",
        "bottoming_out.gel_compression",
    ),
    ("usable.over", 'kind = "choice"', 'kind = "chosen"', "usable.over"),
    ("usable.over", 'kind = "choice"\n', "", "usable.over"),
    ("stands_for.over", "value = 1.10", 'value = "much"', "stands_for.over"),
    ("stands_for.over", "value = 1.10", "value = nan", "stands_for.over"),
    ("stands_for.over", "value = 1.10", "value = inf", "stands_for.over"),
    ("stands_for.over", "value = 1.10", "value = 1.30", "stands_for.over"),
    ("castings.share", 'source = "', 'sorce = "', "castings.share"),
    ("stands_for.shortfall", "value = 1.01\nlow = 1.0\nhigh = 1.05", "value = 1.25\nlow = 1.0\nhigh = 1.3", None),
    ("stands_for.over", "value = 1.10\nlow = 1.0\nhigh = 1.25", "value = 1.30\nlow = 1.0\nhigh = 1.4", None),
]


@pytest.mark.parametrize(("table", "old", "new", "at"), DAMAGED)
def test_a_damaged_file_is_refused_in_one_line_that_names_it(own_file, table, old, new, at):
    text = changed(table, old, new)
    own_file(text)
    with pytest.raises(InputError, match=r"verdict\.toml") as refused:
        verdict_limits()
    said = str(refused.value)
    assert "\n" not in said
    if at is not None:
        start = line_of_table(text, at)
        named = int(re.search(r"verdict\.toml:(\d+)", said).group(1))
        assert start <= named <= start + 6, said


@pytest.mark.parametrize(
    "table",
    [
        "stands_for.shortfall",
        "usable.shortfall",
        "castings.share",
        "bottoming_out.gel_compression",
        "usable.beyond_people",
    ],
)
def test_a_missing_limit_is_refused(own_file, table):
    own_file(re.sub(rf"(?ms)^\[{re.escape(table)}\]\n.*?(?=^\[|^#|\Z)", "", BUILT_IN))
    with raises_code("missing") as refused:
        verdict_limits()
    assert table.partition(".")[0] in str(refused.value) or table.partition(".")[2] in str(refused.value)


OTHER = ["", "schema = 1\n", BUILT_IN.replace("schema = 1", "schema = 2"), "schema = 1\nusable = 3\n"]


@pytest.mark.parametrize("text", [*OTHER, BUILT_IN + "\n[own]\nvalue = 1\n"])
def test_a_file_of_another_form_is_refused(own_file, text):
    own_file(text)
    with pytest.raises(InputError, match=r"verdict\.toml"):
        verdict_limits()


def test_a_suggestion_reads_the_limits_before_any_work(own_file):
    own_file("schema = 1\n")
    with raises_code("missing", "stands_for"):
        read_problem(Request("forefinger", shape="slab", verify=False))


@pytest.mark.parametrize(
    ("table", "value", "allowed"),
    [
        ("stands_for.over", 1.0, True),
        ("stands_for.over", 0.99, False),
        ("usable.over", 3.0, True),
        ("usable.over", 3.05, False),
    ],
)
def test_over_readings_are_allowed_from_one_to_three(own_file, table, value, allowed):
    start = BUILT_IN.index(f"[{table}]")
    numbers = f"value = {value}\nlow = 0.5\nhigh = 9.0\n"
    own_file(BUILT_IN[:start] + re.sub(r"value = .*\nlow = .*\nhigh = .*\n", numbers, BUILT_IN[start:], count=1))
    if allowed:
        field = {"stands_for.over": "stands_over", "usable.over": "over"}[table]
        assert getattr(verdict_limits(), field) == value
        return
    with raises_code("out_of_range"):
        verdict_limits()


OLD = {
    "usable.shortfall_castings": "[usable.shortfall_castings]\nvalue = 1.2\nlow = 1.0\nhigh = 1.5\n",
    "choice.tie": "[choice.tie]\nvalue = 0.01\nlow = 0.0\nhigh = 0.05\n",
}


@pytest.mark.parametrize("entry", OLD)
def test_a_file_of_the_earlier_edition_is_refused_with_what_to_do_before_any_work(own_file, capsys, entry):
    from dummydesign.cli import run

    own_file(f'{BUILT_IN}\n{OLD[entry]}kind = "choice"\nsource = "an earlier edition"\n')
    with raises_code("unknown_key", entry):
        verdict_limits()
    assert run(["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--no-verify"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "verdict.toml:" in line and entry.partition(".")[2] in line and "delete" in line
