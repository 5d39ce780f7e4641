"""Deviations over a flank of measured teeth: distance of the smooth real flank from the nominal flank, at any place."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.metrology.flanks.measured_flank import MeasuredFlank
from gearmesh.records import dataclass
from gearmesh.teeth.micro_geometry.deviations import deviating_tooth
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: shares beyond the measured extent within which a place still belongs to it
EDGE_TOLERANCE = 1e-6


@dataclass(frozen=True)
class MeasuredField:
    """Deviations of one side of a real tooth from a nominal tooth, over the measured extent."""

    #: nominal tooth
    nominal: Tooth
    #: tooth with the measured flank; it has the parameters of the nominal tooth
    real: Tooth
    #: measured side
    side: Side
    #: first and last measured share, from form point to tip and from toe to heel
    extent: tuple[tuple[float, float], tuple[float, float]]

    @staticmethod
    def of(tooth: Tooth, side: Side, flank: MeasuredFlank) -> MeasuredField:
        """Return the deviations of a measured flank of a nominal tooth. Raises DesignError if the flank makes no
        tooth."""
        on = np.isfinite(flank.deviations)
        s, t = (np.clip(share[on], 0.0, 1.0) for share in (flank.feet.s, flank.feet.t))
        extent = (float(s.min()), float(s.max())), (float(t.min()), float(t.max()))
        return MeasuredField(tooth, deviating_tooth(tooth, {side: flank.grid}), side, extent)

    def at(self, s: Array, t: Array) -> Array:
        """Return deviations (...,), mm, at shares (...,); NaN where nothing was measured."""
        s, t = np.broadcast_arrays(s, t)
        (us, i), (ut, j) = (np.unique(x, return_inverse=True) for x in (s, t))
        parameters = self.nominal.flank_grid(self.side, us, ut).parameters[i.ravel(), j.ravel()]
        nominal, real = (tooth.side(self.side).flank.jet(*parameters.T) for tooth in (self.nominal, self.real))
        d = dot(real.r - nominal.r, nominal.n).reshape(s.shape)
        inside = np.ones(s.shape, dtype=bool)
        for x, (first, last) in zip((s, t), self.extent, strict=True):
            inside &= (x >= first - EDGE_TOLERANCE) & (x <= last + EDGE_TOLERANCE)
        return np.where(inside, d, np.nan)
