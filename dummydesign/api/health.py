"""What a machine lacks: versions, optional parts, folders, one solve and one solid."""

from __future__ import annotations

import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path

from dummydesign.core import cache
from dummydesign.core.blas_threads import surroundings
from dummydesign.core.errors import DummydesignError
from dummydesign.core.serialise import Serialised
from dummydesign.core.user_library import user_folder

NEEDED = ("numpy", "scipy", "scikit-fem", "threadpoolctl", "typst", "pillow")
PARTS = (
    ("mould", ("cadquery", "trimesh", "networkx", "lxml", "ezdxf"), "", "moulds and their DXF"),
    ("pictures", ("matplotlib",), "", "pictures of stress, plots in Python"),
    ("fields", ("pyvista",), "", "pictures of moulds, fields for ParaView, bones of many triangles"),
    ("studio", ("nicegui",), "dummydesign[studio]", "the pages in the browser"),
    ("tables", ("pandas", "xarray"), "dummydesign[tables]", "data frames in Python"),
    ("xlsx", ("python-calamine",), "dummydesign[xlsx]", "workbooks of test machines"),
    ("cluster", ("distributed",), "dummydesign[cluster]", "large sweeps on several machines"),
)
"""A part, its packages, the extra that brings them (else they are installed by name), and what it is for."""
SOLVE_LIMIT = 0.03
"""Largest difference of the trial solve from the response table, relative."""
SOLID_S = 120.0
SOLID = """
import sys
from dummydesign.mold.cad.kernel import cad_problem, cq
if problem := cad_problem():
    sys.exit(problem)
print(cq.Workplane().box(30, 20, 10).val().Volume())
"""


@dataclass(frozen=True)
class HealthCheck(Serialised):
    """One thing looked at: ``status`` is ok, missing (optional) or failed; ``advice`` is what to type."""

    name: str
    status: str
    value: str
    advice: str = ""


@dataclass(frozen=True)
class Health(Serialised):
    """All checks of a machine; ``ready`` when none failed."""

    checks: tuple[HealthCheck, ...]
    ready: bool
    warnings: tuple[dict[str, str], ...] = field(default=())


def check_machine(solid: bool = True) -> Health:
    """Look at versions, parts, folders, one solve and, with ``solid``, one solid."""
    checks = [*_versions(), *_parts(), *_folders(), _solve(), *([_solid()] if solid else [])]
    return Health(tuple(checks), all(one.status != "failed" for one in checks))


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _versions() -> Iterator[HealthCheck]:
    from dummydesign._version import __version__

    yield HealthCheck("dummydesign", "ok", __version__)
    yield HealthCheck("python", "ok", f"{platform.python_version()}, {platform.system()} {platform.machine()}")
    versions = {name: _version(name) for name in NEEDED}
    lacking = [name for name, version in versions.items() if version is None]
    text = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    yield HealthCheck(
        "packages", "failed" if lacking else "ok", text, f"pip install {' '.join(lacking)}" if lacking else ""
    )


def _parts() -> Iterator[HealthCheck]:
    for name, packages, extra, purpose in PARTS:
        versions = {package: _version(package) for package in packages}
        lacking = [package for package, version in versions.items() if version is None]
        if lacking:
            wanted = f"'{extra}'" if extra else " ".join(lacking)
            yield HealthCheck(name, "missing", f"no {', '.join(lacking)}", f"for {purpose}: pip install {wanted}")
        else:
            yield HealthCheck(name, "ok", ", ".join(f"{package} {version}" for package, version in versions.items()))


def _folders() -> Iterator[HealthCheck]:
    yield _writable("this folder", Path.cwd(), "change to a folder of your own")
    yield _writable("own data", user_folder(), "set DUMMYDESIGN_HOME to a folder that you can write to")
    folder = cache.folder()
    if folder is None:
        yield HealthCheck("cache", "missing", "off: every solve is made again", "unset DUMMYDESIGN_CACHE")
        return
    size = sum(path.stat().st_size for path in folder.rglob("*.json")) if folder.is_dir() else 0
    check = _writable("cache", folder, "set DUMMYDESIGN_CACHE to a folder that you can write to")
    # without a cache answers are the same, only later
    status = "missing" if check.status == "failed" else check.status
    yield HealthCheck("cache", status, f"{check.value}, {size / 1e6:.1f} MB", check.advice)


def _writable(name: str, folder: Path, advice: str) -> HealthCheck:
    """Whether a file can be made there, or in the nearest folder above that exists."""
    there = next((path for path in (folder, *folder.parents) if path.is_dir()), None)
    try:
        if there is None:
            raise OSError("no such folder")
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as problem:
        return HealthCheck(name, "failed", f"{folder}: {problem.strerror or problem}", advice)
    return HealthCheck(name, "ok", f"{folder}, can be written to")


def _solve() -> HealthCheck:
    """Solve a small slab by finite elements and compare it with its response table."""
    try:
        from dummydesign.pad.pad_under_punch import Pad
        from dummydesign.pad.predict import predict_static

        begun = time.perf_counter()
        pad = Pad(10.0, 0.03, 7.9)
        forces = [float(predict_static(pad, [1.0], fidelity=name).force_N[0]) for name in ("axisymmetric", "table")]
    except (DummydesignError, ImportError, ArithmeticError, OSError) as problem:
        return HealthCheck("solve", "failed", " ".join(str(problem).split()), "install the package again")
    away = abs(forces[0] / forces[1] - 1.0)
    text = f"{forces[0]:.3f} N, {100 * away:.2f} % from the stored solution, {time.perf_counter() - begun:.1f} s"
    advice = "" if away <= SOLVE_LIMIT else "report it with the versions above"
    return HealthCheck("solve", "ok" if away <= SOLVE_LIMIT else "failed", text, advice)


def _solid() -> HealthCheck:
    """Make a box with the CAD kernel in a process of its own, as a kernel that lacks a library may end the process."""
    advice = "Debian, Ubuntu: apt-get install libgl1 libx11-6; without moulds use --no-cad"
    begun = time.perf_counter()
    try:
        words = [sys.executable, "-c", SOLID]
        done = subprocess.run(
            words,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=SOLID_S,
            check=False,
            env=surroundings(),
        )
    except (OSError, subprocess.TimeoutExpired) as problem:
        return HealthCheck("solid", "missing", f"{type(problem).__name__}", advice)
    printed = done.stdout.split()
    if done.returncode or not printed:
        last = (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]
        value, _, remedy = last.partition(": pip install ")
        return HealthCheck("solid", "missing", value, f"pip install {remedy}" if remedy else advice)
    exact = abs(float(printed[-1]) / 6000.0 - 1.0) < 1e-9
    text = f"box of {float(printed[-1]):.1f} mm3, {time.perf_counter() - begun:.1f} s"
    return HealthCheck("solid", "ok" if exact else "failed", text, "" if exact else "install cadquery again")
