"""Steps of a pour with what each does to the mould, and the rules that their order keeps. No CAD."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

# What a step may do. A move is anything that disturbs the level: carrying, weighing the mould itself, tilting it.
PREPARE, LEVEL, MIX, DEGAS, POUR, WAIT, CLOSE, GEL, MOVE, CURE = (
    "prepare", "level", "mix", "degas", "pour", "wait", "close", "gel", "move", "cure",
)  # fmt: skip


# What is filled in by hand.
BLANK = "________"


@dataclass(frozen=True)
class Step:
    """One line of the sheet and what is done in it, in order."""

    text: str
    acts: tuple[str, ...] = (PREPARE,)


def order_faults(steps: Sequence[Step]) -> list[str]:
    """What is wrong with the order of a pour's steps, in words; empty when nothing is.

    Rules: the mould is level when resin starts to gel and nothing moves it in between; resin is degassed after it is
    mixed and before it gels; it is poured before the mould is closed; the cure comes last. Resin that has not
    gelled before gels in the cure.
    """
    acts = [act for step in steps for act in step.acts]
    faults: list[str] = []
    level = mixed = degassed = poured = False
    for act in acts:
        if act == LEVEL:
            level = True
        elif act == MOVE:
            level = False
        elif act == MIX:
            mixed, degassed, poured = True, False, False
        elif act == DEGAS:
            degassed = mixed
        elif act == POUR:
            if not mixed:
                faults.append("resin is poured that is not mixed")
            poured = True
        elif act == CLOSE and not poured:
            faults.append("the mould is closed before resin is poured")
        elif act == GEL or (act == CURE and mixed):
            if not level:
                faults.append("resin gels in a mould that is not level or was moved since")
            if not (poured and degassed):
                faults.append("resin gels that was not degassed and poured")
            mixed = False
    if not acts or acts[-1] != CURE:
        faults.append("the cure is not the last step")
    return faults
