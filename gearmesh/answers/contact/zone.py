"""The zone of contact of a pair: contact lines on the flanks and in the plane of action, what of the flank they pass over, and the
limit lines beyond which there is none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearmesh.contact.path import ContactPath
from gearmesh.contact.zone import ContactZone, LimitLine, contact_zone, limit_lines
from gearmesh.figures import Figures, figure
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.gear_train import GearPair

#: sine of the distance of axes that cross over that of the contact from them up to which they intersect
INTERSECT = 1e-9


@dataclass(frozen=True)
class ZoneFigures(Figures):
    """The zone of contact of flanks that touch along lines."""

    share: float = figure(
        "part of the gear's flank over which contact lines pass", key="contact_zone_share", symbol="A_c/A"
    )
    ends: list[float] = figure("stations of the gear's face between which they do", "mm", key="contact_zone_ends_mm")

    @staticmethod
    def of(zone: ContactZone) -> ZoneFigures:
        """Of a zone of contact."""
        return ZoneFigures(zone.share, zone.ends.tolist())


@dataclass(frozen=True)
class ActionPlane:
    """The plane in which the zone of contact is looked at: axes `along` and `across` (3,) from the `origin` (3,), fixed frame, what
    `labels` say of them, and its `name`."""

    name: str
    origin: Array
    along: Array
    across: Array
    labels: tuple[str, str]

    @staticmethod
    def of(pair: GearPair, path: ContactPath) -> ActionPlane:
        """That of a pair with a path of contact that touches somewhere.

        Of parallel axes the plane of action, through axis and common normal. Of members with cylindrical faces on crossed axes,
        as a worm and its wheel, the plane parallel to both axes, from where the pinion's is nearest to the gear's. Of others the
        pitch plane: through the axis of their relative motion, along their velocities.
        """
        first, second = pair.mounts
        touching = np.flatnonzero(path.touching)
        k = int(touching[len(touching) // 2])
        point, of_pinion = path.point[k], f"along the axis of the {pair.pinion.name} (mm)"
        over = cross(first.axis, second.axis)
        if float(np.linalg.norm(over)) < MAX_SINE_OF_PARALLEL:
            normal = path.normal[k] - dot(path.normal[k], first.axis) * first.axis
            labels = (of_pinion, "along the line of action (mm)")
            origin = _foot(first.origin, first.axis, point)
            return ActionPlane("plane of action", origin, first.axis, unit(normal), labels)
        apart = float(np.abs(dot(second.origin - first.origin, unit(over))))
        cylindrical = all(station_normal(member.tooth.blank.axial) == (0.0, 1.0) for member in pair.both)
        if cylindrical and apart > INTERSECT * float(np.linalg.norm(point - first.origin)):
            across = unit(cross(unit(over), first.axis))
            return ActionPlane(
                "plane parallel to both axes", _crossing(pair), first.axis, across, (of_pinion, "across it (mm)")
            )
        along, moved = unit(first.spin - pair.ratio * second.spin), first.velocity(point)
        across = unit(moved - dot(moved, along) * along)
        labels = ("along the axis of the relative motion (mm)", "across it (mm)")
        return ActionPlane("pitch plane", _foot(first.origin, along, point), along, across, labels)

    def places(self, points: Array) -> Array:
        """Places (..., 2), mm, of points (..., 3), fixed frame, seen at right angles to the plane."""
        away = points - self.origin
        return np.stack((away @ self.along, away @ self.across), axis=-1)


def _foot(origin: Array, axis: Array, point: Array) -> Array:
    """The point (3,) of an axis at right angles to which another is."""
    return np.asarray(origin + dot(point - origin, axis) * axis)


def _crossing(pair: GearPair) -> Array:
    """The point (3,) of the pinion's axis nearest to the gear's."""
    first, second = pair.mounts
    apart = second.origin - first.origin
    cosine = float(dot(first.axis, second.axis))
    way = (dot(apart, first.axis) - cosine * dot(apart, second.axis)) / (1.0 - cosine**2)
    return np.asarray(first.origin + way * first.axis)


@dataclass(frozen=True)
class ZoneOfContact:
    """What the picture of a zone of contact shows: the `pair`, the contact `whole` of a tooth pair from first to last touch, that
    of all tooth pairs `now`, at the rotation `phi1` (rad) of the pinion; `limits` by the members' names, and the `zone`, None of
    flanks that touch in points or on edges."""

    pair: GearPair
    whole: ContactPath
    now: ContactPath
    phi1: float
    plane: ActionPlane
    limits: Mapping[str, LimitLine]
    zone: ContactZone | None


def zone_of_lines(pair: GearPair, path: ContactPath) -> ContactZone | None:
    """The zone of contact of a pair whose flanks touch along lines on a path; None of others."""
    return contact_zone(pair) if (path.kind == "line").any() else None


def zone_of_contact(pair: GearPair, whole: ContactPath, now: ContactPath, phi1: float) -> ZoneOfContact:
    """The zone of contact of a pair with the contact `whole` of a tooth pair, and of all of them `now`, at phi1 (rad)."""
    zone = zone_of_lines(pair, whole)
    limits = {} if zone is None else limit_lines(pair, zone)
    return ZoneOfContact(pair, whole, now, phi1, ActionPlane.of(pair, whole), limits, zone)
