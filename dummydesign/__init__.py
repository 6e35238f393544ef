"""Design soft dummies of human hand tissue: resin recipe, pad geometry, mould, and the loop with measured data.

Inside the package lengths are in mm, forces in N, times in s and stresses in MPa;
the unit is part of every outward name.

``suggest``, ``predict``, ``whatif``, ``fit`` and the others in :mod:`dummydesign.api` are the calls for scripts; they
are imported when first used.
"""

from typing import Any

from dummydesign._version import __version__

CALLS = (
    "calibrate",
    "close_loop",
    "compare",
    "fit",
    "import_traces",
    "load_resin",
    "load_tissue",
    "make_mould",
    "on_person",
    "predict",
    "record_pad",
    "replay",
    "suggest",
    "whatif",
)
__all__ = ["__version__", *CALLS]


def __getattr__(name: str) -> Any:
    if name in CALLS:
        from dummydesign import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
