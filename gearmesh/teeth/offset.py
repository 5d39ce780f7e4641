"""Teeth with surfaces moved along their exact normals: stock to be ground off, clearance of printed teeth, spark gaps.

All surfaces that bound the teeth move: generated surfaces as `Parallel` surfaces, lands and roots as parallel levels.
End faces, bore and the rest of the body stay. The moved surfaces are trimmed again, like those of every tooth. Tangent
surfaces share points and normals, and stay tangent; surfaces that meet in an edge end where they cross. Drawn surfaces
are drawn again: tip chamfers keep their size, and the radius of roundings grows by the distance. A root that two
cutters leave straight from fillet to fillet stays straight. Distances are in mm, positive away from the material.

A distance may be too large in three ways, which are tested on sections from toe to heel:

- 1 - d k < 0 for a principal curvature k (`curvature`; hollow: positive): the surface turns inside out, a fillet first.
- the section crosses itself or the section of the next tooth: the space is closed, the tooth cut through.
- the tooth cannot be trimmed: it is pointed, the tip lies beyond the generated surface, or the root lies in the bore.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.numeric.algebra import Array, dot, plane_cross
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.levels import LandLevel
from gearmesh.kernel.surface.offset import Parallel
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.strip import Strip
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.tooth import PROOF_STATIONS, Tooth
from gearmesh.teeth.tooth_side import Bottom, TipCorner, ToothSide

#: key that a refusal names
OFFSET_KEY = "offset"
#: reason for a section that crosses itself or its neighbours
CROSSED_TEETH = "the teeth would cut themselves or each other"
#: samples of every link of a section on which an offset is tested
LINK_SAMPLES = 33
#: accuracy of the largest offset, as a share of the tooth's height
OFFSET_ACCURACY = 1e-4
#: sine of the angle between normals below which surfaces are tangent
TANGENT_SINE = 1e-7
#: most Newton steps to the end of a surface
END_NEWTON_STEPS = 20
#: share of the largest area density below which the least density is looked for between stations
LOW_DENSITY_SHARE = 0.1
#: rounds of that search, each with a grid four times finer
DENSITY_ROUNDS = 3
#: length of a section below which it is a rounding error
ZERO_LENGTH_MM = 1e-9
#: largest gap between neighbouring links
MAX_LINK_GAP_MM = 1e-7


def offset_member(member: Member, distance: float) -> Member:
    """Return the member with all its teeth moved.

    Raises DesignError, with the largest distance that works, if the distance is too large.
    """
    if distance == 0.0:
        return member
    if not np.isfinite(distance):
        raise ArgumentError(OFFSET_KEY, distance, must_be="a finite number of mm")
    return with_moved_teeth(member, lambda tooth: offset_tooth(tooth, distance))


def with_moved_teeth(member: Member, move: Callable[[Tooth], Tooth]) -> Member:
    """Return the member with its teeth moved by a function, which is called once for each different tooth."""
    moved: dict[int, Tooth] = {}
    for tooth in (member.tooth, *member.others.values()):
        if id(tooth) not in moved:
            moved[id(tooth)] = move(tooth)
    others = {number: moved[id(tooth)] for number, tooth in member.others.items()}
    return replace(member, tooth=moved[id(member.tooth)], others=others)


def offset_tooth(tooth: Tooth, distance: float) -> Tooth:
    """Return the tooth with all its surfaces moved.

    Raises DesignError, with the largest distance that works, if the distance is too large.
    """
    made = _trial(tooth, distance)
    if isinstance(made, Tooth):
        return made
    raise distance_refusal(OFFSET_KEY, distance, tooth.height, OFFSET_ACCURACY, lambda d: _trial(tooth, d))


def distance_refusal(
    key: str, distance: float, height: float, accuracy: float, trial: Callable[[float], Tooth | str]
) -> ArgumentError:
    """Return the refusal of a distance (mm) by which surfaces of a tooth cannot move, with the largest that works.

    - height: height of the tooth, mm.
    - accuracy: accuracy of the largest distance, as a share of the height.
    - trial: the moved tooth for a distance, or the reason why it is wrong.
    """
    # bisection between no distance and the asked distance, or one tooth height
    most, rounds = float(np.sign(distance)) * min(abs(distance), height), int(np.ceil(-np.log2(accuracy)))
    largest, beyond = last_true(
        lambda tried, _: np.array([isinstance(trial(float(d)), Tooth) for d in tried]),
        np.zeros(1),
        np.array([most]),
        rounds=rounds,
    )
    # the fault just beyond the largest distance explains more than the fault at the asked distance
    reason = trial(float(beyond[0]))
    digits = max(int(np.ceil(-np.log10(accuracy * height))), 0)
    shown = np.trunc(largest[0] * 10.0**digits) / 10.0**digits
    bound = "at most" if distance > 0.0 else "at least"
    return ArgumentError(key, distance, unit="mm", reason=str(reason), allowed=f"{bound} {shown:.{digits}f} mm")


def _trial(tooth: Tooth, distance: float) -> Tooth | str:
    """Return the tooth with all its surfaces moved, or the reason why it is wrong."""
    try:
        made = _shift(tooth, distance)
        made.prove()
        fault = _fault(made, tooth)
    except (NoSolutionError, ValueError) as failure:
        # ValueError: fillets between which no root can be drawn
        return str(failure)
    return fault or made


def _shift(tooth: Tooth, distance: float) -> Tooth:
    """Return the tooth with all its surfaces moved, before any test."""
    blank = replace(tooth.blank, tip=tooth.blank.tip.parallel(distance), root=tooth.blank.root.parallel(distance))
    edge = tooth.tip_edge
    if edge is not None and edge.rounded:
        edge = edge.grown(distance) if edge.least + distance > 0.0 else None
    right, left = (_side(side, tooth, blank, distance) for side in (tooth.right, tooth.left))
    made = replace(tooth, right=right, left=left, blank=blank, tip_edge=edge)
    if tooth.crest is not None:
        # flanks pass smoothly into a generated land: all of them move along common normals
        made = replace(made, crest=replace(tooth.crest, surface=Parallel(tooth.crest.surface, distance)))
    return made if tooth.bottom is None else replace(made, bottom=_bottom(tooth, tooth.bottom, made, distance))


def _bottom(tooth: Tooth, bottom: Bottom, made: Tooth, distance: float) -> Bottom:
    """Return the moved root of a tooth; a root drawn from fillet to fillet is drawn again between the fillets of
    `made`.
    """
    axial, extent = tooth.blank.axial, tooth.blank.extent
    middle, back = np.array([0.5 * sum(extent)]), tooth.joint.to(-tooth.pitch_angle)

    def end(side: ToothSide, stations: Array) -> Jet:
        """Return the jet of a side's fillet at the root."""
        return along(side.fillet, np.full_like(stations, side.root), stations, axial)[1]

    fillets = (end(tooth.left, middle).move(back), end(tooth.right, middle))
    if all(
        _touch(fillet.n, along(bottom.surface, np.array([h]), middle, axial)[1].n)
        for fillet, h in zip(fillets, bottom.ends, strict=True)
    ):
        return replace(bottom, surface=Parallel(bottom.surface, distance))
    strip = Strip.through(axial, extent, lambda a: back.point(end(made.left, a).r), lambda a: end(made.right, a).r)
    return Bottom(strip, (0.0, 1.0))


