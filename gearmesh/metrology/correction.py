"""Changes of machine settings that remove measured deviations.

They follow by least squares from the sensitivity of the flank to each setting:

    d + J x = 0,    J_ij = d n_i / d x_j

d: deviations along the normals; J x: displacements of the flank along the normals under changes x of the settings. J is
scaled by the root mean square of each column and decomposed by singular values. Directions of x in which the noise
hides the deviations are not changed (truncated decomposition).
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: singular value over the largest one, below which it is rounding
MIN_SINGULAR_RATIO = 1e-7
#: part of a setting in a combination, over the largest part or of 1, below which the setting does not belong to it
MIN_SETTING_PART = 0.1
#: displacement by a combination over that by single settings, below which the settings can replace one another
MAX_EXCHANGE_MOTION = 0.05
#: standard deviations of the noise above which a direction counts as visible
MIN_SIGNAL_SIGMAS = 2.0


@dataclass(frozen=True)
class Exchange:
    """Settings that can replace one another: changed together, they hardly move the flank."""

    #: numbers (K,) of the settings, the largest part first
    settings: tuple[int, ...]
    #: changes (K,) of these settings for a change of 1 of the first
    changes: Array
    #: root mean square displacement, mm, of the flank under these changes
    moves: float
    #: root mean square displacement, mm, of the flank under the change of the first setting alone
    alone: float
    #: standard deviation of the first setting in this combination due to noise; inf if nothing moves
    spread: float
    #: correlation of the first two settings by the covariance of all changes that are known at least as well
    correlation: float


@dataclass(frozen=True)
class SettingChanges:
    """Changes of M settings that remove measured deviations."""

    #: changes (M,) of the settings
    changes: Array
    #: standard deviations (M,) of the changes due to noise; inf for a setting that others replace exactly
    uncertainties: Array
    #: singular values of the scaled sensitivity
    singular_values: Array
    #: number of directions in which the deviations exceed the noise
    directions: int
    #: standard deviation of a measured deviation, mm
    noise: float
    #: settings that move the flanks exactly as others do together; of these the smallest changes are taken
    alike: tuple[int, ...] = ()
    #: combinations of settings that can replace one another
    exchanges: tuple[Exchange, ...] = ()


def setting_changes(deviations: Array, sensitivity: Array, noise: float | None = None) -> SettingChanges:
    """Compute the changes of settings that remove deviations.

    - `deviations` (N,): mm.
    - `sensitivity` (N, M): displacements, mm per unit of each setting; no column is 0.
    - `noise`: standard deviation of a deviation, mm; by default estimated from the deviations that no setting removes.
    """
    scale = np.sqrt(np.mean(sensitivity**2, axis=0))
    u, sigma, vt = np.linalg.svd(sensitivity / scale, full_matrices=False)
    above_rounding = sigma > MIN_SINGULAR_RATIO * sigma[0]
    # settings in a direction that moves nothing
    alike = np.flatnonzero(np.linalg.norm(vt[~above_rounding], axis=0) > MIN_SETTING_PART)
    u, sigma_real, v = u[:, above_rounding], sigma[above_rounding], vt[above_rounding].T
    # component of the deviations in each direction of the settings
    components = -u.T @ deviations
    if noise is None:
        remaining = deviations + u @ components
        noise = float(np.sqrt(remaining @ remaining / max(len(remaining) - len(components), 1)))
    visible = np.abs(components) > MIN_SIGNAL_SIGMAS * noise
    changes = v @ np.where(visible, components / sigma_real, 0.0) / scale
    uncertainties = noise * np.sqrt(np.sum((v / sigma_real) ** 2, axis=1)) / scale
    uncertainties[alike] = np.inf
    exchanges = _exchanges((sigma, vt), sensitivity, scale, noise)
    return SettingChanges(changes, uncertainties, sigma, int(visible.sum()), noise, tuple(alike.tolist()), exchanges)


def _exchanges(
    decomposition: tuple[Array, Array], sensitivity: Array, scale: Array, noise: float
) -> tuple[Exchange, ...]:
    """Return combinations that leave little of the displacement of their single settings, the least first.

    - `decomposition`: singular values (M,) and right vectors (M, M) of the sensitivity (N, M) over its `scale` (M,)
    - `noise`: mm
    """
    sigma, vt = decomposition
    count = len(sensitivity)
    # directions below rounding have the spread of rounding; they then decide the correlation
    spreads = 1.0 / np.maximum(sigma, MIN_SINGULAR_RATIO * sigma[0])
    exchanges = []
    for number in reversed(range(len(sigma))):
        value, combination = sigma[number], vt[number]
        # a single setting moves the flank by a root mean square of 1 times its part: value / sqrt(count) is the share
        # that is left
        if value / np.sqrt(count) > MAX_EXCHANGE_MOTION:
            break
        by_part = np.argsort(-np.abs(combination))
        members = by_part[np.abs(combination[by_part]) > MIN_SETTING_PART * abs(combination[by_part[0]])]
        if len(members) < 2:
            continue
        first = int(members[0])
        # less certain combinations are excluded: they would hide the correlation in this one
        pair = vt[: number + 1, members[:2]] * spreads[: number + 1, None]
        covariance = pair.T @ pair
        # changes of the other settings that best undo a change of the first one
        other_changes = np.linalg.lstsq(
            sensitivity[:, members[1:]] / scale[members[1:]], -sensitivity[:, first], rcond=None
        )[0]
        changes = np.array([1.0, *(other_changes / scale[members[1:]])])
        moves_nothing = value <= MIN_SINGULAR_RATIO * sigma[0]
        exchanges.append(
            Exchange(
                tuple(members.tolist()),
                changes,
                0.0 if moves_nothing else float(np.sqrt(np.mean((sensitivity[:, members] @ changes) ** 2))),
                float(scale[first]),
                np.inf if moves_nothing else float(noise / value * abs(combination[first]) / scale[first]),
                float(covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])),
            )
        )
    return tuple(exchanges)
