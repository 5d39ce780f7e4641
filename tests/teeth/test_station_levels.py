"""Teeth whose stations are cylinders and whose lands are planes: a toy face gear with straight flanks, in closed form."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import quad

from gearmesh import Member
from gearmesh.cad.brep import DEFAULT_TOLERANCE_MM, exact_volume, spline_tooth
from gearmesh.cad.solid_part import solid_part
from gearmesh.cad.volume import volume
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.levels import ConeSurface
from gearmesh.kinds import (
    Blank,
    Body,
    BodyFeatures,
    ConeLevel,
    Jet,
    Region,
    Side,
    TipEdge,
    ToolDescription,
    Tooth,
    ToothSide,
)
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian, volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.mesh.tessellate import tessellate
from gearmesh.teeth.blank.features import Boss, Slot

TEETH, INNER, OUTER = 24, 30.0, 38.0
#: z (mm) of the tip plane, the root plane, the web and the back; bore
TIP, ROOT, WEB, BACK, BORE = -2.0, 2.5, 4.0, 9.0, 12.0
#: pressure angles (rad) of right and left side, half the thickness at z = 0, radius of the fillets
ANGLES, HALF, FILLET = {"right": np.radians(20.0), "left": np.radians(31.0)}, 2.2, 0.5


@dataclass(frozen=True)
class Profile:
    """y = sign (HALF + z tan(angle)) along x: a plane, and a round cylinder between it and the root plane.

    The flank's first parameter is the height z, the fillet's the angle (rad) of its normal from the root plane's.
    """

    angle: float
    sign: float

    @property
    def turn(self) -> float:
        return 0.5 * np.pi - self.angle

    @property
    def centre(self) -> tuple[float, float]:
        """(|y|, z) of the fillet's axis."""
        z = ROOT - FILLET
        return HALF + z * np.tan(self.angle) + FILLET / np.cos(self.angle), z

    def at(self, q: Array) -> tuple[Array, Array]:
        """(|y|, z) on the fillet."""
        y, z = self.centre
        return y - FILLET * np.sin(q), z + FILLET * np.cos(q)

    def half_thickness(self, z: Array) -> Array:
        """|y|, over all of the tooth's height."""
        y, z0 = self.centre
        joint = z0 + FILLET * np.cos(self.turn)
        with np.errstate(invalid="ignore"):
            return np.where(z < joint, HALF + z * np.tan(self.angle), y - np.sqrt(FILLET**2 - (z - z0) ** 2))


def prism(
    y: Array, z: Array, y_p: Array, z_p: Array, n: tuple[Array, Array], n_p: tuple[Array, Array], v: Array
) -> Jet:
    """A surface of lines along x, 34 mm from the axis at v = 0."""
    zero = np.zeros_like(v)
    vector = lambda a, b, c: np.stack(np.broadcast_arrays(a, b, c), axis=-1)  # noqa: E731
    return Jet(
        vector(34.0 + v, y, z),
        vector(zero, *n),
        vector(zero, y_p, z_p),
        vector(zero + 1.0, 0.0, 0.0),
        vector(zero, *n_p),
        vector(zero, 0.0, 0.0),
    )


@dataclass(frozen=True)
class Flank:
    profile: Profile

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = np.broadcast_arrays(u, v)
        sign, slope, zero = self.profile.sign, np.tan(self.profile.angle), np.zeros(u.shape)
        normal = sign * np.cos(self.profile.angle) + zero, -np.sin(self.profile.angle) + zero
        return prism(sign * (HALF + u * slope), u, sign * slope + zero, zero + 1.0, normal, (zero, zero), v)


@dataclass(frozen=True)
class Fillet:
    profile: Profile

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = np.broadcast_arrays(u, v)
        sign, (y, z), s, c = self.profile.sign, self.profile.at(u), np.sin(u), np.cos(u)
        return prism(sign * y, z, -sign * FILLET * c, -FILLET * s, (sign * s, -c), (sign * c, s), v)


