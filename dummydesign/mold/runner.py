"""Make a mould from outside: a child process does the CAD, checked files are renamed into place."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.files import output_folder
from dummydesign.core.outputs.manifest import COMMAND_LINE
from dummydesign.core.threads import ONE_THREAD
from dummydesign.mold.gauging.points import gauge_points
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.model.validate import validate
from dummydesign.mold.pour.batch import batches_of
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.print_layers import check_layers
from dummydesign.mold.pour.warnings import pour_warnings
from dummydesign.mold.processor_time import HUNG_S, ran_out

PROCESSOR_S = 900.0
"""Processor time after which the CAD kernel is given up; the largest moulds take a tenth of it. [s]"""
RESULT = ".result.json"
WORKER = ("-m", "dummydesign.mold.worker")


@dataclass(frozen=True)
class MouldResult:
    """What was made: files by role, volumes, masses to weigh, all checks, and the hash of the assembly."""

    files: dict[str, str]
    volumes_mm3: dict[str, float]
    masses_g: dict[str, float]
    checks: tuple[dict[str, Any], ...]
    step_sha256: str
    warnings: tuple[dict[str, str], ...]
    pour: dict[str, Any]
    spec_hash: str
    batch: dict[str, Any]
    gauge_points: tuple[dict[str, Any], ...]
    seconds: float = field(default=0.0, compare=False)
    memory_MB: float = field(default=0.0, compare=False)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values."""
        plain = asdict(self)
        listed = {key: list(plain[key]) for key in ("checks", "warnings", "gauge_points")}
        return {**plain, **listed}


def make_mold(
    spec: MouldSpec, folder: Path, processor_s: float = PROCESSOR_S, bone_file: Path | None = None
) -> MouldResult:
    """Build the mould of a specification with all its files into a folder.

    Parameters
    ----------
    spec : MouldSpec
        From :func:`dummydesign.mold.model.preset.mould_spec`.
    folder : Path
        Made when needed; files of the same name are replaced, and only when everything has been checked.
    processor_s : float
        Processor time after which the child process is ended, whatever the clock says. [s]
    bone_file : Path, optional
        Placed solid of a bone from a file, as :func:`dummydesign.mold.bone.place.place_bone` writes it.

    Returns
    -------
    MouldResult

    Raises
    ------
    InputError
        When the specification or the folder cannot be used.
    NoAnswerError
        ``cad_unavailable`` when CadQuery or a system library is missing, ``cad_failed`` when the kernel
        failed, crashed or took too long, ``check_failed`` when a check failed. What is known without CAD
        (weights, warnings) or was found (checks) is in its ``result``; no file is left under a final name.
    """
    validate(spec)
    check_layers(spec)
    if spec.insert is not None and bone_file is None:
        raise InputError(f"the bone of this mould comes from {spec.insert.file}; give the file again")
    target = output_folder(folder)
    work = Path(tempfile.mkdtemp(prefix=".mould-", dir=target))
    try:
        found = _run_child(spec, work, processor_s, bone_file)
        result = _result(spec, found, target)
        failed = [item for item in result.checks if item["status"] == "fail"]
        if failed:
            names = "; ".join(f"{item['id']} = {item['value']} (limit {item['limit']})" for item in failed)
            partial = {**result.to_dict(), "files": {}}
            raise NoAnswerError("check_failed", f"the mould was built but failed {names}; no file was kept", partial)
        _move(work, target, found["files"])
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return result


def without_cad(spec: MouldSpec) -> dict[str, Any]:
    """What is known of a mould without CAD: weights from closed forms, warnings, the hash."""
    plan = pour_plan(spec)
    return {
        "files": {},
        "masses_g": masses_g(plan.to_dict()),
        "pour": plan.to_dict(),
        "batch": batches_of(spec, plan),
        "spec_hash": spec.hash,
        "gauge_points": [point.to_dict() for point in gauge_points(spec)],
        "warnings": pour_warnings(spec, plan),
    }


