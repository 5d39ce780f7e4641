"""Contents of a picture as data; `views` composes scenes of gears, `render` turns a scene into pixels.

A flank picture is in its member's own frame (axis along z), the picture of a pair in the fixed frame. Lengths are in
mm, angles in rad, colours "#rrggbb". NaN points interrupt curves, areas and maps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, fields, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.path import ContactPath
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.records import dataclass
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import HEEL_END, TOE_END
from gearmesh.view.palette import COLOUR_MAP, COMPOUND_COLOUR, MARKING_COLOUR, OUTLINE_COLOUR, PATH_COLOUR


class Project(Protocol):
    """Projection of points onto a flank."""

    def __call__(self, points: Array) -> Array:
        """Return the closest points (..., 3) of the trimmed flank, NaN beyond its edges."""

    def beyond(self, points: Array) -> Array:
        """Return distances (...,) of the projections of points (..., 3) beyond the edges, mm; not above 0 on the flank."""


@dataclass(frozen=True)
class Paint:
    """Colour of a body, and other colours for regions, named in full or by their first word ("flank")."""

    colour: str
    regions: Mapping[str, str] = field(default_factory=dict)

    def of(self, region: str) -> str:
        return self.regions.get(region, self.regions.get(region.split("_")[0], self.colour))


#: a tooth that is looked at
STEEL_PAINT = Paint("#c6cdd5", {"flank": "#dce2e9", "fillet": "#ced5dd"})
#: the rest of its gear
DULL_STEEL_PAINT = Paint("#bdc5ce", {"flank": "#cad1d9", "fillet": "#c2cad3"})
#: a gear whose flanks are painted with marking compound
MARKED_PAINT = Paint(STEEL_PAINT.colour, {"flank": MARKING_COLOUR, "fillet": MARKING_COLOUR})
#: first member
BLUE_STEEL_PAINT = Paint("#8ba9c9", {"flank": "#a5c0dc", "fillet": "#98b4d2"})
#: third member
BRONZE_PAINT = Paint("#b98d72", {"flank": "#cda68d", "fillet": "#c39a80"})
#: fourth and fifth member
SAGE_PAINT = Paint("#93ab8b", {"flank": "#a9c0a1", "fillet": "#9fb696"})
PLUM_PAINT = Paint("#a391b3", {"flank": "#b8a8c6", "fillet": "#ae9dbd"})
#: second member
BRASS_PAINT = Paint("#cdae7a", {"flank": "#dfc595", "fillet": "#d6ba88"})
#: first member behind a section
PALE_BLUE_PAINT = Paint("#e3eaf2")
#: second member behind a section
PALE_BRASS_PAINT = Paint("#f4efe4")
#: tools
TOOL_PAINT = Paint("#7f93c9", {"flank": "#92a6dc", "fillet": "#d98f5c"})


@dataclass(frozen=True)
class SceneBody:
    """A mesh at its position in the scene."""

    #: mesh in its own frame, mm
    mesh: TriangleMesh
    #: motion from its own frame into the frame of the scene
    own_to_scene: Rigid
    #: colours of its regions
    paint: Paint
    #: True if other bodies are drawn in front where both have nearly the same depth
    yields: bool = False
    #: colour of its inside where it is cut open; then its edges are not drawn. None: not a section
    section: str | None = None
    #: 1 for an opaque body; below 1 the bodies behind it are seen through it
    opacity: float = 1.0


@dataclass(frozen=True)
class Curve:
    """A polyline."""

    #: points (K, 3), mm; NaN interrupts the line
    points: Array
    #: its text in the legend, none if empty
    label: str = ""
    #: its colour
    colour: str = OUTLINE_COLOUR
    #: its width, pixels of a picture of 1600x1200
    width: float = 2.0


@dataclass(frozen=True)
class Dots:
    """Round marks."""

    #: middles (K, 3), mm; NaN is skipped
    points: Array
    #: their text in the legend, none if empty
    label: str = ""
    #: their colour
    colour: str = PATH_COLOUR
    #: their diameter, pixels of a picture of 1600x1200
    size: float = 12.0


@dataclass(frozen=True)
class PatternArea:
    """A filled part of a surface patch."""

    #: points (M, N, 3) of the patch, mm
    points: Array
    #: level (M, N): the area is where it is at most 1; None: the whole patch
    level: Array | None = None
    #: its text in the legend, none if empty
    label: str = ""
    #: its colour
    colour: str = COMPOUND_COLOUR


@dataclass(frozen=True)
class CompoundFilm:
    """Marking compound on a surface patch, lit like a body; where it is rubbed off, the steel shows."""

    #: points (M, N, 3) of the patch, mm
    points: Array
    #: share (M, N) of the compound that stays, 0 to 1
    share: Array
    #: unit normals (M, N, 3) out of the patch
    normals: Array
    #: text of the compound in the legend
    label: str = "marking compound"
    #: text of the places without compound
    rubbed_label: str = "rubbed off"


@dataclass(frozen=True)
class ValueMap:
    """Surface patches in colours of a scale from 0 to `limit`; NaN and values above the limit are not drawn."""

    #: points (..., M, N, 3) of the patches, mm
    points: Array
    #: values (..., M, N) at the points, in the label's unit
    values: Array
    #: value at which the scale ends
    limit: float
    #: quantity and unit beside the colour bar
    label: str = "gap (µm)"
    #: matplotlib's name of the colours
    colours: str = COLOUR_MAP


@dataclass(frozen=True)
class Camera:
    """A camera and the part of the scene that it sees."""

    #: position (3,), mm
    position: Array
    #: point (3,) in the middle of the picture, mm
    focus: Array
    #: direction (3,) that is upwards in the picture
    up: Array
    #: height (mm) of the scene at the focus that fills the picture
    height: float
    #: True for a parallel projection, False for a perspective
    parallel: bool = True
    #: distance (mm) of the front plane before the focus: bodies that yield are cut away before it. None: no plane
    front: float | None = None
    #: unit normal (3,) of the front plane, towards the part that is cut away. None: towards the viewer
    front_normal: Array | None = None
    #: direction (3,) along which the scale bar measures. None: across the picture
    measured: Array | None = None

    @property
    def axes(self) -> Array:
        """Rows: unit vectors to the right, up and towards the viewer, (3, 3)."""
        back = unit(self.position - self.focus)
        right = unit(cross(self.up, back))
        return np.stack((right, cross(back, right), back))

    @property
    def distance(self) -> float:
        return float(np.linalg.norm(self.position - self.focus))

    def moved(self, shift: Array, height: float) -> Camera:
        """Return the camera moved by `shift` (3,), mm, for a picture of another height (mm); its front plane stays."""
        normal = self.axes[2] if self.front_normal is None else self.front_normal
        front = None if self.front is None else self.front - float(shift @ normal)
        return replace(self, position=self.position + shift, focus=self.focus + shift, height=height, front=front)

    def pixels(self, points: Array, size: tuple[int, int]) -> Array:
        """Pixels of points (..., 3) from the left and from the top, and depth from the camera in mm, (..., 3)."""
        seen = (points - self.position) @ self.axes.T
        depth = -seen[..., 2]
        scale = size[1] / self.height * (np.ones_like(depth) if self.parallel else self.distance / depth)
        return np.stack((size[0] / 2 + scale * seen[..., 0], size[1] / 2 - scale * seen[..., 1], depth), axis=-1)


@dataclass(frozen=True)
class Word:
    """A word that names a part of the scene."""

    #: the word
    text: str
    #: point (3,) of the named part, mm
    point: Array
    #: point (3,), mm: the word is written beyond `point` as seen from here
    inside: Array
    #: True if the named part is outside of the picture
    beyond: bool = False


#: share of a picture's width that remains for the bodies beside a colour bar
BODIES_WIDTH_SHARE = 0.885


def beside_bar(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height (pixels) that remain of a picture beside a colour bar."""
    return round(BODIES_WIDTH_SHARE * size[0]), size[1]


