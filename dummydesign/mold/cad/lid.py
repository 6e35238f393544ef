"""What closes a lidded mould: lid with keys, sprue and vents, its backer and the box it is cast in."""

from __future__ import annotations

from typing import Any

from dummydesign.mold.cad.casting_box import casting_box
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.prisms import drafted_prism, single_solid
from dummydesign.mold.model.layout import Layout, Point
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec


def mould_tools(spec: MouldSpec, plan: Layout, tools: dict[str, list[Any]]) -> list[Any]:
    """Sockets for the keys and the gutter, as cut into the mould's land.

    Parameters
    ----------
    spec : MouldSpec
        Of a lidded mould.
    plan : Layout
        Its layout.
    tools : dict
        Cutting solids by name; ``keys`` and ``gutter`` are added for the checks.

    Returns
    -------
    list of cadquery.Solid
    """
    c = spec.closure
    tools["keys"] = [ball(place, plan.land_mm, c.key_radius_mm + c.key_clearance_mm) for place in plan.keys]
    tools["gutter"] = [gutter(spec, plan)]
    return [*tools["keys"], *tools["gutter"]]


def gutter(spec: MouldSpec, plan: Layout) -> Any:
    """Groove of half-round section around the cavity that takes what is squeezed out of the parting gap."""
    import cadquery as cq

    c = spec.closure
    line = plan.fill_outline.grown(c.gutter_distance_mm)
    path = _wire(line, plan.land_mm)
    start = cq.Plane(origin=(0, -line.width_mm / 2, plan.land_mm), xDir=(0, 1, 0), normal=(1, 0, 0))
    return cq.Workplane(start).circle(c.gutter_radius_mm).sweep(cq.Workplane(obj=path)).val()


def add_lid(made: Parts, beside_mm: float) -> None:
    """Build lid, backer, loose pins and the lid's casting box into ``made``."""
    spec, plan, c = made.spec, made.plan, made.spec.closure
    land = plan.land_mm
    # Cast parting face down, so it narrows away from the parting plane and the frame lifts off.
    hull = drafted_prism(plan.top, c.lid_mm, -spec.body.outer_draft_deg, land)
    full = single_solid(hull.fuse(*[ball(place, land, c.key_radius_mm) for place in plan.keys]))
    sprue = [_funnel(spec, plan.sprue, land, c.sprue_small_mm, c.sprue_large_mm)]
    vents = [_funnel(spec, place, land, c.vent_small_mm, c.vent_large_mm) for place in plan.vents]
    made.tools["sprue"], made.tools["vents"] = sprue, vents
    made.tools["lid_hull"] = [hull]
    made.add("lid", single_solid(full.cut(*sprue, *vents)), "silicone")
    made.add("backer", _backer(spec, plan), "rigid")
    sockets = made.tools["sockets"] = _pin_sockets(spec, plan)
    master, frame = casting_box(spec, full, hull, land, False, tuple(sockets))
    made.add("lid_master", master, "rigid", (beside_mm, plan.flange.width_mm + 40.0, 0))
    made.add("lid_frame", frame, "rigid", (beside_mm, plan.flange.width_mm + 40.0, 0))
    for name, small, large, side in (
        ("sprue_pin", c.sprue_small_mm, c.sprue_large_mm, 0.0),
        ("vent_pin", c.vent_small_mm, c.vent_large_mm, 30.0),
    ):
        made.add(name, _pin(spec, small, large), "rigid", (side, plan.flange.width_mm + 40.0, 0))


def ball(place: Point, z_mm: float, radius_mm: float) -> Any:
    """Make a ball about a place at a height. [mm]

    Parameters
    ----------
    place : Point
        Its centre seen from above.
    z_mm, radius_mm : float
        Height of the centre, and the radius. [mm]

    Returns
    -------
    cadquery.Solid
    """
    import cadquery as cq

    return cq.Workplane(origin=(place.x_mm, place.y_mm, z_mm)).sphere(radius_mm).val()


