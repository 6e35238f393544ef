"""The page of the tissue in Chromium: what was fitted is what is shown, chosen and used; people; mistakes."""

from __future__ import annotations

import json
import shutil
import time

import pytest

from dummydesign.core.files import acquire_lock
from dummydesign.project.folder import change_project, make_project, read_project
from dummydesign.studio import job_process as runner
from dummydesign.tissue import load_tissue
from tests.studio.test_measured import drop, visit, wait_for_chips
from tests.studio.test_pages import NAMELESS, RULES
from tests.support.studio import COMMAND_MS, browser, running
from tests.support.studio import test_id as by
from tests.support.two_people import STIFFER, write_people

pytestmark = pytest.mark.slow
LONG_MS = 120_000


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    """A studio with the presses of two people in an import."""
    base = tmp_path_factory.mktemp("tissue")
    files = write_people(base)
    root = make_project(base / "thumb", tissue="forefinger").root
    with running(root, base / "home") as found:
        with browser() as page:
            page.goto(found.address)
            visit(page, f"{found.home}measured")
            drop(page, *files)
            wait_for_chips(page, *(path.name for path in files))
            page.locator(by("run-import")).click()
            page.wait_for_selector(f"{by('found-import')} iframe", timeout=LONG_MS)
        yield found, root, base / "home"


@pytest.fixture
def page(studio):
    found, root, home = studio
    for folder in (root / "tissue", root / ".studio" / "bin", home / "materials"):
        shutil.rmtree(folder, ignore_errors=True)
    (root / "tissue").mkdir()
    change_project(read_project(root), tissue="forefinger")
    for folder in (root / ".studio" / "jobs").glob("*-*"):
        if not folder.name.endswith("-import"):
            shutil.rmtree(folder)
    with browser(viewport={"width": 1280, "height": 900}) as opened:
        opened.set_default_timeout(LONG_MS)
        opened.goto(found.address)
        visit(opened, f"{found.home}tissue")
        yield opened
        assert opened.broken == [] and opened.outside == []


def fit_anna(page, name="anna"):
    page.wait_for_selector(by("traces"))
    # presses of several people: none is chosen before
    page.locator(by("traces")).click()
    options = page.get_by_role("option").filter(has_text="anna")
    for number in range(2):
        options.nth(number).click()
    page.wait_for_function("document.querySelectorAll('.q-chip').length === 2")
    page.keyboard.press("Escape")
    page.locator(f"input{by('fit-name')}").fill(name)
    page.wait_for_selector(f".command code >> text=tissue/{name}.toml")
    page.locator(by("run-fit")).click()
    page.wait_for_selector(f"{by('found-fit')} div.plot", timeout=COMMAND_MS)


def test_the_fitted_tissue_is_chosen_shown_kept_and_used(page, studio):
    _, root, _ = studio
    fit_anna(page)
    for _ in range(2):  # at once, and after a reload
        page.wait_for_selector(f"{by('tissue')} >> text=tissue/anna.toml")
        assert (
            page.locator(f"{by('tissue-shown')} .command code").inner_text()
            == "dummydesign tissues show tissue/anna.toml"
        )
        assert page.locator(f"{by('found-fit')} p b").first.inner_text() == "tissue/anna.toml"
        assert page.locator(f"{by('found-fit')} div.plot").count() == 2
        page.reload()
        page.wait_for_selector(f"{by('found-fit')} div.plot")
    assert read_project(root).tissue == "forefinger"
    page.locator(by("use")).click()
    page.wait_for_url("**/design?**")
    assert "tissue=tissue%2Fanna.toml" in page.url and read_project(root).tissue == "tissue/anna.toml"


def test_the_result_goes_with_its_presses_and_name_and_has_a_button_of_its_own(page, studio):
    found, root, _ = studio
    fit_anna(page)
    page.locator(f"input{by('fit-name')}").fill("other")
    page.wait_for_selector(f"{by('found-fit')} div.plot", state="detached")
    page.locator(f"input{by('fit-name')}").fill("anna")
    page.wait_for_selector(f"{by('found-fit')} div.plot")
    # another tissue is chosen above: the button of the result still takes the fitted one
    page.locator(by("tissue")).click()
    page.get_by_role("option", name="palm (built-in)", exact=True).click()
    page.wait_for_selector(".command code >> text=show palm")
    page.locator(by("use-fitted")).click()
    page.wait_for_url("**/design?**")
    assert read_project(root).tissue == "tissue/anna.toml"
    # from another page: the chosen tissue's fit is there again
    page.goto(f"{found.home}tissue")
    page.wait_for_selector(f"{by('found-fit')} div.plot")


