"""The picture: parts are stacked clear of each other; without a renderer the mould is as good."""

from __future__ import annotations

import pytest

from dummydesign.mold.files import meshes as mesh
from dummydesign.mold.files import picture as view


def test_stacked_parts_never_overlap_in_height():
    bounds = {"tray": (-18.0, -6.0), "mould": (-10.0, 11.0), "pad": (0.0, 8.0), "strike_off": (8.0, 16.0)}
    order = ["tray", "mould", "pad", "strike_off"]
    lifts = view.exploded(bounds, order, 20.0)
    assert lifts["tray"] == 0.0
    for lower, upper in zip(order, order[1:]):  # noqa: RUF007
        assert bounds[upper][0] + lifts[upper] - bounds[lower][1] - lifts[lower] == pytest.approx(20.0)


@pytest.mark.slow
def test_picture_shows_every_material(open_parts, tmp_path):
    import subprocess
    import sys

    import numpy as np

    from dummydesign.mold.files.step import COLOURS

    meshes = {name: mesh.tessellate(open_parts.solid(name)) for name in ("mould", "pad", "master")}
    colours = {name: COLOURS[open_parts.parts[name].material] for name in meshes}
    view.pack(meshes, colours, "test", tmp_path / "m.npz")
    command = [sys.executable, "-m", "dummydesign.mold.files.picture", str(tmp_path / "m.npz"), str(tmp_path / "m.png")]
    subprocess.run(command, capture_output=True, timeout=120)
    if not (tmp_path / "m.png").is_file():
        pytest.skip("this machine cannot render")
    from PIL import Image

    pixels = np.asarray(Image.open(tmp_path / "m.png").convert("RGB")).astype(float)
    for colour in colours.values():
        # A lit face has the part's hue: the direction of its colour, whatever its brightness.
        way = np.array(colour) / np.linalg.norm(colour)
        alike = (pixels @ way) / np.maximum(np.linalg.norm(pixels, axis=2), 1.0) > 0.995
        assert np.count_nonzero(alike & (pixels.max(axis=2) < 250)) > 2000


def test_mould_without_a_picture_is_complete_and_says_so(open_spec, tmp_path):
    import subprocess
    import sys

    from dummydesign.mold.produce import finish_picture

    (tmp_path / ".picture.npz").write_bytes(b"")
    dead = subprocess.Popen([sys.executable, "-c", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"])
    warnings: list[dict[str, str]] = []
    assert finish_picture(dead, tmp_path, open_spec, warnings) == {}
    assert warnings[0]["code"] == "no_picture" and not (tmp_path / ".picture.npz").exists()


def test_a_check_that_breaks_off_leaves_no_renderer_running(open_spec, tmp_path, monkeypatch):
    import subprocess
    import sys
    from types import SimpleNamespace

    from dummydesign.mold import produce

    renderer = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])

    def broken(*_: object) -> None:
        raise RuntimeError("a check broke off")

    monkeypatch.setattr(produce, "build", lambda *_: SimpleNamespace(spec=open_spec, parts={}))
    monkeypatch.setattr(produce, "_start_picture", lambda *_: renderer)
    monkeypatch.setattr(produce, "_write_steps", broken)
    with pytest.raises(RuntimeError, match="broke off"):
        produce.produce(open_spec, tmp_path)
    assert renderer.returncode is not None
