"""[AB] aligned and misaligned, from the printed settings by a third computation, which settles the text's "8 to 7 sec"."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import swept_cones
from oracles.built import pair_of
from oracles.places import SAMPLES

from gearmesh import load
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC


@pytest.mark.parametrize("axial", [0.0, -0.05])
@pytest.mark.parametrize(("side", "last"), [("concave", -18.0), ("convex", 18.0)])
@pytest.mark.sweep_cases("concave--18.0--0.05", "concave--18.0-0.0", "convex-18.0-0.0")
def test_contact_is_that_of_swept_cones(side: str, last: float, axial: float) -> None:
    """The printed settings define phi1 = 0 and phi2 = 0: both members are as cut at cradle rotation 0."""
    design = load(
        SAMPLES / "spiral_bevel_abdullah_straight.toml", [f"contact.side=pinion_{side}", f"assembly.dA={axial}"]
    )
    phi1 = np.radians([0.0, 0.5 * last, last])
    exact, swept = contact_path(solver_pair(pair_of(design)), phi1, edges=False), swept_cones.contact(side, phi1, axial)
    np.testing.assert_allclose(exact.te / ARCSEC, swept.transmission_error / ARCSEC, rtol=0, atol=1e-6)
    np.testing.assert_allclose(exact.phi2 / ARCSEC, swept.phi2 / ARCSEC, rtol=0, atol=1e-6)
    np.testing.assert_allclose(exact.point, swept.points, rtol=0, atol=1e-8)
