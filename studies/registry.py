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
        "tables.shapes", f"{kind} --count {count} --fresh {fresh}", (f"{TABLES}{kind}-bonded.json",),
        f"response table of {kind} pads",
    )
    for kind, count, fresh in (("crowned", 494, 40), ("layered", 80, 40), ("boned", 80, 40), ("bumped", 60, 20))
)
STUDIES = (
    Study(
        "tables.slab", "", (f"{TABLES}slab-bonded.json", f"{TABLES}slab-sliding.json"),
        "response tables of slabs under a round, glued punch",
    ),
    Study(
        "tables.square", "", (f"{TABLES}square-bonded.json", f"{TABLES}square-sliding.json"),
        "square over circle of equal area, in space", "7 min of one core",
    ),
    *SHAPES,
    Study(
        "tables.filleted", "", (f"{TABLES}filleted-bonded.json", f"{TABLES}filleted-sliding.json"),
        "slabs under punches with a filleted edge",
    ),
    Study(
        "tables.puck", "--keep", (f"{TABLES}puck-50x30.json",), "plate friction of a puck of 50 x 30 mm",
        "1 min of one core",
    ),
    Study(
        "tables.puck", "--shapes --keep", (f"{TABLES}puck-shapes.json",),
        "plate friction of pucks of other proportions", "some 6 min of one core",
    ),
    Study(
        "tables.separability", "", (f"{TABLES}quick-error.json",), "error of the quick prediction of motions",
        "--part shapes: 4 min of one core",
    ),
    Study(
        "tables.compressibility", "", (f"{TABLES}slab-compressibility.json",),
        "how a Poisson's ratio below 1/2 softens a slab",
    ),
    Study(
        "tissues.infer", "--seed 1 --samples 200000",
        tuple(f"materials/tissues/{site}{end}" for site in ("forefinger", "palm", "thenar")
              for end in (".toml", "_draws.csv")),
        "built-in tissues, inferred from published statements",
    ),
    Study(
        "resins.ecoflex", "", tuple(f"materials/resins/ecoflex-00-{grade}.toml" for grade in ("10", "30", "50")),
        "Ecoflex resins, fitted to public compression curves",
    ),
    Study(
        "resins.polyurethane_relaxation", "", ("materials/resins/polyurethane-nagoya.toml",),
        "relaxation of the polyurethane, printed to be entered by hand",
    ),
    Study(
        "paper_dummies.study", "",
        ("docs/dummies.md", *(f"docs/data/dummies{part}.csv" for part in (
            "", "-statements", "-figures", "-verdicts", "-at-once", "-exponents", "-peaks"))),
        "the published method's dummies", "2 min",
    ),
    Study(
        "thickness", "", ("docs/whatif.md", "docs/data/thickness.csv", "docs/data/thickness-curves.csv"),
        "what thickness does to a slab", "some minutes with --solve",
    ),
    Study(
        "shapes", "", ("docs/shapes.md", "docs/data/shapes.csv", "docs/data/shapes-designs.csv"),
        "what each shape reaches for each tissue", "6 min",
    ),
    Study("shape_figure", "", ("docs/images/shapes.png",), "cross-sections of the best pads of a forefinger", "2 s"),
    Study(
        "real_data", "MEAT_DIR ADHESIVE_DIR", ("docs/real-data.md", "docs/data/real-data.csv"),
        "real presses of other laboratories, predicted from left-out presses", "3 min",
    ),
    Study("verification", "", ("VERIFICATION.md",), "checks of the pad model against closed forms"),
    Study("ways", "", ("docs/architecture.md",), "ways of design, campaign and slider", "1 min"),
    Study("errors", "", ("docs/errors.md",), "list of error codes", "1 s"),
    Study("architecture", "", ("docs/images/architecture.svg",), "picture of the rooms", "1 s"),
)  # fmt: skip
"""All studies, tables first."""
