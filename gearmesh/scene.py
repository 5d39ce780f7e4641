"""What is in a picture, as data, and the pictures of a gear pair; `render` turns a scene into pixels.

A flank picture stands in its member's own frame (axis along z), the picture of the pair in the fixed frame.
Lengths are in mm, angles in rad, colours "#rrggbb". NaN points cut curves, areas and maps off.

What lies on a tooth is computed in the tangent plane of the contact, put on the exact surface by the caller's
`project`, and lifted along the normal by `ToothView.lift`, a small fraction of the picture, so that it is neither
buried in the facets of the mesh nor seen to float:

    tangent plane  ----+----        ellipse, half axes a and b along `major` and `minor`
                     .. | ..        project: closest point of the trimmed flank, NaN beyond it
    exact flank   .-'   |   '-.     lift: 0.1 % of the tooth's bounding radius
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from gearmesh.assembly import Assembly
from gearmesh.errors import NoSolutionError
from gearmesh.frames import Array, Rigid, cross, dot, unit
from gearmesh.mesh import TriangleMesh
from gearmesh.path import ContactPath

Project = Callable[[Array], Array]

COMPOUND = "#3f7fc4"
OUTLINE = "#12345a"
PATH = "#c8102e"
EDGE = "#ff8c00"


@dataclass(frozen=True)
class Paint:
    """Colour of a body: one for all, and others for regions named in full or by their first word ("flank")."""

    colour: str
    regions: Mapping[str, str] = field(default_factory=dict)

    def of(self, region: str) -> str:
        return self.regions.get(region, self.regions.get(region.split("_")[0], self.colour))


STEEL = Paint("#b3bbc3", {"flank": "#d3d9df", "fillet": "#c2cad2"})
DULL_STEEL = Paint("#b0b8c0", {"flank": "#c2cad1", "fillet": "#b8c0c8"})
BLUE_STEEL = Paint("#8ba9c9", {"flank": "#a5c0dc", "fillet": "#98b4d2"})
BRASS = Paint("#cdae7a", {"flank": "#dfc595", "fillet": "#d6ba88"})


@dataclass(frozen=True)
class Body:
    """A mesh at its place in the picture; `yields` lets other bodies win where both have nearly the same depth."""

    mesh: TriangleMesh
    own_to_scene: Rigid
    paint: Paint
    yields: bool = False


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
class GapMap:
    """Surface patch `points` (M, N, 3) coloured by `gap_um` (M, N) from 0 to `limit_um`; not drawn beyond it."""

    points: Array
    gap_um: Array
    limit_um: float
    label: str = "gap (µm)"


@dataclass(frozen=True)
class Camera:
    """A camera at `position` looking at `focus` (3,); `height` mm of the scene at the focus fill the picture."""

    position: Array
    focus: Array
    up: Array
    height: float
    parallel: bool = True

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
class Scene:
    """All that a picture shows; `size` in pixels, width by height."""

    bodies: tuple[Body, ...]
    camera: Camera
    curves: tuple[Curve, ...] = ()
    dots: tuple[Dots, ...] = ()
    areas: tuple[PatternArea, ...] = ()
    maps: tuple[GapMap, ...] = ()
    title: str = ""
    size: tuple[int, int] = (1600, 1200)


@dataclass(frozen=True)
class MemberContact:
    """The contact of P positions as one member sees it, in its own frame: what a flank picture draws.

    point, normal (out of the member), major, minor (P, 3); semi_major, semi_minor (P,) in mm, NaN where there is
    no ellipse; edge (P,) True for edge contact; lines: contact lines (K, 3), one a position or None.
    """

    point: Array
    normal: Array
    major: Array
    minor: Array
    semi_major: Array
    semi_minor: Array
    edge: NDArray[np.bool_]
    lines: tuple[Array | None, ...] = ()

    @property
    def ellipses(self) -> NDArray[np.int64]:
        """Indices of the positions that have an ellipse."""
        return np.flatnonzero(np.isfinite(self.semi_major + self.semi_minor + self.point[:, 0]))

    @property
    def along_lines(self) -> NDArray[np.int64]:
        """Indices of the positions that have a contact line."""
        return np.array([i for i, line in enumerate(self.lines) if line is not None], dtype=np.int64)


def contact_on(member: str, path: ContactPath, assembly: Assembly) -> MemberContact:
    """The contact path in the own frame of `member`, "pinion" or "gear"."""
    pinion = member == "pinion"
    own_to_fixed = assembly.pinion.at(path.rotation) if pinion else assembly.gear.at(path.phi2)
    fixed_to_own = own_to_fixed.inverse
    turns, shifts = fixed_to_own.rotation, fixed_to_own.translation
    return MemberContact(
        point=path.point1 if pinion else path.point2,
        normal=fixed_to_own.vector(path.normal if pinion else -path.normal),
        major=fixed_to_own.vector(path.major),
        minor=fixed_to_own.vector(path.minor),
        semi_major=path.semi_major,
        semi_minor=path.semi_minor,
        edge=path.kind == "edge",
        lines=tuple(None if line is None else line @ turns[i].T + shifts[i] for i, line in enumerate(path.lines)),
    )


@dataclass(frozen=True)
class ToothView:
    """The tooth of a flank picture, in its member's own frame: only this one is needed at a fine tolerance.

    `fine` is the tooth that carries the contact, `context` a coarse mesh of what surrounds it; `project` takes
    points (..., 3) near the flank to the closest points of the exact flank, and to NaN beyond its trimmed edges.
    """

    fine: TriangleMesh
    project: Project
    context: TriangleMesh | None = None
    title: str = ""
    size: tuple[int, int] = (1600, 1200)

    @property
    def lift(self) -> float:
        """Height above the surface, mm, at which things are drawn: 0.1 % of the tooth's bounding radius."""
        low, high = self.fine.vertices.min(axis=0), self.fine.vertices.max(axis=0)
        return 1e-3 * float(np.linalg.norm(high - low)) / 2

    @property
    def bodies(self) -> tuple[Body, ...]:
        fine = Body(self.fine, Rigid.identity(), STEEL)
        if self.context is None:
            return (fine,)
        return (fine, Body(self.context, Rigid.identity(), DULL_STEEL, yields=True))


