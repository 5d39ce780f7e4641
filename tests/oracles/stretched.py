"""A tooth between other end faces, for places where the blank of a design never ends."""

from __future__ import annotations

from dataclasses import replace

from gearmesh.kernel.surface.levels import station_normal
from gearmesh.kinds import Tooth


def stretched(tooth: Tooth, toe: float, heel: float) -> Tooth:
    """The tooth between two stations, mm; the ends of the body's profile move with the end faces."""
    blank, (across, up) = tooth.blank, station_normal(tooth.blank.axial)
    profile = list(blank.body.profile)
    for k, station in ((0, toe), (-1, heel)):
        (rho, z), way = profile[k], station - blank.faces[k]
        profile[k] = (rho + across * way, z + up * way)
    body = replace(blank.body, profile=tuple(profile))
    return replace(tooth, blank=replace(blank, extent=(toe, heel), body=body))
