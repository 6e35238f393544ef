"""The folder of a mould without --out has one name, inside a project and outside."""

import pytest

from dummydesign.cli.commands import mold
from dummydesign.cli.entry import parser_of
from dummydesign.mold.batch import folder_name
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import read_kind


@pytest.mark.parametrize("shape", ["slab", "puck", "crowned:20,2,9"])
def test_inside_and_outside_a_project(shape):
    options = parser_of("mold").parse_args(["--thickness", "12", "--shape", shape])
    kind, parameters = read_kind(shape)
    side = 50.0 if shape == "puck" else 150.0
    spec = mould_spec(12.0, side, 50.0 if shape == "puck" else 120.0, kind=kind, parameters=parameters)
    assert mold.default_in_project(options) == folder_name([12.0], 1, spec.pad.prefix, 1)