def side(name: str) -> ToothSide:
    profile = Profile(ANGLES[name], -1.0 if name == "right" else 1.0)
    z = float(profile.at(np.array(profile.turn))[1])
    return ToothSide(
        Flank(profile), Fillet(profile), (z, profile.turn), root=0.0, tip=TIP, tool=ToolDescription("broach")
    )


@pytest.fixture(scope="module")
def gear() -> Member:
    body = Body.disk(BORE, (INNER, WEB), (OUTER, BACK))
    blank = Blank(ConeLevel(0.5 * np.pi), (INNER, OUTER), ConeLevel(np.pi, -TIP), ConeLevel(np.pi, -ROOT), body)
    return Member("face", Tooth(TEETH, side("right"), side("left"), blank), lambda p, v: {"z": p, "x": v})


@pytest.fixture(scope="module")
def closed_form() -> float:
    """All teeth, slice by slice: within |y| < w a ring has the area of its two asin sectors."""

    def sector(rho: float, w: float) -> float:
        return 0.5 * (rho**2 * np.arcsin(w / rho) + w * np.sqrt(rho**2 - w**2))

    def slice_area(z: float) -> float:
        halves = [float(Profile(angle, 1.0).half_thickness(np.array(z))) for angle in ANGLES.values()]
        return sum(sector(OUTER, w) - sector(INNER, w) for w in halves)

    joints = [float(Profile(angle, 1.0).at(np.array(0.5 * np.pi - angle))[1]) for angle in ANGLES.values()]
    teeth = TEETH * quad(slice_area, TIP, ROOT, points=joints, epsabs=1e-10, epsrel=1e-13, limit=200)[0]
    ring = np.pi * (OUTER**2 - INNER**2) * (WEB - ROOT)
    return float(teeth + ring + np.pi * (OUTER**2 - BORE**2) * (BACK - WEB))


@pytest.mark.quick
@pytest.mark.parametrize("angle", [0.0, 0.4, 0.5 * np.pi, 2.2, np.pi])
def test_levels_of_every_angle(angle: float) -> None:
    """Distance along the normal, and the surface of its zeros: planes and cylinders exactly."""
    level = ConeLevel(angle, 3.0)
    rho, z, h = 5.0, 1.7, 1e-6
    r = np.array([rho * np.cos(0.8), rho * np.sin(0.8), z])
    steps = h * np.eye(3)
    numeric = (level.value(r + steps) - level.value(r - steps)) / (2.0 * h)
    np.testing.assert_allclose(level.gradient(r), numeric, atol=1e-9)
    turned = (level.gradient(r + steps) - level.gradient(r - steps)) / (2.0 * h)
    np.testing.assert_allclose([level.hessian(r, e) for e in np.eye(3)], turned, atol=1e-9)
    assert np.linalg.norm(level.gradient(r)) == pytest.approx(1.0, abs=1e-15)
    foot = r - level.value(r) * level.gradient(r)
    assert abs(level.value(foot)) < 1e-14
    at = np.hypot(foot[0], foot[1]) * -np.cos(angle) + foot[2] * np.sin(angle)
    jet = ConeSurface(level).jet(np.array(0.8), np.array(at))
    np.testing.assert_allclose(jet.r, foot, atol=1e-14)
    np.testing.assert_allclose(jet.n, level.gradient(foot), atol=1e-15)
    assert dot(cross(jet.r_u, jet.r_v), jet.n) == pytest.approx(np.hypot(foot[0], foot[1]))
    if angle in (0.0, np.pi):
        assert jet.r[2] == 3.0 * np.sign(np.cos(angle))
    else:
        assert ConeLevel.of(level.radius, level.slope).value(r) == pytest.approx(level.value(r), abs=1e-14)


