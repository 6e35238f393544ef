"""Two examples of every command and of every action of one, shown at the end of its ``--help``."""

from __future__ import annotations

# A line on what it does, then the words after ``dummydesign``.
EXAMPLES: dict[str, tuple[tuple[str, str], ...]] = {
    "suggest": (
        ("the pad for a forefinger, its mould and report", "suggest --tissue forefinger"),
        ("the best slab for a palm, without CAD", "suggest --tissue palm --shape slab --no-cad"),
    ),
    "compare-designs": (
        ("two designs side by side", "compare-designs suggest-palm suggest-palm-2"),
        ("three designs, the report in a folder", "compare-designs a b c --out which-pad"),
    ),
    "predict": (
        ("force of a 10 mm slab of 30 kPa at three depths", "predict --young 30 --thickness 10 --depth 1,2,3"),
        (
            "stress inside a crowned pad, for ParaView",
            "predict --young 40 --thickness 8 --shape crowned:20,2,9 --depth 2 --fidelity axisymmetric --fields a.vtu",
        ),
    ),
    "whatif": (
        ("how the thickness changes the curve", "whatif --thickness 5:20:5 --ratio 15"),
        ("scores for a thenar over ratio and thickness", "whatif --thickness 5:20:5 --ratio 14:16:0.5 --tissue thenar"),
    ),
    "mold": (
        ("an open mould for a 5 mm pad", "mold --thickness 5"),
        ("a lidded mould for a 20 mm pad", "mold --thickness 20 --preset lidded --ratio 15.4 --out thenar"),
        ("the moulds of a campaign's pads, twice cast", "mold --thickness 5,15,20 --count 2 --out pads"),
    ),
    "import": (
        ("read what a test machine wrote", "import export.csv --out traces"),
        ("the same machine again, by its profile", "import monday.csv --profile my-zwick --out traces"),
    ),
    "fit": (
        ("parameters of the tissue law from two presses", "fit slow.csv fast.csv"),
        ("with a report", "fit slow.csv fast.csv --out fit.toml"),
    ),
    "compare": (
        ("a cast pad against a palm's ranges", "compare pad.csv --tissue palm"),
        ("with a report", "compare pad.csv --tissue palm --out compared"),
        ("in your own test", "compare pad.csv --tissue palm --force 2,4 --velocity 100 --hold 3 --punch round:12"),
    ),
    "campaign": (
        ("what to press, in which order, with a sheet to print", "campaign new my-dummy --young 25"),
        ("what is not yet pressed, or looks wrong", "campaign check my-dummy"),
    ),
    "loop": (
        ("trace a campaign to what the model lacks", "loop campaign"),
        ("with an effect of your own", "loop campaign --effect my_effect.py --out loop"),
    ),
    "replay": (
        ("predict another campaign with what was learned", "replay campaign2 --calibration loop/calibration.json"),
        ("the same as JSON", "replay campaign2 --calibration loop/calibration.json --json"),
    ),
    "tissues": (
        ("the tissues there are", "tissues list"),
        ("one of them with its sources", "tissues show palm"),
    ),
    "resins": (
        ("the resins there are", "resins list"),
        ("one of them with its sources", "resins show ecoflex-00-30"),
    ),
    "mold record": (
        ("what was poured, with its thickness at the gauge points of the pour sheet",
         "mold record mould_t5 --thickness middle=5,corner1=5.1,corner2=5,corner3=4.9,corner4=5 --mass 91"),
        ("with the modulus of a puck of the same pour",
         "mold record mould_t5 --thickness 5,5.1,5,4.9,5 --mass 91 --modulus 26"),
    ),
    "campaign new": (
        ("pads of 25 kPa, presses in random order", "campaign new my-dummy --young 25"),
        ("two pads, two forces, three days, other punch",
         "campaign new my-dummy --young 25 --pads 5,15 --force 3,9 --ages 9,14,29 --punch round:16"),
        ("the pads of two moulds that were made", "campaign new my-dummy --from-mould moulds/mould_t5,moulds/mould_t8"),
    ),
    "campaign check": (
        ("what is not yet pressed, or looks wrong", "campaign check my-dummy"),
        ("the same as JSON", "campaign check my-dummy --json"),
    ),
    "campaign from-files": (
        ("traces whose names say what they are", "campaign from-files my-dummy t05_v010_f03_1.csv t05_v250_f03_1.csv"),
        ("with a table of the presses", "campaign from-files my-dummy a.csv b.csv --table trials.csv --young 25"),
    ),
    "tissues list": (
        ("the tissues there are", "tissues list"),
        ("the same as JSON", "tissues list --json"),
    ),
    "tissues show": (
        ("every number of a tissue with its source", "tissues show palm"),
        ("of a file of your own", "tissues show tissue/mine.toml"),
    ),
    "tissues add": (
        ("from one folder of traces a person", "tissues add my-thumb anna bert carla"),
        ("from fits", "tissues add my-thumb anna.toml bert.toml --elements 5"),
    ),
    "tissues add-curves": (
        ("from one table of several people's curves", "tissues add-curves my-thumb curves.csv"),
        ("by the closed form as printed", "tissues add-curves my-thumb curves.csv --law published"),
    ),
    "tissues add-points": (
        ("points of a figure into a tissue of your own", "tissues add-points my-thumb points.csv"),
        ("the same as JSON", "tissues add-points my-thumb points.csv --json"),
    ),
    "tissues add-spring": (
        ("a spring constant with its spread", "tissues add-spring my-arm --stiffness 30 --spread 20% --source mine"),
        ("with its unit", "tissues add-spring my-arm --stiffness 30kN/m --source mine --replace"),
    ),
    "tissues template": (
        ("a table of body regions to fill", "tissues template regions.csv"),
        ("the same as JSON", "tissues template regions.csv --json"),
    ),
    "tissues add-regions": (
        ("a tissue of every filled row", "tissues add-regions regions.csv"),
        ("again, after a correction", "tissues add-regions regions.csv --replace"),
    ),
    "tissues remove": (
        ("delete a tissue of your own", "tissues remove my-thumb"),
        ("saying what was deleted as JSON", "tissues remove my-thumb --json"),
    ),
    "tissues rename": (
        ("another name", "tissues rename my-thumb thumb-2024"),
        ("the same as JSON", "tissues rename my-thumb thumb-2024 --json"),
    ),
    "tissues path": (
        ("where the file lies", "tissues path palm"),
        ("the same as JSON", "tissues path palm --json"),
    ),
    "resins list": (
        ("the resins there are", "resins list"),
        ("the same as JSON", "resins list --json"),
    ),
    "resins show": (
        ("every number of a resin with its source", "resins show polyurethane-nagoya"),
        ("with a plot of modulus over ratio", "resins show polyurethane-nagoya --out resin"),
    ),
    "resins add": (
        ("keep a resin file", "resins add my-resin.toml"),
        ("in the place of the one of this name", "resins add my-resin.toml --replace"),
    ),
    "resins add-compression": (
        ("a puck pressed slowly between plates",
         "resins add-compression puck.csv --diameter 29 --height 12.5 --name my-batch --ratio 15"),
        ("a batch of a known resin",
         "resins add-compression puck.csv --diameter 29 --height 12.5 --name my-batch --ratio 15 "
         "--resin polyurethane-nagoya"),
    ),
    "resins remove": (
        ("delete a resin of your own", "resins remove my-batch"),
        ("saying what was deleted as JSON", "resins remove my-batch --json"),
    ),
    "resins rename": (
        ("another name", "resins rename my-batch batch-7"),
        ("the same as JSON", "resins rename my-batch batch-7 --json"),
    ),
    "resins path": (
        ("where the file lies", "resins path ecoflex-00-30"),
        ("the same as JSON", "resins path ecoflex-00-30 --json"),
    ),
    "init": (
        ("a folder for everything about one dummy", "init thumb"),
        ("with the defaults of its commands", "init thumb --tissue thenar --resin ecoflex-00-30 --aim safe-side"),
    ),
    "status": (
        ("where the project one stands in is, and what to do next", "status"),
        ("of another folder, as JSON", "status thumb --json"),
    ),
    "studio": (
        ("the folder one stands in, in the browser", "studio"),
        ("another folder, at an address of one's own", "studio thumb --port 9000 --no-browser"),
    ),
}  # fmt: skip


def examples_of(command: str) -> str:
    """The end of a command's help: its examples, or nothing."""
    rows = [f"  {what}:\n    dummydesign {words}" for what, words in EXAMPLES.get(command, ())]
    return "examples:\n" + "\n".join(rows) if rows else ""
