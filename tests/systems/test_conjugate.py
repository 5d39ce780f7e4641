"""Geometry I and II of [CR3553]: the closed forms against the engine, which knows only cutters, cradles and contact."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import contact_of, pair_of
from oracles.places import SAMPLES

from gearmesh import DesignError, GearPair, Rigid, load
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, cross, dot
from gearmesh.kernel.surface.curvature import principal, relative_curvature, shape_operator
from gearmesh.systems.spiral_bevel.conjugate.build import conjugate_blank, conjugate_geometry
from gearmesh.systems.spiral_bevel.conjugate.geometry import ConjugateGeometry

CASES = [
    (geometry, hand, side)
    for geometry in (1, 2)
    for hand in ("left", "right")
    for side in ("pinion_convex", "pinion_concave")
]
PHI1 = np.radians(np.linspace(-6.0, 6.0, 13))


class Case:
    """A sample solved by the engine, and its closed forms at the same positions, mirrored for a right-hand pinion."""

    def __init__(self, geometry: int, hand: str, side: str) -> None:
        design = load(SAMPLES / f"spiral_bevel_geometry{geometry}.toml", [f"hand={hand}", f"contact.side={side}"])
        self.gears: GearPair = pair_of(design)
        self.path: ContactPath = contact_path(solver_pair(self.gears), PHI1, edges=False)
        assert (self.path.kind == "point").all()
        self.forms: ConjugateGeometry = conjugate_geometry(
            design, conjugate_blank(design), side.removeprefix("pinion_")
        )
        self.mirror = np.array([1.0, -1.0 if hand == "right" else 1.0, 1.0])
        # the source turns a left-hand pinion right-handed; the project in the sense in which the concave side drives
        self.phi_d = -PHI1 * np.sin(self.forms.gamma_1)
        gamma = self.forms.gamma_1
        c, s = np.cos(gamma), np.sin(gamma)
        self.own_from_f = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])

    def fixed(self, in_f: Array) -> Array:
        return (in_f @ self.own_from_f.T) * self.mirror


#: one pair and side for each commit, the others in the sweep
ONE_QUICK = pytest.mark.sweep_cases(
    "1-left-pinion_concave",
    "1-right-pinion_convex",
    "2-left-pinion_convex",
    "2-right-pinion_concave",
    "1-left-pinion_convex",
    "2-left-pinion_concave",
    "2-right-pinion_convex",
)


@pytest.fixture(params=CASES, ids=lambda case: f"{case[0]}-{case[1]}-{case[2]}")
def case(request: pytest.FixtureRequest) -> Case:
    return Case(*request.param)


@ONE_QUICK
def test_line_of_action(case: Case) -> None:
    wanted = case.fixed(case.forms.line_of_action(case.phi_d))
    np.testing.assert_allclose(case.path.point, wanted, rtol=0, atol=1e-9 * case.forms.cone_distance)
    sign = np.sign(dot(case.path.normal, case.fixed(case.forms.normal(case.phi_d))))
    np.testing.assert_allclose(
        case.path.normal, sign[:, None] * case.fixed(case.forms.normal(case.phi_d)), rtol=0, atol=1e-9
    )


@ONE_QUICK
def test_motion_is_conjugate(case: Case) -> None:
    assert np.ptp(case.path.te) < 1e-8 * ARCSEC


@pytest.mark.sweep_cases(
    "1-left-pinion_concave",
    "1-right-pinion_convex",
    "2-left-pinion_convex",
    "2-right-pinion_concave",
    "1-right-pinion_concave",
    "2-left-pinion_concave",
    "2-right-pinion_convex",
)
def test_paths_on_both_members(case: Case) -> None:
    scale = 1e-9 * case.forms.cone_distance
    for mount, found, wanted, half_turn in (
        (case.gears.pinion.mount, case.path.point1, case.forms.pinion_path(case.phi_d), 0.0),
        (case.gears.gear.mount, case.path.point2, case.forms.gear_path(case.phi_d), np.pi),
    ):
        # the project's tooth stands on +x, the source's flank passes the pitch line at phi = 0
        place = Rigid.about_z(mount.sign * mount.zero + half_turn)
        np.testing.assert_allclose(found, place.point(wanted * case.mirror), rtol=0, atol=scale)


@ONE_QUICK
def test_contact_moves_across_or_along_the_tooth(case: Case) -> None:
    sections = case.gears.pinion.tooth.blank.axial.value(case.path.point1)
    height = case.gears.pinion.tooth.blank.root.value(case.path.point1)
    if np.isinf(case.forms.rho):
        assert np.ptp(height) > 1.5 * np.ptp(sections)
    else:
        # on the pitch cone, which is parallel to the root cone
        assert np.ptp(height) < 1e-9
        assert np.ptp(sections) > 5.0


@pytest.mark.sweep_cases(
    "1-left-pinion_concave",
    "1-right-pinion_convex",
    "2-left-pinion_convex",
    "2-right-pinion_concave",
    "2-left-pinion_concave",
    "2-right-pinion_convex",
)
def test_curvatures_at_the_mean_point(case: Case) -> None:
    middle = np.flatnonzero(PHI1 == 0.0)
    spiral, forms = case.forms.spiral_angle, case.forms
    first = case.fixed(np.array([[0.0, np.sin(spiral), -np.cos(spiral)]]))
    normal = case.fixed(forms.normal(np.zeros(1)))
    second = cross(normal, first) * case.mirror.prod()
    operators = []
    for k, (member, flank) in enumerate(zip((case.gears.pinion, case.gears.gear), case.gears.flanks, strict=True)):
        params = (case.path.params1, case.path.params2)[k][middle]
        mount = (case.gears.pinion.mount, case.gears.gear.mount)[k]
        turn = (PHI1[middle], case.path.phi2[middle])[k]
        jet = getattr(member.tooth, flank).flank.jet(params[:, 0], params[:, 1]).move(mount.at(turn))
        sign = np.sign(dot(jet.n, normal))
        found = principal(sign[:, None, None] * shape_operator(jet, first, second))
        k1, k2, sigma = forms.mean_curvatures(k + 1)
        np.testing.assert_allclose([found.k1[0], found.k2[0]], [k1, k2], rtol=1e-9)
        assert abs(np.sin(found.angle[0] - sigma)) < 1e-9
        operators.append(jet)
    relative = relative_curvature(operators[0], operators[1], first, second)[0]
    assert (np.linalg.eigvalsh(relative) < 0.0).all()


@pytest.mark.sweep
def test_sample_runs_without_error_from_tooth_to_tooth() -> None:
    found = contact_of(load(SAMPLES / "spiral_bevel_geometry1.toml"))
    assert set(found.path.kind) == {"point"}
    assert found.summary["contact_ratio"] > 1.0
    assert found.summary["mesh_te_peak_to_peak_arcsec"] < 1e-8


@pytest.mark.quick
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("rho", "words"),
    [
        # upright at the blade's tip: the mean dedendum, 2.8370 mm, over sin(20 deg)
        (8.29, "rho = 8.29 mm: allowed is more than 8.295 mm"),
        (1.0, "rho = 1 mm: allowed is more than 8.295 mm"),
        (5680.0, "up to 5674.01 mm"),
        (1e6, "rho = 1000000.0: must be a length in mm above 0 and up to 50000"),
    ],
)
@pytest.mark.sweep_cases(
    "5680.0-up to 5674.01 mm",
    "1.0-rho = 1 mm: allowed is more than 8.295 mm",
    "8.29-rho = 8.29 mm: allowed is more than 8.295 mm",
)
def test_profile_radius_that_no_tooth_can_have(rho: float, words: str) -> None:
    with pytest.raises(DesignError) as refused:
        pair_of(load(SAMPLES / "spiral_bevel_geometry2.toml", [f"rho={rho}"]))
    assert words in str(refused.value)


@pytest.mark.sweep
@pytest.mark.sweep_cases("8.3")
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rho", [8.3, 5670.0])
def test_profile_radius_near_its_limits(rho: float) -> None:
    found = contact_of(load(SAMPLES / "spiral_bevel_geometry2.toml", [f"rho={rho}"]))
    assert set(found.path.kind) == {"point"}
    assert found.summary["mesh_te_peak_to_peak_arcsec"] < 1e-7
