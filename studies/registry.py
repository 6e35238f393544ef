"""The studies: what builds shipped tables, data files and documents."""

from __future__ import annotations

from dataclasses import dataclass

PACKAGE = "studies"
TABLES = "materials/tables/"


@dataclass(frozen=True)
class Study:
    """One command that makes files of this repository.

    Attributes
    ----------
    module : str
        Module below ``studies``.
    arguments : str
        What the command needs beside the module, as typed.
    files : tuple of str
        Files it writes, from the repository's root.
    makes : str
        What they are.
    takes : str
        How long it takes on two cores, as it was measured; said when it was not.
    """

    module: str
    arguments: str
    files: tuple[str, ...]
    makes: str
    takes: str = "time not recorded"

    @property
    def command(self) -> str:
        """The command line that makes the files."""
        return f"python -m {PACKAGE}.{self.module} {self.arguments}".rstrip()


SHAPES = tuple(
    Study(
        "tables.shapes",
        f"{kind} --count {count} --fresh {fresh}",
        (f"{TABLES}{kind}-bonded.json",),
        f"response table of {kind} pads",
    )
    for kind, count, fresh in (("crowned", 494, 40), ("layered", 80, 40), ("boned", 80, 40))
)
STUDIES = (
    Study(
        "tables.slab",
        "",
        (f"{TABLES}slab-bonded.json", f"{TABLES}slab-sliding.json"),
        "response tables of slabs under a round, glued punch",
    ),
    Study(
        "tables.square",
        "",
        (f"{TABLES}square-bonded.json", f"{TABLES}square-sliding.json"),
        "square over circle of equal area, in space",
        "7 min of one core",
    ),
    Study(
        "tables.square_crown",
        "--store square-crown-solves.jsonl",
        (f"{TABLES}square-crowned.json",),
        "square over circle of equal area on crowns, in space",
        "40 min of one core",
    ),
    *SHAPES,
    Study(
        "tables.filleted",
        "",
        (f"{TABLES}filleted-bonded.json", f"{TABLES}filleted-sliding.json"),
        "slabs under punches with a filleted edge",
    ),
    Study(
        "tables.puck",
        "--keep",
        (f"{TABLES}puck-50x30.json",),
        "plate friction of a puck of 50 x 30 mm",
        "1 min of one core",
    ),
    Study(
        "tables.puck",
        "--shapes --keep",
        (f"{TABLES}puck-shapes.json",),
        "plate friction of pucks of other proportions",
        "some 6 min of one core",
    ),
    Study(
        "tables.separability",
        "",
        (f"{TABLES}quick-error.json",),
        "error of the quick prediction of motions",
        "--part shapes: 15 min of one core",
    ),
    Study(
        "tables.compressibility",
        "",
        (f"{TABLES}slab-compressibility.json",),
        "how a Poisson's ratio below 1/2 softens a slab",
    ),
    Study(
        "tables.elastic_law",
        "",
        (f"{TABLES}elastic-law.json",),
        "force of pads of an Ogden law over neo-Hookean ones",
        "some 15 min of one core",
    ),
    Study(
        "tissues.infer",
        "--seed 1 --samples 200000",
        tuple(
            f"materials/tissues/{site}{end}"
            for site in ("forefinger", "palm", "thenar")
            for end in (".toml", "_draws.csv")
        ),
        "built-in tissues, inferred from published statements",
    ),
    Study(
        "resins.ecoflex",
        "",
        tuple(f"materials/resins/ecoflex-00-{grade}.toml" for grade in ("10", "30", "50")),
        "Ecoflex resins, fitted to public compression curves",
    ),
    Study(
        "resins.polyurethane_relaxation",
        "",
        ("materials/resins/polyurethane-nagoya.toml",),
        "relaxation of the polyurethane, printed to be entered by hand",
    ),
    Study(
        "paper_dummies.study",
        "",
        (
            "docs/dummies.md",
            *(
                f"docs/data/dummies{part}.csv"
                for part in ("", "-statements", "-figures", "-verdicts", "-at-once", "-exponents", "-peaks")
            ),
        ),
        "the published method's dummies",
        "2 min",
    ),
    Study(
        "thickness",
        "",
        ("docs/whatif.md", "docs/data/thickness.csv", "docs/data/thickness-curves.csv"),
        "what thickness does to a slab",
        "some minutes with --solve",
    ),
    Study(
        "shapes",
        "",
        ("docs/shapes.md", "docs/data/shapes.csv", "docs/data/shapes-designs.csv"),
        "what each shape reaches for each tissue",
        "6 min",
    ),
    Study("built_in", "", ("docs/design.md",), "recommended pads of the built-in tissues"),
    Study("shape_figure", "", ("docs/images/shapes.png",), "cross-sections of the best pads of a forefinger", "2 s"),
    Study(
        "real_data",
        "MEAT_DIR ADHESIVE_DIR",
        ("docs/real-data.md", "docs/data/real-data.csv"),
        "real presses of other laboratories, predicted from left-out presses",
        "3 min",
    ),
    Study(
        "limbs",
        "MULTIS_DIR",
        ("docs/real-data.md", "docs/data/limbs.csv"),
        "law of thickness over bone, on arms and legs of 95 people",
        "10 s",
    ),
    Study(
        "acrylic",
        "VHB_DIR PREDICTION_DIR",
        ("docs/real-data.md", "docs/data/acrylic.csv"),
        "stress of an acrylic at three rates, predicted from two curves",
        "10 s",
    ),
    Study(
        "pad_figures",
        "",
        tuple(
            f"docs/data/pad-{name}.csv"
            for name in ("sharp-error", "square", "quick-error", "base-friction", "fillet", "friction")
        ),
        "figures of the pad model",
        "2 min",
    ),
    Study("data_files", "", ("docs/data/README.md",), "list of the data files and where each is from", "1 s"),
    Study("verification", "", ("VERIFICATION.md",), "checks of the pad model against closed forms"),
    Study("call_traces", "", ("docs/architecture.md",), "ways of design, campaign and slider", "1 min"),
    Study("errors", "", ("docs/errors.md",), "list of error codes", "1 s"),
    Study("front_picture", "", ("docs/images/pad-and-force.png",), "picture of the README", "1 min"),
    Study(
        "on_person_figures",
        "",
        tuple(f"docs/images/on-person-{drive}.svg" for drive in ("position", "steady", "force", "mass", "spring")),
        "one press on people under each drive",
    ),
    Study("loop_figure", "", ("docs/images/loop.svg",), "the loop on one simulated campaign", "30 s"),
    Study("architecture", "", ("docs/images/architecture.svg",), "picture of the rooms", "1 s"),
)
"""All studies, tables first."""


