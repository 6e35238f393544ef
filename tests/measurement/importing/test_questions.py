"""Every question names an answer, and the answer ends it: the same question is never asked again."""

from __future__ import annotations

import inspect
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from dummydesign.cli.commands.import_ import pairs
from dummydesign.core.errors import InputError
from dummydesign.measurement import importing
from dummydesign.measurement.importing.decisions import ImportLog, QuestionError, Settings
from dummydesign.measurement.importing.read import import_files
from tests.measurement.importing.press.test_baseline import press as drifting
from tests.support.machine_presses import recording

STEP = 0.01
TIME = np.arange(0.0, 8.0, STEP)
WAY = np.interp(TIME, [1.0, 1.8, 6.0, 6.8], [-2.0, 6.0, 6.0, -2.0])
FORCE = 0.06 * np.maximum(WAY, 0.0) ** 3 * np.interp(TIME, [1.8, 6.0], [1.0, 0.8])
FORCE = FORCE + np.random.default_rng(5).normal(0.0, 2e-3, len(TIME))
LEVEL = 3.0 - 0.8 * FORCE / FORCE.max()
PRESSED = TIME > 1.9


def table(head, *columns, form="{:.4f}", sign=","):
    cells = [[cell if isinstance(cell, str) else form.format(cell) for cell in column] for column in columns]
    return "\n".join([head, *map(sign.join, zip(*cells)), ""])


def mixed(values):
    return [f"{value:.4f}".replace(".", ".,"[at % 2]) for at, value in enumerate(values)]


FAST = recording(6, velocity_mm_s=250.0)


def delayed(delay_s):
    return np.interp(TIME - delay_s, TIME, FORCE)


GIVEN = dict
HEAD = "time_s,position_mm,force_N"
FILES = {
    "columns of one name": (table("time_s,x,x,force_N", TIME, WAY, WAY, FORCE), GIVEN(columns={"displacement": "x"})),
    "strain and stress": (table("time_s;strain [%];stress [kPa]", TIME, 3 * WAY, FORCE, sign=";"), {}),
    "two positions": (table("time_s,position_mm,depth_mm,force_N", TIME, WAY, WAY**2, FORCE), {}),
    "no names": (table("alpha,beta,gamma", TIME, WAY, FORCE), {}),
    "no units": (table("time,position,force", TIME, WAY, FORCE), {}),
    "two decimal signs": (table("time_s;position_mm;force_N", mixed(TIME), mixed(WAY), mixed(FORCE), sign=";"), {}),
    "a thousand or a decimal": (
        table(
            "time_ms;position_um;force_mN",
            *(
                [
                    f"{int(value) // 1000}.{int(value) % 1000:03d}" if value >= 1000 else f"{int(value)}"
                    for value in column
                ]
                for column in (1000 * TIME, 1000 * np.maximum(WAY, 0.0), 1000 * np.maximum(FORCE, 0.0))
            ),
            sign=";",
        ),
        {},
    ),
    "two lengths": (
        table("clock,time_s,position_mm,force_N", [f"00:00:{t / 2:06.3f}" for t in TIME], TIME, WAY, FORCE),
        GIVEN(columns={"time": "time_s"}),
    ),
    "too fast a machine": (table("time_s,position_mm,force_N", TIME / 1e3, WAY, FORCE, form="{:.6f}"), {}),
    "too deep": (table("time_s,position_m,force_N", TIME, WAY, FORCE), {}),
    "up and down": (table(HEAD, TIME, WAY, FORCE - np.where(WAY > 4, 0.0, 0.6 * FORCE.max()) * (WAY > 1)), {}),
    "pressed or offset": (table(HEAD, TIME, WAY, FORCE.max() * 1.02 - FORCE), {}),
    "force after the stop": (table(HEAD, TIME, WAY, delayed(0.9)), {}),
    "force after the stop, by flip": (table(HEAD, TIME, WAY, delayed(0.9)), GIVEN(flip=frozenset())),
    "position back while the force rises": (
        table(
            HEAD,
            TIME,
            np.interp(TIME, [1.0, 1.6, 1.7, 1.8, 6.0, 6.8], [-2.0, 4.0, 3.0, 6.0, 6.0, -2.0]),
            np.interp(TIME, [1.6, 1.7, 1.8, 6.0, 6.8], [0.0, 6.0, 10.0, 8.0, 0.0]),
        ),
        {},
    ),
    "no lead-in": (table(HEAD, TIME, 0.5 * TIME, 0.8 + 30.0 * (1.0 - np.exp(-0.5 * TIME / 1.2))), {}),
    "drift or slope": (table(HEAD, *drifting(2, drift=0.15, dwell=0.0, gap=6.0, speed=3.0, release=False)[:3]), {}),
    "fast and far": (table(HEAD, FAST.time_s, FAST.displacement_mm + 200.0, FAST.force_N), {}),
    "one column for two": (table("time_s,load position,beta", TIME, WAY, FORCE), {}),
    "too slow": (table(HEAD, 1000.0 * TIME, WAY, FORCE), {}),
}
"""Files and what was said before, each of which leads to a question."""


def answers(message, asked):
    """Settings of the answers that a message names, as they would be typed; one in capitals is a place to fill in."""
    for option in re.split(r",? or (?=--)|, (?=--)", message.rpartition("; say ")[2]):
        words = shlex.split(re.sub(r"[;(].*", "", option).replace(" where ", " # where "), comments=True)
        given = {}
        for name, value in zip(words[::2], words[1::2]):
            key = name.removeprefix("--")
            if not name.startswith("--") or re.fullmatch(r"(\w+=)?(UNIT|NAME.*|S|HZ)|N|ROLE=.*", value):
                continue
            value = value.rstrip(",")
            given[key] = pairs(key, value) if key in ("columns", "units") else value
        if "flip" in given:
            given["flip"] = frozenset() if given["flip"] == "none" else frozenset(given["flip"].split(","))
        if given:
            merged = {
                key: {**asked.get(key, {}), **one} if isinstance(one, dict) else one for key, one in given.items()
            }
            yield {**asked, **merged}


def question_of(path, settings):
    """The doubt of the question, None where it is read or refused for another reason."""
    try:
        import_files([path], Settings(**settings))
    except QuestionError as question:
        return str(question)
    except InputError:
        pass  # an answer may be wrong for the file: then it is refused, not asked again
    return None


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("name", FILES)
def test_each_answer_that_a_question_names_ends_it(tmp_path, name):
    text, given = FILES[name]
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    message = question_of(tmp_path / "a.csv", given)
    assert message is not None and "; say --" in message
    named = list(answers(message, given))
    for settings in named:
        assert question_of(tmp_path / "a.csv", settings) != message, settings
    assert named or re.search(r"--(units \w+=(UNIT|\.\.)|delay S|contact N|columns ROLE=NAME)", message), message


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_the_files_lead_to_every_question(tmp_path, monkeypatch):
    source, asked = Path(importing.__file__).parent, set()
    every = {
        (path.name, number)
        for path in source.glob("*.py")
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if "log.question(" in line
    }
    usual = ImportLog.question

    def question(log, doubt, option, allowed=None):
        frame = inspect.currentframe().f_back
        asked.add((Path(frame.f_code.co_filename).name, frame.f_lineno))
        return usual(log, doubt, option, allowed)

    monkeypatch.setattr(ImportLog, "question", question)
    for text, given in FILES.values():
        (tmp_path / "a.csv").write_text(text, encoding="utf-8")
        question_of(tmp_path / "a.csv", given)
    missed = sorted(one for one in every if not any(one[0] == name and abs(one[1] - at) < 8 for name, at in asked))
    assert missed == []
