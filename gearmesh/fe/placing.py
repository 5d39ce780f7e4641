"""Where the teeth of a finite-element model touch: the leading tooth pair at a position, loaded, on its flanks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmesh.contact.flanks import hertz_path, solver_pair
from gearmesh.contact.hertz import Material, contact_modulus, normal_force
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.mesh.hexahedra.hexahedra import Focus, HexGrid
from gearmesh.mesh.hexahedra.layers import HALF_ARC, layers, running_angle
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: step in s and t of the difference quotients that give the directions of the flank's lines
STEP = 1e-4
#: step of the second differences that give how far the flank is from straight along the ellipse
BOW_STEP = 1e-2
#: neighbouring tooth pairs among which the leading one is looked for, either way
NEIGHBOURS = 2
#: rotation under load over that of the approach by Hertz alone, as teeth on their rim bend too: 1.12 of beveloid_crossed, 1.16 of
#: a worm drive
UNDER_LOAD = 1.15
#: half lengths of an ellipse over which stations of both members lie over each other
REACH = 1.5
#: difference of rotation (rad) below which pairs are ahead alike
ALIKE = 1e-9


@dataclass(frozen=True)
class PlacedPair:
    """The leading tooth pair at a position: its contact (a path of one position) under all of a torque.

    `force` N along the normal; by Hertz, NaN at an edge: `pressure` MPa at the middle, `semi_major` (of a line: half its
    length) and `semi_minor` mm. `approach` mm: by Hertz, elsewhere its order of magnitude. `arm`: length, mm, at which the
    force turns the pinion about z of the model's frame, signed as the torque that drives. `frame`: fixed frame to model.
    """

    path: ContactPath
    force: float
    pressure: float
    semi_major: float
    semi_minor: float
    approach: float
    arm: float
    frame: Rigid

    @property
    def sense(self) -> float:
        """Sense, 1 or -1, in which the torque that drives turns the pinion about z of the model's frame."""
        return math.copysign(1.0, self.arm)

    @property
    def turn(self) -> float:
        """About how far the load turns the pinion about z of the model's frame, rad."""
        return UNDER_LOAD * self.approach / self.arm

    @property
    def turns(self) -> tuple[float, float]:
        """Rotations of pinion and gear, rad."""
        return float(self.path.rotation[0]), float(self.path.phi2[0])


def place(pair: GearPair, phi1: float, torque: float, materials: tuple[Material, Material]) -> PlacedPair:
    """Positions of the members at phi1 (rad, counted as the source counts it) under a torque (N mm) on the pinion.

    The gear is as far on as the leading teeth push it; where that are neighbours of the pair at phi1, the pinion is turned by
    whole pitches so that they are the teeth on +x. Raises NoSolutionError if no teeth touch there.
    """
    flanks = solver_pair(pair)
    start = contact_path(flanks, np.array([phi1]), pair.generation)
    pitch = pair.pitch
    turn = float(start.rotation[0]) if start.touching[0] else phi1
    # whole pitches away other teeth stand alike, unless the members turn about other axes than their own
    if pair.pinion.mount.eccentricity == pair.gear.mount.eccentricity == (0.0, 0.0):
        turn -= pitch * float(np.round(turn / pitch))
    path = contact_path(flanks, turn + pitch * np.arange(-NEIGHBOURS, NEIGHBOURS + 1.0))
    if not path.touching.any():
        raise NoSolutionError(reason=f"no teeth touch at phi1 = {np.degrees(phi1):g} deg; tca shows where they do")
    ahead = np.where(path.touching, pair.drive * path.te, -np.inf)
    # pairs that are ahead alike, as of conjugate gears, differ by rounding only: the one asked for then leads
    away = np.abs(np.arange(-NEIGHBOURS, NEIGHBOURS + 1))
    foremost = np.argmin(np.where(ahead >= ahead.max() - ALIKE, away, NEIGHBOURS + 1))
    return _under(pair, contact_path(flanks, path.rotation[[int(foremost)]]), torque, materials)


