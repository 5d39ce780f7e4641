"""The space between two teeth as a solid with named faces for CAD: splines, root and tip surface, planes or cones at the ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gearmesh.cad.brep import Patch, SplineTooth, spline_tooth
from gearmesh.cad.occ import PRECISION_MM, face, frame, wire
from gearmesh.cad.solid_part import tooth_faces, whole_part
from gearmesh.cad.step import NamedFace, Part, require_occ
from gearmesh.cad.turned import Loop, TurnedSurface
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.blank.body import end_regions
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.space import Space


def spline_space(space: Space, tolerance: float) -> SplineTooth:
    """Fit patches to a space within `tolerance` (mm) of its exact surfaces; its left side lies on the tooth before."""
    drawn, back = spline_tooth(space, tolerance), space.joint.to(-space.pitch_angle)
    regions = [link.region for link in drawn.links]
    before = regions.index(Region.TIP_SURFACE) + 1
    left = drawn.links[before:]

    def place(patches: tuple[Patch, ...]) -> tuple[Patch, ...]:
        return tuple(replace(patch, control=back.point(patch.control)) for patch in patches)

    patches = {link: place(own) if link in left else own for link, own in drawn.patches.items()}
    corners = np.concatenate((drawn.corners[:before], back.point(drawn.corners[before:])))
    return replace(drawn, patches=patches, corners=corners, closed=True)


def space_part(member: Member, space: SplineTooth) -> Part:
    """Build the solid of a member's space. Raises DesignError for an invalid solid, OutputError without OpenCASCADE."""
    require_occ()
    faces, loops, _ = tooth_faces(space)
    regions = end_regions(space.tooth.blank.axial)
    for end, (loop, region) in enumerate(zip(loops, regions, strict=True)):
        faces.append(NamedFace(_end_face(space, loop, end), region, region))
    name = f"{member.name}_space"
    return whole_part(name, tuple(faces), (*space.tooth.regions, *regions))


def _end_face(space: SplineTooth, loop: Loop, end: int) -> Any:
    """Return the plane, cone or cylinder inside the outline at toe (0) or heel (1)."""
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Plane
    from OCP.TopLoc import TopLoc_Location

    across, up = station_normal(space.tooth.blank.axial)
    # the beginnings of links, in (u, v) of the surface, show the sense of the loop
    corners = space.corners[:, -end]
    if across == 0.0:
        surface, u, v = Geom_Plane(frame((0.0, 0.0, loop.z), 1.0, 0.0)), corners[:, 0], corners[:, 1]
        outward = up > 0.0
    else:
        rho = np.hypot(corners[:, 0], corners[:, 1])
        far = int(np.argmax(np.abs(rho - rho[0]) + np.abs(corners[:, 2] - corners[0, 2])))
        first, last = (np.array([rho[k], corners[k, 2]]) for k in (0, far))
        # the seam of the surface lies opposite to the outline
        turned = TurnedSurface.through(first, last, loop.angle - np.pi)
        builder, here, surface = BRep_Builder(), TopLoc_Location(), turned.surface
        for drawn, trace in zip(loop.edges, loop.traces, strict=True):
            builder.UpdateEdge(drawn, turned.curve(trace, np.pi), surface, here, max(PRECISION_MM, trace.miss))
        angle = np.arctan2(corners[:, 1], corners[:, 0]) - loop.angle
        u = turned.axis * ((angle + np.pi) % (2.0 * np.pi) - np.pi)
        v = np.array([turned.length(*place) for place in zip(rho, corners[:, 2], strict=True)])
        outward = across > 0.0
    forward = float(u @ np.roll(v, -1) - v @ np.roll(u, -1)) > 0.0
    edges = loop.edges if forward else loop.edges[::-1]
    return face(surface, [wire(*((drawn, forward) for drawn in edges))], outward == (end == 1))
