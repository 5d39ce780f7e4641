"""Teeth that run out into a thicker shaft: the hob or milling cutter stops before the shaft, and the root rises along it.

      tip   ______________________________|
                                       .  |  shaft
      root  ____________________ . -      |        radius of the rise: that of the tool at its tip
               face width       |run-out  |

The generating rack then has ends, `tools.stopped_rack`. It slides along the tool's axis, which stands still. Flanks and fillets
are the envelopes of the rack, the root is the envelope of the tool's cylinder; up to the stop they are those of a gear without
run-out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.meridian import CylinderMeridian, Meridian, Values
from gearmesh.records import dataclass
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.rack import RackSurface
from gearmesh.tools.stopped_rack import StoppedRack

#: height of the flanks that run-outs leave, in modules
LEFT_FLANK_MODULES = 0.05
#: Newton steps to the tip along the flank's parameter
MAX_TIP_STEPS = 12
#: places along a run-out at which form points are looked at, and the share by which they reach beyond its end
FORM_SAMPLES = 129
SEARCHED_SHARE = 0.5
#: places nearer to each other are one break
LEAST_BREAK_DISTANCE_MM = 1e-3


@dataclass(frozen=True)
class RunOutRoot:
    """Meridian of the root: a cylinder between the stops, and the tool's envelope beyond them."""

    #: root radius between the stops, mm
    root: float
    #: z of the tool's axis at toe and heel; infinite without a run-out
    stops: tuple[float, float]
    #: envelope of the tool, about z = 0
    tool: CylinderMeridian
    #: no corners
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        low, high = self.stops
        beyond = np.where(a > high, a - high, np.where(a < low, a - low, 0.0))
        rho, slope, bend = self.tool.at(beyond)
        return np.where(beyond == 0.0, self.root, rho), slope, np.where(beyond == 0.0, 0.0, bend)


