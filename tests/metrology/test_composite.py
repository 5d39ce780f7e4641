"""Pitch deviations over whole turns: closed form of involute teeth, eccentric members, and centre distances without backlash."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, GearPair, Member, load
from gearmesh.answers.inspection.composite import composite_test
from gearmesh.contact.engagement.pitch_turns import pitch_turns
from gearmesh.contact.engagement.turns import FullTurns, full_turns
from gearmesh.contact.fit.tight_mesh import tight_mesh
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.kinds import Side
from gearmesh.metrology.measured_teeth import MeasuredTeeth
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.systems.cylindrical.geometry.line_of_action import tight_distance
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.system import complete_design
from gearmesh.teeth.micro_geometry.index_angles import IndexAngles

SPUR = ("spur", "pinion.teeth=16", "gear.teeth=32", "assembly.center_distance=72")


def design_of(sample: str, *keys: str) -> gm.Design:
    return load(SAMPLES / f"{sample}.toml", list(keys))


def shifted(pair: GearPair, pinion: dict[Side, Array], gear: dict[Side, Array] | None = None) -> GearPair:
    """The pair with flanks ahead of their places by angles, rad."""
    members = [
        replace(member, index=IndexAngles.of_sides(own or {}))
        for member, own in zip(pair.both, (pinion, gear), strict=True)
    ]
    return replace(pair, pinion=members[0], gear=members[1])


def lead_of_involute_teeth() -> tuple[Array, FullTurns]:
    """Return the lead of the gear at every meeting of 16 and 32 teeth with random pitch deviations, and the whole turns."""
    pair = pair_of(design_of(*SPUR))
    random = np.random.default_rng(5)
    radii = 24.0, 48.0
    index = [2e-3 * random.uniform(-1.0, 1.0, teeth) for teeth in (16, 32)]
    first, second = (own / radius for own, radius in zip(index, radii, strict=True))
    both = shifted(pair, *(dict.fromkeys(Side, own) for own in (first, second)))
    number = np.arange(32)
    s1, s2 = (int(mount.sign) for mount in pair.mounts)
    # at phi1 = k pitches tooth k of the pinion, counted backwards as it turns forwards, is where tooth 0 was
    lead = (
        pair.ratio * s1 * first[(-s1 * number) % 16]
        - s2 * second[(-s2 * np.sign(pair.ratio).astype(int) * number) % 32]
    )
    return lead, pitch_turns(both)


@pytest.mark.quick
def test_involute_teeth_lead_by_their_pitch_deviations() -> None:
    """The gear is ahead by the pitch deviations of the two touching flanks where one tooth pair is alone. So the total
    single-flank deviation is the range of these leads. In between, the gear is behind neither pair."""
    lead, turns = lead_of_involute_teeth()
    assert turns.pitches == 32
    number = np.arange(32)
    te = turns.te.reshape(32, -1)
    alone = [j for j in range(te.shape[1]) if np.unique(turns.carrier.reshape(32, -1)[:, j] - number).size == 1]
    assert alone
    for j in alone:
        k = turns.carrier.reshape(32, -1)[:, j]
        assert te[:, j] - te[0, j] == pytest.approx(lead[k % 32] - lead[k[0] % 32], abs=1e-10)
    assert turns.peak_to_peak == pytest.approx(np.ptp(lead), rel=1e-6)
    pair, first = pair_of(design_of(*SPUR)), np.zeros(16)
    with pytest.raises(DesignError, match="must be 16, one a tooth"):
        shifted(pair, {pair.flanks[0]: first[:-1]})


def eccentric_shifts(member: Member, size: float, phase: float) -> dict[Side, Array]:
    """Return readings of a pitch gauge on a member whose teeth are off their axis: middles of displaced flanks, as angles."""
    shifts = {}
    angle = 2.0 * np.pi * np.arange(member.tooth.teeth) / member.tooth.teeth
    for side in Side:
        grid = member.tooth.flank_grid(side, [0.5], [0.5])
        (x, y, _), (n_x, n_y, _) = grid.points[0, 0], grid.normals[0, 0]
        along = n_x * np.cos(phase - angle) + n_y * np.sin(phase - angle)
        shifts[side] = size * along / (x * n_y - y * n_x)
    return shifts


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "name"), [(SPUR, "gear"), (("spiral_bevel_geometry1",), "pinion")], ids=("spur", "bevel")
)
def test_pitch_deviations_of_an_eccentric_member_make_its_wave(sample: tuple[str, ...], name: str) -> None:
    """To half a pitch, by which teeth take over one from the next, and to what of an eccentricity is no pitch deviation."""
    pair = pair_of(design_of(*sample))
    member = pair.members[name]
    own_shifts = eccentric_shifts(member, 0.03, math.radians(50.0))
    uneven = shifted(pair, *(own_shifts if name == other else {} for other in pair.members))
    eccentric = pair_of(design_of(*sample, f"assembly.{name}_eccentricity=0.03", f"assembly.{name}_phase=50"))
    own, real = pitch_turns(uneven), full_turns(eccentric)
    assert own.peak_to_peak == pytest.approx(real.peak_to_peak, rel=0.03)
    # errors of the one against the other, over the turns: much less than either; the wrong sign or sense doubles it
    apart = np.ptp((own.te - own.te.mean()) - (real.te - real.te.mean())[: own.te.size])
    assert apart < 0.25 * real.peak_to_peak
    assert own.peak_to_peak > 100.0 * ARCSEC


@pytest.mark.sweep
def test_tight_centre_distances_are_those_of_thicker_involute_teeth() -> None:
    design = design_of("internal")
    pair, mesh = pair_of(design), proportions(complete_design(design).in_mm()).mesh
    teeth = pair.pinion.tooth.teeth
    # thicker by 4 um in the normal section, half on either side; and uneven by nothing that shows
    half = 2e-3 / mesh.pinion.radius / math.cos(mesh.pinion.beta)
    tilt = 1e-12 * np.arange(teeth)
    tight = tight_mesh(shifted(pair, {Side.RIGHT: -half + tilt, Side.LEFT: half + tilt}))
    assert tight.nominal == pytest.approx(tight_distance(mesh), abs=1e-6)
    thick = replace(mesh, pinion=replace(mesh.pinion, allowance=mesh.pinion.allowance + 4e-3))
    grown = tight_distance(thick) - tight_distance(mesh)
    assert tight.distance - tight.nominal == pytest.approx(grown, rel=1e-3)
    assert tight.total < 1e-8


@pytest.mark.sweep
def test_composite_deviations_of_a_pair() -> None:
    """Deviations alike on both sides turn the gear by the arcs of the pinion's circle, less what the neighbours of the lowest tooth
    lead it by, and hardly move the axes."""
    design = design_of(*SPUR)
    index = 1e-3 * np.cos(2.0 * np.pi * np.arange(16) / 16)
    answer = composite_test(
        design, gm.build(design).train, {"pinion": MeasuredTeeth(pitch={side: PitchDeviations(index) for side in Side})}
    )
    own = answer.figures
    neighbour = 1.0 - np.cos(2.0 * np.pi / 16)
    assert 2.0 - neighbour - 1e-6 < own.single_flank_total < 2.0 + 1e-6
    assert own.double_flank_tooth < own.double_flank_total < own.single_flank_total
    assert own.turns_pinion == 1.0
    assert "F_i''" in answer.headline
    with pytest.raises(DesignError, match="must be one of pinion, gear"):
        composite_test(design, gm.build(design).train, {"ring": MeasuredTeeth()})


def eccentric_pair(teeth: tuple[int, int], **assembly: float) -> gm.Gears:
    members = {name: {"teeth": count, "face_width": 20} for name, count in zip(("pinion", "gear"), teeth, strict=True)}
    return gm.build(gm.parse({"kind": "cylindrical", "module": 2, "backlash": 0.1, **members, "assembly": assembly}))


def test_play_of_an_eccentric_gear_is_that_of_one_gear() -> None:
    """Displaced involutes: 2 e tan(alpha) / r either way. The coast flanks were those of a gear whose eccentricity stands a pitch
    beside: the play was a fifth too small."""
    turns = full_turns(eccentric_pair((17, 17), gear_eccentricity=0.02).train.pairs[0])
    closed = 4.0 * 0.02 * math.tan(math.radians(20.0)) / 17.0
    assert np.ptp(turns.backlash) == pytest.approx(closed, rel=1e-2)


@pytest.mark.sweep
def test_runout_alone_is_a_composite_deviation() -> None:
    """Displaced involutes: F_i' = 2 e / cos(alpha) on the reference circle, F_i'' = 2 e. Pairs that were only eccentric were
    refused as if they had pitch deviations."""
    own = eccentric_pair((17, 17), gear_eccentricity=0.02).composite().figures
    assert own.single_flank_total == pytest.approx(40.0 / math.cos(math.radians(20.0)), rel=2e-3)
    assert own.double_flank_total == pytest.approx(40.0, rel=4e-3)
    assert own.turns_pinion == 1.0


@pytest.mark.sweep
@pytest.mark.parametrize(("phase", "total"), [(26.0, 74.95), (71.0, 66.50)])
def test_two_eccentricities_depend_on_their_phase(phase: float, total: float) -> None:
    """20/40 teeth, 0.02 mm each, at the extremes of phase: ranges of sin(2 x) + sin(x) and cos(2 x) + cos(x) times e / cos(alpha),
    not the sum 2 (e1 + e2) / cos(alpha), 85.1 um."""
    assembly = {"pinion_eccentricity": 0.02, "gear_eccentricity": 0.02, "gear_phase": phase}
    own = eccentric_pair((20, 40), **assembly).composite().figures
    assert own.single_flank_total == pytest.approx(total, abs=0.25)
    turn = np.linspace(0.0, 2.0 * np.pi, 100_001)
    least, most = (20.0 * np.ptp(wave(2.0 * turn) + wave(turn)) for wave in (np.cos, np.sin))
    assert own.double_flank_total is not None
    assert 0.995 * least < own.double_flank_total < 1.005 * most