def _side(side: ToothSide, tooth: Tooth, blank: Blank, distance: float) -> ToothSide:
    """Return one side with its surfaces moved."""
    smooth, fillet, root = side.smooth_flank, Parallel(side.fillet, distance), side.root
    if tooth.bottom is None:
        root = _end(fillet, root, blank.root, blank)
    return replace(
        side,
        flank=Parallel(side.flank, distance),
        fillet=fillet,
        root=root,
        tip_corner=None if side.tip_corner is None else _tip_corner(side, side.tip_corner, blank, distance),
        smooth_flank=None if smooth is None else lambda p, v: Parallel(smooth(p, v), distance),
        generated=side.generated or side,
        crossed=side.crossed or side.sharp or not smooth_at_form_point(side, blank),
        generation=None,
    )


def smooth_at_form_point(side: ToothSide, blank: Blank) -> bool:
    """True if flank and fillet are tangent at the form point all along the face; a modified flank may leave the fillet
    in an edge.
    """
    stations = blank.extent[0] + np.linspace(0.0, 1.0, PROOF_STATIONS) * (blank.extent[1] - blank.extent[0])
    flank, fillet = (
        along(surface, np.full_like(stations, p), stations, blank.axial)[1].n
        for surface, p in zip((side.flank, side.fillet), side.form_point, strict=True)
    )
    return bool((np.linalg.norm(flank - fillet, axis=-1) < TANGENT_SINE).all())


def _tip_corner(side: ToothSide, corner: TipCorner, blank: Blank, distance: float) -> TipCorner:
    """Return the moved tip chamfer or rounding; it ends where it crosses the flank if the two are not tangent."""
    moved, (p, q) = Parallel(corner.surface, distance), corner.form_point
    normals = [_middle(surface, x, blank).n for surface, x in ((side.flank, p), (corner.surface, q))]
    return TipCorner(
        moved,
        corner.form_point,
        _end(moved, corner.end, blank.tip, blank),
        corner.crossed or not _touch(*normals),
    )


def _middle(surface: Surface, p: float, blank: Blank) -> Jet:
    """Jet (1,) of a surface at its parameter p at mid face."""
    return along(surface, np.array([p]), np.array([0.5 * sum(blank.extent)]), blank.axial)[1]


