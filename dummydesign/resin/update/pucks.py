"""Put a puck's point into a resin, and take one out again as if it had never been there."""

from __future__ import annotations

from dataclasses import replace

from dummydesign.resin.model.resin import Resin
from dummydesign.resin.update.modulus import Point, base_numbers, base_title, update_resin
from dummydesign.resin.update.relaxation import ArmUpdate, update_relaxation

_NOTE = "relaxation: "


def with_point(resin: Resin, point: Point, name: str) -> tuple[Resin, tuple[ArmUpdate, ...], tuple[str, ...]]:
    """Update the law by a point, and the relaxation by what its puck's holds showed.

    Parameters
    ----------
    resin : Resin
        As it was.
    point : Point
        What was measured at one ratio.
    name : str
        Of the resin that is made.

    Returns
    -------
    resin : Resin
    updates, said
        As :func:`~dummydesign.resin.update.relaxation.update_relaxation` gives them; empty without holds.
    """
    changed = update_resin(resin, [point], name)
    if point.puck is None or point.puck.seen_s is None:
        return changed, (), ()
    return update_relaxation(changed, point.puck.arms, point.ratio, point.puck.seen_s)


def known_puck(resin: Resin, sha256: str) -> Point | None:
    """The point of a resin that came from this recording."""
    for item in resin.points:
        if "puck" in item and item["puck"].sha256 == sha256:
            return Point(**item)
    return None


def without_puck(resin: Resin, sha256: str) -> Resin:
    """Begin again from the base and add every other point in its order."""
    arms, ratio_ref = resin.prior_relaxation or (resin.arms, resin.relaxation_ratio_ref)
    base = replace(
        resin, title=base_title(resin), numbers=base_numbers(resin), posterior=None, prior_numbers=None, points=(),
        contradictions=(), arms=arms, relaxation_ratio_ref=ratio_ref, prior_relaxation=None,
        notes=tuple(note for note in resin.notes if not note.startswith(_NOTE)),
    )  # fmt: skip
    for item in resin.points:
        point = Point(**item)
        if point.puck is None or point.puck.sha256 != sha256:
            base, _, _ = with_point(base, point, resin.name)
    return base
