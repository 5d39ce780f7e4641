"""Contact of a gear pair: its trimmed flanks handed to the solver, which knows nothing of teeth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline

from gearmesh.contact.heights import cubic
from gearmesh.contact.hertz import STEEL, Material, contact_modulus, line_contact, normal_force, point_contact
from gearmesh.contact.meshing import Flank
from gearmesh.contact.pair import JOINT, ROOT, Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array, polar_angle
from gearmesh.kernel.curvature import principal, relative_curvature, tangent_basis
from gearmesh.kernel.levels import CurveLevel, Level, ScrewLevel, Shifted
from gearmesh.kernel.surface import Jet
from gearmesh.teeth.region import FILLETS, FLANKS, Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.train import GearPair, Member

#: points of the grid across a flank, and across a fillet
ROWS, FILLET_ROWS = 13, 13
#: points of a flank's joint with the fillet, where undercut neither begins nor ends between them
JOINT_POINTS = 25
#: share of the face below which undercut at its very end does not count
SHORTEST = 1e-6
#: mm along the profile by which a point may lie past joint or root by its parameters and be told by its place alone
BACK = 1e-3


def solver_pair(pair: GearPair) -> Pair:
    """The two touching flanks of a gear pair, mounted, as the solver wants them."""
    return Pair(
        pinion=contact_flank(pair.pinion, pair.flanks[0]),
        gear=contact_flank(pair.gear, pair.flanks[1]),
        ratio=pair.ratio,
        drive=pair.drive,
        delta=pair.delta,
        fillets=(contact_fillet(pair.pinion, pair.flanks[0]), contact_fillet(pair.gear, pair.flanks[1])),
        pitch=pair.pitch,
    )


def analyse(pair: GearPair, phi1: Array) -> ContactPath:
    """Contact path of a gear pair at phi1 (P,), rad, counted as its source counts it."""
    return contact_path(solver_pair(pair), phi1, pair.generation)


@dataclass(frozen=True)
class PathHertz:
    """Hertz contact at the positions of a path, all (P,): NaN at edges and where there is no contact.

    `force` N along the normal; `peak_pressure` MPa; half axes `semi_major`, `semi_minor` and `approach` mm. At a line of
    contact `semi_major` is half its length and `approach`, which for half-spaces has no limit, is NaN.
    """

    torque: float
    force: Array
    peak_pressure: Array
    semi_major: Array
    semi_minor: Array
    approach: Array


def hertz_path(
    pair: GearPair, path: ContactPath, torque: float, materials: tuple[Material, Material] = (STEEL, STEEL)
) -> PathHertz:
    """Hertz contact along a solved path under a torque (Nm) on the pinion about its axis, in the sense that drives.

    All of the torque is on the one pair of teeth that the path is of, however many share it. A line is loaded evenly; its
    curvature is that at its middle. `materials` are those of pinion and gear. Raises DesignError unless torque > 0.
    """
    if not 0.0 < torque < np.inf:
        raise DesignError(f"torque = {torque:g} Nm: allowed is a finite number above 0")
    mount, modulus = pair.pinion.mount, contact_modulus(*materials)
    force = np.abs(normal_force(1e3 * torque, path.point, path.normal, mount.origin, mount.axis))
    kappa = separation_curvatures(pair, path)
    values = np.full((4, len(path.phi1)), np.nan)
    points = np.flatnonzero((path.kind == "point") & (kappa > 0.0).all(axis=-1))
    found = point_contact(kappa[points, 0], kappa[points, 1], force[points], modulus)
    values[:, points] = found.peak_pressure, found.semi_major, found.semi_minor, found.approach
    lengths = np.array([np.nan if line is None else _length(line) for line in path.lines])
    lines = np.flatnonzero((path.kind == "line") & (lengths > 0.0) & (kappa[:, 1] > 0.0))
    loaded = line_contact(kappa[lines, 1], force[lines] / lengths[lines], modulus)
    values[:3, lines] = loaded.peak_pressure, 0.5 * lengths[lines], loaded.half_width
    return PathHertz(torque, np.where(np.isnan(values[0]), np.nan, force), *values)


def touching_jets(pair: GearPair, path: ContactPath) -> tuple[Jet, Jet]:
    """Jets (P,) of both flanks at the points of a path, fixed frame; NaN where they do not touch."""
    jets = []
    for number, (member, side, params, turn) in enumerate(
        (
            (pair.pinion, pair.flanks[0], path.params1, path.rotation),
            (pair.gear, pair.flanks[1], path.params2, path.phi2),
        ),
        start=1,
    ):
        surfaces = member.tooth.side(side)
        with np.errstate(invalid="ignore"):
            found = surfaces.flank.jet(params[:, 0], params[:, 1])
            if (path.part == number).any():
                found = found.where(path.part != number, surfaces.fillet.jet(params[:, 0], params[:, 1]))
            jets.append(found.moved(member.mount.at(turn)))
    return jets[0], jets[1]


def separation_curvatures(pair: GearPair, path: ContactPath) -> Array:
    """Relative principal curvatures (P, 2), 1/mm, smaller first, with which the flanks part from the points of a path."""
    first, second = touching_jets(pair, path)
    e1, e2 = tangent_basis(first)
    relative = principal(relative_curvature(first, second, e1, e2))
    return np.stack((-relative.k1, -relative.k2), axis=-1)


def _length(line: Array) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=-1).sum())


def contact_flank(member: Member, side: Side) -> Flank:
    """One trimmed flank of a member in its mounting.

    Raises TrimError where the tooth cannot be trimmed.
    """
    tooth = member.tooth
    s = np.linspace(0.0, 1.0, ROWS)
    grid = tooth.grid(FLANKS[side], s if side is Side.RIGHT else s[::-1], tooth.even)
    axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
    # where a broken edge begins, if there is one
    tip = Shifted(tooth.blank.tip, float(tooth.blank.tip.value(grid.points[-1, grid.points.shape[1] // 2])))
    joint = _Joint(tooth, side, grid)
    return Flank(
        surface=tooth.side(side).flank,
        mount=member.mount,
        edges={
            "tip": tip,
            "toe": Shifted(axial, toe, -1.0),
            "heel": Shifted(axial, heel),
            JOINT: joint.level,
        },
        axial=axial,
        extent=(toe, heel),
        grid=grid.parameters,
        beyond_ends=joint,
        smooth=frozenset({JOINT}) if joint.smooth else frozenset(),
    )


def contact_fillet(member: Member, side: Side) -> Flank:
    """The fillet of one side of a member in its mounting, from the root to the joint; its ends but for the joint are edges.

    Raises TrimError where the tooth cannot be trimmed.
    """
    tooth = member.tooth
    axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
    s = np.linspace(0.0, 1.0, FILLET_ROWS)
    grid = tooth.grid(FILLETS[side], s if side is Side.RIGHT else s[::-1], tooth.even)
    return Flank(
        surface=tooth.side(side).fillet,
        mount=member.mount,
        edges={
            "toe": Shifted(axial, toe, -1.0),
            "heel": Shifted(axial, heel),
            ROOT: _root(axial, grid, tooth.even.stations),
        },
        axial=axial,
        extent=(toe, heel),
        grid=grid.parameters,
        beyond_ends=_Between(grid, axial, tooth.even.stations),
        smooth=frozenset({ROOT}),
    )


class _Joint:
    """The joint of a flank with the fillet, through exact points of it: `level` bounds the flank there.

    The surface may come back to that level behind a line of regression; called with parameters and own-frame points it gives how
    far (mm along the profile) they lie past the joint by their parameters, less `BACK`.
    """

    def __init__(self, tooth: Tooth, side: Side, grid: Grid) -> None:
        assert grid.p is not None
        assert grid.jet is not None
        axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
        across = CurveLevel.across_stations(axial)
        undercut = tooth.even.of(side).joint_flank != tooth.side(side).joint[0]
        self.smooth = not undercut.any()
        r, p = grid.points[:1], grid.p[:1]
        if undercut.any() and not undercut.all():
            breaks = tooth.breaks_of(side)
            cuts = np.concatenate(([0.0], breaks[(breaks > SHORTEST) & (breaks < 1.0 - SHORTEST)], [1.0]))
            t = np.stack([np.linspace(low, high, JOINT_POINTS) for low, high in pairwise(cuts)])
            joint = tooth.flank_grid(side, [0.0], t.ravel())
            assert joint.p is not None
            r, p = joint.points[0].reshape(*t.shape, 3), joint.p[0].reshape(t.shape)
        if heel < toe:
            r, p = r[::-1, ::-1], p[::-1, ::-1]
        curve = _pieces(axial.value(r), across.value(r))
        tips = grid.points[-1]
        above = np.sign((across.value(tips) - curve(axial.value(tips))).mean())
        self.level = CurveLevel(axial, across, curve, float(above))
        self._axial, self._parameter = axial, _pieces(axial.value(r), p)
        speed = float(np.linalg.norm(grid.jet.r_u[ROWS // 2, grid.points.shape[1] // 2]))
        self._scale = speed * float(np.sign((grid.p[0] - grid.p[-1]).mean()))

    def __call__(self, parameters: Array, r: Array) -> Array:
        found: Array = self._scale * (parameters[..., 0] - self._parameter(self._axial.value(r))) - BACK
        return found


def _pieces(x: Array, y: Array) -> PPoly:
    """Smooth curves, one through each row of points (K, N), x ascending, that meet where they end."""
    curves = [PPoly.from_spline(make_interp_spline(*row, k=5)) for row in zip(x, y, strict=True)]
    places = np.concatenate([curves[0].x, *(curve.x[1:] for curve in curves[1:])])
    return PPoly(np.concatenate([curve.c for curve in curves], axis=1), places)


def _root(axial: Level, grid: Grid, stations: Array) -> ScrewLevel:
    """What bounds a fillet, given by its grid at `stations` (T,), at its root, where it is tangent to a surface of revolution."""
    angle = np.unwrap(polar_angle(grid.points[0]))
    order = np.argsort(stations)
    curve = PPoly.from_spline(make_interp_spline(stations[order], angle[order], k=5))
    level = ScrewLevel(axial, curve, float(np.hypot(*grid.points[0, 0, :2])))
    inside = level.value(grid.points[1]).mean() < 0.0
    return level if inside else replace(level, radius=-level.radius)


class _Between:
    """How far (mm along the profile) fillet points lie past the joint with the flank, or past the root, less `BACK`."""

    def __init__(self, grid: Grid, axial: Level, stations: Array) -> None:
        assert grid.p is not None
        assert grid.jet is not None
        self._axial, self._stations = axial, stations
        self._root, self._joint = grid.p[0], grid.p[-1]
        self._speed = float(np.linalg.norm(grid.jet.r_u[FILLET_ROWS // 2, grid.points.shape[1] // 2]))

    def __call__(self, parameters: Array, r: Array) -> Array:
        place = _place(self._axial.value(r), self._stations)
        root, joint = (cubic(end, place) for end in (self._root, self._joint))
        p, sense = parameters[..., 0], np.sign(joint - root)
        found: Array = np.maximum(self._speed * sense * (p - joint), self._speed * sense * (root - p) - BACK)
        return found


def _place(axial: Array, stations: Array) -> Array:
    """Places of axial coordinates in steps of even stations (T,), none beyond the ends."""
    last = len(stations) - 1.0
    found: Array = np.clip((axial - stations[0]) * (last / (stations[-1] - stations[0])), 0.0, last)
    return found
