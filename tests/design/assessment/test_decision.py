"""Why a pad is chosen: what decides over the best pad of another kind, and what is listed of every kind."""

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.assessment.decision import BEYOND, LEVEL, MISFIT, POURED, SHARE, compare_kinds, explain
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.outlook import Outlook
from dummydesign.design.search.shape_search import rank, search_shapes
from dummydesign.report.suggest_facts import why_text

COUNT = 160


def design(kind, level=2, chances=0.5, misfit=0.1, poured=None, beyond=1.0):
    """A design of a kind by its outlook; ``beyond`` is its largest reading over the limit."""
    chances = np.broadcast_to(np.asarray(chances, float), COUNT)
    outlook = SimpleNamespace(
        level=lambda limits, strict: level,
        chances=chances,
        poured=chances if poured is None else np.full(COUNT, poured),
        ratio=15.0,
        after_puck=float(chances.mean()),
        misfit=misfit,
        beyond=np.log(beyond),
    )
    outlook.as_poured = float(outlook.poured.mean())
    outlook.ties = lambda best, poured=False: Outlook.ties(outlook, best, poured)
    return SimpleNamespace(shape=SimpleNamespace(name=kind), thickness_mm=10.0, outlook=outlook)


@pytest.fixture
def told():
    space = SimpleNamespace(targets=SimpleNamespace(limits=None, strict=False))
    return lambda chosen, *others: explain(chosen, others, space)


def test_the_level_decides_then_the_share_after_a_puck_then_the_misfit(told):
    chosen = design("crowned", 2, 0.5, 0.1)
    assert told(chosen, design("slab", 3, 0.9)).decided_by == LEVEL
    assert told(chosen, design("slab", 2, 0.4)).decided_by == SHARE
    assert told(chosen, design("slab", 2, 0.5, 0.3)).decided_by == MISFIT
    even = 0.3 * (-1.0) ** np.arange(COUNT)
    assert told(chosen, design("slab", 2, 0.49 + even)).decided_by == MISFIT, "within two standard errors"


def test_what_is_told_to_have_decided_is_what_the_search_ranks_by(told):
    """Each pair differs in one rank, and in the misfit the other way round."""
    space = SimpleNamespace(targets=SimpleNamespace(limits=None, strict=False))
    for decided, first, second in (
        (SHARE, design("crowned", 2, 0.9, 0.8), design("slab", 2, 0.5, 0.1)),
        (POURED, design("crowned", 2, 0.9, 0.8, poured=0.6), design("slab", 2, 0.9, 0.1, poured=0.4)),
        (BEYOND, design("crowned", 3, 0.0, 0.8, beyond=1.2), design("slab", 3, 0.0, 0.1, beyond=1.5)),
        (BEYOND, design("crowned", 3, 0.0, 0.8, beyond=1.2), design("slab", 3, 0.0, 0.1, beyond=np.inf)),
        (MISFIT, design("crowned", 3, 0.0, 0.1, beyond=np.inf), design("slab", 3, 0.0, 0.8, beyond=np.inf)),
    ):
        assert rank([second, first], space) == [first, second]
        choice = told(first, second)
        assert choice.decided_by == decided and "inf" not in choice.text


def test_the_next_best_is_the_first_of_another_kind(told):
    chosen = design("crowned", 1)
    found = told(chosen, design("crowned", 1), design("boned", 2), design("slab", 2))
    assert found.next_best == "the boned pad (10 mm, ratio 15)"
    alone = told(chosen, design("crowned", 2))
    assert alone.next_best is None and alone.decided_by is None


def test_every_kind_is_listed_with_its_level_and_share_and_kinds_without_a_pad_with_the_reason():
    problem = read_problem(Request("forefinger", shape="slab", thickness_mm=(5.0, 6.0), verify=False))
    designs, _ = search_shapes("slab", problem.slab_law, problem)
    first, missing = compare_kinds(designs[:1], {"boned": "too thin"}, problem)
    row = first.to_dict()
    own = designs[0]
    assert row["kind"] == "slab" and row["by"] == "table" and row["after_puck"] == own.outlook.after_puck
    assert row["acceptable"] == (row["level"] != "not_representative") and 0.0 <= row["total"] <= 1.0
    assert (row["thickness_mm"], row["ratio"]) == (own.thickness_mm, own.outlook.ratio)
    assert missing.to_dict() == {"kind": "boned", "shape": None, "reason": "too thin"}


def test_misfits_are_the_reason_only_where_the_recommended_pad_has_the_least():
    rows = [
        {"kind": kind, "shape": kind, "misfit_rms_ln_force": m} for kind, m in (("layered", 0.46), ("crowned", 0.05))
    ]
    given = {"inputs": {"force_N": [5.0, 15.0]}, "choice": {"text": "least beyond its limits"}}
    told = {
        kind: why_text({"shapes": rows, "recommendation": {"shape": kind}, **given}) for kind in ("layered", "crowned")
    }
    assert told["layered"] == "least beyond its limits"
    assert "0.05 (layered 0.46)" in told["crowned"] and "0.5 to 15 N" in told["crowned"]
    assert why_text({"shapes": rows[:1], "recommendation": {"shape": "layered"}, **given}) == "least beyond its limits"
