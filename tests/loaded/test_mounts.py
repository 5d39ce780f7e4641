"""Shafts and bearings that give way under load: closed forms of a spur pair, and the rigid limit."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
from oracles.loaded import SMALL, few_elements, geared
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, FlexibleMount, Rigid
from gearmesh.answers.load.members import held_by_rim, mounts_around, mounts_of
from gearmesh.contact.hertz import STEEL, Material
from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region, Side, Tooth
from gearmesh.loaded.compliance.compliance import FlankCompliance, flank_compliance
from gearmesh.loaded.sharing import LoadedMesh, SecondMesh, loaded_mesh
from gearmesh.mesh.hexahedra.hexahedra import Cells

INF = np.inf
BASE = 30.0 * np.cos(np.radians(20.0))
#: of 100 Nm, N
FORCE = 1e5 / BASE


@cache
def rigid() -> LoadedMesh:
    """Without mounts."""
    return under(None)


@pytest.fixture(scope="module")
def spur_bodies() -> Callable[..., FlankCompliance]:
    """Stands in for `flank_compliance` of the spur sample's members, whose teeth are the same however they are held: few elements,
    made once."""
    made: dict[tuple[int, Side], FlankCompliance] = {}

    def of(tooth: Tooth, side: Side, *asked: Any, **named: Any) -> FlankCompliance:
        if (tooth.teeth, side) not in made:
            made[tooth.teeth, side] = few_elements(tooth, side, *asked, **named)
        return made[tooth.teeth, side]

    return of


def under(pinion: FlexibleMount | None, gear: FlexibleMount | None = None) -> LoadedMesh:
    pair, bodies = geared("spur")
    return loaded_mesh(pair, pair.pitch * np.array([0.0, 0.4]), np.array([1e5]), bodies, flexible=(pinion, gear))


def mean_station(found: LoadedMesh) -> float:
    """z of the middle of the load, mm."""
    (load,) = found.loads
    line = load.pressure.sum(axis=2) * (load.separation.dx * load.separation.dy)[:, None]
    return float((line * load.separation.middle[..., 2]).sum() / line.sum())


@pytest.mark.sweep
def test_what_hardly_gives_way_is_rigid() -> None:
    """Against no mounts at all: 1e-8 of the rotation, stresses as far as pressures settle."""
    stiff = under(FlexibleMount.of([1e16] * 3 + [1e20] * 3), FlexibleMount.of([INF] * 6))
    np.testing.assert_allclose(stiff.rotation, rigid().rotation, rtol=1e-8)
    np.testing.assert_allclose(stiff.root_stress, rigid().root_stress, rtol=1e-6)


@pytest.mark.sweep
def test_soft_bearings_shift_along_the_line_of_action() -> None:
    """Either member shifts by F / k along the line of action, and the pinion turns by that over its base radius. The
    transmission error falls behind by that angle times the ratio. 0.1 %: the centre distance grows, and the angle of the force
    with it."""
    pair, _ = geared("spur")
    for k, flexible in enumerate(
        ((FlexibleMount.of([2e4, 2e4, *[INF] * 4]), None), (None, FlexibleMount.of([2e4, 2e4, *[INF] * 4])))
    ):
        found = under(*flexible)
        assert (found.status == Status.CONVERGED).all()
        np.testing.assert_allclose(np.linalg.norm(found.displacement[..., k, :3], axis=-1), FORCE / 2e4, rtol=1e-3)
        np.testing.assert_array_equal(found.displacement[..., 1 - k, :], 0.0)
        behind = found.rotation - rigid().rotation
        np.testing.assert_allclose(behind * BASE, FORCE / 2e4, rtol=1e-3)
        np.testing.assert_allclose(found.te - rigid().te, -pair.drive * 0.5 * behind, rtol=1e-9)
    # the shaft's torsion: T / k
    twisted = under(FlexibleMount.of([*[INF] * 5, 1e8]))
    np.testing.assert_allclose(twisted.rotation - rigid().rotation, 1e5 / 1e8, rtol=1e-3)


def shift_and_turn(name: str, *keys: str) -> tuple[Array, Array]:
    """Return the shift of a pinion in a soft bearing, and the turn at its base circle, over F / k at one position."""
    pair, bodies = geared(name, *keys)
    own = pair.pinion.tooth.flank_grid(pair.flanks[0], [0.5], [0.5])
    (point,), (normal,) = own.points[0], own.normals[0]
    base = abs(np.cross(point, normal)[2]) / np.hypot(*normal[:2])
    soft = (FlexibleMount.of([2e4, 2e4, *[INF] * 4]), None)
    torque, phi1 = np.array([1e5]), np.array([0.4 * pair.pitch])
    stiff, held = (loaded_mesh(pair, phi1, torque, bodies, flexible=own) for own in ((None, None), soft))
    assert (held.status == Status.CONVERGED).all()
    by = torque / base / 2e4
    return np.linalg.norm(held.displacement[0, :, 0, :3], axis=-1) / by, (held.rotation - stiff.rotation)[0] * base / by


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "keys"), [("double_helical", ()), ("rack", ("pinion.modifications={}",))])
def test_pinions_of_racks_and_of_two_halves_have_bearings(name: str, keys: tuple[str, ...]) -> None:
    """Shift is F / k, as for a spur pair, F being the transverse force, to which both halves add; the turn is the shift over
    the base radius. 0.1 %, and another 0.1 % for the turn: the teeth touch farther along and deflect differently there."""
    shift, turn = shift_and_turn(name, *keys)
    np.testing.assert_allclose(shift, 1.0, rtol=1e-3)
    np.testing.assert_allclose(turn, 1.0, rtol=2e-3)


@pytest.mark.sweep
def test_racks_have_guides() -> None:
    """A rack gives way by force over stiffness along its travel and away from the pinion, and the pinion turns on by as much."""
    pair, bodies = geared("rack", "pinion.modifications={}")
    guide = mounts_of(gm.load(SAMPLES / "rack.toml", [f"rack.mount.stiffness={[2e4, 1e4, *['rigid'] * 4]}"]), pair)
    torque, phi1 = np.array([5e4]), np.array([0.4 * pair.pitch])
    stiff, found = (loaded_mesh(pair, phi1, torque, bodies, flexible=(None, own)) for own in (None, guide["rack"]))
    assert (found.status == Status.CONVERGED).all()
    # 20 teeth of module 2, 20 and 19.5283 deg
    radius = 20.0 / np.cos(np.radians(19.5283))
    slope = np.tan(np.radians(20.0)) / np.cos(np.radians(19.5283))
    force = torque[0] / radius
    along, away = force / 1e4, force * slope / 2e4
    np.testing.assert_allclose(found.displacement[0, 0, 1, :2], [-away, along], rtol=1e-3)
    turned = (along + away * slope) / radius
    assert (found.rotation - stiff.rotation)[0, 0] == pytest.approx(turned, rel=2e-3)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("axial", "aside"), [(1e5, 0.01), (1e3, 0.0), pytest.param(1e3, 0.01, marks=pytest.mark.sweep)]
)
def test_a_pinion_of_two_halves_goes_where_both_carry(axial: float, aside: float) -> None:
    """A gear that is 10 um off along its axis would load one half alone. A pinion in an axial spring follows the gear until the
    spring holds the difference of the halves' axial forces. With a soft spring it goes nearly all the way."""
    pair, bodies = geared("double_helical")
    base = pair.gear.mount.base
    moved_base = Rigid(base.rotation, base.translation + np.array([0.0, 0.0, aside]))
    pair = replace(pair, gear=replace(pair.gear, mount=replace(pair.gear.mount, base=moved_base)))
    held = FlexibleMount.of([INF, INF, axial, INF, INF, INF])
    found = loaded_mesh(pair, np.array([0.4 * pair.pitch]), np.array([1e5]), bodies, flexible=(held, None))
    assert (found.status == Status.CONVERGED).all()
    (load,) = found.loads
    first, second = (load.force[load.half == half].sum() for half in (0, 1))
    normal = pair.pinion.tooth.flank_grid(pair.flanks[0], [0.5], [0.5]).normals[0, 0]
    moved = found.displacement[0, 0, 0, 2]
    # the spring's force against the difference of the halves', of which a tenth of a newton is left to the iteration
    assert moved * axial == pytest.approx((second - first) * abs(normal[2]), rel=1e-3, abs=0.1)
    if axial == 1e5:
        assert 0.2 * second < first < 0.5 * second
    else:
        assert moved == pytest.approx(aside, rel=0.02, abs=1e-6)
        assert first == pytest.approx(second, rel=0.03)


