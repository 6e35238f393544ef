"""What a person sees on the pages of a half-way project, by real clicks: verdicts, warnings, sizes, typed numbers."""

from __future__ import annotations

import re

import pytest

from dummydesign.loop.calibration_file import write_calibration
from tests.support import lab_project as lab
from tests.support.made_calibration import calibration
from tests.support.studio import choose, opened, settled
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow
SETTLED = '[data-test="verdict"] .verdict[data-state="settled"]'
PAD = "design?tissue=forefinger&shape=crowned:radius=20,height=2,foot=9&thickness_mm=4.5&ratio=15"


def test_the_verdict_of_a_pad_is_its_designs_and_an_estimate_is_called_one(page, studio):
    opened(page, studio, PAD)
    page.wait_for_selector(SETTLED)
    assert "The verdict of good." in page.locator(SETTLED).inner_text()
    assert "Estimate" not in page.locator(SETTLED).inner_text()
    page.locator(f"{by('slide-ratio')} [tabindex]").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("document.querySelector('small.label').textContent.includes('ratio 15.05')")
    page.wait_for_selector(SETTLED)
    assert "Estimate" in page.locator(SETTLED).inner_text()


def test_a_calibration_of_another_resin_is_warned_of_on_the_design_page(page, studio):
    file = studio[1] / "calibrations" / "other" / "calibration.json"
    file.parent.mkdir()
    write_calibration(calibration(pad={"resin": "ecoflex-0030", "ratio": 15.0}), file)
    query = f"&ratio=15&calibration={file.relative_to(studio[1]).as_posix()}"
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6" + query)
    page.wait_for_selector(f"{SETTLED}, .verdict[data-state=refused]")
    assert "pads of ecoflex-0030" in page.locator(f"{by('numbers')} .warnings").inner_text()


