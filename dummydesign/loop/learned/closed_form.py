"""The simplest closed form that says the same as a learned curve, by the corrected information criterion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.learned.effect import FOLLOWED

AS_GOOD = 0.1
"""Share of what a curve explains that a closed form may lose."""
CAUSES = {
    "depth_mm": "the force law at this depth: a layer, a skin or a particle in the pad, or a bottom that is felt; "
    "press a pad of another thickness: a layer stays at its depth, a law goes with depth over thickness",
    "depth_share": "a material law that stiffens or softens otherwise; press a puck between plates, where the strain "
    "is uniform",
    "force_N": "a load cell that is not linear or saturates, or a set-up that gives way; press with another load cell",
    "since_stop_s": "a relaxation that two arms do not hold; hold longer",
    "temperature_C": "a modulus that changes otherwise with temperature; press the same pad cold and warm",
    "age_days": "cure that goes on, or drying; press the same pad again in a week",
}
"""What makes such a remainder as a rule, and the press that would tell."""


@dataclass(frozen=True)
class ClosedForm:
    """A closed form for a curve g(u).

    Attributes
    ----------
    name : str
        ``linear``, ``power``, ``exponential``, ``saturation``, ``step``, ``bump``, or ``curve`` when none is as good.
    text : str
        The form with its numbers, what causes it as a rule and what to press.
    lost : float
        Share of what the curve explains that the form loses.
    """

    name: str
    text: str
    lost: float


def closed_form(knots: NDArray, values: NDArray, information: NDArray, follows: str) -> ClosedForm:
    """Find the simplest form that fits a curve as well as the data know it.

    Parameters
    ----------
    knots, values : ndarray, shape (k,)
        The curve.
    information : ndarray, shape (k, k)
        Inverse covariance of its values by the data.
    follows : str
        The quantity, one of :data:`FOLLOWED`.
    """
    # what the data know of a constant is next to nothing: the modulus has it
    flat = values - np.average(values, weights=np.diag(information))
    total = float(flat @ information @ flat)
    count, best = len(knots), None
    for name, parameters, shapes in _forms(knots):
        for shape, text in shapes:
            # a constant change is the modulus
            columns = np.stack([shape, np.ones(count)], axis=1)
            known = columns.T @ information
            weights = np.linalg.lstsq(known @ columns, known @ values, rcond=1e-12)[0]
            amount, left = float(weights[0]), values - columns @ weights
            chi2 = float(left @ information @ left)
            spare = max(count - parameters - 1, 1)
            score = chi2 + 2.0 * parameters + 2.0 * parameters * (parameters + 1) / spare
            if best is None or score < best[0]:
                best = (score, name, text(amount), chi2)
    lost = best[3] / total if best is not None and total > 0.0 else 1.0
    said, why = FOLLOWED[follows], CAUSES[follows]
    if best is None or lost > AS_GOOD:
        most = int(np.argmax(np.abs(flat)))
        middle, size = knots[most], flat[most]
        form = f"a curve of no simple form, {100 * size:+.1f} % at {middle:.3g}"
        return ClosedForm("curve", f"relative change of the force with u = {said}: {form}. As a rule: {why}", lost)
    return ClosedForm(best[1], f"relative change of the force with u = {said}: {best[2]}. As a rule: {why}", lost)


Form = tuple[NDArray, Callable[[float], str]]


def _forms(knots: NDArray) -> list[tuple[str, int, list[Form]]]:
    """Name, number of parameters and shapes of each form, on a grid of the parameter that is not linear."""
    u, span = np.maximum(knots, 1e-12), float(np.ptp(knots))
    scales = span * np.geomspace(0.05, 3.0, 25)
    return [
        ("linear", 1, [(u, lambda a: f"{a:.3g} u")]),
        ("power", 2, [(u**p, lambda a, p=p: f"{a:.3g} u^{p:.2g}") for p in np.arange(0.25, 6.01, 0.25) if p != 1.0]),
        ("exponential", 2, [(np.expm1(u / s), lambda a, s=s: f"{a:.3g} (exp(u / {s:.3g}) - 1)") for s in scales[8:]]),
        ("saturation", 2, [(-np.expm1(-u / s), lambda a, s=s: f"{a:.3g} (1 - exp(-u / {s:.3g}))") for s in scales]),
        ("bump", 3, [(np.exp(-(((u - c) / w) ** 2)), lambda a, c=c, w=w: f"{a:.3g} exp(-((u - {c:.3g}) / {w:.3g})^2)")
                     for c in np.linspace(u[0], u[-1], 4 * len(u)) for w in span * np.geomspace(0.02, 0.5, 30)]),
        ("step", 2, [(1.0 * (u > s), lambda a, s=s: f"{a:.3g} beyond {s:.3g}") for s in 0.5 * (u[1:] + u[:-1])]),
    ]  # fmt: skip
