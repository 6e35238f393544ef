"""Files: canonical STEP, meshes, drawings and sheets say what the solids and the plan say."""

from __future__ import annotations

import hashlib
import json
import math
import random
import re
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from dummydesign.mold.files import meshes as mesh
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.files import step
from dummydesign.mold.files.meshes import tessellate
from dummydesign.mold.files.solid_view import read_view
from dummydesign.mold.files.step import canonical_step
from dummydesign.mold.pour.plan import CUP_FACTOR, batch_of, pour_plan, witness_mass_g
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.sheet_text import sheet_text

HEADER = ("x.step", "test")


@pytest.fixture(scope="module")
def pad_step(open_parts):
    return step.step_text([open_parts.parts["pad"]], "pad", "test")


STYLES = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"


def _with_colours_in_another_order(text: str, seed: int) -> str:
    """The same assembly as the kernel may write it: the colours of its parts in another order under other numbers, and,
    as these may be longer, with lines broken elsewhere."""
    rows = re.findall(r"^#(\d+) = ((?:[^;']|'[^']*')*);\n", text, re.M)
    first = next(at for at, (_, body) in enumerate(rows) if body.startswith(STYLES))
    last = max(at for at, (_, body) in enumerate(rows) if body.startswith(STYLES))
    last = next(at for at in range(last, len(rows)) if rows[at + 1][1].startswith("SHAPE_DEFINITION"))
    chains = []
    for row in rows[first : last + 1]:
        if row[1].startswith(STYLES):
            chains.append([])
        chains[-1].append(row)
    random.Random(seed).shuffle(chains)
    new = {old: str(int(rows[first][0]) + n) for n, (old, _) in enumerate(row for chain in chains for row in chain)}
    lines = [
        f"#{new[old]} = "
        + re.sub(r"#(\d+)", lambda m: f"#{new.get(m[1], m[1])}", body).replace(",", ",\n  ", seed)
        + ";\n"
        for chain in chains
        for old, body in chain
    ]
    start, end = text.index(f"#{rows[first][0]} = "), text.index(f"#{rows[last + 1][0]} = ")
    again = text[:start] + "".join(lines) + text[end:]
    again = re.sub(r"(USAGE_OCCURRENCE.*),\$\);", r"\1,$\n  );", again)
    return again.replace("USAGE_OCCURRENCE('pad'", "USAGE_OCCURRENCE('19'").replace("2000-01-01", "2026-05-04")


def test_an_assembly_is_the_same_text_however_the_kernel_orders_colours_and_counts(open_parts):
    first = step.step_text(list(open_parts.parts.values()), "all", "test")
    again = [_with_colours_in_another_order(first, seed) for seed in range(5)]
    assert len({first, *again}) > 3
    assert {canonical_step(text, "all.step", "test") for text in again} == {first}


def test_canonical_step_keeps_every_entity_and_sees_a_changed_number(pad_step):
    again = canonical_step(pad_step, *HEADER)
    count = [len(re.findall(r"^#\d+ =", text, re.M)) for text in (pad_step, again)]
    assert count[0] == count[1] > 100
    changed = re.sub(r"CARTESIAN_POINT\('',\((-?\d)", r"CARTESIAN_POINT('',(9\1", pad_step, count=1)
    assert changed != pad_step and canonical_step(changed, *HEADER) != again


def test_letters_beyond_ascii_are_written_as_step_prescribes(pad_step):
    name = "樹脂 für 𠮷"
    text = canonical_step(pad_step, name, name)
    assert text.isascii() and text.count(r"'\X2\6A398102\X0\ f\X2\00FC\X0\r \X4\00020BB7\X0\'") == 2
    written = text.split("'")[1]
    assert canonical_step(text, written, written) == text


def test_canonical_step_refuses_what_is_not_step():
    with pytest.raises(ValueError, match="not a STEP file"):
        canonical_step("solid cube", *HEADER)
    with pytest.raises(ValueError, match="one after the other"):
        canonical_step(f"FILE_SCHEMA(('X'));DATA;\n#5={STYLES}('',(#9),#1);\n#7=A(#1);\n#9=B();\nENDSEC;", *HEADER)


