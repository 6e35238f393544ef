"""Counted work of a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dummydesign.loop.fitting.budget import budget_spent, count, counted
from dummydesign.loop.fitting.fit import fit
from dummydesign.loop.fitting.problem import CampaignProblem
from tests.support.puck_presses import clean_fit


def test_a_budget_counts_what_is_fitted_inside_and_notes_that_something_was_left_out():
    assert not budget_spent()
    with counted(2) as whole:
        count(models=1, iterations=1)
        assert not budget_spent() and not whole.stopped
        with counted(0) as inner:
            assert budget_spent() and inner.stopped
        count(iterations=1)
        assert not whole.stopped and budget_spent() and whole.stopped
        assert (whole.models, whole.iterations) == (1, 2)
    assert not budget_spent()


def test_a_fit_counts_one_model_and_each_of_its_jacobians():
    found = clean_fit()
    counts = []
    for _ in range(2):
        with counted(100) as budget:
            fit(found.problem, found.vector + 0.05, found.sizes, 4)
        counts.append((budget.models, budget.iterations))
    assert counts[0] == counts[1] and counts[0][0] == 1 and 1 <= counts[0][1] <= 4


def test_sensitivities_at_one_vector_are_worked_out_once_and_counted_each_time(monkeypatch):
    found, whole, worked = clean_fit(), CampaignProblem._jacobian, []
    monkeypatch.setattr(CampaignProblem, "_jacobian", lambda *words: worked.append(1) or whole(*words))
    with counted(100) as budget:
        first = fit(found.problem, found.vector + 0.05, found.sizes, 4)
        once = len(worked)
        again = fit(first.problem, first.vector, first.sizes, 1)
    assert once <= budget.iterations and len(worked) <= once + 1
    fresh = fit(replace(first.problem), first.vector, first.sizes, 1)
    assert np.array_equal(again.vector, fresh.vector) and np.array_equal(again.jacobian, fresh.jacobian)
