"""Default root of the spur pinion: as round as its rack has room for, and clear of the gear's tips.

The tip edge of the gear is known in closed form (`limits.ShapedGear`). Transformed into the pinion's frame through a
mesh, it must stay inside the pinion's space. The rack generates the profile of the space in closed form as well. A
point (x, y) of the rack with the normal (n_x, n_y) generates when that normal passes through the pitch point, at y_c =
y - x n_y / n_x. Hence

    rho e^(i theta) = (r + x + i (y - y_c)) e^(i y_c / r).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.defaults import ROOM_SHARE, straight_rounding, unusual_defaults
from gearmesh.systems.face_gear.limits import ShapedGear

if TYPE_CHECKING:
    from gearmesh.systems.face_gear.design import FaceGearDesign

#: standard depth of the rack, in modules
STANDARD_DEDENDUM_MODULES = 1.25
#: standard tip rounding of the rack, in modules
STANDARD_TIP_RADIUS_MODULES = 0.25
#: least rounding (modules) for which a default depth has room
MIN_TIP_RADIUS_MODULES = 0.1
#: largest default depth, in modules
MAX_DEDENDUM_MODULES = 2.0
#: default depth (modules) beyond the depth that just clears the tips
EXTRA_DEDENDUM_MODULES = 0.02
#: number of sections of the gear
GEAR_SECTIONS = 17
#: number of mesh positions within one and a half pitches either way
MESH_POSITIONS = 361
#: number of points of the pinion's flank, and of its fillet
PROFILE_POINTS = 2000
#: largest overlap (modules) that counts as 0: the error of interpolation between these points
MAX_OVERLAP_MODULES = 1e-6
#: number of halvings in a bisection
BISECTION_STEPS = 20


@dataclass(frozen=True)
class PinionRoot:
    """Root of the pinion's rack."""

    #: depth below the shifted pitch plane, in modules
    dedendum: float
    #: tip rounding, in modules
    tool_tip_radius: float


def clear_root(design: FaceGearDesign, shaped: ShapedGear, radii: tuple[float, float]) -> PinionRoot:
    """Return depth and rounding of the rack.

    They are given values, standard values, or values that clear the tips of a gear between `radii`.
    """
    spec = design.pinion
    depth, radius = spec.dedendum, spec.tool_tip_radius
    if not np.isnan([depth, radius]).any():
        return PinionRoot(depth, radius)
    with np.errstate(all="ignore"):
        tips = tips_on_pinion(design, shaped, radii)

    def clears(depth: float, radius: float) -> bool:
        return overlap(design, tips, depth, radius) <= MAX_OVERLAP_MODULES

    # a larger depth is used only if the standard depth does not clear the tips and a larger one does
    if np.isnan(depth):
        least = MIN_TIP_RADIUS_MODULES if np.isnan(radius) else radius
        deepest = min(MAX_DEDENDUM_MODULES, _deepest(design, least))
        depth = STANDARD_DEDENDUM_MODULES
        if not clears(depth, least) and depth < deepest and clears(deepest, least):
            depth = min(_last(lambda at: clears(at, least), deepest, depth) + EXTRA_DEDENDUM_MODULES, deepest)
    # rounding for which the rack's tooth has room, or a smaller one that clears the tips
    if np.isnan(radius):
        radius = straight_rounding(*_rack(design, depth), STANDARD_TIP_RADIUS_MODULES)
        if not clears(depth, radius):
            radius = ROOM_SHARE * _last(lambda at: clears(depth, at), 0.0, radius)
    return PinionRoot(float(depth), float(radius))


def unlike_standard(design: FaceGearDesign) -> tuple[str, ...]:
    """Warnings on a root that differs from the standard: deeper, or less round because the rack's tooth is narrow."""
    why = "the rack's tooth and the gear's tips leave room for no other"
    standards = {"pinion.dedendum": (STANDARD_DEDENDUM_MODULES, why)}
    if (
        straight_rounding(*_rack(design, design.pinion.dedendum), STANDARD_TIP_RADIUS_MODULES)
        < STANDARD_TIP_RADIUS_MODULES
    ):
        standards["pinion.tool_tip_radius"] = (STANDARD_TIP_RADIUS_MODULES, "the rack's tooth has no room for it")
    return unusual_defaults(design, standards)


