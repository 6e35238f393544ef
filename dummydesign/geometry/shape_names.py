"""Names of the shapes, known by their modules without loading them: for help texts, which load nothing heavy."""

from __future__ import annotations

import ast
import pkgutil
from pathlib import Path

DEFAULT = "slab"
_FOLDER = Path(__file__).with_name("shapes")


def shape_names() -> tuple[str, ...]:
    """Names of the package's shapes, the slab first; a module of ``geometry/shapes`` is a shape of its name."""
    found = {item.name for item in pkgutil.iter_modules([str(_FOLDER)])}
    return DEFAULT, *sorted(found - {DEFAULT})


def shape_help(*more: str, default: str = DEFAULT) -> str:
    """The shapes as help texts list them, with further names at the end.

    Parameters
    ----------
    more : str
        What else the option takes.
    default : str
        Which of them is taken when none is typed.
    """
    return ", ".join(f"{name} (default)" if name == default else name for name in (*shape_names(), *more))


def shape_meanings() -> dict[str, str]:
    """What each shape is: the first line of its module, without loading it."""
    found = {}
    for name in shape_names():
        text = (_FOLDER / f"{name}.py").read_text(encoding="utf-8")
        line = (ast.get_docstring(ast.parse(text)) or name).splitlines()[0].rstrip(".")
        found[name] = line[0].lower() + line[1:]
    return found