@dataclass(frozen=True)
class Scene:
    """Everything that a picture shows."""

    #: bodies, in the frame of the scene
    bodies: tuple[SceneBody, ...]
    #: camera; with `maps` it sees the part of the picture beside their colour bar
    camera: Camera
    #: curves on the bodies
    curves: tuple[Curve, ...] = ()
    #: dots on the bodies
    dots: tuple[Dots, ...] = ()
    #: filled areas on the bodies
    areas: tuple[PatternArea, ...] = ()
    #: coloured maps on the bodies; the first has the colour bar
    maps: tuple[ValueMap, ...] = ()
    #: marking compound on the bodies
    films: tuple[CompoundFilm, ...] = ()
    #: words beside the parts that they name
    words: tuple[Word, ...] = ()
    #: title, above the bodies
    title: str = ""
    #: width and height of the picture, pixels
    size: tuple[int, int] = (1600, 1200)


#: share of the engagement below which two positions are the same
SAME_POSITION_SHARE = 1e-9


@dataclass(frozen=True)
class MemberContact:
    """The contact of P positions on one member, in its own frame: the content of a flank picture."""

    #: points of contact (P, 3), mm; NaN without contact
    point: Array
    #: unit normals (P, 3) out of the member
    normal: Array
    #: unit vectors (P, 3) along the major axes of the ellipses
    major: Array
    #: unit vectors (P, 3) along the minor axes
    minor: Array
    #: major semi-axes (P,), mm; NaN without an ellipse
    semi_major: Array
    #: minor semi-axes (P,), mm; NaN without an ellipse
    semi_minor: Array
    #: True (P,) for edge contact
    edge: NDArray[np.bool_]
    #: contact lines (K, 3), mm, or None, one for each position
    lines: tuple[Array | None, ...] = ()
    #: points and normals (W, 3) of the path of contact if it is known at more than the P positions
    curve: tuple[Array, Array] | None = None

    def at(self, index: NDArray[np.intp]) -> MemberContact:
        """Return the contact of some positions (K,), without a curve between the positions."""
        kept: dict[str, Any] = {
            each.name: getattr(self, each.name)[index] for each in fields(self) if each.name not in ("lines", "curve")
        }
        return MemberContact(**kept, lines=tuple(self.lines[k] for k in index) if self.lines else ())

    def image(self, exchange: Array) -> MemberContact:
        """Return the contact on the other flank, the image by the map of the own frame with diagonal `exchange` (3,)."""
        return replace(
            self,
            point=exchange * self.point,
            normal=exchange * self.normal,
            major=exchange * self.major,
            minor=exchange * self.minor,
            lines=tuple(None if line is None else exchange * line for line in self.lines),
            curve=None if self.curve is None else (exchange * self.curve[0], exchange * self.curve[1]),
        )

    @property
    def path(self) -> tuple[Array, Array]:
        """Points and normals (W, 3) of the path of contact.

        NaN for positions with a contact line: the solver's point on such a line is arbitrary.
        """
        if self.curve is not None:
            return self.curve
        point = self.point.copy()
        point[self.along_lines] = np.nan
        return point, self.normal

    @property
    def places(self) -> Array:
        """Points (K, 3) that enclose all contact: points of the path and of contact lines, and ends of ellipses."""
        chosen = self.ellipses
        reach = self.semi_major[chosen, None] * self.major[chosen]
        lines = [line for line in self.lines if line is not None]
        points = (self.point, self.path[0], self.point[chosen] + reach, self.point[chosen] - reach, *lines)
        every = np.concatenate(points)
        return every[np.isfinite(every[:, 0])]

    @property
    def middle(self) -> Array:
        """Point (3,) of the middle position with contact; the middle of its contact line if it has one."""
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
    """Return the contact of a path in the own frame of the pinion (0) or the gear (1).

    Its curve includes the positions of the `whole` path if given.
    """
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
        order = order[np.diff(rotation[order], prepend=-np.inf) > SAME_POSITION_SHARE * np.ptp(rotation)]
        points, normals, edge, rotation = points[order], normals[order], edge[order], rotation[order]
    after = jumps(points, edge, rotation) + 1
    return replace(own, curve=(np.insert(points, after, np.nan, axis=0), np.insert(normals, after, np.nan, axis=0)))


