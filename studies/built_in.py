"""What `suggest` recommends for the tissues of the library.

    python -m studies.built_in

designs a pad for the forefinger, the palm and the thenar as ``dummydesign suggest --tissue NAME`` does, and the best
slab beside it, and writes a table into ``docs/design.md``. Nothing is drawn with another seed than the command's.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import dummydesign
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.levels import level_name
from dummydesign.design.scoring.settings import verdict_limits
from studies.marked_page import MarkedPage

TISSUES = ("forefinger", "palm", "thenar")
PAGE = Path("docs") / "design.md"
DESIGNS = MarkedPage(PAGE, "<!-- built-in tissues: begin -->", "<!-- built-in tissues: end -->")
SHARES = {"resin_known": "average batch", "after_puck": "after a puck"}

Answers = Sequence[tuple[str, Mapping[str, Any], Mapping[str, Any] | None]]
"""Tissue, answer, and the answer with slabs alone; None where none reaches the presses."""


def answer_of(tissue: str, **options: Any) -> dict[str, Any] | None:
    """The answer of `suggest`; None where no pad reaches the presses."""
    try:
        return dict(dummydesign.suggest(tissue, **options).to_dict())
    except NoAnswerError:
        return None


def design_table(answers: Answers) -> str:
    """One row a tissue: verdict, pad, fractions of castings, factors on energies, and the best slab."""
    head = [
        "tissue",
        "verdict",
        "shape, thickness, ratio",
        "usable as poured",
        *SHARES.values(),
        "out of reach",
        "factor on energies: central, 95 %, average batch",
        "best slab",
    ]
    rows = []
    for tissue, answer, slab in answers:
        best, castings, factor = (
            answer["recommendation"],
            answer["shares"]["as_poured"],
            answer["verdict"]["correction"],
        )
        factors = (factor[name] for name in ("factor_central", "factor", "factor_after_measuring"))
        shape = str(best["shape"]).partition(":")
        lengths = ",".join(part.partition("=")[2] for part in shape[2].split(",")) if shape[2] else ""
        rows.append(
            [
                tissue,
                level_name(answer["verdict"]["level"]),
                f"{shape[0]}{f':{lengths}' if lengths else ''}, {best['thickness_mm']:g} mm, {best['ratio']:g}",
                _percent(castings["usable"]),
                *(_percent(answer["shares"][name]["usable"]) for name in SHARES),
                _percent(castings["out_of_reach"]),
                ", ".join("-" if one is None else f"{one:.2f}" for one in factors),
                _slab_words(slab),
            ]
        )
    return _table(head, rows)


def _percent(share: float) -> str:
    """A share, with a decimal near the limit so that it is not rounded onto it."""
    near = abs(share - verdict_limits().share) < 0.01
    return f"{100 * share:.{1 if near else 0}f} %"


def _slab_words(slab: Mapping[str, Any] | None) -> str:
    """Verdict on the best slab and its larger excess."""
    if slab is None:
        return "none reaches the presses"
    verdict = slab["verdict"]
    level, short, over = level_name(verdict["level"]), verdict["shortfall"], verdict["over"]
    if verdict["not_reached"]:
        return f"{level}: a press is out of reach"
    if short["central"] > over["central"]:
        return f"{level}: {short['quantity']} {100 * (1.0 - 1.0 / short['central']):.0f} % too low"
    return f"{level}: {over['quantity']} {100 * (over['central'] - 1.0):.0f} % too high"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


def main() -> None:
    """Design for each tissue and write the table."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    repository = Path.cwd()
    DESIGNS.read(repository)
    answers = []
    for tissue in TISSUES:
        answer = answer_of(tissue)
        if answer is None:
            raise SystemExit(f"no pad reaches the presses of {tissue}")
        answers.append((tissue, answer, answer_of(tissue, shape="slab")))
    DESIGNS.write(repository, design_table(answers))


if __name__ == "__main__":
    main()
