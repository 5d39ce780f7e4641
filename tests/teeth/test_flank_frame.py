"""Places on a flank: lengths and heights are those of the axial half plane."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import unit
from gearmesh.teeth.flank_frame import FlankFrame

# Angle (deg) of lengths to the axis, and whether lengths and heights are drawn as radii or z, from where they are 0.
KINDS = {
    ("beveloid_crossed", 0): (0.0, True),
    ("internal", 1): (0.0, True),
    ("face_gear", 1): (90.0, False),
    ("spiral_bevel_basic", 0): (np.degrees(np.arctan2(13, 44)), False),
}


@pytest.mark.parametrize(("sample", "k"), KINDS)
def test_the_frame_is_the_axial_half_plane_turned(sample: str, k: int) -> None:
    pair = pair_of(gm.load(SAMPLES / f"{sample}.toml"))
    member, side = pair.both[k], pair.flanks[k]
    points = member.tooth.flank_grid(side, np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 7)).points
    middle = points[2, 3]
    axial = np.stack((points[..., 2], np.hypot(points[..., 0], points[..., 1])), axis=-1)
    angle, absolute = KINDS[sample, k]
    along = (axial * (np.cos(np.radians(angle)), np.sin(np.radians(angle)))).sum(axis=-1)
    frame = FlankFrame.of(member, side)
    for found in (frame, frame.as_drawn):
        places = found.places(points)
        # the axial half plane, turned by the angle of the pitch cone
        np.testing.assert_allclose(
            np.linalg.norm(places - places[2, 3], axis=-1), np.linalg.norm(axial - axial[2, 3], axis=-1), atol=1e-12
        )
        np.testing.assert_allclose(np.abs(np.diff(places[..., 0], axis=1)), np.abs(np.diff(along, axis=1)), atol=1e-9)
        step = 1e-5 * unit(np.random.default_rng(1).normal(size=points.shape))
        np.testing.assert_allclose(
            found.places(points + step) - found.places(points - step), 2.0 * found.directions(points, step), atol=1e-11
        )
        # the outline goes through the corners and along the rim of the grid
        toe, heel = (-1, 0) if sample == "internal" else (0, -1)
        rim = {"root": places[0, 3], "tip": places[-1, 3], "toe": places[2, toe], "heel": places[2, heel]}
        for name, place in found.marks.items():
            np.testing.assert_allclose(place, rim[name], atol=1e-9)
        np.testing.assert_allclose(found.extent, [found.outline.min(axis=0), found.outline.max(axis=0)])
        assert all(np.linalg.norm(found.outline - places[i, j], axis=-1).min() < 1e-9 for i in (0, -1) for j in (0, -1))
        np.testing.assert_allclose(found.outline[0], found.outline[-1], atol=1e-12)
    # from the middle of the flank, to heel and tip
    np.testing.assert_allclose(frame.places(middle), 0.0, atol=1e-12)
    assert frame.inverted == (False, False)
    # as drawn: z and radius as they are, cone distance too
    drawn = frame.as_drawn.places(points)
    if absolute:
        np.testing.assert_allclose(drawn, axial, atol=1e-12)
    else:
        np.testing.assert_allclose(drawn[2, 3, 1], 0.0, atol=1e-12)
        np.testing.assert_allclose(drawn[2, 3, 0], member.tooth.blank.axial.value(middle))
