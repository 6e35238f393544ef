"""Shipped tables: whatever is wrong with a file, one error names it and the command that makes it anew."""

from __future__ import annotations

import json

import pytest

from dummydesign.core import user_library as json_table
from dummydesign.pad import predict as separability
from dummydesign.pad.tables import elastic_law, puck, shape, slab, square
from dummydesign.pad.tables import slab as compressibility
from tests.support.refusal import raises_code

READERS = {
    "slab-bonded.json": (slab.load_table, "studies.tables.slab"),
    "square-bonded.json": (square.load_square, "studies.tables.square"),
    "square-crowned.json": (square.load_crown, "studies.tables.square_crown"),
    "crowned-bonded.json": (lambda: shape.load_shape_table("crowned"), "studies.tables.shapes crowned"),
    "elastic-law.json": (elastic_law.load_elastic_table, elastic_law.COMMAND),
    "filleted-bonded.json": (lambda: slab.load_filleted("bonded", 0.1), "studies.tables.filleted"),
    "puck-50x30.json": (puck.load_puck_table, puck.COMMAND),
    "puck-shapes.json": (puck.load_shapes, f"{puck.COMMAND} --shapes"),
    "quick-error.json": (separability.load_quick_error, separability.COMMAND),
    "slab-compressibility.json": (compressibility.load_compressibility, compressibility.COMMAND),
}
CACHED = (
    slab.load_table,
    square.load_square,
    square.load_crown,
    slab.load_filleted,
    shape.load_shape_table,
    puck.load_puck_table,
    puck.load_shapes,
    separability.load_quick_error,
    elastic_law.load_elastic_table,
    compressibility.load_compressibility,
)
DAMAGED = (
    "",
    "{ torn",
    "[]",
    "3",
    '"text"',
    "null",
    "{}",
    "\xff",
    '{"single": 1, "shapes": 2, "surface": [], "base": 1}',
)


@pytest.fixture
def folder(monkeypatch, tmp_path):
    """An empty place for tables; what was read before is forgotten, and again afterwards."""
    tables = tmp_path / "materials" / "tables"
    tables.mkdir(parents=True)
    monkeypatch.setattr(json_table, "data_folder", lambda: tmp_path)
    for reader in CACHED:
        reader.cache_clear()
    yield tables
    for reader in CACHED:
        reader.cache_clear()


@pytest.mark.parametrize("name", READERS)
def test_a_damaged_or_missing_table_is_one_error_that_names_its_command(folder, name):
    reader, command = READERS[name]
    for text in (None, *DAMAGED):
        if text is not None:
            (folder / name).write_bytes(text.encode("latin-1"))
        with raises_code("table_unavailable", "table") as caught:
            reader()
        assert caught.value.code == "table_unavailable"
        assert str(caught.value).endswith(command)


def test_every_shipped_table_has_a_reader_and_is_read():
    shipped = {path.name for path in json_table.table_path("x").parent.glob("*.json")}
    kinds = {f"{kind}-bonded.json" for kind in shape.tabulated_kinds()}
    known = {*READERS, *kinds, "slab-sliding.json", "square-sliding.json", "filleted-sliding.json"}
    assert shipped == known
    for reader, _ in READERS.values():
        assert reader() is not None


def test_what_a_parser_says_in_words_is_passed_on(folder):
    (folder / "a.json").write_text(json.dumps({"values": []}))

    def parse(data):
        raise ValueError("no values")

    with raises_code("table_unavailable", "table"):
        json_table.read("a.json", "table", "make a", parse)
