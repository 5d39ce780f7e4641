"""Worm and wheel as bodies: they touch and do not overlap."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.examples import some
from oracles.overlap import overlap
from oracles.worm_drives import DRIVES, drive
from scipy.optimize import minimize_scalar

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region
from gearmesh.systems.worm_drive.build import wheel_hob

#: deg: five positions over one pitch of the worm's two threads
PHI1 = np.array([-75.0, -40.0, -5.0, 30.0, 65.0])
#: of either solid, mm; the backlash of the drives leaves room for it on the other side of the teeth
TOLERANCE = 0.03


def in_touch(name: str) -> Array:
    """phi2 (rad) at which teeth touch at `PHI1`: by the ratio, but where a larger hob cuts another form than ZI, there the first
    of three tooth pairs."""
    gears, (pair,) = drive(name), drive(name).pairs
    if not name.endswith("oversize") or name.startswith("ZI"):
        return np.radians(PHI1) * pair.ratio
    pitch = 2.0 * np.pi / gears.members["wheel"].tooth.teeth
    threads = np.array([[-1.0], [0.0], [1.0]])
    phi2 = gears.contact(np.ravel(PHI1 + 180.0 * threads), cycle=False).path.phi2.reshape(3, -1)
    return np.asarray(np.nanmax(phi2 - threads * pitch, axis=0))


@pytest.mark.sweep
@pytest.mark.parametrize("name", some(DRIVES, 1))
def test_solids_touch_and_do_not_overlap(name: str) -> None:
    """At five positions: slivers of the facets' error where they touch, nothing when the wheel is turned away by both tolerances,
    an overlap when it is turned the other way."""
    gears = drive(name)
    (pair,) = gears.pairs
    worm, wheel = (gears.solid(member, TOLERANCE).mesh for member in gears.members)
    # normal distances are those along the pitch circle times cos(gamma) cos(alpha_n); a quarter more, as it varies over the flank
    normal = np.cos(gears.design.lead_angle) * np.cos(np.radians(20.0))
    turn = 1.25 * 2.0 * TOLERANCE / (95.0 * normal)
    for phi1, phi2 in zip(np.radians(PHI1), in_touch(name), strict=True):
        here, away, into = (overlap(pair, (worm, wheel), phi1, phi2 + k * turn) for k in (0.0, 1.0, -1.0))
        assert 0.0 < here.thickness < TOLERANCE
        assert away.volume == 0.0
        assert into.thickness > TOLERANCE


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "tolerance"), [("worm_drive", 0.02), ("worm_drive_zk_oversize", 0.02), ("worm_drive_dual_lead", 0.005)]
)
def test_solids_of_samples_touch_where_they_should_on_both_sides(sample: str, tolerance: float) -> None:
    """At five positions of a pitch: slivers where the driving flanks touch, and as many where the others do, turned on by the
    backlash of that position; nothing between them, and overlaps beyond, by both tolerances."""
    gears = built_sample(sample)
    (pair,), fit = gears.pairs, gears.contact().fit
    assert fit is not None
    worm, wheel = (gears.solid(member, tolerance).mesh for member in gears.members)
    step = 1.25 * 2.0 * tolerance / fit.lever
    phi1 = (np.arange(5.0) / 5.0 + 0.03) * pair.pitch
    for rotation, first, play in zip(phi1, fit.turns(phi1), fit.play(phi1), strict=True):
        ways = (0.0, play, -step, play + step, *((step, 0.5 * play, play - step) if play > 2.0 * step else ()))
        touching, coasting, *beyond = (
            overlap(pair, (worm, wheel), rotation, first + pair.drive * way) for way in ways[:4]
        )
        assert 0.0 < touching.thickness < tolerance
        assert 0.0 < coasting.thickness < tolerance
        assert min(into.thickness for into in beyond) > tolerance
        for way in ways[4:]:
            assert overlap(pair, (worm, wheel), rotation, first + pair.drive * way).volume == 0.0


@pytest.mark.parametrize("changes", [["hob.reference_diameter=66"], ["shaft_angle=75"]], ids=str)
def test_roots_of_wheels_end_where_fillets_begin(changes: list[str]) -> None:
    """Hob whose axis is turned out of the plane across the wheel's axis: its tip cylinder leaves points beside the plane of the
    common perpendicular. Computed from points in that plane, root and fillet are 4 um apart at the end of the face, and 1 mm at
    75 deg."""
    gears = built_sample("worm_drive", *changes)
    tooth, hob = gears.members["wheel"].tooth, wheel_hob(gears.design)
    sections = tooth.sections(np.linspace(0.0, 1.0, 9))
    root, right, left = (
        tooth.grid(region, np.array([0.0, 1.0]), sections).points
        for region in (Region.ROOT, Region.FILLET_RIGHT, Region.FILLET_LEFT)
    )
    assert np.abs(root[1] - right[0]).max() < 1e-11
    assert np.abs(np.hypot(root[0, :, 0], root[0, :, 1]) - np.hypot(left[1, :, 0], left[1, :, 1])).max() < 1e-11
    # the least distance of the tip cylinder from the axis, at every height
    s, c = np.sin(hob.tilt), np.cos(hob.tilt)

    def away(psi: float, z: float) -> float:
        along = (z - hob.tip_radius * np.sin(psi) * c) / s
        return float(
            np.hypot(hob.distance - hob.tip_radius * np.cos(psi), along * c - hob.tip_radius * np.sin(psi) * s)
        )

    for x, y, z in root[1]:
        least = minimize_scalar(away, args=(z,), bounds=(-1.5, 1.5), method="bounded", options={"xatol": 1e-9})
        assert np.hypot(x, y) == pytest.approx(least.fun, abs=1e-10)


@pytest.mark.sweep
@pytest.mark.parametrize("angle", [20.0, 25.0])
def test_chamfered_throats_touch_the_throat_and_leave_it_nowhere(angle: float) -> None:
    """The tip in the axial section against distances from the worm's axis, where the wheel's flanks end, and as solids."""
    changes = ["wheel.tip_form=chamfered", f"wheel.throat_angle={angle}"]
    gears, throated = built_sample("worm_drive", *changes), built_sample("worm_drive")
    tooth = gears.members["wheel"].tooth
    z = np.linspace(-18.0, 18.0, 36001)
    tip = tooth.blank.tip.at(z)
    away = np.hypot(125.0 - tip, z)
    assert away.min() == pytest.approx(25.0, abs=1e-6)
    touching = z[away < 25.0 + 1e-6]
    for place in (0.0, 25.0 * np.sin(np.radians(angle))):
        assert np.abs(np.abs(touching) - place).min() < 2e-3
    assert tip.max() == 102.5 == tip[-1]
    ends = tooth.grid(Region.FLANK_RIGHT, np.array([1.0]), tooth.sections(np.linspace(0.0, 1.0, 21))).points[0]
    np.testing.assert_allclose(np.hypot(ends[:, 0], ends[:, 1]), tooth.blank.tip.at(ends[:, 2]), rtol=0, atol=1e-9)
    assert gears.solid("wheel", 0.1).figures["watertight"]
    volumes = [of.members["wheel"].tooth.volume() for of in (throated, gears)]
    # the throat has more material everywhere, but nowhere more than 1 mm of tip
    assert 0.0 < volumes[0] - volumes[1] < 2.0 * np.pi * 102.5 * 41.0 * 0.1
