r"""Rack cutters with ends: beyond a place along the tooth trace each profile point follows a circle about the tool's axis.

A hob or a multi-rib cutter that has stopped at the end of its feed is a rack in the normal section through its axis. Beside
that section its ribs recede from the blank:

      x ^        o  tool's axis, square to the trace, at the tool's radius over its tip
        |       /|
        |      / |  rho = axis - x of the profile point
        |   __/  |
        |_______ |____ profile point
        +------------> trace
                stop

While the tool is fed it leaves the straight part, at its stop the curved part. Both have the same tangent planes at the stop.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.tools.rack import RackSurface


@dataclass(frozen=True)
class StoppedRack:
    """Surface of a rack cutter with ends; parameters (p, v): profile parameter and length along the trace, mm."""

    #: the rack
    rack: RackSurface
    #: height of the tool's axis over the pitch plane, mm
    axis: float
    #: radius of the tool at its tip, mm; beyond a stop v is the length along the circle of the tip
    tool_radius: float
    #: v of the stops, the smaller one first; infinite without a stop
    stops: tuple[float, float]
    #: height of the rack's frame in the frame of the surface, mm
    raised: float = 0.0

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        (x_axis, y_axis), trace = self.rack.directions
        points, tangents, normals, turned = self.rack.profile.section(u)
        low, high = self.stops
        stop = np.where(v > high, high, np.where(v < low, low, v))
        # turn about the tool's axis, which takes the profile's x axis and the trace to `radial` and `onward`
        angle = (v - stop) / self.tool_radius
        s, c = np.sin(angle)[..., None], np.cos(angle)[..., None]
        radial, onward = c * x_axis - s * trace, s * x_axis + c * trace
        rho = self.axis - points[..., :1]
        turning = np.where(angle == 0.0, 0.0, 1.0 / self.tool_radius)[..., None]

        def lift(plane: Array) -> Array:
            return np.asarray(plane[..., :1] * radial + plane[..., 1:] * y_axis)

        return Jet(
            (self.axis + self.raised) * x_axis - rho * radial + points[..., 1:] * y_axis + stop[..., None] * trace,
            lift(normals),
            lift(tangents),
            np.where(angle[..., None] == 0.0, trace, rho / self.tool_radius * onward),
            lift(turned),
            -turning * normals[..., :1] * onward,
        )
