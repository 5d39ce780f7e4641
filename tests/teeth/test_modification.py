"""Fields of micro-geometry: their partials by differences, and the amounts that designs name, where they name them."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.micro_geometry import modification as m
from gearmesh.teeth.micro_geometry.screw_involute import AmountJet

E = m.Extent(root=4.0, tip=12.0, toe=-10.0, heel=10.0)
#: of an internal gear, whose tip is nearer to the base circle
RING = m.Extent(root=22.0, tip=12.0, toe=10.0, heel=-10.0)
GRID = tuple(tuple(0.01 * np.sin(i + 0.7 * j) for j in range(5)) for i in range(6))
FIELDS: dict[str, m.FlankField] = {
    **{f"tip_{shape}": m.tip_relief(0.1, 9.0, E, shape) for shape in m.RELIEF_SHAPES},
    **{f"root_{shape}": m.root_relief(0.1, 6.0, E, shape) for shape in m.RELIEF_SHAPES},
    **{f"end_{shape}": m.end_relief(0.1, 3.0, E, "toe", shape) for shape in m.RELIEF_SHAPES},
    "crowning": m.profile_crowning(0.4, E),
    "slope": m.profile_slope(-0.4, E),
    "twist": m.profile_twist(0.4, E),
    "helix_crowning": m.helix_crowning(0.4, E),
    "helix_slope": m.helix_slope(0.4, E),
    "triangular": m.triangular_end_relief(0.4, 9.0, E, -0.3, "tip"),
    "topography": m.Topography(tuple(np.linspace(4.5, 11.0, 6)), (-9.0, -4.0, 0.0, 4.0, 9.0), GRID),
}


def value(field: m.FlankField | m.Modification, length: float, z: float) -> float:
    return float(field.jet(np.array([length]), np.array([z])).a[0])


def differences(field: m.FlankField | m.Modification, length: Array, z: Array, h: float = 1e-3) -> AmountJet:
    """First partials of amounts, and second ones of first partials, by central differences: good to 1e-7."""

    def partial(name: str, dl: float, dz: float) -> Array:
        ahead, behind = (getattr(field.jet(length + k * dl, z + k * dz), name) for k in (h, -h))
        return np.asarray((ahead - behind) / (2.0 * h))

    a_l, a_z = partial("a", 1, 0), partial("a", 0, 1)
    return AmountJet(field.jet(length, z).a, a_l, a_z, partial("a_l", 1, 0), partial("a_l", 0, 1), partial("a_z", 0, 1))


@pytest.mark.parametrize("name", [*FIELDS, "sum"])
def test_partials(name: str) -> None:
    field = FIELDS.get(name) or m.Modification(tuple(FIELDS.values()), E)
    length, z = (each.ravel() for each in np.meshgrid([1.0, 2.2, 3.1, 5.0, 8.3, 10.9, 12.4], [-10.6, -8.1, 0.3, 9.7]))
    exact, other = field.jet(length, z), differences(field, length, z)
    for each in fields(AmountJet):
        found = np.broadcast_to(getattr(exact, each.name), length.shape)
        np.testing.assert_allclose(found, getattr(other, each.name), atol=2e-6, err_msg=each.name)
    if name == "topography":
        at = np.meshgrid(field.lengths, field.positions, indexing="ij")
        np.testing.assert_allclose(field.jet(*at).a, GRID, atol=1e-15)


@pytest.mark.parametrize("e", [E, RING])
@pytest.mark.parametrize("shape", m.RELIEF_SHAPES)
def test_amounts_are_where_the_names_say(e: m.Extent, shape: m.Shape) -> None:
    start = e.tip + 0.4 * (e.root - e.tip)
    tip, root = m.tip_relief(0.02, start, e, shape), m.root_relief(0.03, start, e, shape)
    middle = 0.5 * (e.toe + e.heel)
    assert value(tip, e.tip, 0.0) == pytest.approx(0.02, abs=1e-15)
    assert (
        value(tip, start, 0.0) == value(tip, e.root, 0.0) == value(root, start, 0.0) == value(root, e.tip, 0.0) == 0.0
    )
    assert value(root, e.root, 0.0) == pytest.approx(0.03, abs=1e-15)
    half = {"linear": 0.5, "parabolic": 0.25, "circular": 0.25}[shape]
    assert value(tip, 0.5 * (start + e.tip), 0.0) == pytest.approx(0.02 * half, rel=1e-4)
    toe = m.end_relief(0.01, 4.0, e, "toe", shape)
    assert value(toe, 5.0, e.toe) == pytest.approx(0.01, abs=1e-15)
    assert value(toe, 5.0, e.toe + np.copysign(4.0, e.heel - e.toe)) == value(toe, 5.0, e.heel) == 0.0
    assert toe.kinks.positions == (e.toe + np.copysign(4.0, e.heel - e.toe),)
    assert (toe.kinks.ridges, tip.kinks.creases) == ((toe.kinks.positions, (start,)) if shape == "linear" else ((), ()))
    for bow, ends in ((m.profile_crowning(0.01, e), (e.root, e.tip)), (m.helix_crowning(0.01, e), (e.toe, e.heel))):
        profile = ends == (e.root, e.tip)
        for end in ends:
            assert value(bow, *((end, 0.0) if profile else (5.0, end))) == pytest.approx(0.01, abs=1e-16)
        assert value(bow, *((0.5 * sum(ends), 0.0) if profile else (5.0, middle))) == 0.0
    for amount in (0.01, -0.01):
        slope, lead = m.profile_slope(amount, e), m.helix_slope(amount, e)
        assert value(slope, e.tip, 0.0) - value(slope, e.root, 0.0) == pytest.approx(amount, abs=1e-16)
        assert value(lead, 5.0, e.heel) - value(lead, 5.0, e.toe) == pytest.approx(amount, abs=1e-16)
        assert min(value(slope, e.tip, 0.0), value(slope, e.root, 0.0), value(lead, 5.0, e.toe)) >= 0.0
    twist = m.profile_twist(0.01, e)
    slopes = [value(twist, e.tip, z) - value(twist, e.root, z) for z in (e.toe, e.heel)]
    assert slopes[1] - slopes[0] == pytest.approx(0.01, abs=1e-16)


@pytest.mark.parametrize("e", [E, RING])
@pytest.mark.parametrize("lean", [0.3, -0.3])
@pytest.mark.parametrize("end", ["tip", "root"])
def test_triangular_relief_is_in_one_corner_and_along_the_contact_lines(e: m.Extent, lean: float, end: str) -> None:
    field = m.triangular_end_relief(0.02, 5.0, e, lean, end)
    corners = {(profile, z): value(field, profile, z) for profile in (e.root, e.tip) for z in (e.toe, e.heel)}
    (profile, z), top = max(corners.items(), key=lambda item: item[1])
    assert profile == getattr(e, end)
    assert top == pytest.approx(0.02, abs=1e-15)
    assert sum(amount != 0.0 for amount in corners.values()) == 1
    inwards = -np.sign(z)
    assert value(field, profile, z + 4.9 * inwards) > 0.0
    assert value(field, profile, z + 5.0 * inwards) == pytest.approx(0.0, abs=1e-15)
    here = value(field, profile, z + 2.0 * inwards)
    assert value(field, profile + 0.2 * lean, z + 2.0 * inwards - 0.2) == pytest.approx(here, abs=1e-15)


def test_amounts_level_off_below_the_evaluated_profile() -> None:
    """From half the least roll length down nothing changes, so that the base circle stays the only singular place."""
    whole = m.Modification((FIELDS["slope"], FIELDS["twist"]), E)
    jet = whole.jet(np.array([-3.0, 0.0, 2.0]), np.full(3, 8.0))
    assert (jet.a_l == 0.0).all()
    assert (jet.a_lz == 0.0).all()
    assert np.ptp(jet.a) == 0.0
    assert whole.jet(np.array([4.0]), np.zeros(1)).a == pytest.approx(0.4)
    assert m.Modification((FIELDS["tip_linear"], FIELDS["end_circular"]), E).kinks == m.Kinks(
        (9.0,), (-7.0,), (9.0,), ()
    )
