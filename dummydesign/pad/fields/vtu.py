"""Fields as VTK files that ParaView opens: one ``.vtu`` a depth and a ``.pvd`` that holds them together."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.pad.fields.pressed import Pressed

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
    made.point_data["displacement_mm"] = _three(pressed.displacement_mm)
    made.point_data["cauchy_MPa"] = np.stack([rr, zz, tt, rz, nothing, nothing], axis=1)
    made.point_data["principal_MPa"] = pressed.principal_MPa
    made.point_data["pressure_MPa"] = pressed.pressure_MPa
    made.point_data["von_mises_MPa"] = pressed.von_mises_MPa
    made.point_data["stretch"] = pressed.stretch
    on_face = {name: nothing.copy() for name in ("contact_pressure_MPa", "contact_shear_MPa", "contact_state")}
    for name, values in zip(on_face, (pressed.face.pressure_MPa, pressed.face.shear_MPa, pressed.face.state)):
        on_face[name][pressed.face.node] = values
        made.point_data[name] = on_face[name]
    made.field_data["depth_mm"] = [pressed.depth_mm]
    made.field_data["force_N"] = [pressed.force_N]
    return made


def write_fields(fields: Sequence[Pressed], path: str | Path) -> list[Path]:
    """Write the fields of several depths.

    Parameters
    ----------
    fields : sequence of Pressed
        One for each depth.
    path : path
        ``NAME.vtu``. One depth is written there, several to ``NAME-1.vtu``, ``NAME-2.vtu`` ...; ``NAME.pvd`` lists
        them with the depth in the place of the time.

    Returns
    -------
    list of Path
        The ``.pvd`` and then the ``.vtu`` files.

    Raises
    ------
    InputError
        When the name does not end with .vtu, or the place cannot be written or is full; nothing is left then.
    """
    final = Path(path)
    if final.suffix != ".vtu":
        raise InputError(f"fields file '{path}' must end with .vtu")
    one = len(fields) == 1
    names = [final] if one else [final.with_name(f"{final.stem}-{k}.vtu") for k in range(1, len(fields) + 1)]
    try:
        with tempfile.TemporaryDirectory(dir=final.parent, prefix=".fields-") as folder:
            parts = [Path(folder) / name.name for name in names]
            for pressed, part in zip(fields, parts):
                grid(pressed).save(part)
                if not part.exists() or part.stat().st_size == 0:
                    raise InputError(f"fields file '{path}' cannot be written: is there room on the disk?")
            for part, name in zip(parts, names):
                os.replace(part, name)
    except OSError as problem:
        raise InputError(f"fields file '{path}' cannot be written: {problem.strerror or problem}") from None
    rows = "".join(
        f'    <DataSet timestep="{pressed.depth_mm:.9g}" file="{name.name}"/>\n' for pressed, name in zip(fields, names)
    )
    text = f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n{rows}  </Collection>\n'
    return [write_text(final.with_suffix(".pvd"), text + "</VTKFile>\n"), *names]


def _three(plane: np.ndarray) -> np.ndarray:
    return np.column_stack([plane, np.zeros(len(plane))])
