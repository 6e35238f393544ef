"""Steps of loop, replay, fit and compare: on a terminal, not with -q, and not in a file."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from dummydesign import cli
from dummydesign.loop.calibration_file import write_calibration
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue import load_tissue
from tests.support.made_calibration import calibration

CAMPAIGN = Path(__file__).parents[3] / "examples" / "campaign"
COMMANDS = ("fit", "compare", "replay", pytest.param("loop", marks=pytest.mark.slow))


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """Each command with what it needs."""
    folder = tmp_path_factory.mktemp("steps")
    finger, motion = load_tissue("forefinger").target(), ramp_and_hold(10.0, 1.5, hold_s=5.0, hold_points=400)
    force = finger.force(motion, 10.0)
    rows = "\n".join(f"{t:.9f},{x:.9f},{f:.6f}" for t, x, f in zip(motion.time_s, motion.displacement_mm, force))
    (folder / "press.csv").write_text("time_s,displacement_mm,force_N\n" + rows + "\n")
    write_calibration(calibration(), folder / "calibration.json")
    trace, out = str(folder / "press.csv"), str(folder / "out")
    return {
        "fit": ["fit", trace],
        "compare": ["compare", trace, "--tissue", "forefinger", "--out", out, "--replace"],
        "replay": ["replay", str(CAMPAIGN), "--calibration", str(folder / "calibration.json")],
        "loop": ["loop", str(CAMPAIGN), "--out", out + "-loop", "--replace"],
    }


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_steps_are_on_the_terminal_alone_counted_and_cleared_and_not_with_quiet(command, asked, monkeypatch, capsys):
    told = {}
    cases = (("terminal", Terminal(), []), ("quiet", Terminal(), ["-q"]), ("file", io.StringIO(), []))
    for name, stream, more in cases:
        with monkeypatch.context() as patched:
            patched.setattr("sys.stderr", stream)
            assert cli.run([*asked[command], *more]) == 0
        told[name] = stream.getvalue()
    shown = told["terminal"].split("\r\033[K")[1:]
    assert shown[0].startswith("step 1 of about ") and shown[-1] == "" and len(shown) > 3
    assert any(text.endswith(" left") for text in shown)
    assert told["quiet"] == told["file"] == ""
    capsys.readouterr()
