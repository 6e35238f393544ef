"""The child process that loads the CAD kernel: ``python -m dummydesign.mold.child_main question.json answer.json``.

It answers what was made, or an ``error`` {code, message}.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from pathlib import Path
from typing import Any

from dummydesign.core.blas_threads import limit_processor_time
from dummydesign.core.progress import leave
from dummydesign.mold.cad.kernel import cad_problem, load_trimesh


def run(asked: dict[str, Any]) -> dict[str, Any]:
    """Make the mould of the question; never raises for faults with a message."""
    if problem := cad_problem():
        return {"error": {"code": "cad_unavailable", "message": problem}}
    try:
        return _made(asked)
    except Exception as problem:
        text = " ".join(str(problem).split()) or "no message"
        return {"error": {"code": "cad_failed", "message": f"{type(problem).__name__}: {text}"}}


def _made(asked: dict[str, Any]) -> dict[str, Any]:
    from dummydesign.mold.files.pour_sheet import Foot

    start = time.perf_counter()
    if "puck" in asked:
        from dummydesign.mold.puck.build_files import produce_pucks
        from dummydesign.mold.puck.ring import PuckSpec

        pucks = PuckSpec.from_dict(asked["puck"])
        result = produce_pucks(pucks, Path(asked["folder"]), Foot(pucks.hash, **asked["papers"]))
    else:
        from dummydesign.mold.build_files import produce
        from dummydesign.mold.model.spec import MouldSpec

        spec = MouldSpec.from_dict(asked["spec"])
        result = produce(spec, Path(asked["folder"]), Foot(spec.hash, **asked["papers"]))
        result["memory_MB"] = peak_memory_MB()
    return {**result, "seconds": time.perf_counter() - start}


def peak_memory_MB() -> float:
    """Largest resident memory of this process so far, 0 where the system does not tell. [MB]"""
    try:
        import resource
    except ImportError:
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024**2 if sys.platform == "darwin" else 1024)


def main() -> None:
    """Entry point of the child."""
    if not cad_problem():
        # Loaded before the question comes: it comes when the other end closes this one's input.
        load_trimesh()
        import dummydesign.mold.build_files  # noqa: F401
    sys.stdin.read()
    asked = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    if "processor_s" in asked:
        limit_processor_time(asked["processor_s"])
    # Nothing that is made here lives in cycles: looking for them over and over takes a tenth of the time.
    gc.disable()
    Path(sys.argv[2]).write_text(json.dumps(run(asked), allow_nan=False), encoding="utf-8")


if __name__ == "__main__":
    main()
    # Taking the kernel apart takes as long as a third of loading it; the answer is on the disk.
    leave()
