"""By real clicks: light, button and mould are those of the pad that is seen; what is stale is marked."""

from __future__ import annotations

import json
import time

import pytest

from dummydesign.core.files import acquire_lock
from dummydesign.core.user_library import find
from dummydesign.project.folder import change_project, make_project, read_project
from dummydesign.studio import job_process as runner
from dummydesign.studio import jobs
from tests.support import lab_project as lab
from tests.support.studio import browser, choose, opened, running, saved, settled, unfold
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow
SETTLED = '[data-test="verdict"] .verdict[data-state="settled"]'
BLUE = """() => [...document.querySelectorAll('.q-btn.bg-primary, a.go:not(.more)')]
    .filter((one) => one.offsetParent).map((one) => one.innerText.trim())"""


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    base = tmp_path_factory.mktemp("seen-pad")
    root = make_project(base / "palm", tissue="palm").root
    lab.design(root, "older", "slab", 12.0, "usable_with_correction", "2026-01-01")
    lab.mould(root, "mould_t12", 12.0)
    with running(root, base / "home") as found:
        yield found, root


@pytest.fixture
def page(studio):
    with browser(viewport={"width": 1280, "height": 900}) as found:
        found.set_default_timeout(240_000)
        found.goto(studio[0].address)
        found.wait_for_selector("h1")
        yield found
        assert found.broken == [] and found.outside == []


def design(page, studio, query):
    page.goto(f"{studio[0].home}design?tissue=palm&{query}")
    page.wait_for_selector(SETTLED)
    page.wait_for_selector(f"{by('next-of-pad')} {by('mould')}")


def test_the_light_is_that_of_the_ratio_of_the_slider(page, studio):
    for ratio in ("14", "17"):
        design(page, studio, f"shape=crowned:2.4,3.5,7.8&thickness_mm=11&ratio={ratio}")
        shown = page.locator(f"{by('verdict')} .verdict")
        assert "red" in shown.get_attribute("class").split()
        assert "100 % of an average batch" not in shown.inner_text()


def test_the_blue_button_solves_the_pad_that_is_seen_and_its_mould_has_its_ratio(page, studio):
    design(page, studio, "shape=slab&thickness_mm=11.3&ratio=15.15")
    assert page.evaluate(BLUE) == ["Solve this pad"]
    assert "Estimate" in page.locator(by("verdict")).inner_text()
    page.locator(by("run-pad")).click()
    page.wait_for_function("!document.querySelector('[data-test=verdict]').innerText.includes('Estimate')")
    page.wait_for_selector(SETTLED)
    job = jobs.latest(studio[1], "pad")
    best = job.answer["recommendation"]
    assert (best["shape"], best["thickness_mm"], best["ratio"]) == ("slab", 11.3, 15.15)
    shown = page.locator(f"{by('verdict')} .verdict")
    assert job.answer["verdict"]["light"] in shown.get_attribute("class").split()
    assert job.answer["verdict"]["text"] in page.locator(f"{by('verdict')} p").inner_text()
    page.locator(f"{by('next-of-pad')} {by('mould')}").click()
    page.wait_for_selector("h1 >> text=Mould")
    line = page.locator(f"{by('run-mould')} ~ div .command code, .work .command code").first.inner_text()
    assert "--thickness 11.3" in line and "--ratio 15.15" in line and "--shape" not in line


def test_a_pad_that_a_puck_settles_leads_to_the_puck_on_all_pages(page, studio):
    root = studio[1]
    lab.design(root, "open", "slab", 9.0, "not_settled", "2027-01-01")
    kept = json.loads((root / "designs" / "open" / "manifest.json").read_text())
    kept["inputs"]["tissue"] = "palm"
    (root / "designs" / "open" / "manifest.json").write_text(json.dumps(kept))
    design(page, studio, "shape=slab&thickness_mm=9&ratio=15&design=designs/open")
    assert page.evaluate(BLUE) == ["Measure one puck first"]
    page.goto(studio[0].home)
    page.wait_for_selector(by("next"))
    assert "puck" in page.locator(by("next")).inner_text().lower()
    page.locator(by("next")).click()
    page.wait_for_selector("h1 >> text=Puck")
    assert "Puck" in page.locator("nav [aria-current]").inner_text()


def test_a_punch_from_outside_the_project_is_refused_in_address_and_field(page, studio):
    design(page, studio, "shape=slab&thickness_mm=9&ratio=15&punch=profile:/etc/passwd")
    assert "square:14" in page.locator("small.label").inner_text()
    unfold(page, "question")
    page.locator(f"input{by('punch')}").fill("profile:/etc/passwd")
    page.locator(f"input{by('punch')}").press("Enter")
    page.wait_for_selector('[data-test="verdict"] .verdict[data-state="refused"] >> text=not a file of this project')


