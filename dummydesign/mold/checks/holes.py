"""How many holes go through each part, for the Euler numbers of the meshes."""

from __future__ import annotations

from dummydesign.mold.model.spec import MouldSpec


def genera(spec: MouldSpec) -> dict[str, int]:
    """How many holes go through each part: 8 bolts, 3 level screws, sprue and vents, the frame's opening."""
    open_holes = 0 if spec.closure is None else 6
    # Vents and screws of a bone's carrier; that of several crowns only has marks.
    carrier = 8 if spec.pad.shape.bone_height_mm else 0
    if spec.is_printed:
        # Eight bolts, two pins, three levelling screws; the ring's openings.
        return {"pad": 0, "mould": 13, "frame": 13 + spec.count, "strike_off": 0, "collar": 1, "layer_top": 0,
                "layer_base": 0, "spacer": 0, "carrier": carrier, "face_sheet": 0}  # fmt: skip
    return {
        "pad": 0, "mould": 0, "master": 8, "frame": 9, "strike_off": 0, "tray": 3, "collar": 1, "lid": open_holes,
        "backer": open_holes, "lid_master": 8, "lid_frame": 9, "sprue_pin": 0, "vent_pin": 0, "layer_top": 0,
        "layer_base": 0, "spacer": 0, "carrier": carrier, "face_sheet": 0,
    }  # fmt: skip
