"""A member of one tooth: a thread that goes round its axis, with a wheel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import gearmesh as gm
from gearmesh.answers.check import flank_meshes, roll_test
from gearmesh.cad.section import member_section
from gearmesh.check.heightfield import MeshFlank
from gearmesh.check.members import roll_teeth
from gearmesh.check.windings import turns
from gearmesh.contact.flanks import analyse
from gearmesh.mesh.solid import gear_solid, prove

FILE = Path(__file__).parents[1] / "corpus" / "thread_beveloid_one_tooth.toml"
#: of the solids, mm, and their surface, mm^2, at most
TOLERANCE, AREA = 0.02, 2e4


def test_a_member_of_one_tooth_is_a_closed_solid() -> None:
    gears = gm.build(gm.load(FILE))
    thread = gears.members["pinion"]
    # lead p_z = pi m_n / sin(beta) of the width of 40 mm
    assert turns(thread.tooth) == pytest.approx(40.0 / (np.pi * 4.0 / np.sin(np.radians(85.0))), rel=1e-9)
    assert turns(gears.members["gear"].tooth) < 0.1
    proof = prove(gear_solid(thread, TOLERANCE), thread.genus)
    assert (proof.status, proof.watertight) == ("NoError", True)
    assert abs(proof.volume - thread.plain_volume()) < TOLERANCE * AREA
    curves = [c for contour in member_section(thread, 7.0, 1e-3).contours for c in contour.curves]
    reach = max(float(np.hypot(*c.at(np.linspace(0.0, 1.0, 5)).T).max()) for c in curves)
    assert reach == pytest.approx(float(thread.tooth.blank.tip.at(7.0)), abs=1e-6)


@pytest.mark.sweep
def test_a_thread_drives_its_wheel_uniformly_and_the_roll_test_agrees() -> None:
    """Both are involute helicoids: no transmission error over whole turns, which pass from tooth to tooth of the wheel."""
    pair = gm.build(gm.load(FILE)).train.pairs[0]
    path = analyse(pair, np.linspace(-np.pi, 1.2 * np.pi, 12))
    assert path.touching.all()
    assert (path.edge == "").all()
    assert np.ptp(path.te) < 1e-9
    # of several windings that a circle about the wheel's axis meets the one in mesh, exact grids and meshes within a tolerance
    (touch,) = roll_teeth(pair, path.phi1[6:7], cells=40, guess_phi2=path.phi2[6:7])
    assert touch is not None
    assert abs(touch.phi2 - path.phi2[6]) < 1e-6
    found = roll_test(pair, path, positions=1, tolerance=0.01)
    # facets of 10 um are coarse for the ellipse, not for the gear's rotation
    (verdict,) = (verdict for verdict in found.verdicts if "te_difference" in verdict.what)
    assert verdict.ok
    # the next winding, where the gear is expected a tooth farther: it touches behind the end of its surface contact
    (other,) = roll_teeth(pair, path.phi1[6:7], cells=40, guess_phi2=path.phi2[6:7] + 2.0 * np.pi / 30.0)
    assert other is not None
    assert 0.0 < abs(other.phi2 - path.phi2[6] - 2.0 * np.pi / 30.0) < 0.01


def area(corners: NDArray[np.float64]) -> float:
    edges = np.diff(corners, axis=1)
    return 0.5 * float(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=-1).sum())


def test_long_facets_do_not_reach_into_the_next_winding() -> None:
    """Teeth that go round 1.07 times, in long facets: where a tooth comes into mesh its other end met the gear first."""
    pair = gm.build(gm.load(FILE.with_name("overlap_beveloid_four_teeth.toml"))).train.pairs[0]
    path = analyse(pair, np.radians([-235.0]))
    (flank, _) = flank_meshes(pair, 0.05)
    corners = flank.corners()
    assert np.ptp(corners[..., 2], axis=1).max() > 10.0
    piece = MeshFlank(corners).between(-10.0, 5.0)
    assert piece is not None
    assert (piece.points[:, 2].min(), piece.points[:, 2].max()) == (-10.0, 5.0)
    # what is left of the others is below and above
    others = [MeshFlank(corners).between(*ends) for ends in ((-np.inf, -10.0), (5.0, np.inf))]
    parts = [area(part.corners) for part in (piece, *others) if part is not None]
    assert sum(parts) == pytest.approx(area(corners), rel=1e-12)
    (verdict,) = roll_test(pair, path, positions=1, tolerance=0.05).verdicts
    assert verdict.ok
