"""Run the CAD child from outside: make a mould."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from dummydesign.core.blas_threads import HUNG_S, ran_out, surroundings
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.files import output_folder, writing
from dummydesign.core.manifest import COMMAND_LINE
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.model.validate import validate
from dummydesign.mold.pour.acceptance import GaugePoint, gauge_points
from dummydesign.mold.pour.plan import batches_of, pour_plan
from dummydesign.mold.pour.printing import check_layers
from dummydesign.mold.pour.warnings import pour_warnings

if TYPE_CHECKING:
    from dummydesign.mold.puck.ring import PuckSpec

WORKER = ("-m", "dummydesign.mold.child_main")


class CadChild:
    """A child that loads the CAD kernel while it waits for its question: this Python, one thread, this package.

    ``meanwhile`` is called once the question is asked, while the child works on it.
    """

    def __init__(self) -> None:
        self._work = tempfile.TemporaryDirectory(prefix="dummydesign-cad-", ignore_cleanup_errors=True)
        self._question, self._answer = (Path(self._work.name) / f"{name}.json" for name in ("question", "answer"))
        self._process = subprocess.Popen(
            [sys.executable, *WORKER, str(self._question), str(self._answer)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            env=surroundings(),
        )
        self.meanwhile: Callable[[], None] | None = None

    def ask(
        self, asked: dict[str, Any], timeout_s: float
    ) -> tuple[subprocess.CompletedProcess[str] | None, dict[str, Any]]:
        """Ask the one question; no process when it did not end in time, {} without answer."""
        self._question.write_text(json.dumps(asked), encoding="utf-8")
        process = self._process
        assert process.stdin is not None
        with suppress(BrokenPipeError):  # it has ended already
            process.stdin.close()
        process.stdin = None
        if self.meanwhile is not None:
            self.meanwhile()
        try:
            said, complained = process.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            return None, {}
        # One that was stopped by its limit may have been writing.
        whole = self._answer.is_file() and not ran_out(process.returncode)
        done = subprocess.CompletedProcess(process.args, process.returncode, said, complained)
        return done, json.loads(self._answer.read_text(encoding="utf-8")) if whole else {}

    def close(self) -> None:
        """End it, whatever it does."""
        if self._process.poll() is None:
            self._process.kill()
            self._process.communicate()
        self._work.cleanup()


_started: list[CadChild] = []


@contextmanager
def child_ahead() -> Iterator[CadChild]:
    """Start the child now; it takes the next question that is asked inside. One without a question is ended."""
    child = CadChild()
    _started.append(child)
    try:
        yield child
    finally:
        if child in _started:
            _started.remove(child)
        child.close()


def _answered(
    asked: dict[str, Any], timeout_s: float
) -> tuple[subprocess.CompletedProcess[str] | None, dict[str, Any]]:
    """Ask the child that was started ahead, or one that is started now; see :meth:`CadChild.ask`."""
    child = _started.pop() if _started else CadChild()
    try:
        return child.ask(asked, timeout_s)
    finally:
        child.close()


PROCESSOR_S = 900.0
"""Processor time after which the CAD kernel is given up; the largest moulds take a tenth of it. [s]"""


@dataclass(frozen=True)
class Made(Serialised):
    """What was made: files by role, volumes, masses to weigh, all checks, and the hash of the assembly."""

    files: dict[str, str]
    volumes_mm3: dict[str, float]
    masses_g: dict[str, float]
    checks: list[dict[str, Any]]
    step_sha256: str
    warnings: list[dict[str, str]]
    pour: dict[str, Any]
    spec_hash: str


M = TypeVar("M", bound=Made)


@dataclass(frozen=True)
class MouldResult(Made):
    """A mould that was made, with the batch to mix and where its pad is gauged."""

    batch: dict[str, Any]
    gauge_points: tuple[GaugePoint, ...]
    seconds: float = field(default=0.0, compare=False)
    memory_MB: float = field(default=0.0, compare=False)


def make_mold(spec: MouldSpec, folder: Path, processor_s: float = PROCESSOR_S, paper: str = "A4") -> MouldResult:
    """Build the mould of a specification with all its files into a folder; an error leaves nothing there."""
    validate(spec)
    check_layers(spec)
    asked = {
        "spec": spec.to_dict(),
        "processor_s": processor_s,
        "papers": papers(paper),
    }
    what = f"preset {spec.preset}, {spec.pad.title}, specification {spec.hash}"
    return _build(MouldResult, folder, ".mould-", asked, what, without_cad(spec))


def _build(kind: type[M], folder: Path, prefix: str, asked: dict[str, Any], what: str, known: dict[str, Any]) -> M:
    """Let the child make all files in a place of their own; they are moved when no check failed."""
    target = output_folder(folder)
    with tempfile.TemporaryDirectory(prefix=prefix, dir=target, ignore_cleanup_errors=True) as work:
        answer = {**known, **_made({**asked, "folder": work}, what, known)}
        files = answer["files"]
        result = kind(**{**answer, "files": {role: str(target / name) for role, name in files.items()}})
        failed = [item for item in result.checks if item["status"] == "fail"]
        if failed:
            names = "; ".join(f"{item['id']} = {item['value']} (limit {item['limit']})" for item in failed)
            message = f"the mould was built but failed {names}; no file was kept"
            raise NoAnswerError("check_failed", message, {**result.to_dict(), "files": {}}, "mould")
        _move(Path(work), target, files)
    return result


@dataclass(frozen=True)
class PuckResult(Made):
    """Rings of pucks that were made; hours and grams of printing are estimates."""

    printing_h: float
    filament_g: float
    seconds: float = field(default=0.0, compare=False)


def make_puck_rings(spec: PuckSpec, folder: Path, paper: str = "A4") -> PuckResult:
    """Build the rings of some pucks with all their files into a folder; an error leaves nothing there."""
    from dummydesign.mold.puck.plan import puck_plan, spec_cost, warnings_of

    plan, cost = puck_plan(spec), spec_cost(spec)
    known = {
        "files": {},
        "masses_g": dict(plan.mix.components),
        "pour": plan.to_dict(),
        "spec_hash": spec.hash,
        "printing_h": cost.printing_h,
        "filament_g": cost.filament_g,
        "warnings": warnings_of(spec, plan),
    }
    asked = {"puck": spec.to_dict(), "processor_s": PROCESSOR_S, "papers": papers(paper)}
    return _build(PuckResult, folder, ".puck-", asked, f"{spec.title}, specification {spec.hash}", known)


def _move(work: Path, target: Path, files: dict[str, str]) -> None:
    """Rename the checked files into place."""
    for name in files.values():
        if (target / name).is_dir():
            message = f"'{target / name}' is a folder; a file of that name has to be written"
            raise InputError(message, "file_exists", "out", str(target / name))
    with writing("output folder", target, "out"):
        for name in files.values():
            os.replace(work / name, target / name)


def without_cad(spec: MouldSpec) -> dict[str, Any]:
    """What is known of a mould without CAD: weights from closed forms, warnings, the hash."""
    plan = pour_plan(spec)
    return {
        "files": {},
        "masses_g": masses_g(plan.to_dict()),
        "pour": plan.to_dict(),
        "batch": batches_of(spec, plan),
        "spec_hash": spec.hash,
        "gauge_points": gauge_points(spec),
        "warnings": pour_warnings(spec, plan),
    }


def masses_g(pour: dict[str, Any]) -> dict[str, float]:
    """What is weighed: the resin's components (``NAME (base)`` of a base layer), the silicone of mould and lid. [g]"""
    masses = {part["name"]: part["mass_g"] for part in pour["components"]}
    under = pour.get("base", {"components": []})
    masses |= {f"{part['name']} (base)": part["mass_g"] for part in under["components"]}
    cast = {"silicone": pour["silicone_mass_g"], "silicone (lid)": pour["lid_silicone_mass_g"]}
    return masses | {name: mass for name, mass in cast.items() if mass}


