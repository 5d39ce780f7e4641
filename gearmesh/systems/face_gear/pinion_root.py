"""Root of the spur pinion where the design leaves it out: as round as its rack has room for, and clear of the gear's tips.

The tip edge of the gear is known in closed form (`limits.ShapedGear`); transformed into the pinion's frame through a mesh it
must stay inside the pinion's space, whose profile the rack generates in closed form as well: a point (x, y) of the rack with the
normal (n_x, n_y) generates where that normal passes through the pitch point, at y_c = y - x n_y / n_x, and so

    rho e^(i theta) = (r + x + i (y - y_c)) e^(i y_c / r).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.defaults import ROOM, straight_rounding, unusual_defaults
from gearmesh.systems.face_gear.limits import ShapedGear

if TYPE_CHECKING:
    from gearmesh.systems.face_gear.design import FaceGearDesign

#: Depth and tip rounding of the rack that are not given, in modules.
DEDENDUM, TIP_RADIUS = 1.25, 0.25
#: Least rounding, in modules, that a depth that is not given has room for, largest such depth, and depth beyond what clears.
LEAST_RADIUS, DEEPEST, DEEPER = 0.1, 2.0, 0.02
#: Sections of the gear, positions within one and a half pitches either way, points of the pinion's flank and fillet.
SECTIONS, POSITIONS, POINTS = 17, 361, 2000
#: Overlap (modules) that is none: what interpolation between those points leaves.
TOUCHING = 1e-6
HALVINGS = 20


@dataclass(frozen=True)
class PinionRoot:
    """Depth below the shifted pitch plane and tip rounding of the pinion's rack, in modules."""

    dedendum: float
    tool_tip_radius: float


def clear_root(design: FaceGearDesign, shaped: ShapedGear, radii: tuple[float, float]) -> PinionRoot:
    """Depth and rounding as given, and where they are not, as is standard or clears the tips of a gear between `radii`."""
    spec = design.pinion
    depth, radius = spec.dedendum, spec.tool_tip_radius
    if not np.isnan([depth, radius]).any():
        return PinionRoot(depth, radius)
    with np.errstate(all="ignore"):
        tips = tips_on_pinion(design, shaped, radii)

    def clears(depth: float, radius: float) -> bool:
        return overlap(design, tips, depth, radius) <= TOUCHING

    if np.isnan(depth):
        least = LEAST_RADIUS if np.isnan(radius) else radius
        deepest = min(DEEPEST, _deepest(design, least))
        depth = DEDENDUM
        if not clears(depth, least) and depth < deepest and clears(deepest, least):
            depth = min(_last(lambda at: clears(at, least), deepest, depth) + DEEPER, deepest)
    if np.isnan(radius):
        radius = straight_rounding(*_rack(design, depth), TIP_RADIUS)
        if not clears(depth, radius):
            radius = ROOM * _last(lambda at: clears(depth, at), 0.0, radius)
    return PinionRoot(float(depth), float(radius))


def unlike_standard(design: FaceGearDesign) -> tuple[str, ...]:
    """Warnings of a root that is not as is standard: deeper, or less round because the rack's tooth is too narrow."""
    why = "the rack's tooth and the gear's tips leave room for no other"
    standards = {"pinion.dedendum": (DEDENDUM, why)}
    if straight_rounding(*_rack(design, design.pinion.dedendum), TIP_RADIUS) < TIP_RADIUS:
        standards["pinion.tool_tip_radius"] = (TIP_RADIUS, "the rack's tooth has no room for it")
    return unusual_defaults(design, standards)


