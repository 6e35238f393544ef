"""A shape from elsewhere, known to no module of the package, goes through predict, mold, suggest and loop."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from dummydesign import cli
from dummydesign.core.errors import InputError
from dummydesign.design.search.shape_family import Designs, Family
from dummydesign.geometry.dimensions import STEEPEST_TOP_DEG, THINNEST_GEL_MM, check_inside, check_left
from dummydesign.geometry.pad_shape import PadBlock, PadShape, grid
from dummydesign.geometry.shape_registry import read_shape, registered, shape_kinds
from dummydesign.mold.cad.shapes import FlatSolids
from dummydesign.mold.checks import solids as check
from dummydesign.mold.checks import solids as check_shape
from dummydesign.mold.files import pour_sheet as sheet
from dummydesign.mold.model.layout import cavity_volume_mm3, layout
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.spec import PadGeometry, read_kind
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from dummydesign.pad.tables.slab import load_table
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text


@dataclass(frozen=True)
class Coned(PadShape):
    """A truncated cone on the tested face: radius of its flat top, radius of its foot, height."""

    name: ClassVar[str] = "coned"
    closed_form: ClassVar[str] = ", a truncated cone"
    required_warnings: ClassVar[frozenset[str]] = frozenset({"curved_master", "thickness_varies"})
    top_mm: float
    foot_mm: float
    height_mm: float

    flat_top: ClassVar[bool] = False

    @property
    def first_exponent(self) -> float:
        return 1.0

    @property
    def relief_mm(self) -> float:
        return self.height_mm

    @property
    def steepest_deg(self) -> float:
        return math.degrees(math.atan2(self.height_mm, self.foot_mm - self.top_mm))

    def lines_mm(self) -> tuple[float, ...]:
        return self.top_mm, self.foot_mm

    def drop_mm(self, x_mm: NDArray, y_mm: NDArray) -> NDArray:
        share = (np.hypot(x_mm, y_mm) - self.top_mm) / (self.foot_mm - self.top_mm)
        return self.height_mm * np.clip(share, 0.0, 1.0)

    def top_volume_mm3(self, block: PadBlock) -> float:
        return math.pi * self.height_mm / 3 * (self.top_mm**2 + self.top_mm * self.foot_mm + self.foot_mm**2)

    def check(self, thickness_mm: float, length_mm: float = 150.0, width_mm: float = 120.0) -> None:
        if not 0.0 < self.top_mm < self.foot_mm:
            message = f"top = {self.top_mm:g} mm is not between 0 and foot = {self.foot_mm:g} mm"
            raise InputError(message, "out_of_range", "top_mm", self.top_mm, (0.0, self.foot_mm))
        if not 0.0 < self.steepest_deg <= STEEPEST_TOP_DEG:
            message = f"cone slope = {self.steepest_deg:.0f} deg is not between 0 and {STEEPEST_TOP_DEG:g} deg"
            raise InputError(message, "out_of_range", "slope_deg", self.steepest_deg, (0.0, STEEPEST_TOP_DEG))
        check_left("cone", self.height_mm, thickness_mm, THINNEST_GEL_MM)
        check_inside("cone", self.foot_mm, min(length_mm, width_mm))

    def mark(self, block: PadBlock, scale: float) -> str:
        return f"truncated cone: top radius {self.top_mm:g}, foot {self.foot_mm:g}, height {self.height_mm:g} mm"

    @classmethod
    def candidates(cls, thickness_mm: NDArray, radius_mm: float) -> tuple[NDArray, dict[str, NDArray]]:
        h, top, wider, share = grid(thickness_mm, np.array([2.0, 4.0, 6.0]), np.array([2.0, 5.0]), np.array([0.2, 0.4]))
        return h, {"top": top, "foot": top + wider, "height": np.round(share * h, 1)}

    @classmethod
    def in_proportion(cls, k: NDArray) -> dict[str, NDArray]:
        return {"height": k}


class ConedSolids(FlatSolids):
    """An exact cone."""

    def tops(self, pad: PadGeometry) -> list[Any]:
        import cadquery as cq

        shape = pad.shape
        assert isinstance(shape, Coned)
        return [cq.Solid.makeCone(shape.top_mm, shape.foot_mm, shape.height_mm)]


class ConedFamily(Family):
    """A law it brings: the slab under a punch of the contact's radius, which grows down the cone."""

    kind = "coned"
    source = "law"

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        return Designs(self.kind, *Coned.candidates(np.asarray(thickness_mm, float), radius_mm))

    def check(self, shape: PadShape) -> None:
        assert isinstance(shape, Coned)

    def at_thickness(self, shape: PadShape, thickness_mm: float, wanted_mm: NDArray) -> Designs:
        wanted = np.asarray(wanted_mm, float)
        grows = Coned.in_proportion(wanted / thickness_mm)
        scaled = {name: value * grows.get(name, np.ones_like(wanted)) for name, value in shape.parameters}
        return Designs(self.kind, wanted, scaled)

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        h, p = designs.thickness_mm[:, None], {name: value[:, None] for name, value in designs.parameters.items()}
        depth = np.maximum(depth_mm, 0.0)
        contact = np.minimum(p["top"] + (p["foot"] - p["top"]) * depth / p["height"], radius_mm)
        held = np.minimum(depth, self.limit_mm(designs, radius_mm)[:, None])
        low, high = load_table("bonded").ratio_range
        area = load_table("bonded").force(held, h, 1.0, np.clip(contact, low * h, high * h))
        return np.where(depth <= held * (1.0 + 1e-9), area, np.nan)

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        return 0.45 * designs.thickness_mm

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        return np.full(np.shape(depth_mm), 0.3)


