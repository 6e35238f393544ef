"""Triangles of a bone's file: mended where there is one answer, refused by name where there is none."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from dummydesign.core.errors import InputError
from dummydesign.mold.cad.bone_mesh import _volume, crossing, read_triangles, simplified

BALL = trimesh.creation.icosphere(subdivisions=3, radius=6.0)
POINTS, FACES = np.array(BALL.vertices), np.array(BALL.faces)


def written(tmp_path, points, faces):
    path = tmp_path / "bone.stl"
    path.write_bytes(trimesh.Trimesh(points, faces, process=False).export(file_type="stl"))
    return path


def flat_added(points, faces):
    """One triangle is split at the middle of a side, and the slit closed by one whose corners lie on a line."""
    a, b, c = faces[0]
    points = np.vstack([points, (points[a] + points[b]) / 2])
    m = len(points) - 1
    return points, np.vstack([faces[1:], [[a, m, c], [m, b, c], [a, b, m]]])


def doubled_corners(points, faces):
    return points, np.vstack([faces, [[5, 5, 9], [7, 8, 8]]])


def mixed(points, faces):
    faces = faces.copy()
    faces[::3] = faces[::3, ::-1]
    return points, faces


def inside_out(points, faces):
    return points, faces[:, ::-1]


def twice(points, faces):
    return points, np.vstack([faces, faces[:4]])


@pytest.mark.parametrize(
    "damage, words",
    [
        (flat_added, "1 degenerate"),
        (doubled_corners, "2 degenerate"),
        (mixed, "427 triangles turned"),
        (inside_out, ""),
        (twice, "4 degenerate"),
    ],
)
def test_a_fault_with_one_remedy_is_mended_and_said(damage, words, tmp_path):
    points, faces, mended = read_triangles(written(tmp_path, *damage(POINTS, FACES)))
    assert mended.startswith(words) and bool(mended) == bool(words)
    assert _volume(points, faces) == pytest.approx(BALL.volume, rel=1e-6)
    kept = trimesh.Trimesh(points, faces, process=False)
    assert kept.is_watertight and kept.is_winding_consistent and kept.area_faces.min() > 1e-6


def test_metres_are_mended_like_millimetres(tmp_path):
    points, faces, _ = read_triangles(written(tmp_path, POINTS / 1000.0, FACES))
    assert _volume(points, faces) == pytest.approx(1e-9 * BALL.volume, rel=1e-4)


@pytest.mark.parametrize(
    "damage, reason",
    [
        (lambda p, f: (p, f[3:]), "not closed: .* edges have one triangle only, one near"),
        (lambda p, f: (np.vstack([p, p + (20.0, 0, 0)]), np.vstack([f, f + len(p)])), "holds 2 bodies"),
        (lambda p, f: (np.vstack([p, [[0, 0, 20.0]]]), np.vstack([f, [[f[0, 0], f[0, 1], len(p)]]])), "more than two"),
    ],
)
def test_a_fault_without_one_remedy_is_refused_by_name(damage, reason, tmp_path):
    with pytest.raises(InputError, match=reason) as refused:
        read_triangles(written(tmp_path, *damage(POINTS, FACES)))
    assert refused.value.code == "malformed" and "\n" not in str(refused.value)


def test_a_surface_that_crosses_itself_is_seen_where_it_does():
    assert crossing(POINTS, FACES) is None
    dented = POINTS.copy()
    dented[dented[:, 2].argmax(), 2] = -9.0
    at = crossing(dented, FACES)
    assert at is not None and at[2] < -5.0
    with pytest.raises(InputError, match="crosses itself near"):
        simplified(dented, FACES, "dented.stl")


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_crossings_are_those_of_every_pair(seed):
    """Against all pairs of segments and triangles by barycentric coordinates."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(30, 3))
    for scale, expected in ((1.0, True), (0.02, False)):
        corners = points[:10, None] * (1 if scale == 1 else 40) + scale * rng.normal(size=(10, 3, 3))
        flat, faces = corners.reshape(-1, 3), np.arange(30).reshape(-1, 3)
        assert (
            (crossing(flat, faces) is not None)
            == expected
            == any(
                pierces(corners[i, k], corners[i, (k + 1) % 3], corners[j])
                for i in range(10)
                for j in range(10)
                if i != j
                for k in range(3)
            )
        )


def pierces(foot, tip, triangle):
    try:
        x = np.linalg.solve(
            np.column_stack([triangle[1] - triangle[0], triangle[2] - triangle[0], foot - tip]), foot - triangle[0]
        )
    except np.linalg.LinAlgError:
        return False
    return x[0] > 0 and x[1] > 0 and x[0] + x[1] < 1 and 0 < x[2] < 1


def test_a_scan_is_simplified_with_its_error():
    pytest.importorskip("pyvista")
    fine = trimesh.creation.icosphere(subdivisions=5, radius=6.0)
    points, faces, most, rms = simplified(np.array(fine.vertices), np.array(fine.faces), "scan.stl")
    assert len(faces) <= 1500 and 0 < rms < most < 0.05
    assert np.abs(np.linalg.norm(points, axis=1) - 6.0).max() < 0.05
