"""An internal ring by hand: straight flanks, arcs for fillets, teeth that point to the axis, a body outside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh import Member
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Blank, Body, ConeLevel, Jet, PlaneLevel, Region, ToolDescription, Tooth, ToothSide

#: teeth, radii of tip, root and rim, half the face width, mm
TEETH, TIP, ROOT, RIM, HALF = 20, 40.0, 46.0, 60.0, 10.0
#: where a flank's straight line begins and what way it goes, towards the tip (x, y); radius of the fillet
FOOT, FILLET = np.array([44.5, -4.0]), 2.0
INWARD = np.array([-4.6, 1.5]) / np.hypot(4.6, 1.5)


@dataclass(frozen=True)
class Extruded:
    """A line (curvature 0) or arc through `start` in direction `along` (x, y), parameter its length, drawn up the z axis.

    The arc bends to the left where `curvature` > 0. Mirrored in y where `mirrored`. The normal is on the left of the curve,
    turned over by `sign`.
    """

    start: Array
    along: Array
    curvature: float
    sign: float
    mirrored: bool = False

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        k, left = self.curvature, np.array([-self.along[1], self.along[0]])
        c, s = np.cos(k * u)[..., None], np.sin(k * u)[..., None]
        ahead, aside = (s / k, (1.0 - c) / k) if k else (u[..., None], 0.0 * u[..., None])
        place = self.start + ahead * self.along + aside * left
        tangent, normal = c * self.along + s * left, self.sign * (c * left - s * self.along)
        turning = -self.sign * k * tangent
        flip = np.array([1.0, -1.0 if self.mirrored else 1.0])

        def lifted(plane: Array, z: Array) -> Array:
            return np.concatenate((flip * plane, np.broadcast_to(z, u.shape)[..., None]), axis=-1)

        zero = np.zeros(u.shape)
        up = lifted(0.0 * tangent, np.ones(u.shape))
        return Jet(
            lifted(place, v), lifted(normal, zero), lifted(tangent, zero), up, lifted(turning, zero), np.zeros_like(up)
        )


def arc_length() -> float:
    """Length of the fillet from the flank to the root circle."""
    low, high = 0.0, 0.5 * np.pi * FILLET
    arc = Extruded(FOOT, -INWARD, -1.0 / FILLET, 1.0)
    for _ in range(80):
        middle = 0.5 * (low + high)
        x, y, _ = arc.jet(np.array(middle), np.array(0.0)).r
        low, high = (middle, high) if np.hypot(x, y) < ROOT else (low, middle)
    return low


def ring(heel: float) -> Member:
    """The ring; "right" is y < 0 as on every tooth, and the heel is at z = `heel` times half the face width (1 or -1).

    Towards -z the directions along the chain and to the heel turn out of the material, as on an external gear towards +z.
    """
    root = arc_length()
    sides = [
        ToothSide(
            Extruded(FOOT, INWARD, 0.0, 1.0, mirrored),
            Extruded(FOOT, -INWARD, -1.0 / FILLET, -1.0, mirrored),
            form_point=(0.0, 0.0),
            root=root,
            tip=4.8,
            tool=ToolDescription("broach"),
        )
        for mirrored in (False, True)
    ]
    blank = Blank(
        PlaneLevel(0.0, heel),
        (-HALF, HALF),
        ConeLevel(-0.5 * np.pi, -TIP),
        ConeLevel(-0.5 * np.pi, -ROOT),
        Body.tube(RIM, -heel * HALF, heel * HALF, Region.RIM),
    )
    return Member("ring", Tooth(TEETH, *sides, blank), lambda p, v: {})


def ring_volume(steps: int = 4000) -> float:
    """Its volume (mm^3), from the section's polygon with so many corners on every curve: an area by triangles."""
    root = arc_length()
    line, arc = Extruded(FOOT, INWARD, 0.0, 1.0), Extruded(FOOT, -INWARD, -1.0 / FILLET, 1.0)
    fillet = arc.jet(np.linspace(root, 0.0, steps), np.array(0.0)).r[:, :2]
    # |FOOT + p INWARD| = TIP
    across = FOOT @ INWARD
    tip = -across - np.sqrt(across**2 - FOOT @ FOOT + TIP**2)
    flank = line.jet(np.array([0.0, tip]), np.array(0.0)).r[:, :2]
    right = np.concatenate((fillet, flank))
    x, y = right.T
    side = 0.5 * float(x[:-1] @ y[1:] - x[1:] @ y[:-1])
    land = -np.arctan2(right[-1, 1], right[-1, 0]) * TIP**2
    gap = (np.pi / TEETH + np.arctan2(right[0, 1], right[0, 0])) * ROOT**2
    hole = TEETH * (2.0 * side + land + gap)
    return float(2.0 * HALF * (np.pi * RIM**2 - hole))