# --- the pictures ---


def member_scene(view: ToothView, contact: MemberContact, count: int = 9, camera: Camera | None = None) -> Scene:
    """A tooth with the path of contact and, at up to `count` positions, the contact ellipses or contact lines."""
    chosen = spread(contact.ellipses, count)
    discs, outlines = ellipses_on_surface(contact, chosen, view.project, view.lift)
    areas = tuple(PatternArea(disc, label="contact ellipses" if i == 0 else "") for i, disc in enumerate(discs))
    curves = (Curve(outlines, colour=OUTLINE, width=1.5),) if len(chosen) else ()
    return Scene(
        bodies=view.bodies,
        camera=camera or flank_camera(view, contact),
        areas=areas,
        curves=curves + contact_lines(view, contact, count) + path_on_surface(view, contact),
        dots=position_dots(view, contact),
        title=view.title,
        size=view.size,
    )


def pattern_scene(view: ToothView, contact: MemberContact, grid: Array, camera: Camera | None = None) -> Scene:
    """A tooth with the union of its contact ellipses as one area; `grid` (I, J, 3) are points of its exact flank.

    150 x 300 points draw the ends of slender ellipses smoothly. A pair in line contact shows its lines instead.
    """
    lifted = lift_grid(grid, contact, view.lift)
    area = PatternArea(lifted, union_level(contact, grid), "contact pattern: union of the ellipses")
    return Scene(
        bodies=view.bodies,
        camera=camera or flank_camera(view, contact),
        areas=(area,) if len(contact.ellipses) else (),
        curves=contact_lines(view, contact, count=25) + path_on_surface(view, contact),
        title=view.title,
        size=view.size,
    )


