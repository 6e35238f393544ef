"""Public functions say what their arguments are: numpy style, with shape and unit.

This holds for what people outside call. Public is a function, or a method of a class, whose own name and all names on
the way to it (packages, module, class)
have no leading underscore. One of three or more arguments, ``self`` and ``cls`` not counted, has a Parameters section
that names each of them, and none that it does not have. An entry has a description (not needed when its type is a
class of the package); that of an array says its shape, or that it is broadcast; that of a name that ends in a unit has
the unit in square brackets. A method may leave all this to the method of a base class that it overrides, and any
function to the definition of the same arguments that its docstring names with "see", such as the contract of a family
of classes: ``see :class:`dummydesign.pad.force_law.ForceLaw```.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import pydoc
import re
from collections.abc import Iterator
from types import FunctionType
from typing import Any

import pytest

import dummydesign

OUTWARD = (
    "api",
    "core.errors",
    "core.quantity",
    "geometry.pad_shape",
    "loop.effects.contract_check",
    "loop.model.effect",
    "measurement.campaign",
    "measurement.campaign_file",
    "measurement.importing.read",
    "measurement.trace",
    "pad.force_law",
    "resin.model.resin",
    "resin.model.resin_file",
    "tissue.model.maxwell_law",
    "tissue.model.tissue",
    "tissue.model.tissue_file",
    "design.search.shape_family",
)
"""What people outside call or derive from: the calls for scripts, the contracts, the readers."""
FEWEST = 3
UNITS = {
    "mm": "mm",
    "mm2": "mm2",
    "mm3": "mm3",
    "mm_s": "mm/s",
    "N": "N",
    "s": "s",
    "ms": "ms",
    "MPa": "MPa",
    "kPa": "kPa",
    "GPa": "GPa",
    "Pa": "Pa",
    "Pa_s": "Pa s",
    "deg": "deg",
    "rad": "rad",
    "K": "K",
    "C": "C",
    "g": "g",
    "kg": "kg",
    "h": "h",
    "Hz": "Hz",
    "N_mm": "N/mm",
    "ml": "ml",
    "per_K": "1/K",
    "g_per_cm3": "g/cm3",
    "N_per_m": "N/m",
    "mm_s2": "mm/s2",
    "N_per_mm3": "N/mm3",
    "N_s_per_mm": "N s/mm",
}
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: : (.+))?$")
ARRAY = re.compile(r"ndarray|NDArray|ArrayLike|\bArray\b")
SEE = re.compile(r"[Ss]ee\s+:(?:class|meth|func):`~?([\w.]+)`")
SHAPED = re.compile(r"shape|\(\w*[,)]|broadcast|As (for|in)|scalar")


def modules(name: str) -> Iterator[Any]:
    top = importlib.import_module(f"dummydesign.{name}")
    yield top
    for item in pkgutil.walk_packages(getattr(top, "__path__", ()), f"{top.__name__}."):
        if not any(part.startswith("_") for part in item.name.split(".")):
            yield importlib.import_module(item.name)


def documented(module: Any, follow: bool = True) -> Iterator[tuple[str, FunctionType, list[str]]]:
    """Name, function and docstrings (its own, then those it overrides or names) of what a module defines."""
    for name, thing in vars(module).items():
        if name.startswith("_") or getattr(thing, "__module__", None) != module.__name__:
            continue
        function = inspect.unwrap(thing) if callable(thing) and not inspect.isclass(thing) else None
        if isinstance(function, FunctionType):
            yield (
                f"{module.__name__}.{name}",
                function,
                [function.__doc__ or "", *(named(function, module) if follow else ())],
            )
        if inspect.isclass(thing):
            for key, member in vars(thing).items():
                member = getattr(member, "__func__", member)
                if key.startswith("_") or not isinstance(member, FunctionType):
                    continue
                overridden = [getattr(base, key).__doc__ or "" for base in thing.__mro__ if hasattr(base, key)]
                yield (
                    f"{module.__name__}.{name}.{key}",
                    member,
                    [member.__doc__ or "", *overridden, *(named(member, module) if follow else ())],
                )


def named(function: FunctionType, module: Any) -> Iterator[str]:
    """Docstrings of the definitions that a docstring names with "see"; of a class, its method of the same name."""
    for path in SEE.findall(function.__doc__ or ""):
        found = pydoc.locate(f"{module.__name__}.{path}") or pydoc.locate(path)
        assert found is not None, f"{module.__name__}.{function.__qualname__} names {path}, which is not there"
        same = getattr(found, function.__name__, None) if inspect.isclass(found) else found
        yield getattr(same, "__doc__", None) or ""


def arguments(function: FunctionType) -> dict[str, str]:
    """Names and annotations of the arguments, without ``self`` and ``cls``."""
    given = inspect.signature(function).parameters.values()
    return {item.name: str(item.annotation) for item in given if item.name not in ("self", "cls")}


def parameters_section(docstring: str) -> dict[str, tuple[str, str]] | None:
    """Entries of a numpy Parameters section: type and description by name; None without a section."""
    lines = inspect.cleandoc(docstring).splitlines()
    start = next((at for at, line in enumerate(lines[:-1]) if line == "Parameters" and lines[at + 1] == "-" * 10), None)
    if start is None:
        return None
    entries: dict[str, tuple[str, str]] = {}
    names: list[str] = []
    for at in range(start + 2, len(lines)):
        line = lines[at]
        if at + 1 < len(lines) and lines[at + 1].startswith("---"):
            break
        entry = ENTRY.match(line)
        if entry:
            names = [name.strip("* ") for name in entry[1].split(",")]
            entries.update({name: (entry[2] or "", "") for name in names})
        elif line.startswith("    "):
            entries.update({name: (entries[name][0], f"{entries[name][1]} {line.strip()}".strip()) for name in names})
    return entries


def faults(wanted: dict[str, str], docstring: str) -> list[str]:
    """What is wrong with the Parameters section of a function with these arguments; none when nothing is."""
    entries = parameters_section(docstring)
    if entries is None:
        return ["has no Parameters section"]
    found = [f"names {name}, which is not an argument" for name in entries if name not in wanted]
    for name, annotation in wanted.items():
        if name not in entries:
            found.append(f"does not name {name}")
            continue
        kind, text = entries[name]
        whole = f"{kind} {text}"
        if not (text or kind[:1].isupper()):
            found.append(f"does not describe {name}")
        if ARRAY.search(annotation) and "Callable" not in annotation and not SHAPED.search(whole):
            found.append(f"does not give the shape of {name}")
        unit = unit_of(name)
        stated = re.search(rf"\[[^\]]*(?<![\w/]){re.escape(unit)}(?![\w/])[^\]]*\]", whole)
        if unit and not stated and "As " not in text:
            found.append(f"does not give the unit of {name}, [{unit}]")
    return found


def unit_of(name: str) -> str:
    """The unit that a name ends in; empty without one."""
    ends = [end for end in UNITS if name.endswith(f"_{end}")]
    return UNITS[max(ends, key=len)] if ends else ""


def complaints(outward: str) -> list[str]:
    found = []
    for module in modules(outward):
        for name, function, docstrings in documented(module):
            wanted = arguments(function)
            if len(wanted) >= FEWEST and all(faults(wanted, text) for text in docstrings):
                found += [f"{name} {fault}" for fault in faults(wanted, docstrings[0])]
    return found


@pytest.mark.parametrize("outward", OUTWARD)
def test_what_people_outside_call_says_what_each_argument_is(outward):
    assert complaints(outward) == []


def test_every_function_and_class_of_the_package_has_a_docstring_unless_private():
    """One line suffices inside; a method may leave it to the one it overrides."""
    bare = []
    for item in pkgutil.walk_packages(dummydesign.__path__, "dummydesign."):
        if not any(part.startswith("_") for part in item.name.split(".")):
            module = importlib.import_module(item.name)
            bare += [
                name for name, _, texts in documented(module, follow=False) if not any(text.strip() for text in texts)
            ]
    assert bare == []


def three(time_s, force_N, name):
    """Fit.

    Parameters
    ----------
    time_s, force_N : ndarray, shape (n,)
        A trace. [s, N]
    name : str
        What the trace is called in messages.
    """


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("name : str", "title : str", "names title, which is not an argument"),
        ("name : str", "title : str", "does not name name"),
        ("[s, N]", "[s]", "does not give the unit of force_N, [N]"),
        ("What the trace is called in messages.", "", "does not describe name"),
        ("ndarray, shape (n,)", "ndarray", "does not give the shape of time_s"),
        ("Parameters", "Arguments", "has no Parameters section"),
    ],
)
def test_a_faulty_section_is_complained_of(old, new, fault):
    wanted = {"time_s": "NDArray", "force_N": "NDArray", "name": "str"}
    assert faults(wanted, three.__doc__) == []
    assert fault in faults(wanted, three.__doc__.replace(old, new))


def test_names_with_a_unit_are_recognised_by_their_longest_ending():
    assert [unit_of(name) for name in ("speed_mm_s", "expansion_per_K", "hold_s", "bins")] == ["mm/s", "1/K", "s", ""]