def _wire(outline: Outline, z_mm: float) -> Any:
    """Outline as a closed wire that starts in the middle of the front side."""
    import cadquery as cq

    x, y, r = outline.length_mm / 2, outline.width_mm / 2, outline.radius_mm
    path = cq.Workplane(origin=(0, 0, z_mm)).moveTo(0, -y).lineTo(x - r, -y).radiusArc((x, -y + r), -r)
    path = path.lineTo(x, y - r).radiusArc((x - r, y), -r).lineTo(-x + r, y).radiusArc((-x, y - r), -r)
    return path.lineTo(-x, -y + r).radiusArc((-x + r, -y), -r).close().val()


def _funnel(spec: MouldSpec, place: Point, z_mm: float, small_mm: float, large_mm: float) -> Any:
    """Cone through the lid, narrow at the pad so that the stem breaks there, open above."""
    import cadquery as cq

    high = spec.closure.lid_mm
    slope = (large_mm - small_mm) / 2 / high
    below, above = 0.5, 0.5
    return cq.Solid.makeCone(
        small_mm / 2 - slope * below,
        large_mm / 2 + slope * above,
        high + below + above,
        cq.Vector(place.x_mm, place.y_mm, z_mm - below),
    )


def _backer(spec: MouldSpec, plan: Layout) -> Any:
    """Stiff plate on the lid: a lid of soft silicone alone is not flat; holes let sprue and vents through."""
    import cadquery as cq

    c = spec.closure
    low = plan.land_mm + c.lid_mm
    plate = drafted_prism(plan.top.grown(-1.0), c.backer_mm, 0.0, low)
    holes = [(plan.sprue, c.sprue_large_mm)] + [(place, c.vent_large_mm) for place in plan.vents]
    tools = [
        cq.Solid.makeCylinder(large / 2 + 1.0, c.backer_mm + 2, cq.Vector(place.x_mm, place.y_mm, low - 1))
        for place, large in holes
    ]
    return single_solid(plate.cut(*tools))


def _spigot_radius(spec: MouldSpec, small_mm: float) -> float:
    """Radius of a pin's spigot: with its gap less than the pin's foot, so that the foot seats on the base."""
    return max(0.8, small_mm / 2 - 0.3 - spec.machines.gap_mm)


def _pin(spec: MouldSpec, small_mm: float, large_mm: float) -> Any:
    """Loose pin that keeps a funnel open while the lid is cast: spigot, cone, handle above the silicone."""
    import cadquery as cq

    c, grow = spec.closure, _grow(spec)
    high = c.lid_mm * grow
    cone = cq.Solid.makeCone(small_mm * grow / 2, large_mm * grow / 2, high)
    spigot = cq.Solid.makeCylinder(
        _spigot_radius(spec, small_mm), c.pin_spigot_mm - 0.5 + 0.01, cq.Vector(0, 0, -c.pin_spigot_mm + 0.5)
    )
    handle = cq.Solid.makeCylinder(large_mm * grow / 2, c.pin_handle_mm, cq.Vector(0, 0, high))
    return single_solid(cone.fuse(spigot, handle))


def _pin_sockets(spec: MouldSpec, plan: Layout) -> list[Any]:
    """Blind holes in the lid's base plate for the pins' spigots."""
    import cadquery as cq

    c, grow = spec.closure, plan.silicone_scale
    places = [(plan.sprue, c.sprue_small_mm)] + [(place, c.vent_small_mm) for place in plan.vents]
    return [
        cq.Solid.makeCylinder(
            _spigot_radius(spec, small) + spec.machines.gap_mm,
            c.pin_spigot_mm,
            cq.Vector(place.x_mm * grow, place.y_mm * grow, -c.pin_spigot_mm),
        )
        for place, small in places
    ]


def _grow(spec: MouldSpec) -> float:
    from dummydesign.mold.model.layout import silicone_scale

    return silicone_scale(spec)