def gap_scene(
    view: ToothView,
    contact: MemberContact,
    grid: Array,
    patches: Sequence[tuple[Array, Array]],
    limit: float,
    camera: Camera | None = None,
) -> Scene:
    """A tooth with the smallest gap of a roll test, up to `limit` mm, in colours.

    `grid` (I, J, 3) are points of its exact flank; every patch is one position's points (M, N, 3), own frame, and
    gaps (M, N) in mm, NaN where there is none. The path of contact is drawn from `contact`, the solver's result.
    """
    gap = closest_gap(grid, patches)
    gap_map = GapMap(lift_grid(grid, contact, view.lift), 1e3 * gap, 1e3 * limit, "smallest gap in the roll test (µm)")
    return Scene(
        bodies=view.bodies,
        camera=camera or flank_camera(view, contact),
        maps=(gap_map,),
        curves=path_on_surface(view, contact),
        title=view.title,
        size=view.size,
    )


def pair_scene(
    pinion: TriangleMesh,
    gear: TriangleMesh,
    assembly: Assembly,
    phi: tuple[float, float],
    title: str = "",
    size: tuple[int, int] = (1600, 1200),
    close_up: tuple[Array, float] | None = None,
) -> Scene:
    """Both members (own frames) in their mounted positions at rotations `phi` = (phi1, phi2), fixed frame.

    `close_up` is a point (3,), fixed frame, and the radius (mm) around it that fills the picture instead of the pair.
    """
    bodies = (
        Body(pinion, assembly.pinion.at(phi[0]), BLUE_STEEL),
        Body(gear, assembly.gear.at(phi[1]), BRASS),
    )
    first, second = (body.own_to_scene.point(body.mesh.vertices) for body in bodies)
    return Scene(bodies, pair_camera(assembly, first, second, size, close_up), title=title, size=size)


# --- cameras ---

#: shaft angle (rad) from which on a pair is looked at from the side
STEEP = np.radians(55.0)


def framed(back: Array, up: Array, points: Array, size: tuple[int, int], margin: float = 1.3) -> Camera:
    """Parallel camera looking along -`back` with `up` upwards (3,) that just holds `points` (K, 3), by `margin`."""
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.sqrt(dot(points - centre, points - centre).max()))
    first = Camera(centre + 4.0 * radius * unit(back), centre, up, 2.0 * radius)
    seen = (points - centre) @ first.axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    shift = (low[:2] + high[:2]) / 2 @ first.axes[:2]
    width, height = (high - low)[:2]
    tall = margin * max(height, width * size[1] / size[0])
    return Camera(first.position + shift, centre + shift, up, float(tall))


def flank_camera(view: ToothView, contact: MemberContact, tilt: float = 0.6, swing: float = 0.2) -> Camera:
    """Look at a flank along its outward normal at the middle of the contact, tilted so that neighbours do not hide it.

    The view is up the tooth (along the normals of its top land), turned by `tilt` (rad) from the normal towards the tip
    and by `swing` along the tooth; it holds the flanks of `view.fine`.
    """
    if not np.isfinite(contact.normal).any():
        raise NoSolutionError(
            f"{view.title or 'flank picture'}: no position has contact, so there is nothing to look at"
        )
    flanks = [name for name in view.fine.region_names if name.startswith("flank")]
    shown = view.fine.only(*flanks).vertices if flanks else view.fine.vertices
    normal = unit(np.nanmean(contact.normal, axis=0))
    middle = np.nanmean(contact.point, axis=0)
    land = view.fine.only("land").normals if "land" in view.fine.region_names else middle[None] * [1.0, 1.0, 0.0]
    up = unit(land.mean(axis=0))
    rise = unit(up - dot(up, normal) * normal)
    along = cross(rise, normal)
    back = np.cos(tilt) * (np.cos(swing) * normal + np.sin(swing) * along) + np.sin(tilt) * rise
    return framed(back, up, shown, view.size)


