"""Names of effects stand in the files of the effects alone: a new one is a file, nothing elsewhere."""

from __future__ import annotations

import re
from pathlib import Path

import dummydesign
from dummydesign.loop import effects
from dummydesign.loop.effects.registry import EFFECTS

PACKAGE = Path(dummydesign.__file__).parent
EFFECTS_FOLDER = Path(effects.__file__).parent


def speaks_of(text: str, name: str) -> bool:
    """Whether a literal is an effect's name, or an end of one as for startswith and endswith."""
    ends = (text.startswith("_") and name.endswith(text)) or (text.endswith("_") and name.startswith(text))
    return text == name or ends


def literals(path: Path) -> set[str]:
    """Words that stand alone in quotes, also beside a brace of an f-string: what could be a name or an end of one."""
    return set(re.findall(r"""(?<=["'}])[a-z0-9_]{3,}(?=["'{])""", path.read_text(encoding="utf-8")))


def test_no_literal_outside_the_effects_is_the_name_of_an_effect():
    files = [path for path in PACKAGE.rglob("*.py") if EFFECTS_FOLDER not in path.parents]
    assert len(files) > 100
    names = [effect.name for effect in EFFECTS]
    found = {
        f"{path.relative_to(PACKAGE)}: {text}"
        for path in files
        for text in literals(path)
        if any(speaks_of(text, name) for name in names)
    }
    assert found == set()


def test_the_search_finds_whole_names_and_ends_of_names():
    assert speaks_of("ageing", "ageing") and speaks_of("_relaxation_mode", "slow_relaxation_mode")
    assert not speaks_of("age", "ageing") and not speaks_of("temperature_C", "temperature")
