"""The root of a tooth where it breaks: chord, lever and fillet at the tangent of 30 deg, on the fillet that the tool leaves.

In the normal section through the middle of the tooth at the reference cylinder, the plane across the tooth trace there, x along the
tooth's middle and e across it:

        |   /  flank
        |  /
    x ^ | /.   tangent at 30 deg to x (60 deg on an internal tooth): chord s_Fn between both sides, radius rho_F of the contour
      | |(
        +---> e

The same section and angle as [ISO 6336-3 6.2], which puts a spur gear of z_n teeth in its place; on spur gears both are one. The
lever h_F is that of a force on the flank at the outer point of single contact, from where its line crosses x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.curvature import shape_operator, tangent_basis
from gearmesh.kernel.surface.levels import SlantedLevel
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, involute
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction
from gearmesh.teeth.tooth import Tooth

#: angle of the tangent, deg, of external and internal teeth [ISO 6336-3]
TANGENT, TANGENT_INTERNAL = 30.0, 60.0


@dataclass(frozen=True)
class CriticalSection:
    """Chord s_Fn, distance of its middle from the axis, and radius of the fillet there, mm; NaN where no tangent has the angle."""

    chord: float
    radius: float
    fillet_radius: float


def normal_section(beta: float) -> SlantedLevel:
    """Stations of the plane through the middle of the tooth at the reference cylinder, across its trace: y sin + z cos, mm."""
    return SlantedLevel(np.array([0.0, math.sin(beta), math.cos(beta)]), np.zeros(3))


def critical_section(tooth: Tooth, teeth: Toothing) -> CriticalSection:
    """Where the tangent of the right fillet, between its form point and the root land, has the angle of the critical section;
    mm."""
    plane = normal_section(teeth.beta)
    side = tooth.right
    wanted = math.radians(TANGENT_INTERNAL if teeth.internal else TANGENT)

    def jet(q: Array) -> Jet:
        return along(side.fillet, q, np.zeros_like(q), plane)[1]

    def excess(q: Array, _: NDArray[np.intp]) -> Array:
        direction = cross(np.broadcast_to(plane.normal, (*q.shape, 3)), jet(q).n)
        return np.arctan2(_across(plane, direction), np.abs(direction[..., 0])) - wanted

    form_point = tooth.sections([0.5]).right.form_point_fillet
    roots = bracketed_root(excess, form_point, np.full_like(form_point, side.root))
    if not roots.converged[0]:
        return CriticalSection(math.nan, math.nan, math.nan)
    there = jet(roots.values)
    point = there.r[0]
    return CriticalSection(2.0 * math.hypot(*point[1:]), float(point[0]), float(_contour_radius(plane, there)[0]))


def _across(plane: SlantedLevel, direction: Array) -> Array:
    """Length of vectors (..., 3) of the plane across the middle of the tooth, not signed."""
    e = np.array([0.0, plane.normal[2], -plane.normal[1]])
    length: Array = np.abs(direction @ e)
    return length


def _contour_radius(plane: SlantedLevel, jet: Jet) -> Array:
    """Radius of curvature (...,) of the contour that a plane cuts out of a surface, by Meusnier; positive where it is hollow."""
    e1, e2 = tangent_basis(jet)
    k = shape_operator(jet, e1, e2)
    along_contour = cross(np.broadcast_to(plane.normal, jet.n.shape), jet.n)
    slant = np.linalg.norm(along_contour, axis=-1)
    t = np.stack((dot(along_contour, e1), dot(along_contour, e2)), axis=-1) / slant[..., None]
    normal_curvature = np.einsum("...i,...ij,...j->...", t, k, t)
    radius: Array = slant / normal_curvature
    return radius


def lever(teeth: Toothing, line: LineOfAction, section: CriticalSection) -> float:
    """Lever h_F (mm) of a force at the outer point of single contact over the chord of the critical section [ISO 6336-3 6.2, B].

    The tooth's virtual spur gear has z_n = z / (cos(beta_b)^2 cos(beta)) teeth. The active flank ends where its own tip or the
    mating gear's fillet says.
    """
    beta_b = teeth.beta_b
    radius = 0.5 * teeth.module * teeth.teeth / (math.cos(beta_b) ** 2 * math.cos(teeth.beta))
    base = radius * math.cos(teeth.alpha)
    ratio = line.contact_ratio / math.cos(beta_b) ** 2
    tip = radius - teeth.radius + math.hypot(teeth.base_radius, line.active(teeth)[1])
    pitch = math.pi * teeth.module * math.cos(teeth.alpha)
    length = math.sqrt(max(0.0, tip**2 - base**2)) - teeth.sense * max(0.0, ratio - 1.0) * pitch
    pressure = math.atan2(length, base)
    half = 0.5 * teeth.thickness / radius + teeth.sense * (involute(teeth.alpha) - involute(pressure))
    crossing = base / math.cos(pressure - teeth.sense * half)
    return teeth.sense * (crossing - radius + teeth.radius - section.radius)
