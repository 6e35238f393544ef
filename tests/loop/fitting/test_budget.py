"""Counted work of a search."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dummydesign.loop.fitting.fit import budget_spent, count, counted, fit
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.selection.nonparametric_effect import predicted_without
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


def test_a_refit_without_some_presses_works_out_no_sensitivities_that_it_does_not_step_by(monkeypatch):
    found, whole, worked = clean_fit(), CampaignProblem._jacobian, []
    out = np.arange(len(found.problem.presses.trials)) < 4
    monkeypatch.setattr(CampaignProblem, "_jacobian", lambda *words: worked.append(1) or whole(*words))
    moved = replace(found, vector=found.vector + 0.05)
    with counted(100) as budget:
        predicted = predicted_without(moved, out)
    assert len(worked) == budget.iterations and budget.models == 1
    assert np.isfinite(predicted[out]).all()


def test_a_vector_is_simulated_once_for_its_forces_and_once_for_their_slope(monkeypatch):
    problem, whole, simulated = replace(clean_fit().problem), CampaignProblem.nodes, []
    monkeypatch.setattr(CampaignProblem, "nodes", lambda *words: simulated.append(1) or whole(*words))
    vector = clean_fit().vector
    first = problem.predict(vector)
    problem.slope(vector, first)
    assert problem.predict(vector) is first and len(simulated) == 2
    problem.slope(vector, problem.predict(vector))
    assert len(simulated) == 2
    assert not np.array_equal(problem.predict(vector + 0.01), first) and len(simulated) == 3
