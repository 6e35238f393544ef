"""Where crowns, bumps and bones stand in the block; the solids themselves are stood for by what made them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from dummydesign.mold.cad.shapes import FlatSolids, boned, crowned, solids_of
from tests.support.mould_checks import shape_spec


@dataclass(frozen=True)
class Made:
    """A solid by what it was made of, and where it was moved to."""

    kind: str
    given: tuple
    at: tuple = (0.0, 0.0, 0.0)

    def translate(self, by):
        return replace(self, at=tuple(a + b for a, b in zip(self.at, by)))


@pytest.fixture(autouse=True)
def made(monkeypatch):
    """Every solid in the order it was made."""
    solids = []

    def maker(kind):
        def make(*given, **named):
            solids.append(Made(kind, (*given, *named.values())))
            return solids[-1]

        return make

    for module in (boned, crowned):
        for kind in ("cap", "ridge"):
            if hasattr(module, f"{kind}_solid"):
                monkeypatch.setattr(module, f"{kind}_solid", maker(kind))
    return solids


def test_a_bone_stands_on_the_free_face():
    pad = shape_spec("boned:20,6", 15.0).pad
    bone = boned.SOLIDS.bone(pad)
    # its tip lies below the tested face by what is left of the gel
    assert bone.kind == "cap" and bone.given == (pad.shape, pytest.approx(9.0))
    assert boned.SOLIDS.tops(pad) == [] and crowned.SOLIDS.bone(pad) is None


def test_crowns_stand_at_their_sites_and_are_made_once(made):
    single = shape_spec("crowned:10,2", 12.0).pad
    (cap,) = crowned.SOLIDS.tops(single)
    assert cap.at == (0.0, 0.0, 0.0) and cap.given == (single.shape,)
    made.clear()
    several = shape_spec("crowned:10,2,6,0,2,1,20", 12.0).pad
    caps = crowned.SOLIDS.tops(several)
    assert [one.at[:2] for one in caps] == [pytest.approx(place) for place in ((-10.0, 0.0), (10.0, 0.0))]
    assert len(made) == 1


def test_a_ridge_is_one_solid_to_the_walls():
    pad = shape_spec("crowned:10,2,6,1", 12.0).pad
    (ridge,) = crowned.SOLIDS.tops(pad)
    assert ridge.kind == "ridge" and ridge.given == (pad.shape, *pad.shape.ends(pad))


def test_a_slab_adds_nothing_and_each_shape_has_its_own():
    slab = shape_spec("slab", 10.0).pad
    plain = solids_of(slab.shape)
    assert type(plain) is FlatSolids and plain.tops(slab) == [] and plain.bone(slab) is None
    for text, module in (("boned:20,6", boned), ("crowned:10,2", crowned)):
        assert solids_of(shape_spec(text, 15.0).pad.shape) is module.SOLIDS
