"""The ring of a puck: closed forms against counted areas and CAD, weights, hours, what its sheet accepts and types."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.pour.bill_of_materials import mould_cost, printed_volumes_mm3
from dummydesign.mold.puck import ring as rings
from dummydesign.mold.puck.plan import puck_plan, ring_cost
from dummydesign.mold.puck.ring import Ring, cavity_mm3, puck_spec, read_pucks, ring_volume_mm3
from dummydesign.mold.puck.sheet import acceptance_rows, puck_sheet
from tests.support.refusal import raises_code


def test_area_of_a_half_is_that_of_counted_points():
    spec = puck_spec([Ring(50.0, 30.0)])
    ring, step = spec.rings[0], 0.05
    inner = spec.scale * 25.0
    outer, groove = inner + rings.WALL_MM, rings.groove_mm(spec)
    x, y = np.meshgrid(np.arange(-40.0, 40.0, step) + step / 2, np.arange(-2.0, 35.0, step) + step / 2)
    radius, middle = np.hypot(x, y), outer + rings.LUG_LONG_MM / 2
    lug = (y <= rings.LUG_THICK_MM) & (np.abs(x) <= outer + rings.LUG_LONG_MM)
    inside = (y >= 0.0) & ((radius <= outer) | lug) & (radius > inner)
    inside &= ~(y < groove - np.abs(x + middle))
    inside |= (y < 0.0) & (-y < rings.RIDGE_MM - np.abs(x - middle))
    assert rings.half_area_mm2(spec, ring) == pytest.approx(inside.sum() * step**2, rel=1e-3)


def test_without_shrinkage_and_heat_the_cavity_is_the_puck():
    spec = puck_spec([Ring(50.0, 30.0)])
    assert cavity_mm3(spec, spec.rings[0]) == pytest.approx(spec.scale**3 * math.pi / 4 * 2500 * 30, rel=1e-12)
    slab = mould_spec(10.0, preset="printed")
    from dummydesign.mold.model.layout import pad_scale

    assert spec.scale == pad_scale(slab)


def test_sizes_as_typed_and_what_is_refused():
    assert read_pucks("50x30") == (Ring(50.0, 30.0),)
    assert read_pucks("50x30,40X25,50x30") == (Ring(50.0, 30.0, 2), Ring(40.0, 25.0))
    for text, code, quantity in (
        ("50", "malformed", "puck"),
        ("50x30x20", "malformed", "puck"),
        ("axb", "malformed", "puck"),
        ("5x5", "out_of_range", "puck_diameter"),
        ("50x5", "out_of_range", "puck_height"),
        ("100x10", "out_of_range", "puck_diameter_over_height"),
        (",".join(["50x30"] * 13), "out_of_range", "number_of_pucks"),
    ):
        with raises_code(code, quantity):
            read_pucks(text)
    with raises_code("not_applicable", "preset"):
        puck_spec([Ring(50.0, 30.0)], preset="open")


def test_a_ring_larger_than_the_printer_is_refused():
    spec = puck_spec([Ring(120.0, 60.0)])
    long, wide = rings.half_size_mm(spec, spec.rings[0])
    for bed, fits in ((long + 10.5, True), (long + 9.5, False)):
        small = replace(spec, machines=replace(spec.machines, bed_x_mm=bed, bed_y_mm=wide + 10.5, bed_margin_mm=5.0))
        if fits:
            rings.check_bed(small)
            continue
        with raises_code("cannot_be_made", "puck"):
            rings.check_bed(small)


def test_a_ring_prints_in_about_an_hour_where_the_silicone_mould_of_a_puck_takes_ten():
    ring = ring_cost(50.0, 30.0)
    mould = mould_cost(mould_spec(30.0, 50.0, 50.0, kind="puck"))
    assert 0.7 < ring.printing_h < 1.2 and mould.printing_h > 8.0
    assert ring.filament_g == pytest.approx(18.0 * ring.printing_h)
    assert ring_cost(50.0, 30.0, 2).printing_h == pytest.approx(2.0 * ring.printing_h)


def test_costs_load_no_cad():
    code = (
        "import sys; from dummydesign.mold.puck.plan import ring_cost; ring_cost(); "
        "from dummydesign.mold.pour.bill_of_materials import mould_cost; "
        "from dummydesign.mold.model.preset import mould_spec; "
        "mould_cost(mould_spec(10.0)); print('cadquery' in sys.modules, 'OCP' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["False", "False"], done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("fixture", ["open_parts", "boned"])
def test_printed_volumes_are_those_of_the_solids(fixture, request):
    made = request.getfixturevalue(fixture)
    volumes = printed_volumes_mm3(made.spec)
    printed = {name: part.volume_mm3 for name, part in made.parts.items() if part.is_printed}
    assert volumes.keys() == printed.keys()
    for name, volume in printed.items():
        assert volumes[name] == pytest.approx(volume, rel=0.01), name


def test_a_lidded_mould_has_no_hours_without_cad(lidded_spec):
    cost = mould_cost(lidded_spec)
    assert cost.printing_h is None and cost.silicone_g > 0.0 and cost.resin_g > 0.0


def test_weights_cover_the_rings_in_the_right_ratio():
    one, two = (puck_plan(puck_spec([Ring(50.0, 30.0, count)], ratio=15.4)) for count in (1, 3))
    density = 1e-3 * puck_spec([Ring(50.0, 30.0)], ratio=15.4).pour.density_g_per_cm3
    assert one.puck_g[0] == pytest.approx(density * math.pi / 4 * 2500 * 30)
    assert one.raised and not two.raised
    for plan in (one, two):
        (_, polyol), (_, isocyanate) = plan.mix.components
        assert isocyanate / polyol == pytest.approx(0.154, rel=0.005)
        assert plan.mix.error_percent < 0.5 and plan.mix.total_g > plan.wanted_g - 0.2


def test_a_puck_is_accepted_by_size_and_mass_and_never_by_the_modulus_it_is_to_show():
    spec = puck_spec([Ring(50.0, 30.0), Ring(40.0, 25.0)], ratio=15.4)
    plan = puck_plan(spec)
    measured = [row[0] for row in acceptance_rows(spec, plan)[1:]]
    assert {"diameter", "height", "mass"} <= {name.split(" ")[0] for name in measured}
    assert not any("modulus" in name for name in measured)
    rows = {row[0]: row for row in acceptance_rows(spec, plan)}
    assert rows["mass of 40x25"][1] == f"{plan.puck_g[1]:.1f} g"
    text = " ".join(block.text + " ".join(block.items) for block in puck_sheet(spec, plan))
    assert " pad" not in text.split("5. Press")[0].replace("with the pad", "")
    for words in ("puck50x30-v10.csv puck50x30-v50.csv", "puck40x25-v10.csv", "--friction lubricated", "--ratio 15.4"):
        assert words in text


def test_a_silicone_mould_of_a_puck_does_not_accept_by_modulus_either():
    from dummydesign.mold.pour.acceptance import acceptance_rows as pad_rows
    from dummydesign.mold.pour.plan import pour_plan

    for kind, has in (("puck", False), ("slab", True)):
        spec = mould_spec(30.0, 50.0, 50.0, kind=kind)
        names = [row[0] for row in pad_rows(spec, pour_plan(spec))]
        assert any("modulus" in name for name in names) == has


@pytest.mark.slow
def test_half_and_puck_are_exact_solids_that_close():
    from dummydesign.mold.puck.build_files import half_solid, puck_solid

    spec = puck_spec([Ring(40.0, 25.0)])
    half, puck = half_solid(spec, spec.rings[0]), puck_solid(spec, spec.rings[0])
    assert half.isValid() and len(half.Solids()) == 1
    assert 2 * half.Volume() == pytest.approx(ring_volume_mm3(spec, spec.rings[0]), rel=1e-9)
    assert puck.Volume() == pytest.approx(cavity_mm3(spec, spec.rings[0]), rel=1e-9)
    assert half.intersect(puck).Volume() < 1e-6
    assert {abs(round(face.normalAt().z, 9)) for face in half.Faces()} == {0.0, 1.0}


@pytest.mark.slow
def test_the_command_makes_checked_files_of_several_pucks_with_one_sheet(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["mold", "--puck", "50x30,50x30,30x20", "--ratio", "15.4", "--json"]
    assert run(words) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {check["status"] for check in answer["checks"]} == {"pass"}
    assert {"assembly", "ring_half_50x30", "puck_30x20", "pour_sheet", "ring_half_50x30_3mf"} <= answer["files"].keys()
    assert len(answer["step_sha256"]) == 64 and sum(answer["masses_g"].values()) > 150.0
    volumes = answer["volumes_mm3"]
    assert volumes["puck_50x30"] == pytest.approx(math.pi / 4 * 2500 * 30, rel=1e-12)
    assert volumes["cavity_50x30"] > volumes["puck_50x30"]
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out) | {"seconds": 0} == answer | {"seconds": 0}


@pytest.mark.parametrize(
    "words, named",
    [
        (["--count", "2"], "--count"),
        (["--shape", "crowned:20,2"], "--shape"),
        (["--length", "100"], "--length"),
        (["--width", "80mm"], "--width"),
        (["--base-ratio", "20"], "--base-ratio"),
        (["--face-sheet", "3"], "--face-sheet"),
        (["--machine", "m", "--silicone", "s"], "--machine, --silicone"),
    ],
)
def test_what_belongs_to_pads_is_refused_beside_a_puck(words, named, capsys):
    assert run(["mold", "--puck", "50x30", *words, "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["quantity"]) == ("conflict", "puck") and f"leave {named} out" in error["message"]


def test_thickness_and_puck_are_not_given_together(capsys):
    assert run(["mold", "--puck", "50x30", "--thickness", "5"]) == 2
    assert run(["mold"]) == 2 and "--puck" in capsys.readouterr().err
