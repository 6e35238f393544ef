"""Tables over thickness, ratio and punch: depth, stiffness, local exponent, peak over steady, score."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.curves import COARSE, ForceLaw, Slabs, make_curves, press_to_depth, steady_depth
from dummydesign.design.search import THICKNESS_MM, make_slabs
from dummydesign.errors import InputError, out_of_range, unknown_name

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from dummydesign.design.targets import Targets
    from dummydesign.resin.model import Resin

MOST_DESIGNS = 1_000_000
CHUNK = 4096
FIDELITIES = ("table", "axisymmetric")
PEAK_FORCE_N = 10.0
"""Steady force at which peak over steady is given, that of the paper's force-time figures. [N]"""


@dataclass(frozen=True)
class Study:
    """What is varied. All combinations are worked out, thickness slowest.

    Attributes
    ----------
    thickness_mm, ratio : tuple of float
        Designs. [mm, resin's ratio]
    punches : tuple of (name, radius in mm)
        Punches by the radius of the circle of their area.
    velocities_mm_s, forces_N : tuple of float
        Speeds for peak over steady, and relaxed forces for depth, stiffness and exponent.
    resin : str
    tissue : str or None
        Score for this tissue when given (with its aim).
    fidelity : str
        ``table`` or ``axisymmetric`` (one finite-element solve a thickness and punch).
    """

    thickness_mm: tuple[float, ...]
    ratio: tuple[float, ...]
    punches: tuple[tuple[str, float], ...]
    velocities_mm_s: tuple[float, ...] = (10.0, 250.0)
    forces_N: tuple[float, ...] = (1.0, 5.0, 10.0, 15.0)
    resin: str = "polyurethane-nagoya"
    tissue: str | None = None
    aim: str = "average"
    fidelity: str = "table"

    @property
    def size(self) -> int:
        """Number of designs."""
        return len(self.thickness_mm) * len(self.ratio) * len(self.punches)

    def check(self, resin: Resin) -> None:
        """Refuse what is not allowed before any work (InputError)."""
        if self.fidelity not in FIDELITIES:
            raise unknown_name("fidelity", self.fidelity, FIDELITIES)
        if self.size > MOST_DESIGNS:
            raise InputError(f"number of designs = {self.size} is above {MOST_DESIGNS}; use wider steps")
        for value in self.thickness_mm:
            if not THICKNESS_MM[0] <= value <= THICKNESS_MM[1]:
                raise out_of_range("thickness in mm", value, *THICKNESS_MM, "slabs that can be cast")
        resin.check_ratio(self.ratio)
        for name, values in (("force in N", self.forces_N), ("velocity in mm/s", self.velocities_mm_s)):
            for value in values:
                if not value > 0:
                    raise out_of_range(name, value, "above 0", "any finite value")

    def to_dict(self) -> dict[str, Any]:
        """Return what is varied as plain values."""
        return asdict(self)


def whatif(study: Study, law: ForceLaw | None = None, executor: Executor | None = None) -> dict[str, Any]:
    """Work out every design of a study.

    Parameters
    ----------
    study : Study
        What is varied.
    law : ForceLaw, optional
        Elastic force of slabs; by default what the study's fidelity names.
    executor : concurrent.futures.Executor, optional
        Runs finite-element solves side by side.

    Returns
    -------
    dict
        ``rows`` (see :func:`rows_of`) and ``seconds`` of work.

    Raises
    ------
    InputError
        For names, ranges or a number of designs that are not allowed.
    """
    start = time.perf_counter()
    rows = list(rows_of(study, law, executor))
    return {"rows": rows, "seconds": time.perf_counter() - start}


def rows_of(study: Study, law: ForceLaw | None = None, executor: Executor | None = None) -> Iterator[dict[str, Any]]:
    """Yield the rows of a study: one design each.

    A row has ``thickness_mm``, ``ratio``, ``punch``, ``young_kPa``, then by force ``depth_mm_at_N``,
    ``depth_over_thickness_at_N``, ``stiffness_N_per_mm_at_N``, ``exponent_at_N`` (d ln F / d ln x), all of
    the relaxed pad, ``peak_over_steady`` by speed at 10 N steady, ``limit`` (None, or why values are
    missing) and ``score`` when a tissue is given. What is out of reach is None.
    """
    from dummydesign.resin import load_resin

    resin = load_resin(study.resin)
    study.check(resin)
    targets = _targets(study)
    thickness, ratio = np.array(study.thickness_mm), np.array(study.ratio)
    for name, radius in study.punches:
        curves = make_curves(law or _law(study, radius, executor), thickness, radius)
        combinations = np.array(list(itertools.product(range(len(thickness)), range(len(ratio)))))
        for first in range(0, len(combinations), CHUNK):
            part = combinations[first : first + CHUNK]
            slabs = make_slabs(curves, part[:, 0], resin, ratio[part[:, 1]])
            yield from _chunk(study, slabs, ratio[part[:, 1]], name, targets)


def _law(study: Study, radius_mm: float, executor: Executor | None) -> ForceLaw:
    """The force law of the study's fidelity for one punch."""
    if study.fidelity == "axisymmetric":
        from dummydesign.design.solved import solve_law

        return solve_law(study.thickness_mm, radius_mm, executor)
    from dummydesign.pad.table import load_table

    return load_table(base="bonded")


