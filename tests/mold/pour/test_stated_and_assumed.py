"""What a resin does not state is marked; temperature, vacuum and chemistry are named; what is poured is said."""

import dataclasses
import itertools
import re

import numpy as np
import pytest

from dummydesign.mold.checks.process import check_process
from dummydesign.mold.files.pour_sheet import pour_sheet
from dummydesign.mold.model.preset import _RESIN_FALLBACK, mould_spec, read_preset
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import batch_of, pour_plan
from dummydesign.mold.pour.steps import ASSUMED, order_faults, pour_steps
from dummydesign.mold.pour.warnings import is_tin, pour_warnings
from dummydesign.mold.puck.plan import puck_plan, warnings_of
from dummydesign.mold.puck.ring import puck_spec, read_pucks
from dummydesign.mold.puck.sheet import puck_sheet
from dummydesign.resin import load_resin
from dummydesign.resin.model.modulus_laws import LAWS, guessed_chemistry
from dummydesign.resin.model.resin_file import save_resin
from tests.support.mould_checks import failed
from tests.support.refusal import raises_code
from tests.support.sheet_text import sheet_text

BASE = load_resin()


def with_properties(resin=BASE, drop=(), **values):
    """The resin without some properties, others at a value."""
    properties = {name: one for name, one in resin.properties.items() if name not in drop}
    for name, value in values.items():
        given = resin.properties.get(name) or next(iter(resin.properties.values()))
        properties[name] = dataclasses.replace(given, value=value, low=0.9 * value, high=1.1 * value)
    return dataclasses.replace(resin, properties=properties)


def written(spec):
    plan = pour_plan(spec)
    warnings = pour_warnings(spec, plan)
    return sheet_text(pour_sheet(spec, plan, warnings)), {item["code"]: item["message"] for item in warnings}


def with_process(preset, **changed):
    """A preset with other lines in its [process]."""
    used = read_preset(preset)
    table = dict(used.top.data["process"]) | changed
    return dataclasses.replace(used, top=dataclasses.replace(used.top, data={**used.top.data, "process": table}))


def test_every_set_of_missing_numbers_is_marked_in_sheet_sources_and_warnings():
    names = [*_RESIN_FALLBACK, "cure_temperature_C"]
    rng = np.random.default_rng()
    drawn = [tuple(rng.permutation(names)[: rng.integers(1, len(names) + 1)]) for _ in range(6)]
    for missing in [(), *drawn]:
        spec = mould_spec(8.0, 90.0, 70.0, resin=with_properties(drop=missing), ratio=15.0)
        text, codes = written(spec)
        assert set(spec.pour.assumed) == set(missing)
        listed = {
            name
            for name in names
            if any(
                f" {name} = " in one and "(assumed)" in one
                for one in spec.sources
                if one.startswith(f"resin {BASE.name} ")
            )
        }
        assert listed == set(missing)
        assert ("assumed_numbers" in codes) == bool(missing)
        for name, (words, _) in ASSUMED.items():
            assert (name in missing) == (words in codes.get("assumed_numbers", ""))
        body = text.split("## Cautions")[0]
        marks = {
            "pot_life_min": "min (assumed)",
            "cure_time_h": "h (assumed)",
            "shrinkage_percent": "% assumed",
            "age_before_test_days": "days (assumed)",
            "degas_pressure_kPa": "kPa (assumed)",
            "cure_temperature_C": " C (assumed)",
        }
        for name, words in marks.items():
            # A warm cure has a line of its own that a missing temperature never reaches.
            assert (name in missing) == bool(re.search(re.escape(words), body)), (name, missing)


def test_what_is_assumed_makes_no_other_mould_and_survives_the_file():
    whole = dict.fromkeys(_RESIN_FALLBACK)
    same = with_properties(**_RESIN_FALLBACK | {"shrinkage_percent": 1e-9})
    missing = with_properties(drop=[name for name in whole if name != "shrinkage_percent"], shrinkage_percent=1e-9)
    stated, assumed = (mould_spec(8.0, 90.0, 70.0, resin=one, ratio=15.0) for one in (same, missing))
    assert assumed.pour.assumed and not stated.pour.assumed
    assert dataclasses.replace(assumed, sources=stated.sources).hash == stated.hash
    assert MouldSpec.from_dict(assumed.to_dict()).pour == assumed.pour


def test_the_sheet_names_the_temperature_that_the_cavity_is_made_for():
    for cure in (*np.random.default_rng().uniform(1.0, 80.0, 5).round(1), 5.0, 23.0):
        spec = mould_spec(8.0, 90.0, 70.0, resin=with_properties(cure_temperature_C=float(cure)), ratio=15.0)
        line = next(step.text for step in pour_steps(spec, pour_plan(spec)) if "cure" in step.acts)
        assert f"{cure:g} C" in line
        assert ("room temperature" in line) == (abs(cure - 23.0) <= 5.0)
        assert ("refrigerator" in line) == (cure < 18.0) and ("oven" in line) == (cure > 28.0)


def test_a_fast_resin_is_told_where_the_time_is_written_and_can_be_poured_without_a_vacuum():
    fast = with_properties(pot_life_min=7.0)
    with raises_code("out_of_range", "pour_and_degas_min") as caught:
        mould_spec(8.0, 90.0, 70.0, resin=fast, ratio=15.0)
    assert "[process]" in str(caught.value) and 'degas = "none"' in str(caught.value)
    for preset in ("open", "lidded", "printed"):
        spec = mould_spec(8.0, 90.0, 70.0, with_process(preset, degas="none", pour_and_degas_min=3.0), fast, 15.0)
        plan, (text, codes) = pour_plan(spec), written(spec)
        assert "No vacuum" in text and "Degas in the cup" not in text and "under vacuum" not in text
        assert "not_degassed" in codes and not order_faults(pour_steps(spec, plan))
        assert not failed(check_process(spec, plan, pour_warnings(spec, plan)))


