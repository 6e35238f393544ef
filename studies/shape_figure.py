"""The figure of docs/shapes.md: cross-sections of the best pad of each kind for the forefinger.

python -m studies.shape_figure
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

DOCS = Path(__file__).resolve().parent.parent / "docs"
FIGURE, DESIGNS = DOCS / "images" / "shapes.png", DOCS / "data" / "shapes-designs.csv"
TISSUE, HALF_MM, GAP_MM, PUNCH_MM = "forefinger", 16.0, 1.5, 3.0
GEL, OTHER_GEL, RIGID = "#a9c7e8", "#6f9bc8", "0.55"


def main() -> None:
    """Draw punch, gel, second layer, bone and base of each kind, true to scale."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from dummydesign.geometry.dimensions import PUNCH_SIDE_MM
    from dummydesign.geometry.shape_registry import read_shape

    plt.rcParams.update({"font.size": 9})
    with DESIGNS.open(encoding="utf-8") as stream:
        designs = [row for row in csv.DictReader(stream) if row["tissue"] == TISSUE]
    x = np.linspace(-HALF_MM, HALF_MM, 641)
    highest = max(float(row["thickness_mm"]) for row in designs) + GAP_MM + PUNCH_MM + 0.5
    figure, axes = plt.subplots(2, 3, figsize=(7.4, 4.4), layout="constrained", sharex=True, sharey=True)
    for panel in axes.flat[len(designs) :]:
        panel.set_axis_off()
    for panel, row in zip(axes.flat, designs):
        shape, thickness = read_shape(row["shape"]), float(row["thickness_mm"])
        top, bone = thickness - shape.drop_mm(x, 0.0 * x), shape.bone_mm(x, 0.0 * x)
        layers = shape.layers()
        panel.fill_between(x, bone, top, color=GEL, lw=0)
        if layers is not None:
            panel.fill_between(x, 0.0, thickness - layers[0], color=OTHER_GEL, lw=0)
        panel.fill_between(x, -1.0, bone, color=RIGID, lw=0)
        panel.plot(x, top, color="black", lw=0.8)
        low = thickness + GAP_MM
        panel.add_patch(plt.Rectangle((-PUNCH_SIDE_MM / 2, low), PUNCH_SIDE_MM, PUNCH_MM, color="0.75"))
        panel.tick_params(labelbottom=True)
        panel.set(title=f"{shape.name}, {thickness:g} mm", aspect="equal")
        panel.set(xlim=(-HALF_MM, HALF_MM), ylim=(-1.0, highest))
        panel.spines[["top", "right"]].set_visible(False)
    axes[0, 0].set_ylabel("height [mm]")
    axes[1, 0].set(xlabel="x [mm]", ylabel="height [mm]")
    axes.flat[-1].text(-HALF_MM, 2.0, "light blue: gel\ndark blue: second gel\ndark grey: rigid\nlight grey: punch")
    figure.savefig(FIGURE, dpi=130, metadata={"Software": None})


if __name__ == "__main__":
    main()