def _made(asked: dict[str, Any], what: str, known: dict[str, Any]) -> dict[str, Any]:
    """Have the child make a mould, and turn every way it can end into a result or a named error with what is known."""
    processor_s = asked["processor_s"]
    done, answer = _answered(asked, HUNG_S)
    code, how = "cad_failed", ""
    if done is None:
        how = f"did not end within {HUNG_S:g} s"
    elif ran_out(done.returncode):
        how = f"did not finish within {processor_s:g} s of processor time"
    elif not answer:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        status = f"signal {-done.returncode}" if done.returncode < 0 else f"exit status {done.returncode}: {last}"
        how = f"ended without an answer ({status})"
    elif "error" not in answer:
        return answer
    else:
        code, how = answer["error"]["code"], f"failed: {answer['error']['message']}"
    message = f"the CAD kernel {how} ({what}); nothing was written"
    if code == "cad_unavailable":
        message = answer["error"]["message"]
    raise NoAnswerError(code, message, to_plain(known), "mould")


def papers(paper: str) -> dict[str, str]:
    """What drawings and sheet are on and carry: paper, command line as typed, date (``SOURCE_DATE_EPOCH`` if given)."""
    words = COMMAND_LINE.get()
    command = "" if words is None else shlex.join(["dummydesign", *words])
    fixed = os.environ.get("SOURCE_DATE_EPOCH", "")
    day = datetime.fromtimestamp(int(fixed), UTC) if fixed.isdigit() else datetime.now()
    return {"command": command, "date": day.date().isoformat(), "paper": paper}
