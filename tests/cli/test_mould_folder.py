"""The folder of a mould without --out has one name, inside a project and outside."""

import pytest

from dummydesign.api.moulds import make_mould
from dummydesign.cli.commands import mold
from dummydesign.cli.entry import parser_of, run
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import read_kind
from tests.support.refusal import raises_code


@pytest.mark.parametrize("shape", ["slab", "puck", "crowned:20,2,9"])
def test_inside_and_outside_a_project(shape):
    options = parser_of("mold").parse_args(["--thickness", "12", "--shape", shape])
    kind, parameters = read_kind(shape)
    side = 50.0 if shape == "puck" else 150.0
    spec = mould_spec(12.0, side, 50.0 if shape == "puck" else 120.0, kind=kind, parameters=parameters)
    assert mold.default_in_project(options) == f"mould_{spec.tag}"


@pytest.mark.parametrize(
    "words",
    [["--thickness", "5,8"], ["--thickness", "5,x"], ["--thickness", "400"], ["--thickness", "5", "--count", "0"]],
)
def test_a_mould_of_no_one_pad_is_one_line_and_no_file(words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["mold", *words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and list(tmp_path.iterdir()) == []
    assert ("once for each" in said) is ("," in words[1])


def test_a_list_of_thicknesses_is_refused_in_python_too():
    for given in ([5.0, 8.0], (5.0,)):
        with raises_code("not_a_number", "thickness_mm"):
            make_mould(given)
