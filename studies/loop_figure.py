"""Draw the figure of docs/loop.md: campaign, residual, effect, calibration and next design of one simulated campaign.

    python -m studies.loop_figure

The relaxation of the pads of tests/support/campaign_generator.py depends on speed, which the base model leaves out.
Takes half a minute. One campaign as an example: rates are those of the blind studies.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import dummydesign
from dummydesign.loop.result import named
from dummydesign.report.page import figure_values
from tests.support import campaign_generator as generator

FIGURE = Path(__file__).resolve().parent.parent / "docs" / "images" / "loop.svg"
EFFECT, SIZE, SEED, CAST = "rate_dependent_viscosity", 0.12, 1, 'resin = "polyurethane-nagoya"\nratio = 15.0'
MEASURED, BASE, AFTER = "0.35", "#c94a1f", "#1f4e79"


def series(rows: list[dict[str, str]]) -> dict[str, np.ndarray]:
    """x and y of each series of a figure."""
    columns: dict[str, list[list[float]]] = {}
    for row in rows:
        columns.setdefault(row["series"], []).append([float(row[key]) if row[key] else np.nan for key in ("x", "y")])
    return {name: np.array(rows) for name, rows in columns.items()}


def deepest(folder: Path) -> dict[str, np.ndarray]:
    """Measured and modelled force of the press in which the base model misses most."""

    def miss(curves: dict[str, np.ndarray]) -> float:
        measured, base = (
            next(rows for name, rows in curves.items() if name.startswith(one)) for one in ("measured", "base")
        )
        return float(np.max(np.abs(measured[:, 1] - base[:, 1])))

    figures = figure_values(folder / "report.csv")
    return max((series(rows) for name, rows in figures.items() if name.startswith("press-")), key=miss)


def draw(loop: Path, answer: dict, designs: dict[str, Path]) -> None:
    """Draw the four steps in a row."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "loop", "font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    figure, ((press, left), (cause, design)) = plt.subplots(2, 2, figsize=(8.4, 5.2), layout="constrained")
    styles = {"measured": (".", MEASURED), "base": ("--", BASE), "corrected": ("-", AFTER)}
    curves = deepest(loop)
    for begin, words in (("measured", "measured"), ("base", "base model"), ("corrected", "with the effect")):
        for at, rows in enumerate(rows for name, rows in curves.items() if name.startswith(begin)):
            style, colour = styles[begin]
            press.plot(*rows.T, style, color=colour, ms=3, lw=1.2, label="" if at else words)
    press.set(xscale="log", xlabel="time since contact [s]", ylabel="force [N]", title="1 Campaign: press cast pads")
    press.legend(frameon=False, fontsize=8)
    rows = answer["residual"]["by_trial"]
    number = np.arange(1, len(rows) + 1)
    left.bar(number, [1e3 * row["base_rmse_N"] for row in rows], color=BASE, width=0.9, label="base model")
    left.bar(number, [1e3 * row["rmse_N"] for row in rows], color=AFTER, label="with the effect")
    floor = 1e3 * answer["after"]["error"]["noise_floor_N"]
    left.axhline(floor, color="black", lw=0.8, ls="--", label="noise floor")
    left.set(xlabel="press", ylabel="rms residual [mN]", title="2 Residual: measured minus model")
    left.set_ylim(0.0, 1.45 * max(1e3 * row["base_rmse_N"] for row in rows))
    left.legend(frameon=False, fontsize=8)
    ranking = answer["ranking"][:5][::-1]
    colours = [AFTER if row["name"] == answer["effects"][0]["name"] else "0.75" for row in ranking]
    cause.barh([named(row["name"]) for row in ranking], [row["evidence"] for row in ranking], color=colours)
    cause.axvline(answer["threshold"], color="black", lw=0.8, ls="--")
    cause.set(xlabel="evidence (needed: dashed)", title="3 Effect: find the cause, calibrate")
    for name, colour, style in (("without calibration", BASE, "--"), ("with calibration", AFTER, "-")):
        curve = series(figure_values(designs[name] / "report.csv")["steady"])["recommended pad"]
        design.plot(np.append(0.0, curve[:, 0]), np.append(0.0, curve[:, 1]), style, color=colour, label=name)
    design.set(xlabel="depth [mm]", ylabel="steady force [N]", title="4 Next design: a 12 mm slab")
    design.legend(frameon=False, fontsize=8)
    figure.savefig(FIGURE, metadata={"Date": None})
    plt.close(figure)


def main() -> None:
    """Press, close the loop, design, and draw."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        generator.write_campaign(folder / "campaign", EFFECT, SIZE, SEED, cast=CAST)
        answer = dummydesign.calibrate(folder / "campaign", out=folder / "loop").to_dict()
        designs = {}
        for name, more in (
            ("without calibration", {}),
            ("with calibration", {"calibration": folder / "loop" / "calibration.json"}),
        ):
            designs[name] = folder / name
            dummydesign.suggest(
                "palm",
                shape="slab",
                thickness_mm=(12.0, 12.0),
                ratio=(15.0, 15.0),
                verify=False,
                cad=False,
                out=designs[name],
                **more,
            )
        draw(folder / "loop", answer, designs)
    print([(one["name"], one["evidence"]) for one in answer["effects"]], answer["after"]["parameters"]["young_kPa"])


if __name__ == "__main__":
    main()
