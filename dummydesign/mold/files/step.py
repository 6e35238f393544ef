"""Write and read STEP AP242 with names, colours, materials and validation properties. CAD child only.

The kernel's writer is not reproducible (time stamp, counters, order of colours), so what it writes goes
through :func:`dummydesign.mold.files.step_canonical.canonical_step`.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.prisms import rough_bounds
from dummydesign.mold.files.step_canonical import Header, canonical_step

ORGANISATION = "dummydesign"
COLOURS = {
    "resin": (0.93, 0.62, 0.50), "resin_base": (0.62, 0.36, 0.45), "silicone": (0.36, 0.62, 0.74),
    "rigid": (0.72, 0.73, 0.75), "glass": (0.62, 0.80, 0.72),
}  # fmt: skip


@dataclass(frozen=True)
class Material:
    """Name and density that a part carries in the STEP file."""

    name: str
    description: str
    density_g_per_cm3: float


@dataclass(frozen=True)
class StepPart:
    """What one product of a STEP file consists of."""

    name: str
    solid: Any
    material: Material
    colour: tuple[float, float, float]
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @cached_property
    def volume_mm3(self) -> float:
        """Volume of the solid."""
        return float(self.solid.Volume())

    @cached_property
    def area_mm2(self) -> float:
        """Surface of the solid."""
        return float(self.solid.Area())

    @cached_property
    def centroid_mm(self) -> tuple[float, float, float]:
        """Its middle of volume."""
        return self.solid.Center().toTuple()


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


def step_text(parts: Sequence[StepPart], root: str, description: str) -> str:
    """Return the STEP text of one part, or of an assembly named ``root`` when there are several.

    Parameters
    ----------
    parts : sequence of StepPart
        One part, or those of an assembly.
    root : str
        Name of the part or of the assembly.
    description : str
        Line of the header; it names the specification's hash.

    Returns
    -------
    str
        The file in canonical order, the same to the last byte for the same parts.

    Raises
    ------
    RuntimeError
        When the kernel refuses to transfer or to write.
    """
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_StepModelType

    document = _document(parts, root)
    writer = STEPCAFControl_Writer()
    _settings()
    for switch in ("SetColorMode", "SetNameMode", "SetMaterialMode", "SetPropsMode"):
        getattr(writer, switch)(True)
    if not writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs):
        raise RuntimeError(f"the kernel could not transfer '{root}' to STEP")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "raw.step")
        if writer.Write(path) != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise RuntimeError(f"the kernel could not write '{root}' as STEP")
        raw = Path(path).read_text(encoding="utf-8", errors="replace")
    return canonical_step(raw, Header(f"{root}.step", description, time_stamp(), ORGANISATION))


def _settings() -> None:
    """AP242, millimetres, no curves in parameter space (a third of the size, volumes kept to 3e-5 mm3)."""
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Controller

    STEPCAFControl_Controller.Init_s()
    Interface_Static.SetCVal_s("write.step.schema", "AP242DIS")
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    Interface_Static.SetCVal_s("write.step.product.name", "part")


def _document(parts: Sequence[StepPart], root: str) -> Any:
    from OCP.gp import gp_Trsf, gp_Vec
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, 0.001)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = [_add_part(document, shapes, part) for part in parts]
    if len(parts) > 1:
        whole = shapes.NewShape()
        TDataStd_Name.Set_s(whole, TCollection_ExtendedString(root))
        for part, label in zip(parts, labels):
            move = gp_Trsf()
            move.SetTranslation(gp_Vec(*part.offset_mm))
            child = shapes.AddComponent(whole, label, TopLoc_Location(move))
            TDataStd_Name.Set_s(child, TCollection_ExtendedString(part.name))
        shapes.UpdateAssemblies()
    return document


def _add_part(document: Any, shapes: Any, part: StepPart) -> Any:
    """Add one product with name, colour, material and validation properties; return its label."""
    from OCP.gp import gp_Pnt
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
    from OCP.TDataStd import TDataStd_Name
    from OCP.XCAFDoc import XCAFDoc_Area, XCAFDoc_Centroid, XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_Volume

    label = shapes.AddShape(part.solid.wrapped, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(part.name))
    colour = Quantity_Color(*part.colour, Quantity_TypeOfColor.Quantity_TOC_sRGB)
    tool = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    tool.SetColor(label, colour, XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    material = XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    words = [part.material.name, part.material.description]
    material.SetMaterial(
        label,
        *[TCollection_HAsciiString(word) for word in words],
        part.material.density_g_per_cm3,
        TCollection_HAsciiString("density measure"),
        TCollection_HAsciiString("POSITIVE_RATIO_MEASURE"),
    )
    XCAFDoc_Volume.Set_s(label, part.volume_mm3)
    XCAFDoc_Area.Set_s(label, part.area_mm2)
    XCAFDoc_Centroid.Set_s(label, gp_Pnt(*part.centroid_mm))
    return label


def read_step(path: Path, validity: bool = True) -> list[ReadPart]:
    """Read a STEP file again; one entry per product that holds solids, in the order of their names.

    ``validity`` asks the kernel to validate each solid, which takes as long as reading it.

    Raises
    ------
    RuntimeError
        When the kernel cannot read it.
    """
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDF import TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    reader = STEPCAFControl_Reader()
    for switch in ("SetColorMode", "SetNameMode", "SetMatMode", "SetPropsMode"):
        getattr(reader, switch)(True)
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone or not reader.Transfer(document):
        raise RuntimeError(f"{path.name} cannot be read again as STEP")
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = TDF_LabelSequence()
    shapes.GetShapes(labels)
    found = [labels.Value(index) for index in range(1, labels.Length() + 1)]
    simple = [label for label in found if XCAFDoc_ShapeTool.IsSimpleShape_s(label)]
    return sorted((_read_part(document, label, validity) for label in simple), key=lambda part: part.name)


def _read_part(document: Any, label: Any, validity: bool) -> ReadPart:
    import cadquery as cq
    from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
    from OCP.TDataStd import TDataStd_Name
    from OCP.XCAFDoc import XCAFDoc_ColorTool, XCAFDoc_ColorType, XCAFDoc_ShapeTool, XCAFDoc_Volume

    shape = cq.Shape.cast(XCAFDoc_ShapeTool.GetShape_s(label))
    name = TDataStd_Name()
    named = label.FindAttribute(TDataStd_Name.GetID_s(), name)
    colour = Quantity_Color()
    coloured = XCAFDoc_ColorTool.GetColor_s(label, XCAFDoc_ColorType.XCAFDoc_ColorSurf, colour)
    volume = XCAFDoc_Volume()
    declared = volume.Get() if label.FindAttribute(XCAFDoc_Volume.GetID_s(), volume) else None
    material, density = _read_material(label)
    return ReadPart(
        name=name.Get().ToExtString() if named else "",
        volume_mm3=shape.Volume(),
        bounds_mm=rough_bounds(shape),
        solids=len(shape.Solids()),
        valid=shape.isValid() if validity else True,
        colour=tuple(colour.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)) if coloured else None,
        material=material,
        density_g_per_cm3=density,
        declared_volume_mm3=declared,
    )


def _read_material(label: Any) -> tuple[str | None, float | None]:
    """Name and density (g/cm3) of the material a product refers to."""
    from OCP.TDataStd import TDataStd_TreeNode
    from OCP.XCAFDoc import XCAFDoc, XCAFDoc_Material

    node, material = TDataStd_TreeNode(), XCAFDoc_Material()
    if not label.FindAttribute(XCAFDoc.MaterialRefGUID_s(), node) or not node.HasFather():
        return None, None
    if not node.Father().Label().FindAttribute(XCAFDoc_Material.GetID_s(), material):
        return None, None
    return material.GetName().ToCString(), material.GetDensity()
