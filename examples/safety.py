"""What a robot of 4 kg at 250 mm/s does to the palm and to its dummy, beside your own limits."""

from pathlib import Path

import dummydesign
from dummydesign.design.safety import read_limits, safety_view

limits = read_limits(Path(__file__).with_name("limits.toml"))
answer = dummydesign.suggest("palm", shape="slab")
view = safety_view(answer.outcome, robot_mass_kg=4.0, robot_velocity_mm_s=250.0, limits=limits)
for row in view.presses:
    low, high = row.tissue_energy_mJ
    pad = "out of reach" if row.pad_energy_mJ is None else f"{row.pad_energy_mJ:.1f} mJ"
    print(f"{row.steady_force_N:g} N at {row.velocity_mm_s:g} mm/s: pad {pad}, subjects {low:.1f} to {high:.1f} mJ")
for row in view.impact:
    peak = row["note"] if row["peak_force_N"] is None else f"{row['peak_force_N']:.0f} N"
    print(f"free mass on {row['body']}: {peak}")
broken = [row for row in view.limits if row["within"] is False]
print(f"{len(broken)} of {len(view.limits)} numbers are above the limits of '{limits.name}'")
