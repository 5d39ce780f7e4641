"""Broken edges between flank and top land: drawn in the plane of a station, not generated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.motion.joint import REVOLUTE, Joint
from gearmesh.kernel.numeric.algebra import Array, dot, polar_angle
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.stations import TrimError, along
from gearmesh.kernel.surface.surface import Surface
from gearmesh.teeth.blank.blank import Blank

#: Points (T, 3) at every station: where the edge meets the flank, where the land, and its centre
EdgePoints = tuple[Array, Array, Array]


@dataclass(frozen=True)
class TipEdge:
    """A 45 deg chamfer or a rounding of `size` mm; stations must be planes across the axis, or across a rack."""

    size: float
    rounded: bool = False
    joint: Joint = REVOLUTE

    def between(
        self, flank: Surface, blank: Blank, sign: int, ends: tuple[Array, Array], stations: Array
    ) -> tuple[Array, EdgePoints]:
        """Flank parameter (T,) where the broken edge begins, and its points at stations (T,).

        `ends`: flank parameters (T,) of form point and sharp tip; `sign` +1 on the right side of a tooth, -1 on the left.
        Raises TrimError where the edge is larger than the flank.
        """
        form_point, tip = ends
        axial, joint = blank.axial, self.joint

        def begins(p: Array, at: Array) -> tuple[Array, Array, Array, Array]:
            jet = along(flank, p, at, axial)[1]
            tip_radius = blank.tip.at(jet.r[:, 2])
            # out of the body: away from the axis, or towards it on an internal gear
            towards = np.sign((blank.tip.gradient(jet.r)[:, :2] * joint.outward(jet.r)).sum(axis=-1))
            inward = -jet.n[:, :2] / np.hypot(jet.n[:, 0], jet.n[:, 1])[:, None]
            centre = jet.r.copy()
            centre[:, :2] += self.size * inward
            reach = joint.radius(centre if self.rounded else jet.r)
            return towards * (reach - tip_radius) + self.size, jet.r, centre, tip_radius

        roots = bracketed_root(lambda p, index: begins(p, stations[index])[0], form_point, tip)
        if not roots.converged.all():
            raise TrimError("edge", 0.0, "the tip edge is larger than the flank")
        p = roots.values
        _, on_flank, centre, tip_radius = begins(p, stations)
        on_land = on_flank.copy()
        sharp = along(flank, tip, stations, axial)[1].r
        angle = joint.angle(centre) if self.rounded else joint.angle(sharp) + sign * self.size / joint.arm(sharp)
        on_land[:, :2] = joint.place(angle, tip_radius)
        return p, (on_flank, on_land, centre)

    def section_curve(self, edge: EdgePoints, s: Array) -> tuple[Array, Array]:
        """Points and unit outward normals (S, T, 3) from the flank (s = 0) to the land (s = 1), s (S, 1)."""
        on_flank, on_land, centre = edge
        s = s[..., None]
        if self.rounded:
            first, last = on_flank - centre, on_land - centre
            radius = np.hypot(first[:, 0], first[:, 1])[:, None]
            start, turn = polar_angle(first), polar_angle(last) - polar_angle(first)
            angle = start + s[..., 0] * ((turn + np.pi) % (2.0 * np.pi) - np.pi)
            normals = np.stack((np.cos(angle), np.sin(angle), np.zeros_like(angle)), axis=-1)
            return centre + radius * normals, normals
        across = on_land - on_flank
        points = on_flank + s * across
        outward = np.stack((across[:, 1], -across[:, 0], np.zeros(len(across))), axis=-1)
        # the centre lies in the tooth
        outward *= np.sign(dot(outward, on_flank - centre))[:, None]
        outward /= np.sqrt(dot(outward, outward))[:, None]
        return points, np.broadcast_to(outward, points.shape)
