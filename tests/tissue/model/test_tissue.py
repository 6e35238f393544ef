"""Tissues: bands and aims, the two ranges, the built-in files, and what a broken file says."""

import subprocess
import sys

import numpy as np
import pytest

from dummydesign.core.user_library import data_folder, read_toml
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.maxwell_law import Parameters
from dummydesign.tissue.model.ranges import force_range
from dummydesign.tissue.model.subject import Subject
from dummydesign.tissue.model.tissue import same_shape
from dummydesign.tissue.model.tissue_file import readable_tissues, tissue_toml
from tests.support.refusal import raises_code

SITES = ["palm", "thenar", "forefinger"]


def subject(gamma1, c=0.05):
    return Parameters("ode", gamma1, (0.3 * gamma1, gamma1), ((10.0, (20 * c, 3 * c)), (250.0, (10 * c, c))))


@pytest.mark.parametrize("site", SITES)
def test_built_in_subjects_obey_what_the_paper_says_of_every_subject(site):
    tissue = load_tissue(site)
    gammas = np.array([[p.gamma1_N_per_mm3, *p.gamma_N_per_mm3] for p in tissue.parameter_sets])
    assert len(tissue.subjects) == 5 and tissue.kinds == ("inferred",)
    assert np.all(np.diff(gammas, axis=0) > 0), "gamma1, gamma2 and gamma3 rise together over the subjects"
    assert np.all(gammas[:, 1] < gammas[:, 2]), "gamma2 is always smaller than gamma3"
    for p in tissue.parameter_sets:
        slow, fast = np.array(p.dampers_at(10.0)), np.array(p.dampers_at(250.0))
        assert slow[0] > slow[1] and fast[0] > fast[1], "c2 is always larger than c3"
        assert np.all(fast < slow), "the dampers fall with speed"


@pytest.mark.parametrize("site", SITES)
def test_bands_are_mean_and_extremes_of_the_subjects_and_aims_follow_them(site):
    tissue = load_tissue(site)
    gamma1 = [p.gamma1_N_per_mm3 for p in tissue.parameter_sets]
    band = tissue.bands["gamma1_N_per_mm3"]
    assert (band.low, band.value, band.high) == pytest.approx((min(gamma1), np.mean(gamma1), max(gamma1)))
    assert tissue.target("average").gamma1_N_per_mm3 == pytest.approx(np.mean(gamma1))
    safe = tissue.target("safe-side")
    c3 = [p.dampers_at(250.0)[1] for p in tissue.parameter_sets]
    assert safe.dampers_at(250.0)[1] == pytest.approx(max(c3))
    assert tissue.target("subject:Rank-2-of-5") == tissue.parameter_sets[1]
    with raises_code("unknown_name", "subject"):
        tissue.target("subject:rank-2")
    with raises_code("unknown_name", "aim"):
        tissue.target("best")


@pytest.mark.parametrize("site", SITES)
@pytest.mark.parametrize("condition", [(5.0, 10.0), (10.0, 250.0), (15.0, 250.0)])
def test_every_subject_lies_inside_its_own_force_variation_range(site, condition):
    tissue, (steady, speed) = load_tissue(site), condition
    band = tissue.force_range(steady, speed)
    for parameters, depth, stop in zip(tissue.parameter_sets, band.depth_mm, band.stop_s):
        motion = ramp_and_hold(speed, depth)
        force = parameters.force(motion, speed)
        assert force[-1] == pytest.approx(steady, rel=1e-4)
        shares = band.inside(motion.time_s, force, stop)
        assert shares["inside_fraction"] == 1.0
        assert band.peak_low_N <= force.max() * 1.003 and force.max() <= band.peak_high_N * 1.003


def test_a_force_off_the_range_counts_only_where_it_is_off():
    people = (subject(0.05), subject(0.1))
    band = force_range(people, 10.0, 250.0)
    motion = ramp_and_hold(250.0, band.depth_mm[0])
    force = people[0].force(motion, 250.0)
    above = np.where(motion.time_s > band.stop_s[0], force + 20.0, force)
    shares = band.inside(motion.time_s, np.stack([force, above, force + 50.0]), band.stop_s[0])
    assert shares["inside_rise_fraction"] == pytest.approx([1.0, 1.0, 0.0], abs=0.02)
    assert shares["inside_hold_fraction"] == pytest.approx([1.0, 0.0, 0.0])
    assert shares["inside_fraction"] == pytest.approx([1.0, 0.5, 0.0], abs=0.02)