def tips_on_pinion(design: FaceGearDesign, shaped: ShapedGear, radii: tuple[float, float]) -> tuple[Array, Array]:
    """Return radii (M,), in modules, and polar angles (M,), rad, of the gear's tip edges in the pinion's frame.

    The angles count from the middle of the nearest space.
    """
    m, teeth, shaper = design.given_module, design.pinion.teeth, shaped.shaper
    gear_radii, height = np.linspace(*radii, GEAR_SECTIONS), design.gear.addendum * m
    right, left = (side.tip_edge(height, gear_radii) for side in shaped.sides)
    edges = np.stack((right, left * [1.0, -1.0, 1.0]))
    phi1 = np.linspace(-3.0, 3.0, MESH_POSITIONS)[:, None, None] * np.pi / teeth
    # at phi1 = 0 a tooth of the gear is in the middle of a space of the pinion, without backlash
    turned = gear_base(shaped.shaft_angle, -shaped.offset) @ Rigid.about_z(phi1[..., 0] * teeth / shaped.teeth)
    fixed = np.einsum("pqij,stj->psti", turned.rotation, edges) + turned.translation
    axis_distance = 0.5 * (shaper.teeth - teeth) * m
    x, y = fixed[..., 0] - axis_distance, fixed[..., 1]
    angle, pitch = np.arctan2(y, x) + phi1, 2.0 * np.pi / teeth
    return np.hypot(x, y).ravel() / m, (angle - pitch * np.round(angle / pitch)).ravel()


def overlap(design: FaceGearDesign, tips: tuple[Array, Array], depth: float, radius: float) -> float:
    """Return the largest distance (modules, along the circle) of `tips` outside the pinion's space.

    `depth`, `radius`: depth and rounding of the rack, in modules.
    """
    rho, angle = tips
    room = _half_space(design, depth, radius)(rho)
    return float((rho * (np.abs(angle) - room))[rho < 0.5 * design.pinion.teeth].max(initial=-1.0))


def _half_space(design: FaceGearDesign, depth: float, radius: float) -> Callable[[Array], Array]:
    """Return a function of radii (M,) that returns half the angle (rad) of the pinion's space; lengths are in modules.

    The angle is < 0 below the root.
    """
    pitch, alpha, shift = 0.5 * design.pinion.teeth, np.radians(design.pressure_angle), design.pinion.profile_shift
    # working flank and fillet are in their positions without backlash
    half = 0.25 * np.pi
    centre_x = shift - depth + radius
    centre_y = half + (centre_x - shift) * np.tan(alpha) - radius / np.cos(alpha)
    arc = np.linspace(0.5 * np.pi, alpha, PROFILE_POINTS)
    fillet = _generate(
        centre_x - radius * np.sin(arc), centre_y + radius * np.cos(arc), -np.sin(arc), np.cos(arc), pitch
    )
    x = np.linspace(centre_x - radius * np.sin(alpha), shift + design.pinion.addendum, PROFILE_POINTS)
    ones = np.ones_like(x)
    flank = _generate(x, half + (x - shift) * np.tan(alpha), -np.sin(alpha) * ones, np.cos(alpha) * ones, pitch)
    # an undercut flank reverses at its cusp: only the part beyond it counts
    cusp = int(np.argmin(flank[0]))

    def room(rho: Array) -> Array:
        half_angle: Array = np.maximum(
            np.interp(rho, *fillet, left=-np.pi, right=-np.pi), np.interp(rho, flank[0][cusp:], flank[1][cusp:], -np.pi)
        )
        return half_angle

    return room


def _generate(x: Array, y: Array, n_x: Array, n_y: Array, pitch: float) -> tuple[Array, Array]:
    """Return radii and polar angles (P,) generated by points (x, y) of the rack with normals (n_x, n_y).

    See the module's text.
    """
    off = x * n_y / n_x
    return np.hypot(pitch + x, off), np.arctan2(off, pitch + x) + (y - off) / pitch


def _rack(design: FaceGearDesign, depth: float) -> tuple[float, float, tuple[float, float]]:
    """Return width at the pitch plane, depth (modules) and pressure angles (deg) of the pinion's rack."""
    alpha = np.radians(design.pressure_angle)
    width = 0.5 * np.pi + design.backlash / design.given_module / np.cos(alpha)
    return float(width), depth, (design.pressure_angle, design.pressure_angle)


def _deepest(design: FaceGearDesign, radius: float) -> float:
    """Return the depth (modules) at which the rack's tip has room for a rounding."""
    width, _, (angle, _) = _rack(design, 0.0)
    alpha = np.radians(angle)
    return float((0.5 * width - radius / ROOM_SHARE * np.tan(0.25 * np.pi - 0.5 * alpha)) / np.tan(alpha))


def _last(holds: Callable[[float], bool], good: float, bad: float) -> float:
    """Return the value nearest to `bad` at which `holds` is true, by bisection from `good`."""
    for _ in range(BISECTION_STEPS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return good
