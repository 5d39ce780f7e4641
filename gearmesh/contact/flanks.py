"""Contact of a gear pair: hand the trimmed flanks of teeth to the solver, which knows surfaces but no teeth."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.contact.conditions.ends import Between, FormPoints, root_of, tip_of
from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.hertz import STEEL, Material, contact_modulus, line_contact, normal_force, point_contact
from gearmesh.contact.pair import (
    CREASE_NAMES,
    FILLET_PART,
    FORM_POINT,
    RIDGE_NAMES,
    ROOT_EDGE,
    TIP_CORNERS,
    TIP_EDGE,
    Pair,
)
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array, cross, distinct, unit
from gearmesh.kernel.surface.curvature import in_plane, principal, relative_curvature, shape_operator, tangent_basis
from gearmesh.kernel.surface.levels import ConeLevel, Level, Shifted
from gearmesh.kernel.surface.nearest import tangential
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.kept_by_tooth import KeptByTooth
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Side
from gearmesh.teeth.section import Link, breaks
from gearmesh.teeth.tooth import Tooth

#: points of the grid across a flank
FLANK_ROWS = 13
#: points of the grid across a fillet
FILLET_ROWS = 13
#: points of the grid across a chamfer or rounding of the tip
TIP_ROWS = 9
#: sine of the angle between normals up to which two surfaces pass smoothly into each other
SMOOTH_ANGLE_SINE = 1e-6


class ToothParts(NamedTuple):
    """Parts of one side of a tooth for the solver, with one mount."""

    #: trimmed flank
    flank: Flank
    #: fillet
    fillet: Flank
    #: chamfer or rounding of the tip; None for a sharp tip
    tip: Flank | None


#: parts of the last teeth, with the mount that each member had first
_KEPT_PARTS = KeptByTooth[ToothParts]()


def _parts(member: Member, side: Side) -> ToothParts:
    """Return the parts of one side of a member with its mount; those of the last teeth are kept with their tables."""

    def made() -> ToothParts:
        return ToothParts(contact_flank(member, side), contact_fillet(member, side), contact_tip_edge(member, side))

    flank, fillet, tip = _KEPT_PARTS.get(member.one_tooth, side, made)
    mount = member.mount
    return ToothParts(flank.remount(mount), fillet.remount(mount), None if tip is None else tip.remount(mount))


def solver_flank(member: Member, side: Side) -> Flank:
    """Return the mounted flank of one side of a member as `solver_pair` has it."""
    return _parts(member, side).flank


def solver_pair(pair: GearPair) -> Pair:
    """Return the mounted flanks, fillets and tip edges of a gear pair for the solver."""
    pinion, gear = (_parts(member, side) for member, side in zip(pair.both, pair.flanks, strict=True))
    return Pair(
        pinion=pinion.flank,
        gear=gear.flank,
        ratio=pair.ratio,
        drive=pair.drive,
        delta=pair.delta,
        fillets=(pinion.fillet, gear.fillet),
        tips=(pinion.tip, gear.tip),
        pitch=pair.pitch,
        arm_turns=pair.arm_turns,
    )


def analyse(pair: GearPair, phi1: Array) -> ContactPath:
    """Compute the contact path of a gear pair at phi1 (P,), rad, as its source counts phi1."""
    return contact_path(solver_pair(pair), phi1, pair.generation)


@dataclass(frozen=True)
class PathHertz:
    """Hertz contact at the P positions of a path; values are NaN at edges and without contact."""

    #: torque on the pinion, Nm
    torque: float
    #: normal force (P,), N
    force: Array
    #: greatest pressure (P,), MPa
    peak_pressure: Array
    #: semi-major axis (P,) of the contact ellipse, or half the length of a contact line, mm
    semi_major: Array
    #: semi-minor axis (P,) of the contact ellipse, or half the width of the contact strip, mm
    semi_minor: Array
    #: approach (P,) of the members, mm, NaN in line contact, where half-spaces have none
    approach: Array
    #: share (P,) of the torque on the tooth pair
    share: Array

    @property
    def line_load(self) -> Array:
        """Load per length (P,), N/mm, in the middle of the contact: the integral of the pressure across it."""
        loads: Array = 0.5 * np.pi * self.peak_pressure * self.semi_minor
        return loads


def refuse_torque(torque: float) -> None:
    """Raise ArgumentError for a torque (Nm) that is not above 0."""
    if not 0.0 < torque < np.inf:
        raise ArgumentError("torque", torque, unit="Nm", allowed="a finite number above 0")


def hertz_path(
    pair: GearPair,
    path: ContactPath,
    torque: float,
    materials: tuple[Material, Material] = (STEEL, STEEL),
    share: ArrayLike = 1.0,
) -> PathHertz:
    """Compute Hertz contact along a solved path under a torque (Nm) on the pinion in the driving sense.

    `share` (P,) is the share of the torque on the tooth pair; by default the pair carries all of it. The load on a line is uniform,
    and its curvature is the curvature at the middle. `materials` belong to pinion and gear. Raises ArgumentError unless torque > 0.
    """
    refuse_torque(torque)
    mount, modulus = pair.pinion.mount, contact_modulus(*materials)
    force = np.abs(normal_force(1e3 * torque, path.point, path.normal, mount.origin, mount.axis, share))
    kappa = separation_curvatures(pair, path)
    values = np.full((4, len(path.phi1)), np.nan)
    points = np.flatnonzero((path.kind == "point") & (kappa > 0.0).all(axis=-1))
    contact = point_contact(kappa[points, 0], kappa[points, 1], force[points], modulus)
    values[:, points] = contact.peak_pressure, contact.semi_major, contact.semi_minor, contact.approach
    lengths = np.array([np.nan if line is None else _length(line) for line in path.lines])
    lines = np.flatnonzero((path.kind == "line") & (lengths > 0.0) & (kappa[:, 1] > 0.0))
    loaded = line_contact(kappa[lines, 1], force[lines] / lengths[lines], modulus)
    values[:3, lines] = loaded.peak_pressure, 0.5 * lengths[lines], loaded.half_width
    force = np.where(np.isnan(values[0]), np.nan, force)
    peak, semi_major, semi_minor, approach = values
    return PathHertz(torque, force, peak, semi_major, semi_minor, approach, np.where(path.touching, share, np.nan))


def touching_jets(pair: GearPair, path: ContactPath) -> tuple[Jet, Jet]:
    """Return jets (P,) of both members at the points of a path, fixed frame; NaN without contact."""
    jets = []
    for member, side, params, turn, regions in (
        (pair.pinion, pair.flanks[0], path.params1, path.rotation, path.regions[0]),
        (pair.gear, pair.flanks[1], path.params2, path.phi2, path.regions[1]),
    ):
        with np.errstate(invalid="ignore"):
            jet = member.tooth.side(side).flank.jet(params[:, 0], params[:, 1])
            for region in (FILLET_PART, TIP_EDGE):
                surface = _surface(member.tooth, side, region) if (regions == region).any() else None
                if surface is not None:
                    jet = jet.where(regions != region, surface.jet(params[:, 0], params[:, 1]))
            jets.append(jet.move(member.mount.at(turn)))
    return jets[0], jets[1]


def _surface(tooth: Tooth, side: Side, region: str) -> Surface | None:
    """Return the surface of a fillet or tip edge."""
    return tooth.side(side).fillet if region == FILLET_PART else tooth.tip_edges.get(side)


def separation_curvatures(pair: GearPair, path: ContactPath) -> Array:
    """Return relative principal curvatures (P, 2), 1/mm, smaller first, of the gap at the points of a path."""
    first, second = touching_jets(pair, path)
    e1, e2 = tangent_basis(first)
    relative = principal(relative_curvature(first, second, e1, e2))
    return np.stack((-relative.k1, -relative.k2), axis=-1)


@dataclass(frozen=True)
class Curvatures:
    """Principal curvatures by the normal out of the body: below 0 where a flank is convex; NaN at edges and without contact."""

    #: greater principal curvature (P,), 1/mm
    k1: Array
    #: smaller principal curvature (P,), 1/mm
    k2: Array
    #: unit vectors (P, 3) along the direction of `k1`, fixed frame
    direction1: Array
    #: unit vectors (P, 3) along the direction of `k2`, fixed frame
    direction2: Array


def path_curvatures(pair: GearPair, path: ContactPath) -> tuple[Curvatures, Curvatures, Curvatures]:
    """Compute curvatures of the pinion's flank, of the gear's flank, and relative, at the points of a path [CR3553 1.6, 1.7].

    Relative curvatures belong to the sum of both shape operators, each by the normal out of its body (K1 - K2 by one normal).
    They are below 0 where the flanks part, and 0 along a line of contact.
    """
    first, second = touching_jets(pair, path)
    (e1, e2), (g1, g2) = tangent_basis(first), tangent_basis(second)
    known = np.isin(path.kind, ("point", "line"))
    return (
        _curvatures(shape_operator(first, e1, e2), e1, e2, known),
        _curvatures(shape_operator(second, g1, g2), g1, g2, known),
        _curvatures(relative_curvature(first, second, e1, e2), e1, e2, known),
    )


def _curvatures(operator: Array, e1: Array, e2: Array, known: NDArray[np.bool_]) -> Curvatures:
    """Return principal curvatures of operators (P, 2, 2) in tangent bases e1, e2 (P, 3); NaN where not `known` (P,)."""
    principal_curvatures = principal(operator)
    ways = in_plane(principal_curvatures.angle, e1, e2)
    k1, k2 = (np.where(known, k, np.nan) for k in (principal_curvatures.k1, principal_curvatures.k2))
    first, second = (np.where(known[:, None], way, np.nan) for way in ways)
    return Curvatures(k1, k2, first, second)


def smooth_under(pair: GearPair, path: ContactPath) -> NDArray[np.bool_]:
    """Return True (P,) where the contact ellipse lies on smooth parts of both flanks.

    Across a line on which a relief begins, the gap differs from the gap of the curvatures at the point.
    """
    is_smooth = np.ones(len(path.phi1), dtype=bool)
    axes = path.semi_major[:, None] * path.major, path.semi_minor[:, None] * path.minor
    both = zip(pair.both, pair.flanks, touching_jets(pair, path), (path.params1, path.params2), strict=True)
    for member, which, jet, at in both:
        side = member.tooth.side(which)
        steps = [np.stack(tangential(jet, axis), axis=-1) for axis in axes]
        reach = np.hypot(*steps)
        for k, lines in enumerate((side.flank_breaks, side.face_breaks)):
            for place in lines:
                is_smooth &= ~(np.abs(at[:, k] - place) <= reach[:, k])
    return is_smooth


def _length(line: Array) -> float:
    return float(np.nansum(np.linalg.norm(np.diff(line, axis=0), axis=-1)))


def contact_flank(member: Member, side: Side) -> Flank:
    """Return one trimmed flank of a member with its mount.

    Raises TrimError where the tooth cannot be trimmed, DesignError where teeth of the member differ.
    """
    tooth = member.one_tooth
    own = tooth.side(side)
    grid = tooth.grid(FLANK_REGIONS[side], rows_of(tooth.chain[FLANK_REGIONS[side]], side), tooth.even)
    axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
    form_point = FormPoints(tooth, side, grid)
    smooth = {FORM_POINT} if form_point.smooth else set()
    edge = tooth.tip_edge_grid(side, np.array([0.0, 1.0]))
    if edge is not None and _are_parallel(grid.normals[-1], edge.normals[0]):
        smooth.add("tip")
    if tooth.crest is not None:
        # a generated land continues the flank
        smooth.add("tip")
    return Flank(
        surface=own.flank,
        mount=member.mount,
        edges={
            "tip": tip_of(tooth, grid),
            "toe": Shifted(axial, toe, -1.0),
            "heel": Shifted(axial, heel),
            FORM_POINT: form_point.level,
        },
        axial=axial,
        extent=(toe, heel),
        grid=grid.parameters,
        beyond_ends=form_point,
        smooth=frozenset(smooth),
        creases=_creases(tooth, side),
        smooth_surface=own.smooth_flank,
        tip_corners=_tip_corners(tooth),
        unbroken=not (own.flank_breaks or own.face_breaks or own.face_bends or own.tabulated),
    )


def rows_of(link: Link, side: Side) -> Array:
    """Return s (I,) of the rows of a flank's grid from the root on: equally spaced rows and the seams."""
    s = distinct(np.append(np.linspace(0.0, 1.0, FLANK_ROWS), breaks(link)))
    return s if side is Side.RIGHT else s[::-1]


