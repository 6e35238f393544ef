"""What to do now, in order: one puck of a batch that was not measured, else the pad; hours and grams of each step."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.parsing import command_words
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.problem import recipe_of_pour
from dummydesign.design.request import Request
from dummydesign.design.scoring.verdict import OUT_OF_REACH, OUTCOMES, PEAK, deviations, ranges_of
from dummydesign.design.suggestion import Suggestion
from dummydesign.design.test_conditions import beyond_people
from dummydesign.mold.pour.bill_of_materials import MouldCost, mould_cost
from dummydesign.mold.pour.plan import WITNESS_MM
from dummydesign.mold.puck.plan import BATCH, SPEEDS_MM_S, command, ring_cost, trace_names

TYPED_AGAIN = (
    "aim",
    "punch",
    "edge_radius_mm",
    "force_N",
    "velocity_mm_s",
    "hold_s",
    "base",
    "condition",
    "deceleration_mm_s2",
)
"""Options of the next search beside tissue, resin and mould, in the order in which they are typed."""
SEARCHED_AGAIN = ("shape", "preset", "pad_mm", "thickness_mm", "ratio", "sites")
"""Those that a mould which is kept has decided already."""
TEST = ("punch", "edge_radius_mm", "force_N", "velocity_mm_s", "hold_s")
"""Options of the test that a campaign and 'compare' have as well."""
CAMPAIGN = "my-dummy"
PRESS_PEOPLE = (
    "press people with these forces; read the presses with 'dummydesign import' and 'dummydesign fit', "
    "keep them with 'dummydesign tissues add'"
)
STIFFER = "a stiffer resin, or a thicker pad (--thickness)"
# Least gain of usable castings for which a puck is pressed: twice the standard error of a share.
GAIN = 0.03
# A puck and its two presses on the machine, and a pad by the protocol. [h]
PRESSING_H = 0.5


@dataclass(frozen=True)
class Step(Serialised):
    """One step: what to do, the command to type, hours until it is done, and what it takes; None where it has none.

    ``cost`` is material in grams by what it is: presets hold no prices.
    """

    do: str
    command: str | None = None
    hours: float | None = None
    cost: dict[str, float] | None = None


@dataclass(frozen=True)
class PadPath(Serialised):
    """A way to a pad that can be used: steps, printing and calendar hours, and the castings that are usable then."""

    name: str
    printing_h: float | None
    calendar_h: float | None
    grams: dict[str, float]
    usable: float
    text: str


def whole_answer(answer: Suggestion, inputs: dict[str, Any], mould: dict[str, Any] | None = None) -> dict[str, Any]:
    """Return the answer with the question and what to do next; with a mould, the recipe is that of its volumes."""
    steps, plain = next_steps(answer, inputs), answer.to_dict()
    ahead = {"next": to_plain(steps), "paths": to_plain(paths_of(answer))}
    ahead["rests_on"] = {**plain["rests_on"], "next_step": steps[0].do}
    whole = {"inputs": inputs, **plain, **ahead, "files": {}}
    if mould is None:
        return whole
    known = whole["sources"]
    return {
        **whole,
        "recommendation": {
            **whole["recommendation"],
            "recipe": recipe_of_pour(mould["pour"]),
            "batch": mould["batch"],
        },
        "warnings": [*whole["warnings"], *mould["warnings"]],
        "sources": [*known, *(text for text in mould["sources"] if text not in known)],
        "files": mould["files"],
        "mold": {key: value for key, value in mould.items() if key not in ("files", "warnings", "sources")},
    }


def next_steps(answer: Suggestion, inputs: Mapping[str, Any]) -> list[Step]:
    """Steps from an answer on."""
    if answer.verdict.level == "not_representative":
        return [Step(f"do not cast this pad: {why_red(answer)}")]
    beyond = beyond_people(answer.request.protocol.forces_N, answer.problem.tissue) > 1.0
    people = [Step(PRESS_PEOPLE)] if beyond else []
    # of a batch that was measured a second puck shows nothing new
    if not answer.resin.measured and ((answer.verdict.level == "not_settled" and not beyond) or _puck_helps(answer)):
        return [*people, *_puck_first(answer, inputs)]
    return [*people, *_pad(answer, inputs)]


def _puck_helps(answer: Suggestion) -> bool:
    """Whether more castings are acceptable after one puck: those that need no correction where most can be such."""
    shares = answer.shares
    name = "stands_for" if shares.resin_known.stands_for > 0.5 else "usable"
    return bool(getattr(shares.after_puck, name) - getattr(shares.as_poured, name) >= GAIN)


def _pad(answer: Suggestion, inputs: Mapping[str, Any]) -> list[Step]:
    """Cast the pad, press it by a campaign and compare it with the subjects."""
    made, best = _mould(answer), answer.best
    # a calibration is of an earlier dummy, whose folder may be there
    numbered = (f"{CAMPAIGN}-{number}" for number in count(2))
    name = next(one for one in numbered if not Path(one).exists()) if inputs.get("calibration") else CAMPAIGN
    sheet = [] if _written(inputs) else [Step("make its mould and pour sheet", answer.mould_command)]
    hours = None if made.printing_h is None else made.printing_h + _curing_h(answer)
    given = {**inputs, "resin": str(inputs["resin"]), "condition": _typed_condition(inputs)}
    shape = "" if best.shape.plain else f" --shape {shlex.quote(str(best.shape))}"
    contact = f" --contact {given['condition']}" if given["condition"] else ""
    planned = (
        f"dummydesign campaign new {name} --resin {shlex.quote(given['resin'])} --ratio {best.ratio:g} "
        f"--pads {best.thickness_mm:g}{shape}{command_words(Request, given, ('pad_mm', 'base', *TEST))}{contact}"
    )
    words = command_words(Request, given, (*TEST, "condition", "deceleration_mm_s2"))
    return [
        *sheet,
        Step("cast the pad by its pour sheet", None, hours, {"silicone": made.silicone_g, "resin": made.resin_g}),
        # a campaign knows no punch of two sides
        Step("plan its presses", None if given["punch"].startswith("rectangle") else planned),
        Step(f"press in the order of its sheet; save each trace under its name in {name}", None, PRESSING_H),
        Step(
            "compare it with the subjects",
            f"dummydesign compare {name}/*.csv --tissue {shlex.quote(given['tissue'])}{words}",
        ),
    ]


def _written(inputs: Mapping[str, Any]) -> Any:
    """The folder in which mould and pour sheet were written; nothing where they were not."""
    return inputs.get("out") if inputs.get("cad") else None


def _typed_condition(inputs: Mapping[str, Any]) -> str | None:
    """The condition under the punch, where it has to be typed."""
    return None if inputs["condition"] == "bonded" else inputs["condition"]


def _puck_first(answer: Suggestion, inputs: Mapping[str, Any]) -> list[Step]:
    """Cast and press a puck of the batch, then choose the ratio for the same mould."""
    ratio = answer.best.ratio
    diameter, height = (f"{value:g}" for value in WITNESS_MM)
    size = f"{diameter}x{height}"
    take = ring_cost(*WITNESS_MM, resin=str(inputs["resin"]), ratio=ratio)
    # not the resin's own name
    batch = BATCH if answer.resin.name != BATCH else f"{BATCH}-2"
    speeds = " and ".join(f"{speed:g}" for speed in SPEEDS_MM_S)
    added = command(trace_names(size), diameter, height, ratio, shlex.quote(inputs["resin"]), batch)
    return [
        Step(
            f"print the ring of a puck ({diameter} mm diameter, {height} mm high)",
            f"dummydesign mold --puck {size} --resin {shlex.quote(inputs['resin'])} --ratio {ratio:g}",
            take.printing_h,
            {"filament": take.filament_g},
        ),
        Step(
            f"cast the puck at ratio {ratio:g}; measure it, weigh it; press it at {speeds} mm/s, 10 s hold",
            None,
            _curing_h(answer) + PRESSING_H,
            {"resin": take.resin_g},
        ),
        Step("read the puck: its sizes as measured, --mass G as weighed", added),
        Step("choose the ratio for the batch, for the same mould", _search_again(inputs, batch)),
    ]


def _search_again(inputs: Mapping[str, Any], batch: str) -> str:
    """The command of the next search: of the same mould where one was made."""
    given = {**inputs, "condition": _typed_condition(inputs)}
    folder = given.get("mould") or _written(given)
    names = TYPED_AGAIN if folder else (*TYPED_AGAIN, *SEARCHED_AGAIN)
    words = command_words(Request, given, names) + (f" --mould {shlex.quote(str(folder))}" if folder else "")
    return f"dummydesign suggest --tissue {shlex.quote(given['tissue'])}{words} --resin {batch}"


def paths_of(answer: Suggestion) -> list[PadPath]:
    """The puck first and then the pad, beside the pad at once: what each takes and how many castings are usable.

    Of a batch that was measured it is the pad alone.
    """
    pad, poured, after = _mould(answer), answer.shares.as_poured.usable, answer.shares.after_puck.usable
    ring, wait = ring_cost(*WITNESS_MM, resin=answer.request.resin, ratio=answer.best.ratio), _curing_h(answer)
    kept = answer.request.mould is not None
    printing = 0.0 if kept else pad.printing_h
    grams = {"silicone": 0.0 if kept else pad.silicone_g, "resin": pad.resin_g}
    # the pad's mould is printed while the puck cures, and is the same for every batch
    known_h = max(ring.printing_h + wait + PRESSING_H, printing or 0.0)
    filament = 0.0 if kept else pad.filament_g or 0.0
    both = {**grams, "filament": ring.filament_g + filament, "resin": grams["resin"] + ring.resin_g}
    printed = None if printing is None else ring.printing_h + printing
    at_once = _path("pad at once", printing, (printing or 0.0) + wait, {**grams, "filament": filament}, poured)
    return [*([] if answer.resin.measured else [_path("puck first", printed, known_h + wait, both, after)]), at_once]


def _path(name: str, printing_h: float | None, calendar_h: float, grams: dict[str, float], usable: float) -> PadPath:
    """A way with its words; printing that is not known is in neither hours nor days."""
    hours, days = f"{printing_h:.2g} h printing, " if printing_h else "", int(np.ceil(calendar_h / 24.0))
    text = f"{name}, {hours}{grams['resin']:.0f} g, {days} day{'s' * (days > 1)}: {100.0 * usable:.0f} % usable"
    return PadPath(name, printing_h, None if printing_h is None else calendar_h, grams, usable, text)


def _mould(answer: Suggestion) -> MouldCost:
    """What the mould of the recommended pad and one casting take."""
    return mould_cost(answer.problem.mould(answer.best))


def _curing_h(answer: Suggestion) -> float:
    """Hours from pouring until what was cast can be tested."""
    pour = answer.problem.mould(answer.best).pour
    return float(pour.cure_time_h + 24.0 * pour.age_before_test_days)


def why_red(answer: Suggestion) -> str:
    """Why no casting of a resin will do, in the resin's own terms, and what would have to change."""
    ranges, limits, readings = ranges_of(answer.targets), answer.targets.limits, answer.best.readings
    missing = ~np.isfinite(readings.peak_N)
    if missing.any():
        return f"{ranges.force_N[missing].min():g} N is out of reach: the gel bottoms out; {STIFFER}"
    differences = deviations(ranges, readings)
    low, high = (limits.stands_shortfall, np.inf) if ranges.strict else (limits.shortfall, limits.over)
    (short, name, at), (over, other, its) = map(differences.worst, (differences.short, differences.above))
    failing = {kind: share for kind, share in (answer.verdict.castings or {}).items() if kind in OUTCOMES and share}
    if failing and max(short / low, over / high) <= 1.0:
        # the pad itself is within the limits: its castings are what decides
        most = max(failing, key=lambda kind: failing[kind])
        instead = STIFFER if most == OUT_OF_REACH else "a second puck narrows what is known of the batch"
        return f"{100.0 * failing[most]:.0f} % of castings are {OUTCOMES[most]}; {instead}"
    little = short / low >= over / high
    if (name if little else other) != PEAK:
        side = "stiffer" if little else "softer"
        return f"its steady curve is {side} shaped than the subjects'; try another resin or a smaller force"
    people, whose = ranges.peak_low_N if little else ranges.peak_high_N, "the subjects' peak"
    if little and ranges.strict:
        people, whose = ranges.peak_high_N, ranges.highest or "the peak of the highest subject"
    at, limit = (at, low) if little else (its, 1.0 / high)
    force, own = ranges.force_N[at], float(readings.peak_N[at] / ranges.force_N[at])
    factor = (float(people[at]) / limit / force - 1.0) / max(own - 1.0, 1e-9)
    return (
        f"the resin relaxes too {'little' if little else 'much'}: at {force:g} N, {ranges.velocity_mm_s[at]:g} mm/s "
        f"{whose} is {people[at] / force:.2f} times the steady force, the pad's {own:.2f}; to "
        f"be within {100.0 * (max(limit, 1.0 / limit) - 1.0):.0f} % of them it would have to relax "
        + (f"{factor:.1f} times as much" if factor > 0.0 else "not at all")
    )
