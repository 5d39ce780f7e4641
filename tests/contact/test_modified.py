"""Transmission error and contact of modified involute gears against rigid closed forms, to 1e-6 um."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.modified_involute import SpurPair, pair_curve, peak_to_peak

from gearmesh import GearPair, parse
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.flanks import separation_curvatures, solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute

#: largest error of a transmission error, mm: rounding of what is solved to 1e-11 mm
ROUNDING = 1e-9
TEETH, MODULE, WIDTH = (20, 40), 3.0, 20.0


def built(
    pinion: dict[str, Any], gear: dict[str, Any] | None = None, helix: float = 0.0, flank: str = "right"
) -> GearPair:
    members = [
        {
            "teeth": teeth,
            "face_width": WIDTH,
            "helix_angle": sense * helix,
            **({"modifications": table} if table else {}),
        }
        for teeth, sense, table in zip(TEETH, (1, -1), (pinion, gear), strict=True)
    ]
    return pair_of(
        parse(
            {
                "kind": "beveloid",
                "module": MODULE,
                "pinion": members[0],
                "gear": members[1],
                "contact": {"flank": flank},
            }
        )
    )


def involute(pair: GearPair) -> ScrewInvolute:
    found = pair.pinion.tooth.side(pair.flanks[0]).flank
    assert isinstance(found, ScrewInvolute)
    return found


def spur() -> tuple[SpurPair, tuple[float, float], float]:
    """The pair, the roll lengths of the pinion between which it is in contact, and the pinion's pitch."""
    base = [0.5 * MODULE * teeth * np.cos(np.radians(20.0)) for teeth in TEETH]
    pair = SpurPair(*base, 0.5 * MODULE * sum(TEETH))
    tips = [np.sqrt((0.5 * MODULE * teeth + MODULE) ** 2 - r_b**2) for teeth, r_b in zip(TEETH, base, strict=True)]
    return pair, (pair.line_of_action - tips[1], tips[0]), 2.0 * np.pi / TEETH[0]


def solved_advance(pair: GearPair, angle: Array) -> Array:
    """Advances of one pair of teeth where the pinion's involutes begin at an angle, over those of the unmodified gears."""
    own = involute(pair)
    plain = built({}, flank=str(pair.flanks[0]))
    phi1 = own.start - own.side * angle if own.side > 0 else own.start + angle
    contacts = first_touch(solver_pair(pair), np.asarray(phi1))
    assert contacts.touching.all()
    found: Array = contacts.advance - first_touch(solver_pair(plain), np.zeros(1)).advance
    return found


def mesh_peak_to_peak(pair: GearPair) -> float:
    flanks = solver_pair(pair)
    cycle = mesh_cycle(flanks, pair.pitch, whole_engagement(flanks, pair.pitch))
    assert cycle is not None
    return cycle.peak_to_peak


@pytest.mark.quick
@pytest.mark.parametrize(
    ("table", "unbroken"),
    [
        ({"profile_crowning": "2um", "helix_crowning": "5um"}, True),
        ({"tip_relief": {"amount": "4um", "start_roll_length": 14.0, "shape": "linear"}}, False),
        ({"tip_relief": {"amount": "4um", "start_roll_length": 14.0, "shape": "parabolic"}}, False),
        ({"end_relief_toe": {"amount": "20um", "length": "2mm", "shape": "parabolic"}}, False),
    ],
    ids=["crowned", "linear", "parabolic", "ends"],
)
@pytest.mark.sweep_cases("crowned", "ends", "linear")
def test_breaks_of_slope_and_curvature_are_known(table: dict[str, Any], unbroken: bool) -> None:
    """Polynomials through samples bound no advance across such a break: at the start of a linear relief 1e-8 rad were lost."""
    for pair in (built(table), built({}, table)):
        assert solver_pair(pair).unbroken is unbroken


@pytest.mark.sweep
@pytest.mark.sweep_cases("right")
@pytest.mark.parametrize("flank", ["right", "left"])
def test_profile_crowning(flank: str) -> None:
    """Every contact in closed form; of the mesh, parabolas a pitch apart meet C (p_b / evaluated length)^2 below their vertices."""
    amount, (spurs, path, pitch) = 0.002, spur()
    pair = built({"profile_crowning": f"{1e3 * amount:g}um"}, flank=flank)
    field = involute(pair).amount
    assert field is not None
    e = field.extent
    length = np.linspace(path[0] + 1.0, path[1] - 0.01, 41)
    jet = field.jet(length, 0.0 * length)
    standing = spurs.standing(length, jet.a, jet.a_l)
    error = solved_advance(pair, standing[0]) - spurs.advance(*standing)
    assert np.abs(error).max() * spurs.gear < ROUNDING
    length = np.linspace(path[0] + 1.0, path[1], 60_001)
    jet = field.jet(length, 0.0 * length)
    angle, gear = spurs.standing(length, jet.a, jet.a_l)
    order = np.argsort(angle)
    exact = peak_to_peak(angle[order], spurs.advance(angle, gear)[order], pitch)
    assert mesh_peak_to_peak(pair) * spurs.gear == pytest.approx(exact * spurs.gear, abs=ROUNDING)
    assert exact * spurs.gear == pytest.approx(amount * (pitch * spurs.pinion / (e.tip - e.root)) ** 2, rel=0.02)