def test_what_was_judged_for_another_tissue_or_an_older_resin_is_marked(page, studio, tmp_path):
    root = studio[1]
    page.goto(studio[0].home)
    page.wait_for_selector(by("newest"))
    resin = find("materials/resins", "resin", lab.RESIN).path
    folder = root / "designs" / "newest"
    lab.design(root, "newest", "slab", 12.0, "usable_with_correction", "2027-02-01")
    for path, inputs in ((folder, {"tissue": "palm"}), (root / "moulds" / "mould_t12", {})):
        kept = json.loads((path / "manifest.json").read_text())
        kept["inputs"] |= inputs
        kept["files_read"] = [{"name": f"resin {lab.RESIN}", "file": resin.name, "sha256": "0" * 64}]
        (path / "manifest.json").write_text(json.dumps(kept))
    page.reload()
    page.wait_for_selector(f".verdict.grey{by('newest')}")
    assert "has changed since" in page.locator(".body .problem").first.inner_text()
    page.goto(f"{studio[0].home}mould?shape=slab&thickness_mm=12&ratio=15&tissue=palm")
    page.wait_for_selector(".problem >> text=Make the mould again")
    change_project(read_project(root), tissue="forefinger")
    page.goto(studio[0].home)
    page.wait_for_selector(".problem >> text=judged for palm")
    change_project(read_project(root), tissue="palm")


def test_a_search_of_another_question_is_not_shown_as_ones_own(page, studio):
    root = studio[1]
    folder = root / ".studio" / "jobs" / "0900-suggest"
    folder.mkdir(parents=True)
    words = ["suggest", "--tissue", "thenar", "--aim", "average", "--resin", lab.RESIN, "--punch", "square:14"]
    asked = {"name": "suggest", "words": words, "cwd": str(root), "start": time.time()}
    (folder / runner.COMMAND).write_text(json.dumps(asked))
    with acquire_lock(folder / runner.LOCK):
        design(page, studio, "shape=slab&thickness_mm=9&ratio=15")
        page.wait_for_selector(".work [role=status] >> text=another choice")
        assert page.locator(by("stop-suggest")).inner_text() == "Stop the other one"


def test_every_large_plot_is_saved_as_picture_and_values(page, studio):
    design(page, studio, "shape=slab&thickness_mm=9&ratio=15")
    lines = saved(page, by("plots"), "csv").decode("utf-8").splitlines()
    assert lines[0] == '"series","depth [mm]","steady force [N]"'
    pad = [line.split(",") for line in lines if line.startswith('"this pad"')]
    assert len(pad) > 20 and all(float(force) >= 0.0 for *_, force in pad)
    assert saved(page, by("plots"), "png").startswith(b"\x89PNG")


def test_a_project_without_a_tissue_chooses_none(page, tmp_path):
    root = make_project(tmp_path / "none").root
    with running(root, tmp_path / "home") as found:
        page.goto(found.address)
        page.wait_for_selector(by("next"))
        assert "project.toml" not in page.locator(by("next")).inner_text()
        page.goto(f"{found.home}design")
        page.wait_for_selector(".problem >> text=No tissue is chosen")
        page.wait_for_selector(by("tissue"))
        choose(page, "tissue", "palm (built-in)")
        page.wait_for_selector(SETTLED)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_words_of_every_button_have_contrast(studio, scheme):
    contrast = """() => {
      const linear = (c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
      const light = (rgb) => rgb.map((one) => linear(one / 255))
        .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
      const behind = (one) => { for (; one; one = one.parentElement) {
        const [r, g, b, a = 1] = getComputedStyle(one).backgroundColor.match(/[\\d.]+/g).map(Number);
        if (a > 0.9) return [r, g, b]; } return [255, 255, 255]; };
      return [...document.querySelectorAll('.q-btn, a.go')].filter((one) => one.offsetParent).map((one) => {
        const pair = [getComputedStyle(one).color.match(/[\\d.]+/g).map(Number).slice(0, 3), behind(one)].map(light);
        return [one.innerText, (Math.max(...pair) + 0.05) / (Math.min(...pair) + 0.05)]; }); }"""
    with browser(viewport={"width": 1280, "height": 900}, color_scheme=scheme) as page:
        page.goto(studio[0].address)
        page.wait_for_selector("h1")
        for path in ("design?tissue=palm&shape=slab&thickness_mm=9&ratio=15", "mould", "learn", "campaign"):
            opened(page, studio, path)
            settled(page)
            low = [one for one in page.evaluate(contrast) if one[1] < 4.5]
            assert low == [], (path, low)
