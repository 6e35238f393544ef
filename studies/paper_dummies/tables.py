"""Tables of the study of the paper's dummies: verdicts, why some statements fail, and the files with all figures."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence

import numpy as np

from studies.paper_dummies.dummies import FORCES_N, HELD, REFERENCE, SITES, YOUNG_KPA, Dummy, Variant
from studies.paper_dummies.in_time import CENTRE, SOFT_EDGE, SPEEDS, STIFF_EDGE, Dummies, Judged
from studies.paper_dummies.statements import ABOUT_5N, Statement, statements

WANTED_PLACE = {"I": CENTRE, "II": SOFT_EDGE, "III": STIFF_EDGE}
WANTED_PEAK = {"I": CENTRE, "II": STIFF_EDGE, "III": (0.0, 1.0)}
NOT_AT_ALL = "cannot be reproduced"
NOT_NEO_HOOKEAN = f"{NOT_AT_ALL} by a neo-Hookean resin"
SHORT = {"agrees": "yes", "disagrees": "other", NOT_NEO_HOOKEAN: "stiffening", NOT_AT_ALL: "never"}
"""Verdicts as the page's cells."""
ANSWERS = {True: "yes", False: "no", None: ""}
SHARES = ("below_5N_fraction", "above_5N_fraction")
Results = dict[Variant, Dummies]
AllJudged = list[tuple[Statement, dict[Variant, Judged]]]


def judge_every(results: Results) -> AllJudged:
    """Every statement with its judgement and numbers in every variant."""
    return [
        (statement, {variant: statement.judge(dummies) for variant, dummies in results.items()})
        for statement in statements()
    ]


def tables(results: Results, scan: Results) -> str:
    """Return the tables of the page as Markdown."""
    judged = judge_every(results)
    parts = [
        ("Statements", f"{by_dummy(judged)}\n{_counts(judged)}"),
        ("How many statements hold at once", at_once(judged)),
        ("Exponent of the steady curve", exponents(results, scan)),
        ("Peak over steady force at 10 N", relaxation(results)),
        ("The simulated dummies (glued, 25 kPa)", figures(results)),
    ]
    return "\n".join(f"### {title}\n\n{text}" for title, text in parts)


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


def by_dummy(judged: AllJudged) -> str:
    """Verdict of each statement, dummies across."""
    cells: dict[tuple[str, str], dict[str, str]] = {}
    for statement, found in judged:
        cells.setdefault((statement.words, statement.basis), {})[statement.dummy] = SHORT[verdict(found)]
    rows = [(*key, *(own.get(name, "") for name in SITES)) for key, own in cells.items()]
    return _table(("the paper's statement", "basis", *SITES), rows)


def _counts(judged: AllJudged) -> str:
    rows = []
    for basis in ("input", "band", "free"):
        verdicts = [SHORT[verdict(found)] for statement, found in judged if statement.basis == basis]
        rows.append((basis, *(verdicts.count(kind) for kind in SHORT.values()), len(verdicts)))
    rows.append(("all", *(sum(row[column] for row in rows) for column in range(1, len(SHORT) + 2))))
    return _table(("basis", *SHORT.values(), "rows"), rows)


def statements_text(judged: AllJudged) -> str:
    """Every statement in every variant, with the number behind it, as CSV; ``holds`` is empty if not judged."""
    head = ("dummy", "statement", "section", "basis", "base", "young_kPa", "yeoh_c2_over_mu", "holds", "number")
    return _csv(
        head,
        (
            (s.dummy, s.words, s.section, s.basis, *_named(v), ANSWERS[holds], number)
            for s, found in judged for v, (holds, number) in found.items()
        ),
    )  # fmt: skip


def _named(variant: Variant) -> tuple[str, str, str]:
    return variant.base, f"{variant.young_kPa:g}", f"{variant.stiffening:g}"


