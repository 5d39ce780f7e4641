"""Figures of a row of a study under load: what a mesh cycle under each torque comes to, in lists with one number a torque."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.contact.path import ARCSEC
from gearmesh.errors import Status
from gearmesh.kernel.algebra import Array
from gearmesh.loaded.sharing import PairLoad

#: positions in a pitch
POSITIONS = 9


def load_figures(found: LoadedContact) -> dict[str, list[Any]]:
    """Figures of a loaded mesh whose positions are even in one pitch, under their names with units: at how many it converged, and
    None for all others under a torque with which it did not at all of them."""
    mesh = found.mesh
    converged = (mesh.status == Status.CONVERGED).sum(axis=1).tolist()
    totals, count = found.totals, len(mesh.phi1)
    roots = [f"{member}_root_stress{at}_mpa" for at in ("", "_30") for member in found.pair.members]
    stiffness = 1e-3 * ARCSEC * mesh.stiffness.mean(axis=1)
    figures: dict[str, list[Any]] = {
        "loaded_te_peak_to_peak_arcsec": [each["te_peak_to_peak_arcsec"] for each in totals],
        "max_pressure_mpa": [each["max_pressure_mpa"] for each in totals],
        **{name: [each[name] for each in totals] for name in roots},
        "max_pair_share": [
            float((load.moment / each).max()) for load, each in zip(mesh.loads, mesh.torque, strict=True)
        ],
        "loaded_edge_positions": [len(np.unique(load.position[load.on_edge])) for load in mesh.loads],
        "mean_stiffness_nm_per_arcsec": stiffness.tolist(),
        "loaded_contact_ratio": [loaded_contact_ratio(load, count) for load in mesh.loads],
    }
    figures = {
        name: [each if good == count else None for each, good in zip(values, converged, strict=True)]
        for name, values in figures.items()
    }
    return {**figures, "loaded_converged_positions": converged}


def loaded_contact_ratio(load: PairLoad, count: int) -> float:
    """Pitches over which one tooth pair carries, with `count` positions even in a pitch: to where its moment, beyond the last
    positions at which it carries, has run out if it goes on falling as between them; half a step where it does not fall."""
    moment = _moments(load, count)
    moment = moment[moment > 0.0]
    return (len(moment) - 1 + _run_out(moment[:2]) + _run_out(moment[:-3:-1])) / count


def _moments(load: PairLoad, count: int) -> Array:
    """Moments, N mm, of one tooth pair, both halves of double helical gears together, one after the other as it goes through the
    mesh: what pair k does at a position is what pair 0 does k pitches before."""
    at, own = np.unique(load.position - count * load.number, return_inverse=True)
    found: Array = np.bincount(own, load.moment, len(at)).astype(float)
    return found


def _run_out(moment: Array) -> float:
    """Steps from the last of two moments to nothing, the one before it second."""
    if len(moment) < 2 or not moment[1] > moment[0]:
        return 0.5
    return float(np.clip(moment[0] / (moment[1] - moment[0]), 0.0, 1.0))
