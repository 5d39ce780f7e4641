"""Principal curvatures that `tca --json` has: against closed forms, differences of normals, and the ellipse beside them."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.flanks import path_curvatures
from gearmesh.systems.spiral_bevel.conjugate.build import conjugate_blank, conjugate_geometry


@pytest.mark.parametrize("geometry", [1, 2])
@pytest.mark.sweep_cases("1")
def test_conjugate_flanks_have_the_curvatures_of_the_source(geometry: int) -> None:
    """[CR3553 2.4.5-7, 2.7.10-12] at the mean point."""
    design = gm.load(SAMPLES / f"spiral_bevel_geometry{geometry}.toml")
    form = conjugate_geometry(design, conjugate_blank(design), "convex")  # type: ignore[arg-type]
    row = gm.build(design).contact(0.0, cycle=False).positions()[0].row
    for member, name in ((1, "pinion"), (2, "gear")):
        # by the source's normal, which is out of the pinion and into the gear
        sign = 1.0 if member == 1 else -1.0
        wanted = sorted(sign * k for k in form.mean_curvatures(member)[:2])
        found = row["curvature"][name]
        np.testing.assert_allclose([found["k2_per_mm"], found["k1_per_mm"]], wanted, rtol=1e-6)
    relative = row["curvature"]["relative"]
    # the ellipse has half axes sqrt(2 delta / |k|), its major axis along the smaller curvature
    np.testing.assert_allclose(
        [row["ellipse"]["a_mm"], row["ellipse"]["b_mm"]],
        np.sqrt(2.0 * design.in_mm().contact.delta / -np.array([relative["k1_per_mm"], relative["k2_per_mm"]])),
        rtol=1e-9,
    )
    assert abs(np.dot(relative["direction1"], row["ellipse"]["major_axis"])) > 1.0 - 1e-9


@pytest.mark.parametrize("sample", ["beveloid_crossed", "hypoid", "helical"])
@pytest.mark.sweep_cases("beveloid_crossed", "hypoid")
def test_directions_and_curvatures_are_those_of_differences_of_normals(sample: str) -> None:
    """A step along a principal direction turns the normal by -k times it; no second derivative is asked for."""
    contact = gm.build(gm.load(SAMPLES / f"{sample}.toml")).contact(np.array([-2.0, 1.0]), cycle=False)
    pair, path = contact.pair, contact.path
    curved = path_curvatures(pair, path)
    for member, side, params, turn, own in zip(
        pair.both, pair.flanks, (path.params1, path.params2), (path.rotation, path.phi2), curved[:2], strict=True
    ):
        surface, place = member.tooth.side(side).flank, member.mount.at(turn)
        u, v = params.T
        at = surface.jet(u, v).move(place)
        for k, way in ((own.k1, own.direction1), (own.k2, own.direction2)):
            tangents = np.stack((at.r_u, at.r_v), axis=-1)
            du, dv = (np.linalg.pinv(tangents) @ way[..., None])[..., 0].T
            step = 1e-3
            ahead, back = (surface.jet(u + s * du, v + s * dv).move(place).n for s in (step, -step))
            np.testing.assert_allclose((ahead - back) / (2.0 * step), -k[:, None] * way, rtol=0, atol=2e-6)
