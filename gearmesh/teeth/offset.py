"""Teeth with their surfaces moved along the exact normals: stock to be ground off, clearance of printed teeth, spark gaps.

Everything that bounds the teeth moves, what tools generate as a `Parallel` surface, lands and roots as parallel levels; end
faces, bore and the rest of the body stay where they are. Surfaces are trimmed against each other anew, by what trims every tooth:
those that touch have points and normals in common and still touch, those that meet in an edge end where they cross. What
is drawn, not generated, is drawn anew: tip chamfers in their size, roundings with a radius larger by the distance, a root
straight from fillet to fillet where two cutters leave it so. Distances are in mm, positive away from the material.

A distance may be too large in three ways, which are looked for on sections from toe to heel:

- 1 - d k < 0 for a principal curvature k (`curvature`; hollow: positive): the surface turns inside out, a fillet first;
- the section crosses itself or that of the next tooth: the space is closed, the tooth cut through;
- the tooth cannot be trimmed: it is pointed, the tip beyond what the tool generates, the root in the bore.
"""

from __future__ import annotations

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

#: name under which a distance is refused
KEY = "offset"
#: points of every link of a section on which an offset is proved
ACROSS = 33
#: share of the tooth's height to which the largest offset is found
ACCURACY = 1e-4
#: sine of the angle between normals of surfaces that touch
TOUCHING = 1e-7
#: Newton steps to where a surface ends
STEPS = 20
#: share of the largest area density of a surface below which its least is looked for between stations, and how often, four times as
#: close each time: what nine stations say of a bevel gear's fillet is 2.5 um too large, one round leaves a sixteenth
NEAR, CLOSER = 0.1, 3
#: lengths (mm) of a section that are rounding, and by which neighbouring links may miss each other
SHORT, MISS = 1e-9, 1e-7


def offset_member(member: Member, distance: float) -> Member:
    """The member with all its teeth moved. Raises DesignError, with the largest distance that works, where one is too large."""
    if distance == 0.0:
        return member
    if not np.isfinite(distance):
        raise ArgumentError(KEY, distance, must_be="a finite number of mm")
    own, others = offset_tooth(member.tooth, distance), dict[int, Tooth]()
    for number, tooth in member.others.items():
        alike = next((k for k in others if member.others[k] is tooth), None)
        others[number] = offset_tooth(tooth, distance) if alike is None else others[alike]
    return replace(member, tooth=own, others=others)


def offset_tooth(tooth: Tooth, distance: float) -> Tooth:
    """The tooth with all its surfaces moved. Raises DesignError, with the largest distance that works, where it is too large."""
    made = _trial(tooth, distance)
    if isinstance(made, Tooth):
        return made
    most, rounds = float(np.sign(distance)) * min(abs(distance), tooth.height), int(np.ceil(-np.log2(ACCURACY)))
    largest, beyond = last_true(
        lambda tried, _: np.array([isinstance(_trial(tooth, float(d)), Tooth) for d in tried]),
        np.zeros(1),
        np.array([most]),
        rounds=rounds,
    )
    # what is wrong next to what works says more than what is wrong far beyond it
    reason = _trial(tooth, float(beyond[0]))
    digits = max(int(np.ceil(-np.log10(ACCURACY * tooth.height))), 0)
    shown = np.trunc(largest[0] * 10.0**digits) / 10.0**digits
    bound = "at most" if distance > 0.0 else "at least"
    raise ArgumentError(KEY, distance, unit="mm", reason=str(reason), allowed=f"{bound} {shown:.{digits}f} mm")


def _trial(tooth: Tooth, distance: float) -> Tooth | str:
    """The tooth with all its surfaces moved, or what is wrong with it."""
    try:
        made = _shift(tooth, distance)
        made.prove()
        fault = _fault(made, tooth)
    except (NoSolutionError, ValueError) as failure:
        # ValueError: fillets between which no root can be drawn
        return str(failure)
    return fault or made


def _shift(tooth: Tooth, distance: float) -> Tooth:
    """The tooth with all its surfaces moved, as it comes."""
    blank = replace(tooth.blank, tip=tooth.blank.tip.parallel(distance), root=tooth.blank.root.parallel(distance))
    edge = tooth.tip_edge
    if edge is not None and edge.rounded:
        edge = replace(edge, size=edge.size + distance) if edge.size + distance > 0.0 else None
    right, left = (_side(side, tooth, blank, distance) for side in (tooth.right, tooth.left))
    made = replace(tooth, right=right, left=left, blank=blank, tip_edge=edge)
    return made if tooth.bottom is None else replace(made, bottom=_bottom(tooth, tooth.bottom, made, distance))


def _bottom(tooth: Tooth, bottom: Bottom, made: Tooth, distance: float) -> Bottom:
    """The root of a tooth; one that does not touch the fillets, drawn from one to the other, is drawn between those of `made`."""
    axial, extent = tooth.blank.axial, tooth.blank.extent
    middle, back = np.array([0.5 * sum(extent)]), tooth.joint.to(-tooth.pitch_angle)

    def end(side: ToothSide, stations: Array) -> Jet:
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
        crossed=side.crossed or side.sharp or not _smooth(side, blank),
        generation=None,
    )


def _smooth(side: ToothSide, blank: Blank) -> bool:
    """Whether flank and fillet touch at the form point all along the face; a modified flank may leave the fillet in an edge."""
    stations = blank.extent[0] + np.linspace(0.0, 1.0, PROOF_STATIONS) * (blank.extent[1] - blank.extent[0])
    flank, fillet = (
        along(surface, np.full_like(stations, p), stations, blank.axial)[1].n
        for surface, p in zip((side.flank, side.fillet), side.form_point, strict=True)
    )
    return bool((np.linalg.norm(flank - fillet, axis=-1) < TOUCHING).all())


