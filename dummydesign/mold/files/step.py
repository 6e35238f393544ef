"""Write and read STEP AP242, the same text for the same model."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.cad.parts import Part
from dummydesign.mold.cad.solids import rough_bounds

_STATEMENT = re.compile(r"#(\d+)\s*=\s*((?:[^;']++|'(?:[^']|'')*')*);")
_STRING_OR_SPACE = re.compile(r"('(?:[^']|'')*')|\s+")
_STRING_OR_REFERENCE = re.compile(r"('(?:[^']|'')*')|#(\d+)")
_REFERENCE = re.compile(r"#(\d+)")
_PIECE = re.compile(r"(?:'(?:[^']|'')*'|[^,'])*,?")
_OCCURRENCE = re.compile(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*',('(?:[^']|'')*')")
_BEYOND_ASCII = re.compile(r"[^\x00-\x7f]+")
_LINE = 78


ORGANISATION = "dummydesign"


def canonical_step(text: str, name: str, description: str) -> str:
    """Return the same model with a fixed header, in an order and a numbering that depend on content alone."""
    text = _in_ascii(text)
    start, schema = text.find("DATA;"), re.search(r"FILE_SCHEMA\s*\(\s*\(\s*('[^']*')", text)
    if start < 0 or schema is None:
        raise ValueError("not a STEP file: no DATA section or no FILE_SCHEMA")
    entities = {int(number): _without_spaces(body) for number, body in _STATEMENT.findall(text, start)}
    _repair_density_unit(entities)
    for number, body in entities.items():
        if body.startswith("NEXT_ASSEMBLY_USAGE_OCCURRENCE"):
            entities[number] = _OCCURRENCE.sub(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE(\1,\1", body)
    parts = {number: _split(body) for number, body in entities.items()}
    digests = _digests(parts)
    for number, body in entities.items():
        if body.startswith("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"):
            parts[number] = _split(_sorted_items(body, digests))
    renumbered = {old: f"#{new}" for new, old in enumerate(_depth_first(parts, digests), 1)}
    lines = [_wrapped(f"{new}={_joined(parts[old], renumbered)};") for old, new in renumbered.items()]
    name, description, who = _quoted(name), _quoted(description), _quoted(ORGANISATION)
    head = [
        "ISO-10303-21;",
        "HEADER;",
        f"FILE_DESCRIPTION(({description}),'2;1');",
        f"FILE_NAME({name},{_quoted(time_stamp())},({who}),({who}),{who},{who},'');",
        f"FILE_SCHEMA(({schema.group(1)}));",
        "ENDSEC;",
        "DATA;",
    ]
    return "\n".join([*head, *lines, "ENDSEC;", "END-ISO-10303-21;", ""])


def _is_plain(body: str) -> bool:
    """Whether all strings of an entity are empty, as most are: nothing in it has to be left alone."""
    return "'" not in body.replace("''", "")


def _without_spaces(body: str) -> str:
    if _is_plain(body):
        return "".join(body.split())
    return _STRING_OR_SPACE.sub(lambda hit: hit.group(1) or "", body)


def _split(body: str) -> tuple[list[str], list[int]]:
    """What stands before, between and after the references of an entity, and the numbers they refer to."""
    if _is_plain(body):
        pieces = _REFERENCE.split(body)
        return pieces[::2], [int(number) for number in pieces[1::2]]
    texts, refers, start = [], [], 0
    for hit in _STRING_OR_REFERENCE.finditer(body):
        if hit.group(2):
            texts.append(body[start : hit.start()])
            refers.append(int(hit.group(2)))
            start = hit.end()
    return [*texts, body[start:]], refers


def _joined(parts: tuple[list[str], list[int]], names: dict[int, str]) -> str:
    """An entity with a name for each number that it refers to."""
    texts, refers = parts
    if not refers:
        return texts[0]
    return texts[0] + "".join([names[number] + text for number, text in zip(refers, texts[1:])])


def _digests(parts: dict[int, tuple[list[str], list[int]]]) -> dict[int, str]:
    """Content hash of every entity, children first."""
    digests: dict[int, str] = {}
    for first in parts:
        stack = [first]
        while stack:
            number = stack[-1]
            if number in digests:
                stack.pop()
                continue
            if number not in parts:
                raise ValueError(f"entity #{number} is referred to but not in the file")
            missing = [child for child in parts[number][1] if child not in digests]
            if missing:
                stack.extend(missing)
                continue
            digests[number] = hashlib.blake2b(_joined(parts[number], digests).encode(), digest_size=12).hexdigest()
            stack.pop()
    return digests


def _sorted_items(body: str, digests: dict[int, str]) -> str:
    """Sort the list of styled items, whose order means nothing, by hash."""

    def ordered(hit: re.Match[str]) -> str:
        return f"'',({','.join(sorted(hit.group(1).split(','), key=lambda item: digests[int(item[1:])]))})"

    return re.sub(r"'.*?',\(([^)]*)\)", ordered, body, count=1)


def _depth_first(parts: dict[int, tuple[list[str], list[int]]], digests: dict[int, str]) -> list[int]:
    """Order of entities, each before what it refers to, from the roots sorted by type and hash."""
    children = {child for _, references in parts.values() for child in references}
    roots = [number for number in parts if number not in children]
    stack = sorted(roots, key=lambda n: (parts[n][0][0].split("(")[0], digests[n]), reverse=True)
    seen: dict[int, None] = {}
    while stack:
        number = stack.pop()
        if number not in seen:
            seen[number] = None
            stack.extend(reversed(parts[number][1]))
    return list(seen)


def _repair_density_unit(entities: dict[int, str]) -> None:
    """Write densities in g cm^-3: the kernel's writer gives its unit the exponents 3 and 2."""
    masses = {number for number, body in entities.items() if "MASS_UNIT()" in body}
    for body in [body for body in entities.values() if body.startswith("DERIVED_UNIT(")]:
        units = {n: int(_REFERENCE.findall(entities[n])[0]) for n in map(int, _REFERENCE.findall(body))}
        if len(units) == 2 and masses & set(units.values()):
            for n, unit in units.items():
                entities[n] = f"DERIVED_UNIT_ELEMENT(#{unit},{'1.' if unit in masses else '-3.'})"