@dataclass(frozen=True)
class DataFile:
    """A file of ``docs/data`` that no study above writes.

    Attributes
    ----------
    name : str
        File in ``docs/data``.
    command : str
        Command that measures it, as typed; empty for a list by hand.
    origin : str
        How it comes about: written, copied from what the command prints, or by hand, and from what.
    """

    name: str
    command: str
    origin: str


WRITTEN, COPIED, BY_HAND = "written by the command", "copied from what the command prints", "a list by hand"
DATA_FILES = (
    *(
        DataFile(f"castings-blind{part}.csv", "python -m benchmarks.accuracy.castings_blind", WRITTEN)
        for part in ("", "-classes")
    ),
    DataFile(
        "crowns-drawn.csv",
        "python -m benchmarks.accuracy.crowns_drawn --count 44 --seed 88127 --out FILE",
        f"{COPIED}; and --count 36 --seed 99013",
    ),
    DataFile(
        "fit-coverage.csv",
        "python -m benchmarks.accuracy.fit_coverage --draws 400 --seed SEED SEED --csv FILE",
        f"{COPIED}; two seeds, not recorded",
    ),
    *(
        DataFile(f"loop-blind{part}.csv", "python -m benchmarks.accuracy.loop_blind --table-only", WRITTEN)
        for part in ("", "-effects", "-errors", "-missed", "-unnamed")
    ),
    DataFile(
        "loop-detection.csv",
        "python -m benchmarks.accuracy.loop_detection --table --beside "
        "benchmarks/results/loop_independent_generator_10[45]*.jsonl",
        WRITTEN,
    ),
    DataFile("loop-ecoflex.csv", "python -m benchmarks.accuracy.loop_ecoflex DATA_DIR", WRITTEN),
    DataFile("loop-functions.csv", "python -m benchmarks.accuracy.loop_blind --table-only", WRITTEN),
    DataFile("loop-forms.csv", "", f"{BY_HAND} of the parameters of form in dummydesign/loop/effects"),
    DataFile("loop-rules.csv", "", f"{BY_HAND} of the constants in dummydesign/loop/selection"),
    DataFile("loop-turns.csv", "python -m benchmarks.accuracy.loop_turns", WRITTEN),
    DataFile(
        "mould-cost.csv",
        "python -m benchmarks.speed.mold_build",
        f"{COPIED}; rows 'before ...' are of an earlier version and cannot be measured again; shaped pads: "
        "by the same functions",
    ),
    DataFile("mould-gauge-points.csv", "", f"{BY_HAND} of gauge_places in dummydesign/geometry/shapes"),
    DataFile("mould-parts.csv", "", f"{BY_HAND} of the parts that dummydesign/mold/cad/build.py makes"),
    DataFile("mould-shape-limits.csv", "", f"{BY_HAND} of dummydesign/geometry/dimensions.py and the shapes' checks"),
    DataFile(
        "on-person-blind.csv",
        "python -m benchmarks.accuracy.on_person_blind --cases 240 --seed 417023 --out FILE",
        WRITTEN,
    ),
    DataFile("pad-checks.csv", "", f"{BY_HAND} of comparisons; its last column names the test or command of each"),
    DataFile("pad-getfem.csv", "python -m benchmarks.accuracy.pad_getfem --python PATH", f"{COPIED}; GetFEM is needed"),
    DataFile("pad-limits.csv", "", f"{BY_HAND} of where solved curves ended and the errors that they stated"),
    DataFile("pad-three-fillets.csv", "", f"{BY_HAND} of counts of one comparison; no command repeats it"),
    DataFile("pad-time.csv", "python -m benchmarks.speed.pad", f"{COPIED}; on one machine"),
    DataFile("people-share.csv", "python -m benchmarks.accuracy.people_share FILE.csv", WRITTEN),
    DataFile("puck-drawn.csv", "python -m benchmarks.accuracy.puck_shapes --drawn 10", COPIED),
    DataFile("puck-hold.csv", "python -m benchmarks.accuracy.puck_hold --draws 25 --csv FILE", COPIED),
    DataFile("puck-shapes.csv", "python -m benchmarks.accuracy.puck_shapes --csv FILE", WRITTEN),
    DataFile(
        "random-tissues.csv",
        "python -m benchmarks.accuracy.random_tissues --seed 31127",
        f"{COPIED}; rows of an earlier version, with the shape bumped",
    ),
    DataFile("shapes-model-checks.csv", "", f"{BY_HAND} of checks in VERIFICATION.md and in tests/pad/shaped"),
    DataFile("shapes-model-cubic.csv", "", f"{BY_HAND} of fits of crowns to a cubic law; no command repeats them"),
    DataFile("shapes-offset.csv", "python -m benchmarks.accuracy.pad_shaped_3d offset", COPIED),
    DataFile("suggest-keys.csv", "", f"{BY_HAND} of the keys of 'suggest --json'"),
    DataFile("upgrade.csv", "", f"{BY_HAND} of names that changed since 0.1.0"),
)
"""Every other file of ``docs/data``."""
