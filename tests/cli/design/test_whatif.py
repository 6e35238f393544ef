"""``whatif`` on the command line: rows and their files, going on, refusals."""

import pytest

from dummydesign.cli.entry import run
from tests.support.command_answer import answer


def test_whatif_gives_rows_and_their_csv(capsys, tmp_path):
    status, found = answer(
        capsys, "whatif", "--thickness", "5:20:5", "--ratio", "15,16", "--tissue", "palm", "--out", str(tmp_path)
    )
    assert status == 0 and found["schema"] == "dummydesign.whatif/1" and found["seconds"] > 0
    assert [(row["thickness_mm"], row["ratio"]) for row in found["rows"]] == [
        (t, r) for t in (5.0, 10.0, 15.0, 20.0) for r in (15.0, 16.0)
    ]
    row = found["rows"][1]
    assert set(row["exponent_at_N"]) == {"1", "5", "10", "15"} and set(row["peak_over_steady"]) == {"10", "250"}
    assert row["limit"] is None and "total" in row["score"]
    assert any(row["limit"] for row in found["rows"])
    assert len((tmp_path / "rows.csv").read_text().splitlines()) == 9
    assert (tmp_path / "report.html").stat().st_size > 50_000
    assert not list(tmp_path.glob(".*"))


@pytest.mark.slow
def test_whatif_in_two_processes_gives_the_same(capsys, tmp_path):
    arguments = ["whatif", "--thickness", "5:20:5", "--ratio", "15,16", "--out", "w"]
    assert answer(capsys, *arguments)[1]["rows"] == answer(capsys, *arguments, "--workers", "2")[1]["rows"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--thickness", "3:30"], "START:STOP:STEP"),
        (["--thickness", "3:30:0.001", "--ratio", "14:20:0.01"], "above 1000000"),
        (["--thickness", "5", "--ratio", "30"], "allowed range 14.0 to 20.0"),
        (["--thickness", "5", "--punch", "star:3"], "punch 'star:3'"),
        (["--thickness", "5", "--fidelity", "guess"], "unknown fidelity"),
        (["--thickness", "5", "--velocity", "0"], "velocity in mm/s = 0"),
    ],
)
def test_whatif_refuses_in_one_line_and_leaves_nothing(arguments, message, capsys, tmp_path):
    out = tmp_path / "study"
    assert run(["whatif", *arguments, "--out", str(out)]) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith("error: ") and message in error and "\n" not in error
    assert not out.exists()