def _end(surface: Surface, end: float, level: LandLevel, blank: Blank) -> float:
    """Parameter at which a surface ends at a land or root, near `end`: at the point of tangency, otherwise at the
    intersection.
    """
    for _ in range(END_NEWTON_STEPS):
        jet = _middle(surface, end, blank)
        # Newton's step to the level, along the curve of constant station; it stops at a point of tangency
        up, station = level.gradient(jet.r), blank.axial.gradient(jet.r)
        if _touch(jet.n, up / np.linalg.norm(up, axis=-1, keepdims=True)):
            break
        way = jet.r_u - (dot(station, jet.r_u) / dot(station, jet.r_v))[:, None] * jet.r_v
        end -= float((level.value(jet.r) / dot(up, way))[0])
    return end


def _touch(n: Array, other: Array) -> bool:
    """True if surfaces with these unit normals (1, 3) at a common point are tangent there."""
    return bool(np.linalg.norm(n - other) < TANGENT_SINE)


def _fault(made: Tooth, base: Tooth) -> str:
    """Reason why a tooth moved from `base` is wrong; empty if it is sound."""
    s, sections, middle = (
        np.linspace(0.0, 1.0, LINK_SAMPLES),
        made.sections(np.linspace(0.0, 1.0, PROOF_STATIONS)),
        base.sections([0.5]),
    )
    grids = {region: made.grid(region, s, sections) for region in made.regions}
    sound = {region: base.grid(region, [0.5], middle).jet for region in grids if region in base.regions}
    # the ends of the body's profile must stay below the root
    ends = np.array([(rho, 0.0, z) for rho, z in made.blank.body.profile[:: len(made.blank.body.profile) - 1]])
    if (made.blank.root.value(ends) >= 0.0).any():
        return "the root would cut through the body under the teeth"
    for region, grid in grids.items():
        before = sound.get(region)
        if not made.chain[region].generated or grid.jet is None or before is None:
            continue
        # a cusp: the area density changes sign against that of the unmoved surface
        sense = float(np.sign(area_density(before))[0, 0])
        if _least_density(made, region, sense, (s, sense * area_density(grid.jet))) < -ZERO_LENGTH_MM:
            return f"the {_words(region)} would have a cusp: its radius of curvature is smaller"
    for (region, grid), after in zip(grids.items(), [*grids.values()][1:], strict=False):
        if np.abs(grid.points[-1] - after.points[0]).max() > MAX_LINK_GAP_MM:
            return f"the {_words(region)} would part from what it meets"
    if crosses_itself(made, np.concatenate([grid.points[1:] for grid in grids.values()])):
        return CROSSED_TEETH
    return ""


def _least_density(made: Tooth, region: Region, sense: float, on_grid: tuple[Array, Array]) -> float:
    """Least area density of a link as a share of the largest.

    `on_grid`: s (S,) and densities (S, T) at all stations. If the least density is near 0, the grid is refined round
    it.
    """
    (s, density), t = on_grid, np.linspace(0.0, 1.0, PROOF_STATIONS)
    largest = float(np.abs(density).max())
    for _ in range(DENSITY_ROUNDS):
        if not 0.0 <= density.min() < LOW_DENSITY_SHARE * largest:
            break
        i, j = (int(k) for k in np.unravel_index(density.argmin(), density.shape))
        s, t = (np.linspace(x[max(k - 1, 0)], x[min(k + 1, x.size - 1)], PROOF_STATIONS) for x, k in ((s, i), (t, j)))
        jet = made.grid(region, s, made.sections(t)).jet
        assert jet is not None
        density = sense * area_density(jet)
    return float(density.min()) / largest


def _words(region: Region) -> str:
    """Return a region's name for messages."""
    return str(region).replace("_", " ")


def crosses_itself(tooth: Tooth, points: Array) -> bool:
    """True if a section of one pitch, points (N, T, 3), crosses itself or its neighbours.

    The points are laid into the plane of (arc length round the joint, height).
    """
    joint = tooth.joint
    around = joint.running(joint.angle(points).T)
    heights = tooth.blank.across.value(points).T
    arm = float(joint.arm(points).mean())
    section = np.stack((arm * around, heights), axis=-1)
    pitch_step = np.array([arm * tooth.pitch_angle, 0.0])
    row = np.concatenate((section - pitch_step, section, section + pitch_step), axis=1)
    count = section.shape[1]
    # segments p-q of this tooth against segments a-b of three teeth: they cross if each separates the other's ends
    p, q = row[:, count - 1 : 2 * count - 1, None], row[:, count : 2 * count, None]
    a, b = row[:, None, :-1], row[:, None, 1:]
    sides = plane_cross(q - p, a - p) * plane_cross(q - p, b - p), plane_cross(b - a, p - a) * plane_cross(b - a, q - a)
    long_enough = [np.hypot(*np.moveaxis(last - first, -1, 0)) > ZERO_LENGTH_MM for first, last in ((p, q), (a, b))]
    return bool(((sides[0] < 0.0) & (sides[1] < 0.0) & long_enough[0] & long_enough[1]).any())
