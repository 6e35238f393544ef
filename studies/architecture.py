"""The picture of docs/architecture.md, drawn from the imports: ``python -m studies.architecture``.

Rooms stand in the order of their layers. A number in row A and column B says how many imports of room A take
something from room B. With no upward arrow everything lies right of the diagonal, where the lower layers are.
"""

from __future__ import annotations

import argparse
import ast
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.files import write_text

PACKAGE = "dummydesign"
PICTURE = Path("docs") / "images" / "architecture.svg"
ROOMS = (
    ("studies", "builds shipped tables, data files and documents"),
    ("cli", "arguments in, printed answer out"),
    ("studio", "pages in the browser over a project folder"),
    ("api", "the calls for scripts"),
    ("project", "project folder: defaults, where it stands"),
    ("report", "one-page HTML, plots, CSV; computes nothing"),
    ("person", "a press on a pad, carried over to people"),
    ("design", "targets, search, assessment, sweeps"),
    ("loop", "campaign, residual, missing effect, calibration"),
    ("mold", "mould: specification, solids, files, checks"),
    ("tissue", "five-element law, fit, bands of subjects"),
    ("resin", "ratio to modulus, own batches, puck test"),
    ("inference", "reduction, noise, least squares, profiles"),
    ("pad", "finite elements, response tables, relaxation"),
    ("measurement", "motions, sensor, traces, campaigns"),
    ("geometry", "shapes of pads: outline, volume, limits, words"),
    ("core", "errors, files, data files, cache"),
)
"""Rooms from the top layer down, with what each holds; tissue and resin share a layer."""
ROW, LEFT, TOP, COLUMN = 30, 490, 120, 44


@dataclass(frozen=True)
class House:
    """What the picture shows: modules and lines by room, and imports from room to room."""

    modules: Counter[str]
    lines: Counter[str]
    imports: Counter[tuple[str, str]]


def room_of(module: str) -> str:
    """Room of a dotted module name; modules beside the rooms (the front door) belong to ``api``."""
    parts = module.split(".")
    if parts[-1] == "__main__" and len(parts) == 2:
        return "cli"
    return parts[1] if len(parts) > 1 and parts[1] in dict(ROOMS) else "api"


def read_house(package: Path) -> House:
    """Count modules, lines and imports by room; type-only imports are left out.

    Parameters
    ----------
    package : Path
        Folder of the package.
    """
    modules: Counter[str] = Counter()
    lines: Counter[str] = Counter()
    imports: Counter[tuple[str, str]] = Counter()
    for path in sorted(package.rglob("*.py")):
        name = ".".join([PACKAGE, *path.relative_to(package).with_suffix("").parts])
        text = path.read_text(encoding="utf-8")
        here = room_of(name)
        modules[here] += path.name != "__init__.py"
        lines[here] += text.count("\n")
        for taken in imported(ast.parse(text)):
            there = room_of(taken)
            if there != here and not taken.endswith("_version"):
                imports[here, there] += 1
    return House(modules, lines, imports)


def imported(tree: ast.Module) -> list[str]:
    """Modules of this package that a module imports, lazy imports included, type-only ones not."""
    names = []
    for node in _imports(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        else:
            module = node.module or ""
            names += [f"{module}.{alias.name}" if module == PACKAGE else module for alias in node.names[:1]]
    return [name for name in names if name.split(".")[0] == PACKAGE]


def _imports(tree: ast.Module) -> list[ast.Import | ast.ImportFrom]:
    """Import statements that run, those inside functions too."""
    found: list[ast.Import | ast.ImportFrom] = []
    left: list[ast.AST] = [tree]
    while left:
        node = left.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            found.append(node)
        elif not (isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)):
            # only statements hold imports: expressions need not be walked
            inner = ast.iter_child_nodes(node)
            left += [one for one in inner if isinstance(one, ast.stmt | ast.ExceptHandler | ast.match_case)]
    return found


