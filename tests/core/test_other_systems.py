"""What other systems do otherwise, tried here: code pages, paths with backslashes, names of devices."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from dummydesign.core import user_library
from dummydesign.core.errors import InputError

ROOT = Path(__file__).parents[2]


def run(tmp_path, *words, **variables):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "DUMMYDESIGN_HOME": str(tmp_path / "home"), **variables}
    return subprocess.run([sys.executable, *words], cwd=tmp_path, env=environment, capture_output=True)


PLAIN = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C", "LANG": "C"}
"""A terminal and files in ASCII, as on a machine without a locale."""


@pytest.mark.parametrize("name", ["resins", "tissues"])
def test_a_terminal_that_knows_ascii_alone_gets_every_answer(tmp_path, name):
    done = run(tmp_path, "-m", "dummydesign", name, "list", **PLAIN)
    assert done.returncode == 0, done.stderr
    done.stdout.decode("ascii")


@pytest.mark.slow
def test_files_of_a_campaign_are_utf8_whatever_the_locale(tmp_path):
    words = ["campaign", "new", "plan", "--young", "25", "--no-power"]
    pages = []
    for name, variables in (("a", PLAIN), ("b", {"PYTHONUTF8": "1"})):
        (tmp_path / name).mkdir()
        done = run(tmp_path / name, "-m", "dummydesign", *words, **variables)
        assert done.returncode == 0, done.stderr
        pages.append((tmp_path / name / "plan" / "sheet.html").read_bytes())
    assert pages[0] == pages[1]
    pages[0].decode("utf-8")


def test_every_text_file_names_its_encoding():
    """``open``, ``read_text`` and ``write_text`` without one use the code page of the machine."""
    words = [sys.executable, "-m", "ruff", "check", "--preview", "--isolated", "--select", "PLW1514", "dummydesign"]
    pytest.importorskip("ruff")
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_output_of_other_programs_is_never_read_by_the_code_page():
    """``text=True`` alone ends in an error where a program prints a letter that the code page lacks."""
    bare = [
        f"{path.name}:{number}"
        for path in (ROOT / "dummydesign").rglob("*.py")
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if re.search(r"\b(text|universal_newlines)=True", line) and "encoding=" not in line
    ]
    assert bare == []


@pytest.mark.parametrize("name", ["con", "NUL", "com1", "aux.2", "lpt9"])
def test_a_name_of_a_device_is_refused_on_every_system(name):
    with pytest.raises(InputError) as caught:
        user_library.check_name("resin", name)
    assert caught.value.code == "bad_name"


@pytest.mark.parametrize("name", ["console", "com", "nul-1", "auxiliary.2", "com12"])
def test_a_name_that_only_begins_as_a_device_is_fine(name):
    user_library.check_name("resin", name)


def test_a_file_is_taken_as_one_with_either_slash(monkeypatch):
    monkeypatch.setattr(user_library, "os", SimpleNamespace(sep="\\", altsep="/", environ=os.environ))
    for name in ("mine/soft", "mine\\soft", "soft.toml"):
        with pytest.raises(InputError) as caught:
            user_library.find("materials/resins", "resin", name)
        assert caught.value.code == "file_not_found"


@pytest.mark.slow
def test_a_script_whose_workers_would_run_it_again_gets_the_line_that_it_lacks(tmp_path):
    """Processes are spawned on every system, as on Windows."""
    lines = "import dummydesign\nprint(len(dummydesign.whatif([8, 12], [14, 16], workers=2).rows))\n"
    (tmp_path / "script.py").write_text(lines, encoding="utf-8")
    done = run(tmp_path, "script.py", DUMMYDESIGN_CACHE="off")
    assert done.returncode == 1
    assert b"if __name__ == '__main__':" in done.stderr.splitlines()[-1]


def test_the_user_s_folder_is_the_platform_s_where_none_is_named(monkeypatch, tmp_path):
    monkeypatch.delenv("DUMMYDESIGN_HOME", raising=False)
    monkeypatch.setattr(Path, "home", classmethod(lambda cls: tmp_path))
    for name in ("XDG_DATA_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    places = {
        "linux": tmp_path / ".local" / "share",
        "win32": tmp_path,
        "darwin": tmp_path / "Library" / "Application Support",
    }
    for platform, place in places.items():
        monkeypatch.setattr("sys.platform", platform)
        assert user_library.user_folder() == place / "dummydesign"
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "own"))
    assert user_library.user_folder() == tmp_path / "own"