def pair_camera(
    assembly: Assembly,
    pinion: Array,
    gear: Array,
    size: tuple[int, int],
    close_up: tuple[Array, float] | None = None,
) -> Camera:
    """Look at a pair so that the mesh is seen: the picture holds the vertices `pinion` and `gear` (K, 3), fixed frame.

    Axes at a small angle are seen nearly end on, the pinion above or left of the gear; at a large angle the gear lies
    under the pinion and turns its teeth up. With `close_up` the picture holds the radius around its point instead.
    """
    first, second = assembly.pinion.axis, assembly.gear.axis
    apart = pinion.mean(axis=0) - gear.mean(axis=0)
    points = np.concatenate((pinion, gear))
    if assembly.shaft_angle > STEEP:
        # both axes from where they cross to the bodies
        first = first * np.sign(first @ (pinion.mean(axis=0) - assembly.gear.origin))
        second = second * np.sign(second @ (gear.mean(axis=0) - assembly.pinion.origin))
        side = unit(cross(first, second))
        whole = framed(0.9 * side - 0.6 * second - 0.5 * first, -second, points, size)
    else:
        along = unit(first + np.where(dot(first, second) < 0, -second, second))
        above = unit(apart - dot(apart, along) * along)
        ups = (above, cross(above, along))
        views = (framed(along + 0.4 * up + 0.3 * cross(up, along), up, points, size) for up in ups)
        whole = min(views, key=lambda camera: camera.height)
    if close_up is None:
        return whole
    point, radius = close_up
    return replace(whole, position=whole.position - whole.focus + point, focus=point, height=2.0 * radius)


# --- what lies on the surface ---


def ellipses_on_surface(
    contact: MemberContact, chosen: NDArray[np.int64], project: Project, lift: float, rays: int = 145, rings: int = 9
) -> tuple[Array, Array]:
    """Contact ellipses of the positions `chosen` (E,), laid on the surface and cut off at the flank's edges.

    Returns discs (E, rings, rays, 3) and the outlines (E (rays + 1), 3), separated by NaN.
    """
    turn = np.broadcast_to(np.linspace(0.0, 2.0 * np.pi, rays), (len(chosen), rays))
    which = np.broadcast_to(chosen[:, None], turn.shape)

    def place(which: NDArray[np.int64], angle: Array, part: Array) -> Array:
        a, b = part * contact.semi_major[which] * np.cos(angle), part * contact.semi_minor[which] * np.sin(angle)
        return project(contact.point[which] + a[..., None] * contact.major[which] + b[..., None] * contact.minor[which])

    reach = np.ones(turn.shape)
    rim = place(which, turn, reach)
    outside = ~np.isfinite(rim[..., 0])
    # Each ray ends at the flank's edge: the disc is cut there, not at the nearest sample.
    out_which, out_turn = which[outside], turn[outside]
    reach[outside] = _last_inside(
        lambda part: place(out_which, out_turn, part), np.zeros(out_turn.shape), np.ones(out_turn.shape)
    )
    part = np.linspace(0.0, 1.0, rings)[:, None] * reach[:, None, :]
    grown = (len(chosen), rings, rays)
    discs = place(np.broadcast_to(which[:, None], grown), np.broadcast_to(turn[:, None], grown), part)
    # The outline ends where it crosses the edge, between two samples.
    row, column = np.nonzero(outside[:, 1:] != outside[:, :-1])
    inner, outer = column + outside[row, column], column + ~outside[row, column]
    ends = which[row, 0]
    last = _last_inside(lambda angle: place(ends, angle, np.ones(angle.shape)), turn[row, inner], turn[row, outer])
    rim[row, outer] = place(ends, last, np.ones(last.shape))
    normal = lift * contact.normal[chosen]
    rim = np.concatenate((rim + 1.5 * normal[:, None], np.full((len(chosen), 1, 3), np.nan)), axis=1)
    return discs + normal[:, None, None], rim.reshape(-1, 3)


