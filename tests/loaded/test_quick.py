"""Contact under load at level "quick": against level "full" at three torques, and variants on the grids of another design."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, GearPair
from gearmesh.contact.hertz import STEEL
from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.loaded.separation import near_pairs, separation
from gearmesh.loaded.sharing import (
    MAX_VARIANT_SHIFT,
    Level,
    LoadedMesh,
    Reference,
    compliances,
    largest_shift,
    loaded_mesh,
    modified_shift,
    outlines_of,
)

#: torques, Nm, at which samples run
TORQUES = {
    "spur_relieved": (20.0, 50.0, 100.0),
    "helical": (500.0, 1000.0, 1500.0),
    "spiral_bevel_basic": (20.0, 60.0, 150.0),
    "face_gear": (50.0, 100.0, 200.0),
}
POSITIONS = 9


def positions(pair: GearPair) -> Array:
    places: Array = pair.pitch * np.arange(POSITIONS) / POSITIONS
    return places


@lru_cache
def pair_with(sample: str, *keys: str) -> GearPair:
    return pair_of(gm.load(SAMPLES / f"{sample}.toml", list(keys)))


def solved(sample: str, level: Level, *keys: str) -> LoadedMesh:
    """A sample under its torques at a level."""
    pair = pair_with(sample, *keys)
    bodies = compliances(pair, level=level)
    return loaded_mesh(pair, positions(pair), 1e3 * np.array(TORQUES[sample]), bodies, level=level)


def largest_shares(found: LoadedMesh) -> Array:
    """Largest share of the torque on a tooth pair, (T, P)."""
    return np.array(
        [
            [(load.moment[load.position == p] / torque).max() for p in range(POSITIONS)]
            for load, torque in zip(found.loads, found.torque, strict=True)
        ]
    )


def assert_close(quick: LoadedMesh, full: LoadedMesh) -> None:
    """Transmission error and load shares within 3 %, or a thousandth of the deflection; what else the README says."""
    ranges = [np.ptp(found.te, axis=1) / ARCSEC for found in (quick, full)]
    room = 0.03 * ranges[1] + 1e-3 * full.rotation.max(axis=1) / ARCSEC
    assert (np.abs(ranges[0] - ranges[1]) < room).all(), ranges
    np.testing.assert_allclose(largest_shares(quick), largest_shares(full), rtol=0.03)
    np.testing.assert_allclose(quick.rotation, full.rotation, rtol=0.02)
    np.testing.assert_allclose(quick.bending.max(axis=1), full.bending.max(axis=1), rtol=0.15)
    peaks = [np.array([np.nanmax(load.peak) for load in found.loads]) for found in (quick, full)]
    np.testing.assert_allclose(*peaks, rtol=0.06)


@pytest.mark.sweep
@pytest.mark.sweep_cases("helical", "spiral_bevel_basic", "face_gear")
@pytest.mark.parametrize("sample", some(list(TORQUES), 4))
def test_the_quick_level_is_near_the_full_one(sample: str) -> None:
    quick, full = (solved(sample, level) for level in ("quick", "full"))
    assert_close(quick, full)
    # errors are not estimated
    assert all(np.isnan(load.error).all() for load in quick.loads)


@pytest.mark.sweep
def test_a_variant_on_grids_and_bodies_of_another_design() -> None:
    """10 um of crowning: the same as with bodies and grids of its own; with 0.2 mm the gears are other gears."""
    sample, crowned = "spur_relieved", "pinion.modifications.helix_crowning=10um"
    pair, variant = pair_with(sample), pair_with(sample, crowned)
    phi1, torque = positions(pair), 1e3 * np.array(TORQUES[sample])
    bodies = compliances(pair, level="quick")
    reference = Reference.of(pair, phi1, torque, bodies, (STEEL, STEEL), "quick")
    assert largest_shift(pair, variant, outlines_of(pair), outlines_of(variant)) < MAX_VARIANT_SHIFT
    # the gear's tooth is the same one, and its outline is computed once
    assert [one is other for one, other in zip(outlines_of(pair), outlines_of(variant), strict=True)] == [False, True]
    found = loaded_mesh(variant, phi1, torque, bodies, level="quick", reference=reference)
    own = solved(sample, "quick", crowned)
    np.testing.assert_allclose(found.te, own.te, atol=2e-3 * own.rotation.max())
    np.testing.assert_allclose(found.rotation, own.rotation, rtol=5e-3)
    other = pair_with(sample, "pinion.modifications.helix_crowning=200um")
    assert largest_shift(pair, other, outlines_of(pair), outlines_of(other)) > MAX_VARIANT_SHIFT


def test_modifications_alone_shift_teeth_as_far_as_their_outlines_do() -> None:
    """Second route: outlines, which are made from hexahedra. Other teeth cannot be compared so."""
    pair = pair_with("helical")
    crowned = pair_with("helical", "pinion.modifications.helix_crowning=0.01")
    outlines = outlines_of(pair)
    shift = modified_shift(pair, crowned, outlines)
    assert shift == pytest.approx(largest_shift(pair, crowned, outlines, outlines_of(crowned)), rel=1e-3)
    assert modified_shift(pair, pair, outlines) == 0.0
    assert modified_shift(pair, pair_with("helical", "pinion.profile_shift=0.01"), outlines) is None


def test_grids_of_one_pair_that_differ_in_width_have_the_gaps_of_the_widest() -> None:
    """Against grids of their own: 2 nm, of polynomials of degree 4, and the same cells on the flanks."""
    near = near_pairs(pair_with("spur_relieved"), np.array([0.02]), 0.02)
    count = len(near.position)
    force, widths = np.full(2 * count, 2000.0), np.repeat([1.0, 0.7], count)
    shared = separation(near.repeated(2), force, 115000.0, (12, 8), widths)
    own = separation(near, force[:count], 115000.0, (12, 8), widths[count:])
    np.testing.assert_array_equal(shared.narrow, widths)
    np.testing.assert_allclose(shared.gap[count:], own.gap, rtol=0.0, atol=2e-6)
    np.testing.assert_array_equal(shared.on[count:], own.on)


@pytest.mark.sweep
def test_contact_that_opens_and_closes_in_turns_converges() -> None:
    """A cell of a variant of the helical sample did so for 600 steps, until directions began anew there."""
    sample = "helical"
    pair, variant = pair_with(sample), pair_with(sample, "pinion.modifications.profile_crowning=7um")
    phi1, torque, bodies = positions(pair), 1e3 * np.array(TORQUES[sample]), compliances(pair, level="quick")
    reference = Reference.of(pair, phi1, torque, bodies, (STEEL, STEEL), "quick")
    found = loaded_mesh(variant, phi1, torque, bodies, level="quick", reference=reference)
    assert (found.status == Status.CONVERGED).all()


def test_other_levels_are_refused() -> None:
    with pytest.raises(DesignError, match="level = fast: allowed is full or quick"):
        gm.build(gm.load(SAMPLES / "spur.toml")).loaded_contact(20.0, level="fast")
