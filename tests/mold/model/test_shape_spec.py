"""What describes the mould of a shaped pad: equal shapes are equal, edges that meet a curve are refused."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.core.errors import InputError
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import read_kind
from tests.support.mould_checks import shape_spec


def test_equal_shapes_make_equal_specifications_and_a_slab_is_as_it_was():
    typed = [shape_spec(text, 8.0) for text in ("crowned:10,2", "crowned:height=2,radius=10", "CROWNED:10,2,6,0")]
    assert len({spec.hash for spec in typed}) == 1
    assert typed[0].pad.parameters == (("radius", 10.0), ("height", 2.0), ("foot", 6.0), ("ridge", 0.0))
    assert typed[0].hash != shape_spec("crowned:10,2,6.1", 8.0).hash != shape_spec("slab", 8.0).hash
    plain = shape_spec("slab", 8.0).to_dict()
    assert "base" not in plain and plain["pad"]["parameters"] == [] and shape_spec("slab", 8.0).tag == "t8"
    assert typed[0].tag == "crowned_t8" and shape_spec("layered:3,0.4", 8.0).tag == "layered_t8"


def test_layered_specification_survives_json():
    import json

    from dummydesign.mold.model.spec import MouldSpec

    spec = shape_spec("layered:3,0.4", 8.0)
    assert MouldSpec.from_dict(json.loads(spec.canonical())) == spec


CHANGES = [
    ("crowned:10,2", {"edge_radius_mm": 4.5}, "edge_radius_mm"),
    ("crowned:10,2,6,1", {"edge_radius_mm": 1.0}, "ridge must be 0"),
    ("boned:20,6,0,1", {"corner_radius_mm": 9.0}, "corner_radius_mm"),
    ("layered:2,0.4", {"edge_radius_mm": 2.5}, "upper layer"),
]


@pytest.mark.parametrize("text, change, named", CHANGES)
def test_edges_and_corners_that_meet_a_curve_are_refused(text, change, named):
    from dummydesign.mold.model.validate import validate

    spec = shape_spec(text, 15.0)
    with pytest.raises(InputError, match=named):
        validate(replace(spec, pad=replace(spec.pad, **change)))


@pytest.mark.parametrize(
    "text, thickness, edge",
    [
        ("crowned:10,2", 3.5, 1.3),
        ("layered:3,0.4", 8.0, 1.5),
        ("crowned:10,2", 4.5, 1.5),
        ("slab", 3.0, 1.5),
    ],
)
def test_the_edge_of_the_preset_is_taken_as_large_as_the_rim_has_room_for_and_that_is_said(text, thickness, edge):
    from dummydesign.mold.pour.plan import pour_plan
    from dummydesign.mold.pour.warnings import pour_warnings

    spec = shape_spec(text, thickness)
    assert spec.pad.edge_radius_mm == pytest.approx(edge)
    said = [one["message"] for one in pour_warnings(spec, pour_plan(spec)) if one["code"] == "edge_radius"]
    assert len(said) == (edge < 1.5) and all(f"{edge:g} mm" in one for one in said)


def test_known_shapes_are_those_of_the_model_and_the_puck():
    for text in ("crowned:10,2", "layered:3,0.4", "boned:20,6", "slab"):
        kind, parameters = read_kind(text)
        assert mould_spec(10.0, 60.0, 50.0, kind=kind, parameters=parameters).pad.shape == read_shape(text)
    assert mould_spec(30.0, 50.0, 50.0, kind="puck").pad.shape == read_shape("slab")