def path_on_surface(view: ToothView, contact: MemberContact, between: int = 8) -> tuple[Curve, ...]:
    """The path of contact as a curve on the surface, with `between` steps from one position to the next.

    Along contact lines there is none: which of their points a solver reports means nothing.
    """
    point = contact.point.copy()
    point[contact.along_lines] = np.nan
    if not np.isfinite(point).any():
        return ()
    point, normal = _refined(point, between), _refined(contact.normal, between)
    on_surface = view.project(point)
    # Edge contact lies on the trimmed edge itself, where `project` may fall to either side: the chord is near enough.
    on_surface = np.where(np.isfinite(on_surface), on_surface, point)
    return (Curve(on_surface + 2.0 * view.lift * normal, "path of contact", PATH, 3.0),)


def position_dots(view: ToothView, contact: MemberContact) -> tuple[Dots, ...]:
    """Marks at the positions of edge contact."""
    edge = contact.point[contact.edge] + 2.0 * view.lift * contact.normal[contact.edge]
    return (Dots(edge, "edge contact", EDGE),) if len(edge) else ()


def contact_lines(view: ToothView, contact: MemberContact, count: int) -> tuple[Curve, ...]:
    """Up to `count` contact lines, for pairs that touch along lines."""
    chosen = spread(contact.along_lines, count)
    lifted = [(contact.lines[i], 1.5 * view.lift * contact.normal[i]) for i in chosen]
    return tuple(
        Curve(line + up, "contact lines" if i == 0 else "", COMPOUND, 3.0)
        for i, (line, up) in enumerate(lifted)
        if line is not None
    )


def lift_grid(grid: Array, contact: MemberContact, lift: float) -> Array:
    """Flank points (I, J, 3) moved by `lift` mm along the surface normal, to the side of the contact normals."""
    normal = unit(cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1)))
    side = np.sign(dot(normal, np.nanmean(contact.normal, axis=0)))
    return grid + lift * side[..., None] * normal