@pytest.mark.quick
def test_volume_by_sections_is_the_closed_form(gear: Member, closed_form: float) -> None:
    """And does not depend on where the body's profile ends under the teeth."""
    assert gear.tooth.volume() == pytest.approx(closed_form, rel=1e-12)
    bands = gear.tooth.blank.body.bands
    body = Body(((INNER, WEB + 1.0), (BORE + 1.0, WEB), (BORE, BACK), (OUTER, BACK - 2.0)), bands)
    frusta = np.pi / 3.0 * (BACK - WEB) * (3 * BORE**2 + 3 * BORE + 1.0) - np.pi * BORE**2 * (BACK - WEB)
    toe = np.pi * (INNER**2 - (INNER**2 + INNER * (BORE + 1.0) + (BORE + 1.0) ** 2) / 3.0)
    heel = 2.0 * np.pi * (OUTER**2 - (OUTER**2 + OUTER * BORE + BORE**2) / 3.0)
    changed = replace(gear.tooth, blank=replace(gear.tooth.blank, body=body))
    assert changed.volume() == pytest.approx(closed_form - frusta - toe - heel, rel=1e-12)


def test_mesh_is_a_proved_solid_that_converges_to_the_closed_form(gear: Member, closed_form: float) -> None:
    """The error falls with the tolerance, that is with the square of the cells; end faces lie on their cylinders."""
    tolerances = (1e-2, 1e-3, 1e-4)
    errors = []
    for tolerance in tolerances:
        solid = gear_solid(gear, tolerance)
        proof = prove(solid, 1)
        assert proof.ok
        errors.append(abs(proof.volume - closed_form))
        for region, radius, sense in (("inner_cylinder", INNER, -1.0), ("outer_cylinder", OUTER, 1.0)):
            face = solid.only(region)
            corners = face.corners()
            np.testing.assert_allclose(np.hypot(*face.vertices.T[:2]), radius, rtol=0, atol=1e-11)
            middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
            assert np.abs(np.hypot(*np.moveaxis(middles, -1, 0)[:2]) - radius).max() < 1.05 * tolerance
            outwards = sense * corners.mean(axis=1) / radius * [1.0, 1.0, 0.0]
            assert (dot(face.normals, outwards) > 0.95).all()
    assert 0.85 < np.polyfit(np.log(tolerances), np.log(errors), 1)[0] < 1.15
    assert errors[-1] < 1e-5 * closed_form


@pytest.mark.quick
def test_normals_point_to_the_tips_side(gear: Member) -> None:
    """Lands face -z; every patch is counterclockwise seen from outside."""
    mesh = tessellate(gear.tooth, 1e-2)
    for patch in mesh.patches:
        a, b, c = np.moveaxis(patch.points[patch.triangles], 1, 0)
        assert (dot(cross(b - a, c - a), patch.normals) > 0.0).all()
        if patch.region in ("land", "root"):
            np.testing.assert_array_equal(patch.normals, np.broadcast_to([0.0, 0.0, -1.0], patch.normals.shape))


@pytest.mark.quick
def test_bore_hub_and_keyway(gear: Member, closed_form: float) -> None:
    member = replace(gear, features=BodyFeatures(keyway=Slot(5.0, 2.0), hub=Boss(32.0, 6.0)))
    solid = gear_solid(member, 1e-3)
    assert prove(solid, 1).ok
    assert solid.volume() == pytest.approx(exact_volume(member), rel=2e-5)
    assert exact_volume(member) > closed_form


def test_cad_solid_is_valid_and_has_the_volume(gear: Member, closed_form: float) -> None:
    part = solid_part(gear, spline_tooth(gear.tooth))
    assert volume(part) == pytest.approx(closed_form, rel=1e-8)
    names = {face.name for face in part.faces}
    assert {"inner_cylinder", "outer_cylinder", "face_toe", "bore", "face_heel"} <= names
    featured = replace(gear, features=BodyFeatures(keyway=Slot(5.0, 2.0), hub=Boss(32.0, 6.0)))
    assert volume(solid_part(featured, spline_tooth(gear.tooth, DEFAULT_TOLERANCE_MM))) == pytest.approx(
        exact_volume(featured), rel=1e-6
    )


