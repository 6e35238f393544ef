"""Fields of a pressed pad as ParaView files and as a picture."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import unwritable, write_bytes, write_text
from dummydesign.pad.fields import Array, Pressed

SUFFIXES = (".png", ".svg", ".pdf")
# Colours end at this percentile of the stress under the punch: at the punch's edge it has no bound.
TOP = 97.0


def write_picture(fields: Sequence[Pressed], path: str | Path, title: str = "") -> Path:
    """Draw one row for each depth (at most four, evenly chosen): cross-section, and pressure over the radius."""
    final = Path(path)
    if final.suffix not in SUFFIXES:
        message = f"picture '{path}' must end with {', '.join(SUFFIXES)}"
        raise InputError(message, "bad_name", "picture", str(path), SUFFIXES)
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
    points = pressed.rest_mm + pressed.displacement_mm
    stress = 1e3 * pressed.von_mises_MPa
    near = (pressed.rest_mm[pressed.cells, 0] < 1.3 * reach).any(axis=1)
    triangles = _triangles(pressed.cells[near])
    for side in (1.0, -1.0):
        shown = axes.tripcolor(
            side * points[:, 0],
            points[:, 1],
            triangles,
            stress,
            shading="gouraud",
            cmap="viridis",
            vmin=0.0,
            vmax=ceiling,
            rasterized=True,
        )
        axes.plot(side * points[pressed.face.node, 0], points[pressed.face.node, 1], color="0.1", linewidth=0.8)
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


BIQUADRATIC_QUAD = 28


def grid(pressed: Pressed) -> Any:
    """The fields of one depth as a ``pyvista.UnstructuredGrid``.

    Points are where the nodes were before, x = r and y = z in mm; warp by ``displacement_mm`` to see the pressed pad.
    Point data: ``displacement_mm``, ``cauchy_MPa`` (xx = rr, yy = zz, zz = hoop, xy = rz), ``principal_MPa``,
    ``pressure_MPa``, ``von_mises_MPa``, ``stretch``, and on the tested face ``contact_pressure_MPa``,
    ``contact_shear_MPa`` and ``contact_state`` (0 free, 1 sticks, 2 slips).
    """
    import pyvista

    count = len(pressed.rest_mm)
    cells = np.column_stack([np.full(len(pressed.cells), 9), pressed.cells]).ravel()
    made = pyvista.UnstructuredGrid(cells, np.full(len(pressed.cells), BIQUADRATIC_QUAD), _three(pressed.rest_mm))
    rr, zz, tt, rz = pressed.cauchy_MPa.T
    nothing = np.zeros(count)
    face = pressed.face

    def on_face(values: Array) -> Array:
        all_points = np.zeros(count)
        all_points[face.node] = values
        return all_points

    made.point_data.update(
        {
            "displacement_mm": _three(pressed.displacement_mm),
            "cauchy_MPa": np.stack([rr, zz, tt, rz, nothing, nothing], axis=1),
            "principal_MPa": pressed.principal_MPa,
            "pressure_MPa": pressed.pressure_MPa,
            "von_mises_MPa": pressed.von_mises_MPa,
            "stretch": pressed.stretch,
            "contact_pressure_MPa": on_face(face.pressure_MPa),
            "contact_shear_MPa": on_face(face.shear_MPa),
            "contact_state": on_face(face.state),
        }
    )
    made.field_data.update({"depth_mm": np.array([pressed.depth_mm]), "force_N": np.array([pressed.force_N])})
    return made


def write_fields(fields: Sequence[Pressed], path: str | Path) -> list[Path]:
    """Write the fields of several depths."""
    final = Path(path)
    if final.suffix != ".vtu":
        raise InputError(f"fields file '{path}' must end with .vtu", "bad_name", "fields", str(path), ".vtu")
    one = len(fields) == 1
    names = [final] if one else [final.with_name(f"{final.stem}-{k}.vtu") for k in range(1, len(fields) + 1)]
    try:
        with tempfile.TemporaryDirectory(dir=final.parent, prefix=".fields-") as folder:
            parts = [Path(folder) / name.name for name in names]
            for pressed, part in zip(fields, parts):
                grid(pressed).save(part)
                if not part.exists() or part.stat().st_size == 0:
                    message = f"fields file '{path}' cannot be written: is there room on the disk?"
                    raise InputError(message, "file_unwritable", "fields", str(path))
            for part, name in zip(parts, names):
                os.replace(part, name)
    except OSError as problem:
        raise unwritable("fields file", path, problem, "fields") from None
    rows = "".join(
        f'    <DataSet timestep="{pressed.depth_mm:.9g}" file="{name.name}"/>\n' for pressed, name in zip(fields, names)
    )
    text = f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n{rows}  </Collection>\n'
    return [write_text(final.with_suffix(".pvd"), text + "</VTKFile>\n"), *names]


def _three(plane: np.ndarray) -> np.ndarray:
    return np.column_stack([plane, np.zeros(len(plane))])
