"""Place a bone from a file: a child process reads, cuts and measures it; the specification then knows it."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.threads import ONE_THREAD
from dummydesign.geometry.limits import RIM_FREE_MM
from dummydesign.mold.bone.insert import Insert, Placing

SUFFIXES = (".stl", ".step", ".stp")
TIMEOUT_S = 300.0
WORKER = ("-m", "dummydesign.mold.bone.solid")


def place_bone(
    file: Path, placing: Placing, thickness_mm: float, length_mm: float, width_mm: float, solid: Path
) -> tuple[Insert, tuple[tuple[str, float], ...]]:
    """Read a bone, set it into a pad and find the dome that stands for it.

    Parameters
    ----------
    file : Path
        STL or STEP, its lengths taken as millimetres.
    placing : Placing
        Scale, turn, place, depth.
    thickness_mm, length_mm, width_mm : float
        The pad. [mm]
    solid : Path
        Where the placed solid is written, for the mould.

    Returns
    -------
    Insert, tuple of (str, float)
        The bone, and the parameters of the boned shape nearest to it.

    Raises
    ------
    InputError
        For a file or a placing that makes no bone, or one that sticks out.
    NoAnswerError
        ``cad_unavailable`` or ``cad_failed``.
    """
    placing.check(thickness_mm)
    if file.suffix.lower() not in SUFFIXES:
        raise InputError(f"bone '{file.name}': a name that ends in {', '.join(SUFFIXES)} is needed")
    try:
        content = file.read_bytes()
    except OSError as problem:
        raise InputError(f"bone '{file}': cannot be read: {problem.strerror}") from None
    room = min(length_mm, width_mm) / 2 - RIM_FREE_MM
    found = _measured({"file": str(file), "solid": str(solid), "placing": asdict(placing), "thickness_mm": thickness_mm,
                       "room_mm": room})  # fmt: skip
    dome = (("radius", round(found.pop("tip_mm"), 2)), ("height", placing.height_mm),
            ("foot", round(found.pop("foot_mm"), 2)))  # fmt: skip
    insert = Insert(file.name, hashlib.sha256(content).hexdigest(), placing, **found)
    insert.check(length_mm, width_mm)
    return insert, dome


def _measured(asked: dict[str, Any]) -> dict[str, Any]:
    """What the child says of a bone; its error as ours."""
    package = str(Path(__file__).resolve().parents[3])
    path = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
    with tempfile.TemporaryDirectory(prefix="dummydesign-bone-") as work:
        question, answer = Path(work) / "asked.json", Path(work) / "answer.json"
        question.write_text(json.dumps(asked), encoding="utf-8")
        command = [sys.executable, *WORKER, str(question), str(answer)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S,
                                  env={**os.environ, **ONE_THREAD, "PYTHONPATH": path})  # fmt: skip
        except subprocess.TimeoutExpired:
            raise NoAnswerError("cad_failed", f"the bone was not read within {TIMEOUT_S:g} s", {}) from None
        if not answer.is_file():
            last = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
            raise NoAnswerError("cad_failed", f"the bone could not be read: {last}", {})
        found: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
    if "error" not in found:
        return found
    if found["error"]["code"] == "input":
        raise InputError(found["error"]["message"])
    raise NoAnswerError(found["error"]["code"], found["error"]["message"], {})
