"""Load factors of loaded contact: K_Hbeta, load per face width over its mean; K_Halpha, with over without pitch deviations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.loaded import geared, loaded_contact
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.load.loaded import face_exponent, loaded_contact_of
from gearmesh.teeth.micro_geometry.index_angles import IndexAngles

MISALIGNED = "assembly.gamma_v=0.02"


@pytest.mark.sweep
def test_the_face_load_factor_is_largest_over_mean_load_of_slices() -> None:
    factors = []
    for keys in ((), (MISALIGNED,)):
        loaded = loaded_contact("spur", (300.0,), 3, *keys)
        rows = loaded.tribology().rows
        z, force, length = np.array(
            [(row.members["gear"].point[2], row.line_load * row.length, row.length) for row in rows]
        ).T
        # the gear is 28 mm wide, the pinion 30: places by the gear's own frame; rows run along the axis
        ends = np.linspace(-14.0, 14.0, 21)[:, None]
        slices = np.diff((np.clip((ends - z) / length + 0.5, 0.0, 1.0) * force).sum(axis=1))
        assert slices.sum() == pytest.approx(force.sum(), rel=1e-3)
        (total,) = loaded.totals
        assert total.k_h_beta == pytest.approx(slices.max() / slices.mean(), rel=5e-3)
        factors.append(total.k_h_beta)
        # gear: 28 mm over 2.25 modules of 3 mm
        ratio = 28.0 / (2.25 * 3.0)
        assert total.k_f_beta == pytest.approx(total.k_h_beta ** (1.0 / (1.0 + 1.0 / ratio + 1.0 / ratio**2)), rel=1e-6)
        lean = slices[0] / slices[-1]
        assert lean > 1.2 if keys else lean == pytest.approx(1.0, rel=1e-3)
    # the ends of the narrower gear bear more than its middle, the misaligned end more still
    assert 1.05 < factors[0] < factors[1] - 0.05


def test_the_exponent_is_that_of_the_standard() -> None:
    """ISO/TR 6336-30, example 1 (17/103 teeth, module 8, face 100 mm): K_Hbeta 1.16 gives K_Fbeta 1.12803."""
    # tip 1.145 and root 1.4 - 0.145 modules from the reference circle; the gear is as deep
    assert 1.16 ** face_exponent((100.0, 100.0), (19.2, 19.2)) == pytest.approx(1.12803, rel=5e-4)
    # narrow faces count as three whole depths, and the smaller ratio counts: 9 / (1 + 3 + 9)
    assert face_exponent((10.0, 50.0), (10.0, 10.0)) == pytest.approx(9.0 / 13.0, rel=1e-12)
    assert face_exponent((80.0, 50.0), (10.0, 10.0)) == pytest.approx(25.0 / 31.0, rel=1e-12)


def test_parts_of_a_mesh_cycle_have_no_face_load_factor() -> None:
    loaded = loaded_contact("spur", (300.0,), 3)
    assert "k_h_beta" in loaded.totals[0].row
    part = replace(loaded, mesh=replace(loaded.mesh, phi1=0.1 * loaded.mesh.phi1))
    assert "k_h_beta" not in part.totals[0].row


def test_the_transverse_load_factor_of_a_tooth_that_bears_all_is_in_closed_form() -> None:
    """A tooth far ahead of its place bears the whole torque: its normal force is T / (r_b cos(beta_b)). One that lies far back
    bears nothing, and its neighbours more than before."""
    design, (pair, bodies) = gm.load(SAMPLES / "helical.toml"), geared("helical")
    phi1, torque = np.zeros(1), 100.0
    alone = loaded_contact_of(design, pair, [torque], phi1=phi1, cycle=None, bodies=bodies)
    assert "k_h_alpha" not in alone.totals[0].row
    share = max(tooth_pair.load_share for tooth_pair in alone.rows[0].tooth_pairs)
    assert share < 0.7
    # 24 teeth, module 5 mm, 20 and 15 deg
    at = np.tan(np.radians(20.0)) / np.cos(np.radians(15.0))
    base_radius = 60.0 / np.cos(np.radians(15.0)) / np.hypot(1.0, at)
    base_cosine = np.sqrt(1.0 - (np.sin(np.radians(15.0)) * np.cos(np.radians(20.0))) ** 2)
    whole = 1e3 * torque / (base_radius * base_cosine)
    factors, tooth = {}, pair.pinion.tooth.teeth * [0.0]
    for ahead in (-0.1, 0.1):
        tooth[0] = ahead / base_radius
        uneven = replace(pair, pinion=replace(pair.pinion, index=IndexAngles(tuple(tooth), tuple(tooth))))
        loaded = loaded_contact_of(design, uneven, [torque], phi1=phi1, cycle=None, bodies=bodies)
        pairs = [tooth_pair.pair for tooth_pair in loaded.rows[0].tooth_pairs]
        factors[0 in pairs] = loaded.totals[0].k_h_alpha
        assert (0 in pairs) == (pairs == [0])
    assert factors[True] == pytest.approx(whole / alone.mesh.loads[0].force.max(), rel=5e-3)
    assert 1.0 < factors[False] < factors[True]
