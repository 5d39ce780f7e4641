"""The gear body under the teeth: its profile, with a region for every band of it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.region import END_EDGES, END_FACES, HEEL_END, TOE_END, Region


@dataclass(frozen=True)
class Disc:
    """Web of a body; lengths in mm."""

    #: radius of the hub
    inner: float
    #: inner radius of the rim
    outer: float
    #: z of the lower face
    low: float
    #: z of the upper face
    high: float


@dataclass(frozen=True)
class TurnedStep:
    """Step of a shaft or bore; lengths in mm."""

    #: radius where the step begins
    radius: float
    #: radius where it ends; different for a cone
    end_radius: float
    #: length along the axis
    length: float
    #: region of the faces
    region: Region


@dataclass(frozen=True)
class PlaneFace:
    """Plane end of a body between two radii; lengths in mm."""

    #: position along the axis
    z: float
    #: smaller radius
    inner: float
    #: larger radius
    outer: float
    #: True if the face looks to larger z
    up: bool

    def covers(self, reach: tuple[float, float]) -> bool:
        """True if the face contains everything between two radii.

        `reach`: smallest and largest radius, mm.
        """
        return self.inner <= reach[0] and reach[1] <= self.outer


@dataclass(frozen=True)
class Body:
    """Body of revolution under the teeth, or around the teeth of an internal gear.

    `profile`: points (rho, z), mm, in the axial half plane. They run from the end face where the teeth begin (t = 0),
    round the side away from the teeth, to the end face where they end. `bands`: region of each band between
    neighbouring points.
    """

    profile: tuple[tuple[float, float], ...]
    bands: tuple[Region, ...]

    @staticmethod
    def disk(bore: float, toe: tuple[float, float], heel: tuple[float, float], *faces: float) -> Body:
        """Return a disk with a bore of a radius (mm; 0: none).

        `toe` and `heel` are (rho, z), mm, where the end faces meet the teeth. The ends of the bore lie at their z, or at the
        two z of `faces`, mm.
        """
        low, high = faces or (toe[1], heel[1])
        profile = [toe, (bore, low), (bore, high), heel]
        return Body(tuple(profile), (Region.FACE_TOE, Region.BORE, Region.FACE_HEEL))

    @staticmethod
    def tube(radius: float, toe: float, heel: float, band: Region = Region.BORE) -> Body:
        """Return the body between toothed end faces at z = toe and heel (mm) and a cylinder.

        - radius: radius of the cylinder, mm.
        - band: region of the cylinder: the bore, or the rim of an internal gear.
        """
        return Body(((radius, toe), (radius, heel)), (band,))

    @staticmethod
    def hub_and_rim(bore: float, web: Disc, toe: float, heel: float) -> Body:
        """Return a hub with a bore of a radius (mm), a web, and a rim that bears the teeth.

        Hub and rim are between end faces at z = toe and heel, mm.
        """
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

    def with_recess(self, web: Disc) -> Body:
        """Return a disk with a recess in its heel face, between the radii of a web that reaches to its toe face."""
        last, (_, high) = self.bore_band + 1, self.profile[self.bore_band + 1]
        recess = [(web.inner, high), (web.inner, web.high), (web.outer, web.high), (web.outer, high)]
        bands = (*self.bands[: last + 1], *(Region.WEB,) * 3, *self.bands[last:])
        return Body((*self.profile[: last + 1], *recess, *self.profile[last + 1 :]), bands)

    def shift(self, rise: float) -> Body:
        """Return the body moved along z by `rise`, mm."""
        return Body(tuple((rho, z + rise) for rho, z in self.profile), self.bands)

    def with_steps(self, toe: Sequence[TurnedStep], heel: Sequence[TurnedStep]) -> Body:
        """Return the body with steps of hub or shaft on its end faces, round the bore, from the body outwards."""
        points, names = list(self.profile), list(self.bands)
        for steps, heelward in ((heel, True), (toe, False)):
            if not steps:
                continue
            at = names.index(Region.BORE) + heelward
            bore, face = points[at]
            step_points, bands = _turned_steps(steps, bore, face, 1.0 if heelward else -1.0)
            # from the bore's end to the body; at the toe the other way round
            points[at : at + 1] = step_points if heelward else step_points[::-1]
            names[at:at] = bands if heelward else bands[::-1]
            last = at + len(step_points) - 1 if heelward else at
            neighbour = last + 1 if heelward else last - 1
            if 0 <= neighbour < len(points) and points[neighbour] == points[last]:
                # a step as wide as the hub of the web leaves no face between them
                del points[last], names[last if heelward else last - 1]
        return Body(tuple(points), tuple(names))

    def with_stepped_bore(self, toe: Sequence[TurnedStep], heel: Sequence[TurnedStep]) -> Body:
        """Return the body with steps of its bore, or of the outside of a ring, from the ends inwards."""
        points, names, band = list(self.profile), list(self.bands), Region.RIM if self.around else Region.BORE
        # the end of the profile first: its steps of a ring have the region of its outside
        for steps, heelward in ((heel, True), (toe, False))[:: self.rise]:
            if not steps:
                continue
            last = heelward != self.around
            at = names.index(band) + last
            inwards = -1.0 if heelward else 1.0
            radius, z = points[at]
            step_points = [(steps[0].radius, z)]
            for step, after in zip(steps, (*(step.radius for step in steps[1:]), radius), strict=True):
                z += inwards * step.length
                step_points += [(step.radius, z), (after, z)]
            bands = [steps[0].region] * (len(step_points) - 1)
            points[at : at + 1] = step_points[::-1] if last else step_points
            names[at:at] = bands
        return Body(tuple(points), tuple(names))

    @property
    def rise(self) -> int:
        """+1 if the profile ends at larger z than it begins, -1 for an internal gear."""
        return -1 if self.around else 1

    def plane_faces(self, flat_ends: bool) -> list[PlaneFace]:
        """Return the plane faces of the body, and those of the teeth if these end on planes (`flat_ends`).

        Faces of teeth have no bound at the teeth.
        """
        made = [
            PlaneFace(z, min(rho, other), max(rho, other), other > rho)
            for (rho, z), (other, end) in pairwise(self.profile)
            if z == end and rho != other
        ]
        for (rho, z), up in zip((self.profile[0], self.profile[-1]), (self.around, not self.around), strict=True):
            if flat_ends:
                made.append(PlaneFace(z, *((0.0, rho) if self.around else (rho, np.inf)), up))
        return made

    def levels(self, reach: tuple[float, float], flat_ends: bool, depth: float | None = None) -> tuple[float, float]:
        """Return the two z (mm) between which an opening cuts the body, all through or to a depth (mm) from the heel's face.

        `reach`: smallest and largest radius of the opening, mm. `flat_ends` as in `plane_faces`. Raises ValueError if the
        opening does not begin and end on one plane each.
        """
        faces = sorted((face for face in self.plane_faces(flat_ends) if face.covers(reach)), key=lambda face: face.z)
        through = len(faces) == 2
        if depth is None and through:
            return faces[0].z, faces[1].z
        heel = next((face.z for face in faces if face.up), None)
        if depth is not None and heel is not None and (not through or depth < faces[1].z - faces[0].z):
            return heel - depth, heel
        raise ValueError("does not go from one plane face to another")

    @property
    def web(self) -> Disc | None:
        """The web, None if there is none."""
        ends = [self.profile[k : k + 2] for k, band in enumerate(self.bands) if band is Region.WEB]
        if not ends:
            return None
        inner, outer = (pick(rho for pair in ends for rho, _ in pair) for pick in (min, max))
        levels = {one[1] for one, other in ends if one[1] == other[1]}
        # with one recess the web goes on to the other end face
        low, high = sorted(levels if len(levels) == 2 else levels | {self.profile[self.bore_band][1]})
        return Disc(inner, outer, low, high)

    @property
    def without_web(self) -> Body:
        """The body with the recesses beside its web filled."""
        if self.web is None:
            return self
        if Region.WEB not in (self.bands[0], self.bands[-1]):
            return Body.disk(self.bore_radius, self.profile[0], self.profile[-1])
        return Body.tube(self.bore_radius, self.profile[0][1], self.profile[-1][1])

    @property
    def bore_radius(self) -> float:
        """Radius (mm) of the bore, 0 if there is none."""
        return next((self.profile[k][0] for k, band in enumerate(self.bands) if band is Region.BORE), 0.0)

    @property
    def bore_diameter(self) -> float | None:
        """Diameter (mm) of the bore, 0 if there is none; None for a bar."""
        return None if Region.BACK in self.bands else 2.0 * self.bore_radius

    @property
    def solid(self) -> bool:
        """True if the body is a disk that reaches to its axis."""
        return self.genus == 0 and Region.BACK not in self.bands

    @property
    def bore_band(self) -> int:
        """Number of the band that is the bore. Raises ValueError if there is none."""
        return self.bands.index(Region.BORE)

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest z, mm."""
        z = [point[1] for point in self.profile]
        return min(z), max(z)

    @property
    def genus(self) -> int:
        """1 for a body with a hole along its axis, 0 for a body without, such as a bar."""
        return 0 if Region.BACK in self.bands or any(rho == 0.0 for rho, _ in self.profile) else 1

    @property
    def around(self) -> bool:
        """True if the body lies around the teeth, as that of an internal gear."""
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
        """Return the volume (mm^3) between profile and axis, signed by the direction of z from toe to heel."""
        rho, z = np.array(self.profile).T
        return float(np.pi / 3.0 * (np.diff(z) @ (rho[1:] ** 2 + rho[1:] * rho[:-1] + rho[:-1] ** 2)))

    def enclosed_volume(self) -> float:
        """Return the volume (mm^3) between the profile and the straight line from heel to toe, signed by its sense."""
        closed = np.array((*self.profile, self.profile[0]))
        rho, rise = closed[:, 0], np.diff(closed[:, 1])
        return float(np.pi / 3.0 * (rise @ (rho[1:] ** 2 + rho[1:] * rho[:-1] + rho[:-1] ** 2)))


