"""Campaigns and comparisons know a pad by its record: thickness as gauged, with its error."""

from __future__ import annotations

import json
from dataclasses import replace

from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.measurement.pad_record import PadRecord, read_record, thickness_error
from tests.measurement.test_campaign import refused, write

PLACES = (15.2, 15.3, 15.1, 15.2, 15.4)
RECORD = PadRecord(
    "ABCD1234",
    "slab",
    150.0,
    120.0,
    "polyurethane-nagoya",
    15.0,
    15.0,
    PLACES,
    sum(PLACES) / 5,
    thickness_error(PLACES, 0.05),
    250.0,
    25.0,
    26.5,
    accepted=False,
    force_percent=-1.9,
    missed=("mass 250 g",),
)


def save(folder, record=RECORD, name="record.json"):
    (folder / name).write_text(json.dumps(record.to_dict()))
    return folder / name


def test_a_record_reads_back_as_it_was_written(tmp_path):
    assert read_record(save(tmp_path)) == RECORD


def test_a_trial_takes_thickness_and_error_from_its_record_and_only_that_trial(tmp_path):
    save(tmp_path)
    text = 'thickness_mm = 15.0\nrecord = "record.json"'
    read = read_campaign(write(tmp_path, text=lambda t: t.replace("thickness_mm = 15.0", text, 1)))
    assert read.trials[0].thickness_mm == RECORD.thickness_mm and read.trials[1].thickness_mm == 15.0
    assert read.trials[0].thickness_sd_mm == RECORD.thickness_sd_mm and read.trials[1].thickness_sd_mm is None
    assert read.trials[0].pad != read.trials[1].pad and read.records == (tmp_path / "record.json",)
    assert [one["code"] for one in read.warnings].count("pad_not_accepted") == 1


def test_a_trial_takes_witness_and_weighing_from_its_record_but_not_those_of_two_layers(tmp_path):
    known = replace(RECORD, young_sd_kPa=0.5, weighed_ratio=15.04, weighed_ratio_sd=0.02)
    save(tmp_path, known)
    text = 'thickness_mm = 15.0\nrecord = "record.json"'
    first, second = read_campaign(write(tmp_path, text=lambda t: t.replace("thickness_mm = 15.0", text, 1))).trials[:2]
    read = (first.witness_kPa, first.witness_sd_kPa, first.weighed_ratio, first.weighed_ratio_sd)
    assert read == (26.5, 0.5, 15.04, 0.02) and first.design_thickness_mm == 15.0
    assert second.witness_kPa is None and second.weighed_ratio is None and second.design_thickness_mm is None
    save(tmp_path, replace(known, shape="layered:top=5,modulus_ratio=2"))
    assert read_campaign(tmp_path).trials[0].witness_kPa is None


def test_the_pads_record_stands_for_every_trial_its_size_and_its_witness(tmp_path):
    folder = tmp_path / "campaign"
    folder.mkdir()
    save(tmp_path)

    def named(text):
        text = text.replace("thickness_mm = 15.0\n", "")
        return text.replace("young_kPa_nominal = 25.0", 'record = "../record.json"')

    read = read_campaign(write(folder, text=named))
    assert {trial.thickness_mm for trial in read.trials} == {RECORD.thickness_mm}
    assert read.pad.young_kPa_nominal == 26.5 and read.pad.length_mm == 150.0 and read.pad.resin == RECORD.resin


def test_a_record_of_another_pad_or_one_that_is_none_is_refused_with_the_line(tmp_path):
    save(tmp_path)
    (tmp_path / "bad.json").write_text("{")
    (tmp_path / "damaged.json").write_text(json.dumps({**RECORD.to_dict(), "thickness_mm": -1}))
    (tmp_path / "other.json").write_text(json.dumps({"schema": "dummydesign.mold/1"}))

    def trial(name, thickness=15.0):
        given = f'thickness_mm = {thickness}\nrecord = "{name}"'
        return lambda text: text.replace("thickness_mm = 15.0", given, 1)

    for name, thickness, word in (
        ("record.json", 20.0, "another|this pad"),
        ("bad.json", 15.0, "cannot be read"),
        ("damaged.json", 15.0, "damaged"),
        ("other.json", 15.0, "mold record"),
        ("none.json", 15.0, "does not exist"),
    ):
        write(tmp_path, text=trial(name, thickness))
        refused(tmp_path, "campaign.toml:", word.split("|")[-1])
    write(tmp_path, text=lambda t: t.replace("[pad]", '[pad]\nrecord = "record.json"\nlength_mm = 100.0'))
    refused(tmp_path, "campaign.toml:", "length_mm = 100.0")


def test_a_pad_of_even_thickness_has_the_gauges_error_alone():
    assert thickness_error((5.0, 5.0, 5.0), 0.05) == 0.05
