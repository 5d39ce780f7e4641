"""Outline of a member: its axial section, as polygons over (z, rho), and its teeth seen along the axis. Lengths in
mm.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.tooth import Tooth

#: stations along the face
FACE_STATIONS = 25
#: points along each link of a tooth
LINK_POINTS = 13


@dataclass(frozen=True)
class ToothRow:
    """One row of teeth in the axial half plane: lines over (z, rho) from toe to heel.

    `tip`, `root`: lines (FACE_STATIONS, 2) of a tooth with sharp end faces. `broken`: both lines with the end chamfers.
    """

    tip: Array
    root: Array
    broken: tuple[Array, Array]

    @property
    def outline(self) -> Array:
        """Closed polygon of the tooth."""
        tip, root = self.broken
        return np.concatenate((tip, root[::-1]))

    def on_ends(self, radii: tuple[float, float]) -> Array:
        """Return points on the end faces, at radii of the tooth.

        `radii`: radii of the points at toe and heel, mm. Result: z and radius of the points at toe and heel, mm.
        """
        ends = []
        for end, radius in zip((0, -1), radii, strict=True):
            tip, root = self.tip[end], self.root[end]
            share = (radius - root[1]) / (tip[1] - root[1])
            ends.append(root + share * (tip - root))
        return np.array(ends)


@dataclass(frozen=True)
class Outline:
    """Axial section of a member.

    `rows`: its rows of teeth; `body`: closed polygon (N, 2) of the body under or round them, (z, rho).
    """

    rows: tuple[ToothRow, ...]
    body: Array

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest z of the section."""
        z = np.concatenate([self.body[:, 0], *(row.tip[:, 0] for row in self.rows)])
        return float(z.min()), float(z.max())

    @property
    def reach(self) -> float:
        """Largest distance from the axis, or from the reference plane of a rack."""
        return float(max(np.abs(self.body[:, 1]).max(), *(np.abs(row.tip[:, 1]).max() for row in self.rows)))


def outline_of(member: Member) -> Outline:
    """Return the outline of a member. Raises TrimError for teeth that cannot be trimmed."""
    lines = [
        [_middle(tooth, region) for region in (Region.LAND, Region.ROOT)]
        for tooth in (member.tooth.sharp_ends, member.tooth)
    ]
    rows = tuple(
        ToothRow(tip, root, (broken_tip, broken_root))
        for tip, root, broken_tip, broken_root in (
            [_in_half(line, half) for of_tooth in lines for line in of_tooth] for half in member.halves
        )
    )
    profile = np.array([(z, rho) for rho, z in member.body.profile])
    roots = [row.broken[1] for row in rows] + [
        np.array([(z, rho) for rho, z in gap.body.profile]) for gap in member.gaps
    ]
    # join all roots from the end of the profile to its beginning
    rising = profile[0, 0] < profile[-1, 0]
    ordered = sorted((part[np.argsort(part[:, 0])] for part in roots), key=lambda part: float(part[:, 0].mean()))
    under = np.concatenate(ordered) if len(ordered) > 1 else roots[0]
    if len(ordered) > 1 and not rising:
        under = under[::-1]
    return Outline(rows, np.concatenate((under, profile[::-1])))


def _middle(tooth: Tooth, region: Region) -> Array:
    """Middle of a land or root, (N, 2) over (z, rho), from one end face to the other, including the end chamfers."""
    points = tooth.grid(region, np.array([0.5]), tooth.sections(np.linspace(0.0, 1.0, FACE_STATIONS))).points[0]
    toe_chamfer, heel_chamfer = (
        np.zeros((0, 3)) if strip is None else strip.middle(region) for strip in tooth.end_strips
    )
    points = np.concatenate((toe_chamfer, points, heel_chamfer[::-1]))
    # the radius of a rack is the height over the reference plane
    return np.stack((points[:, 2], tooth.joint.radius(points)), axis=-1)


def _in_half(line: Array, half: HalfGear) -> Array:
    """Return a line (N, 2) over (z, rho) in its row of teeth."""
    points = half.points(np.stack((line[:, 1], np.zeros(len(line)), line[:, 0]), axis=-1))
    return np.stack((points[:, 2], line[:, 1]), axis=-1)


def end_of_teeth(member: Member, above: bool) -> tuple[Array, ...]:
    """Outline of one tooth on the end face at larger z (`above`) or at smaller z: lines of points (N, 2), mm, over x
    and y.

    With a chamfer it has two lines: the section under the chamfer, and the outline of the end face. For a double
    helical member the end belongs to its first half.
    """
    tooth = member.tooth
    sections = tooth.sections([0.0, 1.0])
    links = [tooth.grid(region, np.linspace(0.0, 1.0, LINK_POINTS), sections).points for region in tooth.regions]
    heel_above = float(links[0][:, 1, 2].mean()) > float(links[0][:, 0, 2].mean())
    end = 1 if heel_above == above else 0
    strip, section = tooth.end_strips[end], np.concatenate([link[:, end, :2] for link in links])
    return (section,) if strip is None else (section, strip.outline[:, :2])


def bar_faces(member: Member) -> tuple[Array, ...]:
    """Outline of a rack's end face at larger z, from end to end, if its edges are broken; empty if they are sharp.

    Points (N, 2), mm, are over x and y.
    """
    tooth, (_, end) = member.tooth, member.rows.outer[1]
    strip = tooth.end_strips[end]
    if strip is None:
        return ()
    places = tooth.joint.places(tooth.teeth)
    step = tooth.joint.to(tooth.pitch_angle).translation[:2]
    points = (strip.outline[:, :2] + places[:, None, None] * step).reshape(-1, 2)
    first, last = map(float, member.bar_ends(np.array(tooth.blank.faces[end])))
    # the first root is cut in half, the last is extended to the end of the bar
    points[:, 1] = np.maximum(points[:, 1], first)
    return (np.concatenate(([(points[0, 0], first)], points, [(points[0, 0], last)])),)


def tip_edges(member: Member) -> tuple[Array, Array]:
    """Both edges of a land from toe to heel, (FACE_STATIONS, 2) over x and y."""
    tooth = member.tooth
    points = tooth.grid(Region.LAND, np.array([0.0, 1.0]), tooth.sections(np.linspace(0.0, 1.0, FACE_STATIONS))).points
    return points[0, :, :2], points[1, :, :2]
