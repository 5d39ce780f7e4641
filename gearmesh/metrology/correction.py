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
#: standard deviations of the noise by which a direction must show
SIGNIFICANT = 2.0


@dataclass(frozen=True)
class SettingChanges:
    """Changes (M,) of settings and their standard deviations (M,) by the noise (mm), of all directions that are not rounding;
    `singular_values` of the scaled sensitivity, and how many `directions` of it the deviations show; `alike`: settings that move
    the flanks as others do together, so that only the smallest changes are known."""

    changes: Array
    uncertainties: Array
    singular_values: Array
    directions: int
    noise: float
    alike: tuple[int, ...] = ()


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
    return SettingChanges(changes, uncertainties, sigma, int(shown.sum()), noise, tuple(alike.tolist()))
