"""Points of a surface at given stations."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.stations import follow
from gearmesh.kinds import Jet, PlaneLevel

pytestmark = pytest.mark.quick


class Ending:
    """z = v for p <= 1; beyond it ends at v = 3, or has no points from p = 2 on, and waves from p = 3 on without reaching z > 2."""

    def jet(self, p: Array, v: Array) -> Jet:
        p, v = np.broadcast_arrays(np.asarray(p, dtype=float), np.asarray(v, dtype=float))
        z, slope = np.where(p < 3.0, v, np.sin(v) + 1.0), np.where(p < 3.0, 1.0, np.cos(v))
        z = np.where((p < 2.0) | (p >= 3.0), z, np.nan)
        z = np.where((p > 1.0) & (p < 2.0) & (v > 3.0), np.nan, z)
        zero = np.zeros_like(z)
        r, n = np.stack((p, zero, z), axis=-1), np.zeros((*z.shape, 3))
        return Jet(r, n, n, np.stack((zero, zero, slope), axis=-1), n, n)


def test_points_that_have_no_station_cost_the_others_nothing() -> None:
    p = np.array([0.0, 0.5, 1.5, 2.5, 3.5, 3.6])
    found = follow(Ending(), p, np.array([5.0, -7.0, 5.0, 5.0, 5.0, 1.7]), PlaneLevel(0.0))
    assert found.converged.tolist() == [True, True, False, False, False, True]
    np.testing.assert_allclose(found.jet.r[[0, 1, 5], 2], [5.0, -7.0, 1.7], rtol=0, atol=1e-12)
    assert found.status[3] == Status.NOT_FINITE
    assert found.iterations < 40
