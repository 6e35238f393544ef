import subprocess
import sys

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from dummydesign.core.interpolation import monotone_cubic


@pytest.mark.parametrize("count", [2, 3, 4, 40])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_it_is_the_one_of_scipy_inside_and_beyond(count, seed):
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.uniform(0.1, 1.0, count))
    for y in (rng.standard_normal(count), np.sort(rng.standard_normal(count)), np.round(rng.standard_normal(count))):
        at = np.r_[x, np.linspace(x[0] - 0.1, x[-1] + 0.1, 101)].reshape(-1, 1)
        expected = PchipInterpolator(x, y)(at)
        assert monotone_cubic(x, y)(at) == pytest.approx(expected, abs=1e-12 * np.abs(expected).max(), rel=1e-12)


def test_columns_at_one_place_are_those_of_each_column_alone():
    rng = np.random.default_rng(4)
    for count in (2, 3, 6):
        x, y = np.cumsum(rng.uniform(0.1, 1.0, count)), rng.standard_normal((count, 30)).round(1)
        for at in rng.uniform(x[0], x[-1], 5).tolist():
            assert np.array_equal(monotone_cubic(x, y)(at), [monotone_cubic(x, column)(at) for column in y.T])


@pytest.mark.slow
def test_a_suggestion_loads_neither_interpolation_nor_the_loop():
    code = (
        "import sys, dummydesign, dummydesign.design.search.fe_candidates; "
        "dummydesign.suggest('forefinger', shape='boned', verify=False, thickness_mm=(5, 6), ratio=(14, 15)); "
        "print([name for name in ('scipy.interpolate', 'skfem', 'dummydesign.loop.effects') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