def _targets(study: Study) -> Targets | None:
    if study.tissue is None:
        return None
    from dummydesign.design.curves import Sampling
    from dummydesign.design.targets import make_targets
    from dummydesign.tissue.store import load_tissue

    return make_targets(load_tissue(study.tissue), study.aim, Sampling())


def _chunk(study: Study, slabs: Slabs, ratio: NDArray, punch: str, targets: Targets | None) -> Iterator[dict[str, Any]]:
    """Work out some designs at once and yield their rows."""
    forces = np.array(study.forces_N)
    depth = slabs.curves.depth_at(slabs.slab, forces / slabs.young_MPa[:, None])
    slope = slabs.curves.slope_at(slabs.slab, depth) * slabs.young_MPa[:, None]
    with np.errstate(invalid="ignore"):
        columns = {
            "exponent_at_N": slope * depth / forces,
            "depth_mm_at_N": depth,
            "depth_over_thickness_at_N": depth / slabs.thickness_mm[:, None],
            "stiffness_N_per_mm_at_N": slope,
        }
    peaks = _peaks(slabs, study.velocities_mm_s)
    scores = _scores(slabs, targets)
    force_keys = [f"{value:g}" for value in study.forces_N]
    speed_keys = [f"{value:g}" for value in study.velocities_mm_s]
    plain = {name: _rows(values) for name, values in columns.items()}
    plain_peaks, limits = _rows(peaks), _limits(slabs, depth, study.forces_N)
    for index in range(len(ratio)):
        row = {
            "thickness_mm": float(slabs.thickness_mm[index]),
            "ratio": float(ratio[index]),
            "punch": punch,
            "young_kPa": float(1e3 * slabs.young_MPa[index]),
            **{name: dict(zip(force_keys, values[index])) for name, values in plain.items()},
            "peak_over_steady": dict(zip(speed_keys, plain_peaks[index])),
            "limit": limits[index],
        }
        if scores is not None:
            row["score"] = {name: float(values[index]) for name, values in scores.items()}
        yield row


def _peaks(slabs: Slabs, velocities: Sequence[float]) -> NDArray:
    """Peak over steady force at 10 N steady, shape (D, speeds)."""
    columns = []
    for velocity in velocities:
        depth = steady_depth(slabs, PEAK_FORCE_N, velocity)
        columns.append(press_to_depth(slabs, depth, velocity, COARSE).peak_N / PEAK_FORCE_N)
    return np.stack(columns, axis=-1)


def _scores(slabs: Slabs, targets: Targets | None) -> dict[str, NDArray] | None:
    """Scores for a tissue as in the map of the search: the parametric part is that of gamma1."""
    if targets is None:
        return None
    from dummydesign.design.parameters import gamma1_score
    from dummydesign.design.score import evaluate, steady_gamma1

    found = evaluate(slabs, targets)
    parametric = gamma1_score(steady_gamma1(slabs), targets)
    return {
        "total": found.total(parametric),
        "steady_state_range": found.steady_state_range,
        "force_variation_range": found.force_variation_range,
        "aim": found.aim,
        "parametric": parametric,
        "low_force_range": found.low_force_range,
    }


def _limits(slabs: Slabs, depth: NDArray, forces: Sequence[float]) -> list[str | None]:
    """Why a row stops early: the first force that is out of reach, and the limit it meets."""
    limits: list[str | None] = []
    edge = slabs.curves.limit_mm[slabs.slab]
    for index, row in enumerate(np.isnan(depth)):
        if not row.any():
            limits.append(None)
            continue
        share = edge[index] / slabs.thickness_mm[index]
        first = min(force for force, missing in zip(forces, row) if missing)
        limits.append(f"{first:g} N needs more than {edge[index]:.2f} mm ({share:.2f} of the thickness)")
    return limits


def _rows(values: NDArray) -> list[list[float | None]]:
    """Plain lists with None where a value is missing."""
    plain = values.tolist()
    if np.isnan(values).any():
        return [[None if value != value else value for value in row] for row in plain]
    return plain


def csv_text(rows: Sequence[dict[str, Any]]) -> str:
    """Write rows as CSV; dictionaries become one column a key, such as ``depth_mm_at_5_N``."""
    import csv
    import io

    stream = io.StringIO()
    writer = None
    for row in rows:
        flat: dict[str, Any] = {}
        for name, value in row.items():
            if isinstance(value, dict):
                flat |= {_column(name, key): item for key, item in value.items()}
            else:
                flat[name] = value
        if writer is None:
            writer = csv.DictWriter(stream, list(flat), lineterminator="\n")
            writer.writeheader()
        writer.writerow({key: f"{v:.6g}" if isinstance(v, float) else v for key, v in flat.items()})
    return stream.getvalue()


def _column(name: str, key: str) -> str:
    if name.endswith("_at_N"):
        return f"{name[:-1]}{key}_N"
    return f"{name}_at_{key}_mm_s" if name == "peak_over_steady" else f"{name}_{key}"
