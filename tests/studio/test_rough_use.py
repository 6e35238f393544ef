"""The pages under rough hands: nothing is shown that does not belong to what is chosen."""

from __future__ import annotations

import json
import shutil

import pytest

from dummydesign.core.user_library import find
from dummydesign.project.folder import change_project, read_project
from dummydesign.studio import jobs
from tests.support import lab_project as lab
from tests.support.studio import COMMAND_MS, choose, opened, saved, saved_series, unfold
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow
SETTLED = '[data-test="verdict"] .verdict[data-state="settled"]'
REFUSED = '[data-test="verdict"] .verdict[data-state="refused"]'
ODD = 'a "b" #1 %日本 <b>'


def gone(page, selector):
    page.wait_for_function("(one) => document.querySelectorAll(one).length === 0", arg=selector)


def test_a_search_is_shown_while_its_tissue_and_its_folder_are_what_they_were(page, studio):
    root, problems = studio[1], f"{by('found-suggest')} .problem"
    own = root / "tissue" / f"{ODD}.toml"
    shutil.copy(find("materials/tissues", "tissue", "forefinger").path, own)
    opened(page, studio, "tissue")
    choose(page, "tissue", f"tissue/{ODD}.toml")
    page.locator(by("use")).click()
    page.wait_for_selector(SETTLED)
    assert read_project(root).tissue == f"tissue/{ODD}.toml"
    choose(page, "searched", "slab")
    page.locator(by("run-suggest")).click()
    shown = f"{by('found-suggest')} {by('why')}"
    page.wait_for_selector(shown, timeout=COMMAND_MS)
    answer = jobs.latest(root, "suggest").answer
    folder = root / "designs" / answer["inputs"]["out"].rpartition("/")[2]
    assert answer["inputs"]["tissue"] == f"tissue/{ODD}.toml" and folder.is_dir()
    # its verdict is red; nothing is said of what changed
    assert answer["verdict"]["light"] == "red"
    assert ["do not cast" in one for one in page.locator(problems).all_inner_texts()] == [True]
    own.write_text(own.read_text(encoding="utf-8") + "\n# another day\n", encoding="utf-8")
    page.wait_for_function("(one) => document.querySelectorAll(one).length === 2", arg=problems)
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    other = manifest | {"inputs": manifest["inputs"] | {"aim": "safe-side"}}
    (folder / "manifest.json").write_text(json.dumps(other), encoding="utf-8")
    gone(page, shown)
    (folder / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    page.wait_for_selector(shown)
    folder.rename(folder.with_name("by hand"))
    gone(page, shown)


def test_the_verdict_follows_a_tissue_that_changes_on_the_disk(page, studio):
    own = studio[1] / "tissue" / "own.toml"
    text = find("materials/tissues", "tissue", "forefinger").path.read_text(encoding="utf-8")
    own.write_text(text, encoding="utf-8")
    opened(page, studio, "design?tissue=tissue/own.toml&shape=slab&thickness_mm=6&ratio=15")
    page.wait_for_selector(SETTLED)
    own.write_text("damaged", encoding="utf-8")
    page.wait_for_selector(REFUSED)
    assert page.locator(f"{by('plots')} figure").count() == 0
    own.write_text(text, encoding="utf-8")
    page.wait_for_selector(SETTLED)


def test_a_failure_is_said_for_the_tissue_it_was_for_alone(page, studio):
    words = [
        "suggest",
        "--tissue",
        "forefinger",
        "--aim",
        "average",
        "--resin",
        lab.RESIN,
        "--punch",
        "square:14",
        "--shape",
        "slab",
        "--no-cad",
        "--out",
        "designs/suggest-forefinger",
    ]
    lab.job(studio[1], 1, "suggest", words, {}, 2, "the disk is full")
    opened(page, studio, "design?tissue=forefinger")
    page.wait_for_selector(".work .problem >> text=the disk is full")
    unfold(page, "question")
    choose(page, "tissue", "palm (built-in)")
    gone(page, ".work .problem")


def test_a_design_is_deleted_and_brought_back_on_the_design_page(page, studio):
    root = studio[1]
    opened(page, studio, "design?design=designs/good")
    page.wait_for_selector(SETTLED)
    unfold(page, "earlier")
    label = page.locator("small.label").inner_text()
    page.locator(by("designs")).locator(by("delete")).last.click()
    page.wait_for_function("!location.search.includes('design=')")
    page.wait_for_selector(SETTLED)
    assert page.locator("small.label").inner_text() == label and page.locator(by("design")).count() == 1
    page.locator(by("undo-last")).click()
    page.wait_for_function("document.querySelectorAll('[data-test=design]').length === 2")
    assert (root / "designs" / "good" / "manifest.json").is_file()


def test_the_designs_that_are_chosen_are_drawn_over_each_other(page, studio):
    root = studio[1]
    for name, soft in (("good", 1.0), ("red", 2.0)):
        people = {"force_N": [5.0, 10.0], "depth_low_mm": [1.0, 2.0], "depth_high_mm": [2.0, 3.0]}
        curve = {"force_N": [1.0, 5.0, 10.0], "depth_mm": [0.5 * soft, 1.0 * soft, 2.0 * soft], "subjects": people}
        answer = {"inputs": {"tissue": "forefinger"}, "steady_curve": curve}
        (root / "designs" / name / "suggest.json").write_text(json.dumps(answer), encoding="utf-8")
    opened(page, studio, "design?design=designs/good")
    unfold(page, "earlier")
    drawn = f"{by('compared')} .js-plotly-plot"
    page.wait_for_selector(drawn)
    assert saved_series(page, by("compared")) == {"good": 3, "red": 3} | {
        f"subjects of forefinger, {end}": 2 for end in ("low", "high")
    }
    assert saved(page, by("compared"), "png").startswith(b"\x89PNG")
    choose(page, "to-compare", "designs/good")
    page.keyboard.press("Escape")
    gone(page, drawn)


def test_a_missing_tissue_gives_way_to_one_that_is_chosen(page, studio):
    opened(page, studio, "design?tissue=tissue/gone.toml")
    page.wait_for_selector(REFUSED)
    choose(page, "tissue", "palm (built-in)")
    page.wait_for_selector(SETTLED)
    assert "palm" in page.locator("small.label").inner_text() and page.locator(".problem").count() == 0


def test_a_missing_campaign_does_not_refuse_the_pad(page, studio):
    opened(page, studio, "design?campaign=campaigns/gone")
    page.wait_for_selector(SETTLED)
    assert "campaigns/gone" in page.locator(".problem").inner_text()


def test_a_number_that_is_not_allowed_gives_way_to_the_one_in_use(page, studio):
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
    page.wait_for_selector(SETTLED)
    for typed in ("-4", "", "1e3"):
        page.locator(by("number-thickness")).fill(typed)
        page.locator(by("number-ratio")).focus()
        page.wait_for_function("document.querySelector('[data-test=number-thickness]').value === '6'")
        assert "6 mm" in page.locator("small.label").inner_text()
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6&ratio=40")
    page.wait_for_selector(".slider [role=status] >> text=40")


def test_a_mould_in_a_folder_that_another_one_took_is_not_shown(page, studio):
    root = studio[1]
    words = [
        "mold",
        "--thickness",
        "6",
        "--preset",
        "open",
        "--resin",
        lab.RESIN,
        "--ratio",
        "16",
        "--out",
        "moulds/mould_t6",
    ]
    part = {"name": "polyol", "mass_g": 61.0}
    answer = {"inputs": {"ratio": 16.0, "thickness_mm": 6.0}, **lab.weighed(part)}
    answer["files"] = {"a": "moulds/mould_t6/a.step"}
    lab.job(root, 1, "mould", words, answer, 0)
    opened(page, studio, "mould?shape=slab&thickness_mm=6&ratio=16")
    page.wait_for_selector(f"{by('other-mould')} >> nth=0")
    assert page.locator(f"{by('found-mould')} {by('zip')}").count() == 0


@pytest.mark.parametrize("width", [1280, 390])
def test_a_solid_fits_into_its_frame(page, studio, width):
    page.set_viewport_size({"width": width, "height": 900})
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
    page.get_by_text("The pad as a solid, to turn").click()
    page.locator("iframe.solid").scroll_into_view_if_needed()
    frame = page.frame_locator("iframe.solid").locator("canvas")
    frame.wait_for()
    bottom, inner, whole = frame.evaluate(
        "(one) => [one.getBoundingClientRect().bottom, innerHeight, document.documentElement.scrollHeight]"
    )
    assert bottom <= inner and whole <= inner and frame.evaluate("(one) => one.clientHeight") > 140


def test_none_as_calibration_survives_a_reload_where_the_project_names_one(page, studio):
    file = "calibrations/terminal-first/calibration.json"
    change_project(read_project(studio[1]), calibration=file)
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6")
    page.wait_for_selector(f"{REFUSED}, {SETTLED}")
    unfold(page, "question")
    choose(page, "calibration", "none")
    page.wait_for_selector(SETTLED)
    page.reload()
    page.wait_for_selector(SETTLED)
    assert "calibration" not in page.locator("small.label").inner_text()
