"""Safety: energy and mean pressure, a robot of finite mass, a user's limits, and the view of a suggestion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.core.toml_schema import read_table
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, press_to_depth
from dummydesign.design.scoring.targets import press_subjects
from dummydesign.measurement.motion import work_mJ
from dummydesign.tissue.model.measured_curves import MeasuredPerson

if TYPE_CHECKING:
    from dummydesign.design.suggestion import Suggestion
    from dummydesign.tissue.model.parameters import Parameters
    from dummydesign.tissue.model.ranges import ForceRange


# ISO/TS 15066: contact below 0.5 s is transient, what lasts longer quasi-static (second-hand, docs/references.md).
QUASI_STATIC_AFTER_S = 0.5
STEPS, LONGEST_MM, FINE, N_PER_CM2 = 1000, 40.0, 600, 100.0


@dataclass(frozen=True, eq=False)
class SafetyContact(Serialised):
    """What one contact does; arrays over bodies (subjects, or pads).

    ``energy_mJ`` is the integral of F dx from touch to stop, ``peak_force_N`` the largest force,
    ``held_force_N`` the largest force later than 0.5 s after touch (NaN when it is not followed that long),
    ``depth_mm`` the depth at the stop. NaN where the body's law ends before the stop.
    """

    depth_mm: NDArray
    energy_mJ: NDArray
    peak_force_N: NDArray
    held_force_N: NDArray
    stop_s: NDArray

    def where(self, known: NDArray) -> SafetyContact:
        """The same with NaN for bodies that are not known."""
        return SafetyContact(*(np.where(known, value, np.nan) for value in vars(self).values()))


def _of_press(time_s: NDArray, displacement_mm: NDArray, force_N: NDArray, stop_s: NDArray) -> SafetyContact:
    """Contact of presses (bodies, n); nothing moves after the stop, so all samples may be summed."""
    energy = work_mJ(displacement_mm, force_N)
    late = np.where(time_s >= QUASI_STATIC_AFTER_S, force_N, -np.inf).max(axis=-1)
    late = np.where(np.isfinite(late), late, np.nan)
    return SafetyContact(displacement_mm[:, -1], energy, force_N.max(axis=-1), late, stop_s)


def pad_press(
    slabs: PadBatch, depth_mm: NDArray, velocity_mm_s: float, sampling: Sampling | None = None
) -> SafetyContact:
    """Ramp and hold on pads, each to its own depth (NaN for out of reach); see :class:`SafetyContact`."""
    sampling = sampling or Sampling()
    press = press_to_depth(slabs, depth_mm, velocity_mm_s, sampling)
    return _of_press(press.time_s, press.displacement_mm, press.force_N, press.stop_s).where(np.isfinite(depth_mm))


def tissue_press(band: ForceRange, law: str = "ode", sampling: Sampling | None = None) -> SafetyContact:
    """Ramp and hold on the subjects of a force range, each to its own depth; see :class:`SafetyContact`."""
    contact = _of_press(*press_subjects([band], law, sampling or Sampling()), band.stop_s)
    return contact.where(band.stop_s <= band.time_s[-1])


@dataclass(frozen=True)
class ImpactBody:
    """Bodies of one kind with relaxing arms, for a mass that runs into them.

    Each arm obeys q' = gain(x) x' - decay(x) q.
    """

    count: int
    arms: int
    force: Callable[[NDArray, NDArray], NDArray]
    rates: Callable[[NDArray], tuple[NDArray, NDArray]]


def pad_body(slabs: PadBatch) -> ImpactBody:
    """Pads: elastic curve with Prony arms, q' = A'(x) x' - q / tau, F = E (A(x) + sum beta q)."""
    tau = np.array(slabs.tau_s)

    def force(x: NDArray, q: NDArray) -> NDArray:
        inside = np.where(x <= slabs.curves.limit_mm[slabs.slab], x, np.nan)
        area = slabs.curves.area_at(slabs.slab, inside[:, None])[:, 0]
        return slabs.young_MPa * (area + (slabs.beta * q).sum(axis=-1))

    def rates(x: NDArray) -> tuple[NDArray, NDArray]:
        slope = slabs.curves.slope_at(slabs.slab, x[:, None])
        return np.broadcast_to(slope, (len(x), len(tau))), np.broadcast_to(1.0 / tau, (len(x), len(tau)))

    return ImpactBody(len(slabs.slab), len(tau), force, rates)


def tissue_body(subjects: Sequence[Parameters], velocity_mm_s: float) -> ImpactBody:
    """Subjects by the arms of their law, q' = gain x' - decay q, and F = gamma1 x^3 + sum gamma x^2 q."""
    from dummydesign.tissue.model.laws import law_named
    from dummydesign.tissue.model.maxwell_law import stack

    gamma1, gamma, dampers = stack(subjects, velocity_mm_s)
    form = law_named(subjects[0].law)
    form.stretch_rates(np.zeros(len(gamma1)), gamma / dampers)  # says at once if the law does not

    def force(x: NDArray, q: NDArray) -> NDArray:
        return gamma1 * x**form.power + (gamma * q).sum(axis=-1) * x**2

    def rates(x: NDArray) -> tuple[NDArray, NDArray]:
        return form.stretch_rates(x, gamma / dampers)

    return ImpactBody(len(gamma1), gamma.shape[-1], force, rates)


