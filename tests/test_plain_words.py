"""Phrases that talk around, of which plain English has none: counted in the package, its answers, README and docs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
AROUND = re.compile(
    r"\b(is told|are told|told|says so|all the same|carried on|of which one|in the middle|what is left|is said|are said"
    r"|said first|stands? beside|stands? once|is taken by|parted by|held against|hold \w+ against|of it the"
    r"|not known of it|asked for|comes? twice|word of)\b",
    re.IGNORECASE,
)


def phrases(path: Path) -> list[str]:
    lines = path.read_text(encoding="utf-8").splitlines()
    return [f"{path.name}:{at}: {found[0]}" for at, line in enumerate(lines, 1) for found in AROUND.finditer(line)]


def files(folder: str, *endings: str) -> list[Path]:
    return [path for path in sorted((ROOT / folder).rglob("*")) if path.suffix in endings]


@pytest.mark.parametrize("folder", ["dummydesign", "tests/snapshots"])
def test_package_and_answers_do_not_talk_around(folder):
    found = [one for path in files(folder, ".py", ".js", ".html", ".toml", ".txt") for one in phrases(path)]
    assert found == []


def test_readme_and_pages_do_not_talk_around():
    pages = [ROOT / "README.md", *files("docs", ".md")]
    assert [one for page in pages for one in phrases(page)] == []


def test_a_phrase_is_seen():
    assert AROUND.search("a pad that may read low is told first") and not AROUND.search("multiply readings by 1.07")
