"""Critical section of a tooth root: chord, lever and radius of the fillet at the tangent of 30 deg.

The section is normal to the tooth trace, through the middle of the tooth at the reference cylinder. x is along the
tooth's middle, and e across it:

        |   /  flank
        |  /
    x ^ | /.   tangent at 30 deg to x (60 deg on an internal tooth)
      | |(     chord s_Fn between both sides, radius rho_F of the contour
        +---> e

Section and angle are those of [ISO 6336-3 6.2], which replaces the tooth by a spur gear with z_n teeth. For spur gears
both agree. The lever h_F belongs to a force on the flank at the outer point of single contact. It is measured from
where the line of the force crosses x.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.curvature import shape_operator, tangent_basis
from gearmesh.kernel.surface.levels import SlantedLevel
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, involute
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: angle of the tangent for external teeth [ISO 6336-3]
TANGENT_ANGLE_DEG = 30.0
#: angle of the tangent for internal teeth [ISO 6336-3]
INTERNAL_TANGENT_ANGLE_DEG = 60.0


@dataclass(frozen=True)
class CriticalSection:
    """Critical section of a root; NaN if no tangent of the fillet has the angle."""

    #: chord s_Fn, mm
    chord: float
    #: distance of the chord's middle from the axis, mm
    radius: float
    #: radius of the fillet at the chord's ends, mm
    fillet_radius: float


def normal_section(beta: float) -> SlantedLevel:
    """Return the level of the plane normal to the tooth trace, through the middle of the tooth.

    The middle is taken at the reference cylinder. Stations are y sin(beta) + z cos(beta), mm.
    """
    return SlantedLevel(np.array([0.0, math.sin(beta), math.cos(beta)]), np.zeros(3))


def critical_section(tooth: Tooth, teeth: Toothing, which: Side = Side.RIGHT) -> CriticalSection:
    """Return the critical section, where the tangent of a fillet has the angle of the standard.

    The fillet of the side `which` is searched between its form point and the root land. Teeth of this section have both sides
    alike: half of its chord is the distance of the tangent's point from the middle of the tooth.
    """
    plane = normal_section(teeth.beta)
    side = tooth.side(which)
    wanted = math.radians(INTERNAL_TANGENT_ANGLE_DEG if teeth.internal else TANGENT_ANGLE_DEG)

    def jet(q: Array) -> Jet:
        return along(side.fillet, q, np.zeros_like(q), plane)[1]

    def excess(q: Array, _: NDArray[np.intp]) -> Array:
        direction = cross(np.broadcast_to(plane.normal, (*q.shape, 3)), jet(q).n)
        return np.arctan2(_across(plane, direction), np.abs(direction[..., 0])) - wanted

    # the tangent turns from the flank's direction to the root's, so that one root lies between form point and root land
    sections = tooth.sections([0.5])
    form_point = (sections.right if which is Side.RIGHT else sections.left).form_point_fillet
    roots = bracketed_root(excess, form_point, np.full_like(form_point, side.root))
    if not roots.converged[0]:
        return CriticalSection(math.nan, math.nan, math.nan)
    there = jet(roots.values)
    point = there.r[0]
    return CriticalSection(2.0 * math.hypot(*point[1:]), float(point[0]), float(_contour_radius(plane, there)[0]))


def _across(plane: SlantedLevel, direction: Array) -> Array:
    """Return the lengths (...,), without sign, of vectors (..., 3) of the plane across the middle of the tooth."""
    e = np.array([0.0, plane.normal[2], -plane.normal[1]])
    length: Array = np.abs(direction @ e)
    return length


def _contour_radius(plane: SlantedLevel, jet: Jet) -> Array:
    """Return the radius of curvature (...,) of the contour in which a plane cuts a surface.

    It is positive where the contour is hollow. By Meusnier's theorem it is the radius of the normal section times the
    sine of the angle between plane and tangent plane.
    """
    e1, e2 = tangent_basis(jet)
    k = shape_operator(jet, e1, e2)
    along_contour = cross(np.broadcast_to(plane.normal, jet.n.shape), jet.n)
    slant = np.linalg.norm(along_contour, axis=-1)
    t = np.stack((dot(along_contour, e1), dot(along_contour, e2)), axis=-1) / slant[..., None]
    # curvature of the normal section along the contour
    normal_curvature = np.einsum("...i,...ij,...j->...", t, k, t)
    radius: Array = slant / normal_curvature
    return radius


def lever(line: LineOfAction, number: int, section: CriticalSection) -> float:
    """Return the lever h_F (mm) of a force at the outer point of single contact [ISO 6336-3 6.2, B].

    The lever is measured from the chord of the critical section.
    """
    teeth = line.members[number]
    radius, base, angle = _load(line, number)
    # the line of action through this point crosses the tooth's middle
    crossing = base / math.cos(angle)
    return teeth.sense * (crossing - radius + teeth.radius - section.radius)


def load_angle(line: LineOfAction, number: int) -> float:
    """Return the angle alpha_Fen, rad, of this force to the normal of the tooth's middle [ISO 6336-3 6.2]."""
    return _load(line, number)[2]


def _load(line: LineOfAction, number: int) -> tuple[float, float, float]:
    """Return reference and base radius of the virtual spur gear, mm, and the angle of a force at its outer point of
    single contact, rad.

    The tooth's virtual spur gear has z_n = z / (cos(beta_b)^2 cos(beta)) teeth. The active flank ends at the tip of its
    own gear or at the mating gear's fillet.
    """
    teeth = line.members[number]
    beta_b = teeth.beta_b
    # reference, base and tip circle of the virtual spur gear, and its contact ratio
    radius = 0.5 * teeth.module * teeth.teeth / (math.cos(beta_b) ** 2 * math.cos(teeth.beta))
    base = radius * math.cos(teeth.alpha)
    ratio = line.contact_ratio / math.cos(beta_b) ** 2
    tip = radius - teeth.radius + math.hypot(teeth.base_radius, line.active(number)[1])
    pitch = math.pi * teeth.module * math.cos(teeth.alpha)
    # outer point of single contact: its roll length is contact ratio - 1 base pitches inside the tip
    length = math.sqrt(max(0.0, tip**2 - base**2)) - teeth.sense * max(0.0, ratio - 1.0) * pitch
    pressure = math.atan2(length, base)
    half = 0.5 * teeth.thickness / radius + teeth.sense * (involute(teeth.alpha) - involute(pressure))
    return radius, base, pressure - teeth.sense * half
