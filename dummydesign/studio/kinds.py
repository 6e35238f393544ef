"""Kinds of pads side by side: the best of each, and why the recommended one was chosen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError
from dummydesign.design.assessment.choice import TELLS, WORDS

if TYPE_CHECKING:
    from dummydesign.design.inputs import Inputs

HEAD = ("pad", "verdict", "score", "combined score", "shortfall", "over", "thickness mm", "ratio")


@dataclass(frozen=True)
class KindsCompared:
    """A table with one row a kind, the recommended first, and sentences on the choice.

    Attributes
    ----------
    head : tuple of str
        Names of the columns.
    rows : tuple of tuple
        Values of each kind; None where a value is not known.
    sentences : tuple of str
        Why the first row was chosen. Text, not HTML.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    sentences: tuple[str, ...]


def kinds_compared(answer: Mapping[str, Any], verdicts: Mapping[str, Mapping[str, Any]] | None = None) -> KindsCompared:
    """Compare the best pad of each kind.

    Parameters
    ----------
    answer : mapping
        JSON of ``suggest``.
    verdicts : mapping, optional
        Verdict of the best pad of each other kind, from :func:`verdicts_of_kinds`: the answer has the recommended
        pad's only.
    """
    best, choice = answer["recommendation"], answer["choice"]
    kind = best["shape"].partition(":")[0]
    known = {**(verdicts or {}), kind: answer["verdict"]}
    rows, missing = [], []
    for row in answer["shapes"]:
        if row["shape"] is None:
            missing.append(f"No {row['kind']} pad: {row['reason']}.")
            continue
        own = row["kind"] == kind
        verdict = known.get(row["kind"], {})
        pad, total = (best, best["scores"]["total"]) if own else (row, row["total"])
        rows.append(
            (row["kind"], verdict.get("light"), total, row["merit"], _central(verdict, "shortfall"),
             _central(verdict, "over"), pad["thickness_mm"], pad["ratio"])
        )  # fmt: skip
    rows.sort(key=lambda row: (row[0] != kind, -row[3]))
    return KindsCompared(HEAD, tuple(rows), tuple([*_why(answer, best, choice, kind), *missing]))


def _central(verdict: Mapping[str, Any], side: str) -> float | None:
    return verdict[side]["central"] if verdict else None


def _why(answer: Mapping[str, Any], best: Mapping[str, Any], choice: Mapping[str, Any], kind: str) -> list[str]:
    """Sentences on the choice, from the numbers of the answer."""
    lowest = min(row["steady_force_N"] for row in best["conditions"])
    words = {term: text.format(low=lowest) for term, text in WORDS.items()}
    terms, decided = choice["terms"], choice["decided_by"]
    pad = f"the {kind} pad, {best['thickness_mm']:g} mm, ratio {best['ratio']:g}"
    if choice["next_best"] is None:
        said = [f"No other kind was compared with {pad}."]
    elif decided == "verdict":
        said = [f"Chosen: {pad}.", f"The next best is {choice['next_best']}. It is not representative."]
    else:
        said = [
            f"Chosen: {pad}.", f"The next best is {choice['next_best']}.",
            f"The choice is mainly for {words[decided]}: {terms[decided]:+.2f} of {sum(terms.values()):+.2f}.",
        ]  # fmt: skip
    weaker = [f"{words[term]} ({gain:+.2f})" for term, gain in terms.items() if gain < -TELLS]
    if weaker and decided != "verdict":
        said.append(f"It is weaker in {' and '.join(weaker)}.")
    share = choice["weights"]["low_aim"]
    said.append(
        f"The combined score is {100 * (1 - share):.0f} % score and {100 * share:.0f} % match below {lowest:g} N."
    )
    middle = choice["expectation"]["middle"]
    if choice["expectation"]["differs"]:
        said.append(
            f"At central estimates the {middle['kind']} pad, {middle['thickness_mm']:g} mm, ratio "
            f"{middle['ratio']:g}, scores more."
        )
    said.append(
        f"Score with all uncertainties: {choice['expected_total']:.2f} (5 % of castings below "
        f"{choice['total_low']:.2f})."
    )
    return said


def verdicts_of_kinds(inputs: Inputs, answer: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Judge the best pad of each other kind, with its castings; a kind that the tables cannot press is left out.

    Parameters
    ----------
    inputs : Inputs
        Of the question that the answer is to, from :func:`dummydesign.studio.bench.inputs_of`.
    answer : mapping
        JSON of ``suggest``.
    """
    from dummydesign.studio import bench

    own, found = answer["recommendation"]["shape"].partition(":")[0], {}
    for row in answer["shapes"]:
        if row["shape"] is None or row["kind"] == own:
            continue
        try:
            shape = bench.shape_of(row["shape"])
            pad = bench.evaluate_pad(inputs, shape, row["thickness_mm"], row["ratio"])
            found[row["kind"]] = bench.verdict_with_castings(inputs, shape, pad).to_dict()
        except InputError:
            continue
    return found