def test_without_a_vacuum_no_chamber_limits_the_batch():
    coarse = read_preset("open")
    machines = dataclasses.replace(coarse.machines, balance_resolution_g=5.0)
    batches = {}
    for degas in ("cup", "none"):
        preset = dataclasses.replace(with_process("open", degas=degas), machines=machines)
        spec = mould_spec(8.0, 90.0, 70.0, preset)
        batches[degas] = batch_of(spec, spec.pour, pour_plan(spec)).mix.error_percent
    assert batches["none"] <= 0.5 < batches["cup"]


@pytest.mark.parametrize(
    ("text", "chemistry"),
    [
        ("polyol isocyanate", "polyurethane"),
        ("Clear urethane rubber", "polyurethane"),
        ("PU gel", "polyurethane"),
        ("PU gel, polyol with silicone oil", "polyurethane"),
        ("ecoflex-00-30", "platinum silicone"),
        ("Dragon Skin 10", "platinum silicone"),
        ("platinum-cured silicone", "platinum silicone"),
        ("silicone, tin-cured", "tin silicone"),
        ("tin_cure silicone rubber", "tin silicone"),
        ("PDMS 10:1", "silicone"),
        ("Ballistic gelatin, bloom 250", "gelatin"),
        ("something", ""),
        ("vinyl silicone, martini grade", "silicone"),
    ],
)
def test_chemistry_by_the_words_of_a_file(text, chemistry):
    assert guessed_chemistry(text) == chemistry


def test_a_tin_cured_mould_under_a_platinum_pad_is_named():
    resins = {"ecoflex-00-30": 20.0, "polyurethane-nagoya": 15.0}
    for (name, ratio), silicone in itertools.product(resins.items(), ("tin_a25", "platinum_a20")):
        spec = mould_spec(8.0, 90.0, 70.0, read_preset("open", silicone=silicone), name, ratio)
        _, codes = written(spec)
        assert ("cure_inhibition" in codes) == (silicone == "tin_a25" and name.startswith("ecoflex"))
        assert ("bonding" in codes) == name.startswith("ecoflex")
    assert is_tin("my tin mould") and is_tin("condensation_25") and not is_tin("platinum_a20") and not is_tin("setting")


def test_only_polyurethane_is_said_to_bond_as_polyurethane():
    for name, ratio in (("ecoflex-00-30", 20.0), ("polyurethane-nagoya", 15.0)):
        _, codes = written(mould_spec(8.0, 90.0, 70.0, "printed", name, ratio))
        assert ("polyurethane" in codes["printed_mould"]) == (name == "polyurethane-nagoya")


def test_a_declared_chemistry_is_kept(tmp_path):
    resin = dataclasses.replace(BASE, name="mine", chemistry="tin silicone")
    assert load_resin(str(save_resin(resin, tmp_path / "mine.toml"))).chemistry == "tin silicone"


def test_one_fixed_mix_is_weighed(tmp_path):
    """ratio_min = ratio_max with the law of one modulus, by weight and by volume."""
    for by in ("weight", "volume"):
        young = dataclasses.replace(BASE.numbers["young_ref_kPa"], kind="measured")
        resin = dataclasses.replace(
            BASE,
            name="fixed",
            ratio_min=85.0,
            ratio_max=85.0,
            ratio_step=1.0,
            ratio_by=by,
            law=LAWS["fixed"],
            numbers={"young_kPa": young},
            relaxation_ratio_ref=85.0,
            ratio_meaning=f"B per 100 A by {by}",
        )
        again = load_resin(str(save_resin(resin, tmp_path / f"{by}.toml")))
        spec = mould_spec(8.0, 90.0, 70.0, resin=again, ratio=85.0)
        mix = batch_of(spec, spec.pour, pour_plan(spec)).mix
        assert mix.ratio == pytest.approx(85.0, rel=0.01)
        with raises_code("out_of_range", "ratio"):
            mould_spec(8.0, 90.0, 70.0, resin=again, ratio=15.0)


def test_what_the_mould_takes_is_what_is_poured():
    """The batch holds cup loss and spare; neither is said to fill the mould."""
    for thickness in np.random.default_rng().uniform(4.0, 9.0, 3):
        spec = mould_spec(thickness, 90.0, 70.0)
        plan, (text, codes) = pour_plan(spec), written(spec)
        batch = batch_of(spec, spec.pour, plan)
        assert batch.raised and batch.pour_g < plan.batch_mass_g
        assert not re.search(r"needs only|fill the mould", text + codes["small_batch"])
        assert f"pour {batch.pour_g:.1f} g of it into the mould" in text
        assert f"With the loss in the cup and the spare {plan.batch_mass_g:.1f} g would do" in text


def test_pucks_mark_what_is_assumed(tmp_path):
    path = save_resin(
        dataclasses.replace(with_properties(drop=("pot_life_min", "cure_time_h")), name="my"), tmp_path / "my.toml"
    )
    spec = puck_spec(read_pucks("50x30"), resin=str(path), ratio=15.0)
    plan = puck_plan(spec)
    text = sheet_text(puck_sheet(spec, plan))
    assert "min (assumed)" in text and "h (assumed)" in text
    assert "assumed_numbers" in {item["code"] for item in warnings_of(spec, plan)}
