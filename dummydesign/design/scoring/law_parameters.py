"""Parameters of the tissue law fitted to simulated presses of many designs at once (per-speed mode)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, SimulatedPress, press_to_depth
from dummydesign.design.scoring.score import halving, steady_gamma1
from dummydesign.design.scoring.targets import NARROWEST, Targets
from dummydesign.tissue.model.maxwell_law import Parameters, law_named

STEPS, TOLERANCE, DIFFERENCE = 40, 1e-4, 1e-5
_FIT_SAMPLING = (16, 8, 24)
FIRST_HOLD_S = 0.002
# Bounds of gamma / c; a faster arm is a plain damper at the speeds of the protocol. [1/(mm2 s)]
RATES = (1e-6, 1e4)


def fit_presses(slabs: PadBatch, targets: Targets, depth_mm: NDArray, sampling: Sampling) -> list[Parameters | None]:
    """Fit the law of the tissue to the simulated presses of each design.

    All conditions together, springs shared, dampers per speed (as the paper reports them and as bands
    and scores use them); residuals count evenly in the rise in time and in the hold in the logarithm of
    time. Levenberg-Marquardt in the logarithms of the rates c / gamma with the springs, in which the law
    is linear, solved exactly at each step (variable projection), all designs side by side.

    References
    ----------
    Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413 (variable projection).
    """
    fine = Sampling(*_FIT_SAMPLING, sampling.hold_s, sampling.deceleration_mm_s2)
    speeds = _speeds(targets)
    speed_of = np.array([speeds.index(condition.velocity_mm_s) for condition in targets.conditions])
    reached = np.isfinite(depth_mm)
    usable = np.array([all(row[speed_of == s].any() for s in range(len(speeds))) for row in reached])
    if not usable.any():
        return [None] * len(usable)
    kept = slabs.take(usable)
    presses = [
        press_to_depth(kept, depth_mm[usable, index], condition.velocity_mm_s, fine)
        for index, condition in enumerate(targets.conditions)
    ]
    problem = _Problem(presses, fine, targets, speed_of)
    rates = problem.solve()
    springs, _ = problem.fit(problem.responses(rates))
    parameters: list[Parameters | None] = [None] * len(usable)
    for row, design in enumerate(np.nonzero(usable)[0]):
        gamma, per_speed = springs[row, 1:], springs[row, 1:] / rates[row]
        order = np.argsort(-(per_speed / gamma).mean(axis=0))
        dampers = tuple((v, tuple(per_speed[s][order])) for s, v in enumerate(speeds))
        parameters[design] = Parameters(targets.tissue.law, springs[row, 0], tuple(gamma[order]), dampers)
    return parameters


class _Problem:
    """Presses of D designs as one weighted least-squares problem in ln rate (D, speeds, arms)."""

    def __init__(self, presses: list[SimulatedPress], sampling: Sampling, targets: Targets, speed_of: NDArray) -> None:
        self.arms = (targets.tissue.elements - 1) // 2
        wanted: list[NDArray] = []
        self.weight, self.drives = [], []
        for index, velocity in enumerate(_speeds(targets)):
            group = [press for press, speed in zip(presses, speed_of) if speed == index]
            depth = np.stack([press.depth_mm for press in group], axis=1)
            known = np.isfinite(depth)
            motion = sampling.motion(velocity, np.where(known, depth, 1.0))
            stop = np.stack([press.stop_s for press in group], axis=1)
            self.weight.append(_weights(motion.time_s, stop) * known[..., None])
            force = np.nan_to_num(np.stack([press.force_N for press in group], axis=1))
            wanted.append((force * self.weight[-1]).reshape(len(depth), -1))
            self.drives.append(law_named(targets.tissue.law).drive(motion))
        self.wanted = np.concatenate(wanted, axis=1)
        start = targets.parameters
        rate = np.array([np.divide(start.gamma_N_per_mm3, start.dampers_at(v)) for v in _speeds(targets)])
        self.start = np.broadcast_to(np.log(rate), (len(presses[0].stop_s), *rate.shape)).copy()

    def responses(self, rates: NDArray) -> list[NDArray]:
        """Weighted responses of spring and arms, (D, n, 1 + arms) one a speed, for rates (D, speeds, arms)."""
        blocks = []
        for index, drive in enumerate(self.drives):
            columns = [drive.elastic, *(drive.arm(rates[:, index, arm, None]) for arm in range(self.arms))]
            weighted = np.stack(columns, axis=-1) * self.weight[index][..., None]
            blocks.append(weighted.reshape(len(rates), -1, 1 + self.arms))
        return blocks

    def fit(self, responses: list[NDArray]) -> tuple[NDArray, NDArray]:
        """Best non-negative springs (D, 1 + arms) for given responses, and weighted residuals (D, n)."""
        matrix = np.concatenate(responses, axis=1)
        springs = _nonnegative(matrix, self.wanted)
        return springs, np.einsum("dnk,dk->dn", matrix, springs) - self.wanted

    def solve(self) -> NDArray:
        """Levenberg-Marquardt on ln rate, all designs side by side; returns the rates."""
        x = self.start.copy()
        size = x[0].size
        responses = self.responses(np.exp(x))
        residual = self.fit(responses)[1]
        cost = (residual**2).sum(-1)
        damping, moving = np.full(len(x), 1e-2), np.ones(len(x), bool)
        for _ in range(STEPS):
            jacobian = np.stack([self._column(x, k, responses, residual) for k in range(size)], axis=-1)
            normal = np.einsum("dnk,dnl->dkl", jacobian, jacobian)
            gradient = np.einsum("dnk,dn->dk", jacobian, residual)
            diagonal = np.einsum("dkk->dk", normal)
            ridge = damping[:, None] * diagonal + 1e-9 * (diagonal.max(-1, keepdims=True) + 1e-30)
            step = -np.linalg.solve(normal + ridge[:, None, :] * np.eye(size), gradient[..., None])[..., 0]
            step = np.where(moving[:, None], np.clip(step, -2.0, 2.0), 0.0).reshape(x.shape)
            tried = np.clip(x + step, *np.log(RATES))
            new_responses = self.responses(np.exp(tried))
            new = self.fit(new_responses)[1]
            new_cost = (new**2).sum(-1)
            better = moving & (new_cost < cost)
            settled = better & (new_cost > (1.0 - TOLERANCE) * cost)
            x, residual = np.where(better[:, None, None], tried, x), np.where(better[:, None], new, residual)
            responses = [np.where(better[:, None, None], n, o) for n, o in zip(new_responses, responses)]
            cost = np.where(better, new_cost, cost)
            damping = np.clip(np.where(better, damping / 5, damping * 5), 1e-9, 1e6)
            moving &= ~settled & (damping < 1e4)
            if not moving.any():
                break
        return np.exp(x)

    def _column(self, x: NDArray, k: int, responses: list[NDArray], residual: NDArray) -> NDArray:
        """Derivative of the residuals by ln rate k: only the presses at its speed answer to it."""
        speed, arm = divmod(k, self.arms)
        moved = np.exp(x[:, speed, arm] + DIFFERENCE)
        changed = list(responses)
        changed[speed] = changed[speed].copy()
        column = self.drives[speed].arm(moved[:, None]) * self.weight[speed]
        changed[speed][..., 1 + arm] = column.reshape(len(x), -1)
        return (self.fit(changed)[1] - residual) / DIFFERENCE


def _weights(time_s: NDArray, stop_s: NDArray) -> NDArray:
    """Roots of the weights of samples: rise even in time, hold even in its logarithm, one each in sum."""
    since = time_s - stop_s[..., None]
    rise = np.gradient(time_s, axis=-1) * (since <= 0)
    hold = np.gradient(np.log(np.maximum(since, 1e-6)), axis=-1) * (since >= FIRST_HOLD_S)
    return np.sqrt(rise / rise.sum(-1, keepdims=True) + hold / hold.sum(-1, keepdims=True))


def _speeds(targets: Targets) -> list[float]:
    return list(dict.fromkeys(condition.velocity_mm_s for condition in targets.conditions))


def _nonnegative(matrix: NDArray, right: NDArray) -> NDArray:
    """Least squares (D, n, k) with coefficients kept above zero: all columns, or every subset where one falls below."""
    normal = np.einsum("dnk,dnl->dkl", matrix, matrix)
    moment = np.einsum("dnk,dn->dk", matrix, right)
    size = matrix.shape[-1]
    best = np.full((len(matrix), size), 0.0)
    lowest = np.full(len(matrix), np.inf)
    scale = np.maximum(np.einsum("dkk->dk", normal), 1e-300)
    for subset in range(2**size - 1, 0, -1):
        chosen = [k for k in range(size) if subset >> k & 1]
        part = normal[:, chosen][:, :, chosen]
        ridge = 1e-12 * scale[:, chosen][:, None, :] * np.eye(len(chosen))
        value = np.linalg.solve(part + ridge, moment[:, chosen][..., None])[..., 0]
        cost = -2 * np.einsum("dk,dk->d", value, moment[:, chosen])
        cost += np.einsum("dk,dkl,dl->d", value, part, value)
        good = (value >= 0).all(-1) & (cost < lowest)
        lowest = np.where(good, cost, lowest)
        full = np.zeros_like(best)
        full[:, chosen] = value
        best = np.where(good[:, None], full, best)
        if len(chosen) == size and good.all():
            break
    return np.maximum(best, 1e-9 * best.max(-1, keepdims=True))


def parametric_score(fitted: list[Parameters | None], targets: Targets) -> NDArray:
    """Closeness of fitted parameters to the aim: mean over all of 1/2 to the distance in half-widths.

    Distances are in the logarithm; the half-width of each parameter is half its band over the subjects.
    Designs without parameters get 0. Shape (D,).
    """
    bands = [_flat(subject.parameters.to_dict()) for subject in targets.tissue.subjects]
    aim = _flat(targets.parameters.to_dict())
    scores = np.zeros(len(fitted))
    for index, parameters in enumerate(fitted):
        if parameters is None:
            continue
        values = _flat(parameters.to_dict())
        parts = []
        for name, wanted in aim.items():
            if name not in values:
                continue
            spread = [band[name] for band in bands]
            half = max(0.5 * np.log(max(spread) / min(spread)), NARROWEST)
            parts.append(halving(np.log(values[name] / wanted) / half))
        scores[index] = float(np.mean(parts))
    return scores


def gamma1_score(gamma1_N_per_mm3: NDArray, targets: Targets) -> NDArray:
    """The share of :func:`parametric_score` that gamma1 alone gives, for the map; 0 without a law. Shape (D,)."""
    if not targets.parametric:
        return np.zeros(len(gamma1_N_per_mm3))
    spread = [subject.parameters.gamma1_N_per_mm3 for subject in targets.tissue.subjects]
    half = max(0.5 * np.log(max(spread) / min(spread)), NARROWEST)
    with np.errstate(divide="ignore", invalid="ignore"):
        return halving(np.log(gamma1_N_per_mm3 / targets.steady_gamma1_N_per_mm3) / half)


def rough_parametric(slabs: PadBatch, targets: Targets, sampling: Sampling) -> NDArray:
    """The :func:`gamma1_score` of designs from their steady forces in the test of the targets, shape (D,)."""
    return gamma1_score(steady_gamma1(slabs, targets.protocol, sampling.coarse, targets.power), targets)


def _flat(values: dict[str, Any]) -> dict[str, float]:
    """Write dampers per speed as names of their own; the law's name is left out."""
    flat: dict[str, float] = {}
    for name, value in values.items():
        if isinstance(value, dict):
            flat |= {f"{name} at {speed} mm/s": item for speed, item in value.items()}
        elif not isinstance(value, str):
            flat[name] = value
    return flat
