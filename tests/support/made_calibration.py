"""Calibrations as the loop writes them, made from values: a base, effects, a law error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dummydesign.loop.calibration import Calibration, Model, Posterior
from dummydesign.loop.model.forward_model import Active, BaseParameters
from tests.support.named_effects import effect_named

PAD = {
    "young_kPa_expected": 30.0,
    "resin": "polyurethane-nagoya",
    "ratio": 15.0,
    "base": "bonded",
    "shape": "slab",
    "contact": "bonded",
}
NAMES = ("log young_kPa", "log tau_1_s", "log beta_1", "log tau_2_s", "log beta_2")


def calibration(*active, pad=None, shapes=(), level=0.0, verdict="effect", because=()):
    base = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))
    terms = np.zeros((3, 1))
    terms[0] = level
    plain = Model(base, (), (("".join(shapes), 10.0),), terms)
    model = replace(plain, active=tuple(active))
    names, mean = list(NAMES), list(np.log([30.0, 0.05, 0.3, 1.2, 0.2]))
    for one in active:
        names += [f"{one.effect.name}.{p.name}" for p in one.effect.parameters]
        mean += [one.values[p.name] for p in one.effect.parameters]
    known = Posterior(tuple(names), np.array(mean), 1e-4 * np.eye(len(names)), (0.004, 0.01, 0.008))
    left = {"rise": 0.041, "hold": 0.037}
    return Calibration(plain, model, verdict, left, 0.036, {**PAD, **(pad or {})}, tuple(because), known)


def effect(name, **values):
    one = effect_named(name)
    return Active(one, {**one.null_values(), **values})
