"""The wheel carries its data: built, installed alone, and used for the main job from an empty folder."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

from dummydesign import __version__

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A fresh environment with only our wheel in it; other packages are borrowed by path."""
    pytest.importorskip("hatchling", reason="the dev extra is not installed")
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    wheel = next(folder.glob("*.whl"))
    home = folder / "env"
    venv.create(home, with_pip=False)
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    site = next(home.glob("[Ll]ib/**/site-packages"))
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(site)
    (site / "borrowed.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    return python


def run(python, folder, *words):
    return evaluate(python, folder, "-m", "dummydesign", *words)


def evaluate(python, folder, *words):
    """Run Python without the environment of the tests, whose PYTHONPATH may name the repository."""
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder), "LOCALAPPDATA": str(folder)}
    environment |= {name: os.environ[name] for name in ("SYSTEMROOT",) if name in os.environ}  # Windows needs it
    return subprocess.run([str(python), *words], cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.slow
def test_the_installed_package_is_the_wheel_and_not_the_repository(installed, tmp_path):
    code = "import dummydesign, dummydesign.core.user_library as l; print(dummydesign.__file__); print(l.data_folder())"
    found = evaluate(installed, tmp_path, "-c", code)
    package, data = found.stdout.split()
    assert str(ROOT) not in package
    assert data == str(Path(package).parent / "_data")


@pytest.mark.slow
@pytest.mark.parametrize("tissue", ["forefinger", "palm", "thenar"])
def test_the_main_job_runs_from_the_wheel(installed, tmp_path, tissue):
    quick = ("--shape", "slab", "--no-cad", "--no-verify")
    done = run(installed, tmp_path, "suggest", "--tissue", tissue, *quick, "--json")
    answer = json.loads(done.stdout)
    assert done.returncode == int(answer["verdict"]["light"] == "red"), done.stderr
    assert answer["schema"] == "dummydesign.suggest/2"
    chosen = answer["recommendation"]
    assert 3.0 <= chosen["thickness_mm"] <= 30.0
    assert sum(part["mass_g"] for part in chosen["recipe"]["components"]) == pytest.approx(
        chosen["recipe"]["total_g"], abs=0.11
    )


@pytest.mark.slow
def test_presets_tables_and_materials_travel_in_the_wheel(installed, tmp_path):
    assert json.loads(run(installed, tmp_path, "tissues", "list", "--json").stdout)["tissues"]
    assert json.loads(run(installed, tmp_path, "resins", "list", "--json").stdout)["resins"]
    predicted = run(installed, tmp_path, "predict", "--young", "25", "--thickness", "5", "--depth", "1", "--json")
    assert json.loads(predicted.stdout)["force_N"][0] == pytest.approx(5.37, rel=0.01)


@pytest.mark.slow
def test_the_cache_of_an_installed_package_follows_its_sources_and_tables(installed, tmp_path):
    code = """
from dummydesign.core import cache
from dummydesign.core.user_library import data_folder
table = next((data_folder() / "materials" / "tables").glob("*.json"))
source = max((path for path in cache.sources() if path.suffix == ".py"), key=lambda path: len(path.parts))
assert "_data" in table.parts, table
found = [cache.code_version.__wrapped__()]
for path in (table, source):
    before = path.read_bytes()
    path.write_bytes(before + b"\\n")
    found.append(cache.code_version.__wrapped__())
    path.write_bytes(before)
print(len(set(found)), cache.code_version.__wrapped__() == found[0])
"""
    found = evaluate(installed, tmp_path, "-c", code)
    assert found.stdout.split() == ["3", "True"], found.stderr


def test_version_and_day_of_the_release_are_the_same_everywhere():
    """The changelog's newest section, the citation, the archive's description and the package."""
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2})$", changes, re.M)
    archive = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    citation = dict(re.findall(r"^(version|date-released): (.+)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.M))
    assert newest is not None
    assert newest.groups() == (__version__, citation["date-released"])
    assert (citation["version"], archive["version"]) == (__version__, __version__)
    assert archive["publication_date"] == citation["date-released"]


def test_the_lock_holds_every_package_of_the_tests_and_no_address():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    asked = list(project["dependencies"])
    for name in ("dev", "xlsx", "tables", "cluster"):
        asked += extras[name]
    lines = (ROOT / "requirements-test.lock").read_text(encoding="utf-8").splitlines()
    locked = {line.split("==")[0] for line in lines if not line.lstrip().startswith("#")}
    assert {re.split(r"[<>=\[]", line)[0] for line in asked} <= locked
    assert not any("://" in line or "index" in line.lower() for line in lines)
