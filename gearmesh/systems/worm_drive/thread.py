"""Threads of worms and hobs: flanks of the five forms of ISO 10828, roundings, form points and run-outs.

Frame: axis z, with the thread centred on +x at z = 0. Threads turned by pi / z1 are in the positions of the spaces.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.helicoid import GeneratingCurve, Helicoid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.meridian import Values
from gearmesh.records import dataclass
from gearmesh.systems.common.standards.iso10828 import ThreadForm
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, RackLine
from gearmesh.tools.worm_threads import DiskLine, PlaneEdge, TransverseInvolute

#: largest number of Newton or secant steps
MAX_ROOT_STEPS = 60
#: relative residual at which a root is accepted
ROOT_TOLERANCE = 1e-13
#: step (modules) between the first two points of the secant method
PARAMETER_STEP = 1e-6
#: range, in depths of root or tip either way, in which a flank is followed to a rounding
SEARCH_DEPTHS = 4.0
#: number of steps in this range, each way
SEARCH_STEPS = 64
#: profile parameter of a rounding where it touches root or tip cylinder
LAND_PARAMETER = 0.5 * math.pi


@dataclass(frozen=True)
class DiskGrinding:
    """Disk that grinds ZK and ZC flanks."""

    #: radius of the disk at its rim, mm
    disk_radius: float
    #: radius of its profile, mm
    profile_radius: float
    #: depth to which the rim reaches below the reference cylinder, mm
    depth: float


@dataclass(frozen=True)
class Rounding:
    """A rounding in the axial section of a thread."""

    #: profile of the rounding
    arc: Arc
    #: parameters of flank and rounding where they touch
    form_point: tuple[float, float]


@dataclass(frozen=True)
class WormThread:
    """Threads of a worm or hob."""

    #: flank form
    form: ThreadForm
    #: number of threads
    threads: int
    #: +1 right-hand, -1 left-hand
    hand: int
    #: axial module, mm
    module: float
    #: radius of the reference cylinder, mm
    radius: float
    #: pressure angle in the section of the form, rad
    angle: float
    #: axial thickness on the reference cylinder, mm
    thickness: float
    #: disk that grinds ZK and ZC flanks
    grinding: DiskGrinding | None = None
    #: distance by which each flank is set back from the position with this thickness, axial, mm
    thinner: float = 0.0
    #: True if a ZN flank is straight in the normal section of the thread, not of the space
    across_thread: bool = False

    @property
    def screw(self) -> float:
        """Axial advance P, mm/rad."""
        return 0.5 * self.module * self.threads

    @property
    def lead_angle(self) -> float:
        return self.lead_angle_at(self.radius)

    def lead_angle_at(self, radius: float) -> float:
        """Return the lead angle (rad) on a cylinder of a radius (mm)."""
        return math.atan2(self.screw, radius)

    @property
    def axial_pitch(self) -> float:
        return math.pi * self.module

    @property
    def normal_angle(self) -> float:
        """Pressure angle in the normal section, rad: that of the tool except for ZA."""
        if self.form is not ThreadForm.ZA:
            return self.angle
        return math.atan(math.tan(self.angle) * math.cos(self.lead_angle))

    @property
    def base_radius(self) -> float:
        """Radius of the base cylinder of a ZI worm, mm: r cos(alpha_t) with tan(alpha_t) = tan(alpha_n) / sin(gamma)."""
        return self.radius * math.cos(self._transverse_angle)

    @property
    def _transverse_angle(self) -> float:
        """Transverse pressure angle, rad."""
        return math.atan(math.tan(self.normal_angle) / math.sin(self.lead_angle))

    @property
    def curve(self) -> GeneratingCurve:
        """Curve that sweeps the right-hand flank towards +z, without `thinner`."""
        return _curve_of(replace(self, thinner=0.0, hand=1))

    def solved_curve(self) -> GeneratingCurve:
        """Return the curve, with the position of the tool that gives the thickness."""
        half = 0.5 * self.thickness
        if self.form is ThreadForm.ZA:
            return PlaneEdge(RackLine(self.angle, 0.0, half), self.radius, self.screw)
        if self.form is ThreadForm.ZI:
            angle = self._transverse_angle
            return TransverseInvolute(self.base_radius, self.screw, angle - math.tan(angle), half)
        # ZN, ZK, ZC: the tool is moved until the half thickness on the reference cylinder is right, by the secant
        # method
        normal = half * math.cos(self.lead_angle)
        space = 0.5 * self.axial_pitch * math.cos(self.lead_angle) - normal
        start = normal if self.across_thread else -space

        def miss(b: float) -> float:
            section = Helicoid(self._by_tool(b), self.screw)
            return float(section.axial_section(np.array(_at_radius(section, self.radius, self.start)))[0][1]) - half

        return self._by_tool(_root(miss, start, PARAMETER_STEP * self.module))

    def _by_tool(self, b: float) -> GeneratingCurve:
        """Return the curve of ZN, ZK and ZC whose tool's profile is at y = -b (mm) on the reference cylinder."""
        profile: Profile = RackLine(self.angle, 0.0, b)
        middle = 0.0 if self.across_thread else 0.5 * self.axial_pitch
        if self.form is ThreadForm.ZN:
            return PlaneEdge(profile, self.radius, self.screw, self.lead_angle, middle)
        assert self.grinding is not None
        tool = self.grinding
        if self.form is ThreadForm.ZC:
            s, c = math.sin(self.angle), math.cos(self.angle)
            profile = Arc((tool.profile_radius * s, -b - tool.profile_radius * c), -tool.profile_radius)
        distance = self.radius - tool.depth + tool.disk_radius
        return DiskLine(profile, self.radius, self.screw, self.lead_angle, middle, distance)

    @property
    def section(self) -> Helicoid:
        """Right-hand flank towards +z."""
        return Helicoid(self.curve, self.screw, lift=-self.thinner)

    def flank(self, side: int, outward: int = 1) -> Helicoid:
        """Right (+1) or left (-1) flank of the thread; its normal points out of the thread (1) or into it (-1)."""
        return self.place(self.section, side, outward)

    def place(self, surface: Helicoid, side: int, outward: int = 1) -> Helicoid:
        """Return a surface of the right-hand flank towards +z, placed on a side of threads of this hand."""
        signs = (1.0, float(side), float(side * self.hand))
        return replace(surface, screw=self.hand * self.screw, signs=signs, outward=float(outward))

    def form_radius(self, rounding: Rounding) -> float:
        """Return the radius at which flank and a rounding meet, mm."""
        point = self.section.curve.at(np.array(rounding.form_point[0]))
        return float(np.hypot(point.c[0], point.c[1]))

    def rounding_surface(self, rounding: Rounding, side: int, outward: int = 1) -> Helicoid:
        """Return the surface of a rounding on a side of the threads."""
        return self.place(Helicoid(PlaneEdge(rounding.arc, self.radius, self.screw), self.screw), side, outward)

    @property
    def start(self) -> float:
        """Profile parameter near the reference cylinder."""
        if self.form is ThreadForm.ZI:
            return math.tan(self._transverse_angle)
        return self.angle if self.form is ThreadForm.ZC else 0.0

    def at_radius(self, radius: float) -> float:
        """Return the profile parameter of the flank's point at a radius (mm); NaN if it has none."""
        if self.form is ThreadForm.ZI:
            ratio = radius / self.base_radius
            return math.sqrt(ratio**2 - 1.0) if ratio >= 1.0 else math.nan
        return _at_radius(self.section, radius, self.start)

    def half_thickness(self, radius: float) -> float:
        """Return half the axial thickness of the thread at a radius (mm), mm."""
        p = np.array(self.at_radius(radius))
        return float(self.section.axial_section(p)[0][1])

    def root_rounding(self, land: float, radius: float) -> Rounding:
        """Return the rounding of `radius` (mm) between the flank and the cylinder `land` (mm) below it.

        Raises DesignError.
        """
        return _rounding_of(self, land, radius, -1)

    def tip_rounding(self, land: float, radius: float) -> Rounding:
        """Return the rounding of `radius` (mm) between the flank and the cylinder `land` (mm) above it.

        Raises DesignError.
        """
        return _rounding_of(self, land, radius, 1)

    def solved_rounding(self, land: float, radius: float, convex: int) -> Rounding:
        """Return the rounding that touches the flank and the cylinder `land` (mm).

        Its centre is on the flank's parallel curve at the height of the centre over the cylinder. The only solution is
        on the sheet of the flank that passes through the reference cylinder. This sheet ends nearest to the axis in a
        cusp, like an involute on its base cylinder. Raises DesignError if the flank does not reach the rounding.
        """
        section, level = self.section, land - convex * radius

        def over(p: Array) -> Array:
            """Return the height of the parallel curve over the rounding's centre."""
            points, normals = section.axial_section(p)
            return np.asarray(points[..., 0] - convex * radius * normals[..., 0] - level)

        def slope(p: Array) -> Array:
            """Return the derivative of the distance from the axis by p."""
            at = section.curve.at(p)
            return np.asarray((at.c * at.c_p)[..., :2].sum(axis=-1) / np.hypot(at.c[..., 0], at.c[..., 1]))

        rate = float(slope(np.array(self.start)))
        stations = self.start + SEARCH_DEPTHS * (land - self.radius) / rate * np.linspace(
            -1.0, 1.0, 2 * SEARCH_STEPS + 1
        )
        # beyond its end the flank may not exist; `first` to `last` are the stations of the sheet, which ends in a cusp
        with np.errstate(all="ignore"):
            heights, rises = over(stations), slope(stations) * rate
            ends = np.flatnonzero(~(rises > 0.0))
            first = int(ends[ends < SEARCH_STEPS].max(initial=-1)) + 1
            last = int(ends[ends > SEARCH_STEPS].min(initial=len(stations))) - 1
            if last + 1 < len(stations) and math.isfinite(rises[last + 1]):
                last += 1
                stations[last] = bracketed_root(lambda p, _: slope(p), *stations[last - 1 : last + 1, None]).values[0]
                heights[last] = over(stations[last])
        # of several crossings the outermost is the physical one
        crossings = np.flatnonzero(heights[first:last] * heights[first + 1 : last + 1] <= 0.0)
        if not crossings.size:
            raise DesignError("rounding", radius, unit="mm", reason="the flank does not reach it")
        i = first + int(crossings[-1])
        p = bracketed_root(lambda p, _: over(p), *stations[i : i + 2, None]).values
        points, normals = section.axial_section(p)
        x, z = (points - convex * radius * normals)[0].tolist()
        form_point = (float(p[0]), math.atan2(*normals[0].tolist()))
        return Rounding(Arc((x - self.radius, -z), convex * radius), form_point)


