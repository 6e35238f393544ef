"""Results of long solves, kept in the user's cache folder and found again by a hash of what was asked.

An entry is named by its kind and the hash of its canonical inputs and of what made it: the package's version, all
its sources, the shipped tables that solved results are multiplied with, and the versions of the numerical libraries.
A changed solver or table therefore never serves old numbers. Results are computed with one thread for linear
algebra, so that they do not depend on the machine's number of cores. An entry carries a checksum; what is damaged,
truncated or foreign is taken as absent and made anew. A folder that cannot be written means work without a cache,
never an error.

The folder is the platform's cache folder, or the one that ``DUMMYDESIGN_CACHE`` names; ``off`` turns it off.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.user_library import data_folder

VARIABLE = "DUMMYDESIGN_CACHE"
MOST_BYTES = 200_000_000
MOST_ENTRIES = 5000
# Pruning goes this far below the bounds, so that it is not due again at the next entry.
_KEPT_SHARE = 0.9
# A temporary file this old was left behind by a writer that is gone.
_STALE_S = 3600.0
_ENTRY = re.compile(r"[\w-]+-[0-9a-f]{40}\.json")
_PACKAGE = __name__.partition(".")[0]
_PREFIX, _TEMPORARY = ".dummydesign-", ".part"


def folder() -> Path | None:
    """The cache folder, which need not exist; None when the cache is off or there is no home for it."""
    named = os.environ.get(VARIABLE, "").strip()
    if named.lower() == "off":
        return None
    try:
        if named:
            return Path(named)
        if sys.platform == "win32":
            return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "dummydesign" / "Cache"
        if sys.platform == "darwin":
            return Path.home() / "Library" / "Caches" / "dummydesign"
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "dummydesign"
    except RuntimeError:  # no home folder
        return None


def cached(kind: str, inputs: Mapping[str, Any], compute: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Return what ``compute()`` returns, from the cache if it was computed before."""
    compute = one_blas_thread()(compute)
    home = folder()
    if home is None:
        return compute()
    try:
        asked = _text({"kind": kind, "code": code_version(), "inputs": _canonical(dict(inputs))})
    except (TypeError, OSError):  # OSError: the sources cannot be read
        return compute()
    path = home / f"{kind}-{hashlib.sha256(asked.encode()).hexdigest()[:40]}.json"
    kept = _read(path, asked)
    if kept is not None:
        return kept
    made = compute()
    try:
        body = _text(_encoded(made))
    except TypeError:
        return made
    with suppress(OSError):
        _write(path, asked, body)
        _prune(home)
    return _decoded(json.loads(body))


