"""What the words mean that options can be given, for the end of a command's help."""

from __future__ import annotations

import argparse
import re

_HELD = {
    "bonded": "it sticks", "sliding": "it slides without friction and does not lift", "frictionless": "it slides",
    "friction:MU": "Coulomb's friction of coefficient MU",
}  # fmt: skip
MEANINGS: dict[str, dict[str, str]] = {
    "aim": {
        "average": "the middle of the subjects", "safe-side": "the largest of every parameter, the worst contact",
        "subject:NAME": "one of them",
    },
    "base": _HELD,
    "condition": _HELD,
    "campaign contact": _HELD,
    "punch": {
        "square:14": "flat, side in mm", "rectangle:AxB": "flat, sides in mm, taken as the circle of its area",
        "round:D": "flat, diameter in mm", "ball:D": "a ball, diameter in mm",
        "profile:FILE.csv": "turned, columns r_mm,z_mm", "plate": "two plates on a cylinder (--pad cylinder:D)",
    },
    "preset": {
        "open": "an open mould, struck off at its brim", "lidded": "closed by a lid with sprue and vents",
        "printed": "printed in two parts, without silicone", "a TOML file": "a preset of your own",
    },
    "fidelity": {
        "table": "finite elements solved beforehand, at once",
        "axisymmetric": "finite elements of a round pad, seconds",
        "3d": "finite elements in space, minutes", "viscoelastic": "the motion itself with relaxation, minutes",
    },
    "predict law": {
        "neo-hookean": "one modulus", "yeoh:C2_OVER_MU": "stiffens with strain, by its second coefficient",
        "ogden:MU,ALPHA": "a sum of powers of the stretches",
    },
    "fit law": {
        "ode": "the law along the measured motion", "published": "closed form of an ideal ramp and hold, as printed",
        "consistent": "closed form as it follows from the law",
    },
    "tissues law": {
        "ode": "the law along the measured motion", "published": "closed form of an ideal ramp and hold, as printed",
        "consistent": "closed form as it follows from the law",
    },
    "tissues kind": {
        "measured": "by yourself", "fitted": "to your measurements", "digitised": "copied from a text or figure",
        "inferred": "worked out from other numbers", "assumed": "not known",
    },
    "shape": {"auto": "the best of all", "puck": "a cylinder for a test between plates"},
}  # fmt: skip
"""By option, or by command and option where a word means several things. ``shape`` has the package's shapes besides."""


def meanings_of(command: str, action: argparse.Action) -> dict[str, str]:
    """What the words mean that an option lists in its help; empty for options without such words.

    Parameters
    ----------
    command : str
        Its name, with its action where it has any: ``campaign new``.
    action : argparse.Action
    """
    name = action.dest
    known = MEANINGS.get(f"{command.partition(' ')[0]} {name}", MEANINGS.get(name, {}))
    if name == "shape":
        from dummydesign.geometry.shape_names import shape_meanings

        known = shape_meanings() | known
    said = action.help or ""
    return {word: text for word, text in known.items() if re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", said)}


def choices_text(command: str, parser: argparse.ArgumentParser) -> str:
    """The words of all options of a command with their meanings; empty where there are none."""
    rows = []
    for action in parser._actions:
        found = meanings_of(command, action)
        if found:
            rows.append(f"  {action.option_strings[-1]}")
            rows += [f"    {word:<17} {text}" for word, text in found.items()]
    return "what the choices mean:\n" + "\n".join(rows) if rows else ""
