"""Checks of the raw residual, and what it depends on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.inference.noise import whitener
from dummydesign.loop.data.reduction import HOLD, PRE, UNLOADING
from dummydesign.loop.fitting.candidates import project
from dummydesign.loop.fitting.fit import CampaignFit

LINE_RATIO = 2.3
STEP_Z = 6.0
QUIET_RATIO = 1.5
BLOCK_S = 0.1


def hats(values: NDArray, knots: NDArray) -> list[NDArray]:
    """Piecewise-linear hat functions on knots, constant outside."""
    return [np.interp(values, knots, hat) for hat in np.eye(len(knots))]


@dataclass(frozen=True)
class ResidualCheck(Serialised):
    """One check: its statistic, the limit, whether it is exceeded, and what was seen."""

    name: str
    value: float | None
    limit: float
    exceeded: bool
    text: str


def raw_residuals(fit: CampaignFit) -> list[NDArray]:
    """Measured minus modelled force at the raw samples, with each trial's contact shift and gain taken out. [N]"""
    presses = fit.problem.presses
    white = np.maximum(presses.samples, 1.0) / fit.sizes.noise.white_N**2 * presses.used
    slow = np.maximum(fit.sizes.noise.slow_N, 1e-6) ** 2
    weight = white / (1.0 + white * slow)
    own = np.stack([fit.slope, fit.forces], axis=-1)
    weighed = np.swapaxes(own * weight[..., None], 1, 2)
    ridge = np.diag(np.maximum(fit.sizes.scatter, 1e-9) ** -2.0)
    shift, gain = np.linalg.solve(weighed @ own + ridge, weighed @ fit.residual[..., None])[..., 0].T
    # slope is dF/dx: a trial that touched earlier by s reads s dF/dx more
    modelled = fit.problem.at_samples(fit.vector, -shift)
    return [t.trace.force_N - (1.0 + own) * model for t, own, model in zip(presses.trials, gain, modelled)]


def run_checks(fit: CampaignFit) -> list[ResidualCheck]:
    """Run all checks on a fit."""
    residual = raw_residuals(fit)
    return [_lines(fit, residual), _steps(fit, residual), _before_contact(fit, residual)]