def impact(body: ImpactBody, mass_kg: float, velocity_mm_s: float, longest_mm: float = LONGEST_MM) -> SafetyContact:
    """A free mass runs into bodies that rest on a rigid support, until it stops.

    m x'' = -F, x(0) = 0, x'(0) = v, by the midpoint rule with the arms' decay integrated exactly, so that a
    fast arm needs no short step; about 1000 steps to the stop. The energy of the rise is that of the mass,
    m v^2 / 2, whatever the body; force and depth distinguish bodies.

    References
    ----------
    ISO/TS 15066:2016, annex A (effective mass of the robot); here the body does not give way.
    """
    _check_impact(mass_kg, velocity_mm_s)
    guess = stop = _elastic_stop_s(body, 1e-3 * mass_kg, velocity_mm_s, longest_mm)
    for _ in range(8):
        contact = _run(body, 1e-3 * mass_kg, velocity_mm_s, stop / STEPS, longest_mm)
        # a mass that does not stop is followed at the pace of the elastic guess once more
        new = np.where(np.isfinite(contact.stop_s), contact.stop_s, guess)
        if np.all(np.abs(new / stop - 1.0) < 0.5):
            break
        stop = new
    return contact


def _check_impact(mass_kg: float, velocity_mm_s: float) -> None:
    for name, value in (("mass_kg", mass_kg), ("velocity_mm_s", velocity_mm_s)):
        if not (np.isfinite(value) and value > 0):
            raise out_of_range(name, value, "above 0", "any finite value")


def _elastic_stop_s(body: ImpactBody, mass: float, velocity: float, longest: float) -> NDArray:
    """About when a mass stops if nothing relaxes: twice the way that takes its energy, at full speed. [s]"""
    depth = longest * np.geomspace(1e-7, 1.0, 240)
    rest = np.zeros((body.count, body.arms))
    force = np.stack([body.force(np.full(body.count, x), rest) for x in depth])
    taken = np.cumsum(np.diff(depth, prepend=0.0)[:, None] * force, axis=0)
    enough = ~(taken < 0.5 * mass * velocity**2)  # NaN, beyond the law, ends the way as well
    return 2.0 * np.where(enough.any(axis=0), depth[np.argmax(enough, axis=0)], longest) / velocity


def _run(body: ImpactBody, mass: float, velocity: float, step: NDArray, longest: float) -> SafetyContact:
    """Run until every mass has stopped; the stop itself is where the speed passes zero within a step."""
    x, v, q = np.zeros(body.count), np.full(body.count, velocity), np.zeros((body.count, body.arms))
    time, peak, energy = np.zeros(body.count), np.zeros(body.count), np.zeros(body.count)
    depth, stop = np.full(body.count, np.nan), np.full(body.count, np.nan)

    def carried(q: NDArray, at: NDArray, speed: NDArray, h: NDArray) -> NDArray:
        gain, decay = body.rates(at)
        lost = decay * h[:, None]
        mean = np.where(lost > 1e-9, -np.expm1(-lost) / np.maximum(lost, 1e-9), 1.0)
        return q * np.exp(-lost) + gain * (speed * h)[:, None] * mean

    with np.errstate(invalid="ignore", over="ignore"):
        for _ in range(3 * STEPS):
            going = np.isnan(stop) & np.isfinite(v) & (x < longest)
            if not going.any():
                break
            half = x + 0.5 * step * v
            force = body.force(half, carried(q, x, v, 0.5 * step))
            new_v = v - step * force / mass
            share = np.where(new_v <= 0.0, v / np.maximum(v - new_v, 1e-300), 1.0)
            mean_v = 0.5 * (v + np.maximum(new_v, 0.0))
            new_x = x + share * step * mean_v
            q = np.where(going[:, None], carried(q, half, mean_v, share * step), q)
            halted = going & (new_v <= 0.0)
            depth, stop = np.where(halted, new_x, depth), np.where(halted, time + share * step, stop)
            energy = np.where(going, energy + force * (new_x - x), energy)
            peak = np.where(going, np.fmax(peak, np.fmax(force, body.force(new_x, q))), peak)
            x, v, time = np.where(going, new_x, x), np.where(going, new_v, v), np.where(going, time + step, time)
    known = np.isfinite(stop)
    none = np.full(body.count, np.nan)
    return SafetyContact(depth, np.where(known, energy, np.nan), np.where(known, peak, np.nan), none, stop)


WORDS = (
    "Tissue: each subject stops it where the force measured at this speed, over depth, has taken its energy. A mass "
    "slows down, so subjects are deeper than that, and at most as deep as their steady curve makes them"
)