@cache
def few_planets(*keys: str) -> tuple[list[gm.GearPair], list[Any]]:
    """Both meshes of the planetary sample, and their bodies of few elements."""
    gears = gm.build(gm.load(SAMPLES / "planetary.toml", list(keys)))
    meshes = [gears.train.sharing(name) for name in ("sun-planet_1", "planet_1-ring")]
    bodies = [
        tuple(
            flank_compliance(member.tooth, side, STEEL, SMALL, idler=member.idler)
            for member, side in zip(mesh.both, mesh.flanks, strict=True)
        )
        for mesh in meshes
    ]
    return meshes, bodies


def planet_under(which: int, pin: FlexibleMount | None, *keys: str) -> LoadedMesh:
    """One mesh of the planet, 0 with the sun or 1 with the ring, with the planet on a pin, at one position."""
    meshes, bodies = few_planets(*keys)
    flexible = [(None, pin), (pin, None)]
    ratio = abs(meshes[0].ratio)
    torque = np.array([3e4, 3e4 / ratio])[[which]]
    phi1 = np.array([0.4 * meshes[which].pitch])
    second = None
    if pin is not None:
        other = 1 - which
        second = SecondMesh(meshes[other], other, bodies[other], (STEEL, STEEL), flexible[other])
    return loaded_mesh(
        meshes[which], phi1, torque, bodies[which], cells=(24, 14), flexible=flexible[which], second=second
    )


