"""A section of a report with solids that can be turned."""

from __future__ import annotations

from collections.abc import Mapping

from numpy.typing import NDArray

from dummydesign.mold.files.view.solids import box, pack, read_stl, stack, turned_over, view_html, view_script
from dummydesign.report.html.page import Section

PAD_UP = "pad, tested face up"
__all__ = ["box", "pack", "read_stl", "solid_section", "viewer_script"]


def solid_section(parts: Mapping[str, NDArray], text: str) -> Section:
    """A section with a view of parts that can be turned; the pad beside its mould lies with its tested face up.

    Parameters
    ----------
    parts : mapping of name to ndarray (n, 3, 3)
        From the lowest to the highest when drawn apart.
    text : str
        Under the heading.
    """
    shown = {PAD_UP if name == "pad" and "mould" in parts else name: triangles for name, triangles in parts.items()}
    if PAD_UP in shown:
        shown[PAD_UP] = turned_over(shown[PAD_UP])
    return Section("Pad and mould", text, html=view_html(stack(shown)))


def viewer_script() -> str:
    """The script that draws the view."""
    return view_script()
