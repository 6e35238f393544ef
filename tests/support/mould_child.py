"""Code of a child that makes a mould's specification and the volumes of the closed forms, without CAD."""

from __future__ import annotations

CHILD = """
import json, pathlib, sys
asked = json.load(open(sys.argv[1])); folder = pathlib.Path(asked["folder"])
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import gauge_points
from dummydesign.mold.pour.plan import batches_of
from dummydesign.mold.pour.plan import pour_plan
spec = MouldSpec.from_dict(asked["spec"]); plan = pour_plan(spec)
points = [one.to_dict() for one in gauge_points(spec)]
(folder / "spec.json").write_text(json.dumps({"hash": spec.hash, "spec": spec.to_dict(), "gauge_points": points}))
volumes = {"cavity": 1.0, "pad_nominal": 1.0, "pad_compensated": plan.cavity_mm3}
volumes |= {"mould": 1e5, "master": 1.2e5, "tray": 7e4}
status = "fail" if spec.pad.thickness_mm == 7.0 else "pass"
checks = [{"id": "a", "value": 1.0, "limit": 1.0, "status": status}]
found = {"files": {"spec": "spec.json"}, "volumes_mm3": volumes, "checks": checks, "warnings": [],
         "pour": plan.to_dict(), "batch": batches_of(spec, plan), "step_sha256": "0", "seconds": 1.0, "memory_MB": 1.0}
pathlib.Path(sys.argv[2]).write_text(json.dumps(found))
"""
