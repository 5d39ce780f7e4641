"""Section through a mesh: both gears cut open across their teeth at the contact, at one position or over one pitch.

The section is perpendicular to the lengths of the pinion (axis, cone distance). It passes through the contact in the
middle of the path. A worm is cut in its axial section, through its axis and perpendicular to the wheel's axis; this is
the middle section of the wheel. Every tooth pair in mesh has a dot at its contact. Contact outside of the section is
projected onto it along the lengths and drawn paler. The picture has the numbers of the teeth; on parallel axes pitch circles,
or the pitch line of a rack, and the line of action where all normals of contact lie on one line; of axes that meet pitch cones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.answers.contact.rolling import RollingContact
from gearmesh.contact.path import ContactPath
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import Side
from gearmesh.view.palette import INK_COLOUR, PATH_COLOUR
from gearmesh.view.scene import PALE_BLUE_PAINT, PALE_BRASS_PAINT, Camera, Curve, Dots, Scene, SceneBody, Word

#: height of the picture, in heights of a tooth
PICTURE_HEIGHT_TOOTH_HEIGHTS = 4.2
#: distance of facets from the exact surface, pixels
FACET_TOLERANCE_PIXELS = 0.08
#: sine of the angle between axes from which a worm is cut in its axial section
MIN_CROSSED_SINE = 0.7
#: factors of a point's coordinates that give the direction to the z axis
AXIS_DIRECTION_FACTORS = np.array([-1.0, -1.0, 0.0])
#: colour of contact outside of the section
OUTSIDE_CONTACT_COLOUR = "#e39aa6"
#: distance of lines in front of the section, as a share of the picture's height
FRONT_SHARE = 0.01
#: points of a pitch circle, or of a pitch cone
CIRCLE_POINTS = 721
#: distance of two axes, as a share of the cone distance, within which they meet
MAX_SHARE_OF_MEETING = 1e-3
#: farthest points of pitch cones, in cone distances
MAX_REACH_SHARE = 3.0
#: sine of the angle, and distance as a share of the picture's height, within which normals lie on one line of action
MAX_SINE_OF_ACTION = 1e-3
#: margin of the picture without tooth numbers, as a share of its sides
NUMBER_MARGIN_SHARE = 0.08
#: stations along the face between which the middle of a tooth is interpolated
FACE_STATIONS = 9
#: colours of the cut faces of pinion and gear
SECTION_COLOURS = ("#c3d6ea", "#ecdcbc")


@dataclass(frozen=True)
class MeshSection:
    """Section through a pair that rolls: the meshes that are cut, and the camera in front of the cut."""

    #: positions of the pair and its contact at each of them
    rolling: RollingContact
    #: meshes of pinion and gear, own frames
    meshes: tuple[TriangleMesh, TriangleMesh]
    #: camera that looks at the contact along the lengths; its front plane is the section
    camera: Camera
    #: title of the pictures
    title: str
    #: width and height of the pictures, pixels
    size: tuple[int, int]

    @property
    def points(self) -> Array:
        """Points of contact (N, K, 3) of K tooth pairs at N positions, fixed frame; NaN without contact."""
        path, engaged = self.rolling.contacts, self.rolling.engaged
        places = np.full((*engaged.shape, 3), np.nan)
        places[engaged] = np.array([self._cut(path, k) for k in range(len(path.rotation))]).reshape(-1, 3)
        return places

    def _cut(self, path: ContactPath, k: int) -> Array:
        """Return the contact points of position k; a contact line is cut by the section, NaN if they do not cross."""
        line = path.lines[k]
        if line is None:
            return np.where(path.touching[k], path.point[k], np.nan)
        return _crossing(line, (line - self.camera.focus) @ self.camera.axes[2])

    def scenes(self) -> list[Scene]:
        """Return one scene for each position, with dots at the contacts."""
        turns = zip(self.rolling.phi1.tolist(), self.rolling.phi2.tolist(), strict=True)
        return [self._scene(turn, points) for turn, points in zip(turns, self.points, strict=True)]

    def _scene(self, turns: tuple[float, float], points: Array) -> Scene:
        bodies = tuple(
            SceneBody(mesh, member.mount.at(turn), paint, yields=True, section=section)
            for mesh, member, turn, paint, section in zip(
                self.meshes,
                self.rolling.pair.both,
                turns,
                (PALE_BLUE_PAINT, PALE_BRASS_PAINT),
                SECTION_COLOURS,
                strict=True,
            )
        )
        # dots are a little in front of the section
        back = self.camera.axes[2]
        beyond = dot(points - self.camera.focus, back)
        lifted = points + (0.01 * self.camera.height - beyond)[..., None] * back
        outside = self._outside(points)
        dots = [Dots(np.where(outside[:, None], np.nan, lifted), "contact")]
        if self._outside(self.points).any():
            # all pictures of an animation need the same legend
            dots.append(
                Dots(
                    np.where(outside[:, None], lifted, np.nan),
                    "contact before or behind the section",
                    OUTSIDE_CONTACT_COLOUR,
                )
            )
        return Scene(
            bodies,
            self.camera,
            curves=self._lines,
            dots=tuple(dots),
            words=tuple(self._tooth_numbers(turns)),
            title=self.title,
            size=self.size,
        )

    @cached_property
    def _pitch_point(self) -> Array | None:
        """Point (3,) of equal velocity in the section, fixed frame, of parallel axes and of racks; None for other axes."""
        first, second = self.rolling.pair.mounts
        centre, ratio = self._in_section(first.origin), self.rolling.pair.ratio
        if not second.spin.any():
            velocity = ratio * second.velocity(second.origin)
            along = abs(float(dot(velocity, first.axis))) > MAX_SINE_OF_PARALLEL * float(np.linalg.norm(velocity))
            return None if along else np.asarray(centre + cross(velocity, first.spin))
        if float(np.linalg.norm(cross(first.axis, second.axis))) > MAX_SINE_OF_PARALLEL:
            return None
        turning = dot(first.spin, first.axis), ratio * dot(second.spin, first.axis)
        if turning[1] in (0.0, turning[0]):
            return None
        return np.asarray(centre + turning[1] / (turning[1] - turning[0]) * (self._in_section(second.origin) - centre))

    @cached_property
    def _pitch_curves(self) -> tuple[str, list[Array]]:
        """Name of the pitch surfaces, and their curves (K, 3) in the section: circles, the line of a rack, or cones.

        Cones are those of axes that meet; other crossed axes have no surfaces that roll on each other.
        """
        mounts, pitch_point = self.rolling.pair.mounts, self._pitch_point
        right, up = self.camera.axes[:2]
        turn = np.linspace(0.0, 2.0 * np.pi, CIRCLE_POINTS)[:, None]
        if pitch_point is None:
            return "pitch cones", self._cones(turn)
        curves = []
        for mount in mounts:
            if mount.spin.any():
                centre = self._in_section(mount.origin)
                radius = float(np.linalg.norm(pitch_point - centre))
                curves.append(centre + radius * (np.cos(turn) * right + np.sin(turn) * up))
            else:
                way = unit(mount.velocity(mount.origin))
                curves.append(pitch_point + np.linspace(-2.0, 2.0, CIRCLE_POINTS)[:, None] * self.camera.height * way)
        racks = not all(mount.spin.any() for mount in mounts)
        return "pitch circle and pitch line" if racks else "pitch circles", curves

    def _cones(self, turn: Array) -> list[Array]:
        """Return the curves (K, 3) in which the section cuts the pitch cones of axes that meet, at angles (K, 1), rad.

        The cones roll on each other: they touch in the axis of the relative motion. Points behind the apex are NaN.
        """
        first, second = self.rolling.pair.mounts
        common, focus, back = cross(first.axis, second.axis), self.camera.focus, self.camera.axes[2]
        if float(np.linalg.norm(common)) < MAX_SINE_OF_PARALLEL or not (first.spin.any() and second.spin.any()):
            return []
        between = second.origin - first.origin
        apex = first.origin + dot(cross(between, second.axis), common) / dot(common, common) * first.axis
        away = focus - apex
        if abs(float(dot(between, unit(common)))) > MAX_SHARE_OF_MEETING * float(np.linalg.norm(away)):
            return []
        line = unit(first.spin - self.rolling.pair.ratio * second.spin)
        line = line * np.sign(dot(line, away))
        cones = []
        for mount in (first, second):
            along = dot(line, mount.axis) * mount.axis
            ways = along + np.cos(turn) * (line - along) + np.sin(turn) * cross(mount.axis, line)
            reach = dot(away, back) / dot(ways, back)
            near = (reach > 0.0) & (reach < MAX_REACH_SHARE * np.linalg.norm(away))
            cones.append(np.where(near[:, None], apex + reach[:, None] * ways, np.nan))
        return cones

    def _in_section(self, point: Array) -> Array:
        """Project points (..., 3) on the section along the axes."""
        back = self.camera.axes[2]
        return np.asarray(point - dot(point - self.camera.focus, back)[..., None] * back)

    def _sees(self, points: Array) -> bool:
        """True if one of the points (K, 3) is within the picture."""
        wide = self.size[0] / self.size[1]
        aside = np.abs((points - self.camera.focus) @ self.camera.axes[:2].T) / (0.5 * self.camera.height)
        return bool((aside < (wide, 1.0)).all(axis=1).any())

    @cached_property
    def _lines(self) -> tuple[Curve, ...]:
        """Curves of the pitch surfaces, and the line of action if all normals of contact lie on one line."""
        pitch_point, back = self._pitch_point, self.camera.axes[2]
        front = FRONT_SHARE * self.camera.height * back
        label, shapes = self._pitch_curves
        seen = [part for shape in shapes if self._sees(shape) for part in (shape + front, np.full((1, 3), np.nan))]
        curves = [Curve(np.concatenate(seen), label, INK_COLOUR, 1.5)] if seen else []
        if pitch_point is None:
            return tuple(curves)
        path = self.rolling.path
        inside = np.isin(path.kind, ("point", "line"))
        normals = path.normal[inside] - dot(path.normal[inside], back)[:, None] * back
        if inside.any():
            way = unit(normals[0])
            aside = cross(self._in_section(path.point[inside]) - pitch_point, way)
            straight = np.linalg.norm(cross(unit(normals), way), axis=-1).max() < MAX_SINE_OF_ACTION
            if straight and np.linalg.norm(aside, axis=-1).max() < MAX_SINE_OF_ACTION * self.camera.height:
                ends = np.array([[-1.0], [1.0]]) * self.camera.height * way
                curves.append(Curve(pitch_point + ends + front, "line of action", PATH_COLOUR, 2.0))
        return tuple(curves)

    def _tooth_numbers(self, turns: tuple[float, float]) -> Iterator[Word]:
        """Yield the numbers of the teeth in the picture, where the section cuts the line through their middles.

        Threads have none.
        """
        margin, back = NUMBER_MARGIN_SHARE * np.array(self.size), self.camera.axes[2]
        for member, turn in zip(self.rolling.pair.both, turns, strict=True):
            tooth = member.tooth
            if tooth.screw is not None:
                continue
            steps = np.linspace(0.0, 1.0, FACE_STATIONS)
            middle = np.mean([tooth.flank_grid(side, np.array([0.5]), steps).points[0] for side in Side], axis=0)
            places = tooth.joint.places(tooth.teeth)
            moved = member.mount.at(turn) @ tooth.joint.to(places * tooth.pitch_angle)
            lines = np.einsum("kij,nj->kni", moved.rotation, middle) + moved.translation[..., None, :]
            own = np.array([_crossing(line, (line - self.camera.focus) @ back) for line in lines])
            known = np.isfinite(own[:, 0])
            axis = self._in_section(member.mount.origin)
            for number, place in zip(places[known].tolist(), own[known], strict=True):
                pixel = self.camera.pixels(place, self.size)[:2]
                if (pixel > margin).all() and (pixel < np.array(self.size) - margin).all():
                    yield Word(str(number), place, axis)

    def _outside(self, points: Array) -> NDArray[np.bool_]:
        """True (...,) for contact points (..., 3) that lie before or behind the section."""
        beyond = dot(points - self.camera.focus, self.camera.axes[2])
        return np.asarray(np.abs(beyond) > 0.01 * self.camera.height)


def _crossing(line: Array, beyond: Array) -> Array:
    """Return the first point (3,) of a polyline (N, 3) at which its distance `beyond` (N,) of a plane is 0, or NaN."""
    crossing = np.flatnonzero(beyond[:-1] * beyond[1:] <= 0.0)
    if not crossing.size:
        return np.full(3, np.nan)
    i = int(crossing[0])
    share = beyond[i] / (beyond[i] - beyond[i + 1]) if beyond[i] != beyond[i + 1] else 0.0
    return np.asarray(line[i] + share * (line[i + 1] - line[i]))


def mesh_section(
    rolling: RollingContact, meshes: dict[str, TriangleMesh], size: tuple[int, int], title: str = ""
) -> MeshSection:
    """Return the section through the contact in the middle of the path, from which the pair rolls on."""
    pair, path, k = rolling.pair, rolling.path, rolling.middle
    height, axial = _picture_height(pair), _axial_section(pair, path.point[k])
    if axial is None:
        to_fixed = pair.pinion.mount.at(path.rotation[k])
        own, blank = path.point1[k], pair.pinion.tooth.blank
        back = unit(to_fixed.vector(blank.axial.gradient(own)))
        up, focus = to_fixed.vector(unit(AXIS_DIRECTION_FACTORS * own)), path.point[k]
    else:
        focus, up, back = axial
    camera = Camera(focus + 4.0 * height * back, focus, up, height, front=0.0)
    first, second = (meshes[name] for name in pair.members)
    return MeshSection(rolling, (first, second), camera, title, size)


def _axial_section(pair: GearPair, contact: Array) -> tuple[Array, Array, Array] | None:
    """Return the axial section of a worm on a crossed axis; None for every other pair.

    The plane contains the worm's axis and is perpendicular to the wheel's axis. Returned are the point (3,) of it that
    is nearest to the contact, the direction towards the worm's axis, and the direction along the wheel's axis.
    """
    worm, wheel = pair.mounts
    common = cross(worm.axis, wheel.axis)
    if pair.pinion.tooth.screw is None or float(np.linalg.norm(common)) < MIN_CROSSED_SINE:
        return None
    common = unit(common)
    back = unit(cross(common, worm.axis))
    back = back * np.sign(dot(back, wheel.axis))
    up = common * np.sign(dot(worm.origin - contact, common))
    return contact - dot(contact - worm.origin, back) * back, up, back


def facet(pair: GearPair, size: tuple[int, int]) -> float:
    """Return the tolerance (mm) of facets that cannot be seen in a picture of a `size` in pixels."""
    return FACET_TOLERANCE_PIXELS * _picture_height(pair) / size[1]


def _picture_height(pair: GearPair) -> float:
    """Height (mm) of the part of the scene in the picture."""
    return PICTURE_HEIGHT_TOOTH_HEIGHTS * float(np.ptp(FlankFrame.of(pair.pinion, pair.flanks[0]).extent[:, 1]))
