"""Eccentric members over whole turns: against [CR3553] 3.4, the solver with the eccentricity itself, and the roll."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, load, system
from gearmesh.check.roll import roll
from gearmesh.contact.engagement.turns import FullTurns, full_turns, pitches_until_repeat
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.kinds import Mount
from gearmesh.systems.system import kinds

SPUR = ("spur", "pinion.teeth=16", "gear.teeth=24", "assembly.center_distance=60")
#: the pattern of both members repeats with a turn of the gear
EVEN = ("spur", "pinion.teeth=16", "gear.teeth=32", "assembly.center_distance=72")
BEVEL = ("spiral_bevel_geometry1",)


def eccentric_pair(sample: str, *keys: str, size: float = 0.03) -> GearPair:
    errors = {"pinion_eccentricity": size, "pinion_phase": 50.0, "gear_eccentricity": 0.7 * size, "gear_phase": -70.0}
    given = [f"assembly.{key}={value}" for key, value in errors.items()]
    return pair_of(load(SAMPLES / f"{sample}.toml", [*keys, *given]))


@cache
def turned(design: tuple[str, ...], size: float = 0.03) -> tuple[GearPair, FullTurns]:
    """An eccentric pair and its turns, solved once for all tests."""
    pair = eccentric_pair(*design, size=size)
    return pair, full_turns(pair)


def turned_on(pair: GearPair, tooth: int) -> GearPair:
    """The pair as its teeth number `tooth` meet, counted as if they were the first: the eccentricities are turned instead."""

    def mount(each: Mount, angle: float) -> Mount:
        x, y = each.eccentricity
        c, s = np.cos(each.sign * angle), np.sin(each.sign * angle)
        return replace(each, eccentricity=(float(c * x - s * y), float(s * x + c * y)))

    first, second = (
        mount(each, tooth * angle)
        for each, angle in zip(pair.mounts, (pair.pitch, pair.ratio * pair.pitch), strict=True)
    )
    return replace(pair, pinion=replace(pair.pinion, mount=first), gear=replace(pair.gear, mount=second))


@pytest.mark.sweep
@pytest.mark.parametrize("design", [EVEN, BEVEL], ids=lambda design: design[0])
def test_every_tooth_pair_does_as_the_solver_and_the_roll_have_it(design: tuple[str, ...]) -> None:
    pair, turns = turned(design)
    reference = float(contact_path(solver_pair(pair), np.zeros(1)).phi2[0])
    every = np.arange(1, turns.phi1.size, turns.phi1.size // 3)
    for k in every:
        tooth = int(turns.carrier[k])
        at, own = np.array([turns.phi1[k] - tooth * pair.pitch]), turned_on(pair, tooth)
        # teeth that have gone round once more are the same again
        at = (at + 0.5 * turns.pitches * pair.pitch) % (turns.pitches * pair.pitch) - 0.5 * turns.pitches * pair.pitch
        phi2 = contact_path(solver_pair(own), at).phi2
        te = float(phi2[0]) - pair.ratio * at[0] - reference
        assert abs(te - turns.te[k]) < 1e-9
        if k == every[1]:
            grids = [
                member.tooth.flank_grid(side, np.linspace(0, 1, 81), np.linspace(0, 1, 61)).points
                for member, side in zip(own.both, own.flanks, strict=True)
            ]
            (rolled,) = roll(*grids, own.mounts, own.ratio, at, own.drive, own.delta, phi2)
            assert abs(rolled.phi2 - phi2[0]) < 0.05 * ARCSEC
    assert turns.peak_to_peak > 100.0 * ARCSEC
    assert turns.tooth_to_tooth < turns.peak_to_peak


@pytest.fixture
def sparse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of the positions."""
    monkeypatch.setattr("gearmesh.contact.engagement.turns.POSITIONS_PER_PITCH", 6)


