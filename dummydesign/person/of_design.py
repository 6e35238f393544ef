"""The predicted presses of a recommended pad, carried over to people."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design.scoring.presses import press_to_depth
from dummydesign.measurement.trace import Trace
from dummydesign.person.drives.drive import Drive
from dummydesign.person.on_person import OnPerson, on_person

if TYPE_CHECKING:
    from dummydesign.design.assessment.safety import Limits
    from dummydesign.design.suggestion import Suggestion

APPROACH_S, APPROACH_SAMPLES = 0.01, 12
KEPT = "beyond_range"
"""Warning that is of the presses; what the motion of a measured file shows does not apply to one that is assumed."""


def design_on_people(answer: Suggestion, drive: Drive, limits: Limits | None = None) -> OnPerson:
    """Carry the predicted presses of the recommended pad over to the subjects; one press a condition in reach."""
    pressed = on_person(predicted_traces(answer), answer.tissue, drive, limits=limits, area_mm2=answer.punch.area_mm2)
    kept = tuple(one for one in pressed.warnings if one["code"] == KEPT)
    return replace(pressed, presses=tuple(replace(one, contradicted="") for one in pressed.presses), warnings=kept)


def predicted_traces(answer: Suggestion) -> list[Trace]:
    """Return the predicted press of each condition as a trace, with a short approach before contact."""
    slabs = answer.best.evaluation.slabs.take(np.array([answer.best.index]))
    depths = answer.best.evaluation.depth_mm[answer.best.index]
    traces = []
    for column, condition in enumerate(answer.targets.conditions):
        if not np.isfinite(depths[column]):
            continue
        speed = condition.velocity_mm_s
        press = press_to_depth(slabs, depths[[column]], speed, answer.targets.sampling)
        time, order = np.unique(press.time_s[0], return_index=True)
        distinct = np.r_[True, np.diff(time) > 1e-7]
        time, x, force = time[distinct], press.displacement_mm[0][order][distinct], press.force_N[0][order][distinct]
        touch = float((x[1] - x[0]) / (time[1] - time[0]))
        lead = np.linspace(-APPROACH_S, 0.0, APPROACH_SAMPLES + 1)[:-1]
        traces.append(Trace(f"{condition.steady_force_N:g} N, {speed:g} mm/s", np.r_[lead, time],
                            np.r_[touch * lead, x], np.r_[0.0 * lead, force], speed))  # fmt: skip
    return traces


def to_dict(answer: OnPerson) -> dict[str, Any]:
    """Return what ``suggest --drive`` adds to its answer."""
    return {"drive": answer.drive.text, "presses": [one.to_dict(answer.area_mm2) for one in answer.presses]}
