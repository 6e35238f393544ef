"""The parameters of the tissue law in words."""

from __future__ import annotations

from dummydesign.tissue import load_tissue
from dummydesign.tissue.model.maxwell_law import arm_names, parameter_words


def test_the_law_is_told_in_words_and_the_slow_arm_is_the_one_that_relaxes_last():
    tissue = load_tissue("forefinger")
    bands = tissue.to_dict()["bands"]
    arms = arm_names(bands)
    words = {label: parameter_words(label, arms) for label in bands}
    assert words["gamma1_N_per_mm3"] == ("steady stiffness", "N/mm³")
    assert words["gamma3_N_per_mm3"] == ("fast arm, stiffness", "N/mm³")
    assert words["c2_N_s_per_mm"] == ("slow arm, damper", "N s/mm")
    damping = {arm: next(iter(bands[f"c{arm}_N_s_per_mm"].values()))["value"] for arm in arms}
    times = {name: damping[arm] / bands[f"gamma{arm}_N_per_mm3"]["value"] for arm, name in arms.items()}
    assert times["slow "] > 3.0 * times["fast "]
    assert parameter_words("thickness_mm", arms) is None
