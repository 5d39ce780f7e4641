"""Fields of many assemblies from polynomials in their poses: against functions that are known, and against assembly by assembly."""

from __future__ import annotations

import json

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Rigid
from gearmesh.contact.assemblies import many_assemblies
from gearmesh.contact.first_touch import field
from gearmesh.contact.first_touch.poses import CHECKED_ASSEMBLIES, Poses
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.study.rows.work import _build, displacing_keys

#: middle (mm) of the flank of the poses, and distance of its points from it
FLANK_MIDDLE, FLANK_REACH = np.array([30.0, 5.0, 2.0]), 12.0


def poses(count: int, scale: float) -> tuple[Rigid, Array]:
    """Random poses by three errors (M, 3): two shifts, mm, and a lean, rad, about an axis far from the flank."""
    errors = np.random.default_rng(8).normal(size=(count, 3)) * (scale, scale, scale / 40.0)
    nominal = rotation_about("x", 1.3)
    shifts = np.stack((errors[:, 0], errors[:, 1], np.zeros(count)), axis=-1)
    return Rigid(rotation_about("y", errors[:, 2]) @ nominal, np.array([0.0, 3.0, 90.0]) + shifts), errors


def test_smooth_fields_follow_from_few_assemblies() -> None:
    """Points of the flank on cylinders about a distant axis, by arcs that no polynomial has."""
    own_to_gear, _ = poses(300, 0.03)
    known = Poses.of(own_to_gear, FLANK_MIDDLE, FLANK_REACH)
    assert known is not None
    assert len(known.sampled) + CHECKED_ASSEMBLIES <= 100
    points = FLANK_MIDDLE + np.random.default_rng(9).uniform(-6.0, 6.0, (12, 3))
    seen = np.swapaxes(own_to_gear.rotation @ points.T, -1, -2) + own_to_gear.translation[:, None]
    advance = np.arctan2(seen[..., 1], seen[..., 0]) + 0.02 * np.sin(0.4 * seen[..., 2])
    beyond = np.stack([np.hypot(seen[..., 0], seen[..., 1]) - 30.0, seen[..., 2] - 80.0, -seen[..., 1], seen[..., 0]])
    # one node breaks in the assemblies beside one error, one node has an advance in some assemblies only
    advance[:, 3] += np.abs(1e-3 * (seen[:, 3, 0] - seen[:, 3, 0].mean()))
    advance[:, 7] = np.where(seen[:, 7, 1] > np.median(seen[:, 7, 1]), advance[:, 7], np.nan)
    few = np.concatenate((known.sampled, known.checked))
    fitted = known.fit(advance[few], beyond[:, few])
    assert fitted.exact.tolist() == [3, 7]
    every = np.delete(np.arange(12), fitted.exact)
    found, outside = fitted.at(np.arange(300))
    np.testing.assert_allclose(found[:, every], advance[:, every], rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(outside, beyond, rtol=0.0, atol=1e-6)


def test_few_assemblies_and_wide_errors_have_no_polynomials() -> None:
    assert Poses.of(poses(30, 0.03)[0], FLANK_MIDDLE, FLANK_REACH) is None
    assert Poses.of(poses(80, 1.0)[0], FLANK_MIDDLE, FLANK_REACH) is None
    # shifts alone along one line need few terms
    along = Rigid(np.broadcast_to(np.eye(3), (60, 3, 3)), np.linspace(-0.1, 0.1, 60)[:, None] * (1.0, 2.0, 0.5))
    known = Poses.of(along, FLANK_MIDDLE, FLANK_REACH)
    assert known is not None
    assert len(known.sampled) <= 5


@pytest.mark.sweep_cases("spur", "hypoid", "beveloid_parallel", "face_gear")
@pytest.mark.parametrize("name", ["spiral_bevel_basic", "helical", "spur", "hypoid", "beveloid_parallel", "face_gear"])
def test_contacts_are_those_of_sampled_advances(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    design = gm.load(SAMPLES / f"{name}.toml")
    variant = _build(json.dumps(design.stated(), sort_keys=True, default=str), 0)
    keys = displacing_keys(str(design.stated()["kind"]))[:3]
    rng = np.random.default_rng(6)
    errors = {key: rng.normal(0.0, 0.006 if "delta" in key else 0.02, 150) for key in keys}
    bases, phi1 = variant.bases(errors), variant.phi1[[2, len(variant.phi1) // 2, -3]]
    fits: list[int] = []
    fit = Poses.fit

    def counted(known: Poses, advance: Array, beyond: Array) -> object:
        fits.append(len(advance))
        return fit(known, advance, beyond)

    monkeypatch.setattr(Poses, "fit", counted)
    posed = many_assemblies(variant.flanks, bases, phi1)
    # the flanks of each rotation are polynomials through a third of the assemblies or less
    assert len(fits) >= 2
    assert max(fits) <= 50
    monkeypatch.setattr(field, "LEAST_POSED", 10**6)
    sampled = many_assemblies(variant.flanks, bases, phi1)
    np.testing.assert_array_equal(posed.edges, sampled.edges)
    np.testing.assert_array_equal(posed.line, sampled.line)
    np.testing.assert_allclose(posed.advance, sampled.advance, rtol=0.0, atol=1e-12)
