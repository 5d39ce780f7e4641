"""The contact pattern in per cent of face and working height, against a raster of the flank."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.contact.pattern import pattern_figures
from gearmesh.answers.contact.sides import side_contacts
from gearmesh.teeth.blank.body import end_names
from gearmesh.view.on_tooth import union_level
from gearmesh.view.scene import contact_on


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["spiral_bevel_basic", "beveloid_crossed"])
def test_pattern_is_where_a_raster_of_the_flank_has_it(name: str) -> None:
    """Every raster point is exact and inside or outside of the ellipses in space; its shares are counted row by row."""
    contact = gm.build(gm.load(SAMPLES / f"{name}.toml")).contact()
    pair = contact.pair
    assert contact.whole is not None
    for which, found in enumerate(contact.patterns[:2]):
        tooth = pair.both[which].tooth
        points = tooth.flank_grid(pair.flanks[which], np.linspace(0.0, 1.0, 151), np.linspace(0.0, 1.0, 301)).points
        covered = union_level(contact_on(which, contact.whole, pair.mounts), points) <= 1.0
        along, up = tooth.blank.axial.value(points), tooth.blank.across.value(points)
        face = 100.0 * (along - along[:, :1]) / (along[:, -1:] - along[:, :1])
        face = face if end_names(tooth.blank.axial)[0] == "toe" else 100.0 - face
        height = 100.0 * (up - up[:1]) / (up[-1:] - up[:1])
        for values, ends in ((face, found.face_ends), (height, found.height_ends)):
            assert ends == pytest.approx([values[covered].min(), values[covered].max()], abs=1.0)
        assert found.centre_face == pytest.approx(np.mean(found.face_ends))
        assert found.width == pytest.approx(np.ptp(found.height_ends))


@pytest.mark.sweep
@pytest.mark.sweep_cases("worm_drive")
@pytest.mark.parametrize("name", ["worm_drive", "face_gear"])
def test_coast_pattern_of_a_symmetric_pair_mirrors_the_drive_pattern(name: str) -> None:
    """The image is what the coast flanks have if their contact is solved: a half turn exchanges toe and heel."""
    contact = gm.build(gm.load(SAMPLES / f"{name}.toml")).contact()
    assert contact.fit is not None
    assert contact.fit.exchange is not None
    coast = next(side for side in side_contacts(contact.pair, contact.path) if not side.driving)
    solved = pattern_figures(coast.pair, coast.whole)
    images = contact.patterns[2:]
    assert [each.side for each in contact.patterns] == ["drive", "drive", "coast", "coast"]
    for one, other in zip(images, solved, strict=True):
        assert (one.member, one.flank, one.toe) == (other.member, other.flank, other.toe)
        assert [*one.face_ends, *one.height_ends] == pytest.approx([*other.face_ends, *other.height_ends], abs=0.02)
        assert one.bias == pytest.approx(other.bias, abs=0.1)


def test_a_pattern_that_leaves_the_flank_ends_at_its_edge() -> None:
    """A pair displaced until its pattern runs out at an end: the ellipse is cut off there, and no share is beyond 100 %."""
    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", ["assembly.dV=0.35"]))
    pinion = gears.contact().patterns[0]
    assert pinion.face_ends[1] == 100.0
    assert 60.0 < pinion.face_ends[0] < 90.0
    assert pinion.centre_face == pytest.approx(50.0 + 0.5 * pinion.face_ends[0])