@pytest.mark.sweep
def test_both_meshes_of_a_planet_load_its_pin() -> None:
    """Twice the tangential force over the stiffness, and nothing towards the sun; the sun turns on by what the planet goes along
    the line of action, over its base radius. Seen from the ring's mesh, too."""
    pin = FlexibleMount.of([2e5, 1e5, *[INF] * 4])
    force, cosine = 3e4 / 18.0, np.cos(np.radians(20.0))
    back = 2.0 * force / 1e5
    for which, (shared, base) in enumerate(((1, 18.0 * cosine), (0, 27.0 * cosine))):
        found, stiff = planet_under(which, pin), planet_under(which, None)
        assert (found.status == Status.CONVERGED).all()
        np.testing.assert_allclose(found.displacement[0, 0, shared, :2], [0.0, -back], atol=2e-3 * back)
        np.testing.assert_allclose(found.rotation - stiff.rotation, back * cosine / base, rtol=2e-3)


@pytest.mark.sweep
def test_planets_tilt_on_pins_held_at_one_end() -> None:
    """Second route: both meshes on rigid mounts with the planet tilted by as much have the moments that tilt the pin so."""
    stiffness = 1e8
    pin = FlexibleMount.of([INF, INF, INF, stiffness, INF, INF], -10.0)
    found = planet_under(0, pin)
    assert (found.status == Status.CONVERGED).all()
    moved = found.displacement[0, 0, 1]
    meshes, bodies = few_planets()
    moment = 0.0
    phi1 = np.array([0.4 * meshes[0].pitch])
    for which, (mesh, own) in enumerate(zip(meshes, bodies, strict=True)):
        planet = mesh.both[1 - which]
        tilted = replace(planet, mount=pin.displace(planet.mount, moved))
        placed = replace(mesh, gear=tilted) if which == 0 else replace(mesh, pinion=tilted)
        torque = 3e4 / (1.0, abs(meshes[0].ratio))[which]
        rotation = phi1 if which == 0 else phi1 * meshes[0].ratio
        (load,) = loaded_mesh(placed, rotation, np.array([torque]), own, cells=(24, 14)).loads
        grid = load.separation
        line = load.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None]
        sense = (1.0, -1.0)[which]
        wrench = pin.wrenches(planet.mount, grid.middle, sense * grid.normal)
        moment += float((wrench[..., 3] * line).sum())
    # a rigid pin has 33 Nm there: teeth take a quarter of it
    assert stiffness * moved[3] == pytest.approx(moment, rel=5e-3)
    assert abs(moment) < 0.8 * 2.0 * 10.0 * 3e4 / 18.0


def test_equal_planets_move_a_floating_sun_along_its_axis_alone() -> None:
    """Three helical planets: three times the axial force of a mesh over the stiffness, and nothing across the axis, however soft
    the sun is there."""
    keys = ("helix_angle=15",)
    meshes, bodies = few_planets(*keys)
    keyed = gm.load(SAMPLES / "planetary.toml", [*keys, f"sun.mount.stiffness={[1.0, 1.0, 1e5, 1e3, 1e3, 'rigid']}"])
    flexible = mounts_around(meshes[0], mounts_of(keyed, meshes[0]))
    found = loaded_mesh(meshes[0], np.array([0.0]), np.array([3e4]), bodies[0], cells=(24, 14), flexible=flexible)
    radius = 18.0 / np.cos(np.radians(15.0))
    axial = 3e4 / radius * np.tan(np.radians(15.0))
    np.testing.assert_allclose(np.abs(found.displacement[0, 0, 0]), [0, 0, 3.0 * axial / 1e5, 0, 0, 0], rtol=3e-3)