def _quoted(text: str) -> str:
    return "'" + _in_ascii(text).replace("'", "''") + "'"


def _in_ascii(text: str) -> str:
    """Write letters beyond ASCII as ISO 10303-21 does in every edition, which all readers understand."""
    return _BEYOND_ASCII.sub(_hexadecimal, text)


def _hexadecimal(hit: re.Match[str]) -> str:
    letters = hit.group()
    bytes_each, code = (4, "utf-32-be") if max(letters) > "\uffff" else (2, "utf-16-be")
    return rf"\X{bytes_each}\{letters.encode(code).hex().upper()}\X0" + "\\"


def _wrapped(statement: str) -> str:
    """Break a long statement after commas outside strings."""
    if len(statement) <= _LINE:
        return statement
    lines, row = [], ""
    for piece in filter(None, _PIECE.findall(statement)):
        if row and len(row) + len(piece) > _LINE:
            lines.append(row)
            row = ""
        row += piece
    return "\n".join([*lines, row])


@dataclass(frozen=True)
class ReadPart:
    """What was found of one product when a STEP file was read again."""

    name: str
    volume_mm3: float
    bounds_mm: tuple[float, ...]
    solids: int
    valid: bool
    colour: tuple[float, float, float] | None
    material: str | None
    density_g_per_cm3: float | None
    declared_volume_mm3: float | None


