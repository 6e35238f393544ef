"""Write and read STEP AP242, the same text for the same model in every run."""

from __future__ import annotations

import os
import re
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.kernel import cq, occ
from dummydesign.mold.cad.parts import Part
from dummydesign.mold.cad.solids import rough_bounds

_STATEMENT = re.compile(r"#(\d+)\s*=\s*((?:[^;']++|'(?:[^']|'')*')*);")
_REFERENCE = re.compile(r"#(\d+)")
_BREAK = re.compile(r"\n\s*")
_STYLES = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"
_OCCURRENCE = re.compile(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()'[^']*',\s*('(?:[^']|'')*')([^;]*;)")
# The kernel's writer gives the unit of densities the exponents 3 and 2.
_DENSITY = re.compile(
    r"(DERIVED_UNIT_ELEMENT\(#\d+,)3\.(\);\s*#\d+ = \( MASS_UNIT\(\)[^;]*;\s*#\d+ = DERIVED_UNIT_ELEMENT\(#\d+,)2\."
)
_BEYOND_ASCII = re.compile(r"[^\x00-\x7f]+")


ORGANISATION = "dummydesign"


def canonical_step(text: str, name: str, description: str) -> str:
    """Return the kernel's text with a fixed header and the same text for the same model in every run."""
    start, schema = text.find("DATA;"), re.search(r"FILE_SCHEMA\s*\(\s*\(\s*('[^']*')", text)
    if start < 0 or schema is None:
        raise ValueError("not a STEP file: no DATA section or no FILE_SCHEMA")
    data = _sorted_styles(_in_ascii(text[start:]))
    # where the kernel breaks a line depends on how long its numbers were
    data = _OCCURRENCE.sub(lambda hit: f"{hit[1]}{hit[2]},{hit[2]}{_BREAK.sub('', hit[3])}", data)
    data = _DENSITY.sub(r"\g<1>1.\g<2>-3.", data)
    name, description, who = _quoted(name), _quoted(description), _quoted(ORGANISATION)
    head = [
        "ISO-10303-21;",
        "HEADER;",
        f"FILE_DESCRIPTION(({description}),'2;1');",
        f"FILE_NAME({name},{_quoted(time_stamp())},({who}),({who}),{who},{who},'');",
        f"FILE_SCHEMA(({schema.group(1)}));",
        "ENDSEC;",
    ]
    return "\n".join([*head, data])


def _sorted_styles(data: str) -> str:
    """Write the colours of the parts in the order of the parts; the kernel writes them by addresses in memory."""
    begin = data.rfind("\n", 0, data.find(_STYLES)) + 1
    if not begin:
        return data
    hits = {int(hit[1]): hit for hit in _STATEMENT.finditer(data, begin)}
    first, order = min(hits), dict[int, int]()

    def number(old: int) -> None:
        if old in hits and old not in order:
            order[old] = first + len(order)
            for child in _REFERENCE.findall(hits[old][2]):
                number(int(child))

    heads = [old for old, hit in hits.items() if hit[2].startswith(_STYLES)]
    for old in sorted(heads, key=lambda old: int(_REFERENCE.findall(hits[old][2])[-1])):
        number(old)
    if max(order) != first + len(order) - 1:
        raise ValueError("the colours of the parts are not written one after the other")
    whole = {old: _BREAK.sub("", hits[old][2]) for old in order}
    lines = [
        f"#{order[old]} = {_REFERENCE.sub(lambda m: f'#{order.get(int(m[1]), m[1])}', text)};"
        for old, text in whole.items()
    ]
    return data[:begin] + "\n".join(lines) + data[hits[max(order)].end() :]


def _quoted(text: str) -> str:
    return "'" + _in_ascii(text).replace("'", "''") + "'"


def _in_ascii(text: str) -> str:
    """Write letters beyond ASCII as ISO 10303-21 does in every edition, which all readers understand."""
    return _BEYOND_ASCII.sub(_hexadecimal, text)


def _hexadecimal(hit: re.Match[str]) -> str:
    letters = hit.group()
    bytes_each, code = (4, "utf-32-be") if max(letters) > "\uffff" else (2, "utf-16-be")
    return rf"\X{bytes_each}\{letters.encode(code).hex().upper()}\X0" + "\\"


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


def write_steps(folder: Path, parts: Mapping[str, Part], files: Mapping[str, str], words: str) -> None:
    """Write a file of each part that is named, and of all parts as ``assembly``; ``words`` say what they belong to."""
    for role, name in files.items():
        some = list(parts.values()) if role == "assembly" else [parts[role]]
        text = step_text(some, name.removesuffix(".step"), f"{role} of the {words}")
        (folder / name).write_text(text, encoding="utf-8")


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
