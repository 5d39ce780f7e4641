"""[AB] misaligned: the text's "8 to 7 sec" at dA = -0.05 mm settled by a third computation from the printed settings."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES
from oracles.swept_cones import transmission_error

from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.systems.designs import load


@pytest.mark.parametrize(("side", "last"), [("concave", -18.0), ("convex", 18.0)])
def test_transmission_error_is_that_of_swept_cones(side: str, last: float) -> None:
    design = load(SAMPLES / "spiral_bevel_abdullah_straight.toml", [f"contact.side=pinion_{side}", "assembly.dA=-0.05"])
    phi1 = np.radians([0.0, 0.5 * last, last])
    exact = contact_path(solver_pair(pair_of(design)), phi1, edges=False).te
    np.testing.assert_allclose(exact / ARCSEC, transmission_error(side, phi1, axial=-0.05) / ARCSEC, rtol=0, atol=0.02)
