"""A drawing as DXF. No CAD."""

from __future__ import annotations

import io

from dummydesign.mold.files.drawings.sheet import LAYERS, TEXT_MM, Drawing, number


def to_dxf(sheet: Drawing) -> str:
    """Write the sheet as DXF R2010 in millimetres, dimensions as dimension entities; equal sheets, equal files."""
    import ezdxf
    from ezdxf.enums import TextEntityAlignment

    fixed, ezdxf.options.write_fixed_meta_data_for_testing = ezdxf.options.write_fixed_meta_data_for_testing, True
    try:
        document = ezdxf.new("R2010", setup=["dimstyles:metric"])
        document.units = ezdxf.units.MM
        space = document.modelspace()
        for name, width in LAYERS.items():
            document.layers.add(name, lineweight=round(100 * width))
        for line in sheet.lines:
            space.add_lwpolyline(line.points, dxfattribs={"layer": line.layer})
        for text in sheet.texts:
            place = TextEntityAlignment.BOTTOM_CENTER if text.middle else TextEntityAlignment.BOTTOM_LEFT
            turn = 90.0 if text.upright else 0.0
            entity = space.add_text(text.words, height=text.height, rotation=turn, dxfattribs={"layer": "text"})
            entity.set_placement(text.at, align=place)
        for d in sheet.dimensions:
            space.add_linear_dim(
                base=d.line[0], p1=d.start, p2=d.end, angle=90 if d.vertical else 0, text=number(d.value),
                dimstyle="EZDXF", override={"dimtxt": TEXT_MM, "dimasz": 2.5, "dimclrt": 7},
                dxfattribs={"layer": "dimension"},
            ).render()  # fmt: skip
        stream = io.StringIO()
        document.write(stream)
        return stream.getvalue()
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = fixed
