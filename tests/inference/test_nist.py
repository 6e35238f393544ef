"""The least-squares driver on certified data: NIST StRD nonlinear regression, from both of its starts."""

import re
from pathlib import Path

import numpy as np
import pytest

from dummydesign.inference.least_squares import covariance, solve

FOLDER = Path(__file__).parent / "nist"

MODELS = {
    "Misra1a": lambda b, x: b[0] * (1 - np.exp(-b[1] * x)),
    "Lanczos2": lambda b, x: sum(b[2 * i] * np.exp(-b[2 * i + 1] * x) for i in range(3)),
    "Thurber": lambda b, x: (b[0] + b[1] * x + b[2] * x**2 + b[3] * x**3) / (1 + b[4] * x + b[5] * x**2 + b[6] * x**3),
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH10": lambda b, x: b[0] * np.exp(b[1] / (x + b[2])),
    "MGH17": lambda b, x: b[0] + b[1] * np.exp(-x * b[3]) + b[2] * np.exp(-x * b[4]),
    "BoxBOD": lambda b, x: b[0] * (1 - np.exp(-b[1] * x)),
    "Eckerle4": lambda b, x: (b[0] / b[1]) * np.exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
}


def read(name):
    """Starts (2, p), certified values (p,), their deviations (p,), sum of squares, y, x."""
    lines = (FOLDER / f"{name}.dat").read_text().splitlines()
    table = np.array(
        [[float(cell) for cell in line.split("=")[1].split()] for line in lines if re.match(r"\s+b\d+ =", line)]
    )
    squares = next(float(line.split()[-1]) for line in lines if "Residual Sum of Squares" in line)
    data = np.array([[float(cell) for cell in line.split()] for line in lines[60:] if line.strip()])
    return table[:, :2].T, table[:, 2], table[:, 3], squares, data[:, 0], data[:, 1]


def residuals(name, y, x):
    def model(b):
        step = 1e-200
        columns = [MODELS[name](b + 1j * step * row, x).imag / step for row in np.eye(len(b))]
        return MODELS[name](b, x) - y, np.column_stack(columns)

    return model


# From their first (far) starts MGH09, MGH10 and MGH17 lead this driver to other minima: that is what several
# starts are for, and both certified starts are given together.
# Far starts leave the range of floats.
@pytest.mark.filterwarnings("ignore:(overflow|invalid value) encountered:RuntimeWarning")
@pytest.mark.parametrize("name", sorted(MODELS))
def test_certified_values_are_found_to_six_digits(name):
    starts, certified, deviation, squares, y, x = read(name)
    model = residuals(name, y, x)
    wide = np.full(len(certified), 1e8)
    found = solve(model, list(starts), -wide, wide, 1e-15)
    assert found.chi_square == pytest.approx(squares, rel=1e-8 if squares > 1e-10 else 1e-4)
    assert found.parameters == pytest.approx(certified, rel=1e-6)
    spread = covariance(model(found.parameters)[1])
    scale = squares / (len(y) - len(certified))
    assert np.sqrt(np.diag(spread) * scale) == pytest.approx(deviation, rel=1e-5)