def test_a_mould_is_shown_once_when_its_page_is_opened_again(page, studio):
    words = [
        "mold",
        "--thickness",
        "6",
        "--preset",
        "open",
        "--resin",
        lab.RESIN,
        "--ratio",
        "15",
        "--out",
        "moulds/mould_t6",
    ]
    files = {"a": "moulds/mould_t6/master_t6.step"}
    lab.job(
        studio[1],
        1,
        "mould",
        words,
        {"inputs": {"ratio": 15.0}, **lab.weighed({"name": "polyol", "mass_g": 61.0}), "files": files},
        0,
    )
    for _ in range(2):
        opened(page, studio, "mould?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
        page.wait_for_selector(f"{by('found-mould')} {by('do-not-cast')}")
        assert page.locator("h2 >> text=moulds/mould_t6").count() == 1
        assert page.locator(by("mould-of-this-pad")).count() == 0
    page.locator(f"input{by('thickness')}").fill("15")
    page.wait_for_selector(f"{by('mould-of-this-pad')} >> text=moulds/mould_t15")
    page.locator(f"input{by('thickness')}").fill("6")
    page.wait_for_selector(f"{by('found-mould')} {by('do-not-cast')}")
    page.wait_for_selector(by("mould-of-this-pad"), state="detached")
    assert page.locator("h2 >> text=moulds/mould_t6").count() == 1


def test_a_record_is_shown_for_its_own_readings_alone_and_typed_ones_outlive_a_reload(page, studio):
    root = studio[1]
    lab.gauged(root / "moulds" / "mould_t6", 6.0)
    words = ["mold", "record", "moulds/mould_t6", "--thickness", "middle=6.02,corner1=6", "--mass", "112"]
    limit = {"what": "thickness", "value": 6.02, "unit": "mm", "low": 5.82, "high": 6.18, "missed": False}
    lab.job(root, 1, "record", words, {"accepted": True, "missed": [], "limits": [limit]}, 0)
    gauge, mass, shown = f"input{by('gauge-middle')}", f"input{by('record-mass')}", f"{by('found-record')} .green"
    opened(page, studio, "cast?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
    page.locator(f"input{by('gauge-corner1')}").fill("6")
    page.locator(gauge).fill("6,02")
    page.locator(mass).fill("112")
    page.wait_for_selector(shown)
    page.locator(gauge).fill("7.9")
    page.wait_for_selector(shown, state="detached")
    page.wait_for_function("location.search.includes('7.9')")
    page.reload()
    page.wait_for_selector("h1")
    assert page.locator(gauge).input_value() == "7.9" and page.locator(mass).input_value() == "112"
    assert page.locator(shown).count() == 0


def test_a_typed_number_counts_once_it_is_typed_to_its_end_and_is_never_cut_in_silence(page, studio):
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
    page.wait_for_selector(SETTLED)
    field = page.locator(by("number-thickness"))
    for keys, then, said in (
        ("7,5", "7.5", ""),
        ("100", "7.5", "100 is not allowed: 3 to 30"),
        ("8.4", "8.4", ""),
        ("soft", "8.4", "soft is not allowed"),
        ("8.43", "8.43", ""),
    ):
        field.select_text()  # an emptied field would be filled again meanwhile
        field.press_sequentially(keys)
        field.press("Enter")
        page.wait_for_function(f"document.querySelector('[data-test=number-thickness]').value === '{then}'")
        page.wait_for_function(
            "(said) => document.querySelector('.slider [role=status]').innerText.includes(said)", arg=said
        )
        page.wait_for_function(f"document.querySelector('small.label').textContent.includes('slab, {then} mm')")
    opened(page, studio, "mould?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
    thickness = page.locator(f"input{by('thickness')}")
    thickness.fill("100")
    thickness.press("Tab")
    page.wait_for_selector(".q-field__messages >> text=outside the allowed range 3 to 30")
    assert thickness.input_value() == "100"
    thickness.fill("7,5")
    page.wait_for_selector(".command code >> text=--thickness 7.5")


def test_a_number_that_is_being_typed_is_left_alone_when_the_verdict_settles(page, studio):
    opened(page, studio, "design?tissue=forefinger&shape=slab&thickness_mm=6&ratio=15")
    page.wait_for_selector(SETTLED)
    page.locator(by("number-ratio")).fill("15.5")
    thickness = page.locator(by("number-thickness"))
    thickness.select_text()
    thickness.press_sequentially("8")
    page.wait_for_selector(f"{SETTLED} >> text=ratio 15.5")
    assert thickness.input_value() == "8"
    thickness.press("Enter")
    page.wait_for_selector(f"{SETTLED} >> text=slab, 8 mm, ratio 15.5")


MAIN = {
    "": ("newest", "next", "steps"),
    "measured": ("run-import",),
    "tissue": ("use", "tissue-shown"),
    "design": ("verdict", "run-suggest", "plots"),
    "mould": ("red", "run-mould"),
    "cast": ("gauge-map", "run-record"),
    "cast?cast_tab=compare": ("run-compare",),
    "cast?cast_tab=people": ("run-on-person",),
    "campaign?campaign=campaigns/first": ("state", "learn"),
    "learn": ("run-loop",),
    "resin": ("run-ring",),
}


@pytest.mark.parametrize(("width", "height", "screens"), [(1280, 800, 1), (390, 844, 2)])
def test_the_answer_and_the_next_button_of_a_page_are_in_sight_and_no_page_is_long(
    page, studio, width, height, screens
):
    lab.gauged(studio[1] / "moulds" / "mould_t6", 6.0)
    page.set_viewport_size({"width": width, "height": height})
    for path, wanted in MAIN.items():
        opened(page, studio, path)
        page.wait_for_selector(by(wanted[0]))
        settled(page)
        shown = page.locator("body").inner_text()
        assert not re.search("<(div|figure|span|p|table)[ >]", shown), (path, shown)  # HTML that was escaped
        for test in wanted:
            page.wait_for_selector(by(test))
            box = page.locator(by(test)).first.bounding_box()
            # of a plot on a telephone the beginning: it is read by scrolling
            end = box["y"] + (40 if test == "tissue-shown" or (test == "plots" and width < 800) else box["height"])
            assert box["y"] >= 0 and end <= screens * height, (path, test, box)
        wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0, path
        long = page.evaluate("document.documentElement.scrollHeight")
        assert long <= 3 * height, (path, long)


def test_axe_finds_no_fault_on_any_page_nor_in_any_tab(page, studio):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="pip install axe-playwright-python").Axe()
    lab.gauged(studio[1] / "moulds" / "mould_t6", 6.0)
    for path in MAIN:
        opened(page, studio, path)
        page.wait_for_selector(by(MAIN[path][0]))
        settled(page)
        faults = axe.run(page).response["violations"]
        told = [(one["id"], one["nodes"][0]["html"][:200]) for one in faults]
        assert told == [], (path, told)


def test_a_drop_of_many_files_keeps_the_button_in_sight_and_a_page_is_refused(page, studio):
    opened(page, studio, "measured")
    rows = "time_s,displacement_mm,force_N\n0,0,{}\n"
    files = [{"name": f"press{k}.csv", "mimeType": "text/csv", "buffer": rows.format(k).encode()} for k in range(37)]
    other = {"name": "page.html", "mimeType": "text/html", "buffer": b"<p>"}
    page.locator("input[type=file]").set_input_files([*files, other])
    page.wait_for_selector("summary >> text=37 files were taken")
    refused = page.locator(f"{by('drop-measured-said')} [data-kind=refused]")
    assert "page.html" in refused.inner_text() and ".csv" in refused.inner_text()
    assert not (studio[1] / "measured" / "page.html").exists()
    box = page.locator(by("run-import")).bounding_box()
    assert box["y"] + box["height"] <= 800


RING = (
    "(() => { const s = getComputedStyle(document.activeElement);"
    "return (s.outlineStyle === 'solid' && parseFloat(s.outlineWidth) >= 2)"
    "|| s.boxShadow.includes('0px 0px 0px 5px'); })()"
)


def test_what_has_the_focus_is_seen(page, studio):
    for path, test in (("measured", "run-import"), ("design", "run-suggest"), ("tissue", "use"), ("", "next")):
        opened(page, studio, path)
        page.locator(by(test)).focus()
        page.keyboard.press("Shift+Tab")
        page.keyboard.press("Tab")
        page.wait_for_function("(one) => document.activeElement.matches(one)", arg=by(test))
        page.wait_for_function(RING)
        assert page.evaluate("(one) => document.activeElement.matches(one)", by(test)), test
        assert page.evaluate(RING), test


def test_numbers_that_must_not_be_used_stand_under_a_red_light(page, studio):
    words = [
        "on-person",
        "measured/cast-pad/a.csv",
        "--tissue",
        "forefinger",
        "--drive",
        "position",
        "--punch",
        "square:14",
        "--out",
        "designs/on-person-forefinger",
    ]
    folder = studio[1] / "measured" / "cast-pad"
    folder.mkdir(parents=True)
    (folder / "a.csv").write_text("time_s,displacement_mm,force_N\n0,0,0\n1,1,1\n2,2,2\n", encoding="utf-8")
    span = [1.0, 2.0]
    keys = ("peak_force_N", "depth_mm", "steady_force_N", "energy_mJ", "velocity_mm_s", "impulse_Ns", "hold_s")
    one = {
        "file": "a.csv",
        "drive_contradicted": None,
        "beyond_range": [{"value": 100.0, "pressed_to": 15.0, "text": "100 N, people were pressed to 15 N"}],
        "factor_peak": span,
        "factor_peak_95": span,
        "pad": dict.fromkeys(keys, 1.0),
        "band": dict.fromkeys(keys, span),
        "interval_95": dict.fromkeys(keys, span),
        "limits": [],
        "subjects": [1],
    }
    lab.job(studio[1], 1, "on-person", words, {"presses": [one], "warnings": [], "drive": "position"}, 0)
    opened(page, studio, "cast?tissue=forefinger&shape=layered:4,0.6&thickness_mm=9&ratio=15&cast_tab=compare")
    choose(page, "pad", "files dropped here: 1 press")
    page.locator(by("tab-people")).click()
    page.wait_for_selector(f"{by('people')}.red >> text=Do not use these numbers")