def union_level(contact: MemberContact, grid: Array) -> Array:
    """Scaled distance (I, J) from points (I, J, 3) to the nearest ellipse centre: at most 1 inside any ellipse.

    Positions are refined to steps of an eighth of the smallest minor half axis, so that the union is the area
    swept by the moving ellipse and not a row of separate ones. Edge contact, which has no ellipse, adds nothing.
    """
    chosen = contact.ellipses
    if len(chosen) == 0:
        return np.full(grid.shape[:-1], np.inf)
    major = contact.major[chosen] / contact.semi_major[chosen, None]
    minor = contact.minor[chosen] / contact.semi_minor[chosen, None]
    form = major[:, :, None] * major[:, None, :] + minor[:, :, None] * minor[:, None, :]
    centre = contact.point[chosen]
    steps = np.linalg.norm(np.diff(centre, axis=0), axis=-1)
    most = int(np.ceil(8.0 * steps.max(initial=0.0) / contact.semi_minor[chosen].min()))
    between = int(np.clip(most, 1, 64))
    joined = np.flatnonzero(np.diff(chosen) > 1) + 1
    runs = zip(np.split(centre, joined), np.split(form, joined), strict=True)
    refined = [(_refined(c, between), _refined(f, between)) for c, f in runs]
    centre, form = (np.concatenate(parts) for parts in zip(*refined, strict=True))
    # (x - c)' F (x - c) is linear in the ten products 1, x_i, x_i x_j: one matrix product for all positions.
    origin = centre.mean(axis=0)
    x, c = (grid - origin).reshape(-1, 3), centre - origin
    pull = np.einsum("pij,pj->pi", form, c)
    row, column = np.triu_indices(3)
    products = np.concatenate((np.ones((len(x), 1)), x, x[:, row] * x[:, column]), axis=1)
    double = np.where(row == column, 1.0, 2.0)
    factors = np.concatenate((dot(pull, c)[:, None], -2.0 * pull, double * form[:, row, column]), axis=1)
    smallest = np.full(len(x), np.inf)
    for block in np.array_split(factors, -(-len(factors) // 64)):
        np.minimum(smallest, (products @ block.T).min(axis=1), out=smallest)
    return np.sqrt(np.maximum(smallest, 0.0)).reshape(grid.shape[:-1])


def closest_gap(grid: Array, patches: Sequence[tuple[Array, Array]]) -> Array:
    """Smallest gap (I, J) at flank points (I, J, 3) over patches of points (M, N, 3) and gaps (M, N); NaN without.

    Gaps are interpolated bilinearly in the mean plane of the flank, over which a flank is a graph.
    """
    flat = grid.reshape(-1, 3)
    origin = flat.mean(axis=0)
    plane = np.linalg.svd(flat - origin, full_matrices=False)[2][:2]
    places = (flat - origin) @ plane.T
    smallest = np.full(len(flat), np.inf)
    for points, gap in patches:
        known = np.isfinite(gap) & np.isfinite(points).all(axis=-1)
        if known.sum() > 3:
            lattice = (points - origin) @ plane.T
            low, high = lattice[known].min(axis=0), lattice[known].max(axis=0)
            near = np.flatnonzero(((places >= low) & (places <= high)).all(axis=1))
            index = _index_in(lattice, known, places[near])
            here = map_coordinates(np.where(known, gap, np.nan), index.T, order=1, mode="constant", cval=np.nan)
            smallest[near] = np.fmin(smallest[near], here)
    return np.where(np.isfinite(smallest), smallest, np.nan).reshape(grid.shape[:-1])


def _index_in(lattice: Array, known: NDArray[np.bool_], places: Array) -> Array:
    """Fractional indices (K, 2) at which a lattice (M, N, 2) reaches places (K, 2), beyond its range outside of it.

    Newton on the bilinear lattice; where it is not `known` (M, N), its best affine map takes its place.
    """
    index = np.stack(np.meshgrid(*map(np.arange, known.shape), indexing="ij"), axis=-1).astype(float)
    affine = np.concatenate((index, np.ones((*known.shape, 1))), axis=-1)
    filled = np.where(known[..., None], lattice, affine @ np.linalg.lstsq(affine[known], lattice[known])[0])
    slopes = np.stack((np.gradient(filled, axis=0), np.gradient(filled, axis=1)), axis=-1)
    planes = np.concatenate((filled, slopes.reshape(*known.shape, 4)), axis=-1)
    last = np.array(known.shape) - 1.0
    found = np.broadcast_to(last / 2, places.shape)
    # Worst error in cells after 3 and 10 steps: 4e-4 and 2e-12 on roll-test lattices of a beveloid pair; after 10
    # steps 5e-4 when the lattice is a whole beveloid flank, whose parameter lines crowd at the fillet.
    for _ in range(10):
        base = np.clip(found, 0.0, last)
        here = np.stack([map_coordinates(plane, base.T, order=1) for plane in np.moveaxis(planes, -1, 0)], axis=-1)
        step = np.linalg.solve(here[:, 2:].reshape(-1, 2, 2), (places - here[:, :2])[..., None])[..., 0]
        found = base + step
    return found


def _last_inside(place: Callable[[Array], Array], inside: Array, outside: Array) -> Array:
    """Parameter (K,) up to which `place` is finite, between one where it is and one where it is not: bisection."""
    for _ in range(24):
        middle = (inside + outside) / 2
        there = np.isfinite(place(middle)[..., 0])
        inside, outside = np.where(there, middle, inside), np.where(there, outside, middle)
    return inside


def _refined(values: Array, between: int) -> Array:
    """Values (P, ...) with linear interpolation in `between` steps from each to the next."""
    fraction = np.arange(between * (len(values) - 1) + 1) / between
    left = np.minimum(fraction.astype(int), max(len(values) - 2, 0))
    weight = (fraction - left).reshape(-1, *[1] * (values.ndim - 1))
    right = np.minimum(left + 1, len(values) - 1)
    # A weight of 0 must not carry the neighbour's NaN over.
    ahead = np.where(weight > 0, weight * values[right], 0.0)
    behind = np.where(weight < 1, (1.0 - weight) * values[left], 0.0)
    return ahead + behind


def spread(indices: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """At most `count` of the indices, evenly spread with the first and the last."""
    if len(indices) <= count:
        return indices
    return indices[np.linspace(0, len(indices) - 1, count).round().astype(int)]
