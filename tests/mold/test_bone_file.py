"""A bone from a file: placed as asked, measured truly, cast, told from the dome that stands for it, or refused."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.geometry.conic import Conic
from dummydesign.mold.cad.bone import nearest_dome, undersides
from dummydesign.mold.client import insert_bone
from dummydesign.mold.model.layout import bone_volume_mm3
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import Insert, MouldSpec, Placing
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.mould_checks import no_check_fails

BALL = Insert("ball.stl", "0" * 64, Placing(6.0), 2000.0, 600.0, -14.0, 14.0, -14.0, 14.0, 0.02)


@pytest.fixture
def ball(tmp_path):
    import trimesh

    trimesh.creation.icosphere(subdivisions=3, radius=2.0).export(tmp_path / "ball.stl")
    return tmp_path / "ball.stl"


@pytest.mark.parametrize("radius, height, foot", [(20.0, 6.0, math.sqrt(204.0)), (12.0, 4.0, 11.0), (15.0, 3.0, 8.0)])
def test_the_nearest_dome_of_a_dome_is_itself(radius, height, foot):
    r = np.linspace(0.0, 20.0, 400)
    heights = height - Conic(radius, height, foot).sag_mm(r)
    tip, wide, off = nearest_dome(heights, r, height, 25.0)
    assert off < 0.01 * height and tip == pytest.approx(radius, rel=0.1) and wide == pytest.approx(foot, rel=0.02)


def test_a_bone_that_is_no_dome_is_some_way_off_the_nearest():
    x, y = np.meshgrid(np.linspace(-15, 15, 41), np.linspace(-15, 15, 41))
    bar = np.maximum(0.0, 5.0 - y**2 / 12.0).ravel()
    assert nearest_dome(bar, np.hypot(x, y).ravel(), 5.0, 20.0)[2] > 0.5


def test_the_underside_of_a_tilted_triangle_is_its_plane():
    triangle = np.array([[[0.0, 0.0, 1.0], [4.0, 0.0, 3.0], [0.0, 4.0, 1.0]], [[0, 0, 9.0], [4, 0, 9.0], [0, 4, 9.0]]])
    found = undersides(triangle, np.array([[1.0, 1.0], [2.0, 0.5], [3.5, 3.5]]))
    assert found[:2] == pytest.approx([1.5, 2.0]) and np.isnan(found[2])


@pytest.mark.slow
def test_a_ball_is_scaled_placed_cut_and_measured_as_a_spherical_cap(ball, tmp_path):
    placing = Placing(6.0, 10.0, (90.0, 180.0, 90.0), 2.0, -1.0)
    insert, dome = insert_bone(ball, placing, 15.0, 70.0, 60.0, tmp_path / "bone.brep")
    cap = math.pi * 36.0 * (60.0 - 6.0) / 3
    assert insert.volume_mm3 == pytest.approx(cap, rel=0.03)
    assert insert.seat_mm2 == pytest.approx(math.pi * 204, rel=0.03)
    assert (insert.x_low_mm + insert.x_high_mm) / 2 == pytest.approx(2.0, abs=0.05) and not insert.overhang
    assert (insert.y_low_mm + insert.y_high_mm) / 2 == pytest.approx(-1.0, abs=0.05)
    named = dict(dome)
    assert named["height"] == 6.0 and named["radius"] == pytest.approx(20.0, rel=0.15) and insert.off_dome_mm < 0.3


@pytest.mark.slow
def test_past_its_middle_a_ball_overhangs_and_one_that_does_not_reach_the_plate_is_refused(ball, tmp_path):
    solid = tmp_path / "bone.brep"
    assert insert_bone(ball, Placing(8.0, 2.5), 15.0, 60.0, 50.0, solid)[0].overhang
    with pytest.raises(InputError, match=r"10\.00 mm high as scaled.*bone height must be below"):
        insert_bone(ball, Placing(11.0, 2.5), 15.0, 60.0, 50.0, solid)


def test_a_bone_that_sticks_out_or_hardly_meets_its_plate_is_refused_with_the_room_there_is():
    for change, said in (
        ({"x_high_mm": 27.0}, "along the length it lies from -14.0 to 27.0"),
        ({"y_low_mm": -18.0}, "along the width.*allowed is -17 to 17"),
        ({"seat_mm2": 3.0}, "meets its plate with 3.0 mm2"),
    ):
        with pytest.raises(InputError, match=said):
            Insert(**{**BALL.__dict__, **change}).check(60.0, 50.0)
    BALL.check(60.0, 50.0)


def test_the_resin_is_the_pads_less_the_bone_as_measured_and_the_answer_tells_the_dome():
    dome = (("radius", 20.0), ("height", 6.0), ("foot", 14.28))
    plain = mould_spec(15.0, 60.0, 50.0, kind="boned", parameters=dome)
    boned = mould_spec(15.0, 60.0, 50.0, kind="boned", parameters=dome, insert=BALL)
    assert bone_volume_mm3(boned) == 2000.0 and "insert" not in plain.to_dict()
    rho = boned.pour.density_g_per_cm3 * 1e-3
    away = rho * (bone_volume_mm3(plain) - 2000.0)
    assert pour_plan(boned).pad_mass_g - pour_plan(plain).pad_mass_g == pytest.approx(away, rel=1e-2)
    codes = {item["code"]: item["message"] for item in pour_warnings(boned, pour_plan(boned))}
    assert "nearest dome" in codes["bone_from_file"] and "ball.stl" in codes["bone_from_file"]
    assert MouldSpec.from_dict(json.loads(boned.canonical())) == boned and boned.hash != plain.hash


@pytest.mark.parametrize(
    "words, said",
    [
        (["--bone", "no.stl", "--bone-height", "5"], "cannot be read"),
        (["--bone", "ball.stl"], "bone_height_mm is missing"),
        (["--bone", "ball.obj", "--bone-height", "5"], ".stl, .step, .stp"),
        (["--bone-height", "5"], "belongs to a bone"),
        (["--bone", "ball.stl", "--bone-height", "14"], "bone height = 14"),
        (["--bone", "ball.stl", "--bone-height", "5", "--bone-turn", "1,2"], "3 comma-separated numbers"),
        (["--bone", "ball.stl", "--bone-height", "5", "--bone-scale", "0"], "bone scale = 0"),
        (["--bone", "ball.stl", "--bone-height", "5", "--shape", "crowned:20,2"], "takes no bone"),
        (["--bone", "ball.stl", "--bone-height", "5", "--count", "2"], "one mould"),
    ],
)
def test_what_makes_no_bone_is_one_line_before_cad(words, said, ball, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.obj").write_text("")
    before = sorted(path.name for path in tmp_path.iterdir())
    monkeypatch.setattr("dummydesign.mold.client._measured", lambda asked: pytest.fail("CAD was asked"))
    assert cli.run(["mold", "--thickness", "15", "--length", "60", "--width", "50", *words]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ") and message.count("\n") == 1 and said in message
    assert sorted(path.name for path in tmp_path.iterdir()) == before


@pytest.mark.slow
@pytest.mark.parametrize("content, said", [(b"solid nothing\nendsolid\n", "no triangles"), (None, "not closed")])
def test_a_file_without_a_closed_solid_is_refused(content, said, ball, tmp_path):
    import trimesh

    if content is None:
        open_ball = trimesh.creation.icosphere(subdivisions=2, radius=20.0)
        open_ball.update_faces(np.arange(len(open_ball.faces)) > 3)
        content = open_ball.export(file_type="stl")
    (tmp_path / "bad.stl").write_bytes(content)
    with pytest.raises(InputError, match=said):
        insert_bone(tmp_path / "bad.stl", Placing(5.0), 15.0, 60.0, 50.0, tmp_path / "bone.brep")


@pytest.mark.slow
def test_the_command_casts_a_phalanx_with_all_files(tmp_path, capsys):
    import cadquery as cq

    phalanx = cq.Workplane("YZ").circle(7.0).extrude(24.0, both=False).edges().fillet(3.0)
    cq.exporters.export(phalanx, str(tmp_path / "phalanx.step"))
    words = ["--bone", str(tmp_path / "phalanx.step"), "--bone-height", "5", "--out", str(tmp_path / "made"), "--json"]
    assert cli.run(["mold", "--thickness", "12", "--length", "60", "--width", "50", *words]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert no_check_fails(answer["checks"]) and all(Path(path).is_file() for path in answer["files"].values())
    assert {"bone_volume", "gel_and_bone", "bone_cover"} <= {item["id"] for item in answer["checks"]}
    assert answer["inputs"]["bone"] == "phalanx.step" and answer["inputs"]["shape"].startswith("boned:")
    assert "bone_from_file" in {item["code"] for item in answer["warnings"]}