def off_face(gear: Member, mesh: HexMesh, name: str) -> Array:
    """Distance of a named face's nodes from its exact surface, by the closed form of the toy."""
    points = mesh.nodes[mesh.face_nodes(name)]
    levels = {
        "land": gear.tooth.blank.tip,
        "toe": ConeLevel(0.5 * np.pi, INNER),
        "heel": ConeLevel(0.5 * np.pi, OUTER),
    }
    if name in levels:
        return levels[name].value(points)
    _, which, _ = name.split("_")
    back = points[:, 1] * (-1.0 if which == "right" else 1.0)
    return back - Profile(ANGLES[which], 1.0).half_thickness(np.clip(points[:, 2], TIP, ROOT))


@pytest.mark.quick
@pytest.mark.parametrize("order", [1, 2])
def test_hexahedra(gear: Member, order: int) -> None:
    cells = Cells(flank=6, fillet=5, thickness=3, rim=3, face=8)
    mesh = hex_mesh(gear.tooth, np.arange(1), plain_grid(cells), second_order=order == 2)
    assert volumes(mesh.nodes, mesh.elements).min() > 0.0
    assert scaled_jacobian(mesh.nodes, mesh.elements).min() > 0.2
    for name in ("land", "toe", "heel", "flank_right_1", "flank_left_1", "fillet_right_1", "fillet_left_1"):
        assert np.abs(off_face(gear, mesh, name)).max() < 1e-9, name
    # the rim goes from the root plane into the body, along the axis
    rim = mesh.nodes[mesh.face_nodes("rim")][:, 2]
    assert ROOT < rim.min() <= rim.max() <= BACK


@pytest.mark.quick
def test_a_chamfer_on_cylindrical_stations(gear: Member) -> None:
    """Both legs are its size: down the cylinder and along the tip circle of each radius; the solid is closed."""
    broken = replace(gear, tooth=replace(gear.tooth, tip_edge=TipEdge(0.2)))
    t = np.linspace(0.0, 1.0, 5)
    sharp = gear.tooth.flank_grid(Side.LEFT, [1.0], t).points[0]
    last, first = broken.tooth.grid(Region.EDGE_LEFT, [0.0, 1.0], broken.tooth.sections(t)).points
    assert first[:, 2] - TIP == pytest.approx(0.2, abs=1e-12)
    assert last[:, 2] == pytest.approx(TIP, abs=1e-12)
    turn = np.arctan2(*sharp.T[1::-1]) - np.arctan2(*last.T[1::-1])
    assert turn * np.hypot(*sharp.T[:2]) == pytest.approx(0.2, abs=1e-12)
    solid = gear_solid(broken, 0.02)
    assert prove(solid, 1).ok
    assert solid.volume() == pytest.approx(broken.plain_volume(), rel=2e-4)


@pytest.mark.quick
def test_a_body_without_a_bore_of_its_own(gear: Member) -> None:
    """The teeth's inner cylinder goes on to the back: the body has two bands, and the mesh is closed."""
    body = Body(((INNER, WEB), (INNER, BACK), (OUTER, BACK)), (Region.BORE, Region.FACE_HEEL))
    assert (body.bore_radius, body.genus, body.ends) == (INNER, 1, (WEB, BACK))
    solid = gear_solid(replace(gear, tooth=replace(gear.tooth, blank=replace(gear.tooth.blank, body=body))), 1e-3)
    assert prove(solid, 1).ok
    present = {solid.region_names[k] for k in set(solid.regions)}
    assert {"inner_cylinder", "outer_cylinder", "bore", "face_heel"} <= present
    assert "face_toe" not in present
