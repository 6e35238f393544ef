"""The page of measured files in Chromium: what came in is said, nothing is lost, what is shown is what is chosen."""

from __future__ import annotations

import shutil

import pytest

from dummydesign.project.folder import make_project, read_project
from dummydesign.studio import trash as bin
from tests.studio.test_pages import MISSED, NAMELESS, RULES, WHERE
from tests.support.studio import COMMAND_MS, browser, live, running, settled
from tests.support.studio import test_id as by
from tests.support.walkthrough_files import write

pytestmark = pytest.mark.slow
EXPORTS = "finger_v010_f04.txt", "finger_v010_f08.txt", "finger_v250_f08.txt"


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    folder = tmp_path_factory.mktemp("measured")
    write(folder)
    return folder


@pytest.fixture(scope="module")
def studio(base):
    root = make_project(base / "thumb", tissue="forefinger").root
    with running(root, base / "home") as found:
        yield found, root


@pytest.fixture
def page(studio):
    """The page with three files in the folder, and nothing read."""
    found, root = studio
    for path in (root / "measured", root / ".studio" / "bin", root / ".studio" / "jobs"):
        shutil.rmtree(path, ignore_errors=True)
    (root / "measured").mkdir()
    for name in EXPORTS:
        shutil.copy(root.parent / "exports" / name, root / "measured" / name)
    with browser(viewport={"width": 1280, "height": 900}) as opened:
        opened.set_default_timeout(120_000)
        opened.goto(found.address)
        visit(opened, f"{found.home}measured")
        yield opened
        assert opened.broken == [] and opened.outside == []


def visit(page, address):
    page.goto(address)
    live(page)


def drop(page, *paths):
    page.locator(f'{by("drop")} input[type="file"]').first.set_input_files([str(path) for path in paths])


def chips(page):
    return [text.strip() for text in page.locator(".q-chip__content").all_inner_texts()]


def wait_for_chips(page, *names):
    page.wait_for_function(
        "(names) => JSON.stringify([...document.querySelectorAll('.q-chip__content')].map((e) => e.textContent.trim())"
        ".sort()) === JSON.stringify(names)",
        arg=sorted(names),
    )


def choose(page, *names):
    page.locator(by("files")).click()
    for name in names:
        page.get_by_role("option", name=name, exact=True).click()
    page.keyboard.press("Escape")


def names(folder):
    return sorted(path.name for path in folder.iterdir() if not path.name.startswith("."))


def test_of_several_refused_files_each_is_named_and_the_good_one_too(page, studio, tmp_path):
    for name in ("one.csv", "two.csv"):
        with open(tmp_path / name, "wb") as stream:
            stream.truncate(65 * 2**20)
    (tmp_path / "good.csv").write_text("1,2\n")
    drop(page, tmp_path / "one.csv", tmp_path / "good.csv", tmp_path / "two.csv")
    page.wait_for_selector(".note >> text=good.csv")
    refused = page.locator(".problem").all_inner_texts()
    assert [text.split()[0] for text in refused] == ["one.csv", "two.csv"] and all("64 MB" in text for text in refused)
    # the next drop begins a new list
    (tmp_path / "next.csv").write_text("3,4\n")
    drop(page, tmp_path / "next.csv")
    page.wait_for_selector(".note >> text=next.csv")
    assert page.locator(".problem").count() == 0


def test_a_file_dropped_twice_is_known_by_its_content_under_any_name(page, studio, tmp_path):
    _, root = studio
    shutil.copy(root / "measured" / EXPORTS[0], tmp_path / "copy.txt")
    for path in (root.parent / "exports" / EXPORTS[0], tmp_path / "copy.txt", tmp_path / "copy.txt"):
        page.evaluate("document.querySelectorAll('.note').forEach((one) => { one.dataset.before = 1 })")
        drop(page, path)
        page.wait_for_selector(f".note:not([data-before]) >> text={path.name} is")
        assert EXPORTS[0] in page.locator(".note >> text=nothing was changed").inner_text()
    assert names(root / "measured") == sorted(EXPORTS)