@dataclass(frozen=True)
class WayOut:
    """Run-outs of a member; lengths in mm, angles in rad."""

    #: radius of the tool at its tip
    tool_radius: float
    #: rolling radius of the teeth
    radius: float
    #: helix angle of the teeth
    helix: float
    #: normal pressure angle of the teeth; the smaller angle of asymmetric teeth
    alpha: float
    #: root radius of the teeth
    root: float
    #: radius of the teeth at the form point; the larger radius of asymmetric teeth
    form: float
    #: tip radius of the teeth
    tip: float
    #: normal module
    module: float
    #: z of both ends of the full depth, the face width apart
    faces: tuple[float, float]
    #: True for toe and heel if the teeth run out there
    ends: tuple[bool, bool]
    #: largest length of a run-out beyond the face width, see `within`
    longest: float = math.inf

    @property
    def tool(self) -> CylinderMeridian:
        """Envelope of the tool at its stop, about z = 0."""
        return CylinderMeridian(self.root + self.tool_radius, self.tool_radius, self.helix)

    @property
    def rise(self) -> float:
        """Rise of the root up to the end face, which leaves next to no flank."""
        return self.tip - self.form - LEFT_FLANK_MODULES * self.module

    @property
    def lead(self) -> float:
        """Distance (mm) of the stop from the full face: helical flanks begin to run out before the root does."""
        height = max(self.tip - self.radius, self.radius - self.root)
        return height / math.tan(self.alpha) * math.sin(abs(self.helix))

    @property
    def length(self) -> float:
        """Length of a run-out beyond the face width, mm."""
        return min(self.lead + self.tool.reaching(self.root + self.rise), self.longest)

    @property
    def stops(self) -> tuple[float, float]:
        """z of the tool's axis at its stops; infinite where the teeth do not run out."""
        (low, high), (toe, heel) = self.faces, self.ends
        return (low - self.lead if toe else -math.inf, high + self.lead if heel else math.inf)

    @property
    def extent(self) -> tuple[float, float]:
        """z of both ends of the teeth, run-outs included."""
        (low, high), (toe, heel) = self.faces, self.ends
        return (low - self.length if toe else low, high + self.length if heel else high)

    @property
    def walls(self) -> tuple[float, float]:
        """Radii at toe and heel above which a shaft is a wall before the teeth; infinite without a run-out."""
        toe, heel = (self.tip if end else math.inf for end in self.ends)
        return toe, heel

    @property
    def level(self) -> Meridian:
        """Level of the root."""
        return Meridian(RunOutRoot(self.root, self.stops, self.tool))

    @property
    def slanted(self) -> tuple[tuple[float, float], ...]:
        """Station z at the root and second surface parameter of the lines over which the curvature of helical teeth jumps."""
        if self.helix == 0.0:
            return ()
        return tuple((stop, stop * math.cos(self.helix)) for stop in self.stops if math.isfinite(stop))

    def breaks(self, sides: Iterable[ToothSide]) -> tuple[float, ...]:
        """Return z where the curvature of root, form curves or tip edges jumps, ascending.

        Across a helical flank the curvature jumps along the tool's normal section, which is no section z = const.
        """
        found = []
        for stop in self.stops:
            if not math.isfinite(stop):
                continue
            found.append(stop)
            on_tool = np.array(stop * math.cos(self.helix))
            for side in sides:
                tip = np.array(side.tip)
                for _ in range(MAX_TIP_STEPS):
                    jet = side.flank.jet(tip, on_tool)
                    rho = math.hypot(jet.r[0], jet.r[1])
                    tip = tip - (rho - self.tip) * rho / float(jet.r[:2] @ jet.r_u[:2])
                places = (side.flank, tip), (side.flank, side.form_point[0]), (side.fillet, side.form_point[1])
                found += [float(surface.jet(np.array(p), on_tool).r[2]) for surface, p in places]
        found.sort()
        low, high = self.extent
        apart = [z for k, z in enumerate(found) if k == 0 or z - found[k - 1] > LEAST_BREAK_DISTANCE_MM]
        return tuple(z for z in apart if low + LEAST_BREAK_DISTANCE_MM < z < high - LEAST_BREAK_DISTANCE_MM)

    def tip_along(self, side: ToothSide) -> Callable[[Array], Array]:
        """Return start values of the flank's parameter at the tip: it falls as the root rises."""
        first, last, height = side.form_point[0], side.tip, self.tip - self.form

        def at(stations: Array) -> Array:
            rise = self.level.at(stations) - self.root
            return last - np.clip(rise / height, 0.0, 1.0) * (last - first)

        return at

    def within(self, racks: Iterable[tuple[RackSurface, float]]) -> WayOut:
        """Return run-outs that end before their flanks do, for racks with the parameter of their form points.

        With a profile shift, and on helical teeth, form points rise faster than the root.
        """
        at, sense = (1, 1.0) if self.ends[1] else (0, -1.0)
        stop, end, face = self.stops[at], self.extent[at], self.faces[at]
        on_tool = np.linspace(stop, end + SEARCHED_SHARE * (end - stop), FORM_SAMPLES) * math.cos(self.helix)
        most, longest = self.tip - LEFT_FLANK_MODULES * self.module, self.longest
        for rack, form in racks:
            points = self.surface(rack).jet(np.full_like(on_tool, form), on_tool).r
            rho, length = np.hypot(points[:, 0], points[:, 1]), sense * (points[:, 2] - face)
            k = int((rho >= most).argmax())
            if k:
                longest = min(longest, float(np.interp(most, rho[k - 1 : k + 1], length[k - 1 : k + 1])))
        return replace(self, longest=longest)

    @property
    def fault(self) -> str:
        """Reason why the tool does not fit the teeth; empty if it fits."""
        if self.tool_radius <= self.tip - self.root:
            return "the tool is smaller than the teeth are deep"
        width = self.faces[1] - self.faces[0]
        # the middle of the teeth, run-outs included, has full depth
        if self.length >= width and self.ends[0] != self.ends[1]:
            return f"the teeth run out over {self.length:.4g} mm, longer than the face width of {width:.6g} mm"
        return ""

    def surface(self, rack: RackSurface) -> Envelope:
        """Return the surface that a rack with these ends generates."""
        c, s = math.cos(self.helix), math.sin(self.helix)
        low, high = (stop * c for stop in self.stops)
        axis = self.root + self.tool_radius - self.radius
        tool = StoppedRack(rack, axis, self.tool_radius, (low, high), self.radius * s**2)
        return Envelope(tool, RackRoll(self.radius * c**2, -self.radius * s * c))
