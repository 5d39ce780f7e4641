"""Zone of contact of a pair: contact lines on the flanks and in the plane of action, and limit lines.

A contact line passes over the zone of the flank; there is no contact beyond a limit line.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearmesh.contact.path import ContactPath
from gearmesh.contact.zone import ContactZone, LimitLine, contact_zone, limit_lines
from gearmesh.figures import Figures, figure
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: largest distance of crossed axes that count as intersecting, relative to the distance of the contact from them
MAX_INTERSECTION_RATIO = 1e-9


@dataclass(frozen=True)
class ZoneFigures(Figures):
    """The zone of contact of flanks that touch along lines."""

    share: float = figure(
        "part of the gear's flank over which contact lines pass", key="contact_zone_share", symbol="A_c/A"
    )
    ends: list[float] = figure("stations of the gear's face between which they do", "mm", key="contact_zone_ends_mm")

    @staticmethod
    def of(zone: ContactZone) -> ZoneFigures:
        """Return the figures of a zone of contact."""
        return ZoneFigures(zone.share, zone.ends.tolist())


@dataclass(frozen=True)
class ActionPlane:
    """Plane in which the zone of contact is drawn, fixed frame."""

    #: name of the plane
    name: str
    #: origin (3,), mm
    origin: Array
    #: first axis (3,) of the plane
    along: Array
    #: second axis (3,) of the plane
    across: Array
    #: labels of both axes
    labels: tuple[str, str]

    @staticmethod
    def of(pair: GearPair, path: ContactPath) -> ActionPlane:
        """Return the plane of a pair with a path of contact that touches somewhere.

        - parallel axes: the plane of action, through axis and common normal.
        - cylindrical faces on crossed axes, as worm and wheel: parallel to both axes, at the pinion's point nearest to
          the gear's axis.
        - other members: the pitch plane, through the axis of their relative motion, along their velocities.
        """
        first, second = pair.mounts
        touching = np.flatnonzero(path.touching)
        k = int(touching[len(touching) // 2])
        point, of_pinion = path.point[k], f"along the axis of the {pair.pinion.name} (mm)"
        common_perpendicular = cross(first.axis, second.axis)
        if float(np.linalg.norm(common_perpendicular)) < MAX_SINE_OF_PARALLEL:
            normal = path.normal[k] - dot(path.normal[k], first.axis) * first.axis
            labels = (of_pinion, "along the line of action (mm)")
            origin = _foot(first.origin, first.axis, point)
            return ActionPlane("plane of action", origin, first.axis, unit(normal), labels)
        axes_distance = float(np.abs(dot(second.origin - first.origin, unit(common_perpendicular))))
        cylindrical = all(station_normal(member.tooth.blank.axial) == (0.0, 1.0) for member in pair.both)
        if cylindrical and axes_distance > MAX_INTERSECTION_RATIO * float(np.linalg.norm(point - first.origin)):
            across = unit(cross(unit(common_perpendicular), first.axis))
            return ActionPlane(
                "plane parallel to both axes", _crossing(pair), first.axis, across, (of_pinion, "across this axis (mm)")
            )
        along, moved = unit(first.spin - pair.ratio * second.spin), first.velocity(point)
        across = unit(moved - dot(moved, along) * along)
        labels = ("along the axis of the relative motion (mm)", "across this axis (mm)")
        return ActionPlane("pitch plane", _foot(first.origin, along, point), along, across, labels)

    def places(self, points: Array) -> Array:
        """Return places (..., 2), mm, of points (..., 3), fixed frame, projected on the plane."""
        offset = points - self.origin
        return np.stack((offset @ self.along, offset @ self.across), axis=-1)


def _foot(origin: Array, axis: Array, point: Array) -> Array:
    """Return the foot point (3,) on an axis of the perpendicular from a point."""
    return np.asarray(origin + dot(point - origin, axis) * axis)


def _crossing(pair: GearPair) -> Array:
    """Return the point (3,) of the pinion's axis nearest to the gear's."""
    first, second = pair.mounts
    offset = second.origin - first.origin
    cosine = float(dot(first.axis, second.axis))
    way = (dot(offset, first.axis) - cosine * dot(offset, second.axis)) / (1.0 - cosine**2)
    return np.asarray(first.origin + way * first.axis)


@dataclass(frozen=True)
class ZoneOfContact:
    """Contents of the picture of a zone of contact."""

    #: the pair
    pair: GearPair
    #: contact of a tooth pair from first to last contact
    whole: ContactPath
    #: contact of all tooth pairs at `phi1`
    now: ContactPath
    #: rotation of the pinion, rad
    phi1: float
    #: plane of the picture
    plane: ActionPlane
    #: limit lines, by names of members
    limits: Mapping[str, LimitLine]
    #: zone of line contact; None for contact in points or on edges
    zone: ContactZone | None


def zone_of_lines(pair: GearPair, path: ContactPath) -> ContactZone | None:
    """Return the zone of contact of a pair whose flanks touch along lines on a path; None for other contact."""
    return contact_zone(pair) if (path.kind == "line").any() else None


def zone_of_contact(pair: GearPair, whole: ContactPath, now: ContactPath, phi1: float) -> ZoneOfContact:
    """Return the contents of the picture of a zone of contact.

    The contact `whole` belongs to one tooth pair, the contact `now` to all tooth pairs at phi1 (rad).
    """
    zone = zone_of_lines(pair, whole)
    limits = {} if zone is None else limit_lines(pair, zone)
    return ZoneOfContact(pair, whole, now, phi1, ActionPlane.of(pair, whole), limits, zone)