def test_a_file_of_a_taken_name_replaces_the_earlier_one_which_comes_back(page, studio, tmp_path):
    _, root = studio
    other = tmp_path / EXPORTS[0]
    other.write_text("other")
    before = (root / "measured" / EXPORTS[0]).read_bytes()
    drop(page, other)
    page.wait_for_selector(by("undo-last"))
    assert names(root / "measured") == sorted(EXPORTS) and (root / "measured" / EXPORTS[0]).read_text() == "other"
    wait_for_chips(page, EXPORTS[0])
    page.locator(by("undo-last")).click()
    page.wait_for_selector(f"{by('undo')} >> text=back")
    assert (root / "measured" / EXPORTS[0]).read_bytes() == before


def test_files_are_deleted_by_the_keyboard_and_come_back(page, studio):
    _, root = studio
    choose(page, EXPORTS[0], EXPORTS[1])
    page.locator(by("change-files")).click()
    page.wait_for_selector(by("delete"))
    page.locator(f'{by("delete")}[data-name="{EXPORTS[0]}"]').focus()
    page.keyboard.press("Enter")
    wait_for_chips(page, EXPORTS[1])
    page.wait_for_function("document.activeElement.matches('[data-test=undo-last]')")
    assert [one.path for one in bin.deleted(root)] == [f"measured/{EXPORTS[0]}"]
    page.keyboard.press("Enter")
    wait_for_chips(page, EXPORTS[0], EXPORTS[1])
    assert names(root / "measured") == sorted(EXPORTS)


def test_the_result_belongs_to_the_chosen_files_and_a_reload_keeps_both(page, studio):
    _, root = studio
    choose(page, EXPORTS[0])
    page.locator(by("run-import")).click()
    page.wait_for_selector(f"{by('found-import')} >> text={EXPORTS[0]}", timeout=COMMAND_MS)
    page.reload()
    page.wait_for_selector(f"{by('found-import')} >> text={EXPORTS[0]}")
    assert chips(page) == [EXPORTS[0]]
    choose(page, EXPORTS[1])
    page.wait_for_selector(f"{by('found-import')} table", state="detached")
    choose(page, EXPORTS[1])
    page.wait_for_selector(f"{by('found-import')} table")
    # a file that changed since is said
    (root / "measured" / EXPORTS[0]).write_bytes((root / "measured" / EXPORTS[1]).read_bytes())
    page.reload()
    page.wait_for_selector(f"{by('found-import')} .problem >> text={EXPORTS[0]}")
    # one that is gone as well
    (root / "measured" / EXPORTS[0]).unlink()
    page.reload()
    page.wait_for_selector(f".problem >> text={EXPORTS[0]}")
    assert chips(page) == []


def test_an_import_shows_its_presses_and_is_deleted_and_restored_with_them(page, studio):
    _, root = studio
    choose(page, EXPORTS[0], EXPORTS[2])
    page.locator(by("run-import")).click()
    page.wait_for_selector(f"{by('found-import')} iframe", timeout=COMMAND_MS)
    page.locator(by("import")).click()
    page.wait_for_selector(f"{by('import')} iframe")
    held = names(root / "measured" / "import-all")
    page.locator(f'{by("delete")}[data-name="import-all"]').click()
    page.wait_for_selector(f"{by('found-import')} table", state="detached")
    assert not (root / "measured" / "import-all").exists()
    page.locator(by("undo-last")).click()
    page.wait_for_selector(f"{by('found-import')} table")
    assert names(root / "measured" / "import-all") == held and len(held) == 4


