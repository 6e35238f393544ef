"""A budget of counted work for a search: the same on an idle and on a busy machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass


@dataclass
class Budget:
    """Models that were fitted, and their iterations (sensitivities of all presses); ``stopped`` once something was left
    undone because these reached ``most``."""

    most: int
    models: int = 0
    iterations: int = 0
    stopped: bool = False


_BUDGET: ContextVar[Budget | None] = ContextVar("search_budget", default=None)


@contextmanager
def counted(most: int) -> Iterator[Budget]:
    """Give the fits inside so many iterations."""
    budget = Budget(most)
    token = _BUDGET.set(budget)
    try:
        yield budget
    finally:
        _BUDGET.reset(token)


def count(models: int = 0, iterations: int = 0) -> None:
    """Count work that was done."""
    if budget := _BUDGET.get():
        budget.models += models
        budget.iterations += iterations


def budget_spent() -> bool:
    """Whether no further model may be begun, asked where one is left out then; never without a budget."""
    if not (budget := _BUDGET.get()):
        return False
    budget.stopped = budget.stopped or budget.iterations >= budget.most
    return budget.stopped
