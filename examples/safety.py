"""A robot of 0.3 kg hits the pad at 150 mm/s: what the same blow is on people, beside your own limits."""

from pathlib import Path

import dummydesign

DRIVE = "mass:0.3"
hit = dummydesign.predict(
    8.0, resin="polyurethane-nagoya", ratio=15.4, drive=DRIVE, velocity_mm_s=150.0, out="hit.csv"
).to_dict()
print(f"the pad stops it at {hit['depth_mm']:.2f} mm with {hit['peak_force_N']:.1f} N, {hit['energy_mJ']:.2f} mJ")

limits = Path(__file__).with_name("limits.toml")
people = dummydesign.on_person(["hit.csv"], tissue="palm", drive=DRIVE, limits=limits).to_dict()
(press,) = people["presses"]
low, high = press["band"]["peak_N"]
print(f"the subjects stop it with {low:.1f} to {high:.1f} N")
for row in press["limits"]:
    most = f"people up to {row['person_high_95']:.1f}"
    print(f"{row['name']}: limit {row['limit']:g} {row['unit']}, {most}: {row['result']}")
