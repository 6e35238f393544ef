"""What a mould holds, in closed form: cavity, resin, layers, silicone; no CAD."""

from __future__ import annotations

from dummydesign.mold.model.layout import Layout, layout
from dummydesign.mold.model.outline import drafted_volume_mm3, slab_volume_mm3
from dummydesign.mold.model.spec import MouldSpec


def cavity_volume_mm3(spec: MouldSpec, plan: Layout | None = None) -> float:
    """Room in the mould up to the fill plane, a bone's room included: drafted slab and what its top adds. [mm3]

    See :func:`dummydesign.mold.model.outline.slab_volume_mm3`.
    """
    plan = plan or layout(spec)
    pad = spec.pad
    flat = slab_volume_mm3(
        plan.floor_outline, plan.depth_mm - plan.face_mm, pad.draft_deg, pad.edge_radius_mm * plan.scale
    )
    return flat + plan.scale**3 * pad.shape.top_volume_mm3(pad)


def resin_volume_mm3(spec: MouldSpec, plan: Layout | None = None) -> float:
    """Resin of the pad in the cold cavity: the cavity less the bone. [mm3]"""
    plan = plan or layout(spec)
    return cavity_volume_mm3(spec, plan) - plan.scale**3 * bone_volume_mm3(spec)


def bone_volume_mm3(spec: MouldSpec) -> float:
    """The finished bone in the gel: dome or bar in closed form, a bone from a file as measured. [mm3]"""
    return spec.pad.shape.bone_volume_mm3(spec.pad) if spec.insert is None else spec.insert.volume_mm3


def layer_volumes_mm3(spec: MouldSpec, plan: Layout | None = None) -> tuple[float, float]:
    """Volumes of the upper layer (at the mould's floor, poured first) and of the base layer. [mm3]"""
    plan = plan or layout(spec)
    pad = spec.pad
    upper = slab_volume_mm3(plan.floor_outline, plan.interface_mm, pad.draft_deg, pad.edge_radius_mm * plan.scale)
    return upper, cavity_volume_mm3(spec, plan) - upper


def mould_volume_mm3(spec: MouldSpec, plan: Layout | None = None) -> float:
    """Silicone of an open mould: block less cavity less brim, label neglected. [mm3]"""
    plan = plan or layout(spec)
    block = drafted_volume_mm3(plan.bottom, plan.height_mm, spec.body.outer_draft_deg)
    brim = drafted_volume_mm3(plan.brim_outline, spec.body.freeboard_mm, spec.pad.draft_deg)
    return block - spec.count * (cavity_volume_mm3(spec, plan) + brim)