@pytest.mark.sweep
def test_load_goes_to_the_bearing_of_an_overhung_pinion() -> None:
    """The tooth at the far end gives way, on whichever side the bearing is; moments are those of the force about it."""
    for z in (40.0, -40.0):
        found = under(FlexibleMount.of([INF, INF, INF, 1e7, 1e7, INF], z))
        assert (found.status == Status.CONVERGED).all()
        assert np.sign(z) * mean_station(found) > 5.0
        moment = 1e7 * np.linalg.norm(found.displacement[0, :, 0, 3:5], axis=-1)
        np.testing.assert_allclose(moment.mean(), FORCE * abs(z - mean_station(found)), rtol=5e-3)


@pytest.mark.sweep
def test_the_answer_tells_displacements_and_refuses_what_is_no_mount(
    monkeypatch: pytest.MonkeyPatch, spur_bodies: Callable[..., FlankCompliance]
) -> None:
    monkeypatch.setattr("gearmesh.loaded.sharing.flank_compliance", spur_bodies)
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    mount = FlexibleMount.of(np.diag([2e4, 2e4, 1e9, 1e12, 1e12, 1e12]))
    (row,) = gears.loaded_contact(100, [0.0], mounts={"gear": mount}).rows
    assert np.linalg.norm(row.displacements["gear"].displacement) == pytest.approx(1e3 * FORCE / 2e4, rel=1e-3)
    assert "pinion" not in row.displacements
    # vectors have their axis before the unit
    assert "gear_displacement_x_um" in row.flat
    assert "pinion_displacement_x_um" not in row.flat
    with pytest.raises(DesignError, match="mounts = sun: must be pinion or gear"):
        gears.loaded_contact(100, [0.0], mounts={"sun": FlexibleMount.of([INF] * 6)})
    with pytest.raises(DesignError, match=r"stiffness = -1: entry 2 of 6; must be above 0, or inf for rigid"):
        FlexibleMount.of([1, -1, 1, 1, 1, 1])
    with pytest.raises(DesignError, match="stiffness: must be symmetric and positive definite"):
        FlexibleMount.of(np.diag([1.0, 1.0, 1.0, 1.0, 1.0, -1.0]))
    with pytest.raises(DesignError, match=r"stiffness: has shape \(3,\); must be 6"):
        FlexibleMount.of([1, 1, 1])


@pytest.mark.sweep
def test_a_design_says_how_its_members_are_held(
    monkeypatch: pytest.MonkeyPatch, spur_bodies: Callable[..., FlankCompliance]
) -> None:
    """Mounts in the design act like the argument `mounts`, which goes first, member by member. Without z the mount is in the
    middle of the face, where an even load tilts nothing."""
    monkeypatch.setattr("gearmesh.loaded.sharing.flank_compliance", spur_bodies)
    monkeypatch.setattr("gearmesh.answers.load.loaded.loaded_mesh", partial(loaded_mesh, cells=(24, 14)))
    keys = [
        "pinion.mount.stiffness=[inf, 'rigid', inf, 1e7, 1e7, inf]",
        "gear.mount.stiffness=[2e4, 3e4, 1e9, inf, inf, inf]",
    ]
    plain, held = (gm.build(gm.load(SAMPLES / "spur.toml", own)) for own in ([], [*keys, "pinion.mount.z=40mm"]))
    mounts = {
        "pinion": FlexibleMount.of([INF, INF, INF, 1e7, 1e7, INF], 40.0),
        "gear": FlexibleMount.of([2e4, 3e4, 1e9, INF, INF, INF]),
    }
    found = held.loaded_contact(100, [0.0])
    np.testing.assert_equal(found.figures.row, plain.loaded_contact(100, [0.0], mounts=mounts).figures.row)
    stiff = {"gear": FlexibleMount.of([INF] * 6)}
    (row,) = held.loaded_contact(100, [0.0], mounts=stiff).rows
    (same,) = plain.loaded_contact(100, [0.0], mounts={**mounts, **stiff}).rows
    assert row.displacements == same.displacements
    assert "gear" not in row.displacements
    middle = gm.build(gm.load(SAMPLES / "spur.toml", keys[:1])).loaded_contact(100, [0.0])
    assert abs(mean_station(middle.mesh)) < 1e-3 < 5.0 < mean_station(found.mesh)
    bevel = gm.build(
        gm.load(SAMPLES / "spiral_bevel_basic.toml", ["gear.mount.stiffness=[1e5, 1e5, 1e5, inf, inf, inf]"])
    )
    flank = (
        bevel.pairs[0]
        .gear.tooth.flank_grid(bevel.pairs[0].flanks[1], np.linspace(0, 1, 9), np.linspace(0, 1, 33))
        .points
    )
    # its face is some 20 mm wide, and stands beyond the apex
    assert mounts_of(bevel.design, bevel.pairs[0])["gear"].z == pytest.approx(flank[..., 2].mean(), abs=0.3)
    assert abs(flank[..., 2]).min() > 3.0
    # lengths are in the file's units, stiffness is not, and what is rigid comes back from a document
    design = held.design.scale(25.4)
    assert design.mount("pinion").z == pytest.approx(40.0 * 25.4)
    assert design.mount("gear").stiffness == (2e4, 3e4, 1e9, "rigid", "rigid", "rigid")
    assert type(held.design)(**json.loads(json.dumps(held.design.resolve(), allow_nan=False))) == held.design