@lru_cache(maxsize=1)
def code_version() -> str:
    """Hash of the package's version, its sources and tables, and the numerical libraries' versions.

    All sources count, not only those that solve: which ones a result depends on is not known here, and a list
    would be wrong with the next module that moves. Reading them takes some 10 ms.
    """
    from importlib.metadata import PackageNotFoundError, version

    from dummydesign._version import __version__

    digest = hashlib.sha256(__version__.encode())
    for path in sources():
        # the hash of each file by itself: where one ends and the next begins is part of the answer
        digest.update(f"{path.parent.name}/{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    for library in ("numpy", "scipy", "scikit-fem"):
        with suppress(PackageNotFoundError):
            digest.update(f"{library} {version(library)}".encode())
    return digest.hexdigest()


def package_folder() -> Path:
    """The folder of the package, wherever this module lies in it."""
    return Path(str(sys.modules[_PACKAGE].__file__)).parent


def sources() -> list[Path]:
    """All files that results depend on: the package's sources and the shipped tables, at any depth."""
    paths = []
    for root, ending in ((package_folder(), ".py"), (data_folder() / "materials" / "tables", ".json")):
        files = sorted(root.rglob(f"*{ending}"))
        if not files:
            raise FileNotFoundError(f"{root} holds no {ending} files")
        paths += files
    return paths


def _text(value: Any) -> str:
    return json.dumps(value, sort_keys=True, separators=(",", ":"))


def _canonical(value: Any) -> Any:
    """Plain values that stand for ``value``, alike for equal inputs; TypeError for what has no such form."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if value is None or isinstance(value, (bool, str, int)):
        return value
    if isinstance(value, float):
        return value + 0.0  # -0.0 becomes 0.0
    if isinstance(value, (list, tuple)):
        return [_canonical(one) for one in value]
    if isinstance(value, Mapping):
        return {str(name): _canonical(one) for name, one in value.items()}
    own = type(value).__module__.partition(".")[0] == _PACKAGE
    if is_dataclass(value) and not isinstance(value, type) and own:
        content = {field.name: _canonical(getattr(value, field.name)) for field in fields(value)}
        return {type(value).__qualname__: content}
    raise TypeError(f"{type(value).__name__} has no canonical form")


def _encoded(value: Any) -> Any:
    """Plain values from which ``_decoded`` makes an equal one."""
    if isinstance(value, np.ndarray):
        return {"": "array", "type": value.dtype.str, "shape": list(value.shape), "values": value.ravel().tolist()}
    if isinstance(value, np.generic):
        return _encoded(value.item())
    if isinstance(value, tuple):
        return {"": "tuple", "values": [_encoded(one) for one in value]}
    if isinstance(value, list):
        return [_encoded(one) for one in value]
    if isinstance(value, Mapping):
        return {"": "map", "values": [[_encoded(name), _encoded(one)] for name, one in value.items()]}
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"{type(value).__name__} cannot be kept")


def _decoded(value: Any) -> Any:
    if isinstance(value, list):
        return [_decoded(one) for one in value]
    if not isinstance(value, dict):
        return value
    if value[""] == "array":
        return np.array(value["values"], dtype=np.dtype(value["type"])).reshape(value["shape"])
    if value[""] == "tuple":
        return tuple(_decoded(one) for one in value["values"])
    return {_decoded(name): _decoded(one) for name, one in value["values"]}


def _checksum(asked: str, body: str) -> str:
    return hashlib.sha256(f"{asked}\n{body}".encode()).hexdigest()


def _read(path: Path, asked: str) -> dict[str, Any] | None:
    """The value of an entry: three lines of checksum, what was asked, and the value; None unless all is sound."""
    try:
        checksum, question, body = path.read_text(encoding="utf-8").split("\n")
        if question != asked or checksum != _checksum(asked, body):
            return None
        value = _decoded(json.loads(body))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    with suppress(OSError):
        os.utime(path)  # the entries used last are pruned last
    return value if isinstance(value, dict) else None


def _write(path: Path, asked: str, body: str) -> None:
    """Write an entry under a temporary name of its own and rename it; readers never see half of one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, part = tempfile.mkstemp(prefix=_PREFIX, suffix=_TEMPORARY, dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as stream:
            stream.write("\n".join((_checksum(asked, body), asked, body)))
        os.replace(part, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(part)
        raise


def _prune(home: Path) -> None:
    """Remove the entries that were unused for longest when there are too many, and what dead writers left."""
    entries, total = [], 0
    for path in home.iterdir():
        with suppress(OSError):
            state = path.stat()
            if path.name.startswith(_PREFIX) and time.time() - state.st_mtime > _STALE_S:
                path.unlink()
            elif _ENTRY.fullmatch(path.name):  # a user may have named a folder that holds other things
                entries.append((state.st_mtime, state.st_size, path))
                total += state.st_size
    if total <= MOST_BYTES and len(entries) <= MOST_ENTRIES:
        return
    count = len(entries)
    for _, size, path in sorted(entries, key=lambda entry: entry[0]):
        if total <= _KEPT_SHARE * MOST_BYTES and count <= _KEPT_SHARE * MOST_ENTRIES:
            return
        with suppress(OSError):
            path.unlink()
            total, count = total - size, count - 1
