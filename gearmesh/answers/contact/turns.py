"""What `tca --turns` says of a pair over whole turns: figures, waves of eccentric members, and the error at every position."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gearmesh.answers.tables import Listing, rounded
from gearmesh.contact.path import ARCSEC
from gearmesh.contact.turns import FullTurns
from gearmesh.teeth.train import GearPair


def turns_summary(pair: GearPair, turns: FullTurns) -> dict[str, Any]:
    """Figures for the summary, keys with units."""
    return {
        "turns_pinion": turns.pitches / pair.pinion.tooth.teeth,
        "turns_gear": turns.pitches / pair.pinion.tooth.teeth * abs(pair.ratio),
        "turns_te_peak_to_peak_arcsec": turns.peak_to_peak / ARCSEC,
        "turns_te_tooth_to_tooth_arcsec": turns.tooth_to_tooth / ARCSEC,
        "turns_backlash_min_deg": float(np.degrees(turns.backlash.min())),
        "turns_backlash_max_deg": float(np.degrees(turns.backlash.max())),
    }


def turns_details(turns: FullTurns) -> dict[str, Any]:
    """All of it, for the JSON."""
    return {
        "pitches": turns.pitches,
        "positions_per_pitch": turns.per_pitch,
        "waves": _waves(turns),
        **_columns(turns),
    }


def turns_rows(turns: FullTurns) -> list[dict[str, Any]]:
    """One dict a position, the columns of the CSV."""
    columns = _columns(turns)
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _columns(turns: FullTurns) -> dict[str, list[Any]]:
    return {
        "phi1_deg": np.degrees(turns.phi1).round(10).tolist(),
        "te_arcsec": (turns.te / ARCSEC).tolist(),
        "tooth_pair": turns.carrier.tolist(),
        "backlash_deg": np.degrees(turns.backlash).tolist(),
    }


def turns_listing(turns: FullTurns) -> Listing:
    """The waves as a table, beside the closed form."""
    heads = ["wave", "per turn", "arcsec", "crest at phi1 deg", "closed form arcsec", "crest deg"]
    rows = [
        [
            wave["of"],
            wave["per_turn"],
            rounded(wave["amplitude_arcsec"], 4),
            rounded(wave["crest_phi1_deg"], 2),
            *(math.nan if wave[key] is None else rounded(wave[key], n) for key, n in _CLOSED.items()),
        ]
        for wave in _waves(turns)
    ]
    return Listing("Transmission error over whole turns", heads, rows)


def turns_warnings(turns: FullTurns) -> tuple[str, ...]:
    """What is wrong with the pair somewhere in its turns."""
    k = int(turns.backlash.argmin())
    if not turns.backlash[k] < -ARCSEC:
        return ()
    return (
        f"the eccentric members jam: at phi1 = {np.degrees(turns.phi1[k]):.5g} deg the gear's flanks overlap by "
        f"{-np.degrees(turns.backlash[k]):.3g} deg of its rotation; a backlash of so much, or less eccentricity, frees them",
    )


_CLOSED = {"closed_form_amplitude_arcsec": 4, "closed_form_crest_phi1_deg": 2}


def _waves(turns: FullTurns) -> list[dict[str, Any]]:
    def known(value: float) -> float | None:
        return None if math.isnan(value) else value

    return [
        {
            "of": wave.member,
            "per_turn": wave.per_turn,
            "amplitude_arcsec": wave.amplitude / ARCSEC,
            "crest_phi1_deg": math.degrees(wave.crest),
            "closed_form_amplitude_arcsec": known(wave.closed_amplitude / ARCSEC),
            "closed_form_crest_phi1_deg": known(math.degrees(wave.closed_crest)),
        }
        for wave in turns.waves
    ]