@pytest.mark.parametrize("hold_s", [2.0, 10.0])
@pytest.mark.parametrize("off_s", [0.02, 0.2])
def test_a_hold_counts_evenly_in_the_logarithm_of_time_from_5_ms_on(hold_s, off_s):
    """A force that is off until ``off_s`` after the stop is inside for ln(hold / off) of ln(hold / 5 ms)."""
    people = (subject(0.05), subject(0.1))
    band = force_range(people, 10.0, 250.0, hold_s)
    motion = ramp_and_hold(250.0, band.depth_mm[0], hold_s, hold_points=400)
    after = motion.time_s - band.stop_s[0]
    force = people[0].force(motion, 250.0) + 50.0 * ((after > 0.0) & (after < off_s))
    share = band.inside(motion.time_s, force, band.stop_s[0])["inside_hold_fraction"]
    assert share == pytest.approx(np.log(hold_s / off_s) / np.log(hold_s / 0.005), abs=0.03)


@pytest.mark.parametrize(("dampers", "code"), [((), "missing"), (((10.0, (0.1,)),), "inconsistent")])
def test_springs_need_as_many_dampers(dampers, code):
    with raises_code(code, "c_N_s_per_mm"):
        Parameters("ode", 0.1, (0.2, 0.3), dampers)


def test_dampers_between_known_speeds_are_interpolated_in_logarithms():
    person = subject(0.1)
    middle = person.dampers_at(np.sqrt(10.0 * 250.0))
    assert middle == pytest.approx([np.sqrt(a * b) for a, b in zip(person.dampers_at(10), person.dampers_at(250))])
    assert person.dampers_at(1.0) == person.dampers_at(10.0)
    assert person.dampers_at(900.0) == person.dampers_at(250.0)


def test_subjects_of_another_number_of_elements_are_told_which_number_to_fit():
    law = subject(0.1)
    more = Parameters("ode", 0.1, (*law.gamma_N_per_mm3, 0.1), tuple((v, (*c, 0.1)) for v, c in law.c_N_s_per_mm))
    with raises_code("inconsistent", "elements") as refused:
        same_shape(tuple(Subject(name, one, {}) for name, one in (("anna", law), ("ben", more))))
    assert (refused.value.value, refused.value.allowed) == (7, 5) and "--elements 5" in str(refused.value)


@pytest.mark.parametrize("site", SITES)
def test_a_written_tissue_reads_back_the_same(site, tmp_path):
    tissue = load_tissue(site)
    path = tmp_path / f"{site}.toml"
    path.write_text(tissue_toml(tissue))
    again = load_tissue(str(path))
    assert again.parameter_sets == tissue.parameter_sets and again.sources == tissue.sources


@pytest.mark.parametrize(
    "old, new, code",
    [
        ('law = "ode"', 'law = "odd"', "unknown_name"),
        ("gamma1_N_per_mm3 = {", "gamma_1 = {", "unknown_key"),
        ('title = "', 'titel = "', "unknown_key"),
        ("schema = 1", "schema = 2", "unsupported"),
        ('kind = "inferred"', 'kind = "guessed"', "unknown_name"),
        ('"rank-2-of-5"', '"rank-1-of-5"', "duplicate"),
        ("c2_N_s_per_mm.10", "c2_N_s_per_mm.12", "inconsistent"),
    ],
)
def test_a_broken_file_is_named_by_line_and_key(tmp_path, old, new, code):
    path = tmp_path / "palm.toml"
    text = (data_folder() / "materials" / "tissues" / "palm.toml").read_text(encoding="utf-8")
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with raises_code(code) as refused:
        load_tissue(str(path))
    assert "palm.toml:" in str(refused.value)


def test_a_broken_user_file_never_hides_the_built_in_tissues(tmp_path, monkeypatch):
    folder = tmp_path / "materials" / "tissues"
    folder.mkdir(parents=True)
    (folder / "palm.toml").write_text("schema = [")
    (folder / "mine.toml").write_text("schema = 1\nlaw = 'ode'\n")
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    found, problems = readable_tissues()
    assert sorted(tissue.name for tissue in found) == sorted(SITES)
    assert any("palm.toml" in text for text in problems) and any("mine.toml" in text for text in problems)


def test_listing_tissues_imports_nothing_heavy():
    code = (
        "import sys; from dummydesign.cli import run; run(['tissues', 'list']); "
        "bad = {'scipy', 'skfem', 'matplotlib', 'pyvista', 'cadquery'} & set(sys.modules); "
        "sys.exit(1 if bad else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0 and "forefinger" in done.stdout


def test_every_shipped_number_has_interval_kind_and_source():
    for site in SITES:
        content, _ = read_toml(data_folder() / "materials" / "tissues" / f"{site}.toml")
        assert "infer" in content["inference"]["command"]
        for person in load_tissue(site).to_dict()["subjects"]:
            entries = [v for v in person.values() if isinstance(v, dict)]
            flat = [q for e in entries for q in ([e] if "value" in e else e.values())]
            assert len(flat) == 7
            assert all(q["low"] < q["value"] < q["high"] and q["source"] for q in flat)
