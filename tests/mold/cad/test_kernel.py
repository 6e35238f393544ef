"""Libraries are loaded without parts that are not needed, and nothing of that is left behind."""

from __future__ import annotations

import importlib
import sys

import pytest

from dummydesign.mold.cad import kernel


def test_parts_that_are_left_out_are_empty_while_a_library_is_loaded_and_gone_after():
    with kernel._left_out(("nowhere_to_be_found",), ()):
        deep = importlib.import_module("nowhere_to_be_found.deep.deeper")
        assert isinstance(deep.AnyName, type) and deep.AnyName.__name__ == "AnyName"
        assert not hasattr(deep, "__version__")
        with pytest.raises(ModuleNotFoundError):
            importlib.import_module("nowhere_to_be_found_either")
    assert not [name for name in sys.modules if name.startswith("nowhere_to_be_found")]
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("nowhere_to_be_found")


def test_parts_that_are_missing_cannot_be_imported_meanwhile_and_can_after(monkeypatch):
    monkeypatch.delitem(sys.modules, "this", raising=False)
    monkeypatch.delitem(sys.modules, "antigravity", raising=False)
    with kernel._left_out((), ("antigravity",)), pytest.raises(ModuleNotFoundError):
        importlib.import_module("antigravity")
    assert "antigravity" not in sys.modules and importlib.util.find_spec("antigravity") is not None


def test_what_is_loaded_already_is_left_alone_also_after_a_fault():
    before, finders = sys.modules["json"], list(sys.meta_path)
    with pytest.raises(ZeroDivisionError), kernel._left_out(("json",), ("numpy",)):
        assert importlib.import_module("json") is before and importlib.import_module("numpy").pi > 3
        raise ZeroDivisionError
    assert sys.modules["json"] is before and sys.meta_path == finders


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (ModuleNotFoundError("No module", name="cadquery"), "pip install cadquery"),
        (ImportError("libGL.so.1:\n cannot open"), "(libGL.so.1: cannot open): apt-get install libgl1"),
        (None, None),
    ],
)
def test_a_kernel_that_cannot_be_loaded_says_what_mends_it(monkeypatch, fault, words):
    def load():
        if fault:
            raise fault

    monkeypatch.setattr(kernel, "load_cadquery", load)
    found = kernel.cad_problem()
    assert found is None if words is None else words in found and "\n" not in found


def test_names_are_taken_from_the_library_when_they_are_first_used(monkeypatch):
    import types

    monkeypatch.setitem(sys.modules, "cadquery", types.SimpleNamespace(Workplane="made"))
    assert kernel._CadQuery().Workplane == "made"
    part = types.ModuleType("OCP.gp")
    part.gp_Pnt = object()
    monkeypatch.setitem(sys.modules, "OCP", types.ModuleType("OCP"))
    monkeypatch.setitem(sys.modules, "OCP.gp", part)
    own = kernel._OpenCascade()
    assert own.gp_Pnt is part.gp_Pnt and vars(own)["gp_Pnt"] is part.gp_Pnt
