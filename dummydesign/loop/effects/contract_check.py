"""Whether an effect keeps the contract: what it declares, and what it does to presses of reference pads."""

from __future__ import annotations

import traceback
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from functools import lru_cache
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.trials import History, Presses, planned_trace, stack
from dummydesign.loop.model.campaign_law import law_without_solve
from dummydesign.loop.model.effect import HOOKS, OWNERS, PADS, SETUP, Effect, Parameter, SetupLaw, Values
from dummydesign.loop.model.forward_model import Active, BaseParameters, readings, simulate
from dummydesign.measurement.campaign import Trial
from dummydesign.pad.pad_under_punch import Pad, Puck

SHAPES = tuple(PADS)
UNITS = ("mm", "N", "s", "deg", "kg", "K")
"""Units that, as the end of a parameter's name, must be its unit."""
SMALL, VANISHED, LEAST_N = 1e-6, 1e-4, 0.05
"""At this share of the typical size, less than this share of the typical change (or of this force) may be left."""
BASE = BaseParameters(0.025, (0.06, 1.4), (0.3, 0.25))


def check_effect(effect: type[Effect] | Effect) -> tuple[str, ...]:
    """Try an effect against the contract of :class:`dummydesign.loop.model.effect.Effect`.

    Declared: name, hook, owner, signature, source and description; parameters with unit, and bounds that hold null,
    typical size and starting values. Done, on eight presses of reference pads: nothing at null, to the last bit, and
    nothing else changed by the call; a force that is finite at all bounds and grows continuously from null; the same
    force when asked twice; some change at the typical size.

    Parameters
    ----------
    effect : class or instance
        A class is made without arguments.

    Returns
    -------
    tuple of str
        What is wrong, a sentence each; empty when the contract is kept.
    """
    if isinstance(effect, type):
        name = effect.__name__
        if not issubclass(effect, Effect):
            return (f"{name} is not a class derived from dummydesign.loop.Effect",)
        try:
            effect = effect()
        except (Exception, SystemExit) as problem:
            return (f"{name}() raised {problem_text(problem)}; it must be made without arguments",)
    try:
        faults = tuple(_declared(effect))
        with np.errstate(all="ignore"):
            return faults or tuple(_done(effect))
    except (Exception, SystemExit) as problem:
        return (f"{type(effect).__name__} raised {problem_text(problem)}",)


def problem_text(problem: BaseException) -> str:
    """An exception in a few words: kind, text and the line it came from."""
    frames = traceback.extract_tb(problem.__traceback__)
    where = f" (line {frames[-1].lineno} of {Path(frames[-1].filename).name})" if frames else ""
    return f"{type(problem).__name__}: {' '.join(str(problem).split())[:200]}{where}"


def _broken(rules: Mapping[str, object]) -> Iterator[str]:
    """The faults of rules that do not hold."""
    yield from (fault for fault, holds in rules.items() if not holds)


def _declared(effect: Effect) -> Iterator[str]:
    word = isinstance(effect.name, str) and effect.name.isidentifier() and effect.name.islower()
    yield from _broken(
        {
            f"name = {effect.name!r} must be a single word, lower-case letters, digits and underscores": word,
            f"hook = {effect.hook!r} must be one of {', '.join(HOOKS)}": effect.hook in HOOKS,
            f"belongs_to = {effect.belongs_to!r} must be one of {', '.join(OWNERS)}": effect.belongs_to in OWNERS,
            "signature is empty": effect.signature,
            "reference is empty": effect.reference,
            "the class has no docstring that says what it does": type(effect).__doc__,
        }
    )
    columns = {*(field.name for field in fields(History)), *SETUP}
    if isinstance(effect.needs, str):
        yield f"needs = {effect.needs!r} must be a tuple of words; one word is ({effect.needs!r},)"
        return
    for needed in effect.needs:
        if needed not in columns:
            yield f"needs {needed!r}, which no campaign can declare: known are {', '.join(sorted(columns))}"
    if not effect.shapes or not set(effect.shapes) <= set(SHAPES):
        yield f"shapes = {effect.shapes!r} must be of {', '.join(SHAPES)}"
    if not effect.parameters or not all(isinstance(one, Parameter) for one in effect.parameters):
        yield "parameters must be a tuple of one Parameter or more; the first is the size"
        return
    if len({one.name for one in effect.parameters}) < len(effect.parameters):
        yield "two parameters have the same name"
    for one in effect.parameters:
        yield from (f"parameter {one.name}: {fault}" for fault in _parameter(one))


def _parameter(one: Parameter) -> Iterator[str]:
    end = one.name.rpartition("_")[2]
    numbers = (one.null, one.low, one.high, one.typical, *one.starts)
    named_by_unit = end in UNITS and "_per_" not in one.name
    numeric = all(isinstance(value, int | float | np.number) for value in numbers)
    finite = numeric and bool(np.all(np.isfinite(numbers)))
    yield from _broken(
        {
            "unit is empty; '1' stands for a pure number": one.unit,
            f"its name ends in {end}, its unit is {one.unit}": not named_by_unit or one.unit == end,
            "null, low, high, typical and starts must be numbers": numeric,
            "null, low, high, typical and starts must be finite": finite or not numeric,
        }
    )
    if not finite:
        return
    null_inside = one.low < one.high and one.low <= one.null <= one.high
    usual = one.typical if one.log else one.null + one.typical
    outside = [value for value in (usual, *one.starts) if not one.low <= value <= one.high]
    yield from _broken(
        {
            f"null = {one.null:g} must lie within low = {one.low:g} < high = {one.high:g}": null_inside,
            "fitted as a logarithm, so low and typical must be above 0": not one.log or min(one.low, one.typical) > 0,
            "typical must not be 0": one.typical != 0,
        }
    )
    yield from (f"typical or starting value {value:g} lies outside {one.low:g} to {one.high:g}" for value in outside)


