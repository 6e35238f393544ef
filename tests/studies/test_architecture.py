"""The picture of the rooms: what counts as an import, where arrows run, and that none runs upward."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from studies.architecture import ROOMS, House, circles, draw, imported, module_imports, read_house, room_of, upward

PACKAGE = Path(__file__).parents[2] / "dummydesign"
LONGEST, FULL = 600, 20
IMPORT = re.compile(r"^\s*(?:from|import) (dummydesign[\w.]*)(?: import (\([^)]*\)|.*))?", re.MULTILINE)
QUOTED = re.compile(r"[\"'](dummydesign\.[\w.]+)[\"']")


@pytest.mark.slow
def test_no_room_takes_from_a_layer_above_it():
    house = read_house(PACKAGE)
    assert sum(house.imports.values()) > 300
    # a notebook shows the screen of the command
    assert upward(house) == [("api", "cli")] and house.imports[("api", "cli")] == 1


def test_every_folder_of_the_package_is_a_room():
    folders = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}
    assert folders | {"studies"} == {name for name, _ in ROOMS}


def test_a_file_has_at_most_600_lines_and_a_folder_20_modules():
    """Effects are a file each and may be more."""
    root = PACKAGE.parent
    files = [path for part in ("dummydesign", "studies", "tests", "benchmarks") for path in (root / part).rglob("*.py")]
    assert len(files) > 400
    long = {path.relative_to(root).as_posix(): len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert {name: lines for name, lines in long.items() if lines > LONGEST} == {}
    folders = Counter(path.parent.relative_to(root).as_posix() for path in files if path.is_relative_to(PACKAGE))
    assert {name: count for name, count in folders.items() if count > FULL and not name.endswith("effects")} == {}


@pytest.mark.slow
def test_no_module_imports_itself_by_way_of_others():
    """Imports inside functions count; those for types alone do not."""
    graph = module_imports(PACKAGE)
    assert len(graph) > 300 and circles(graph) == []
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]


def test_every_module_is_imported_by_a_test():
    """By an import, or by its name in quotes where a test looks at it from outside."""
    root = PACKAGE.parent
    named = {".".join(path.relative_to(root).with_suffix("").parts) for path in PACKAGE.rglob("*.py")}
    modules = {name for name in named if not name.endswith("__init__")}
    assert len(modules) > 300 and unseen(modules, (root / "tests").rglob("*.py")) == []
    assert unseen({"dummydesign.nowhere.to_be_seen"}, [Path(__file__).parent / "test_tissues.py"]) != []


def unseen(modules: set[str], files: Iterable[Path]) -> list[str]:
    """Those of the modules that no file imports or quotes."""
    seen: set[str] = set()
    for file in files:
        text = file.read_text(encoding="utf-8")
        for module, names in IMPORT.findall(text):
            seen |= {module, *(f"{module}.{name}" for name in re.findall(r"\w+", names))}
        seen.update(QUOTED.findall(text))
    return sorted(modules - seen)


def test_lazy_imports_count_and_type_only_imports_do_not():
    source = (
        "from typing import TYPE_CHECKING\n"
        "import dummydesign.core.files\n"
        "if TYPE_CHECKING:\n    from dummydesign.cli.entry import run\n"
        "def f():\n    from dummydesign.pad import predict\n"
    )
    assert sorted(imported(ast.parse(source))) == ["dummydesign.core.files", "dummydesign.pad"]


def test_an_arrow_to_a_higher_layer_and_one_between_tissue_and_resin_are_upward():
    imports = Counter({("core", "pad"): 1, ("pad", "core"): 2, ("tissue", "resin"): 1})
    house = House(Counter(), Counter(), imports)
    assert upward(house) == [("core", "pad"), ("tissue", "resin")]


def test_the_picture_names_every_room_and_every_count():
    imports = Counter({("cli", "core"): 17})
    root = ElementTree.fromstring(draw(House(Counter(), Counter(), imports)))
    words = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {name for name, _ in ROOMS} <= set(words) and "17" in words


def test_the_front_door_belongs_to_the_calls_for_scripts_and_main_to_the_command_line():
    assert room_of("dummydesign.answers") == "api"
    assert room_of("dummydesign.__main__") == "cli"
    assert room_of("dummydesign.pad.axisymmetric.case") == "pad"
