"""The gear body under the teeth: its profile, with a name for every band of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.teeth.region import Region


@dataclass(frozen=True)
class Disc:
    """The web of a body, mm: radii of hub and rim, which it joins, and z of its faces."""

    inner: float
    outer: float
    low: float
    high: float


@dataclass(frozen=True)
class Body:
    """A body of revolution under (or, of an internal gear, around) the teeth.

    `profile`: points (rho, z), mm, in the axial half plane, from the toe's end face round by the side away from the teeth to
    the heel's; `bands`: the region of each band between neighbouring points.
    """

    profile: tuple[tuple[float, float], ...]
    bands: tuple[Region, ...]

    @staticmethod
    def disk(bore: float, toe: tuple[float, float], heel: tuple[float, float], *faces: float) -> Body:
        """A disk with a bore of radius `bore` (mm; 0: none), its end faces at the points (rho, z) of toe and heel.

        `faces`: z of the bore's ends where these are not those of toe and heel.
        """
        low, high = faces or (toe[1], heel[1])
        profile = [toe, (bore, low), (bore, high), heel]
        return Body(tuple(profile), (Region.FACE_TOE, Region.BORE, Region.FACE_HEEL))

    @staticmethod
    def tube(radius: float, toe: float, heel: float, band: Region = Region.BORE) -> Body:
        """What is left between toothed end faces at z = toe and heel and a cylinder: a bore, or the rim of an internal gear."""
        return Body(((radius, toe), (radius, heel)), (band,))

    @staticmethod
    def hub_and_rim(bore: float, web: Disc, toe: float, heel: float) -> Body:
        """Hub and rim between end faces at z = toe and heel, and a web between them; the rim bears the teeth."""
        profile = [
            (web.outer, toe),
            (web.outer, web.low),
            (web.inner, web.low),
            (web.inner, toe),
            (bore, toe),
            (bore, heel),
            (web.inner, heel),
            (web.inner, web.high),
            (web.outer, web.high),
            (web.outer, heel),
        ]
        recess = (Region.WEB,) * 3
        return Body(tuple(profile), (*recess, Region.FACE_TOE, Region.BORE, Region.FACE_HEEL, *recess))

    def shift(self, rise: float) -> Body:
        """The body moved along z by `rise` (mm)."""
        return Body(tuple((rho, z + rise) for rho, z in self.profile), self.bands)

    def with_hub(self, radius: float, length: float) -> Body:
        """The body with a hub of some outer radius and length (mm) on its heel, round the bore."""
        last, high = self.bore_band + 1, self.ends[1]
        points, names, top = list(self.profile), list(self.bands), high + length
        points[last : last + 1] = [(self.bore_radius, top), (radius, top), (radius, high)]
        names[last:last] = [Region.HUB, Region.HUB]
        if points[last + 3 : last + 4] == [(radius, high)]:
            # as wide as that of the web: no face between them
            del points[last + 2], names[last + 2]
        return Body(tuple(points), tuple(names))

    @property
    def web(self) -> Disc | None:
        """Its web, None where it has none."""
        ends = [self.profile[k : k + 2] for k, band in enumerate(self.bands) if band is Region.WEB]
        if not ends:
            return None
        inner, outer = (pick(rho for pair in ends for rho, _ in pair) for pick in (min, max))
        low, high = sorted({one[1] for one, other in ends if one[1] == other[1]})
        return Disc(inner, outer, low, high)

    @property
    def without_web(self) -> Body:
        """The body with the recesses beside its web filled."""
        return self if self.web is None else Body.tube(self.bore_radius, self.profile[0][1], self.profile[-1][1])

    @property
    def bore_radius(self) -> float:
        """Radius (mm) of the bore, 0 where there is none."""
        return next((self.profile[k][0] for k, band in enumerate(self.bands) if band is Region.BORE), 0.0)

    @property
    def bore_diameter(self) -> float | None:
        """Diameter (mm) of the bore, 0 where there is none; None of a bar."""
        return None if Region.BACK in self.bands else 2.0 * self.bore_radius

    @property
    def solid(self) -> bool:
        """True where it is a disk that goes down to its axis."""
        return self.genus == 0 and Region.BACK not in self.bands

    @property
    def bore_band(self) -> int:
        """Number of the band that is the bore. Raises ValueError where there is none."""
        return self.bands.index(Region.BORE)

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest z, mm."""
        z = [point[1] for point in self.profile]
        return min(z), max(z)

    @property
    def genus(self) -> int:
        """0 for a body without a hole along its axis, such as a bar, 1 for one that has it."""
        return 0 if Region.BACK in self.bands or any(rho == 0.0 for rho, _ in self.profile) else 1

    @property
    def around(self) -> bool:
        """True where the body lies around the teeth, as that of an internal gear."""
        return Region.RIM in self.bands

    @property
    def without_bore(self) -> Body:
        """The body with its bore filled."""
        if Region.BORE not in self.bands:
            return self
        first = self.bore_band
        filled = [(0.0 if k in (first, first + 1) else rho, z) for k, (rho, z) in enumerate(self.profile)]
        return Body(tuple(filled), self.bands)

    def cut_off(self) -> float:
        """Volume (mm^3) between profile and axis; signed by the direction of z from toe to heel."""
        rho, z = np.array(self.profile).T
        return float(np.pi / 3.0 * (np.diff(z) @ (rho[1:] ** 2 + rho[1:] * rho[:-1] + rho[:-1] ** 2)))

    def enclosed_volume(self) -> float:
        """Volume (mm^3) between the profile, closed by the straight line from heel to toe, and itself; signed by its sense."""
        closed = np.array((*self.profile, self.profile[0]))
        rho, rise = closed[:, 0], np.diff(closed[:, 1])
        return float(np.pi / 3.0 * (rise @ (rho[1:] ** 2 + rho[1:] * rho[:-1] + rho[:-1] ** 2)))


def end_regions(level: Level) -> tuple[Region, Region]:
    """Regions of the toothed end faces at toe and heel on stations of a level: planes, cones or cylinders."""
    across, up = station_normal(level)
    if across == 0.0:
        return Region.FACE_TOE, Region.FACE_HEEL
    return (Region.INNER_CYLINDER, Region.OUTER_CYLINDER) if up == 0.0 else (Region.FRONT_CONE, Region.BACK_CONE)
