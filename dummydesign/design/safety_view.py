"""The safety view of a suggestion: energy and mean pressure at each condition, a mass, and a user's limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.assessment.safety import (
    N_PER_CM2,
    Limits,
    SafetyContact,
    against_limits,
    curves_impact,
    impact,
    pad_body,
    pad_press,
    tissue_body,
    tissue_press,
)
from dummydesign.design.assessment.safety import WORDS as CURVES_WORDS
from dummydesign.measurement.motion import work_mJ

if TYPE_CHECKING:
    from dummydesign.design.scoring.presses import Slabs
    from dummydesign.design.suggestion import Suggestion

BEYOND = "not stopped within what the model covers"
TEXT = (
    "Load on the tissue and on the pad under the same press: the energy of the rise (integral of F dx "
    "from touch to stop, the criterion the paper names for dummy II) and the largest mean pressure, force over the "
    "{punch} face. A pad suits a criterion if its value is inside the subjects' range. Peak pressure is not "
    "given: under a sharp edge it grows without bound, it needs the edge radius of the real part."
)


@dataclass(frozen=True)
class PressRow:
    """One condition: energy and mean pressure, lowest and highest subject, and the pad (None out of reach)."""

    steady_force_N: float
    velocity_mm_s: float
    tissue_energy_mJ: tuple[float, float]
    pad_energy_mJ: float | None
    tissue_pressure_N_per_cm2: tuple[float, float]
    pad_pressure_N_per_cm2: float | None


@dataclass(frozen=True)
class SafetyView(Serialised):
    """Presses, and on request the impact of a mass and the comparison with limits, as plain rows."""

    presses: tuple[PressRow, ...]
    impact: tuple[dict[str, Any], ...] = ()
    impact_text: str = ""
    limits: tuple[dict[str, Any], ...] = ()
    limits_source: str = ""
    text: str = ""
    warnings: tuple[dict[str, str], ...] = ()


def safety_view(
    answer: Suggestion, robot_mass_kg: float | None = None, robot_velocity_mm_s: float = 250.0,
    limits: Limits | None = None,
) -> SafetyView:  # fmt: skip
    """Work out the safety view of a suggestion."""
    sampling = answer.targets.sampling
    slabs = answer.best.evaluation.slabs.take(np.array([answer.best.index]))
    presses, checked = [], []
    area = answer.punch.area_mm2
    depths = answer.best.evaluation.depth_mm[answer.best.index]
    for column, condition in enumerate(answer.targets.conditions):
        force, speed = condition.steady_force_N, condition.velocity_mm_s
        tissue = tissue_press(condition.range, answer.tissue.law, sampling)
        pad = pad_press(slabs, depths[[column]], speed, sampling)
        people, own = (contact.peak_force_N * N_PER_CM2 / area for contact in (tissue, pad))
        energies = _ends(tissue.energy_mJ), to_plain(pad.energy_mJ)[0]
        presses.append(PressRow(force, speed, *energies, _ends(people), to_plain(own)[0]))
        checked += [("tissue", f"{force:g} N, {speed:g} mm/s", tissue), ("pad", f"{force:g} N, {speed:g} mm/s", pad)]
    rows: list[dict[str, Any]] = []
    warned: list[dict[str, str]] = []
    words = ""
    if robot_mass_kg is not None:
        words = (
            f"A free mass of {robot_mass_kg:g} kg touches at {robot_velocity_mm_s:g} mm/s and is stopped by the "
            "clamped body alone; the energy is that of the mass, so the bodies differ in force and depth."
        )
        subjects, hit = answer.targets.tissue.parameter_sets, (robot_mass_kg, robot_velocity_mm_s)
        contacts: dict[str, tuple[SafetyContact, tuple[str, ...]]] = {"pad": (impact(pad_body(slabs), *hit), ())}
        try:
            if answer.tissue.measured:
                by_energy = curves_impact(subjects, *hit)
                contacts["tissue"] = by_energy.contact, by_energy.notes
                words += f" {CURVES_WORDS}."
            else:
                contacts["tissue"] = impact(tissue_body(subjects, robot_velocity_mm_s), *hit), ()
        except InputError as problem:
            words += f" Tissue: {problem}."
            warned.append({"code": "no_subjects_in_impact", "message": f"subjects beside the free mass: {problem}"})
        for name, (contact, notes) in contacts.items():
            rows += _impact_rows(name, contact, area, notes)
            if name == "pad" and not np.isfinite(contact.peak_force_N).all():
                warned.append(_bottoming(slabs, robot_mass_kg, robot_velocity_mm_s))
            checked.append((name, f"{robot_mass_kg:g} kg at {robot_velocity_mm_s:g} mm/s", contact))
    held: tuple[dict[str, Any], ...] = ()
    source = ""
    if limits is not None:
        held = tuple(
            {"body": name, "case": case, **row}
            for name, case, contact in checked
            for row in against_limits(contact, area, limits)
        )
        source = f"Limits '{limits.name}': {limits.force_N.source}; {limits.pressure_N_per_cm2.source}"
    text = TEXT.format(punch=answer.request.punch_text)
    return SafetyView(tuple(presses), tuple(rows), words, held, source, text, tuple(warned))


def _bottoming(slabs: Slabs, mass_kg: float, velocity_mm_s: float) -> dict[str, str]:
    """Text for a pad that does not stop a mass within its depth."""
    limit, thickness = float(slabs.curves.limit_mm[slabs.slab[0]]), float(slabs.thickness_mm[0])
    depth = np.linspace(0.0, limit, 200)
    force = slabs.young_MPa[0] * slabs.curves.area_at(slabs.slab, depth[None])[0]
    taken = float(work_mJ(depth, force))
    energy = 0.5e-3 * mass_kg * velocity_mm_s**2
    message = (
        f"the pad bottoms out: {mass_kg:g} kg at {velocity_mm_s:g} mm/s bring {energy:.3g} mJ, the pad at rest takes "
        f"{taken:.3g} mJ to {limit:.1f} mm, {limit / thickness:.2f} of its thickness; beyond it is as hard as its "
        "base, and its force says nothing of the person"
    )
    return {"code": "bottoms_out", "message": message}


def _impact_rows(name: str, contact: SafetyContact, area: float, notes: Sequence[str] = ()) -> list[dict[str, Any]]:
    columns = to_plain([contact.depth_mm, contact.peak_force_N, contact.energy_mJ])
    return [
        {
            "body": name if len(contact.depth_mm) == 1 else f"{name}, subject {index + 1}",
            "depth_mm": depth,
            "peak_force_N": peak,
            "energy_mJ": energy,
            "mean_pressure_N_per_cm2": None if peak is None else peak * N_PER_CM2 / area,
            "note": notes[index] if notes else ("" if peak is not None else BEYOND),
        }
        for index, (depth, peak, energy) in enumerate(zip(*columns))
    ]


def _ends(values: np.ndarray) -> tuple[float, float]:
    return float(values.min()), float(values.max())