def _tip_corner(side: ToothSide, corner: TipCorner, blank: Blank, distance: float) -> TipCorner:
    """A tip chamfer or rounding; where it does not touch the flank they end where they cross."""
    moved, (p, q) = Parallel(corner.surface, distance), corner.form_point
    normals = [_middle(surface, x, blank).n for surface, x in ((side.flank, p), (corner.surface, q))]
    return TipCorner(
        moved,
        corner.form_point,
        _end(moved, corner.end, blank.tip, blank),
        corner.crossed or not _touch(*normals),
    )


def _middle(surface: Surface, p: float, blank: Blank) -> Jet:
    """The jet (1,) of a surface at its parameter p at mid face."""
    return along(surface, np.array([p]), np.array([0.5 * sum(blank.extent)]), blank.axial)[1]


def _end(surface: Surface, end: float, level: LandLevel, blank: Blank) -> float:
    """The parameter at which a surface ends at a land or root, near `end`: there where it touches it, else where it crosses it."""
    for _ in range(STEPS):
        jet = _middle(surface, end, blank)
        up, station = level.gradient(jet.r), blank.axial.gradient(jet.r)
        if _touch(jet.n, up / np.linalg.norm(up, axis=-1, keepdims=True)):
            break
        way = jet.r_u - (dot(station, jet.r_u) / dot(station, jet.r_v))[:, None] * jet.r_v
        end -= float((level.value(jet.r) / dot(up, way))[0])
    return end


def _touch(n: Array, other: Array) -> bool:
    """Whether surfaces with these unit normals (1, 3) at a common point touch there."""
    return bool(np.linalg.norm(n - other) < TOUCHING)


def _fault(made: Tooth, base: Tooth) -> str:
    """What is wrong with a tooth whose surfaces were moved from those of `base`; empty where nothing is."""
    s, sections, middle = (
        np.linspace(0.0, 1.0, ACROSS),
        made.sections(np.linspace(0.0, 1.0, PROOF_STATIONS)),
        base.sections([0.5]),
    )
    grids = {region: made.grid(region, s, sections) for region in made.regions}
    sound = {region: base.grid(region, [0.5], middle).jet for region in grids if region in base.regions}
    # the body is where the root is not
    ends = np.array([(rho, 0.0, z) for rho, z in made.blank.body.profile[:: len(made.blank.body.profile) - 1]])
    if (made.blank.root.value(ends) >= 0.0).any():
        return "the root would cut through the body under the teeth"
    for region, grid in grids.items():
        before = sound.get(region)
        if not made.chain[region].generated or grid.jet is None or before is None:
            continue
        sense = float(np.sign(area_density(before))[0, 0])
        if _least_density(made, region, sense, (s, sense * area_density(grid.jet))) < -SHORT:
            return f"the {_words(region)} would have a cusp: its radius of curvature is smaller"
    for (region, grid), after in zip(grids.items(), [*grids.values()][1:], strict=False):
        if np.abs(grid.points[-1] - after.points[0]).max() > MISS:
            return f"the {_words(region)} would part from what it meets"
    if _crosses(made, np.concatenate([grid.points[1:] for grid in grids.values()])):
        return "the teeth would cut themselves or each other"
    return ""


def _least_density(made: Tooth, region: Region, sense: float, on_grid: tuple[Array, Array]) -> float:
    """The least area density of a link as a share of the largest, from its values (S, T) at s (S,) and all stations: where they
    come near 0 closer and closer round the least one."""
    (s, density), t = on_grid, np.linspace(0.0, 1.0, PROOF_STATIONS)
    largest = float(np.abs(density).max())
    for _ in range(CLOSER):
        if not 0.0 <= density.min() < NEAR * largest:
            break
        i, j = (int(k) for k in np.unravel_index(density.argmin(), density.shape))
        s, t = (np.linspace(x[max(k - 1, 0)], x[min(k + 1, x.size - 1)], PROOF_STATIONS) for x, k in ((s, i), (t, j)))
        jet = made.grid(region, s, made.sections(t)).jet
        assert jet is not None
        density = sense * area_density(jet)
    return float(density.min()) / largest


def _words(region: Region) -> str:
    """A region as messages name it."""
    return str(region).replace("_", " ")


def _crosses(tooth: Tooth, points: Array) -> bool:
    """Whether a section of a pitch (N, T, 3), laid into (way round the joint, height), crosses itself or its neighbours."""
    joint = tooth.joint
    around = joint.running(joint.angle(points).T)
    heights = tooth.blank.across.value(points).T
    arm = float(joint.arm(points).mean())
    one = np.stack((arm * around, heights), axis=-1)
    way = np.array([arm * tooth.pitch_angle, 0.0])
    row = np.concatenate((one - way, one, one + way), axis=1)
    count = one.shape[1]
    p, q = row[:, count - 1 : 2 * count - 1, None], row[:, count : 2 * count, None]
    a, b = row[:, None, :-1], row[:, None, 1:]
    sides = plane_cross(q - p, a - p) * plane_cross(q - p, b - p), plane_cross(b - a, p - a) * plane_cross(b - a, q - a)
    long = [np.hypot(*np.moveaxis(last - first, -1, 0)) > SHORT for first, last in ((p, q), (a, b))]
    return bool(((sides[0] < 0.0) & (sides[1] < 0.0) & long[0] & long[1]).any())
