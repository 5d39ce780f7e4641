"""The section through a mesh: both gears cut open across the teeth, where they touch, at one position or rolling through a pitch.

The section stands at right angles to the pinion's lengths (axis, cone distance) through the contact in the middle of its path. All
pairs of teeth in mesh have a dot where they touch; contact outside of the section is seen in the direction of its lengths.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmesh.contact.cycle import engagement_range
from gearmesh.contact.engagement import engaged
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError, OutputError
from gearmesh.io.atomic import whole_file
from gearmesh.kernel.algebra import Array, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.train import GearPair
from gearmesh.view.render import render
from gearmesh.view.scene import BLUE_STEEL, BRASS, Camera, Dots, Scene, SceneBody

#: heights of a tooth that the picture is high
SEEN = 4.2
#: pictures to a pitch, and how long (ms) each stands
FRAMES, STANDS = 24, 70
#: what of a point leads to the axis
TO_AXIS = np.array([-1.0, -1.0, 0.0])
#: neighbouring pairs of teeth that are looked for, either way
NEIGHBOURS = 4
#: colours of the sections
SECTIONS = ("#c3d6ea", "#ecdcbc")


@dataclass(frozen=True)
class MeshSection:
    """Where a mesh is cut, and what is needed to draw it at any rotation of the pinion.

    `camera` looks along the pinion's lengths at the contact; `phi` (rad) are rotations of pinion and gear that belong together;
    `within`: the pinion's between which a pair of teeth is engaged.
    """

    pair: GearPair
    meshes: tuple[TriangleMesh, TriangleMesh]
    camera: Camera
    phi: tuple[float, float]
    within: tuple[float, float]
    title: str
    size: tuple[int, int]

    def points(self, phi1: Array) -> Array:
        """Where pairs of teeth touch at rotations phi1 (N,), rad: (N, 2 NEIGHBOURS + 1, 3), fixed frame, NaN where they do not."""
        turns = phi1[:, None] + self.pair.pitch * np.arange(-NEIGHBOURS, NEIGHBOURS + 1)
        found = np.full((*turns.shape, 3), np.nan)
        low, high = self.within
        engaged_at = (turns >= low) & (turns <= high)
        path = contact_path(solver_pair(self.pair), turns[engaged_at], None)
        found[engaged_at] = np.array([self._cut(path, k) for k in range(len(path.rotation))]).reshape(-1, 3)
        return found

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

    def scene(self, phi1: float, points: Array) -> Scene:
        """At a rotation phi1 (rad), with dots at points (K, 3)."""
        turns = phi1, self.phi[1] + self.pair.ratio * (phi1 - self.phi[0])
        bodies = tuple(
            SceneBody(mesh, member.mount.at(turn), paint, yields=True, section=section)
            for mesh, member, turn, paint, section in zip(
                self.meshes, self.pair.both, turns, (BLUE_STEEL, BRASS), SECTIONS, strict=True
            )
        )
        # on the section, and a little before it
        back = self.camera.axes[2]
        lifted = points - dot(points - self.camera.focus, back)[..., None] * back + 0.01 * self.camera.height * back
        return Scene(bodies, self.camera, dots=(Dots(lifted, "contact"),), title=self.title, size=self.size)

    def frames(self, count: int = FRAMES) -> list[Scene]:
        """`count` scenes over one pitch, after which everything is as it was."""
        phi1 = self.phi[0] + self.pair.pitch * np.arange(count) / count
        return [self.scene(float(turn), points) for turn, points in zip(phi1, self.points(phi1), strict=True)]


def mesh_section(
    pair: GearPair,
    meshes: dict[str, TriangleMesh],
    path: ContactPath,
    size: tuple[int, int],
    title: str = "",
) -> MeshSection:
    """The section through the contact in the middle of a path. Raises NoSolutionError where flanks never meet."""
    followed = engaged(solver_pair(pair), pair.pitch)
    touching = np.flatnonzero(path.touching)
    if followed is None or not touching.size:
        raise NoSolutionError("the flanks never meet: reduce the assembly errors")
    k = int(touching[len(touching) // 2])
    to_fixed = pair.pinion.mount.at(path.rotation[k])
    own, blank = path.point1[k], pair.pinion.tooth.blank
    back = unit(to_fixed.vector(blank.axial.gradient(own)))
    up = to_fixed.vector(unit(TO_AXIS * own))
    height = SEEN * float(np.ptp(FlankFrame.of(pair.pinion, pair.flanks[0]).extent[:, 1]))
    focus = path.point[k]
    camera = Camera(focus + 4.0 * height * back, focus, up, height, front=0.0)
    first, second = (meshes[name] for name in pair.members)
    within = engagement_range(followed, pair.pitch)
    return MeshSection(
        pair, (first, second), camera, (float(path.rotation[k]), float(path.phi2[k])), within, title, size
    )


def write_animation(file: Path, scenes: list[Scene], size: tuple[int, int] | None = None) -> None:
    """Scenes as a GIF that goes round and round. Raises OutputError for another suffix, and where OpenGL does not work."""
    from PIL import Image

    if file.suffix.lower() != ".gif":
        raise OutputError(f"cannot write {file}: an animation ends in .gif")
    images = [Image.fromarray(render(scene, size=size)) for scene in scenes]
    # one palette for all, so that nothing flickers
    palette = images[0].quantize(128)
    first, *others = (image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images)
    with whole_file(file) as unfinished:
        first.save(unfinished, format="GIF", save_all=True, append_images=others, duration=STANDS, loop=0)


def at_middle(section: MeshSection) -> Scene:
    """The section at the position through whose contact it goes."""
    points = section.points(np.array([section.phi[0]]))
    return section.scene(section.phi[0], points[0])
