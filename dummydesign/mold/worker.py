"""The child process that loads the CAD kernel: ``python -m dummydesign.mold.worker spec.json folder SECONDS``.

It writes ``.result.json`` into the folder: what was made, or an ``error`` {code, message}.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from pathlib import Path
from typing import Any

from dummydesign.core.process import leave, limit_processor_time
from dummydesign.mold.cad.kernel import cad_problem, load_trimesh

RESULT = ".result.json"


def run(spec_file: Path, folder: Path) -> dict[str, Any]:
    """Make the mould described in ``spec_file``; never raises for faults with a message."""
    problem = cad_problem()
    if problem:
        return {"error": {"code": "cad_unavailable", "message": problem}}
    from dummydesign.mold.files.pour_sheet_pdf import Foot
    from dummydesign.mold.model.spec import MouldSpec
    from dummydesign.mold.produce import produce

    load_trimesh()
    asked = json.loads(spec_file.read_text(encoding="utf-8"))
    spec = MouldSpec.from_dict(asked["spec"])
    start = time.perf_counter()
    try:
        result = produce(spec, folder, Foot(spec.hash, **asked["papers"]), asked["bone"] and Path(asked["bone"]))
    except Exception as problem:
        text = " ".join(str(problem).split()) or "no message"
        return {"error": {"code": "cad_failed", "message": f"{type(problem).__name__}: {text}"}}
    result["seconds"] = time.perf_counter() - start
    result["memory_MB"] = peak_memory_MB()
    return result


def peak_memory_MB() -> float:
    """Largest resident memory of this process so far, 0 where the system does not tell. [MB]"""
    try:
        import resource
    except ImportError:
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024**2 if sys.platform == "darwin" else 1024)


def main() -> None:
    """Entry point of the child; the last word is the processor time that it may use. [s]"""
    limit_processor_time(float(sys.argv[3]))
    # Nothing that is made here lives in cycles: looking for them over and over takes a tenth of the time.
    gc.disable()
    spec_file, folder = Path(sys.argv[1]), Path(sys.argv[2])
    result = run(spec_file, folder)
    (folder / RESULT).write_text(json.dumps(result, allow_nan=False), encoding="utf-8")


if __name__ == "__main__":
    main()
    # Taking the kernel apart takes as long as a third of loading it; the answer is on the disk.
    leave()
