"""Independence of the description of a pair: units, hand, tooth, working side, member order."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from oracles.built import pair_of
from oracles.drawn import zero_or_more
from oracles.examples import examples

from gearmesh import Rigid, parse
from gearmesh.contact.engagement.cycle import gears_curve
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import rotation_about

PHI1 = np.radians([-4.0, 0.0, 3.0])
few = examples(5)
cones, helices, errors = st.floats(5.0, 25.0), zero_or_more(-20.0, 20.0), zero_or_more(-0.2, 0.2)


def design(cone: float, helix: float, dx: float = 0.0, gamma: float = 0.0, **more: Any) -> dict[str, Any]:
    member = {"cone_angle": cone, "helix_angle": helix, "face_width": 14.0}
    return {
        "kind": "beveloid",
        "module": 5.0,
        "pinion": {"teeth": 24, **member},
        "gear": {"teeth": 36, **member},
        "assembly": {"dx": dx, "gamma_h": gamma},
        "contact": {"phi1": {"start": -4, "stop": 4, "count": 3}},
        **more,
    }


def solved(mapping: dict[str, Any], phi1: Any = PHI1) -> tuple[Pair, ContactPath]:
    """The solver's pair of a design, and its path."""
    gears = pair_of(parse(mapping))
    pair = solver_pair(gears)
    return pair, contact_path(pair, np.asarray(phi1), gears.generation)


def path_of(mapping: dict[str, Any], phi1: Any = PHI1) -> ContactPath:
    return solved(mapping, phi1)[1]


def same(one: ContactPath, other: ContactPath, scale: float = 1.0, sense: float = 1.0) -> None:
    """Alike but for `scale`, and for the `sense` in which rotations count.

    Flanks whose relative curvature is at the threshold of lines count as touching along one, or on an edge, as rounding falls.
    """
    unlike = one.kind != other.kind
    assert set(one.kind[unlike]) | set(other.kind[unlike]) <= {"edge", "line"}
    touching = one.touching
    te_of_line = 1e-8  # rad: FLAT of a curvature of 0.1/mm over half a face of 14 mm, at a radius of 50 mm
    np.testing.assert_allclose(
        one.te[touching], sense * other.te[touching], rtol=0, atol=te_of_line if unlike.any() else 1e-11
    )
    for name in ("semi_major", "semi_minor"):
        np.testing.assert_allclose(getattr(one, name), scale * getattr(other, name), rtol=1e-6)


def same_places(
    points: tuple[np.ndarray, np.ndarray], paths: tuple[ContactPath, ContactPath], pair: Pair, scale: float
) -> None:
    """Points (N, 3) of two paths alike, across the ellipses of the first one, which is that of `pair`.

    Along them as far as the solver knows the place: normals agree to its tolerance over its length, and over the curvature
    2 delta / a^2 that is a distance.
    """
    path, other = paths
    apart = points[0] - points[1]
    inside = path.kind == "point"
    along = (apart * path.major).sum(axis=1)[inside]
    known = 2.0 * pair.tolerance / pair.length * path.semi_major[inside] ** 2 / (2.0 * pair.delta)
    assert (np.abs(along) <= known + 1e-8 * scale).all()
    apart[inside] -= along[:, None] * path.major[inside]
    # of lines any point stands for the whole
    np.testing.assert_allclose(apart[(path.kind == other.kind) & (path.kind != "line")], 0.0, rtol=0, atol=1e-8 * scale)


@pytest.mark.sweep
@few
@given(cone=cones, helix=helices, dx=errors, gamma=errors)
def test_inches_are_millimetres(cone: float, helix: float, dx: float, gamma: float) -> None:
    metric = design(cone, helix, dx, gamma)
    inch = design(cone, helix, dx / 25.4, gamma, units="inch", module=5.0 / 25.4)
    for member in ("pinion", "gear"):
        inch[member]["face_width"] = 14.0 / 25.4
    same(path_of(metric), path_of(inch))


@pytest.mark.sweep
@few
@given(cone=cones, helix=helices, scale=st.floats(0.1, 20.0))
@example(cone=5.0, helix=-13.609375, scale=9.0)  # an ellipse of 4 m
@example(cone=5.0, helix=-13.875, scale=0.1015625)  # all but a line
def test_a_pair_scales(cone: float, helix: float, scale: float) -> None:
    small = design(cone, helix)
    large = design(cone, helix, module=5.0 * scale)
    for member in ("pinion", "gear"):
        large[member]["face_width"] = 14.0 * scale
    large["contact"] = {**small["contact"], "delta": 0.00635 * scale}
    (pair, one), other = solved(large), path_of(small)
    same(one, other, scale)
    same_places((one.point, scale * other.point), (one, other), pair, scale)