def _lines(fit: CampaignFit, residual: list[NDArray]) -> ResidualCheck:
    """Average spectrum of the fast-sampled residual, 60 ms after the stop on, against its own median."""
    presses = fit.problem.presses
    pieces, rate = [], 0.0
    for row, (trial, values) in enumerate(zip(presses.trials, residual)):
        time = trial.trace.time_s
        step = float(np.median(np.diff(time[: max(20, len(time) // 20)])))
        inside = (time > presses.stop_s[row] + 0.06) & (time < presses.hold_end_s[row])
        run = np.nonzero(inside & (np.r_[step, np.diff(time)] < 1.2 * step))[0]
        if len(run) < 100 or step > 5e-3:
            continue
        pieces.append((values[run], step))
    if len(pieces) < 3:
        return ResidualCheck("spectral line", None, LINE_RATIO, False, "needs 0.1 s of fast sampling after the stop")
    length = min(len(piece) for piece, _ in pieces)
    rate = 1.0 / pieces[0][1]
    power = np.zeros(length // 2 + 1)
    used = [piece[:length] for piece, step in pieces if abs(step * rate - 1.0) < 0.05]
    at = np.arange(length)
    for piece in used:
        smooth = np.polynomial.Polynomial.fit(at, piece, 3)(at)
        power += np.abs(np.fft.rfft((piece - smooth) * np.hanning(length))) ** 2
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    seen = frequency > max(15.0, 5.0 * frequency[1])
    ratio = power[seen] / np.median(power[seen])
    limit = 1.0 + (LINE_RATIO - 1.0) * np.sqrt(36.0 / len(used))
    top = int(np.argmax(ratio))
    text = f"strongest oscillation at {frequency[seen][top]:.1f} Hz, {ratio[top]:.3g} times the median of the spectrum"
    return ResidualCheck("spectral line", float(ratio[top]), float(limit), bool(ratio[top] > limit), text)


def _steps(fit: CampaignFit, residual: list[NDArray]) -> ResidualCheck:
    """Largest step in any hold, in standard deviations of white and slow noise or of the rest if that is
    more (Student's t); a smooth drift is allowed."""
    presses, noise = fit.problem.presses, fit.sizes.noise
    worst, where, size = 0.0, "", 0.0
    for row, (trial, values) in enumerate(zip(presses.trials, residual)):
        time = trial.trace.time_s
        begin, end = presses.stop_s[row] + 0.4, presses.hold_end_s[row] - 0.05
        count = int((end - begin) / BLOCK_S)
        if count < 10:
            continue
        block = np.floor((time - begin) / BLOCK_S).astype(int)
        inside = (block >= 0) & (block < count)
        samples = np.bincount(block[inside], minlength=count)
        if np.any(samples == 0):
            continue
        mean = np.bincount(block[inside], values[inside], minlength=count) / samples
        middle = begin + BLOCK_S * (np.arange(count) + 0.5)
        gap = np.abs(middle[:, None] - middle)
        cover = noise.slow_N**2 * np.exp(-gap / noise.slow_time_s) + np.diag(noise.white_N**2 / samples)
        factor = whitener(cover)
        since = middle - presses.stop_s[row]
        # what a wrong relaxation leaves bends, in time and in its logarithm
        smooth = factor @ np.stack([np.ones(count), np.log(since), since, np.log(since) ** 2, since**2], axis=1)
        basis = np.linalg.qr(smooth)[0]
        both = factor @ np.column_stack([mean, np.arange(count)[:, None] >= np.arange(3, count - 3)])
        both -= basis @ (basis.T @ both)
        clean, steps = both[:, 0], both[:, 1:]
        length = np.linalg.norm(steps, axis=0)
        z = (steps.T @ clean) / length
        top = int(np.argmax(np.abs(z)))
        # a step leaves noise; a curve that a step fits best of all steps leaves more
        rest = (clean @ clean - z[top] ** 2) / (count - smooth.shape[1] - 1)
        own = z[top] / np.sqrt(max(1.0, rest))
        if abs(own) > abs(worst):
            worst, size = float(own), float(z[top] / length[top])
            where = f"{trial.file}, {since[top + 3]:.1f} s after the stop"
    text = f"largest step {size:+.3f} N in {where}" if where else "needs holds of a second or more"
    return ResidualCheck("step in the hold", abs(worst) if where else None, STEP_Z, abs(worst) > STEP_Z, text)


def _before_contact(fit: CampaignFit, residual: list[NDArray]) -> ResidualCheck:
    """Scatter of the residual before contact against the white and slow noise of the rest."""
    presses = fit.problem.presses
    squares, count = 0.0, 0
    for row, (trial, values) in enumerate(zip(presses.trials, residual)):
        before = values[trial.trace.time_s < presses.contact_s[row] - 0.005]
        if len(before) >= 20:
            squares += float(((before - before.mean()) ** 2).sum())
            count += len(before) - 1
    if count < 50:
        return ResidualCheck("noise before contact", None, QUIET_RATIO, False, "needs 20 samples before contact")
    ratio = float(np.sqrt(squares / count) / fit.sizes.floor_N)
    text = f"scatter before contact is {ratio:.2f} times the noise floor"
    return ResidualCheck("noise before contact", ratio, QUIET_RATIO, ratio > QUIET_RATIO, text)


@dataclass(frozen=True)
class Dependence(Serialised):
    """How much of a residual follows one factor: drop of chi2, columns, share of all chi2, and how it looks."""

    factor: str
    drop: float
    columns: int
    share: float
    shape: str
    also = ("excess",)

    @property
    def excess(self) -> float:
        """Drop beyond what noise gives on average."""
        return self.drop - self.columns


def families(fit: CampaignFit) -> dict[str, list[NDArray]]:
    """Columns (T, B) in newton for each factor, at the modelled forces."""
    presses = fit.problem.presses
    force, bins, used = fit.forces, presses.bins, presses.used
    middle = 0.5 * (bins.start + bins.end)
    since = presses.since_stop_s
    phase = np.where(used, presses.label // 100, PRE)
    history = presses.history
    log_time = np.log(np.clip(since, 1e-3, 20.0))
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))
    pressed = np.where((phase == HOLD) | (phase == UNLOADING), 1.0, 0.0)
    times = np.log([1e-3, 6e-3, 3e-2, 0.12, 0.5, 2.0, 8.0])
    logs = (np.log(one)[:, None] for one in (np.maximum(presses.velocity_mm_s, 1e-3), presses.thickness_mm))
    speed, thick = (one - one.mean() for one in logs)
    fast = presses.velocity_mm_s[:, None] / presses.velocity_mm_s.max()
    window = np.linspace(0.0, 0.3, 31)
    unit = force.max() or 1.0
    out = {
        "force": [force * (force / unit), force * (force / unit) ** 2, force * (force / unit) ** 3],
        "depth": [force * hat for hat in hats(depth, np.linspace(0.0, depth.max(), 9))],
        "speed": [force * speed * hat for hat in hats(log_time, times)],
        "thickness": [force * thick * hat for hat in hats(log_time, times)],
        "time since stop": [force * pressed * hat for hat in hats(log_time, times)],
        "oscillation after the stop": [fast * (since > 0) * (since < 0.3) * hat for hat in hats(since, window)],
        "order": [force * _standard(history.sequence), force * _standard(history.sequence) ** 2],
        "repeat": [force * _standard(history.repeat)],
        "loading or unloading": [force * (phase == UNLOADING), depth * (phase == UNLOADING)],
        "before contact": [1.0 * (phase == PRE) * (middle < presses.contact_s[:, None])],
        "single trials": [force * (np.arange(len(force)) == row)[:, None] for row in range(len(force))],
    }
    for column in ("temperature_C", "age_days"):
        declared = getattr(history, column)
        if np.all(np.isfinite(declared)):
            out[column.partition("_")[0]] = [force * _standard(declared)]
    return {name: [np.where(used, column, 0.0) for column in columns] for name, columns in out.items()}


@dataclass(frozen=True)
class ResidualDiagnostics:
    """What a residual depends on, strongest first, and the checks of it."""

    where: list[Dependence]
    checks: list[ResidualCheck]


def diagnose(fit: CampaignFit) -> ResidualDiagnostics:
    """Measure what the residual of a fit depends on, and check it."""
    return ResidualDiagnostics(dependences(fit), run_checks(fit))


def _standard(values: NDArray) -> NDArray:
    """Centred and scaled to one, as a column."""
    centred = values - values.mean()
    spread = np.abs(centred).max()
    return (centred / spread if spread > 0 else centred)[:, None]


def dependences(fit: CampaignFit) -> list[Dependence]:
    """Measure all factors on the residual of a fit, strongest first."""
    projection = project(fit, law_free=True)
    clean = projection.remove(projection.residual)
    total = float(clean @ clean)
    out = []
    for name, columns in families(fit).items():
        stacked = np.stack([projection.column(one) for one in columns], axis=1)
        length = np.linalg.norm(stacked, axis=0)
        cleaned = projection.remove(stacked)[:, length > 0] / length[length > 0]
        if not cleaned.size:
            continue
        basis, singular, turn = np.linalg.svd(cleaned, full_matrices=False)
        keep = singular > 0.02
        if not keep.any():
            continue
        along = basis[:, keep].T @ clean
        drop = float(along @ along)
        weights = np.zeros(len(columns))
        weights[length > 0] = turn[keep].T @ (along / singular[keep])
        shape = " ".join(f"{w:+.1f}" for w in weights[:12]) if name != "single trials" else ""
        out.append(Dependence(name, drop, int(keep.sum()), drop / total if total else 0.0, shape))
    return sorted(out, key=lambda one: -one.excess)