@pytest.mark.sweep
def test_bodies_are_held_by_the_rim_where_the_design_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """1.2 whole depths, of 2.25 modules, under the root; teeth then give way less than with a body down to the bore."""
    asked: dict[int, float | None] = {}

    def few(
        tooth: Tooth,
        side: Side,
        material: Material,
        *,
        cells: Cells,
        rim: float | None,
        reach: int,
        coarser: Cells,
        idler: bool,
    ) -> FlankCompliance:
        asked[tooth.teeth] = rim
        return flank_compliance(tooth, side, material, SMALL, rim, reach=reach, idler=idler)

    monkeypatch.setattr("gearmesh.loaded.sharing.flank_compliance", few)
    design = gm.load(SAMPLES / "spur.toml", ["gear.mount.held=rim"])
    found = gm.build(design).loaded_contact(100, [0.0])
    pinion, gear = found.pair.both
    assert asked[pinion.tooth.teeth] is None
    body = gear.tooth.sections(np.array([0.5]))
    depth = float(
        np.ptp(
            [np.hypot(*gear.tooth.grid(r, np.array([0.5]), body).points[0, 0, :2]) for r in (Region.LAND, Region.ROOT)]
        )
    )
    assert asked[gear.tooth.teeth] == pytest.approx(1.2 * depth, rel=1e-9)
    whole = gm.build(gm.load(SAMPLES / "spur.toml")).loaded_contact(100, [0.0])
    assert 0.75 * whole.mesh.rotation[0, 0] < found.mesh.rotation[0, 0] < 0.97 * whole.mesh.rotation[0, 0]
    planets = gm.build(gm.load(SAMPLES / "planetary.toml", ["planet.mount.held=rim"]))
    assert [held_by_rim(planets.design, pair) for pair in planets.pairs[::3]] == [(False, True), (True, False)]
    assert mounts_of(planets.design, planets.pairs[0]) == {}


NUMBERS = r"must be 6 numbers above 0 or \"rigid\", in N/mm, N, N mm/rad, or 6 rows of 6 finite numbers"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("sample", "keys", "message"),
    [
        ("spur", "gear.mount.stiffness=[1, 2, 3]", rf"gear\.mount\.stiffness = \[1, 2, 3\]: {NUMBERS}"),
        ("spur", "gear.mount.stiffness=[1, 2, 3, 4, 5, 0]", rf"gear\.mount\.stiffness = .*: {NUMBERS}"),
        (
            "spur",
            f"gear.mount.stiffness={np.ones((6, 6)).tolist()}",
            r"stiffness: its rows must be symmetric and positive",
        ),
        ("spur", "gear.mount.z=3", r"gear\.mount\.z = 3 mm: needs stiffness"),
        (
            "planetary",
            "planets=4; assembly.planet_angles='0, 88, 180, 268'; sun.mount.stiffness=[1, 1, 1, 1, 1, 1]",
            r"sun\.mount\.stiffness: must be left out for planets at uneven angles",
        ),
        ("spur", "gear.mount.held=hub", r'gear\.mount\.held = "hub": must be one of "bore", "rim"'),
    ],
)
def test_mounts_that_a_design_cannot_have(sample: str, keys: str, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        gm.load(SAMPLES / f"{sample}.toml", keys.split("; "))
