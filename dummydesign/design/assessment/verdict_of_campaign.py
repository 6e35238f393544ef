"""The verdicts on the pads of a campaign: the presses of each pad against a tissue's subjects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import DummydesignError
from dummydesign.design.assessment.verdict_of_traces import verdict_of_traces
from dummydesign.design.scoring.verdict import LEVELS, Verdict
from dummydesign.tissue.comparison.compare import compare_traces

if TYPE_CHECKING:
    from dummydesign.measurement.campaign import Campaign
    from dummydesign.tissue.model.tissue import Tissue


@dataclass(frozen=True)
class PadVerdict:
    """One pad of a campaign with its verdict, or the reason why it has none."""

    shape: str
    thickness_mm: float
    presses: int
    verdict: Verdict | None
    reason: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return all fields as plain values."""
        judged = None if self.verdict is None else self.verdict.to_dict()
        return {"shape": self.shape or "slab", "thickness_mm": self.thickness_mm, "presses": self.presses,
                "verdict": judged, "reason": self.reason or None}  # fmt: skip


def verdicts_of_campaign(campaign: Campaign, tissue: Tissue) -> tuple[PadVerdict, ...]:
    """Judge every pad of a campaign by its own presses, the worst level first.

    Parameters
    ----------
    campaign : Campaign
    tissue : Tissue
    """
    found = []
    for shape, thickness in dict.fromkeys(trial.pad for trial in campaign.trials):
        traces = [trial.trace for trial in campaign.trials if trial.pad == (shape, thickness)]
        judged, reason = None, ""
        try:
            judged = verdict_of_traces(compare_traces(traces, tissue, campaign.lowpass), tissue)
        except DummydesignError as problem:
            reason = str(problem)
        found.append(PadVerdict(shape, thickness, len(traces), judged, reason))
    return tuple(sorted(found, key=lambda pad: -1 if pad.verdict is None else LEVELS.index(pad.verdict.level),
                        reverse=True))  # fmt: skip
