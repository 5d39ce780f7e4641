"""Figures of a row of a study under load: values of a mesh cycle, in lists with one number per torque."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from gearmesh.answers.load.figures import FilletFigures
from gearmesh.answers.load.loaded import LoadedContact
from gearmesh.errors import Status
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, largest_known
from gearmesh.loaded.sharing import PairLoad
from gearmesh.records import dataclass

#: positions of a mesh cycle in one pitch
POSITIONS_PER_PITCH = 9


@dataclass(frozen=True)
class LoadFigures(Figures):
    """A mesh under several torques, one number per torque; None where the mesh did not converge at all positions."""

    loaded_te_peak_to_peak: list[float | None] = figure("loaded transmission error, peak to peak", "arcsec")
    max_pressure: list[float | None] = figure("largest pressure", "MPa")
    root_stress: Mapping[str, list[float | None]] = figure(
        "largest tensile stress in the fillets below their borders with the flanks; beside the contact the smaller of the stresses "
        "with and without the contact's own field",
        "MPa",
        key="{member}_root_stress_mpa",
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
    """Return the figures of a loaded mesh whose positions divide one pitch equally.

    They include the number of converged positions. All other figures are None under a torque for which any position did
    not converge.
    """
    mesh = loaded.mesh
    converged = (mesh.status == Status.CONVERGED).sum(axis=1).tolist()
    count = len(mesh.phi1)
    # not the totals, whose other figures take a tenth of the time of a row
    fillets = [loaded.largest_in_fillets(k) for k in range(len(mesh.torque))]

    def if_converged(values: Iterable[Any]) -> list[Any]:
        return [
            value if converged_count == count else None
            for value, converged_count in zip(values, converged, strict=True)
        ]

    def of_members(stress: Callable[[FilletFigures], float]) -> dict[str, list[float | None]]:
        return {name: if_converged(stress(of_torque[name]) for of_torque in fillets) for name in loaded.pair.members}

    return Summary(
        LoadFigures(
            loaded_te_peak_to_peak=if_converged((mesh.te_peak_to_peak / ARCSEC).tolist()),
            max_pressure=if_converged(largest_known(load.peak) for load in mesh.loads),
            root_stress=of_members(lambda fillet: fillet.root_stress),
            root_stress_30=of_members(lambda fillet: fillet.root_stress_30),
            max_pair_share=if_converged(
                float((load.moment / torque).max()) for load, torque in zip(mesh.loads, mesh.torque, strict=True)
            ),
            loaded_edge_positions=if_converged(len(np.unique(load.position[load.on_edge])) for load in mesh.loads),
            mean_stiffness=if_converged((1e-3 * ARCSEC * mesh.stiffness.mean(axis=1)).tolist()),
            loaded_contact_ratio=if_converged(loaded_contact_ratio(load, count) for load in mesh.loads),
            loaded_converged_positions=converged,
        )
    )


def loaded_contact_ratio(load: PairLoad, count: int) -> float:
    """Return the number of pitches over which one tooth pair is loaded, for `count` positions per pitch.

    Beyond the last loaded position at each end the moment is extrapolated to zero along its last slope. If it does not
    fall towards the end, half a step is added.
    """
    moment = _moments(load, count)
    moment = moment[moment > 0.0]
    return (len(moment) - 1 + _run_out(moment[:2]) + _run_out(moment[:-3:-1])) / count


def _moments(load: PairLoad, count: int) -> Array:
    """Return the moments, N mm, of one tooth pair, in order, as it goes through the mesh.

    Pair k has at a position the moment that pair 0 has k pitches earlier. Both halves of double helical gears are
    summed.
    """
    at, inverse = np.unique(load.position - count * load.number, return_inverse=True)
    moments: Array = np.bincount(inverse, load.moment, len(at)).astype(float)
    return moments


def _run_out(moment: Array) -> float:
    """Return the steps from the last loaded position to zero moment.

    `moment` has the last value first, then the value before it.
    """
    if len(moment) < 2 or not moment[1] > moment[0]:
        return 0.5
    return float(np.clip(moment[0] / (moment[1] - moment[0]), 0.0, 1.0))