def test_a_puck_makes_a_resin_which_the_project_takes(page, studio, base):
    _, root = studio
    drop(page, base / "puck.csv")
    wait_for_chips(page, "puck.csv")
    page.locator(by("resin")).click()
    page.wait_for_selector(by("run-puck"))
    page.locator(f"input{by('puck-diameter')}").fill("50")
    page.locator(f"input{by('puck-height')}").fill("30")
    page.wait_for_selector(".command code >> text=--height 30")
    page.locator(by("run-puck")).click()
    page.wait_for_selector(f"{by('found-puck')} table", timeout=COMMAND_MS)
    # simulated with 31 kPa and a friction of 0.3, which nobody tells the fit
    young = float(page.locator(f"{by('found-puck')} .fact b").first.inner_text().split()[0])
    before, after = (
        page.locator(f"{by('found-puck')} tbody tr").nth(row).locator("td").all_inner_texts() for row in (1, 2)
    )
    assert float(after[2]) < 31.0 < float(after[3])
    assert abs(young - 31.0) < abs(float(before[1]) - 31.0)
    assert float(after[3]) - float(after[2]) < float(before[3]) - float(before[2])
    page.reload()
    page.wait_for_selector(f"{by('found-puck')} table")
    page.locator(f"input{by('puck-height')}").fill("25")
    page.wait_for_selector(f"{by('found-puck')} table", state="detached")
    page.locator(f"input{by('puck-height')}").fill("30")
    page.wait_for_selector(f"{by('found-puck')} table")
    assert page.evaluate(NAMELESS) == [] and page.evaluate(RULES) == []
    page.locator(by("use-resin")).click()
    page.wait_for_url("**/design?**resin=my-batch**")
    assert read_project(root).resin == "my-batch"


def test_the_page_with_all_that_it_offers_fits_a_phone_and_the_keyboard(page, studio):
    choose(page, EXPORTS[0])
    page.locator(by("run-import")).click()
    page.wait_for_selector(f"{by('found-import')} iframe", timeout=COMMAND_MS)
    page.locator(by("change-files")).click()
    page.wait_for_selector(by("delete"))
    page.locator(f'{by("delete")}[data-name="{EXPORTS[2]}"]').click()
    page.wait_for_selector(by("undo-last"))
    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_function("document.documentElement.clientWidth <= 390")
    for held in page.locator("iframe").all():
        if held.is_visible():
            held.scroll_into_view_if_needed()
    settled(page)
    assert page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth") <= 0
    assert page.evaluate(NAMELESS) == [] and page.evaluate(RULES) == []
    for _ in range(4):  # a plot that loads in the frame of its frame takes the focus from the walk
        page.locator(".skip").focus()
        while page.evaluate(WHERE) is not None:
            page.keyboard.press("Tab")
        if not page.evaluate(MISSED):
            break
        settled(page)
    assert page.evaluate(MISSED) == []


def test_a_deletion_can_be_undone_on_a_page_that_is_opened_right_after(studio, page):
    _, root = studio
    bin.delete(root, f"measured/{EXPORTS[0]}")
    page.reload()
    page.locator(by("undo-last")).click()
    page.wait_for_function("!document.querySelector('[data-test=undo-last]')")
    assert names(root / "measured") == sorted(EXPORTS)


def test_the_overview_lists_what_was_deleted_and_restores_it_in_the_place_of_a_new_file(studio, page):
    found, root = studio
    for name in EXPORTS[:2]:
        bin.delete(root, f"measured/{name}")
    (root / "measured" / EXPORTS[0]).write_text("new")
    visit(page, found.home)
    page.locator(f"{by('bin')} .q-item").click()
    page.wait_for_selector(by("restore"))
    assert page.evaluate(NAMELESS) == [] and page.evaluate(RULES) == []
    for name in EXPORTS[:2]:
        page.locator(f'{by("restore")}[aria-label="Restore measured/{name}"]').click()
        page.wait_for_selector(f"{by('undo')} >> text={name} is back")
    assert names(root / "measured") == sorted(EXPORTS)
    # what had its name by then is in the bin
    assert (root / "measured" / EXPORTS[0]).read_bytes() != b"new"
    assert [one.path for one in bin.deleted(root)] == [f"measured/{EXPORTS[0]}"]
