"""Wrong labels are doubted, right ones are not, and nothing is read otherwise before the user asks for it."""

from __future__ import annotations

import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.fitting.by_trial import of_pads
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.result import result_dict
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.doubt_words import OddGroup, other_zero
from dummydesign.loop.selection.doubts import doubts_of, groups, labels_of, odd, pads_of_a_day
from dummydesign.measurement.campaign_file import read_campaign
from tests.support.refusal import raises_code


def test_one_value_that_the_others_do_not_let_expect_is_odd():
    rng = np.random.default_rng(4)
    columns = np.stack([np.ones(24), np.linspace(-1.0, 1.0, 24)], axis=1)
    values = columns @ [0.2, 0.5] + rng.normal(0.0, 0.01, 24)
    values[5] -= 0.3
    use, spreads = np.ones(24, bool), np.array([10.0, 10.0])
    differences, z = odd(values, np.full(24, 1e-3), columns, spreads, 1e-3, use)
    assert np.argmax(np.abs(z)) == 5 and abs(z[5]) > 15.0
    assert differences[5] == pytest.approx(-0.3, abs=0.03)
    assert np.abs(np.delete(z, 5)).max() < 5.0


def test_a_group_is_a_day_or_a_heap_and_noise_is_none():
    rng = np.random.default_rng(5)
    days, noise = np.repeat([9.0, 14.0, 29.0], 10), rng.normal(0.0, 0.02, 30)
    level = np.zeros(30), days, 0.01, 0.04, np.ones((30, 1)), np.array([10.0])
    assert groups(noise, *level) is None
    of_day = groups(noise + 0.1 * (days == 14.0), *level)
    assert of_day.of_day and np.array_equal(of_day.rows, days == 14.0)
    assert of_day.apart == pytest.approx(0.1, abs=0.03)
    heap = np.isin(np.arange(30), [3, 11, 17, 28])
    some = groups(noise + 0.3 * heap, *level)
    assert not some.of_day and np.array_equal(some.rows, heap)


def test_what_is_said_of_a_group_can_be_read_from_the_campaign_file():
    trials = [SimpleNamespace(file=f"t{number}.csv", age_days=14.0) for number in range(3)]
    group = OddGroup(np.array([True, False, True]), 0.123, 7.5, False)
    doubt = other_zero(SimpleNamespace(trials=trials), group)
    assert (doubt.kind, doubt.files, doubt.rows, doubt.z) == ("zero", ("t0.csv", "t2.csv"), (0, 2), 7.5)
    assert tomllib.loads(doubt.read_as) == {"read_as": [{"files": ["t0.csv", "t2.csv"], "zero_N": 0.12}]}


@pytest.fixture
def small(tmp_path, campaigns):
    """A function that writes the first presses of a campaign anew, with its rows changed and lines added."""
    source = campaigns("none", 401)

    def write(count: int, change, more: str = ""):
        head, *blocks = (source / "campaign.toml").read_text().split("[[trial]]")
        blocks = [change(number, block) for number, block in enumerate(blocks[:count])]
        folder = tmp_path / "own"
        folder.mkdir(exist_ok=True)
        (folder / "campaign.toml").write_text("[[trial]]".join([head, *blocks]) + more)
        for path in source.glob("*.csv"):
            (folder / path.name).write_text(path.read_text())
        return folder

    return write


def unchanged(_number, block):
    return block


def test_read_as_changes_what_it_names_and_says_so(small):
    plain = read_campaign(small(14, unchanged)).trials
    order = sorted(range(14), key=lambda number: plain[number].thickness_mm)
    thin, sensor, looked, thick = order[0], order[1], order[2], order[-1]
    assert plain[thick].thickness_mm > plain[thin].thickness_mm
    lines = (
        f'\n[[read_as]]\nfiles = ["{plain[thin].file}"]\npad_of = "{plain[thick].file}"\n'
        f'\n[[read_as]]\nfiles = ["{plain[sensor].file}"]\nlowpass_hz = 20.0\nzero_N = 0.5\nvelocity_mm_s = 12.0\n'
        f'\n[[read_as]]\nfiles = ["{plain[looked].file}"]\nconfirmed = true\n'
    )
    read = read_campaign(small(14, unchanged, lines))
    assert read.trials[thin].thickness_mm == plain[thick].thickness_mm
    assert read.trials[sensor].lowpass.cutoff_hz == 20.0 and read.trials[sensor].velocity_mm_s == 12.0
    np.testing.assert_allclose(read.trials[sensor].trace.force_N, plain[sensor].trace.force_N - 0.5)
    assert [number for number, trial in enumerate(read.trials) if trial.confirmed] == [looked]
    assert [one["code"] for one in read.warnings].count("read_as") == 3


