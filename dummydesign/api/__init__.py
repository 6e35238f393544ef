"""The calls for scripts; each result has ``to_dict()``, what the command of the same name prints with ``--json``.

    import dummydesign
    answer = dummydesign.suggest("forefinger")
    answer.to_dict()["recommendation"]["thickness_mm"]

The command line calls these functions, with the same defaults, and prints what they return. Heavy packages are
imported when a function runs.
"""

from dummydesign.api.answers import Answer, Fitted, Result, Rows
from dummydesign.api.campaign_calls import calibrate, replay
from dummydesign.api.comparison_calls import compare_designs
from dummydesign.api.design_calls import suggest
from dummydesign.api.import_calls import import_traces
from dummydesign.api.mould_calls import make_mould, record_pad
from dummydesign.api.predict_calls import predict
from dummydesign.api.sweep_calls import whatif
from dummydesign.api.trace_calls import compare, fit
from dummydesign.resin import load_resin
from dummydesign.tissue import load_tissue

close_loop = calibrate

__all__ = [
    "Answer", "Fitted", "Result", "Rows", "calibrate", "close_loop", "compare", "compare_designs", "fit",
    "import_traces", "load_resin", "load_tissue", "make_mould", "predict", "record_pad", "replay", "suggest", "whatif",
]  # fmt: skip