@pytest.mark.sweep
def test_waves_are_those_of_the_closed_form_to_first_order() -> None:
    """[CR3553 3.4.14]: e / (r_b2) of the pinion's and of the gear's, their crests too; what is left is of second order."""
    apart = []
    for size in (0.03, 0.015):
        _, turns = turned(EVEN, size)
        assert turns.pitches == 32
        waves = [wave for wave in turns.waves if np.isfinite(wave.closed_amplitude)]
        assert [(wave.member, wave.per_turn) for wave in waves] == [("pinion", 1), ("gear", 1)]
        base = 0.5 * 32 * 3.0 * np.cos(np.radians(20.0))
        np.testing.assert_allclose(
            [wave.closed_amplitude for wave in waves], [size / base, 0.7 * size / base], rtol=1e-9
        )
        closed = sum(
            wave.closed_amplitude * np.cos(rate * (turns.phi1 - wave.closed_crest))
            for wave, rate in zip(waves, (1.0, 16 / 32), strict=True)
        )
        left = turns.te - closed
        # where one pair carries alone; at the change of teeth edges carry, which the closed form does not know
        apart.append(float(np.quantile(np.abs(left - np.median(left)), 0.5)))
        assert apart[-1] < 0.03 * turns.peak_to_peak
    assert 3.0 < apart[0] / apart[1] < 5.0


def test_the_pattern_repeats_with_the_teeth_of_eccentric_members() -> None:
    pair = eccentric_pair(*SPUR)
    for members, pitches in (((), 1), (("pinion",), 16), (("gear",), 24), (("pinion", "gear"), 48)):
        own = {
            name: member if name in members else replace(member, mount=member.mount.concentric)
            for name, member in pair.members.items()
        }
        assert pitches_until_repeat(replace(pair, **own)) == pitches


@pytest.mark.sweep
def test_every_kind_takes_eccentric_members_and_puts_them_on_their_mounts() -> None:
    for kind in kinds():
        keys = {line.key for line in system(kind).design.key_lines()}
        others = {
            "planetary": ("sun", "planet", "ring"),
            "rack": ("pinion",),
            "worm_drive": ("worm", "wheel"),
            "cycloidal": ("disc", "ring"),
            "spline": ("shaft", "hub"),
        }
        members = others.get(kind, ("pinion", "gear"))
        assert {f"assembly.{member}_{what}" for member in members for what in ("eccentricity", "phase")} <= keys
    samples = {
        "beveloid_parallel": "gear",
        "planetary": "planet",
        "rack": "pinion",
        "face_gear": "gear",
        "circular_arc": "pinion",
        "worm_drive": "wheel",
    }
    for sample, name in samples.items():
        design = gm.load(
            SAMPLES / f"{sample}.toml", [f"assembly.{name}_eccentricity=20um", f"assembly.{name}_phase=90"]
        )
        train = gm.build(design).train
        off = {each: member.mount.eccentricity for each, member in train.members.items()}
        for each, (x, y) in off.items():
            assert (abs(x), round(y, 9)) < (1e-9, 0.020001 if each.startswith(name) else 1e-9)
        assert sum(abs(y - 0.02) < 1e-12 for _, y in off.values()) == (3 if name == "planet" else 1)


@pytest.mark.sweep
@pytest.mark.usefixtures("sparse")
def test_jammed_turns_are_told_and_backlash_frees_them() -> None:
    keys = [
        *SPUR[1:],
        "assembly.pinion_eccentricity=0.05",
        "contact.phi1.start=0",
        "contact.phi1.stop=1",
        "contact.phi1.count=2",
    ]
    jammed, free = (
        gm.build(gm.load(SAMPLES / "spur.toml", [*keys, f"backlash={backlash}"])).contact(cycle=False, turns=True)
        for backlash in (0.01, 0.1)
    )
    assert any("jam" in line for line in jammed.warnings)
    assert not any("jam" in line for line in free.warnings)
    # the eccentricity takes 2 e sin(alpha) along the normal of both flanks together
    for contact in (jammed, free):
        low, high = contact.summary["turns_backlash_min_deg"], contact.summary["turns_backlash_max_deg"]
        base = 0.5 * 24 * 3.0 * np.cos(np.radians(20.0))
        np.testing.assert_allclose(np.radians(high - low) * base, 4.0 * 0.05 * np.sin(np.radians(20.0)), rtol=0.02)
    turns = free.document()["turns"]
    assert turns["pitches"] == 16
    assert len(turns["te_arcsec"]) == 16 * turns["positions_per_pitch"]
    assert free.csv().splitlines()[0] == "phi1_deg,te_arcsec,tooth_pair,backlash_deg"