def _creases(tooth: Tooth, side: Side) -> dict[str, Level]:
    """Return the levels through the creases of a flank."""
    own, middle = tooth.side(side), tooth.stations([0.5])
    levels: dict[str, Level] = {}
    for name, p in zip(CREASE_NAMES, own.creases, strict=False):
        r = along(own.flank, np.full_like(middle, p), middle, tooth.blank.axial)[1].r
        levels[name] = ConeLevel.of(float(np.hypot(r[0, 0], r[0, 1])), 0.0)
    return levels | {
        name: Shifted(tooth.blank.axial, place) for name, place in zip(RIDGE_NAMES, own.ridges, strict=False)
    }


def _tip_corners(tooth: Tooth) -> dict[str, Level]:
    """Return the levels of the stations at which the tip line of a flank has corners."""
    axial, ends = tooth.blank.axial, sorted(tooth.blank.extent)
    inside = [place for place in tooth.blank.tip.corners(axial) if ends[0] < place < ends[1]]
    return {name: Shifted(axial, place) for name, place in zip(TIP_CORNERS, inside, strict=False)}


def contact_fillet(member: Member, side: Side) -> Flank:
    """Return the fillet of one side of a member with its mount, from root to form point; toe, heel and root are its edges.

    Raises TrimError where the tooth cannot be trimmed, DesignError where teeth of the member differ.
    """
    tooth = member.one_tooth
    own = tooth.side(side)
    axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
    s = np.linspace(0.0, 1.0, FILLET_ROWS)
    grid = tooth.grid(FILLET_REGIONS[side], s if side is Side.RIGHT else s[::-1], tooth.even)
    return Flank(
        surface=own.fillet,
        mount=member.mount,
        edges={
            "toe": Shifted(axial, toe, -1.0),
            "heel": Shifted(axial, heel),
            ROOT_EDGE: root_of(axial, grid, tooth.even.stations, tooth.joint),
        },
        axial=axial,
        extent=(toe, heel),
        grid=grid.parameters,
        beyond_ends=Between(grid, axial, tooth.even.stations),
        smooth=frozenset({ROOT_EDGE}),
        unbroken=not (own.fillet_breaks or own.face_breaks or own.face_bends or own.tabulated),
    )


