"""The section through a mesh: both gears cut open across the teeth, where they touch, at one position or rolling through a pitch.

The section is at right angles to the pinion's lengths (axis, cone distance) through the contact in the middle of its path; that of
a worm goes through its own axis, across the wheel's: the axial section of one and the middle section of the other. All tooth pairs
in mesh have a dot where they touch; contact outside of the section is seen in the direction of its lengths, and paler.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.answers.contact.rolling import RollingContact
from gearmesh.contact.path import ContactPath
from gearmesh.errors import OutputError
from gearmesh.io.atomic import whole_file
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import GearPair
from gearmesh.view.render import render
from gearmesh.view.scene import BLUE_STEEL, BRASS, Camera, Dots, Scene, SceneBody

#: heights of a tooth that the picture is high, and parts of a pixel by which facets may be off
SEEN, PIXEL = 4.2, 0.08
#: pictures to a pitch, and how long (ms) each stands
FRAMES, STANDS = 24, 70
#: sine of the angle between axes from which on a thread is cut along its own
CROSSED = 0.7
#: what of a point leads to the axis
TO_AXIS = np.array([-1.0, -1.0, 0.0])
#: colour of contact outside of the section
BEYOND = "#e39aa6"
#: colours of the sections
SECTIONS = ("#c3d6ea", "#ecdcbc")


@dataclass(frozen=True)
class MeshSection:
    """Where a mesh is cut, and what is drawn of it while it is `rolling`; `camera` looks at the contact along its lengths."""

    rolling: RollingContact
    meshes: tuple[TriangleMesh, TriangleMesh]
    camera: Camera
    title: str
    size: tuple[int, int]

    @property
    def points(self) -> Array:
        """Where tooth pairs touch (N, K, 3), fixed frame, NaN where they do not."""
        path, engaged = self.rolling.contacts, self.rolling.engaged
        places = np.full((*engaged.shape, 3), np.nan)
        places[engaged] = np.array([self._cut(path, k) for k in range(len(path.rotation))]).reshape(-1, 3)
        return places

    def _cut(self, path: ContactPath, k: int) -> Array:
        """The point of contact of a position, of a contact line where it goes through the section."""
        line = path.lines[k]
        if line is None:
            return np.where(path.touching[k], path.point[k], np.nan)
        beyond = (line - self.camera.focus) @ self.camera.axes[2]
        crossing = np.flatnonzero(beyond[:-1] * beyond[1:] <= 0.0)
        if not crossing.size:
            return np.full(3, np.nan)
        i = int(crossing[0])
        share = beyond[i] / (beyond[i] - beyond[i + 1]) if beyond[i] != beyond[i + 1] else 0.0
        at: Array = line[i] + share * (line[i + 1] - line[i])
        return at

    def scenes(self) -> list[Scene]:
        """All positions, one scene each, with dots where teeth touch."""
        turns = zip(self.rolling.phi1.tolist(), self.rolling.phi2.tolist(), strict=True)
        return [self._scene(turn, points) for turn, points in zip(turns, self.points, strict=True)]

    def _scene(self, turns: tuple[float, float], points: Array) -> Scene:
        bodies = tuple(
            SceneBody(mesh, member.mount.at(turn), paint, yields=True, section=section)
            for mesh, member, turn, paint, section in zip(
                self.meshes, self.rolling.pair.both, turns, (BLUE_STEEL, BRASS), SECTIONS, strict=True
            )
        )
        # on the section, and a little before it
        back = self.camera.axes[2]
        beyond = dot(points - self.camera.focus, back)
        lifted = points + (0.01 * self.camera.height - beyond)[..., None] * back
        outside = self._outside(points)
        dots = [Dots(np.where(outside[:, None], np.nan, lifted), "contact")]
        if self._outside(self.points).any():
            # all pictures of an animation have the same legend
            dots.append(
                Dots(np.where(outside[:, None], lifted, np.nan), "contact before or behind the section", BEYOND)
            )
        return Scene(bodies, self.camera, dots=tuple(dots), title=self.title, size=self.size)

    def _outside(self, points: Array) -> NDArray[np.bool_]:
        """Which points (..., 3) are no contact of the section, but before or behind it, (...,)."""
        beyond = dot(points - self.camera.focus, self.camera.axes[2])
        return np.asarray(np.abs(beyond) > 0.01 * self.camera.height)


def mesh_section(
    rolling: RollingContact, meshes: dict[str, TriangleMesh], size: tuple[int, int], title: str = ""
) -> MeshSection:
    """The section through the contact from which a pair rolls on."""
    pair, path, k = rolling.pair, rolling.path, rolling.middle
    height, axial = _picture_height(pair), _axial_section(pair, path.point[k])
    if axial is None:
        to_fixed = pair.pinion.mount.at(path.rotation[k])
        own, blank = path.point1[k], pair.pinion.tooth.blank
        back = unit(to_fixed.vector(blank.axial.gradient(own)))
        up, focus = to_fixed.vector(unit(TO_AXIS * own)), path.point[k]
    else:
        focus, up, back = axial
    camera = Camera(focus + 4.0 * height * back, focus, up, height, front=0.0)
    first, second = (meshes[name] for name in pair.members)
    return MeshSection(rolling, (first, second), camera, title, size)


def _axial_section(pair: GearPair, contact: Array) -> tuple[Array, Array, Array] | None:
    """Of a worm on a crossed axis, in its axial section across the wheel's axis: the point (3,) nearest to a contact, the way to
    the worm's axis, and that along the wheel's; None of other pairs."""
    first, second = pair.mounts
    over = cross(first.axis, second.axis)
    if pair.pinion.tooth.screw is None or float(np.linalg.norm(over)) < CROSSED:
        return None
    over = unit(over)
    back = unit(cross(over, first.axis))
    back = back * np.sign(dot(back, second.axis))
    up = over * np.sign(dot(first.origin - contact, over))
    return contact - dot(contact - first.origin, back) * back, up, back


def facet(pair: GearPair, size: tuple[int, int]) -> float:
    """Distance (mm) of facets from a surface that is not seen in a picture of a `size` in pixels."""
    return PIXEL * _picture_height(pair) / size[1]


def _picture_height(pair: GearPair) -> float:
    """Height (mm) of what a picture shows."""
    return SEEN * float(np.ptp(FlankFrame.of(pair.pinion, pair.flanks[0]).extent[:, 1]))


def write_animation(file: Path, scenes: list[Scene], size: tuple[int, int] | None = None) -> None:
    """Scenes as a GIF that goes round and round. Raises OutputError for another suffix, and where OpenGL does not work."""
    from PIL import Image

    if file.suffix.lower() != ".gif":
        raise OutputError("cannot write", file, reason="the suffix of an animation must be .gif")
    images = [Image.fromarray(render(scene, size=size)) for scene in scenes]
    # one palette for all, so that nothing flickers
    palette = images[0].quantize(128)
    first, *others = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    with whole_file(file) as unfinished:
        first.save(unfinished, format="GIF", save_all=True, append_images=others, duration=STANDS, loop=0)