def _done(effect: Effect) -> Iterator[str]:
    seen, reasons = False, []
    for shape in effect.shapes:
        presses, law = reference_presses(shape)
        reason = effect.unavailable(presses, law)
        if reason:
            reasons.append(f"{shape}: {reason}")
            continue
        seen = True
        yield from _on_presses(effect, presses, law)
    if not seen:
        yield f"it cannot be tested on the reference presses ({'; '.join(reasons)})"


def _on_presses(effect: Effect, presses: Presses, law: SetupLaw) -> Iterator[str]:
    def force(values: Values | None) -> NDArray:
        acting = () if values is None else (Active(effect, values),)
        return readings(presses, simulate(presses, law, BASE, acting), acting)

    size, null, typical = effect.parameters[0], effect.null_values(), _of_size(effect, 1.0)
    base = force(None)
    if not np.array_equal(force(null), base):
        yield f"at {size.name} = {size.null:g} the force is not that of the base to the last bit"
    if size.log:
        yield f"parameter {size.name} is the size and must not be fitted as a logarithm"
    unsound = faults_on(effect, presses, law)
    yield from unsound
    if unsound:
        return
    full, tiny = force(typical), force(_of_size(effect, SMALL))
    changed = float(np.abs(full - base).max())
    if not np.all(np.isfinite(tiny)):
        yield f"its force is not finite at {_values_text(typical)}"
        return
    if changed == 0.0:
        yield f"at {_values_text(typical)} it changes nothing"
    left = float(np.abs(tiny - base).max())
    if left > VANISHED * max(changed, LEAST_N):
        yield f"towards null it leaves a step of {left:.3g} N: the slope of the force is not finite there"
    for values in ({**typical, p.name: end} for p in effect.parameters for end in (p.low, p.high)):
        if not np.all(np.isfinite(force(values))):
            yield f"its force is not finite at {_values_text(values)}"


def faults_on(effect: Effect, presses: Presses, law: SetupLaw) -> tuple[str, ...]:
    """What makes the force of an effect of its typical size unusable on given presses.

    Parameters
    ----------
    effect : Effect
    presses : Presses
        T trials of N nodes.
    law : SetupLaw
    """
    acting = (Active(effect, _of_size(effect, 1.0)),)
    base = simulate(presses, law, BASE)
    try:
        full = np.asarray(simulate(presses, law, BASE, acting))
    except Exception as problem:
        return (f"its force cannot be used: {problem_text(problem)}",)
    if full.shape != base.shape:
        return (f"its force has the shape {full.shape}, the presses have {base.shape}",)
    if not np.isrealobj(full):
        return (f"its force is complex at {_values_text(acting[0].values)}",)
    if not np.all(np.isfinite(full)):
        return (f"its force is not finite at {_values_text(acting[0].values)}",)
    faults = []
    if not np.array_equal(simulate(presses, law, BASE, acting), full):
        faults.append("asked twice, it gives two forces")
    if not np.array_equal(simulate(presses, law, BASE), base):
        faults.append("after a call the base has another force: it changes what it is given")
    return tuple(faults)


def _of_size(effect: Effect, share: float) -> Values:
    """Typical values, the size at a share of its own."""
    size, *others = effect.parameters
    return {size.name: size.null + share * size.typical, **{p.name: p.typical for p in others}}


def _values_text(values: Values) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in values.items())


@lru_cache(maxsize=3)
def reference_presses(shape: str) -> tuple[Presses, SetupLaw]:
    """Eight presses of two pads at two speeds with unloading, temperatures, ages and rests, and their base law."""
    filleted = Pad(10.0, 1.0, 7.9, edge_radius_mm=0.8)
    pads: dict[str, tuple[Pad | Puck, tuple[float, float], float]] = {
        "shaped": (filleted, (8.0, 15.0), 0.3),
        "slab": (replace(filleted, edge_radius_mm=0.0, sides_mm=(14.0, 14.0)), (5.0, 15.0), 0.3),
        "cylinder": (Puck(30.0, 1.0, 50.0), (30.0, 40.0), 0.2),
    }
    pad, thicknesses, share = pads[shape]
    law = law_without_solve(replace(pad, thickness_mm=h) for h in thicknesses)
    trials: list[Trial] = []
    for order, (repeat, thickness, speed) in enumerate(product((1, 2), thicknesses, (10.0, 250.0))):
        depth = share * thickness * (1.0 - 0.3 * (repeat - 1))
        trace = planned_trace(f"reference_{order}", speed, depth, 3.0, True)
        elastic = law(trace.displacement_mm[None], np.array([[thickness]]))[0]
        trials.append(
            Trial(
                trace.name,
                thickness,
                speed,
                3.0,
                None,
                repeat,
                order + 1,
                60.0 if order % 2 else 3600.0,
                21.0 + order,
                9.0 * repeat,
                replace(trace, force_N=BASE.young_MPa * elastic),
            )
        )
    presses = stack(tuple(trials), None)
    vars(presses)["flat_top_N"] = 0.5 * float(simulate(presses, law, BASE).max())  # as if their readings were clipped
    return presses, law
