"""What a long command tells those who watch it from outside."""

from dummydesign.core.progress import VARIABLE, write_progress


def test_the_newest_line_is_in_the_file_and_nothing_else_is_left(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path / "progress.txt"))
    for text in ("step 1", "step 2: größer"):
        write_progress(text)
    assert (tmp_path / "progress.txt").read_text(encoding="utf-8") == "step 2: größer"
    assert len(list(tmp_path.iterdir())) == 1


def test_without_a_watcher_or_with_a_place_that_cannot_be_written_nothing_happens(tmp_path, monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    write_progress("x")
    monkeypatch.setenv(VARIABLE, str(tmp_path / "gone" / "progress.txt"))
    write_progress("x")
    assert list(tmp_path.iterdir()) == []