def test_a_deleted_tissue_stays_chosen_and_comes_back(page, studio):
    _, root, _ = studio
    fit_anna(page)
    page.locator(by("use")).click()
    page.wait_for_url("**/design?**")
    page.go_back()
    page.wait_for_selector(by("delete"))
    page.locator(by("delete")).click()
    page.wait_for_selector(f"{by('tissue')} >> text=tissue/anna.toml (missing)")
    assert list((root / "tissue").iterdir()) == [] and read_project(root).tissue == "tissue/anna.toml"
    gone = ".problem >> text='tissue/anna.toml' is not there"
    page.wait_for_selector(gone)
    page.evaluate("window.before = true")
    page.locator(by("use")).click()
    page.wait_for_function("window.before === undefined")
    page.wait_for_selector(gone)
    assert page.locator(".problem").count() == 1 and read_project(root).tissue == "tissue/anna.toml"
    page.reload()
    page.wait_for_selector(f"{by('tissue')} >> text=tissue/anna.toml (missing)")
    assert "tissue=tissue%2Fanna.toml" in page.url
    page.locator(by("undo-last")).click()
    page.wait_for_selector(by("delete"))
    assert (root / "tissue" / "anna-report" / "report.html").is_file()


def test_that_no_tissue_is_chosen_is_said_once(page, tmp_path):
    root = make_project(tmp_path / "none").root
    with running(root, tmp_path / "home") as found:
        page.goto(found.address)
        visit(page, f"{found.home}tissue")
        for _ in range(2):  # at once, and after a click that needs a tissue
            page.wait_for_selector(".problem >> text=No tissue is chosen")
            assert page.get_by_text("No tissue is chosen").count() == 1
            page.evaluate("window.before = true")
            page.locator(by("use")).click()
            page.wait_for_function("window.before === undefined")
    assert read_project(root).tissue is None


def test_a_tissue_in_use_by_a_running_command_is_not_deleted(page, studio):
    _, root, _ = studio
    fit_anna(page)
    folder = root / ".studio" / "jobs" / "0900-suggest"
    folder.mkdir()
    words = ["suggest", "--tissue", "tissue/anna.toml", "--out", "designs/a"]
    asked = {"name": "suggest", "words": words, "cwd": str(root), "start": time.time()}
    (folder / runner.COMMAND).write_text(json.dumps(asked))
    lock = acquire_lock(folder / runner.LOCK)
    page.locator(by("delete")).click()
    page.wait_for_selector(".problem >> text=in use")
    assert (root / "tissue" / "anna.toml").is_file()
    lock.close()
    page.locator(by("delete")).click()
    page.wait_for_selector(by("undo-last"))


def test_two_people_become_one_tissue_by_the_command_lines_that_are_shown(page, studio):
    _, root, home = studio
    page.locator(by("people")).click()
    page.locator(by("guess-people")).click()
    page.wait_for_selector(".command code >> text=tissues add people")
    lines = [text for text in page.locator(".command code").all_inner_texts() if "people" in text]
    assert len(lines) == 3 and all(f"tissue/people/{name}.toml" in line for name, line in zip(STIFFER, lines))
    page.locator(by("run-people")).click()
    page.wait_for_selector(f"{by('stop-people')}:visible")
    page.reload()  # it goes on without the page that began it
    page.wait_for_selector(f"{by('found-people')} table")
    tissue = load_tissue(str(home / "materials" / "tissues" / "people.toml"))
    stiffness = {one.name: one.parameters.gamma1_N_per_mm3 for one in tissue.subjects}
    assert abs(stiffness["bert"] / stiffness["anna"] - STIFFER["bert"]) < 0.01
    (path,) = (root / ".studio" / "jobs").glob("*-people/command.json")
    kept = json.loads(path.read_text())
    done = [*kept["first"], kept["words"]]
    assert len(done) == 3 and [len(line.split()) - 1 for line in lines] == [len(words) for words in done]
    page.wait_for_selector(".command code >> text=show people")
    # the same name again would take the place of the first: it has to be ticked
    page.locator(by("run-people")).click()
    page.wait_for_selector(".problem >> text=Replace")
    page.locator(f"{by('found-people')} {by('use-fitted')}").click()
    page.wait_for_url("**/design?**")
    assert read_project(root).tissue == "people"


def test_the_page_with_results_fits_a_phone_and_names_its_controls(page):
    fit_anna(page)
    page.locator(by("people")).click()
    page.locator(by("guess-people")).click()
    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_function("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
    assert page.evaluate(NAMELESS) == [] and page.evaluate(RULES) == []


def test_a_person_whose_fit_fails_ends_the_chain_with_the_reason(page, studio):
    _, root, home = studio
    page.locator(by("people")).click()
    page.locator(by("guess-people")).click()
    page.locator(f"input{by('people-lowpass')}").fill("-3")
    page.wait_for_selector(".command code >> text=--lowpass -3")
    page.locator(by("run-people")).click()
    page.wait_for_selector(".work .problem >> text=-3")
    page.wait_for_selector(f"{by('run-people')}:not([disabled])")
    assert len(list((root / ".studio" / "jobs").glob("*-people"))) == 1
    assert not (home / "materials").exists()
    # mended, it goes to the end
    page.locator(f"input{by('people-lowpass')}").fill("")
    page.wait_for_selector(".command code >> text=tissues add people")
    page.wait_for_function("!document.body.innerText.includes('--lowpass')")
    page.locator(by("run-people")).click()
    page.wait_for_selector(f"{by('found-people')} table", timeout=COMMAND_MS)
