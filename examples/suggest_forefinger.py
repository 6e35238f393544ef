"""A pad for the forefinger: what to weigh, how thick, how well it fits, and a report in ./forefinger (no mould)."""

import dummydesign

answer = dummydesign.suggest("forefinger", cad=False, out="forefinger")
best = answer.to_dict()["recommendation"]
print(f"{best['thickness_mm']:g} mm thick, ratio {best['ratio']:g} ({best['ratio_meaning']})")
for part in best["recipe"]["components"]:
    print(f"  weigh {part['mass_g']:.1f} g {part['name']}")
for row in best["conditions"]:
    print(
        f"  {row['steady_force_N']:g} N at {row['velocity_mm_s']:g} mm/s: "
        f"{100 * row['inside_fraction']:.0f} % of the press inside the subjects' range"
    )
print("report:", answer.files["report"])
