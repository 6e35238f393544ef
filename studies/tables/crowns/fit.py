"""The pieces of the surface of crowned pads from solved curves (:mod:`dummydesign.pad.tables.crowned`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.pad.tables.crowned import CrownResponse, Response, crown_inputs
from studies.tables.crowns.edge import MET
from studies.tables.crowns.levels import fit_by_level

Array = np.ndarray

# Levels: d / c of the crown alone and of the bend, eta of the jump, d / h of what all pads share.
ALONE = np.array(
    [0.03, 0.06, 0.1, 0.16, 0.23, 0.32, 0.42, 0.52, 0.62, 0.72, 0.8, 0.87, 0.94, 1.02, 1.1, 1.2, 1.32, 1.45]
)
BENT = np.array(
    [0.1, 0.16, 0.23, 0.32, 0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.87, 0.93, 0.98, 1.03, 1.08, 1.14, 1.2, 1.3, 1.45, 1.65]
    + [1.9, 2.2, 2.6, 3.0, 3.5]
)
RISEN = np.array([0.01, 0.015, 0.021, 0.028, 0.036, 0.046, 0.058, 0.075, 0.1, 0.13])
SHARED = np.array([0.15, 0.18, 0.22, 0.26, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6])
# Known scatter of ln F, of a force beside another of the same pad, and of eta.
NOISE, PAIR_NOISE, ETA_NOISE = 0.002, 0.003, 7e-4
# Scatter of ln of the edge's depth: met at once, and grown to.
EDGE_NOISE = 0.003, 0.03
# Where the larger fillet's force is this much softer, the edge carries.
CARRIES = 0.012
# What all pads share is fitted to depths beyond the edge's plus this (a jump), or times this (a bend).
CLEAR = 0.03, 1.08
# A level is left out below this depth over thickness: less is not solved.
LEAST = 0.01
# Foot over the punch's radius below which the flat around the crown is met at once.
NARROW = 0.7
# Feet over the punch's radius that help each piece to its end.
OF_JUMP, OF_BEND = 0.95, 0.6
# Curves that reach the last depth are carried on straight to here, so that the bend has no free end, and those of the
# crown alone by this share of their end, with this scatter: what is beyond it is asked for where edges are late.
CARRIED_ON, BEYOND, BEYOND_NOISE = 0.9, 1.12, 0.01


@dataclass(frozen=True)
class Curves:
    """Solved crowns.

    Attributes
    ----------
    inputs : ndarray, shape (n, 4)
        ln h/a, c/h, ln b/a, ln s.
    depth : ndarray, shape (m,)
        Depths over thickness.
    y, added : ndarray, shape (n, m)
        ln of F over the tip's; what a sharp edge added, relative. NaN where not solved.
    edge, doubt : ndarray, shape (n,)
        d / h at which the edge is reached, and what is not known of it; NaN where not known.
    reach : ndarray, shape (n,)
    """

    inputs: Array
    depth: Array
    y: Array
    added: Array
    edge: Array
    doubt: Array
    reach: Array


def fit_crowns(curves: Curves) -> CrownResponse:
    """Fit all pieces."""
    x, inputs, height = curves.depth, curves.inputs, curves.inputs[:, 1]
    narrow = inputs[:, 2] < np.log(NARROW)
    met = np.nan_to_num(curves.doubt, nan=1.0) <= MET
    seen = np.isfinite(curves.edge)
    narrow_edge = _edge(curves, met & (inputs[:, 2] < np.log(OF_JUMP)), met)
    wide_edge = _edge(curves, seen & (inputs[:, 2] > np.log(NARROW - 0.05)), met)
    modelled = height * np.exp(np.where(narrow, narrow_edge.at_levels(inputs)[:, 0], wide_edge.at_levels(inputs)[:, 0]))
    edge = np.where(narrow & met, curves.edge, modelled)
    carries = (np.abs(np.nan_to_num(curves.added)) > CARRIES) & (x > 0.03)
    engaged = np.where(carries.any(axis=1), x[carries.argmax(axis=1)], np.inf)
    solved = np.isfinite(curves.y)
    untouched = solved & (x < 0.98 * edge[:, None]) & (x < engaged[:, None] - 1e-9)
    ends = np.where(untouched.any(axis=1), x[len(x) - 1 - untouched[:, ::-1].argmax(axis=1)], 0.0)
    alone = _levels(curves.y, untouched, x, ALONE, height, BEYOND * ends, anchored=True)
    alone[ALONE * height[:, None] < LEAST] = np.nan
    unsure = np.where(ALONE * height[:, None] > ends[:, None] + 1e-9, BEYOND_NOISE, NOISE)
    wide = np.nonzero(inputs[:, 2] > np.log(OF_BEND))[0]
    last = np.array([x[row][-1] for row in solved])
    last = np.where(last >= x[-1], CARRIED_ON, last)
    bent = _levels(curves.y[wide], solved[wide], x, BENT, height[wide], last[wide], anchored=True)
    bent[BENT * height[wide, None] < 0.55 * edge[wide, None]] = np.nan
    clear = np.where(narrow, edge + CLEAR[0], CLEAR[1] * edge)
    shared = _levels(curves.y, solved & (x > clear[:, None]), x, SHARED, np.ones(len(inputs)), last)
    jumped = np.nonzero(met & (inputs[:, 2] < np.log(OF_JUMP)))[0]
    risen, scatter = _risen(curves, jumped)
    reach = curves.reach

    def fitted(values: Array, levels: Array, which: Array) -> Response:
        return fit_by_level(inputs[which], values, np.full(values.shape, NOISE), levels, False, reach[which])

    return CrownResponse(
        fit_by_level(crown_inputs(inputs), alone, unsure, ALONE, True, reach),
        narrow_edge,
        wide_edge,
        fit_by_level(inputs[jumped], risen, scatter, RISEN, False, reach[jumped]),
        fitted(bent, BENT, wide),
        fitted(shared, SHARED, np.arange(len(inputs))),
    )


def _edge(curves: Curves, use: Array, met: Array) -> Response:
    """ln of the edge's depth over the crown's height, of some of the pads; ``met`` says which are known best."""
    inputs = curves.inputs[use]
    value = np.log(curves.edge[use] / inputs[:, 1])[:, None]
    noise = np.where(met[use], *EDGE_NOISE)[:, None]
    return fit_by_level(inputs, value, noise, np.ones(1), False, curves.reach[use])


def _levels(y: Array, use: Array, x: Array, levels: Array, unit: Array, ends: Array, anchored: bool = False) -> Array:
    """Curves (n, m) at the levels, counted in ``unit`` (n,): a natural spline in sqrt(d / h), straight from its last
    point to the ``ends`` (n,); NaN where not known."""
    out = np.full((len(y), len(levels)), np.nan)
    for row, curve, known, one, end in zip(out, y, use, unit, ends):
        if known.sum() < 3:
            continue
        node, value = np.sqrt(x[known]), curve[known]
        first = 0.0 if anchored else x[known][0] - 1e-9
        wanted = (levels * one >= first) & (levels * one <= end + 1e-9)
        row[wanted] = _carried(node, value, np.sqrt(levels[wanted] * one), anchored)
    return out


def _carried(node: Array, value: Array, at: Array, anchored: bool = False) -> Array:
    """Natural cubic spline, from 0 at 0 when anchored, straight beyond its last point."""
    from scipy.interpolate import CubicSpline

    if anchored:
        node, value = np.append(0.0, node), np.append(0.0, value)
    spline = CubicSpline(node, value, bc_type="natural")
    inside = np.clip(at, node[0], node[-1])
    return spline(inside) + np.maximum(at - node[-1], 0.0) * spline(node[-1], 1)


def _risen(curves: Curves, which: Array) -> tuple[Array, Array]:
    """ln((F / F_e - 1) / eta) at the levels, and its known scatter."""
    x = curves.depth
    values, noise = np.full((len(which), len(RISEN)), np.nan), np.ones((len(which), len(RISEN)))
    for k, i in enumerate(which):
        edge, solved = curves.edge[i], np.isfinite(curves.y[i])
        before, after = solved & (x < edge - 5e-4), solved & (x > edge + 1e-3)
        if before.sum() < 3 or after.sum() < 4:
            continue
        at_edge = _carried(np.sqrt(x[before]), curves.y[i, before], np.sqrt(np.array([edge])), anchored=True)[0]
        grown = np.expm1(curves.y[i, after] - at_edge + 1.5 * np.log(x[after] / edge))
        up = grown > 1e-3
        if up.sum() < 4:
            continue
        eta, grown = (x[after] - edge)[up], grown[up]
        node, at = np.sqrt(eta), np.sqrt(RISEN)
        wanted = (at >= 0.8 * node[0]) & (at <= node[-1] + 1e-9)
        values[k, wanted] = _carried(node, np.log(grown / eta), at[wanted])
        level = np.exp(np.interp(at, node, np.log(grown)))
        noise[k] = PAIR_NOISE * (1.0 + level) / level + ETA_NOISE / RISEN
    return values, noise