def tips_on_pinion(design: FaceGearDesign, shaped: ShapedGear, radii: tuple[float, float]) -> tuple[Array, Array]:
    """Radii (M,), in modules, and polar angles (M,), rad, from the middle of the nearest space, of the gear's tip edges there."""
    m, teeth, shaper = design.given_module, design.pinion.teeth, shaped.shaper
    at, height = np.linspace(*radii, SECTIONS), design.gear.addendum * m
    right, left = (side.tip_edge(height, at) for side in shaped.sides)
    edges = np.stack((right, left * [1.0, -1.0, 1.0]))
    phi1 = np.linspace(-3.0, 3.0, POSITIONS)[:, None, None] * np.pi / teeth
    # at phi1 = 0 a tooth of the gear stands in the middle of a space of the pinion, without backlash
    turned = gear_base(shaped.shaft_angle, -shaped.offset) @ Rigid.about_z(phi1[..., 0] * teeth / shaped.teeth)
    fixed = np.einsum("pqij,stj->psti", turned.rotation, edges) + turned.translation
    apart = 0.5 * (shaper.teeth - teeth) * m
    x, y = fixed[..., 0] - apart, fixed[..., 1]
    angle, pitch = np.arctan2(y, x) + phi1, 2.0 * np.pi / teeth
    return np.hypot(x, y).ravel() / m, (angle - pitch * np.round(angle / pitch)).ravel()


def overlap(design: FaceGearDesign, tips: tuple[Array, Array], depth: float, radius: float) -> float:
    """How far (modules, along the circle) `tips` are outside the pinion's space, with a rack of that depth and rounding."""
    rho, angle = tips
    room = _half_space(design, depth, radius)(rho)
    return float((rho * (np.abs(angle) - room))[rho < 0.5 * design.pinion.teeth].max(initial=-1.0))


def _half_space(design: FaceGearDesign, depth: float, radius: float) -> Callable[[Array], Array]:
    """Half the angle (rad) of the pinion's space at radii (M,), all lengths in modules; < 0 below the root."""
    pitch, alpha, shift = 0.5 * design.pinion.teeth, np.radians(design.pressure_angle), design.pinion.profile_shift
    # the working flank and its fillet stand where they would stand without backlash
    half = 0.25 * np.pi
    centre_x = shift - depth + radius
    centre_y = half + (centre_x - shift) * np.tan(alpha) - radius / np.cos(alpha)
    arc = np.linspace(0.5 * np.pi, alpha, POINTS)
    fillet = _generate(
        centre_x - radius * np.sin(arc), centre_y + radius * np.cos(arc), -np.sin(arc), np.cos(arc), pitch
    )
    x = np.linspace(centre_x - radius * np.sin(alpha), shift + design.pinion.addendum, POINTS)
    one = np.ones_like(x)
    flank = _generate(x, half + (x - shift) * np.tan(alpha), -np.sin(alpha) * one, np.cos(alpha) * one, pitch)
    # an undercut flank turns back at its cusp
    cusp = int(np.argmin(flank[0]))

    def room(rho: Array) -> Array:
        half_angle: Array = np.maximum(
            np.interp(rho, *fillet, left=-np.pi, right=-np.pi), np.interp(rho, flank[0][cusp:], flank[1][cusp:], -np.pi)
        )
        return half_angle

    return room


def _generate(x: Array, y: Array, n_x: Array, n_y: Array, pitch: float) -> tuple[Array, Array]:
    """Radii and polar angles (P,) that points (x, y) with normals (n_x, n_y) of the rack generate (see the module's text)."""
    off = x * n_y / n_x
    return np.hypot(pitch + x, off), np.arctan2(off, pitch + x) + (y - off) / pitch


def _rack(design: FaceGearDesign, depth: float) -> tuple[float, float, tuple[float, float]]:
    """Width at the pitch plane, depth (modules) and pressure angles (deg) of the pinion's rack."""
    alpha = np.radians(design.pressure_angle)
    width = 0.5 * np.pi + design.backlash / design.given_module / np.cos(alpha)
    return float(width), depth, (design.pressure_angle, design.pressure_angle)


def _deepest(design: FaceGearDesign, radius: float) -> float:
    """Depth (modules) at which the rack's tip has room for a rounding."""
    width, _, (angle, _) = _rack(design, 0.0)
    alpha = np.radians(angle)
    return float((0.5 * width - radius / ROOM * np.tan(0.25 * np.pi - 0.5 * alpha)) / np.tan(alpha))


def _last(holds: Callable[[float], bool], good: float, bad: float) -> float:
    """The place nearest to `bad` where it holds, from `good` on."""
    for _ in range(HALVINGS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return good