def jumps(points: Array, edge: NDArray[np.bool_] | NDArray[np.str_], rotation: Array) -> NDArray[np.intp]:
    """Indices of the points (P, 3) of a path after which it jumps: from flank contact to `edge` contact (P,) or back.

    `edge` has True for edge contact, or the names of edges: a path may then jump from one edge to another, too.
    A path that continues along an edge has a velocity (per `rotation` (P,), rad) between the velocities before and
    after the change. At a jump the velocity is farther from this interval than both velocities together are from zero.
    """
    if len(rotation) < 2:
        return np.zeros(0, dtype=np.intp)
    turned = np.maximum(np.abs(np.diff(rotation)), SAME_POSITION_SHARE * np.ptp(rotation))
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
    """Return the contact of a path in the own frame of a member, without a curve between the positions."""
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
    """The tooth of a flank picture, in its member's own frame; only this tooth is meshed finely."""

    #: fine mesh of the tooth in contact
    fine: TriangleMesh
    #: maps points (..., 3) near the flank to the closest points of the exact flank, NaN beyond its trimmed edges
    project: Project
    #: coarse mesh of the rest of the gear
    context: TriangleMesh | None = None
    #: points (I, J, 3) of the exact flank from root to tip and between its `ends`; the camera looks along their mean
    #: normal
    grid: Array | None = None
    #: title of the picture
    title: str = ""
    #: width and height of the picture, pixels
    size: tuple[int, int] = (1600, 1200)
    #: names of the flank's ends, in the order of the grid's columns
    ends: tuple[str, str] = (TOE_END, HEEL_END)

    @property
    def lift(self) -> float:
        """Height (mm) above the surface at which curves and areas are drawn: 0.1 % of the tooth's bounding radius."""
        low, high = self.fine.vertices.min(axis=0), self.fine.vertices.max(axis=0)
        return 1e-3 * float(np.linalg.norm(high - low)) / 2

    @property
    def bodies(self) -> tuple[SceneBody, ...]:
        fine = SceneBody(self.fine, Rigid.identity(), STEEL_PAINT)
        if self.context is None:
            return (fine,)
        return (fine, SceneBody(self.context, Rigid.identity(), DULL_STEEL_PAINT, yields=True))