def masses_g(pour: dict[str, Any]) -> dict[str, float]:
    """What is weighed: the resin's components, those of a layered pad's base as ``NAME (base)``, the silicone. [g]"""
    masses = {part["name"]: part["mass_g"] for part in pour["components"]}
    under = pour.get("base", {"components": []})
    masses |= {f"{part['name']} (base)": part["mass_g"] for part in under["components"]}
    return {**masses, "silicone": pour["silicone_mass_g"]} if pour["silicone_mass_g"] else masses


def _run_child(spec: MouldSpec, work: Path, processor_s: float, bone_file: Path | None = None) -> dict[str, Any]:
    """Start the child, wait, and turn every way it can end into a result or a named error."""
    spec_file = work / ".spec.json"
    asked = {"spec": spec.to_dict(), "papers": papers(), "bone": str(bone_file) if bone_file else None}
    spec_file.write_text(json.dumps(asked), encoding="utf-8")
    package = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path}
    command = [sys.executable, *WORKER, str(spec_file), str(work), f"{processor_s:g}"]
    what = f"preset {spec.preset}, {spec.pad.title}, specification {spec.hash}"
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S, env=environment)
    except subprocess.TimeoutExpired:
        message = f"the CAD kernel did not end within {HUNG_S:g} s ({what}); nothing was written"
        raise NoAnswerError("cad_failed", message, without_cad(spec)) from None
    if ran_out(done.returncode):
        took = f"{processor_s:g} s of processor time"
        message = f"the CAD kernel did not finish within {took} ({what}); nothing was written"
        raise NoAnswerError("cad_failed", message, without_cad(spec))
    answer = work / RESULT
    if not answer.is_file():
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        how = f"signal {-done.returncode}" if done.returncode < 0 else f"exit status {done.returncode}: {last}"
        message = f"the CAD kernel ended without an answer ({how}; {what}); nothing was written"
        raise NoAnswerError("cad_failed", message, without_cad(spec))
    found = json.loads(answer.read_text(encoding="utf-8"))
    if "error" in found:
        code, text = found["error"]["code"], found["error"]["message"]
        message = text if code == "cad_unavailable" else f"the CAD kernel failed: {text} ({what}); nothing was written"
        raise NoAnswerError(code, message, without_cad(spec))
    return found


def papers() -> dict[str, str]:
    """What drawings and sheet carry besides: the command line as typed, the date (``SOURCE_DATE_EPOCH`` if given)."""
    words = COMMAND_LINE.get()
    command = "" if words is None else shlex.join(["dummydesign", *words])
    fixed = os.environ.get("SOURCE_DATE_EPOCH", "")
    day = datetime.fromtimestamp(int(fixed), UTC) if fixed.isdigit() else datetime.now()
    return {"command": command, "date": day.date().isoformat()}


def _result(spec: MouldSpec, found: dict[str, Any], target: Path) -> MouldResult:
    return MouldResult(
        files={role: str(target / name) for role, name in found["files"].items()},
        volumes_mm3=found["volumes_mm3"],
        masses_g=masses_g(found["pour"]),
        checks=tuple(found["checks"]),
        step_sha256=found["step_sha256"],
        warnings=tuple(found["warnings"]),
        pour=found["pour"],
        spec_hash=spec.hash,
        batch=found["batch"],
        gauge_points=tuple(point.to_dict() for point in gauge_points(spec)),
        seconds=found["seconds"],
        memory_MB=found["memory_MB"],
    )


def _move(work: Path, target: Path, files: dict[str, str]) -> None:
    """Rename the checked files into place.

    Raises
    ------
    InputError
        When a final name is taken by a folder or cannot be written.
    """
    for name in files.values():
        if (target / name).is_dir():
            raise InputError(f"'{target / name}' is a folder; a file of that name has to be written")
    try:
        for name in files.values():
            os.replace(work / name, target / name)
    except OSError as problem:
        raise InputError(f"output folder '{target}' cannot be written: {problem.strerror or problem}") from None
