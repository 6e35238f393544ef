"""Tables of the study of the paper's dummies: verdicts, why some statements fail, and the files with all figures."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence

import numpy as np

from studies.paper_dummies.dummies import FORCES_N, REFERENCE, SITES, Dummy, Variant
from studies.paper_dummies.in_time import CENTRE, SOFT_EDGE, SPEEDS, STIFF_EDGE, Dummies, Judged
from studies.paper_dummies.statements import ABOUT_5N, Statement, statements

WANTED_POSITION = {"I": CENTRE, "II": SOFT_EDGE, "III": STIFF_EDGE}
WANTED_PEAK = {"I": CENTRE, "II": STIFF_EDGE, "III": (0.0, 1.0)}
NOT_AT_ALL = "cannot be reproduced"
NOT_NEO_HOOKEAN = f"{NOT_AT_ALL} by a neo-Hookean resin"
SHORT = {"agrees": "yes", "disagrees": "other", NOT_NEO_HOOKEAN: "stiffening", NOT_AT_ALL: "never"}
"""Verdicts as the page's cells."""
ANSWERS = {True: "yes", False: "no", None: ""}
SHARES = ("below_5N_fraction", "above_5N_fraction")
Results = dict[Variant, Dummies]
AllJudged = list[tuple[Statement, dict[Variant, Judged]]]
Cells = tuple[Sequence[str], Sequence[Sequence[object]]]
"""Head and rows of a table."""


def judge_every(results: Results) -> AllJudged:
    """Every statement with its judgement and numbers in every variant."""
    return [
        (statement, {variant: statement.judge(dummies) for variant, dummies in results.items()})
        for statement in statements()
    ]


def page_tables(results: Results) -> str:
    """Return the table of the page as Markdown: verdicts counted."""
    return _table(*counts(judge_every(results)))


def data_files(results: Results, scan: Results) -> dict[str, str]:
    """Return every table as CSV, by the end of its file's name."""
    judged = judge_every(results)
    return {
        "-verdicts": _csv(*by_dummy(judged)),
        "-at-once": _csv(*at_once(judged)),
        "-exponents": _csv(*exponents(results, scan)),
        "-peaks": _csv(*peaks(results)),
        "-statements": statements_text(judged),
        "-figures": figures_text(results),
    }


def verdict(judged: dict[Variant, Judged]) -> str:
    """``agrees`` in the reference, ``disagrees`` when only another variant does, else ``cannot be reproduced``.

    "By a neo-Hookean resin" is added when a stiffening one does it.
    """
    if judged[REFERENCE][0]:
        return "agrees"
    held = [variant for variant, (holds, _) in judged.items() if holds]
    if not held:
        return NOT_AT_ALL
    if all(variant.stiffening for variant in held):
        return NOT_NEO_HOOKEAN
    return "disagrees"


