"""The names that scripts and extensions of others rely on are there; one that goes keeps an alias for a release."""

from __future__ import annotations

import importlib

import pytest

NAMES = {
    "dummydesign": "__version__ calibrate close_loop compare fit import_traces load_resin load_tissue "
    "make_mould on_person predict record_pad replay suggest whatif",
    "dummydesign.api": "Answer Fitted Predicted Result Rows calibrate close_loop compare fit "
    "import_traces load_resin load_tissue make_mould on_person predict record_pad replay suggest whatif",
    "dummydesign.cli": "main run",
    "dummydesign.core.errors": "DummydesignError InputError NoAnswerError",
    "dummydesign.geometry.pad_shape": "PadShape",
    "dummydesign.geometry.shape_registry": "registered read_shape shape_kinds",
    "dummydesign.loop": "Arm Effect Parameter check_effect wrap",
    "dummydesign.pad.force_law": "ForceLaw",
    "dummydesign.resin": "Component Resin load_resin read_resin update_resin",
    "dummydesign.tissue": "load_tissue",
    "dummydesign.tissue.model.maxwell_law": "MaxwellLaw",
}


@pytest.mark.parametrize("module", NAMES)
def test_public_names_are_there(module):
    found = importlib.import_module(module)
    assert [name for name in NAMES[module].split() if not hasattr(found, name)] == []


def test_the_front_door_has_these_names_and_no_others():
    for module in ("dummydesign", "dummydesign.api", "dummydesign.loop"):
        assert sorted(importlib.import_module(module).__all__) == sorted(NAMES[module].split())
