"""Draw the picture of the README: the mould of the forefinger's pad beside its force curve.

    python -m studies.front_picture

The curves are those of two answers of ``suggest``: the recommended pad, and the slab that it is compared with. The
mould is the left half of ``docs/images/mould.png``. Takes about a minute.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import dummydesign
from dummydesign.report.page import figure_values

ROOT = Path(__file__).resolve().parent.parent

MOULD, PICTURE = ROOT / "docs" / "images" / "mould.png", ROOT / "docs" / "images" / "pad-and-force.png"
LEFT, TOP, RIGHT, BOTTOM = 90, 50, 800, 610
"""Part of the picture of the mould that is shown. [pixels]"""
PAD, PEOPLE, SLAB, WORDS = "#c94a1f", "#8fb4cc", "#4d4d4d", "#1f4e6b"
COLOURS = 256


def steady_curves(folder: Path) -> dict[str, np.ndarray]:
    """Read depth, force, shallowest and deepest subject of each series of the figure ``steady``.

    Parameters
    ----------
    folder : Path
        Of an answer of ``suggest``.
    """
    curves: dict[str, list[list[float]]] = {}
    for row in figure_values(folder / "report.csv")["steady"]:
        values = [float(row[key]) if row[key] else np.nan for key in ("x", "y", "low", "high")]
        curves.setdefault(row["series"], []).append(values)
    return {name: np.array(rows) for name, rows in curves.items()}


def draw(crowned: Path, slab: Path) -> None:
    """Draw both panels into the picture.

    Parameters
    ----------
    crowned, slab : Path
        Folders of the two answers.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from PIL import Image

    plt.rcParams.update({"font.size": 11, "axes.spines.top": False, "axes.spines.right": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), width_ratios=(1.15, 1), layout="constrained")
    left.imshow(plt.imread(MOULD)[TOP:BOTTOM, LEFT:RIGHT])
    left.axis("off")
    left.set_title("pad, open silicone mould, strike-off plate and tray", fontsize=11)
    best, flat = steady_curves(crowned), steady_curves(slab)
    for name, alpha in (("subjects, extrapolated", 0.35), ("subjects of forefinger", 0.75)):
        _, force, low, high = best[name].T
        right.fill_betweenx(force, low, high, color=PEOPLE, alpha=alpha, lw=0)
    for curves, colour, style in ((best, PAD, "-"), (flat, SLAB, "--")):
        depth, force = curves["recommended pad"].T[:2]
        right.plot(np.append(0.0, depth), np.append(0.0, force), style, color=colour, lw=2.2)
    right.text(1.62, 12.9, "people,\n5 to 15 N", color=WORDS)
    for words, to, at, colour in (
        ("people,\nextrapolated", (1.2, 2.9), (1.62, 1.5), WORDS),
        ("crowned pad", (1.46, 11.2), (0.30, 12.6), PAD),
        ("best slab", (0.50, 2.6), (0.08, 6.0), SLAB),
    ):
        right.annotate(words, to, at, color=colour, arrowprops={"arrowstyle": "-", "color": colour})
    right.set(xlabel="depth [mm]", ylabel="steady force [N]", xlim=(0, 2.4), ylim=(0, 15.2))
    right.set_title("forefinger, 14 mm punch", fontsize=11)
    figure.savefig(PICTURE, dpi=140)
    plt.close(figure)
    with Image.open(PICTURE) as drawn:
        reduced = drawn.convert("RGB").quantize(COLOURS, kmeans=2)
    reduced.save(PICTURE, optimize=True)


def main() -> None:
    """Design both pads and draw them."""
    with tempfile.TemporaryDirectory() as folder:
        crowned, slab = Path(folder) / "crowned", Path(folder) / "slab"
        answer = dummydesign.suggest("forefinger", out=crowned)
        flat = next(row for row in answer.result["shapes"] if row["kind"] == "slab")
        one = {name: (flat[name], flat[name]) for name in ("thickness_mm", "ratio")}
        dummydesign.suggest("forefinger", shape="slab", **one, out=slab)
        draw(crowned, slab)
    print(f"{PICTURE.relative_to(ROOT)}: {PICTURE.stat().st_size / 1024:.0f} kB")


if __name__ == "__main__":
    main()
