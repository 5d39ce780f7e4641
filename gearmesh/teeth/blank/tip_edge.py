r"""Broken edges between flank and top land, drawn on the stations.

A station is developed into a plane (see `teeth.blank.development`): the transverse section of a cylindrical gear, the
cone across the pitch cone of a bevel gear, the cylinder of a face gear. In this plane

            land
        ____________ sharp edge         chamfer of size c: a line from the flank, c under the land, to the land, c beside
       /:  c         |                  the sharp edge along it: 45 deg where the flank is square to the land
      / : c          |
     |               |                  rounding of radius c: a circle that touches flank and land
     flank

So `size` is measured in the station, which is the transverse section of a helical gear. Along the normal to a tooth
trace with the spiral angle beta the chamfer's leg on the land is size cos(beta).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.numeric.algebra import Array, dot, polar_angle
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.stations import TrimError, along
from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.development import Development
from gearmesh.teeth.region import Side

#: Points (T, 3) at every station: where the edge meets the flank, where the land, and its centre
EdgePoints = tuple[Array, Array, Array]


@dataclass(frozen=True)
class TipEdge:
    """A 45 deg chamfer or a rounding of `size` mm; `joint` is the motion from one tooth to the next.

    The edge on the flanks `coast` has `coast_size` mm; None: as on the other flanks.
    """

    size: float
    rounded: bool = False
    joint: Joint = REVOLUTE_JOINT
    coast_size: float | None = None
    coast: Side = Side.LEFT

    def of(self, side: Side) -> TipEdge:
        """Return the edge of the right or the left flanks, with one size."""
        own = self.size if self.coast_size is None or side is not self.coast else self.coast_size
        return replace(self, size=own, coast_size=None)

    def grown(self, amount: float) -> TipEdge:
        """Return the edge with larger sizes, by an amount (mm)."""
        coast = None if self.coast_size is None else self.coast_size + amount
        return replace(self, size=self.size + amount, coast_size=coast)

    @property
    def least(self) -> float:
        """Smaller one of both sizes, mm."""
        return self.size if self.coast_size is None else min(self.size, self.coast_size)

    def _between(
        self, flank: Surface, blank: Blank, sign: int, ends: tuple[Array, Array], at: tuple[Array, Array]
    ) -> tuple[Array, EdgePoints]:
        """Solve for the flank parameter (T,) where the broken edge begins; return it with the points (T, 3) of the edge.

        `ends`: flank parameters (T,) of form point and sharp tip; `sign`: +1 on the right side of a tooth, -1 on the
        left; `at`: stations (mm) and t (T,). Raises TrimError where the edge is larger than the flank.
        """
        (form_point, tip), (stations, t) = ends, at
        axial, plane = blank.axial, Development(blank.axial, self.joint)
        # second parameters (T,) of the flank: each search along the face starts where the last one ended
        along_face, jet = along(flank, tip, stations, axial)
        along_face, sharp = along_face.copy(), jet.r
        about = plane.about(sharp)
        corner = plane.flat(sharp, about)
        height = plane.reach(corner)
        # +1 if the reach grows out of the body, -1 for an internal gear
        outward = plane.lift_vector(plane.beside(corner, height + 1.0) - corner, sharp, about)
        towards = np.sign(dot(blank.tip.gradient(sharp), outward))

        def begins(p: Array, which: slice | NDArray[np.intp]) -> tuple[Array, Array, Array]:
            """Return the height of a trial edge over the land (root: 0), its point on the flank, and its centre, at
            flank parameters (M,).
            """
            along_face[which], jet = along(flank, p, stations[which], axial, along_face[which])
            point = plane.flat(jet.r, about[which])
            inward = -plane.flat_vector(jet.n, jet.r, about[which])
            centre = point + self.size * inward / np.hypot(inward[:, 0], inward[:, 1])[:, None]
            reach = plane.reach(centre if self.rounded else point)
            return towards[which] * (reach - height[which]) + self.size, jet.r, centre

        # a chamfer begins `size` under the land; the centre of a rounding lies `size` under it
        roots = bracketed_root(lambda p, index: begins(p, index)[0], form_point, tip)
        if not roots.converged.all():
            # height over the land at which an edge from the form point would end: above 0 where the flank is too low
            missing = np.where(roots.converged, -np.inf, begins(form_point, slice(None))[0])
            k = int(np.argmax(missing))
            excess = float(missing[k]) if missing[k] > 0.0 else None
            raise TrimError("edge", float(t[k]), "the tip edge is larger than the flank", excess)
        _, on_flank, centre = begins(roots.values, slice(None))
        on_land = plane.beside(centre, height) if self.rounded else plane.beside(corner, height, sign * self.size)
        return roots.values, (on_flank, plane.lift(on_land, on_flank, about), plane.lift(centre, on_flank, about))

    def _section_curve(self, edge: EdgePoints, axial: Level, s: Array) -> tuple[Array, Array]:
        """Points and unit normals (S, T, 3) in the stations, from the flank (s = 0) to the land (s = 1), s (S, 1)."""
        plane = Development(axial, self.joint)
        about = plane.about(edge[0])
        on_flank, on_land, centre = (plane.flat(r, about) for r in edge)
        points, normals = self._profile(on_flank, on_land, centre, s[..., None])
        r = plane.lift(points, edge[0], about)
        return r, plane.lift_vector(normals, r, about)

    def _profile(self, on_flank: Array, on_land: Array, centre: Array, s: Array) -> tuple[Array, Array]:
        """Points and unit outward normals (S, T, 2) in the plane, s (S, 1, 1)."""
        if self.rounded:
            first, last = on_flank - centre, on_land - centre
            radius = np.hypot(first[:, 0], first[:, 1])[:, None]
            start, turn = polar_angle(first), polar_angle(last) - polar_angle(first)
            angle = start + s[..., 0] * ((turn + np.pi) % (2.0 * np.pi) - np.pi)
            normals = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
            return centre + radius * normals, normals
        across = on_land - on_flank
        points = on_flank + s * across
        outward = np.stack((across[:, 1], -across[:, 0]), axis=-1)
        # the centre lies in the tooth
        outward *= np.sign((outward * (on_flank - centre)).sum(axis=-1, keepdims=True))
        outward /= np.hypot(outward[:, 0], outward[:, 1])[:, None]
        return points, np.broadcast_to(outward, points.shape)
