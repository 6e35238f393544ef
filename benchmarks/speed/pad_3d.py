"""Time, memory and solver of pads in space.

    python -m benchmarks.speed.pad_3d [CORNER]

First the whole ``predict --fidelity 3d`` curve of 8 points to d / h = 0.5 as a process of its own. Then the linear
solve of one tangent (corner cell CORNER, default 0.14, of a 10 mm pad): nested dissection with dense fronts, the same
elimination order given to SuperLU, and SuperLU with its own ordering. Processor time is what to compare on a machine
that does other work.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.pad.spatial.square_punch import CornerCells, SquareProblem, block_problem

THICKNESSES_MM = (5.0, 10.0, 20.0)


def clock(work: Callable[[], Any]) -> tuple[float, Any]:
    """Processor seconds of a call, and its answer."""
    began = time.process_time()
    answer = work()
    return time.process_time() - began, answer


@one_blas_thread()
def solvers(corner: float) -> None:
    """Compare linear solvers on the tangent at first touch."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import splu

    block, cells = SquareProblem((0.7, 0.7), (7.5, 6.0)), CornerCells(corner)
    problem = block_problem(block, cells)
    solid, free = problem.solid, problem.pattern.free
    state = solid.state(*problem.start())
    assert state is not None
    spent, tangent = clock(lambda: solid.linearise(state))
    print(f"{len(free)} unknowns, {len(solid.mesh.dofs)} cells; residual and tangent {spent:.2f} s")
    load = np.random.default_rng(1).standard_normal(solid.mesh.size)
    spent, dense = clock(lambda: problem.pattern.solve([tangent.stiffness], load))
    print(f"nested dissection, dense fronts   {spent:8.2f} s")
    dofs = solid.mesh.dofs
    row, column = np.repeat(dofs, 81, axis=1).ravel(), np.tile(dofs, (1, 81)).ravel()
    whole = coo_matrix((tangent.stiffness.ravel(), (row, column)), shape=(solid.mesh.size,) * 2).tocsc()
    matrix = whole[free][:, free]
    order = problem.pattern.order
    choices = {
        "nested dissection, SuperLU": (matrix[order][:, order], "NATURAL"),
        "SuperLU, minimum degree": (matrix, "MMD_AT_PLUS_A"),
        "SuperLU, COLAMD": (matrix, "COLAMD"),
    }
    for name, (permuted, ordering) in choices.items():
        options = {"permc_spec": ordering, "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
        spent, factor = clock(lambda: splu(permuted.tocsc(), **options))  # noqa: B023
        print(f"{name:<33} {spent:8.2f} s, {factor.nnz / 1e6:.1f} million entries")
    answer = np.empty(len(free))
    permuted = choices["nested dissection, SuperLU"][0].tocsc()
    answer[order] = splu(permuted, permc_spec="NATURAL").solve(load[free][order])
    print(f"largest difference of the answers {np.abs(answer - dense[free]).max() / np.abs(answer).max():.1e}")


def curves() -> None:
    """Time whole curves as processes of their own."""
    print(f"{'pad':<8} {'wall s':>8} {'processor s':>12} {'memory MB so far':>17}")
    for thickness in THICKNESSES_MM:
        depths = ",".join(f"{x:.6g}" for x in thickness * 0.5 * np.arange(1, 9) / 8)
        command = ["-m", "dummydesign", "predict", "--young", "25", "--thickness", f"{thickness:g}"]
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        ended = subprocess.run([sys.executable, *command, "--depth", depths, "--fidelity", "3d"], capture_output=True)
        wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        memory = after.ru_maxrss / (1024.0 if sys.platform != "darwin" else 1024.0**2)
        failed = "" if ended.returncode == 0 else f"  failed: {ended.stderr.decode().strip()}"
        print(f"{thickness:<5g} mm {wall:>8.1f} {spent:>12.1f} {memory:>17.0f}{failed}")


if __name__ == "__main__":
    os.environ["DUMMYDESIGN_CACHE"] = "off"
    # First, as a process counts what memory its parent had when it was started.
    curves()
    solvers(float(sys.argv[1]) if len(sys.argv) > 1 else 0.14)