@dataclass(frozen=True)
class RunOut:
    """Run-outs: beyond the thread's length the tool is withdrawn, and the root rises towards the tip.

           tip  ______________________
                                  .  |     height: until next to no flank is left
           root ________________.----+
                       half     | run-out

    Roundings and flanks move away from the axis with the root. Its meridian rises with the third power of the distance,
    so that the curvature is continuous where it begins. It is one piece without corners.
    """

    #: root radius of the full thread, mm
    root: float
    #: half the length of the full thread, mm
    half: float
    #: length of either run-out, mm
    length: float
    #: rise of the root at the end of the run-out, mm
    height: float
    #: corners of the meridian: none
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        """Return the radius of the root at `a` (...,), mm, and its first two derivatives."""
        rise, slope, bend = self.rise(a)
        return self.root + rise, slope, bend

    def rise(self, z: Array) -> Values:
        """Return the rise (mm) at z (...,), mm, and its first two derivatives."""
        share = np.maximum(np.abs(z) - self.half, 0.0) / self.length
        steep = 3.0 * self.height / self.length
        return self.height * share**3, np.sign(z) * steep * share**2, 2.0 * steep / self.length * share


@lru_cache(maxsize=16)
def _curve_of(thread: WormThread) -> GeneratingCurve:
    """Return the curve of a thread, cached: a build needs it several times."""
    return thread.solved_curve()