def test_exchanged_presses_take_each_others_rows(small):
    plain = read_campaign(small(4, unchanged)).trials
    lines = f'\n[[read_as]]\nfiles = ["{plain[0].file}", "{plain[1].file}"]\nexchanged = true\n'
    read = read_campaign(small(4, unchanged, lines)).trials
    assert [trial.file for trial in read[:2]] == [plain[1].file, plain[0].file]
    assert [trial.thickness_mm for trial in read] == [trial.thickness_mm for trial in plain]


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ('files = ["none.csv"]\nconfirmed = true', "unknown_name"),
        ('files = ["trial_01.csv"]\nforce = 1.0', "unknown_key"),
        ('files = ["trial_01.csv"]\nexchanged = true', "malformed"),
        ('files = ["trial_01.csv"]\nzero_N = "much"', "not_a_number"),
    ],
)
def test_a_table_that_reads_nothing_is_refused(small, lines, code):
    folder = small(3, unchanged, f"\n[[read_as]]\n{lines}\n")
    with raises_code(code):
        read_campaign(folder)


@pytest.mark.slow
def test_a_wrong_pad_is_doubted_left_out_and_read_as_asked(small):
    plain = read_campaign(small(36, unchanged)).trials
    thick = max(trial.thickness_mm for trial in plain)
    row = next(n for n, trial in enumerate(plain) if trial.thickness_mm == 15.0)
    assert thick == 20.0

    def wrong(number, block):
        return block.replace("thickness_mm = 15.0", "thickness_mm = 20.0") if number == row else block

    result = close_loop(read_campaign(small(36, wrong)))
    data = result_dict(result)
    (doubt,) = data["doubts"]
    assert doubt["kind"] == "pad" and list(doubt["files"]) == [plain[row].file]
    assert data["answer"][0].startswith("Look at the sheet first") and result.verdict == "none"
    assert plain[row].file not in [trial.file for trial in result.presses.trials]
    again = close_loop(read_campaign(small(36, wrong, "\n" + doubt["read_as"] + "\n")))
    assert again.doubts == () and len(again.presses.trials) == 36
    assert "read_as" in [one["code"] for one in again.warnings]
    kept = close_loop(
        read_campaign(small(36, wrong, f'\n[[read_as]]\nfiles = ["{plain[row].file}"]\nconfirmed = true\n'))
    )
    assert kept.doubts == () and len(kept.presses.trials) == 36


@pytest.fixture(scope="module")
def base(plain):
    """The base fit of a campaign without an effect."""
    presses, law = plain
    return fit_base(presses, law, 0.03)


@pytest.mark.slow
def test_a_campaign_without_a_fault_raises_no_doubt(plain, base, campaigns):
    assert doubts_of(read_campaign(campaigns("none", 401)), plain[0], base) == ()


def test_two_pads_taken_for_each_other_for_a_day_are_named(plain, base):
    presses, days = plain[0], plain[0].history.age_days
    thin, *_, thick = (presses.trials[int(np.argmax(presses.pad == pad))] for pad in range(len(presses.pads)))
    rows = (days == np.unique(days)[1]) & np.isin(presses.thickness_mm, (thin.thickness_mm, thick.thickness_mm))
    other = {thin.pad: thick, thick.pad: thin}
    sheet = of_pads(presses, [other[t.pad] if row else t for t, row in zip(presses.trials, rows)])
    labels, none = labels_of(sheet, base), np.zeros(len(rows), bool)
    (doubt,) = pads_of_a_day(labels, ~rows, none)  # as gross ones are left out
    assert doubt.kind == "exchanged" and doubt.rows == tuple(np.flatnonzero(rows))
    assert f'pad_of = "{doubt.files[0]}"' not in doubt.read_as and doubt.read_as.count("[[read_as]]") in (1, 2)
