"""Figures of a row of a study under load: values of a mesh cycle under each torque, in lists with one number per torque."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.answers.load.figures import FilletFigures
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.errors import Status
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.loaded.sharing import PairLoad

#: positions in a pitch
POSITIONS = 9


@dataclass(frozen=True)
class LoadFigures(Figures):
    """A mesh under several torques, one number per torque; None where the mesh did not converge at all positions."""

    loaded_te_peak_to_peak: list[float | None] = figure("loaded transmission error, peak to peak", "arcsec")
    max_pressure: list[float | None] = figure("largest pressure", "MPa")
    root_stress: Mapping[str, list[float | None]] = figure(
        "largest tensile stress in the fillets, away from the contact", "MPa", key="{member}_root_stress_mpa"
    )
    root_stress_30: Mapping[str, list[float | None]] = figure(
        "largest tensile stress at the tangents of 30 deg to the fillets", "MPa", key="{member}_root_stress_30_mpa"
    )
    max_pair_share: list[float | None] = figure("largest share of the torque on one tooth pair")
    loaded_edge_positions: list[int | None] = figure("positions with edge contact", whole=True)
    mean_stiffness: list[float | None] = figure("mean stiffness of the mesh", "Nm/arcsec")
    loaded_contact_ratio: list[float | None] = figure("contact ratio under load")
    loaded_converged_positions: list[int] = figure("positions at which loaded contact converged", whole=True)


def load_figures(loaded: LoadedContact) -> Summary:
    """Figures of a loaded mesh whose positions are even in one pitch: at how many it converged, and None for all others under a
    torque with which it did not at all of them."""
    mesh = loaded.mesh
    converged = (mesh.status == Status.CONVERGED).sum(axis=1).tolist()
    totals, count = loaded.totals, len(mesh.phi1)

    def sure(values: Iterable[Any]) -> list[Any]:
        return [value if good == count else None for value, good in zip(values, converged, strict=True)]

    def of_members(stress: Callable[[FilletFigures], float]) -> dict[str, list[float | None]]:
        return {name: sure(stress(total.fillets[name]) for total in totals) for name in loaded.pair.members}

    return Summary(
        LoadFigures(
            loaded_te_peak_to_peak=sure(total.te_peak_to_peak for total in totals),
            max_pressure=sure(total.max_pressure for total in totals),
            root_stress=of_members(lambda own: own.root_stress),
            root_stress_30=of_members(lambda own: own.root_stress_30),
            max_pair_share=sure(
                float((load.moment / torque).max()) for load, torque in zip(mesh.loads, mesh.torque, strict=True)
            ),
            loaded_edge_positions=sure(len(np.unique(load.position[load.on_edge])) for load in mesh.loads),
            mean_stiffness=sure((1e-3 * ARCSEC * mesh.stiffness.mean(axis=1)).tolist()),
            loaded_contact_ratio=sure(loaded_contact_ratio(load, count) for load in mesh.loads),
            loaded_converged_positions=converged,
        )
    )


def loaded_contact_ratio(load: PairLoad, count: int) -> float:
    """Pitches over which one tooth pair is loaded, with `count` positions even in a pitch: to where its moment, beyond the last
    positions at which it is loaded, has vanished if it goes on falling as between them; half a step where it does not fall."""
    moment = _moments(load, count)
    moment = moment[moment > 0.0]
    return (len(moment) - 1 + _run_out(moment[:2]) + _run_out(moment[:-3:-1])) / count


def _moments(load: PairLoad, count: int) -> Array:
    """Moments, N mm, of one tooth pair, both halves of double helical gears together, one after the other as it goes through the
    mesh: what pair k does at a position is what pair 0 does k pitches before."""
    at, own = np.unique(load.position - count * load.number, return_inverse=True)
    moments: Array = np.bincount(own, load.moment, len(at)).astype(float)
    return moments


def _run_out(moment: Array) -> float:
    """Steps from the last of two moments to nothing, the one before it second."""
    if len(moment) < 2 or not moment[1] > moment[0]:
        return 0.5
    return float(np.clip(moment[0] / (moment[1] - moment[0]), 0.0, 1.0))