def module_imports(package: Path) -> dict[str, set[str]]:
    """Modules of the package that each module imports, those inside functions too."""
    names = {
        path: ".".join([PACKAGE, *path.relative_to(package).with_suffix("").parts]) for path in package.rglob("*.py")
    }
    known = {name.removesuffix(".__init__") for name in names.values()}
    imports: dict[str, set[str]] = {}
    for path, dotted in names.items():
        name = dotted.removesuffix(".__init__")
        taken = {
            one if one in known else one.rpartition(".")[0] for one in every_import(ast.parse(path.read_text("utf-8")))
        }
        imports[name] = {one for one in taken & known if one != name and not name.startswith(f"{one}.")}
    return imports


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Groups of modules that import one another, directly or by way of others."""

    def reach(start: str) -> set[str]:
        seen: set[str] = set()
        left = [start]
        while left:
            new = graph.get(left.pop(), set()) - seen
            seen |= new
            left += new
        return seen

    reached = {name: reach(name) for name in graph}
    groups = {
        tuple(sorted(n for n in graph if n in reached[one] and one in reached[n]))
        for one in graph
        if one in reached[one]
    }
    return [list(group) for group in sorted(groups)]


def every_import(tree: ast.Module) -> list[str]:
    """As :func:`imported`, one dotted name for each name that is taken."""
    names = []
    for node in _imports(tree):
        base = "" if isinstance(node, ast.Import) else f"{node.module}."
        names += [f"{base}{alias.name}" for alias in node.names]
    return [name for name in names if name.split(".")[0] == PACKAGE]


def upward(house: House) -> list[tuple[str, str]]:
    """Pairs of rooms whose imports run from a lower layer to a higher one, or between tissue and resin."""
    order = [name for name, _ in ROOMS]
    same = {"tissue", "resin"}
    return sorted(pair for pair in house.imports if order.index(pair[0]) > order.index(pair[1]) or set(pair) == same)


def draw(house: House) -> str:
    """The picture as SVG text."""
    width, height = LEFT + COLUMN * len(ROOMS) + 20, TOP + ROW * len(ROOMS) + 40
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
        'font-size="12">',
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        f'<text x="10" y="24" font-size="16" fill="#1a1a1a">The rooms of {PACKAGE}, top layer first</text>',
        '<text x="10" y="44" fill="#555555">modules and lines of each room; row takes from column, number of '
        "imports</text>",
    ]
    for number, (name, words) in enumerate(ROOMS):
        y = TOP + ROW * number
        fill = "#f2f5f9" if number % 2 else "#ffffff"
        out.append(f'<rect x="6" y="{y}" width="{width - 12}" height="{ROW}" fill="{fill}"/>')
        out.append(f'<text x="12" y="{y + 19}" font-weight="bold" fill="#1a1a1a">{name}</text>')
        out.append(f'<text x="116" y="{y + 19}" fill="#333333">{words}</text>')
        count = f"{house.modules[name]} / {house.lines[name]}"
        out.append(f'<text x="{LEFT - 8}" y="{y + 19}" text-anchor="end" fill="#555555">{count}</text>')
        x = LEFT + COLUMN * number
        out.append(
            f'<text x="{x + 24}" y="{TOP - 8}" transform="rotate(-50 {x + 24} {TOP - 8})" fill="#1a1a1a">{name}</text>'
        )
        out.append(f'<rect x="{x + 2}" y="{y + 2}" width="{COLUMN - 4}" height="{ROW - 4}" fill="#c9d3df"/>')
    order = [name for name, _ in ROOMS]
    for (taker, giver), count in sorted(house.imports.items()):
        x, y = LEFT + COLUMN * order.index(giver), TOP + ROW * order.index(taker)
        down = order.index(giver) > order.index(taker)
        fill = "#2b6cb0" if down else "#c53030"
        out.append(f'<rect x="{x + 2}" y="{y + 2}" width="{COLUMN - 4}" height="{ROW - 4}" fill="{fill}" rx="3"/>')
        out.append(f'<text x="{x + COLUMN / 2:g}" y="{y + 19}" text-anchor="middle" fill="#ffffff">{count}</text>')
    return "\n".join([*out, "</svg>", ""])


def main(arguments: list[str] | None = None) -> None:
    """Draw the picture of the repository one stands in."""
    parser = argparse.ArgumentParser(prog="python -m studies.architecture", description=__doc__)
    parser.add_argument("--repository", type=Path, default=Path("."), help="folder that holds docs/")
    options = parser.parse_args(arguments)
    house = read_house(options.repository / PACKAGE)
    write_text(options.repository / PICTURE, draw(house))
    print(f"{PICTURE}: {sum(house.modules.values())} modules, {sum(house.lines.values())} lines")
    for taker, giver in upward(house):
        print(f"upward: {taker} takes from {giver}")


if __name__ == "__main__":
    main()
