"""Mould, cast pad, campaign, learn and overview by real clicks: what is shown is chosen, mistakes are mended."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

import pytest

from dummydesign.report.compare import next_steps
from dummydesign.report.front_page import full_sentence
from dummydesign.studio import jobs
from dummydesign.studio import trash as bin
from tests.support import lab_project as lab
from tests.support.studio import COMMAND_MS, choose, opened, saved, saved_series, unfold
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow


def sent(name, content):
    return {"name": name, "mimeType": "text/csv", "buffer": content if isinstance(content, bytes) else content.encode()}


def drop(page, place, *files):
    page.locator(f"{by(f'drop-{place}')} input[type=file]").set_input_files(list(files))


def trial(root, campaign, file):
    with open(root / "campaigns" / campaign / "campaign.toml", "rb") as stream:
        return next(one for one in tomllib.load(stream)["trial"] if one["file"] == file)


def test_go_there_opens_what_the_next_step_is_about_and_links_open_what_they_name(page, studio):
    opened(page, studio, "?campaign=campaigns/first")
    page.locator(by("next")).click()
    page.wait_for_selector(by("state"))
    assert "campaigns%2Fsecond" in page.url
    assert page.locator(by("state")).inner_text().count("0 of 8") == 1
    opened(page, studio, "")
    page.locator(by("open-designs/good")).click()
    page.wait_for_selector("h1 >> text=Design")
    assert "thickness_mm=4.5" in page.url and "design=designs%2Fgood" in page.url
    opened(page, studio, "?campaign=campaigns/second")
    page.locator(by("open-calibrations/terminal-first")).click()
    page.wait_for_selector(by("calibration"))
    assert "campaign=campaigns%2Ffirst" in page.url


def test_a_red_design_is_named_before_the_button_and_its_mould_is_not_handed_out(page, studio):
    opened(page, studio, "mould?design=designs/red")
    page.wait_for_selector(by("red"))
    assert "The verdict of red." in page.locator(by("red")).inner_text()
    above = page.evaluate("""() => document.querySelector('[data-test="red"]').getBoundingClientRect().bottom
        < document.querySelector('[data-test="run-mould"]').getBoundingClientRect().top""")
    assert above
    assert "mould_t6" in page.locator(by("mould-of-this-pad")).inner_text()
    page.wait_for_selector(by("do-not-cast"))
    assert not page.locator(by("zip")).is_visible()
    page.locator(by("other-mould")).click()
    page.wait_for_selector(f"{by('mould-of-this-pad')} >> text=mould_t15")
    assert page.locator(by("red")).count() == 0 and page.locator(by("zip")).is_visible()
    parts = page.locator(f"{by('parts')} tr").all_inner_texts()
    assert [" ".join(one.split()) for one in parts] == [
        "All parts to turn (web page)",
        "Master STEP",
        "All drawings (dxf) DXF",
    ]
    assert page.locator(".links a").nth(1).get_attribute("href").endswith("pour_t15.pdf")
    page.locator("iframe.solid").scroll_into_view_if_needed()
    solid = page.frame_locator("iframe.solid").locator("canvas")
    solid.wait_for()
    assert solid.evaluate("(one) => one.clientHeight") > 140


def test_another_thickness_takes_the_mould_away(page, studio):
    opened(page, studio, "mould?design=designs/red")
    page.wait_for_selector(by("mould-of-this-pad"))
    page.locator(f"input{by('thickness')}").fill("15")
    page.wait_for_selector(f"{by('mould-of-this-pad')} >> text=mould_t15")
    assert page.locator(by("mould-of-this-pad")).count() == 1 and "thickness_mm=15" in page.url


def test_learn_shows_the_chosen_campaign_alone_also_from_the_terminal_and_after_a_failure(page, studio):
    root = studio[1]
    lab.calibration(root, "loop-first", "first")
    words = ["loop", "campaigns/first", "--out", "calibrations/loop-first"]
    lab.job(root, 1, "loop", words, lab.learned("calibrations/loop-first/calibration.json", "All is described."), 0)
    lab.job(root, 2, "loop", words, {}, 2, "the disk is full")
    opened(page, studio, "learn?campaign=campaigns/first")
    page.wait_for_selector(f"{by('found-loop')} {by('verdict')} >> text=All is described.")
    assert "the disk is full" in page.locator(".work .problem").first.inner_text()
    assert page.locator(by("calibration")).count() == 2
    assert page.locator(f"{by('found-loop')} {by('curves')} figure").count() == 1
    choose(page, "campaign", "campaigns/second")
    page.wait_for_function("document.querySelectorAll('[data-test=calibration]').length === 0")
    assert page.locator(by("verdict")).count() == 0 and page.locator(by("curves")).count() == 0
    choose(page, "campaign", "campaigns/first")
    page.wait_for_selector(by("calibration"))
    page.locator(by("again")).last.click()
    page.wait_for_selector("h1 >> text=Design")
    assert "calibration=calibrations%2Fterminal-first%2Fcalibration.json" in page.url


def test_a_calibration_of_a_changed_campaign_is_marked_and_can_be_deleted_and_brought_back(page, studio):
    root = studio[1]
    toml = root / "campaigns" / "first" / "campaign.toml"
    toml.write_text(toml.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    opened(page, studio, "learn?campaign=campaigns/first")
    page.wait_for_selector(by("outdated"))
    page.locator(by("delete")).click()
    page.wait_for_selector(by("undo-last"))
    assert not (root / "calibrations" / "terminal-first").exists()
    page.locator(by("undo-last")).click()
    page.wait_for_selector(by("calibration"))
    assert (root / "calibrations" / "terminal-first" / "calibration.json").is_file()


def test_a_bad_press_is_replaced_comes_back_and_others_are_refused_or_take_the_chosen_press(page, studio):
    root = studio[1]
    folder = root / "campaigns" / "first"
    names = sorted(path.name for path in folder.glob("*.csv"))
    first, second = names[0], names[1]
    before = {name: (folder / name).read_bytes() for name in names}
    opened(page, studio, "campaign?campaign=campaigns/first")
    page.wait_for_selector(by("state"))
    longer, other = before[first] + b"999.0,0.0,0.0\n", before[second] + b"999.0,0.0,0.0\n"
    drop(
        page,
        "presses",
        sent(first, longer),
        sent("run 7.csv", other),
        sent("bad.csv", "no numbers"),
        sent("image.png", b"\x89PNG"),
    )
    said = f"{by('drop-presses-said')} [data-kind=refused]"
    page.wait_for_function(f"document.querySelectorAll('{said}').length === 3")
    refused = " ".join(page.locator(said).all_inner_texts())
    assert "bad.csv" in refused and "image.png" in refused and "run 7.csv" in refused
    page.wait_for_selector(by("undo-last"))
    assert (folder / first).read_bytes() == longer
    page.locator(by("undo-last")).click()
    page.wait_for_selector(f"{by('undo')} >> text=is back")
    assert (folder / first).read_bytes() == before[first]
    page.locator(by("assign-to")).click()
    page.get_by_role("option").filter(has_text=second).click()
    drop(page, "presses", sent("run 7.csv", other))
    page.wait_for_selector(by("undo-last"))
    assert (folder / second).read_bytes() == other and not (folder / "unassigned").exists()
    assert sum(one.path.endswith(second) for one in bin.deleted(root)) == 1


def test_values_of_presses_are_written_and_refused_by_name_by_the_keyboard(page, studio):
    root = studio[1]
    opened(page, studio, "campaign?campaign=campaigns/second")
    page.wait_for_selector(by("state"))
    page.locator(f"{by('values')} .q-item").first.focus()
    page.keyboard.press("Enter")
    page.wait_for_selector(".values input")
    file = page.locator(".values tbody th").first.inner_text()
    page.locator('.values input[data-row="0"][data-key="temperature_C"]').focus()
    page.keyboard.type("21,5")
    page.keyboard.press("Tab")
    page.wait_for_selector(f"{by('values-said')} .note")
    assert trial(root, "second", file)["temperature_C"] == 21.5
    before = (root / "campaigns" / "second" / "campaign.toml").read_bytes()
    page.locator('.values input[data-row="0"][data-key="age_days"]').fill("-4")
    page.keyboard.press("Tab")
    page.wait_for_selector(f"{by('values-said')} .problem >> text=age_days")
    page.wait_for_selector('.values input[data-row="0"][data-key="age_days"][aria-invalid=true]')
    assert (root / "campaigns" / "second" / "campaign.toml").read_bytes() == before
    page.locator(by("fill-day")).click()
    page.get_by_role("option").filter(has_text="14").click()
    page.locator(f"input{by('fill-value')}").fill("23")
    page.locator(by("fill")).click()
    page.wait_for_selector(f"{by('values-said')} .note")
    with open(root / "campaigns" / "second" / "campaign.toml", "rb") as stream:
        trials = tomllib.load(stream)["trial"]
    assert {one.get("temperature_C") for one in trials if one["age_days"] == 14.0} == {23.0}
    assert [one["temperature_C"] for one in trials if one["age_days"] == 9.0 and "temperature_C" in one] == [21.5]
    # an empty field fills in nothing, and what was filled in is taken back by one click
    filled = (root / "campaigns" / "second" / "campaign.toml").read_bytes()
    page.locator(f"input{by('fill-value')}").fill("")
    page.locator(by("fill")).click()
    page.wait_for_selector(f"{by('values-said')} .problem")
    assert (root / "campaigns" / "second" / "campaign.toml").read_bytes() == filled
    page.locator(by("undo-last")).click()
    page.wait_for_selector(f"{by('undo')} >> text=is back")
    assert (root / "campaigns" / "second" / "campaign.toml").read_bytes() == before


def test_a_plan_begins_with_the_moulds_and_can_be_changed_until_a_press_is_there(page, studio):
    root = studio[1]
    opened(page, studio, "campaign?campaign=campaigns/second&thickness_mm=6&shape=slab&ratio=15")
    page.locator(f"{by('plan-new')} .q-item").first.click()
    line = page.locator(f"{by('plan-new')} .command code").inner_text()
    assert "--from-mould moulds/mould_t6,moulds/mould_t15" in line and "--pads" not in line
    # a campaign from elsewhere takes nothing of what is chosen here for its own
    page.locator(f"{by('bring-in')} .q-item").first.click()
    assert "--resin NAME --ratio R" in page.locator(f"{by('bring-in')} .command code").inner_text()
    page.locator(f"{by('replan')} .q-item").first.click()
    page.locator(f"input{by('replan-repeats')}").fill("1.5")
    page.wait_for_selector(f"{by('replan')} .note >> text=repeats = 1.5")
    page.locator(by("run-replan")).click()
    page.wait_for_selector(f"{by('replan')} .problem >> text=repeats = 1.5")
    page.locator(f"input{by('replan-repeats')}").fill("2")
    page.locator(f"input{by('replan-forces')}").fill("2,4")
    page.wait_for_function("document.querySelector('[data-test=replan] code').textContent.includes('--force 2,4')")
    page.locator(by("run-replan")).click()
    page.wait_for_selector(f"{by('found-replan')} {by('planned')}", timeout=COMMAND_MS)
    with open(root / "campaigns" / "second" / "campaign.toml", "rb") as stream:
        assert {one["target_force_N"] for one in tomllib.load(stream)["trial"]} == {2.0, 4.0}
    assert sorted(path.name for path in (root / "campaigns").iterdir() if path.name[0] != ".") == ["first", "second"]
    opened(page, studio, "campaign?campaign=campaigns/first")
    page.wait_for_selector(by("state"))
    assert page.locator(by("replan")).count() == 0


def test_a_cast_pad_is_compared_by_its_presses_and_its_record_is_kept(page, studio):
    root = studio[1]
    lab.gauged(root / "moulds" / "mould_t6", 6.0)
    opened(page, studio, "cast?thickness_mm=6&shape=slab&ratio=15")
    page.wait_for_selector(by("gauge-map"))
    assert page.locator(f"{by('gauge-map')} circle").count() == 2
    page.locator(f"input{by('gauge-middle')}").fill("6.02")
    page.locator(f"input{by('gauge-corner1')}").fill("5.97")
    page.locator(f"input{by('record-mass')}").fill("112")
    page.wait_for_selector("code >> text=middle=6.02,corner1=5.97")
    assert page.locator(f"{by('gauge-map')} g.kept").count() == 2
    page.locator(f"input{by('gauge-corner1')}").fill("5.5")
    page.wait_for_selector(f"{by('gauge-map')} g.missed >> text=2")
    page.locator(by("tab-compare")).click()
    page.wait_for_selector(by("run-compare"))
    unfold(page, "more-presses")
    press = next((root / "campaigns" / "first").glob("t06*f06*.csv"))
    drop(page, "cast", sent("mine.csv", press.read_bytes()), sent("odd.csv", "no numbers"))
    page.wait_for_selector(f"{by('drop-cast-said')} [data-kind=refused] >> text=odd.csv")
    assert (root / "measured" / "cast-pad" / "mine.csv").is_file()
    page.wait_for_selector("code >> text=measured/cast-pad/mine.csv")
    choose(page, "pad", "campaigns/first: slab, 6 mm, 4 presses")
    page.wait_for_selector("code >> text=compare campaigns/first/")
    page.locator(by("run-compare")).click()
    page.wait_for_selector(f"{by('found-compare')} {by('verdict')}", timeout=COMMAND_MS)
    assert page.locator(f"{by('found-compare')} table tbody tr").count() == 4
    advice = next_steps(jobs.latest(root, "compare").answer)[0]
    assert page.locator(by("correction")).inner_text() == full_sentence(advice)
    plots = f"{by('found-compare')} {by('compared-plots')}"
    page.wait_for_function(f"document.querySelectorAll('{plots} .js-plotly-plot').length === 3")
    curves = saved_series(page, plots)
    assert curves["dummy"] > 20 and curves["measured at the end of the hold"] == 2
    assert curves["subjects of forefinger, low"] == curves["subjects of forefinger, high"] > 1
    assert saved(page, plots, "png").startswith(b"\x89PNG")
    choose(page, "pad", "campaigns/first: slab, 15 mm, 4 presses")
    page.wait_for_function("!document.querySelector('[data-test=found-compare] [data-test=verdict]')")
    assert Path(root / "designs" / "compare-forefinger" / "report.html").is_file()


LIMITS = """schema = 1
name = "ours"
force_N = { value = 0.3, low = 0.3, high = 0.3, kind = "assumed", source = "our lab" }
pressure_N_per_cm2 = { value = 300.0, low = 300.0, high = 300.0, kind = "assumed", source = "our lab" }
transient_factor = { value = 2.0, low = 2.0, high = 2.0, kind = "assumed", source = "our lab" }
"""


def test_another_pad_of_a_campaign_has_its_own_verdict_of_a_replay(page, studio):
    root, calibration = studio[1], "calibrations/terminal-first/calibration.json"
    os.utime(root / calibration, (0, 0))  # older than the answer
    words = ["replay", "campaigns/first", "--calibration", calibration, "--tissue", "forefinger"]
    pads = [{"thickness_mm": mm, "verdict": {"light": "green", "text": f"That of {mm:g} mm."}} for mm in (6.0, 15.0)]
    answer = {"holds": True, "rmse_N": 0.1, "base_rmse_N": 0.2, "pads": pads, "trials": []}
    lab.job(root, 1, "replay", words, answer, 0)
    chosen = f"thickness_mm=6&ratio=15&campaign=campaigns/first&calibration={calibration}"
    opened(page, studio, f"cast?tissue=forefinger&shape=slab&{chosen}&cast_tab=compare")
    unfold(page, "model")
    page.wait_for_selector(f"{by('found-replay')} >> text=That of 6 mm.")
    choose(page, "pad", "campaigns/first: slab, 15 mm, 4 presses")
    page.wait_for_selector(f"{by('found-replay')} >> text=That of 15 mm.")


def test_presses_of_a_pad_are_put_on_people_by_a_drive_and_limits_of_ones_own(page, studio):
    root = studio[1]
    opened(page, studio, "cast?thickness_mm=6&shape=slab&ratio=15&cast_tab=compare")
    page.wait_for_selector(by("run-compare"))
    choose(page, "pad", "campaigns/first: slab, 6 mm, 4 presses")
    page.locator(by("tab-people")).click()
    page.wait_for_selector("code >> text=on-person")
    choose(page, "drive", "mass: a free body")
    unfold(page, "own-limits")
    assert not page.locator(f"input{by('drive-stiffness')}").is_visible()
    page.wait_for_selector("text=type mass in kg")
    page.locator(f"input{by('drive-mass')}").fill("4")
    drop(
        page,
        "limits",
        {"name": "ours.toml", "mimeType": "text/plain", "buffer": LIMITS.encode()},
        {"name": "bad.toml", "mimeType": "text/plain", "buffer": b"name = 'bad'"},
    )
    page.wait_for_selector(f"{by('drop-limits-said')} [data-kind=refused] >> text=bad.toml")
    page.wait_for_selector(f"{by('drop-limits-said')} [data-kind=taken] >> text=ours.toml")
    assert [path.name for path in (root / "limits").iterdir()] == ["ours.toml"]
    page.wait_for_selector("code >> text=--drive mass:4 --limits limits/ours.toml")
    page.locator(by("run-on-person")).click()
    page.wait_for_selector(f"{by('found-on-person')} {by('people')}", timeout=COMMAND_MS)
    assert page.locator(f"{by('found-on-person')} .verdict.red").count() == 1
    assert page.locator(f"{by('found-on-person')} table").nth(0).locator("tbody tr").count() == 4
    folder = root / "designs" / "on-person-forefinger"
    assert (folder / "report.html").is_file()
    choose(page, "drive", "force: the arm keeps its force")
    page.wait_for_function("!document.querySelector('[data-test=found-on-person] [data-test=people]')")
