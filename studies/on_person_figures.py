"""The figures of docs/on-person.md: one press on a pad, and what it is on people under each drive.

python -m studies.on_person_figures
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "images"
DRIVES = ("position", "steady", "force", "mass:2", "spring:20,1")


def main() -> None:
    """Press a slab of the paper's polyurethane, and draw."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    import dummydesign
    from dummydesign.measurement.trace import Trace
    from dummydesign.person.drives import read_drive
    from dummydesign.person.on_person import on_person
    from dummydesign.report.on_person import on_grid
    from dummydesign.tissue import load_tissue

    plt.rcParams.update({"svg.hashsalt": "on-person", "font.size": 9})
    made = dummydesign.predict(thickness_mm=15, resin="polyurethane-nagoya", ratio=15, force_N=8, velocity_mm_s=100)
    trace = Trace("pad", made.time_s, made.displacement_mm, made.force_N)
    lead = np.linspace(-0.01, 0.0, 20)[:-1]
    trace = Trace(
        "pad", np.r_[lead, trace.time_s], np.r_[100.0 * lead, trace.displacement_mm], np.r_[0.0 * lead, trace.force_N]
    )
    tissue = load_tissue("palm")
    for text in DRIVES:
        one = on_person([trace], tissue, read_drive(text)).presses[0]
        end = min(float(np.max(one.response.time_s)), 0.6)
        time = end * np.linspace(0.0, 1.0, 600) ** 2
        curves = on_grid(one, time)
        figure, axes = plt.subplots(1, 2, figsize=(7.0, 2.6), layout="constrained")
        pads = (one.press.x_mm, one.press.force_N)
        for panel, rows, pad, label in zip(axes, curves, pads, ("depth [mm]", "force [N]")):
            panel.fill_between(time, rows.min(axis=0), rows.max(axis=0), color="0.85", label="subjects")
            panel.plot(time, rows.T, color="0.55", lw=0.6)
            panel.plot(time, np.interp(time, one.press.time_s, pad), color="#1f4e79", lw=1.6, label="pad")
            panel.set(xlabel="time since contact [s]", ylabel=label)
        axes[1].legend(frameon=False)
        figure.suptitle(f"--drive {text}", fontsize=10)
        name = FOLDER / f"on-person-{text.partition(':')[0]}.svg"
        figure.savefig(name, metadata={"Date": None})
        plt.close(figure)


if __name__ == "__main__":
    main()