@pytest.mark.sweep
@few
@given(cone=cones, helix=helices)
@example(cone=5.703125, helix=-15.84375)  # an ellipse of 1.7 m: the place along it is known to 1e-3 mm
def test_the_mirror_image_of_a_pair_touches_in_the_mirror(cone: float, helix: float) -> None:
    one = path_of(design(cone, helix))
    mirrored = design(cone, -helix)
    mirrored["contact"] = {**mirrored["contact"], "flank": "left"}
    pair, other = solved(mirrored, -PHI1)
    same(one, other, sense=-1.0)
    same_places((other.point, one.point * [1.0, -1.0, 1.0]), (other, one), pair, 1.0)


@pytest.mark.sweep
@examples(3)
@given(helix=zero_or_more(0.0, 25.0), swap=st.booleans())
@example(
    helix=9.014438759172384, swap=False
)  # the end of the line of contact lies in the very corner of the flank at a node
def test_members_may_be_exchanged(helix: float, swap: bool) -> None:
    """A parallel-axis pair has the same contact ratio whichever member drives."""
    teeth = (20, 33) if swap else (33, 20)
    ratios = []
    for first, second in (teeth, teeth[::-1]):
        members = {
            "pinion": {"teeth": first, "helix_angle": helix, "face_width": 20.0},
            "gear": {"teeth": second, "helix_angle": -helix, "face_width": 20.0},
        }
        gears = pair_of(parse({**design(0.0, helix), **members}))
        curve = gears_curve(solver_pair(gears), gears.pitch)
        assert curve is not None
        ratios.append(curve.surface.length / gears.pitch)
    assert ratios[0] == pytest.approx(ratios[1], abs=5e-4)


@few
@given(cone=cones, helix=helices, dx=errors)
def test_every_tooth_pair_is_alike(cone: float, helix: float, dx: float) -> None:
    """The next tooth pair does one pitch later, at the same places, what this one does now."""
    gears = pair_of(parse(design(cone, helix, dx)))
    pitch = gears.pitch
    pair = solver_pair(gears)
    following = replace(
        pair,
        pinion=replace(pair.pinion, mount=replace(pair.pinion.mount, zero=pair.pinion.mount.zero + pitch)),
        gear=replace(pair.gear, mount=replace(pair.gear.mount, zero=pair.gear.mount.zero + pair.ratio * pitch)),
    )
    one, other = contact_path(pair, PHI1), contact_path(following, PHI1 + pitch)
    np.testing.assert_allclose(other.point, one.point, rtol=0, atol=1e-8)
    np.testing.assert_allclose(other.phi2, one.phi2 + pair.ratio * pitch, rtol=0, atol=1e-11)


@pytest.mark.sweep
@few
@given(cone=cones, helix=helices, gamma=errors, turns=st.tuples(*[st.floats(-3.0, 3.0)] * 3))
def test_the_frame_does_not_matter(cone: float, helix: float, gamma: float, turns: tuple[float, float, float]) -> None:
    gears = pair_of(parse(design(cone, helix, 0.0, gamma)))
    pair = solver_pair(gears)
    turned = rotation_about("x", turns[0]) @ rotation_about("y", turns[1]) @ rotation_about("z", turns[2])
    moved = Rigid(turned, 100.0 * np.array(turns))
    elsewhere = replace(
        pair,
        pinion=replace(pair.pinion, mount=replace(pair.pinion.mount, base=moved @ pair.pinion.mount.base)),
        gear=replace(pair.gear, mount=replace(pair.gear.mount, base=moved @ pair.gear.mount.base)),
    )
    one, other = contact_path(pair, PHI1), contact_path(elsewhere, PHI1)
    same(one, other)
    np.testing.assert_allclose(other.point, moved.point(one.point), rtol=0, atol=1e-8)


@pytest.mark.sweep
@few
@given(backlash=zero_or_more(0.0, 0.3), helix=zero_or_more(0.0, 20.0), shift=zero_or_more(0.0, 0.4))
def test_backlash_is_what_lies_between_the_flanks(backlash: float, helix: float, shift: float) -> None:
    """Normal backlash: between drive and coast contact the gear turns by j_n / (r_b cos(beta_b)).

    With shifted profiles this holds only at the centre distance of ISO 21771, which is what the pair is mounted at.
    """
    members = {
        "pinion": {"teeth": 24, "helix_angle": helix, "face_width": 20.0, "profile_shift": shift},
        "gear": {"teeth": 36, "helix_angle": -helix, "face_width": 20.0, "profile_shift": 0.1},
    }
    mapping = {**design(0.0, helix), **members, "backlash": backlash}
    gaps = []
    for flank in ("right", "left"):
        path = path_of({**mapping, "contact": {**mapping["contact"], "flank": flank}}, [0.0])
        gaps.append(float(path.phi2[0]))
    beta, alpha = np.radians(helix), np.radians(20.0)
    transverse = np.arctan(np.tan(alpha) / np.cos(beta))
    base = 0.5 * 36 * 5.0 / np.cos(beta) * np.cos(transverse)
    base_helix = np.arcsin(np.sin(beta) * np.cos(alpha))
    play = 2.0 * np.pi / 36 - (gaps[0] - gaps[1])
    assert play * base * np.cos(base_helix) == pytest.approx(backlash, abs=1e-9)