@pytest.fixture(autouse=True)
def _coned(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with registered(Coned, SOLIDS=ConedSolids(), FAMILY=ConedFamily()):
        yield


TEXT = "coned:4,9,3"


def _answer(capsys, *arguments):
    status = cli.run([*arguments, "--json"])
    caught = capsys.readouterr()
    return status, json.loads(caught.out) if status != 2 else caught.err


def _spec(thickness_mm: float = 12.0):
    kind, parameters = read_kind(TEXT)
    return mould_spec(thickness_mm, 60.0, 50.0, kind=kind, parameters=parameters)


def test_it_is_read_printed_and_listed_and_known_no_longer_than_registered():
    assert read_shape(TEXT) == Coned(4.0, 9.0, 3.0) == read_shape(str(Coned(4.0, 9.0, 3.0)))
    assert "coned" in list(shape_kinds())[4:]
    with raises_code("file_exists", "shape"), registered(Coned):
        pass
    with raises_code("unknown_name", "shape"):
        read_shape("cone:3")
    with raises_code("out_of_range", "cone_height_mm"):
        read_shape(TEXT).check(4.0)


# predict


def test_predict_solves_it_by_the_elements_that_its_contract_names(capsys):
    pad = ["predict", "--young", "30", "--thickness", "12", "--depth", "0.3,0.6"]
    status, error = _answer(capsys, *pad, "--shape", TEXT)
    assert status == 2 and "has no table; add --fidelity axisymmetric" in error
    status, found = _answer(capsys, *pad, "--shape", TEXT, "--fidelity", "axisymmetric")
    assert status == 0 and np.all(np.diff(found["force_N"]) > 0.0)
    # Gel taken away beside the top makes it softer than a slab under a punch of the top's radius.
    slab = load_table("bonded").force(np.array([0.3, 0.6]), 12.0, 0.03, 4.0)
    assert np.all(np.array(found["force_N"]) < 1.02 * slab) and found["force_N"][0] > 0.5 * slab[0]


# mold


def test_its_mould_is_specified_weighed_and_described():
    spec = _spec()
    plan = pour_plan(spec)
    plain = mould_spec(12.0 - 3.0, 60.0, 50.0)
    cone = layout(spec).scale ** 3 * math.pi * (16.0 + 36.0 + 81.0)
    assert cavity_volume_mm3(spec) == pytest.approx(cavity_volume_mm3(plain) + cone, rel=1e-9)
    assert plan.pad_mass_g == pytest.approx(cavity_volume_mm3(spec) * spec.pour.density_g_per_cm3 * 1e-3)
    warnings = pour_warnings(spec, plan)
    assert Coned.required_warnings <= {item["code"] for item in warnings}
    written = sheet_text(sheet.pour_sheet(spec, plan, warnings))
    assert "Truncated cone: top radius 4" in written and "coned pad 60 x 50 x 12 mm" in written
    assert "at a tip of radius" not in written
    assert spec.tag == "coned_t12" and spec.pad.least_gel_mm == pytest.approx(9.0)


def test_its_solid_has_the_closed_form_and_the_heights_of_the_model():
    from dummydesign.mold.cad.build import pad_solid
    from dummydesign.mold.cad.parts import Parts

    spec = _spec()
    plan = layout(spec)
    made = Parts(spec, plan, pad_solid(spec.pad))
    assert made.pad_nominal.Volume() * plan.scale**3 == pytest.approx(cavity_volume_mm3(spec), rel=check.VOLUME_REL)
    assert check_shape.face_profile(made).status == "pass"


def test_a_shape_without_solids_is_refused_in_words():
    from dummydesign.mold.cad.build import pad_solid

    @dataclass(frozen=True)
    class Bare(Coned):
        name: ClassVar[str] = "bare"

    with registered(Bare):
        pad = mould_spec(12.0, 60.0, 50.0, kind="bare", parameters=Coned(4.0, 9.0, 3.0).parameters).pad
        with raises_code("unsupported", "shape"):
            pad_solid(pad)


@pytest.mark.slow
def test_its_whole_mould_passes_all_checks(tmp_path):
    from dummydesign.mold.build_files import produce
    from dummydesign.mold.files.pour_sheet import Foot

    found = produce(_spec(), tmp_path, Foot(_spec().hash))
    assert [item["id"] for item in found["checks"] if item["status"] == "fail"] == []
    assert (tmp_path / "pad_coned_t12.step").is_file()


# suggest


@pytest.mark.slow
def test_suggest_finds_its_best_pad_by_the_law_it_brings(capsys):
    asked = ["suggest", "--tissue", "forefinger", "--thickness", "8:13", "--no-cad", "--no-verify", "--shape"]
    status, found = _answer(capsys, *asked, "coned")
    assert status == int(found["verdict"]["light"] == "red")
    best = found["recommendation"]
    shape = read_shape(best["shape"])
    assert isinstance(shape, Coned)
    shape.check(best["thickness_mm"])
    rows = {row["kind"]: row for row in found["shapes"]}
    assert set(rows) == {"coned"} and rows["coned"]["by"] == "law"
    status, same = _answer(capsys, *asked, best["shape"])
    assert status == int(same["verdict"]["light"] == "red") and read_shape(same["recommendation"]["shape"]) == shape


@pytest.mark.slow
def test_suggest_works_its_best_pad_out_on_finite_elements(capsys):
    asked = ["suggest", "--tissue", "forefinger", "--thickness", "8:12", "--no-cad", "--shape"]
    status, found = _answer(capsys, *asked, TEXT)
    assert status == int(found["verdict"]["light"] == "red")
    assert {row["kind"]: row["by"] for row in found["shapes"]}["coned"] == "elements"


# loop


def test_loop_takes_a_campaign_with_the_shape_and_asks_for_what_else_is_missing(capsys, tmp_path):
    text = f'schema = 1\nname = "one"\n[pad]\nyoung_kPa_nominal = 25.0\nshape = "{TEXT}"\n'
    (tmp_path / "campaign.toml").write_text(text, encoding="utf-8")
    status, error = _answer(capsys, "loop", ".")
    assert status == 2 and error.count("\n") == 1
    assert "side_mm" in error and "coned" not in error
    (tmp_path / "campaign.toml").write_text(text.replace(TEXT, "conned:1,2"), encoding="utf-8")
    status, error = _answer(capsys, "loop", ".")
    assert status == 2 and "campaign.toml:5" in error and "conned" in error
