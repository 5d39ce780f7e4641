"""What is in a picture, as data; `views` composes scenes of gears, `render` turns a scene into pixels.

A flank picture stands in its member's own frame (axis along z), the picture of the pair in the fixed frame.
Lengths are in mm, angles in rad, colours "#rrggbb". NaN points cut curves, areas and maps off.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.path import ContactPath
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import HEEL_END, TOE_END
from gearmesh.view.palette import COMPOUND, OUTLINE, PATH

Project = Callable[[Array], Array]


@dataclass(frozen=True)
class Paint:
    """Colour of a body: one for all, and others for regions named in full or by their first word ("flank")."""

    colour: str
    regions: Mapping[str, str] = field(default_factory=dict)

    def of(self, region: str) -> str:
        return self.regions.get(region, self.regions.get(region.split("_")[0], self.colour))


STEEL = Paint("#b3bbc3", {"flank": "#d3d9df", "fillet": "#c2cad2"})
DULL_STEEL = Paint("#d9dee3", {"flank": "#e4e8ec", "fillet": "#dfe4e8"})
BLUE_STEEL = Paint("#8ba9c9", {"flank": "#a5c0dc", "fillet": "#98b4d2"})
BRONZE = Paint("#b98d72", {"flank": "#cda68d", "fillet": "#c39a80"})
BRASS = Paint("#cdae7a", {"flank": "#dfc595", "fillet": "#d6ba88"})
TOOL = Paint("#7f93c9", {"flank": "#92a6dc", "fillet": "#d98f5c"})


@dataclass(frozen=True)
class SceneBody:
    """A mesh at its place in the picture; `yields` lets other bodies win where both have nearly the same depth.

    `section` is the colour of its inside where it is cut open to be looked at; its edges are not drawn then. Where `opacity` is
    below 1 what is behind it is seen through it.
    """

    mesh: TriangleMesh
    own_to_scene: Rigid
    paint: Paint
    yields: bool = False
    section: str | None = None
    opacity: float = 1.0


@dataclass(frozen=True)
class Curve:
    """Polyline through `points` (K, 3), broken at NaN; `width` in pixels."""

    points: Array
    label: str = ""
    colour: str = OUTLINE
    width: float = 2.0


@dataclass(frozen=True)
class Dots:
    """Marks at `points` (K, 3); `size` in pixels."""

    points: Array
    label: str = ""
    colour: str = PATH
    size: float = 12.0


@dataclass(frozen=True)
class PatternArea:
    """Filled part of a surface patch `points` (M, N, 3): all of it, or where `level` (M, N) is at most 1."""

    points: Array
    level: Array | None = None
    label: str = ""
    colour: str = COMPOUND


@dataclass(frozen=True)
class ValueMap:
    """Surface patches `points` (..., M, N, 3) coloured by `values` (..., M, N) from 0 to `limit`, with NaN or beyond not drawn."""

    points: Array
    values: Array
    limit: float
    label: str = "gap (µm)"


@dataclass(frozen=True)
class Camera:
    """A camera at `position` looking at `focus` (3,); `height` mm of the scene at the focus fill the picture.

    Of bodies that yield what stands more than `front` mm before the focus is cut away, if that is given.
    """

    position: Array
    focus: Array
    up: Array
    height: float
    parallel: bool = True
    front: float | None = None

    @property
    def axes(self) -> Array:
        """Rows: unit vectors to the right, up and towards the viewer, (3, 3)."""
        back = unit(self.position - self.focus)
        right = unit(cross(self.up, back))
        return np.stack((right, cross(back, right), back))

    @property
    def distance(self) -> float:
        return float(np.linalg.norm(self.position - self.focus))

    def pixels(self, points: Array, size: tuple[int, int]) -> Array:
        """Where points (..., 3) appear: pixels from the left, from the top, and depth from the camera in mm."""
        seen = (points - self.position) @ self.axes.T
        depth = -seen[..., 2]
        scale = size[1] / self.height * (np.ones_like(depth) if self.parallel else self.distance / depth)
        return np.stack((size[0] / 2 + scale * seen[..., 0], size[1] / 2 - scale * seen[..., 1], depth), axis=-1)


@dataclass(frozen=True)
class Word:
    """A word at a point (3,), written beyond it as seen from `inside` (3,); `beyond`: what it names is outside of the picture."""

    text: str
    point: Array
    inside: Array
    beyond: bool = False


#: part of a picture's width that its bodies take where a colour bar stands beside them
BESIDE_BAR = 0.885


def beside_bar(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height, pixels, of what is left of a picture beside a colour bar."""
    return round(BESIDE_BAR * size[0]), size[1]