def neighbours(
    pair: GearPair, at: PlacedPair, torque: float, materials: tuple[Material, Material]
) -> dict[tuple[int, int], PlacedPair]:
    """The tooth pairs beside the one placed that have contact, each as if it had all of the torque, by the places of their teeth
    (pinion, gear) from those on +x."""
    flanks, beside = solver_pair(pair), {}
    signs = (pair.pinion.mount.sign, pair.gear.mount.sign * int(np.sign(flanks.ratio)))
    for number in (-1, 1):
        path = contact_path(flanks, at.path.rotation - pair.pitch * number)
        if path.touching[0]:
            pinion, gear = (-int(sign) * number for sign in signs)
            beside[pinion, gear] = _under(pair, path, torque, materials)
    return beside


def _under(pair: GearPair, leading: ContactPath, torque: float, materials: tuple[Material, Material]) -> PlacedPair:
    """A tooth pair at the one position of its path, under all of a torque (N mm)."""
    mount = pair.pinion.mount
    hertz = hertz_path(pair, leading, 1e-3 * torque, materials)
    # the pinion pushes with its outward normal
    per_arm = float(normal_force(1.0, leading.point, leading.normal, mount.origin, mount.axis)[0])
    force, semi_major = abs(torque * per_arm), float(hertz.semi_major[0])
    approach = float(hertz.approach[0])
    if np.isnan(approach):
        # of a line the approach depends on the bodies' depth, of an edge on its sharpness: this is its order of magnitude
        length = 2.0 * semi_major if semi_major > 0.0 else 1.0
        approach = force / (contact_modulus(*materials) * length)
    return PlacedPair(
        leading,
        force=force,
        pressure=float(hertz.peak_pressure[0]),
        semi_major=semi_major,
        semi_minor=float(hertz.semi_minor[0]),
        approach=approach,
        arm=1.0 / per_arm,
        frame=mount.base.inverse,
    )


def focus_on(pair: GearPair, name: str, at: PlacedPair, cells: int = 1, *, turned: bool = False) -> Focus:
    """The loaded ellipse (or line, or point on an edge) in the coordinates of a member's working flank; with `turned` where the
    pinion's has it once the load has turned that."""
    which = pair.index(name)
    member, side = pair.both[which], pair.flanks[which]
    tooth, own = member.tooth, member.mount.at(at.turns[which]).inverse
    params = (at.path.params1, at.path.params2)[which][0]
    centre = arc_centre(tooth, side, params)
    s, t = flank_place(tooth, side, params)
    if np.isnan(at.pressure):
        return Focus(s, t, 0.0, 0.0, 0.0, 0.0, cells)
    # differences inside the flank: its grid ends at 0 and 1
    s_mid, t_mid = (float(np.clip(x, 2.0 * STEP, 1.0 - 2.0 * STEP)) for x in (s, t))
    nodes = STEP * np.array([-1.0, 1.0])
    points = layers(tooth, t_mid + nodes, centre).flank(side, s_mid + nodes).points
    along_s = (points[1, 0] + points[1, 1] - points[0, 0] - points[0, 1]) / (4.0 * STEP)
    along_t = (points[0, 1] + points[1, 1] - points[0, 0] - points[1, 0]) / (4.0 * STEP)
    axes = own.vector(np.stack((at.semi_major * major_axis(at.path), at.semi_minor * minor_axis(at.path))))
    in_plane = np.linalg.lstsq(np.stack((along_s, along_t), axis=-1), axes.T, rcond=None)[0]
    inverse = in_plane @ in_plane.T
    form = np.linalg.inv(inverse)
    middle = layers(tooth, [t_mid], centre)
    here, there = (middle.flank(side, np.array([s_mid])).points[0, 0] for side in Side)
    slope, normal = float(-form[0, 1] / form[0, 0]), own.vector(at.path.normal[0])
    if turned:
        turn = np.array([0.0, 0.0, at.turn])
        slid = own.vector(at.frame.inverse.vector(cross(turn, at.frame.point(at.path.point[0]))))
        back_s, back_t = np.linalg.lstsq(np.stack((along_s, along_t), axis=-1), -slid, rcond=None)[0]
        s, t = s + float(back_s), t + float(back_t)
    return Focus(
        s,
        t,
        slope=slope,
        half_s=1.0 / float(np.sqrt(form[0, 0])),
        half_t=float(np.sqrt(inverse[1, 1])),
        half_depth=2.0 * at.semi_minor / abs(float((here - there) @ normal)),
        cells=cells,
        bow=_bow(tooth, side, (s_mid, t_mid), slope, normal, centre),
    )


