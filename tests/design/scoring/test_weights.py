"""The weights of the score come from one file that a reader can change, and a damaged file is refused in one line."""

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.core.user_library import data_folder
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.settings import AIMS, PARTS, weights_of
from dummydesign.design.scoring.targets import make_targets
from tests.design.scoring.test_score import cubic_slabs
from tests.support.refusal import raises_code

BUILT_IN = (data_folder() / "materials" / "score.toml").read_text()


@pytest.fixture
def own_file(tmp_path, monkeypatch):
    """Writes a file of weights into a user's own folder."""
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    (tmp_path / "materials").mkdir()

    def write(text):
        (tmp_path / "materials" / "score.toml").write_text(text)

    return write


def test_every_aim_names_a_set_whose_parts_sum_to_one_and_whose_numbers_have_a_source():
    for aim in (*AIMS[:2], "subject:anna"):
        weights = weights_of(aim)
        assert sum(weights.parts.values()) == pytest.approx(1.0) and set(weights.parts) == set(PARTS)
        assert min(weights.parts, key=weights.parts.get) == "parametric"
        assert all(number.source and number.low <= number.value <= number.high for number in weights.numbers.values())


def test_a_file_of_ones_own_changes_the_total_of_its_aim_alone(own_file, finger):
    slabs, score = cubic_slabs([1.0, 1.6]), np.array([0.3, 0.9])
    before = evaluate(slabs, make_targets(finger, "average", Sampling())).total(score)
    only = BUILT_IN.replace('average = "curves"', 'average = "fit"')
    for part in PARTS:
        only += f'\n[sets.fit.{part}]\nvalue = {float(part == "parametric")}\nlow = 0\nhigh = 1\nkind = "assumed"\n'
        only += 'source = "mine"\n'
    own_file(only)
    average, safe = (make_targets(finger, aim, Sampling()) for aim in ("average", "safe-side"))
    np.testing.assert_allclose(evaluate(slabs, average).total(score), score)
    assert average.weights.origin == "user" and average.weights.name == "fit" and safe.weights.name == "curves"
    assert not np.allclose(before, score)


@pytest.mark.parametrize(
    "old, new, code, quantity, said",
    [
        ("value = 0.6", "value = 0.7", "inconsistent", "sets.curves", "1.1"),
        ('average = "curves"', 'average = "curve"', "unknown_name", "aims.average", "'curve'"),
        ("[sets.curves.aim]", "[sets.curves.ain]", "unknown_key", "sets.curves.ain", "did you mean 'aim'"),
        ("schema = 1", "schema = 2", "unsupported", "schema", "2"),
        ("schema = 1", "schema = ", "file_unreadable", None, "TOML"),
        (
            "value = 0.6\nlow = 0.4\nhigh = 0.8",
            "value = 5\nlow = 0.0\nhigh = 7",
            "out_of_range",
            "sets.curves.aim",
            "aim = 5",
        ),
        ('kind = "assumed"', "", "missing", None, "lacks kind"),
        ("[sets.curves.parametric]", "[sets.curves.reads_low]", "unknown_key", "sets.curves.reads_low", "reads_low"),
        *(
            (
                "[sets.curves.parametric]",
                f"[sets.curves.{name}]\nvalue = 0.1\nlow = 0\nhigh = 1\nkind = 'assumed'\n"
                "source = 'mine'\n[sets.curves.parametric]",
                "unknown_key",
                f"sets.curves.{name}",
                "delete it",
            )
            for name in ("low_aim", "not_representative", "borderline", "resolution")
        ),
    ],
)
def test_a_damaged_file_is_refused_in_one_line(own_file, capsys, old, new, code, quantity, said):
    assert old in BUILT_IN
    own_file(BUILT_IN.replace(old, new, 1))
    with raises_code(code, quantity):
        weights_of("average")
    assert run(["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--no-verify"]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and "score.toml" in lines[0] and said in lines[0]