def _turned_steps(
    steps: Sequence[TurnedStep], bore: float, face: float, sense: float
) -> tuple[list[tuple[float, float]], list[Region]]:
    """Return points (rho, z) from the bore's end over all steps down to the body's face, and the regions of the bands
    between.

    `face`: z of the body's face; `sense`: +1 at the heel, -1 at the toe.
    """
    ends = face + sense * np.cumsum([step.length for step in steps])
    points, bands = [(bore, float(ends[-1]))], list[Region]()
    for k in range(len(steps) - 1, -1, -1):
        step, start = steps[k], float(ends[k - 1]) if k else face
        if points[-1] != (step.end_radius, float(ends[k])):
            points.append((step.end_radius, float(ends[k])))
            bands.append(step.region)
        points.append((step.radius, start))
        bands.append(step.region)
    return points, bands


def end_names(level: Level) -> tuple[str, str]:
    """Names of the ends at t = 0 and t = 1 of teeth on stations of a level.

    Between plane end faces the toe is the end at smaller z. Teeth of an internal gear end there; other teeth begin
    there.
    """
    across, up = station_normal(level)
    return (HEEL_END, TOE_END) if across == 0.0 and up < 0.0 else (TOE_END, HEEL_END)


def end_edges(level: Level) -> tuple[Region, Region]:
    """Regions of the broken edges at the ends t = 0 and t = 1 on stations of a level."""
    first, last = (END_EDGES[name] for name in end_names(level))
    return first, last


def end_regions(level: Level) -> tuple[Region, Region]:
    """Regions of the toothed end faces at t = 0 and t = 1 on stations of a level: planes, cones or cylinders."""
    across, up = station_normal(level)
    if across == 0.0:
        first, last = (END_FACES[name] for name in end_names(level))
        return first, last
    return (Region.INNER_CYLINDER, Region.OUTER_CYLINDER) if up == 0.0 else (Region.FRONT_CONE, Region.BACK_CONE)