def _row(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _table(head: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    return "\n".join([_row(head), "|---" * len(head) + "|", *(_row(row) for row in rows)]) + "\n"


def by_dummy(judged: AllJudged) -> Cells:
    """Verdict of each statement, dummies across."""
    cells: dict[tuple[str, str], dict[str, str]] = {}
    for statement, outcome in judged:
        cells.setdefault((statement.words, statement.basis), {})[statement.dummy] = SHORT[verdict(outcome)]
    rows = [(*key, *(own.get(name, "") for name in SITES)) for key, own in cells.items()]
    return ("statement", "basis", *SITES), rows


def counts(judged: AllJudged) -> Cells:
    """Statements by basis and verdict."""
    rows: list[Sequence[object]] = []
    for basis in ("input", "band", "free"):
        verdicts = [SHORT[verdict(outcome)] for statement, outcome in judged if statement.basis == basis]
        rows.append((basis, *(verdicts.count(kind) for kind in SHORT.values()), len(verdicts)))
    every = [SHORT[verdict(outcome)] for _, outcome in judged]
    rows.append(("all", *(every.count(kind) for kind in SHORT.values()), len(every)))
    return ("basis", *SHORT.values(), "all"), rows


def statements_text(judged: AllJudged) -> str:
    """Every statement in every variant, with the number behind it, as CSV; ``holds`` is empty if not judged."""
    head = ("dummy", "statement", "section", "basis", "base", "young_kPa", "yeoh_c2_over_mu", "holds", "number")
    return _csv(
        head,
        (
            (s.dummy, s.words, s.section, s.basis, *_named(v), ANSWERS[holds], number)
            for s, outcome in judged
            for v, (holds, number) in outcome.items()
        ),
    )


def _named(variant: Variant) -> tuple[str, str, str]:
    return variant.base, f"{variant.young_kPa:g}", f"{variant.stiffening:g}"


def _csv(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([head, *rows])
    return stream.getvalue()


def at_once(judged: AllJudged) -> Cells:
    """How many statements each variant holds, of those that could be judged."""
    rows: list[Sequence[object]] = []
    for variant in judged[0][1]:
        holds = [outcome[variant][0] for _, outcome in judged]
        rows.append((*_named(variant), holds.count(True), len(holds) - holds.count(None)))
    return ("base", "young_kPa", "yeoh_c2_over_mu", "true", "judged"), rows


def needed_exponents(dummy: Dummy, name: str) -> tuple[float, float, float]:
    """Mean exponent from the stiffest subject near 5 N to the wanted place at 10 N: middle, least, largest.

    A slab that meets the stiffest subject at F_c and stands at depth x at 10 N has the mean exponent
    n = ln(10 / F_c) / ln(x / x_stiffest(F_c)) in between. The middle is F_c = 5 N and the middle of the
    place; for an edge that is the middle of the outer quarter.
    """
    stiff, soft = (float(edge[0]) for edge in dummy.tissue.steady_depth_range([10.0]))

    def needed(crossing: float, position: float) -> float:
        start = float(dummy.tissue.steady_depth_range([crossing])[0][0])
        return math.log(10.0 / crossing) / math.log((soft - position * (soft - stiff)) / start)

    low, high = (min(max(position, 0.0), 1.0) for position in WANTED_POSITION[name])
    ends = [needed(crossing, position) for crossing in ABOUT_5N for position in (low, high)]
    return needed(5.0, 0.5 * (low + high)), min(ends), max(ends)


def _span(values: Iterable[float], digits: int = 2) -> str:
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return "–"
    low, high = (f"{value:.{digits}f}" for value in (min(known), max(known)))
    return low if low == high else f"{low} to {high}"


def exponents(results: Results, scan: Results) -> Cells:
    """Exponent needed against the exponent of a slab, and moduli at which all steady statements of a dummy hold."""
    wanted = {name: [s for s in statements() if s.steady_curve and s.dummy == name] for name in SITES}
    needed = [needed_exponents(results[REFERENCE][name], name) for name in SITES]
    rows: list[Sequence[object]] = [
        ("needed", "", *(f"{mean:.2f} ({low:.2f} to {high:.2f})" for mean, low, high in needed), "", "", "")
    ]
    for base, c2 in dict.fromkeys((variant.base, variant.stiffening) for variant in scan):
        own = {v.young_kPa: dummies for v, dummies in scan.items() if (v.base, v.stiffening) == (base, c2)}
        held = (
            [young for young, dummies in own.items() if all(s.judge(dummies)[0] for s in wanted[name])]
            for name in SITES
        )
        spans = (_span(dummies[name].exponent() for dummies in own.values()) for name in SITES)
        rows.append((base, f"{c2:g}", *spans, *(_span(span, 0) if span else "none" for span in held)))
    columns = [f"{quantity}_{name}" for quantity in ("exponent", "young_kPa") for name in SITES]
    return ("base", "yeoh_c2_over_mu", *columns), rows


def peaks(results: Results) -> Cells:
    """Peak over steady force at 10 N, wanted and simulated, and the largest ratio of II's single arms to another's."""
    rows: list[Sequence[object]] = []
    for speed in SPEEDS:
        for name in SITES:
            press = results[REFERENCE][name].presses[10.0, speed]
            low, high = press.band.peak_low_N, press.band.peak_high_N
            wanted = [(low + position * (high - low)) / 10.0 for position in WANTED_PEAK[name]]
            every = [
                dummies[name].presses[10.0, speed].peak_N / 10.0
                for dummies in results.values()
                if (10.0, speed) in dummies[name].presses
            ]
            arms = "" if name == "II" else f"{_largest_arm(results, speed, name):.2f}"
            spans = (f"{press.peak_N / 10:.2f}", _span(every))
            rows.append((f"{speed:g}", name, f"{wanted[0]:.2f} to {wanted[1]:.2f}", *spans, arms))
    return ("velocity_mm_s", "dummy", "wanted", "bonded_25_kPa", "all_variants", "II_over_this_one_arm"), rows


def _largest_arm(results: Results, speed: float, other: str) -> float:
    """What one arm adds to the peak of II over what it adds to another's: largest over arm times and variants."""
    pairs = [(dummies["II"].arm_weights, dummies[other].arm_weights) for dummies in results.values()]
    return max(float((own[speed] / others[speed]).max()) for own, others in pairs if own and others)


def figures_text(results: Results) -> str:
    """Reach, depths, shares inside the bands and fitted parameters in every variant, as CSV; empty out of reach."""
    head = (
        "base",
        "young_kPa",
        "yeoh_c2_over_mu",
        "dummy",
        "reach_N",
        *(f"depth_{force:g}N_mm" for force in FORCES_N),
        "steady_inside_0.5_to_5N",
        "steady_inside_5_to_15N",
        *(f"inside_{force:g}N_{speed:g}mm_s" for speed in SPEEDS for force in FORCES_N),
        *(f"gamma{arm}_N_per_mm3" for arm in (1, 2, 3)),
        *(f"c{arm}_{speed:g}mm_s_N_s_per_mm" for speed in SPEEDS for arm in (2, 3)),
        "rms_misfit_N",
    )
    rows = (
        (
            *_named(variant),
            name,
            f"{dummy.reach_N:.1f}",
            *(_cell(dummy.depth_at(force)) for force in FORCES_N),
            *(_cell(dummy.steady_inside[part]) for part in SHARES),
            *(_cell(share) for speed in SPEEDS for share in _range_shares(dummy, speed)),
            *_fitted(dummy),
        )
        for variant, dummies in results.items()
        for name, dummy in dummies.items()
    )
    return _csv(head, rows)


def _cell(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.2f}"


def _range_shares(dummy: Dummy, speed: float) -> list[float]:
    presses = [dummy.presses.get((force, speed)) for force in FORCES_N]
    return [math.nan if press is None else press.inside["inside_fraction"] for press in presses]


def _fitted(dummy: Dummy) -> list[str]:
    own = dummy.parameters
    if own is None:
        return [""] * 8
    dampers = (damper for speed in SPEEDS for damper in own.dampers_at(speed))
    fitted = (own.gamma1_N_per_mm3, *own.gamma_N_per_mm3, *dampers)
    return [*(f"{value:.3g}" for value in fitted), f"{dummy.rmse_N:.2f}"]
