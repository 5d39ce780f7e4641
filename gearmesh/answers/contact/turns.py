"""Results of `tca --turns` over whole turns: figures, waves of eccentric members, and the error at every position."""

from __future__ import annotations

import math

import numpy as np

from gearmesh.answers.tables import Listing, round_to
from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.figures import Figures, figure
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair


@dataclass(frozen=True)
class TurnsSummary(Figures):
    """Members over whole turns, eccentric or with pitch deviations."""

    turns_pinion: float = figure("turns of the pinion until the same teeth meet again")
    turns_gear: float = figure("turns of the gear until the same teeth meet again")
    turns_te_peak_to_peak: float = figure("transmission error over whole turns, peak to peak", "arcsec", "F_i'")
    turns_te_tooth_to_tooth: float = figure("largest transmission error within a pitch", "arcsec", "f_i'")
    turns_backlash_min: float = figure("backlash as rotation of the gear, least over whole turns", "deg")
    turns_backlash_max: float = figure("backlash as rotation of the gear, greatest over whole turns", "deg")

    @staticmethod
    def of(pair: GearPair, turns: FullTurns) -> TurnsSummary:
        """Return the figures of a pair over whole turns."""
        whole = turns.pitches / pair.pinion.tooth.teeth
        return TurnsSummary(
            whole,
            whole * abs(pair.ratio),
            turns.peak_to_peak / ARCSEC,
            turns.tooth_to_tooth / ARCSEC,
            float(np.degrees(turns.backlash.min())),
            float(np.degrees(turns.backlash.max())),
        )


@dataclass(frozen=True)
class WaveFigures(Figures):
    """Part of the transmission error that repeats with a member's turns, or with every tooth."""

    of: str = figure("member with whose turns the wave repeats, or mesh")
    per_turn: int = figure("periods in a turn of that member", whole=True)
    amplitude: float = figure("amplitude", "arcsec")
    crest_phi1: float = figure("rotation of the pinion at the first crest", "deg")
    closed_form_amplitude: float | None = figure("amplitude of first order [CR3553 3.4.14]", "arcsec")
    closed_form_crest_phi1: float | None = figure("first crest of first order", "deg")


@dataclass(frozen=True)
class TurnsPositions(Figures):
    """The gears at every position of whole turns."""

    phi1: list[float] = figure("rotations of the pinion", "deg", "phi_1")
    te: list[float] = figure("transmission error of the gears", "arcsec")
    tooth_pair: list[int] = figure("number of the leading tooth pair", whole=True)
    backlash: list[float] = figure("backlash as rotation of the gear", "deg")

    @property
    def rows(self) -> list[dict[str, float]]:
        """Rows of the CSV, one per position."""
        columns = self.row
        return [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]


@dataclass(frozen=True)
class TurnsDetails(Figures):
    """The pair over whole turns, position by position."""

    pitches: int = figure("pitches until the same teeth meet again", whole=True)
    positions_per_pitch: int = figure("positions in a pitch", whole=True)
    waves: list[WaveFigures] = figure("parts of the transmission error that repeat")
    positions: TurnsPositions = figure("the gears at every position", parts=TurnsPositions)

    @staticmethod
    def of(turns: FullTurns) -> TurnsDetails:
        """Return the positions of a pair over whole turns."""
        positions = TurnsPositions(
            np.degrees(turns.phi1).round(10).tolist(),
            (turns.te / ARCSEC).tolist(),
            turns.carrier.tolist(),
            np.degrees(turns.backlash).tolist(),
        )
        return TurnsDetails(turns.pitches, turns.per_pitch, _waves(turns), positions)


def turns_listing(turns: FullTurns) -> Listing:
    """Return a table of the waves, with their closed forms."""
    heads = ["wave", "per turn", "arcsec", "crest at phi1 deg", "closed form arcsec", "crest deg"]
    rows = [
        [
            wave.of,
            wave.per_turn,
            round_to(wave.amplitude, 4),
            round_to(wave.crest_phi1, 2),
            _or_none(wave.closed_form_amplitude, 4),
            _or_none(wave.closed_form_crest_phi1, 2),
        ]
        for wave in _waves(turns)
    ]
    return Listing("Transmission error over whole turns", heads, rows)


def turns_warnings(pair: GearPair, turns: FullTurns) -> tuple[str, ...]:
    """Return warnings about the pair over whole turns."""
    k = int(turns.backlash.argmin())
    if turns.runs_free:
        return ()
    who, what = ("members with pitch deviations", "these") if pair.uneven else ("eccentric members", "the eccentricity")
    return (
        f"the {who} jam: at phi1 = {np.degrees(turns.phi1[k]):.5g} deg the flanks overlap by "
        f"{-np.degrees(turns.backlash[k]):.3g} deg of the gear's rotation; increase the backlash by as much, or reduce {what}",
    )


def _or_none(value: float | None, digits: int) -> float:
    return math.nan if value is None else round_to(value, digits)


def _waves(turns: FullTurns) -> list[WaveFigures]:
    def finite(value: float) -> float | None:
        return None if math.isnan(value) else value

    return [
        WaveFigures(
            wave.member,
            wave.per_turn,
            wave.amplitude / ARCSEC,
            math.degrees(wave.crest),
            finite(wave.closed_amplitude / ARCSEC),
            finite(math.degrees(wave.closed_crest)),
        )
        for wave in turns.waves
    ]