@lru_cache(maxsize=16)
def _rounding_of(thread: WormThread, land: float, radius: float, convex: int) -> Rounding:
    """Return the rounding of a thread, cached: both flanks and every face width and addendum that is tried need it."""
    return thread.solved_rounding(land, radius, convex)


def _at_radius(surface: Helicoid, radius: float, start: float) -> float:
    """Return the parameter of the point of a helicoid's curve at a radius (mm), by Newton's method; NaN if it has none."""
    p = start
    for _ in range(MAX_ROOT_STEPS):
        point = surface.curve.at(np.array(p))
        rho = math.hypot(point.c[0], point.c[1])
        slope = float(point.c[:2] @ point.c_p[:2]) / rho
        step = (rho - radius) / slope if slope else math.nan
        p -= step
        if not abs(rho - radius) > ROOT_TOLERANCE * radius:
            return p if math.isfinite(p) else math.nan
    return math.nan


def _root(f: Callable[[float], float], start: float, step: float) -> float:
    """Return the root of a smooth function near a start, by the secant method; NaN if it is not found."""
    a, b = start, start + step
    f_a, f_b = f(a), f(b)
    for _ in range(MAX_ROOT_STEPS):
        if not math.isfinite(f_b):
            return math.nan
        if abs(f_b) <= ROOT_TOLERANCE * max(1.0, abs(b)) or f_b == f_a:
            return b
        a, b, f_a = b, b - f_b * (b - a) / (f_b - f_a), f_b
        f_b = f(b)
    return b if abs(f_b) <= 1e-10 else math.nan