@pytest.mark.sweep_cases("short", "long")
@pytest.mark.parametrize("share", [0.45, 0.75, 1.0], ids=["short", "intermediate", "long"])
def test_linear_tip_relief(share: float) -> None:
    """Both tips relieved over a share of where two pairs of teeth carry, of length e: nothing up to one half of it, then
    slope (length - e / 2); on the corners where the reliefs begin contact lingers, and is there."""
    amount, (spurs, path, pitch) = 0.004, spur()
    double = path[1] - path[0] - pitch * spurs.pinion
    reach = share * double
    ends = path[1], spurs.line_of_action - path[0]
    starts = ends[0] - reach, ends[1] - reach
    tables = [{"tip_relief": {"amount": amount, "start_roll_length": start, "shape": "linear"}} for start in starts]

    def profile(start: float, end: float) -> Any:
        return lambda x: (amount * (x - start) / (end - start), np.full_like(x, amount / (end - start)))

    reliefs = profile(starts[0], ends[0]), profile(starts[1], ends[1])
    angle, advance = pair_curve(spurs, path, reliefs, starts, 20_001)
    pair = built(tables[0], tables[1])
    some = np.linspace(100, len(angle) - 100, 61).astype(int)
    error = solved_advance(pair, angle[some]) - advance[some]
    assert np.abs(error).max() * spurs.gear < ROUNDING
    exact = peak_to_peak(angle, advance, pitch) * spurs.gear
    assert mesh_peak_to_peak(pair) * spurs.gear == pytest.approx(exact, abs=ROUNDING)
    expected = amount / reach * max(reach - 0.5 * double, 0.0)
    assert exact == pytest.approx(expected, rel=0.02, abs=ROUNDING)


@pytest.mark.parametrize("flank", ["right", "left"])
def test_a_row_of_the_grid_is_where_a_relief_begins(flank: str) -> None:
    pair = built({"tip_relief": {"amount": 0.01, "start_roll_length": 14.0}}, flank=flank)
    assert np.abs(solver_pair(pair).pinion.grid[:, 0, 0] - 14.0).min() < 1e-9


@pytest.mark.sweep
@pytest.mark.sweep_cases("right")
@pytest.mark.parametrize("flank", ["right", "left"])
def test_lines_end_on_the_corner_of_a_linear_relief(flank: str) -> None:
    """Beyond it there is none: roll lengths end where the relief begins, and surface contact as much sooner as they are less."""
    # helix 15 deg as it is, the profile's angle and modules of the normal section
    transverse = np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(15.0)))
    reference = 0.5 * TEETH[0] * MODULE / np.cos(np.radians(15.0))
    base = reference * np.cos(transverse)
    tip = float(np.sqrt((reference + MODULE) ** 2 - base**2))
    start = tip - 2.5
    plain = built({}, helix=15.0, flank=flank)
    table = {"tip_relief": {"amount": 0.01, "start_roll_length": start, "shape": "linear"}}
    relieved = built(table, helix=15.0, flank=flank)
    ends = []
    for pair in (plain, relieved):
        flanks = solver_pair(pair)
        cycle = mesh_cycle(flanks, pair.pitch, whole_engagement(flanks, pair.pitch))
        assert cycle is not None
        ends.append(np.array(cycle.surface))
    later = np.abs(ends[1] - ends[0])
    assert later.min() < 1e-12
    assert later.max() * base == pytest.approx(tip - start, abs=ROUNDING)
    path = contact_path(solver_pair(relieved), np.linspace(*ends[1], 13)[1:-1])
    radius = np.array([np.hypot(*(line[[0, -1]] - relieved.pinion.mount.origin)[:, :2].T) for line in path.lines])
    rolled = np.sqrt(radius**2 - base**2).max(axis=1)
    assert (path.kind == "line").all()
    assert rolled.max() == pytest.approx(start, abs=1e-8)
    assert (np.abs(rolled - start) < 1e-8).sum() >= 3


def test_helix_crowning_makes_points_of_lines() -> None:
    """Flanks part along the face as the parabola does, and the ellipse is as long as that says."""
    amount = 0.01
    pair = built({"helix_crowning": "10um"})
    flanks = solver_pair(pair)
    path = contact_path(flanks, np.radians([-3.0, 0.0, 4.0]))
    assert (path.kind == "point").all()
    bend = 2.0 * amount / (0.5 * WIDTH) ** 2
    np.testing.assert_allclose(separation_curvatures(pair, path)[:, 0], bend, rtol=1e-9)
    np.testing.assert_allclose(path.semi_major, np.sqrt(2.0 * pair.delta / bend), rtol=1e-9)
    np.testing.assert_allclose(path.point[:, 2], 0.0, atol=1e-9)
    assert (contact_path(solver_pair(built({})), np.radians([-3.0, 0.0, 4.0])).kind == "line").all()