def test_strings_with_signs_of_the_syntax_survive():
    rows = f"#7=PRODUCT('a;#3 it''s, (b)','  two  blanks',#9);\n#8={STYLES}('',(#9),#7);\n#9=B();\nENDSEC;"
    again = canonical_step(f"FILE_SCHEMA(('X'));DATA;\n{rows}", *HEADER)
    assert "#7=PRODUCT('a;#3 it''s, (b)','  two  blanks',#9);" in again


def test_density_unit_is_gram_per_cubic_centimetre(pad_step):
    text = re.sub(r"\s", "", pad_step)
    unit = re.search(r"POSITIVE_RATIO_MEASURE\([\d.]+\),#(\d+)\)", text)[1]
    elements = re.search(rf"#{unit}=DERIVED_UNIT\(\((#\d+),(#\d+)\)\)", text).groups()
    powers = {}
    for element in elements:
        base, power = re.search(rf"{element}=DERIVED_UNIT_ELEMENT\((#\d+),([-\d.]+)\)", text).groups()
        kind = re.search(rf"{base}=\((.*?)\);", text)[1]
        powers["mass" if "MASS_UNIT" in kind else "length"] = float(power)
    assert powers == {"mass": 1.0, "length": -3.0}


def test_time_stamp_follows_source_date_epoch(monkeypatch):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    assert step.time_stamp() == "2000-01-01T00:00:00"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert step.time_stamp() == "1970-01-02T00:00:00"


@pytest.mark.slow
def test_step_of_the_child_process_is_the_same_to_the_byte(lidded_package, lidded_parts):
    _, result = lidded_package
    spec, made = lidded_parts.spec, list(lidded_parts.parts.values())
    words = f"assembly of the {spec.preset} mould for a {spec.pad.title}, specification {spec.hash}, lengths in mm"
    text = step.step_text(made, f"assembly_{spec.tag}", words)
    on_disk = Path(result.files["assembly"]).read_bytes()
    assert on_disk == text.encode("ascii")
    assert hashlib.sha256(on_disk).hexdigest() == result.step_sha256


@pytest.mark.slow
def test_every_step_file_reads_back_with_name_colour_material_and_volume(lidded_package, lidded_parts):
    _, result = lidded_package
    whole = {part.name: part for part in step.read_step(Path(result.files["assembly"]))}
    assert set(whole) == set(lidded_parts.parts)
    for name, part in whole.items():
        solid = lidded_parts.solid(name)
        assert part.volume_mm3 == pytest.approx(solid.Volume(), rel=1e-9)
        assert part.volume_mm3 == pytest.approx(result.volumes_mm3.get(name, solid.Volume()), rel=1e-9)
        assert part.valid and part.solids == 1 and part.material and part.colour
        (alone,) = step.read_step(Path(result.files[name]))
        assert alone.name == name and alone.volume_mm3 == pytest.approx(part.volume_mm3, rel=1e-12)
    assert whole["mould"].density_g_per_cm3 == pytest.approx(lidded_parts.spec.silicone.density_g_per_cm3)


@pytest.mark.slow
def test_finer_meshes_come_closer_to_the_solid(open_parts):
    solid = open_parts.solid("pad")
    errors = [
        abs(tessellate(solid, tol, ang).volume / solid.Volume() - 1)
        for tol, ang in ((0.4, 0.8), (0.05, 0.2), (0.005, 0.05))
    ]
    assert errors[0] > errors[1] > errors[2] and errors[2] < 2e-5


def test_mesh_in_3mf_is_the_mesh_in_millimetres(open_parts, tmp_path):
    import trimesh

    part = tessellate(open_parts.solid("tray"))
    mesh.write_3mf(part, tmp_path / "tray.3mf")
    again = trimesh.load(tmp_path / "tray.3mf", force="mesh")
    assert again.is_volume and again.volume == pytest.approx(part.volume, rel=1e-6)
    assert again.extents == pytest.approx(part.extents, abs=1e-4)


def test_mesh_files_are_equal_for_equal_meshes(open_parts, tmp_path):
    part = tessellate(open_parts.solid("tray"))
    mesh.write_3mf(part, tmp_path / "a.3mf")
    first = (tmp_path / "a.3mf").read_bytes()
    mesh.write_3mf(part, tmp_path / "a.3mf")
    assert (tmp_path / "a.3mf").read_bytes() == first