def _bow(tooth: Tooth, side: Side, place: tuple[float, float], slope: float, normal: Array, centre: float) -> float:
    """Second derivative (mm) in t of the height over the tangent plane at a place (s, t), along ds/dt = slope."""
    step = min(BOW_STEP, BOW_STEP / max(abs(slope), 1.0))
    s, t = (float(np.clip(x, 2.0 * BOW_STEP, 1.0 - 2.0 * BOW_STEP)) for x in place)
    low, middle, high = (
        layers(tooth, [t + k * step], centre).flank(side, np.array([s + k * step * slope])).points[0, 0]
        for k in (-1.0, 0.0, 1.0)
    )
    return abs(float((low - 2.0 * middle + high) @ normal)) / step**2


def stations_under_load(pair: GearPair, grid: HexGrid, at: PlacedPair) -> Array:
    """Stations t (K,) of the pinion's flank, a thread's, that lie over those of the gear's `grid` about the ellipse once the load
    has turned the pinion.

    Flanks that conform are polygons along the ellipse that must bend alike: a worm slides six times as far along its wheel as both
    approach each other. Where nodes of one met the middles of the other's edges, half of the ellipse did not touch in CalculiX.
    """
    pinion, gear = pair.both
    focus = focus_on(pair, gear.name, at)
    t = grid.t[np.abs(grid.t - focus.t) < REACH * focus.half_t]
    s = np.clip(focus.s + focus.slope * (t - focus.t), 0.0, 1.0)
    points = np.diagonal(layers(gear.tooth, t, grid.centre).flank(pair.flanks[1], s).points, axis1=0, axis2=1).T
    in_model = Rigid.about_z(-at.turn).point(at.frame.point(gear.mount.at(at.turns[1]).point(points)))
    own = pinion.mount.at(at.turns[0]).inverse.point(at.frame.inverse.point(in_model))
    screw = pinion.tooth.screw
    assert screw is not None
    angle = running_angle(pinion.tooth, own) - arc_centre(pinion.tooth, pair.flanks[0], at.path.params1[0])
    stations = 0.5 + np.sign(screw) * angle / (2.0 * HALF_ARC)
    return np.sort(stations[(stations > 0.0) & (stations < 1.0)])


def arc_centre(tooth: Tooth, side: Side, params: Array) -> float:
    """Running polar angle (rad) of a point of a flank with surface parameters (2,), the middle of the arc of a thread; of other
    teeth 0."""
    return 0.0 if tooth.screw is None else float(running_angle(tooth, tooth.side(side).flank.jet(*params).r))


def flank_place(tooth: Tooth, side: Side, params: Array) -> tuple[float, float]:
    """Coordinates (s, t) on the trimmed flank, s from form point to tip, of a point with surface parameters (2,); of a thread it is
    in the middle of the arc."""
    flank = tooth.side(side).flank
    toe, heel = tooth.blank.extent
    t = float((tooth.blank.axial.value(flank.jet(*params).r) - toe) / (heel - toe)) if tooth.screw is None else 0.5
    ends = tooth.flank_grid(side, np.array([0.0, 1.0]), np.array([np.clip(t, 0.0, 1.0)])).p
    assert ends is not None
    return float((params[0] - ends[0, 0]) / (ends[1, 0] - ends[0, 0])), t


def major_axis(path: ContactPath) -> Array:
    """Unit vector along the major axis, or along a line of contact from its first to its last point; fixed frame."""
    line = path.lines[0]
    axis: Array = path.major[0] if line is None else (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])
    return axis


def minor_axis(path: ContactPath) -> Array:
    return path.minor[0] if path.lines[0] is None else np.cross(path.normal[0], major_axis(path))
