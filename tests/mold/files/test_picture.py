"""The picture: parts are stacked clear of each other; without a renderer the mould is as good."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import product
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.mold.cad.parts import COLOURS
from dummydesign.mold.files import picture as view
from dummydesign.mold.files.pour_sheet import Foot


def test_stacked_parts_never_overlap_in_height():
    bounds = {"tray": (-18.0, -6.0), "mould": (-10.0, 11.0), "pad": (0.0, 8.0), "strike_off": (8.0, 16.0)}
    order = ["tray", "mould", "pad", "strike_off"]
    lifts = view.exploded(bounds, order, 20.0)
    assert lifts["tray"] == 0.0
    for lower, upper in zip(order, order[1:]):  # noqa: RUF007
        assert bounds[upper][0] + lifts[upper] - bounds[lower][1] - lifts[lower] == pytest.approx(20.0)


def box(low, high):
    """Corners and outward triangles of a box."""
    corners = np.array(list(product(*zip(low, high))), float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([tri for a, b, c, d in quads for tri in ((a, b, c), (a, c, d))])


DOWN = (np.array((0.0, 0.0, 1.0)), np.array((1.0, 0.0, 0.0)), np.array((0.0, 1.0, 0.0)))
"""A view from above: towards the viewer, to the right, up."""


def rendered(parts, tmp_path, scale=10.0, light=((0, 0, 1), 1.0)):
    from PIL import Image

    scene = view.Scene(parts, [], "", (200, 200), DOWN, np.zeros(3), scale)
    view.render(scene, tmp_path / "p.png", [light])
    return np.asarray(Image.open(tmp_path / "p.png").convert("RGB")).astype(int)


def test_a_box_from_above_is_its_area_in_its_colour_at_its_place(tmp_path):
    pixels = rendered([(*box((-6, -3, 0), (2, 5, 1)), (1.0, 0.0, 0.0))], tmp_path)
    # 10 pixels a mm; from column 40 to 120, from row 50 to 130, with an edge drawn round it
    red = (pixels[:, :, 0] > 200) & (pixels[:, :, 1] < 60)
    rows, columns = np.nonzero(red)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == pytest.approx((50, 129, 40, 119), abs=1)
    assert red.sum() == pytest.approx(80 * 80, rel=0.05)


def test_the_nearest_part_is_seen_whatever_the_order(tmp_path):
    high, low = (*box((-2, -2, 5), (2, 2, 6)), (0.0, 1.0, 0.0)), (*box((-6, -6, 0), (6, 6, 1)), (1.0, 0.0, 0.0))
    pictures = [rendered(parts, tmp_path) for parts in ([high, low], [low, high])]
    for pixels in pictures:
        assert tuple(pixels[100, 100]) == (0, 255, 0) and tuple(pixels[100, 50]) == (255, 0, 0)


@pytest.mark.slow
def test_picture_shows_every_material_without_a_display(tmp_path):
    parts = {"tray": ((-30, -30, -8), (30, 30, -4)), "mould": ((-25, -25, 0), (25, 25, 8)),
             "pad": ((-20, -20, 9), (20, 20, 12)), "master": ((-25, -25, 0), (25, 25, 4))}  # fmt: skip
    materials = {"tray": "rigid", "mould": "silicone", "pad": "resin", "master": "rigid"}
    colours = {name: COLOURS[material] for name, material in materials.items()}
    meshes = {
        name: SimpleNamespace(vertices=found[0], faces=found[1])
        for name, found in ((name, box(*ends)) for name, ends in parts.items())
    }
    view.pack(meshes, colours, "test", tmp_path / "m.pickle")
    command = [
        sys.executable,
        "-m",
        "dummydesign.mold.files.picture",
        str(tmp_path / "m.pickle"),
        str(tmp_path / "m.png"),
    ]
    bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    subprocess.run(command, check=True, timeout=120, env={**bare, "PYTHONPATH": str(Path(__file__).parents[3])})
    from PIL import Image

    pixels = np.asarray(Image.open(tmp_path / "m.png").convert("RGB")).astype(float)
    assert pixels.shape[1] == view.WIDTH
    for colour in colours.values():
        # A lit face has the part's hue: the direction of its colour, whatever its brightness.
        way = np.array(colour) / np.linalg.norm(colour)
        alike = (pixels @ way) / np.maximum(np.linalg.norm(pixels, axis=2), 1.0) > 0.995
        assert np.count_nonzero(alike & (pixels.max(axis=2) < 250)) > 2000


def test_mould_without_a_picture_is_complete_and_says_so(open_spec, tmp_path):
    from dummydesign.mold.build_files import finish_picture

    (tmp_path / ".picture.pickle").write_bytes(b"")
    dead = subprocess.Popen([sys.executable, "-c", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"])
    warnings: list[dict[str, str]] = []
    assert finish_picture(dead, tmp_path, open_spec, warnings) == {}
    assert warnings[0]["code"] == "no_picture" and not (tmp_path / ".picture.pickle").exists()


def test_a_check_that_breaks_off_leaves_no_renderer_running(open_spec, tmp_path, monkeypatch):
    import subprocess
    import sys
    from types import SimpleNamespace

    from dummydesign.mold import build_files

    renderer = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])

    def broken(*_: object) -> None:
        raise RuntimeError("a check broke off")

    monkeypatch.setattr(build_files, "build", lambda *_: SimpleNamespace(spec=open_spec, parts={}))
    monkeypatch.setattr(build_files, "_start_picture", lambda *_: renderer)
    monkeypatch.setattr(build_files, "_write_and_check", broken)
    with pytest.raises(RuntimeError, match="broke off"):
        build_files.produce(open_spec, tmp_path, Foot("ABCD"))
    assert renderer.returncode is not None