def time_stamp() -> str:
    """Fixed stamp of the header: SOURCE_DATE_EPOCH when set, else the first second of 2000 (UTC)."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    seconds = int(given) if given.isdigit() else 946684800
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(seconds))


def step_text(parts: Sequence[Part], root: str, description: str) -> str:
    """Return the STEP text of one part, or of an assembly named ``root`` when there are several."""
    document = _document(parts, root)
    writer = occ.STEPCAFControl_Writer()
    _settings()
    for switch in ("SetColorMode", "SetNameMode", "SetMaterialMode", "SetPropsMode"):
        getattr(writer, switch)(True)
    if not writer.Transfer(document, occ.STEPControl_StepModelType.STEPControl_AsIs):
        raise RuntimeError(f"the kernel could not transfer '{root}' to STEP")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "raw.step")
        if writer.Write(path) != occ.IFSelect_ReturnStatus.IFSelect_RetDone:
            raise RuntimeError(f"the kernel could not write '{root}' as STEP")
        raw = Path(path).read_text(encoding="utf-8", errors="replace")
    return canonical_step(raw, f"{root}.step", description)


def _settings() -> None:
    """AP242, millimetres, no curves in parameter space (a third of the size, volumes kept to 3e-5 mm3)."""
    occ.STEPCAFControl_Controller.Init_s()
    occ.Interface_Static.SetCVal_s("write.step.schema", "AP242DIS")
    occ.Interface_Static.SetCVal_s("write.step.unit", "MM")
    occ.Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    occ.Interface_Static.SetCVal_s("write.step.product.name", "part")


def _document(parts: Sequence[Part], root: str) -> Any:
    document = occ.TDocStd_Document(occ.TCollection_ExtendedString("XmlXCAF"))
    occ.XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    shapes = occ.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = [_add_part(document, shapes, part) for part in parts]
    if len(parts) > 1:
        whole = shapes.NewShape()
        occ.TDataStd_Name.Set_s(whole, occ.TCollection_ExtendedString(root))
        for part, label in zip(parts, labels):
            move = occ.gp_Trsf()
            move.SetTranslation(occ.gp_Vec(*part.offset_mm))
            child = shapes.AddComponent(whole, label, occ.TopLoc_Location(move))
            occ.TDataStd_Name.Set_s(child, occ.TCollection_ExtendedString(part.name))
        shapes.UpdateAssemblies()
    return document


def _add_part(document: Any, shapes: Any, part: Part) -> Any:
    """Add one product with name, colour, material and validation properties; return its label."""
    label = shapes.AddShape(part.solid.wrapped, False)
    occ.TDataStd_Name.Set_s(label, occ.TCollection_ExtendedString(part.name))
    colour = occ.Quantity_Color(*part.material.colour, occ.Quantity_TypeOfColor.Quantity_TOC_sRGB)
    tool = occ.XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    tool.SetColor(label, colour, occ.XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    material = occ.XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    name, words, *kinds = (
        occ.TCollection_HAsciiString(one)
        for one in (part.material.name, part.material.description, "density measure", "POSITIVE_RATIO_MEASURE")
    )
    material.SetMaterial(label, name, words, part.material.density_g_per_cm3, *kinds)
    occ.XCAFDoc_Volume.Set_s(label, part.volume_mm3)
    occ.XCAFDoc_Area.Set_s(label, part.area_mm2)
    occ.XCAFDoc_Centroid.Set_s(label, occ.gp_Pnt(*part.centroid_mm))
    return label


def read_step(path: Path, validity: bool = True) -> list[ReadPart]:
    """Read a STEP file again; one entry per product that holds solids, in the order of their names.

    ``validity`` asks the kernel to validate each solid, which takes as long as reading it.
    """
    document = occ.TDocStd_Document(occ.TCollection_ExtendedString("XmlXCAF"))
    reader = occ.STEPCAFControl_Reader()
    for switch in ("SetColorMode", "SetNameMode", "SetMatMode", "SetPropsMode"):
        getattr(reader, switch)(True)
    if reader.ReadFile(str(path)) != occ.IFSelect_ReturnStatus.IFSelect_RetDone or not reader.Transfer(document):
        raise RuntimeError(f"{path.name} cannot be read again as STEP")
    shapes = occ.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = occ.TDF_LabelSequence()
    shapes.GetShapes(labels)
    every = [labels.Value(index) for index in range(1, labels.Length() + 1)]
    simple = [label for label in every if occ.XCAFDoc_ShapeTool.IsSimpleShape_s(label)]
    return sorted((_read_part(document, label, validity) for label in simple), key=lambda part: part.name)


def _read_part(document: Any, label: Any, validity: bool) -> ReadPart:
    shape = cq.Shape.cast(occ.XCAFDoc_ShapeTool.GetShape_s(label))
    name = occ.TDataStd_Name()
    named = label.FindAttribute(occ.TDataStd_Name.GetID_s(), name)
    colour = occ.Quantity_Color()
    coloured = occ.XCAFDoc_ColorTool.GetColor_s(label, occ.XCAFDoc_ColorType.XCAFDoc_ColorSurf, colour)
    volume = occ.XCAFDoc_Volume()
    declared = volume.Get() if label.FindAttribute(occ.XCAFDoc_Volume.GetID_s(), volume) else None
    material, density = _read_material(label)
    return ReadPart(
        name=name.Get().ToExtString() if named else "",
        volume_mm3=shape.Volume(),
        bounds_mm=rough_bounds(shape),
        solids=len(shape.Solids()),
        valid=shape.isValid() if validity else True,
        colour=tuple(colour.Values(occ.Quantity_TypeOfColor.Quantity_TOC_sRGB)) if coloured else None,
        material=material,
        density_g_per_cm3=density,
        declared_volume_mm3=declared,
    )


def _read_material(label: Any) -> tuple[str | None, float | None]:
    """Name and density (g/cm3) of the material a product refers to."""
    node, material = occ.TDataStd_TreeNode(), occ.XCAFDoc_Material()
    if not label.FindAttribute(occ.XCAFDoc.MaterialRefGUID_s(), node) or not node.HasFather():
        return None, None
    if not node.Father().Label().FindAttribute(occ.XCAFDoc_Material.GetID_s(), material):
        return None, None
    return material.GetName().ToCString(), material.GetDensity()
