"""Gauge points by name: nominal values from the shape, readings judged each, the record keeps what the law means."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.core.manifest import Question
from dummydesign.core.outputs import new_folder
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import registered
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.measurement.pad_record import read_record
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.acceptance import gauge_points
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.measurement.test_campaign import write
from tests.support.mould_checks import shape_spec
from tests.support.sheet_text import sheet_text

CROWN = mould_spec(4.5, 150.0, 120.0, kind="crowned", parameters=(("radius", 21.2), ("height", 2.0), ("foot", 9.4)))
CORNERS = [f"corner{i}" for i in range(1, 5)]
SHAPES = {
    "slab": ["middle", *CORNERS],
    "crowned:3,8,9": ["tip", "shoulder", *CORNERS],
    "crowned:3,8,9,1": ["tip", "shoulder", *CORNERS],
    "crowned:3,2,3,0,2,1,15": ["tip1", "tip2", "shoulder", *CORNERS],
    "layered:6,0.4": ["middle", *CORNERS],
    "boned:20,6": ["middle", *CORNERS],
}


def mass(spec):
    plan = pour_plan(spec)
    return plan.pad_mass_g + (plan.base.pad_mass_g if plan.base else 0.0)


def keep(folder, spec):
    with new_folder(folder, Question("mold", {"specification": spec.hash})) as output:
        points = [point.to_dict() for point in gauge_points(spec)]
        content = {"hash": spec.hash, "spec": spec.to_dict(), "gauge_points": points}
        output.path("spec.json").write_text(json.dumps(content))
    return str(output.folder)


def typed(spec, **off):
    return ",".join(f"{one.name}={one.nominal_mm + off.get(one.name, 0.0):.4f}" for one in gauge_points(spec))


def record(folder, thickness, spec, *more):
    words = ["mold", "record", folder, "--thickness", thickness, "--mass", f"{mass(spec):.2f}", *more]
    return cli.run(words)


@pytest.mark.parametrize("text", SHAPES)
def test_every_shape_has_its_points_and_each_lies_on_its_closed_form(text):
    spec = shape_spec(text, 15.0)
    pad, points = spec.pad, gauge_points(spec)
    assert [one.name for one in points] == SHAPES[text]
    for one in points:
        x, y = np.array(one.x_mm), np.array(one.y_mm)
        drop = min(float(pad.shape.drop_mm(x - a, y - b)) for a, b in pad.shape.places_mm)
        assert one.nominal_mm == pytest.approx(15.0 - drop)
        assert one.gel_mm == pytest.approx(one.nominal_mm - float(pad.shape.bone_mm(x, y)), abs=1e-9)
        assert one.high_mm - one.nominal_mm == one.nominal_mm - one.low_mm == pytest.approx(0.45)
        # The gauge stands on the face, clear of its rounded edge.
        assert abs(one.x_mm) < 30.0 - pad.edge_radius_mm and abs(one.y_mm) < 25.0 - pad.edge_radius_mm
    flat = [one.nominal_mm for one in points if not one.name.startswith(("tip", "middle"))]
    assert flat == pytest.approx([15.0 - pad.face_height_mm] * len(flat))


def test_a_puck_and_a_small_pad_are_gauged_inside_their_outline():
    puck = mould_spec(30.0, 50.0, 50.0, kind="puck")
    edges = [np.hypot(one.x_mm, one.y_mm) for one in gauge_points(puck) if one.name.startswith("edge")]
    assert len(edges) == 4 and max(edges) == pytest.approx(17.0, abs=0.01)
    small = mould_spec(5.0, 20.0, 20.0)
    assert all(abs(one.x_mm) <= 5.0 and abs(one.y_mm) <= 5.0 for one in gauge_points(small))


def test_a_shape_from_elsewhere_has_points_by_default():
    @dataclass(frozen=True)
    class Coned(PadShape):
        name = "coned"
        slope: float
        flat_top = property(lambda self: False)
        relief_mm = property(lambda self: 2.0)
        lines_mm = lambda self: (2.0 / self.slope,)  # noqa: E731

        def drop_mm(self, x_mm, y_mm):
            return np.minimum(self.slope * np.hypot(x_mm, y_mm), 2.0)

    with registered(Coned):
        found = {one.name: one.nominal_mm for one in gauge_points(shape_spec("coned:0.4", 8.0))}
    assert found == {"tip": 8.0, "shoulder": 6.0, **dict.fromkeys(CORNERS, 6.0)}


@pytest.mark.parametrize("spec", [CROWN, *(shape_spec(text, 15.0) for text in SHAPES)], ids=lambda s: s.pad.name)
def test_a_correct_casting_of_every_shape_passes_and_its_record_has_the_nominal_thickness(spec, tmp_path, capsys):
    folder = keep(tmp_path / "m", spec)
    assert record(folder, typed(spec), spec, "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["accepted"] and answer["thickness_mm"] == pytest.approx(spec.pad.thickness_mm, abs=1e-3)
    kept = read_record(answer["files"]["record"])
    assert kept.points == tuple(one.name for one in gauge_points(spec)) and len(kept.thicknesses_mm) == len(kept.points)
    assert answer["inputs"]["thicknesses_mm"].keys() == set(kept.points)


def test_a_crown_is_judged_at_each_point_and_its_thickness_is_that_of_its_tip(tmp_path, capsys):
    folder = keep(tmp_path / "m", CROWN)
    given = "tip=4.51,shoulder=2.49,corner1=2.48,corner2=2.50,corner3=2.52,corner4=2.50"
    assert record(folder, given, CROWN, "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["thickness_mm"] == pytest.approx(4.51) and answer["accepted"]
    # All points 0.2 mm too high: 4.4 % of the tip's thickness, 8 % of the corners', beyond the limit of 3 %.
    high = typed(CROWN, **dict.fromkeys(["tip", "shoulder", *CORNERS], 0.2))
    assert record(folder, high, CROWN, "--json") == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["error"]["code"] == "pad_not_accepted" and not answer["accepted"]
    assert answer["thickness_mm"] == pytest.approx(4.7) and answer["force_percent"] < -1.0
    # One corner alone is named, and that the pad is not even.
    assert record(folder, typed(CROWN, corner3=0.2), CROWN, "--json") == 1
    answer = json.loads(capsys.readouterr().out)
    missed = [one["what"] for one in answer["limits"] if one["missed"]]
    assert missed == ["thickness at corner3", "off nominal, largest less smallest"]
    assert answer["thickness_mm"] == pytest.approx(4.5)
    assert record(folder, high, CROWN) == 1
    printed = capsys.readouterr()
    assert "MISSED" in printed.out and printed.err.count("\n") == 1


@pytest.mark.parametrize(
    "given, named",
    [
        ("tip=4.5,corner1=2.5", "shoulder, corner2, corner3, corner4"),
        ("top=4.5,shoulder=2.5,corner1=2.5,corner2=2.5,corner3=2.5,corner4=2.5", "tip"),
        ("4.5,2.5,2.5,2.5,2.5", "shoulder="),
        ("4.5,2.5,2.5,2.5,2.5,2.5", "shoulder="),
        ("tip=4.5,2.5,2.5,2.5,2.5", "2.5"),
        ("tip=4.5,tip=4.5", "tip"),
        ("tip=4.5,shoulder=x", "shoulder=x"),
        ("tip=4.5,shoulder=4.5,corner1=0.2,corner2=2.5,corner3=2.5,corner4=2.5", "corner1"),
        ("tip=nan,shoulder=2.5,corner1=2.5,corner2=2.5,corner3=2.5,corner4=2.5", "tip"),
    ],
)
def test_readings_that_cannot_be_judged_are_one_line_with_the_names(given, named, tmp_path, capsys):
    folder = keep(tmp_path / "m", CROWN)
    assert record(folder, given, CROWN) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and named in error
    assert not list((tmp_path / "m").glob("record*"))


def test_a_slab_takes_a_plain_list_or_names_and_both_mean_one_thickness(tmp_path, capsys):
    spec = shape_spec("slab", 10.0)
    found = []
    named = "middle=10.1,corner1=10.2,corner2=10,corner3=10,corner4=10.2"
    for number, given in enumerate(("10.1,10.2,10,10,10.2", named)):
        folder = keep(tmp_path / f"m{number}", spec)
        assert record(folder, given, spec, "--json") == 0
        found.append(json.loads(capsys.readouterr().out))
    for key in ("thickness_mm", "thickness_sd_mm", "force_percent"):
        assert found[0][key] == pytest.approx(found[1][key])
    assert found[0]["points"] == []


def test_a_folder_without_sound_gauge_points_is_refused(tmp_path, capsys):
    folder = keep(tmp_path / "m", CROWN)
    path = tmp_path / "m" / "spec.json"
    content = json.loads(path.read_text())
    del content["gauge_points"]
    path.write_text(json.dumps(content))
    assert record(folder, typed(CROWN), CROWN) == 2
    path.write_text(json.dumps({**content, "gauge_points": [{"name": "tip"}]}))
    assert record(folder, typed(CROWN), CROWN) == 2


def test_a_campaign_presses_the_tips_thickness_of_a_recorded_crown(tmp_path, capsys):
    folder = keep(tmp_path / "m", CROWN)
    assert record(folder, typed(CROWN, tip=0.04), CROWN, "--json") == 0
    path = json.loads(capsys.readouterr().out)["files"]["record"]
    campaign = tmp_path / "campaign"
    campaign.mkdir()

    def named(text):
        text = text.replace("thickness_mm = 15.0\n", "")
        return text.replace("young_kPa_nominal = 25.0", f'record = "{path}"')

    read = read_campaign(write(campaign, text=named))
    assert [trial.thickness_mm for trial in read.trials] == pytest.approx([4.54] * len(read.trials))
    assert {trial.thickness_sd_mm for trial in read.trials} == {read_record(path).thickness_sd_mm}
    assert "pad_not_accepted" not in [one["code"] for one in read.warnings]


def test_the_sheet_lists_every_point_with_its_limits_and_a_column_for_each_pad():
    for spec in (CROWN, mould_spec(8.0, 40.0, 30.0, count=6)):
        plan = pour_plan(spec)
        blocks = sheet.pour_sheet(spec, plan, pour_warnings(spec, plan))
        tables = [block.rows for block in blocks if block.kind == "table" and block.rows[0][0] == "gauge point"]
        for rows in tables:
            for one, row in zip(gauge_points(spec), rows[1:], strict=True):
                assert row[0] == one.name and f"{one.nominal_mm:.2f}" in row
                assert f"{one.low_mm:.2f} to {one.high_mm:.2f}" in row
        assert sum(cell == sheet.BLANK for rows in tables for cell in rows[1]) == spec.count
        text = sheet_text(blocks)
        assert "mean of five" not in text and all(f"{one.name}=MM" in text for one in gauge_points(spec))


def drawn_spec(rng):
    """A crown, several or a ridge on a pad that may be only just large enough."""
    for _ in range(200):
        height, foot = round(rng.uniform(0.6, 6.0), 1), round(rng.uniform(3.0, 25.0), 1)
        ridge, sites = int(rng.random() < 0.25), rng.integers(1, 4, 2)
        sites = (1, 1) if ridge else sites
        pitch = np.round(2.0 * foot + rng.uniform(0.0, 12.0, 2), 1)
        room = np.maximum(2.0 * (foot + 8.0) + (np.array(sites) - 1) * pitch + rng.uniform(0.0, 14.0, 2), 16.0)
        names = {"radius": round(rng.uniform(0.1, 0.6) * foot**2 / height, 1), "height": height, "foot": foot}
        names |= {"ridge": ridge} if ridge else {}
        if max(sites) > 1:
            names |= {"sites_along": sites[0], "sites_across": sites[1], "pitch_along": pitch[0]}
            names |= {"pitch_across": pitch[1]}
        listed = tuple((name, float(value)) for name, value in names.items())
        thickness = round(height + rng.uniform(2.0, 10.0), 1)
        try:
            return mould_spec(thickness, float(room[0]), float(room[1]), kind="crowned", parameters=listed)
        except InputError:
            continue
    raise AssertionError("no drawn mould can be made")


def gauged_on_flats(spec):
    """Points of a drawn mould, each but the tips checked on a fine grid of its foot against the closed forms."""
    pad = spec.pad
    shape, names = pad.shape, [one.name for one in gauge_points(spec)]
    for one in gauge_points(spec):
        if one.name.startswith("tip"):
            continue
        away = [
            abs(one.y_mm - b) if shape.runs_out else np.hypot(one.x_mm - a, one.y_mm - b) for a, b in shape.places_mm
        ]
        assert min(away) - max(shape.lines_mm()) > 3.98
        assert one.nominal_mm == pytest.approx(pad.thickness_mm - shape.relief_mm)
        for at, side in ((one.x_mm, pad.length_mm), (one.y_mm, pad.width_mm)):
            assert side / 2 - abs(at) - pad.edge_radius_mm > 3.98
    left = [one for one in pour_warnings(spec, pour_plan(spec)) if one["code"] == "gauge_points_left_out"]
    missing = {"shoulder", *CORNERS} - set(names)
    assert bool(left) == bool(missing) and all(name in left[0]["message"] for name in missing)
    return missing


def test_no_gauge_point_is_within_the_foot_of_a_slope():
    rng = np.random.default_rng(20261128)
    missing = [gauged_on_flats(drawn_spec(rng)) for _ in range(40)]
    assert sum(map(bool, missing)) < 20  # most pads have room everywhere


def test_a_pad_without_room_beside_its_crown_says_so_and_its_record_needs_no_shoulder(tmp_path, capsys):
    sizes = (("radius", 3.0), ("height", 1.0), ("foot", 4.0))
    spec = mould_spec(8.0, 24.0, 24.0, kind="crowned", parameters=sizes)
    spec = replace(spec, pad=replace(spec.pad, edge_radius_mm=4.0))
    assert "shoulder" in gauged_on_flats(spec)
    folder = keep(tmp_path / "m", spec)
    assert record(folder, typed(spec), spec, "--json") == 0
    assert json.loads(capsys.readouterr().out)["accepted"]


@pytest.mark.slow
def test_no_gauge_point_of_five_hundred_drawn_moulds_is_within_the_foot_of_a_slope():
    rng = np.random.default_rng(20261129)
    missing = [gauged_on_flats(drawn_spec(rng)) for _ in range(500)]
    assert sum(map(bool, missing)) < 250
