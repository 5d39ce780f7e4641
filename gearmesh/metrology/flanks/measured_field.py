"""Deviations over a flank as its measured teeth have them: how far the smooth real flank is from the nominal one, anywhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.metrology.flanks.measured_flank import MeasuredFlank
from gearmesh.teeth.micro_geometry.deviations import deviating_tooth
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: shares beyond what was measured that still count to it
EDGE = 1e-6


@dataclass(frozen=True)
class MeasuredField:
    """Deviations of one side of a `real` tooth from a `nominal` one, whose parameters it has, over what was measured: `extent`, the
    first and last shares from form point to tip and from toe to heel."""

    nominal: Tooth
    real: Tooth
    side: Side
    extent: tuple[tuple[float, float], tuple[float, float]]

    @staticmethod
    def of(tooth: Tooth, side: Side, flank: MeasuredFlank) -> MeasuredField:
        """Of a nominal tooth and what was measured of its flank. Raises DesignError where that makes no tooth."""
        on = np.isfinite(flank.deviations)
        s, t = (np.clip(share[on], 0.0, 1.0) for share in (flank.feet.s, flank.feet.t))
        extent = (float(s.min()), float(s.max())), (float(t.min()), float(t.max()))
        return MeasuredField(tooth, deviating_tooth(tooth, {side: flank.grid}), side, extent)

    def at(self, s: Array, t: Array) -> Array:
        """Deviations (...,), mm, at shares (...,); NaN where nothing was measured."""
        s, t = np.broadcast_arrays(s, t)
        (us, i), (ut, j) = (np.unique(x, return_inverse=True) for x in (s, t))
        parameters = self.nominal.flank_grid(self.side, us, ut).parameters[i.ravel(), j.ravel()]
        nominal, real = (tooth.side(self.side).flank.jet(*parameters.T) for tooth in (self.nominal, self.real))
        d = dot(real.r - nominal.r, nominal.n).reshape(s.shape)
        inside = np.ones(s.shape, dtype=bool)
        for x, (first, last) in zip((s, t), self.extent, strict=True):
            inside &= (x >= first - EDGE) & (x <= last + EDGE)
        return np.where(inside, d, np.nan)