@dataclass(frozen=True)
class CurvesImpact:
    """Contact of every person, and in words how deep it may be, or why it is not known."""

    contact: SafetyContact
    notes: tuple[str, ...]


def curves_impact(subjects: Sequence[Parameters], mass_kg: float, velocity_mm_s: float) -> CurvesImpact:
    """Stop a free mass on every person by the energy under the force-depth curve measured at its speed."""
    _check_impact(mass_kg, velocity_mm_s)
    people = [cast(MeasuredPerson, one) for one in subjects]
    wanted = 0.5e-3 * mass_kg * velocity_mm_s**2
    rows, notes = [], []
    for person in people:
        curve = person.rise_at(velocity_mm_s)
        if curve is None:
            speeds = sorted(set.intersection(*(set(one.velocities_mm_s) for one in people)))
            raise InputError(
                f"robot_velocity_mm_s = {velocity_mm_s:g} is outside the speeds that were pressed, and measured curves "
                f"say nothing of others: all were pressed at {', '.join(f'{v:g}' for v in speeds)} mm/s",
                "out_of_range",
                "robot_velocity_mm_s",
                velocity_mm_s,
                speeds,
            )
        depth, peak, taken = _stopped(*curve, wanted)
        rows.append((depth, wanted if np.isfinite(depth) else np.nan, peak))
        if not np.isfinite(depth):
            end = f"{taken:.3g} mJ to {curve[0][-1]:.2f} mm"
            notes.append(f"not stopped: it brings {wanted:.3g} mJ, the deepest press took {end}")
            continue
        at = np.linspace(0.0, curve[0][-1], FINE)
        rest = np.r_[0.0, person.steady_N(at[1:], np.inf)]
        most = _stopped(at, rest, wanted)[0]
        notes.append(f"at most {most:.2f} mm" if np.isfinite(most) else f"at rest deeper than {at[-1]:.2f} mm")
    depth, energy, peak = np.array(rows).T
    none = np.full(len(people), np.nan)
    return CurvesImpact(SafetyContact(depth, energy, peak, none, none), tuple(notes))


def _stopped(depth_mm: NDArray, force_N: NDArray, energy_mJ: float) -> tuple[float, float, float]:
    """Depth at which a curve has taken an energy, the largest force up to there, and all that it takes; NaN beyond."""
    x = np.linspace(0.0, depth_mm[-1], FINE)
    force = np.interp(x, depth_mm, force_N)
    taken = np.r_[0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(x))]
    if taken[-1] < energy_mJ:
        return np.nan, np.nan, float(taken[-1])
    stop = float(np.interp(energy_mJ, taken, x))
    return stop, float(max(np.interp(stop, x, force), force[x <= stop].max())), float(taken[-1])


@dataclass(frozen=True)
class UserLimits(Serialised):
    """A user's limits at one site, each with source: force [N] and pressure [N/cm2], and the transient factor."""

    name: str
    force_N: Quantity
    pressure_N_per_cm2: Quantity
    transient_factor: Quantity


def read_limits(path: str | Path) -> UserLimits:
    """Read a limits file: ``name`` and the three numbers, each with value, low, high, kind, source."""
    names = ("force_N", "pressure_N_per_cm2", "transient_factor")
    table = read_table(Path(path), ("schema", "name", *names), schema=None)
    return UserLimits(str(table.data.get("name", Path(path).stem)), *(table.quantity(name) for name in names))


def against_limits(contact: SafetyContact, area_mm2: float, limits: UserLimits) -> list[dict[str, Any]]:
    """Compare contacts with limits: one row a criterion, with the largest value over the bodies.

    Pressure is the mean over the punch, F / A.
    """
    rows = []
    criteria = (
        ("force_N", limits.force_N.value, 1.0),
        ("mean_pressure_N_per_cm2", limits.pressure_N_per_cm2.value, N_PER_CM2 / area_mm2),
    )
    contacts = (
        ("quasi-static", contact.held_force_N, 1.0),
        ("transient", contact.peak_force_N, limits.transient_factor.value),
    )
    for criterion, limit, factor in criteria:
        for kind, values, scale in contacts:
            known = values[np.isfinite(values)]
            value = float(known.max()) * factor if len(known) else None
            allowed = limit * scale
            within = None if value is None else value <= allowed
            rows.append({"criterion": criterion, "contact": kind, "value": value, "limit": allowed, "within": within})
    return rows


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
    answer: Suggestion,
    robot_mass_kg: float | None = None,
    robot_velocity_mm_s: float = 250.0,
    limits: UserLimits | None = None,
) -> SafetyView:
    """Work out the safety view of a suggestion."""
    sampling = answer.targets.sampling
    slabs, depths = answer.best.alone, answer.best.depth_mm
    presses, checked = [], []
    area = answer.punch.area_mm2
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
                words += f" {WORDS}."
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


def _bottoming(slabs: PadBatch, mass_kg: float, velocity_mm_s: float) -> dict[str, str]:
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


def _ends(values: NDArray) -> tuple[float, float]:
    return float(values.min()), float(values.max())
