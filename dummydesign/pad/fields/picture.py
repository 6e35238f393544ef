"""Picture of a pressed pad: deformed cross-section with stress, to scale with the punch, and the contact pressure."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_bytes
from dummydesign.pad.fields.pressed import Pressed

Array = np.ndarray

SUFFIXES = (".png", ".svg", ".pdf")
# Colours end at this percentile of the stress under the punch: at the punch's edge it has no bound.
TOP = 97.0


def write_picture(fields: Sequence[Pressed], path: str | Path, title: str = "") -> Path:
    """Draw one row for each depth (at most four, evenly chosen): cross-section, and pressure over the radius.

    Parameters
    ----------
    fields : sequence of Pressed
        One for each depth.
    path : path
        ``.png``, ``.svg`` or ``.pdf``.
    title : str
        Over the picture.

    Returns
    -------
    Path
        The file, as it was asked for.

    Raises
    ------
    InputError
        For another ending, or a place that cannot be written.
    """
    final = Path(path)
    if final.suffix not in SUFFIXES:
        raise InputError(f"picture '{path}' must end with {', '.join(SUFFIXES)}")
    buffer = io.BytesIO()
    figure = draw(fields, title)
    figure.savefig(buffer, format=final.suffix[1:], dpi=160)
    return write_bytes(final, buffer.getvalue())


def draw(fields: Sequence[Pressed], title: str = "") -> Any:
    """The picture as a ``matplotlib.figure.Figure``."""
    from matplotlib.figure import Figure

    chosen = [fields[k] for k in np.unique(np.linspace(0, len(fields) - 1, min(4, len(fields))).round().astype(int))]
    reach = 1.6 * max(float(pressed.punch_mm[:, 0].max()) for pressed in chosen)
    height = max(float(pressed.rest_mm[:, 1].max()) for pressed in chosen)
    top = height + max(0.12 * reach, 1.0)
    width = 6.6
    row = width * (top + 0.06 * reach) / (2.0 * reach) + 0.55
    figure = Figure(figsize=(width + 3.9, max(2.2, row) * len(chosen) + 0.6), layout="constrained")
    grid = figure.subplots(len(chosen), 2, squeeze=False, width_ratios=[width, 3.0])
    under = [p.von_mises_MPa[p.rest_mm[:, 0] < 0.9 * p.face.contact_radius_mm] for p in chosen]
    ceiling = 1e3 * max((float(np.percentile(values, TOP)) for values in under if len(values)), default=1.0)
    for (section, profile), pressed in zip(grid, chosen):
        shown = _section(section, pressed, reach, top, ceiling)
        _profile(profile, pressed, reach)
    figure.colorbar(shown, ax=list(grid[:, 0]), label="von Mises stress in kPa", extend="max", shrink=0.8, pad=0.01)
    if title:
        figure.suptitle(title, fontsize=11)
    return figure


def _triangles(cells: Array) -> Array:
    """Eight triangles for each nine-node cell."""
    a, b, c, d, ab, bc, cd, da, m = cells.T
    parts = [(a, ab, m), (ab, b, m), (b, bc, m), (bc, c, m), (c, cd, m), (cd, d, m), (d, da, m), (da, a, m)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def _section(axes: Any, pressed: Pressed, reach: float, top: float, ceiling: float) -> Any:
    place = pressed.rest_mm + pressed.displacement_mm
    stress = 1e3 * pressed.von_mises_MPa
    near = (pressed.rest_mm[pressed.cells, 0] < 1.3 * reach).any(axis=1)
    triangles = _triangles(pressed.cells[near])
    for side in (1.0, -1.0):
        shown = axes.tripcolor(side * place[:, 0], place[:, 1], triangles, stress, shading="gouraud", cmap="viridis",
                               vmin=0.0, vmax=ceiling, rasterized=True)  # fmt: skip
        axes.plot(side * place[pressed.face.node, 0], place[pressed.face.node, 1], color="0.1", linewidth=0.8)
    half = np.concatenate([pressed.punch_mm, [[pressed.punch_mm[-1, 0], top + reach]]])
    outline = np.concatenate([half[::-1] * (-1.0, 1.0), half])
    axes.fill(*outline.T, facecolor="0.75", edgecolor="0.2", linewidth=0.8)
    axes.axhline(0.0, color="0.2", linewidth=1.6)
    axes.set(xlim=(-reach, reach), ylim=(-0.04 * reach, top), aspect="equal", ylabel="height in mm")
    axes.set_title(f"depth {pressed.depth_mm:.3g} mm, force {pressed.force_N:.3g} N", fontsize=9, loc="left")
    return shown


def _profile(axes: Any, pressed: Pressed, reach: float) -> None:
    contact = pressed.contact()
    profile = contact["profile"]
    axes.plot(profile["radius_mm"], profile["pressure_kPa"], color="#1f4e79", linewidth=1.4)
    mean = contact["mean_kPa"]
    axes.axhline(mean, color="0.5", linewidth=0.8, linestyle="--")
    axes.annotate(f"mean {mean:.3g}", (0.02, mean), xycoords=("axes fraction", "data"), fontsize=8, va="bottom")
    axes.set(xlim=(0.0, 0.8 * reach), ylabel="contact pressure in kPa", xlabel="radius in mm")
    limit = 1.25 * max(contact["peak_kPa"], mean)
    axes.set_ylim(0.0, limit if limit > 0.0 else 1.0)
    if contact["edge_kPa"] > limit:
        axes.set_title(f"at the edge up to {contact['edge_kPa']:.3g} kPa", fontsize=8, loc="right")