def contact_tip_edge(member: Member, side: Side) -> Flank | None:
    """Return the tip chamfer or rounding of one side of a member with its mount, from flank to land; None for a sharp tip.

    Its edges are toe and heel, and the land if the surfaces meet at an angle. An edge between flank and chamfer belongs to the
    flank.

    Raises TrimError where the tooth cannot be trimmed, DesignError where teeth of the member differ.
    """
    tooth = member.one_tooth
    grid = tooth.tip_edge_grid(side, np.linspace(0.0, 1.0, TIP_ROWS))
    if grid is None:
        return None
    axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
    edges: dict[str, Level] = {"toe": Shifted(axial, toe, -1.0), "heel": Shifted(axial, heel)}
    if not _are_parallel(unit(tooth.blank.tip.gradient(grid.points[-1])), grid.normals[-1]):
        edges["tip"] = tip_of(tooth, grid)
    return Flank(
        surface=tooth.tip_edges[side],
        mount=member.mount,
        edges=edges,
        axial=axial,
        extent=(toe, heel),
        grid=grid.parameters,
        beyond_ends=Between(grid, axial, tooth.even.stations, back=0.0),
    )


def _are_parallel(first: Array, second: Array) -> bool:
    """Return True if unit vectors (N, 3) are parallel: surfaces with these normals pass smoothly into each other."""
    return bool((np.linalg.norm(cross(first, second), axis=-1) < SMOOTH_ANGLE_SINE).all())
