"""What a technician sets in the slicer so that the parts come out as drawn. No CAD."""

from __future__ import annotations

from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.print_layers import layer_words


def print_words(spec: MouldSpec) -> str:
    """Elephant's foot, shrinkage and gap of the machine's prints, in words; empty where nothing is known."""
    fit, said = spec.machines.fit, []
    if fit is not None:
        foot = f"take {fit.elephant_foot_mm:g} mm off the first layer (elephant's foot compensation)"
        size = (
            f"switch shrinkage compensation off: STL and 3MF are enlarged by {fit.shrinkage_percent:g} %"
            if fit.shrinkage_percent
            else "print a bar of 150 mm, measure it and let the slicer compensate the shrinkage"
        )
        said.append(f"In the slicer {foot}; {size}. Parts that go together have {fit.gap_per_side_mm:g} mm a side.")
    if words := layer_words(spec):
        said.append(f"{words[0].upper()}{words[1:]}.")
    return f" {' '.join(said)}" if said else ""