def _csv(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([head, *rows])
    return stream.getvalue()


def at_once(judged: AllJudged) -> str:
    """How many statements each variant holds, modulus across."""
    kinds = dict.fromkeys((variant.base, variant.stiffening) for variant in judged[0][1])
    rows = [
        (HELD[base], f"{c2:g}", *(_count(judged, Variant(base, young, c2)) for young in YOUNG_KPA))
        for base, c2 in kinds
    ]  # fmt: skip
    return _table(("base", "c2/mu", *(f"{young:g} kPa" for young in YOUNG_KPA)), rows)


def _count(judged: AllJudged, variant: Variant) -> str:
    holds = [found[variant][0] for _, found in judged]
    out = holds.count(None)
    return f"{holds.count(True)}" + (f" of {len(holds) - out}" if out else "")


def needed_exponents(dummy: Dummy, name: str) -> tuple[float, float, float]:
    """Mean exponent from the stiffest subject near 5 N to the wanted place at 10 N: middle, least, largest.

    A slab that meets the stiffest subject at F_c and stands at depth x at 10 N has the mean exponent
    n = ln(10 / F_c) / ln(x / x_stiffest(F_c)) in between. The middle is F_c = 5 N and the middle of the
    place; for an edge that is the middle of the outer quarter.
    """
    stiff, soft = (float(edge[0]) for edge in dummy.tissue.steady_depth_range([10.0]))

    def needed(crossing: float, place: float) -> float:
        start = float(dummy.tissue.steady_depth_range([crossing])[0][0])
        return math.log(10.0 / crossing) / math.log((soft - place * (soft - stiff)) / start)

    low, high = (min(max(place, 0.0), 1.0) for place in WANTED_PLACE[name])
    ends = [needed(crossing, place) for crossing in ABOUT_5N for place in (low, high)]
    return needed(5.0, 0.5 * (low + high)), min(ends), max(ends)


def _span(values: Iterable[float], digits: int = 2) -> str:
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return "–"
    low, high = (f"{value:.{digits}f}" for value in (min(known), max(known)))
    return low if low == high else f"{low} to {high}"


def exponents(results: Results, scan: Results) -> str:
    """Exponent needed against the exponent of a slab, and moduli at which all steady statements of a dummy hold."""
    wanted = {name: [s for s in statements() if s.steady_curve and s.dummy == name] for name in SITES}
    needed = [needed_exponents(results[REFERENCE][name], name) for name in SITES]
    rows = [("needed", "", *(f"{mean:.2f} ({low:.2f} to {high:.2f})" for mean, low, high in needed), "", "", "")]
    for base, c2 in dict.fromkeys((variant.base, variant.stiffening) for variant in scan):
        own = {v.young_kPa: dummies for v, dummies in scan.items() if (v.base, v.stiffening) == (base, c2)}
        held = (
            [young for young, dummies in own.items() if all(s.judge(dummies)[0] for s in wanted[name])]
            for name in SITES
        )
        spans = (_span(dummies[name].exponent() for dummies in own.values()) for name in SITES)
        rows.append((HELD[base], f"{c2:g}", *spans, *(_span(found, 0) if found else "none" for found in held)))
    head = ("base", "c2/mu", *(f"exponent {name}" for name in SITES), *(f"kPa, {name}" for name in SITES))
    return _table(head, rows)


def relaxation(results: Results) -> str:
    """Peak over steady force at 10 N, wanted and simulated, and the largest ratio of II's single arms to another's."""
    rows = []
    for speed in SPEEDS:
        for name in SITES:
            press = results[REFERENCE][name].presses[10.0, speed]
            low, high = press.band.peak_low_N, press.band.peak_high_N
            wanted = [(low + place * (high - low)) / 10.0 for place in WANTED_PEAK[name]]
            every = [
                dummies[name].presses[10.0, speed].peak_N / 10.0
                for dummies in results.values() if (10.0, speed) in dummies[name].presses
            ]  # fmt: skip
            arms = "" if name == "II" else f"{_largest_arm(results, speed, name):.2f}"
            spans = (f"{press.peak_N / 10:.2f}", _span(every))
            rows.append((f"{speed:g}", name, f"{wanted[0]:.2f} to {wanted[1]:.2f}", *spans, arms))
    return _table(("mm/s", "dummy", "wanted", "glued, 25 kPa", "all variants", "II over this, one arm"), rows)


def _largest_arm(results: Results, speed: float, other: str) -> float:
    """What one arm adds to the peak of II over what it adds to another's: largest over arm times and variants."""
    pairs = [(dummies["II"].arm_weights, dummies[other].arm_weights) for dummies in results.values()]
    return max(float((own[speed] / others[speed]).max()) for own, others in pairs if own and others)


def figures(results: Results) -> str:
    """Reach, depths, shares of the steady curve inside the band and misfit of the reference."""
    rows = [
        (
            name, f"{dummy.reach_N:.1f}", ", ".join(_cell(dummy.depth_at(force)) or "–" for force in FORCES_N),
            *(_cell(dummy.steady_inside[part]) for part in SHARES), f"{dummy.rmse_N:.2f}",
        )
        for name, dummy in results[REFERENCE].items()
    ]  # fmt: skip
    head = ("dummy", "reach, N", "mm at 5, 10, 15 N", "inside, 0.5 to 5 N", "5 to 15 N", "rms misfit, N")
    return _table(head, rows)


def figures_text(results: Results) -> str:
    """Reach, depths, shares inside the bands and fitted parameters in every variant, as CSV; empty out of reach."""
    head = (
        "base", "young_kPa", "yeoh_c2_over_mu", "dummy", "reach_N", *(f"depth_{force:g}N_mm" for force in FORCES_N),
        "steady_inside_0.5_to_5N", "steady_inside_5_to_15N",
        *(f"inside_{force:g}N_{speed:g}mm_s" for speed in SPEEDS for force in FORCES_N),
        *(f"gamma{arm}_N_per_mm3" for arm in (1, 2, 3)),
        *(f"c{arm}_{speed:g}mm_s_N_s_per_mm" for speed in SPEEDS for arm in (2, 3)), "rms_misfit_N",
    )  # fmt: skip
    rows = (
        (
            *_named(variant), name, f"{dummy.reach_N:.1f}", *(_cell(dummy.depth_at(force)) for force in FORCES_N),
            *(_cell(dummy.steady_inside[part]) for part in SHARES),
            *(_cell(share) for speed in SPEEDS for share in _range_shares(dummy, speed)), *_fitted(dummy),
        )
        for variant, dummies in results.items() for name, dummy in dummies.items()
    )  # fmt: skip
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