@pytest.mark.slow
def test_the_view_needs_no_network_and_holds_pad_and_mould_for_the_report(lidded_package, lidded_parts):
    _, result = lidded_package
    parts = read_view(Path(result.files["view"]))
    assert set(parts) == {"pad", "mould"}
    for name, triangles in parts.items():
        box = lidded_parts.solid(name).BoundingBox()
        assert np.ptp(triangles, axis=(0, 1)) == pytest.approx((box.xlen, box.ylen, box.zlen), abs=0.01)
    page = Path(result.files["view"]).read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?:", page)
    assert "<canvas" in page


class _Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.bad = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "rect", "path", "polyline"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag in ("rect", "path", "polyline"):
            return
        if not self.open or self.open.pop() != tag:
            self.bad.append(tag)


def test_pour_sheet_carries_what_the_pour_needs(open_spec, lidded_spec):
    for spec in (open_spec, lidded_spec):
        plan = pour_plan(spec)
        blocks = sheet.pour_sheet(spec, plan, pour_warnings(spec, plan))
        text = sheet_text(blocks)
        batch = batch_of(spec, spec.pour, plan)
        cup_l = CUP_FACTOR * batch.with_witness.total_g / spec.pour.density_g_per_cm3 * 1e-3
        for name, mass in batch.mix.components:
            assert re.search(rf"\| {name} \| {mass:.1f} \|", text)
        for needed in (
            "isocyanates harm",
            spec.hash,
            "weighed, g",
            "Witness",
            "add-compression",
            "cure inhibition",
        ):
            assert needed in text
        for number in (
            f"{plan.level_deg:.2f} deg",
            f"{plan.silicone_mass_g:.0f} g",
            f"{cup_l:.2f} litres",
        ):
            assert number in text
        tags = _Tags()
        tags.feed(sheet.to_html(blocks))
        assert not tags.bad and not tags.open


def test_witness_puck_has_the_mass_of_its_cylinder(open_spec):
    volume_cm3 = math.pi * 2.5**2 * 3.0
    assert witness_mass_g(open_spec.pour) == pytest.approx(volume_cm3 * open_spec.pour.density_g_per_cm3)


@pytest.mark.slow
def test_manifest_names_every_file_with_its_hash(lidded_package):
    folder, result = lidded_package
    sums = json.loads(Path(result.files["manifest"]).read_text())["sha256"]
    endings = Counter(path.suffix for path in folder.iterdir())
    assert {kind: endings[kind] for kind in (".pdf", ".dxf", ".html", ".png")} == {
        ".pdf": 2,
        ".dxf": 1,
        ".html": 2,
        ".png": 1,
    }
    assert set(endings) == {".pdf", ".dxf", ".html", ".png", ".step", ".3mf", ".json"}
    for path in folder.iterdir():
        assert not path.name.startswith(".")
        if path.name != "manifest.json":
            assert sums[path.name] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert json.loads(Path(result.files["checks"]).read_text()) == result.checks
    assert json.loads(Path(result.files["spec"]).read_text())["hash"] == result.spec_hash


def test_a_3mf_is_of_the_core_alone_for_readers_that_refuse_what_they_do_not_know(tmp_path):
    """One namespace, the parts of the core in their order, the same triangles; drawn closed meshes."""
    import zipfile
    from xml.etree import ElementTree

    import trimesh

    rng = np.random.default_rng()
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    for _ in range(3):
        made = trimesh.creation.icosphere(2, float(rng.uniform(1.0, 80.0)))
        made.vertices *= rng.uniform(0.5, 2.0, 3)
        mesh.write_3mf(made, tmp_path / "a & b.3mf")
        archive = zipfile.ZipFile(tmp_path / "a & b.3mf")
        assert archive.namelist()[0] == "[Content_Types].xml"
        text = archive.read("3D/3dmodel.model").decode()
        assert text.count("xmlns") == 1 and "UUID" not in text
        root = ElementTree.fromstring(text)
        assert root.get("unit") == "millimeter" and all(one.tag.startswith(core) for one in root.iter())
        assert [child.tag for child in root] == [f"{core}resources", f"{core}build"]
        again = trimesh.load(tmp_path / "a & b.3mf", force="mesh")
        assert again.is_watertight and again.volume == pytest.approx(made.volume, rel=1e-5)
        assert len(again.faces) == len(made.faces)