@dataclass(frozen=True)
class Scene:
    """All that a picture shows; `size` in pixels, width by height. With `maps` the camera sees what is beside their colour bar."""

    bodies: tuple[SceneBody, ...]
    camera: Camera
    curves: tuple[Curve, ...] = ()
    dots: tuple[Dots, ...] = ()
    areas: tuple[PatternArea, ...] = ()
    maps: tuple[ValueMap, ...] = ()
    words: tuple[Word, ...] = ()
    title: str = ""
    size: tuple[int, int] = (1600, 1200)


#: positions are the same that are this part of the engagement from each other
SAME = 1e-9


@dataclass(frozen=True)
class MemberContact:
    """The contact of P positions as one member sees it, in its own frame: what a flank picture draws.

    point, normal (out of the member), major, minor (P, 3); semi_major, semi_minor (P,) in mm, NaN where there is
    no ellipse; edge (P,) True for edge contact; lines: contact lines (K, 3), one per position or None; curve: points and normals
    (W, 3) of the path of contact where it is known better than by the positions.
    """

    point: Array
    normal: Array
    major: Array
    minor: Array
    semi_major: Array
    semi_minor: Array
    edge: NDArray[np.bool_]
    lines: tuple[Array | None, ...] = ()
    curve: tuple[Array, Array] | None = None

    @property
    def path(self) -> tuple[Array, Array]:
        """Points and normals (W, 3) of the path of contact; NaN along contact lines: which of their points a solver reports means
        nothing."""
        if self.curve is not None:
            return self.curve
        point = self.point.copy()
        point[self.along_lines] = np.nan
        return point, self.normal

    @property
    def places(self) -> Array:
        """Points (K, 3) between which all contact is: of the path and of contact lines, and ends of ellipses."""
        chosen = self.ellipses
        reach = self.semi_major[chosen, None] * self.major[chosen]
        lines = [line for line in self.lines if line is not None]
        points = (self.point, self.path[0], self.point[chosen] + reach, self.point[chosen] - reach, *lines)
        every = np.concatenate(points)
        return every[np.isfinite(every[:, 0])]

    @property
    def middle(self) -> Array:
        """Point (3,) at the middle one of the positions with contact, of a contact line its middle one."""
        known = np.flatnonzero(np.isfinite(self.point[:, 0]))
        k = int(known[len(known) // 2])
        line = self.lines[k] if self.lines else None
        if line is None:
            return np.asarray(self.point[k])
        line = line[np.isfinite(line[:, 0])]
        return np.asarray(line[len(line) // 2])

    @property
    def ellipses(self) -> NDArray[np.int64]:
        """Indices of the positions that have an ellipse."""
        return np.flatnonzero(np.isfinite(self.semi_major + self.semi_minor + self.point[:, 0]))

    @property
    def along_lines(self) -> NDArray[np.int64]:
        """Indices of the positions that have a contact line."""
        return np.array([i for i, line in enumerate(self.lines) if line is not None], dtype=np.int64)


def contact_on(
    member: int, path: ContactPath, mounts: tuple[Mount, Mount], whole: ContactPath | None = None
) -> MemberContact:
    """The contact path in the own frame of the pinion (0) or the gear (1), its curve with the positions of the `whole` path too."""
    own = _own_contact(member, path, mounts)
    (points, normals), edge, rotation = own.path, own.edge, path.rotation
    if whole is not None:
        both = (own, path), (_own_contact(member, whole, mounts), whole)
        kept = np.concatenate([part.touching for _, part in both])
        rotation = np.concatenate([part.rotation for _, part in both])[kept]
        edge = np.concatenate([part.edge for part, _ in both])[kept]
        points, normals = (np.concatenate([part.path[k] for part, _ in both])[kept] for k in (0, 1))
        order = np.argsort(rotation, kind="stable")
        # positions that both have are in one place but for rounding, and what is between them has no direction
        order = order[np.diff(rotation[order], prepend=-np.inf) > SAME * np.ptp(rotation)]
        points, normals, edge, rotation = points[order], normals[order], edge[order], rotation[order]
    after = jumps(points, edge, rotation) + 1
    return replace(own, curve=(np.insert(points, after, np.nan, axis=0), np.insert(normals, after, np.nan, axis=0)))


def jumps(points: Array, edge: NDArray[np.bool_], rotation: Array) -> NDArray[np.intp]:
    """Indices of the points (P, 3) of a path of contact from which it jumps to the next: where contact on flanks becomes that
    of an `edge` (P,) elsewhere, or the other way round.

    A path that goes on along an edge which it reaches has a velocity (per `rotation` (P,), rad) there between that before and that
    after. One that jumps is farther from all of these than they are from rest together.
    """
    if len(rotation) < 2:
        return np.zeros(0, dtype=np.intp)
    turned = np.maximum(np.abs(np.diff(rotation)), SAME * np.ptp(rotation))
    velocity = np.diff(points, axis=0) / turned[:, None]
    changes = edge[1:] != edge[:-1]
    steady = np.where((changes | ~np.isfinite(velocity[:, 0]))[:, None], 0.0, velocity)
    rest = np.zeros((1, 3))
    before, after = np.concatenate((rest, steady[:-1])), np.concatenate((steady[1:], rest))
    way, away = after - before, velocity - before
    part = np.clip(dot(away, way) / np.maximum(dot(way, way), 1e-300), 0.0, 1.0)
    far = np.linalg.norm(away - part[:, None] * way, axis=-1)
    most = np.linalg.norm(before, axis=-1) + np.linalg.norm(after, axis=-1)
    return np.flatnonzero(changes & (far > most) & (most > 0.0))


def _own_contact(member: int, path: ContactPath, mounts: tuple[Mount, Mount]) -> MemberContact:
    pinion = member == 0
    own_to_fixed = mounts[member].at(path.rotation if pinion else path.phi2)
    fixed_to_own = own_to_fixed.inverse
    turns, shifts = fixed_to_own.rotation, fixed_to_own.translation
    point, normal = path.point1 if pinion else path.point2, fixed_to_own.vector(path.normal if pinion else -path.normal)
    return MemberContact(
        point=point,
        normal=normal,
        major=fixed_to_own.vector(path.major),
        minor=fixed_to_own.vector(path.minor),
        semi_major=path.semi_major,
        semi_minor=path.semi_minor,
        edge=path.kind == "edge",
        lines=tuple(None if line is None else line @ turns[i].T + shifts[i] for i, line in enumerate(path.lines)),
        curve=(np.where((path.kind == "line")[:, None], np.nan, point), normal),
    )


@dataclass(frozen=True)
class ToothView:
    """The tooth of a flank picture, in its member's own frame: only this one is needed at a fine tolerance.

    `fine` is the tooth in contact, `context` a coarse mesh of what surrounds it; `project` takes
    points (..., 3) near the flank to the closest points of the exact flank, and to NaN beyond its trimmed edges. `grid` (I, J, 3)
    are points of that flank, from root to tip and between its `ends`; the camera looks at it along its mean normal.
    """

    fine: TriangleMesh
    project: Project
    context: TriangleMesh | None = None
    grid: Array | None = None
    title: str = ""
    size: tuple[int, int] = (1600, 1200)
    ends: tuple[str, str] = (TOE_END, HEEL_END)

    @property
    def lift(self) -> float:
        """Height above the surface, mm, at which things are drawn: 0.1 % of the tooth's bounding radius."""
        low, high = self.fine.vertices.min(axis=0), self.fine.vertices.max(axis=0)
        return 1e-3 * float(np.linalg.norm(high - low)) / 2

    @property
    def bodies(self) -> tuple[SceneBody, ...]:
        fine = SceneBody(self.fine, Rigid.identity(), STEEL)
        if self.context is None:
            return (fine,)
        return (fine, SceneBody(self.context, Rigid.identity(), DULL_STEEL, yields=True))
