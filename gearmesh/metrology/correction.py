"""Changes of machine settings that take measured deviations away, by least squares on how the flank follows each of them:

    d + J x = 0,    J_ij = d n_i / d x_j

d: deviations along the normals, J x: displacements of the flank along them by changes x of the settings. Directions of x that the
noise of d hides stay as they are (truncated singular value decomposition of J, each column over its root mean square).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: singular values below this part of the largest are rounding
ROUNDING = 1e-7
#: part of a setting in combinations that move nothing, from which on it counts
PART = 0.1
#: part of the displacement by single settings that a combination leaves, below which its settings can stand for one another
EXCHANGED = 0.05
#: standard deviations of the noise by which a direction must show
SIGNIFICANT = 2.0


@dataclass(frozen=True)
class Exchange:
    """Settings that can stand for one another: changed together, they hardly move the flank.

    `settings` (K,): numbers of those with a part in it, the largest first; `changes` (K,): their changes when the first changes by
    1; `moves`, `alone`: root mean square (mm) by which the flank then moves, and by which it does by the first setting alone;
    `spread`: standard deviation of the first by the noise, in this combination, infinite where nothing moves; `correlation` of the
    first two settings by the covariance of all changes that are known at least as well.
    """

    settings: tuple[int, ...]
    changes: Array
    moves: float
    alone: float
    spread: float
    correlation: float


@dataclass(frozen=True)
class SettingChanges:
    """Changes (M,) of settings and their standard deviations (M,) by the noise (mm), infinite where other settings move the flank
    alike; `singular_values` of the scaled sensitivity, and how many `directions` of it the deviations show; `alike`: settings that
    move the flanks as others do together, so that only the smallest changes are known; `exchanges`: what stands for what."""

    changes: Array
    uncertainties: Array
    singular_values: Array
    directions: int
    noise: float
    alike: tuple[int, ...] = ()
    exchanges: tuple[Exchange, ...] = ()


def setting_changes(deviations: Array, sensitivity: Array, noise: float | None = None) -> SettingChanges:
    """For deviations (N,), mm, and displacements (N, M), mm per unit of each setting, none of them all 0.

    `noise`: standard deviation of a deviation, mm; by default that of what no setting takes away.
    """
    scale = np.sqrt(np.mean(sensitivity**2, axis=0))
    u, sigma, vt = np.linalg.svd(sensitivity / scale, full_matrices=False)
    real = sigma > ROUNDING * sigma[0]
    alike = np.flatnonzero(np.linalg.norm(vt[~real], axis=0) > PART)
    u, sigma_real, v = u[:, real], sigma[real], vt[real].T
    parts = -u.T @ deviations
    if noise is None:
        rest = deviations + u @ parts
        noise = float(np.sqrt(rest @ rest / max(len(rest) - len(parts), 1)))
    shown = np.abs(parts) > SIGNIFICANT * noise
    changes = v @ np.where(shown, parts / sigma_real, 0.0) / scale
    uncertainties = noise * np.sqrt(np.sum((v / sigma_real) ** 2, axis=1)) / scale
    uncertainties[alike] = np.inf
    exchanges = _exchanges((sigma, vt), sensitivity, scale, noise)
    return SettingChanges(changes, uncertainties, sigma, int(shown.sum()), noise, tuple(alike.tolist()), exchanges)


def _exchanges(
    decomposition: tuple[Array, Array], sensitivity: Array, scale: Array, noise: float
) -> tuple[Exchange, ...]:
    """Combinations that leave little of what their settings do alone, the least first.

    `decomposition`: singular values (M,) and right vectors (M, M) of the sensitivity (N, M) over its `scale` (M,); `noise`: mm.
    """
    sigma, vt = decomposition
    count = len(sensitivity)
    # what is below rounding has the spread of rounding, which settles the correlation
    spreads = 1.0 / np.maximum(sigma, ROUNDING * sigma[0])
    exchanges = []
    for number in reversed(range(len(sigma))):
        value, combination = sigma[number], vt[number]
        # each setting alone moves the flank by a root mean square of 1, times its part
        if value / np.sqrt(count) > EXCHANGED:
            break
        order = np.argsort(-np.abs(combination))
        taking = order[np.abs(combination[order]) > PART * abs(combination[order[0]])]
        if len(taking) < 2:
            continue
        first = int(taking[0])
        # combinations that are known worse would hide how both go together in this one
        pair = vt[: number + 1, taking[:2]] * spreads[: number + 1, None]
        covariance = pair.T @ pair
        others = np.linalg.lstsq(sensitivity[:, taking[1:]] / scale[taking[1:]], -sensitivity[:, first], rcond=None)[0]
        changes = np.array([1.0, *(others / scale[taking[1:]])])
        none = value <= ROUNDING * sigma[0]
        exchanges.append(
            Exchange(
                tuple(taking.tolist()),
                changes,
                0.0 if none else float(np.sqrt(np.mean((sensitivity[:, taking] @ changes) ** 2))),
                float(scale[first]),
                np.inf if none else float(noise / value * abs(combination[first]) / scale[first]),
                float(covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])),
            )
        )
    return tuple(exchanges)
