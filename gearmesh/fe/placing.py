"""Position of the teeth of a finite-element model: the leading tooth pair at a position, under load, and its contact on
the flanks."""

from __future__ import annotations

import math
from dataclasses import field, replace

import numpy as np

from gearmesh.contact.engagement.train_turns import as_pair_0, leading_pairs
from gearmesh.contact.flanks import hertz_path, solver_pair
from gearmesh.contact.hertz import Material, contact_modulus, normal_force
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.mesh.hexahedra.hexahedra import Focus, HexGrid
from gearmesh.mesh.hexahedra.layers import HALF_ARC, layers, running_angle
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: step in s and t of the difference quotients for the directions of the flank's lines
SLOPE_STEP = 1e-4
#: step of the second differences for the deviation of the flank from straight along the ellipse
BOW_STEP = 1e-2
#: rotation under load over the rotation by the Hertz approach alone, since teeth on their rim bend too: 1.12 for
#: beveloid_crossed, 1.16 for a worm drive
UNDER_LOAD = 1.15
#: half lengths of the ellipse over which stations of both members are matched
ELLIPSE_REACH = 1.5


@dataclass(frozen=True)
class PlacedPair:
    """The leading tooth pair at a position, with its contact under the whole torque."""

    #: gears whose teeth on +x are these teeth, displaced as they are there
    pair: GearPair
    #: contact, as a path of one position
    path: ContactPath
    #: force along the normal, N
    force: float
    #: Hertz pressure in the middle, MPa; NaN at an edge
    pressure: float
    #: Hertz semi-axis, mm; half the length of a line contact; NaN at an edge
    semi_major: float
    #: Hertz semi-axis, mm; NaN at an edge
    semi_minor: float
    #: Hertz approach, mm; for lines and edges its order of magnitude
    approach: float
    #: lever, mm, of the force about z of the model's frame, with the sign of the driving torque
    arm: float
    #: motion from the fixed frame to the model's frame
    frame: Rigid
    #: results of `focus_on`, by the member's name and `turned`
    focuses: dict[tuple[str, bool], Focus] = field(default_factory=dict, compare=False, repr=False)

    @property
    def sense(self) -> float:
        """Sense, 1 or -1, in which the driving torque rotates the pinion about z of the model's frame."""
        return math.copysign(1.0, self.arm)

    @property
    def turn(self) -> float:
        """Estimated rotation of the pinion about z of the model's frame under the load, rad."""
        return UNDER_LOAD * self.approach / self.arm

    @property
    def turns(self) -> tuple[float, float]:
        """Rotations of pinion and gear, rad."""
        return float(self.path.rotation[0]), float(self.path.phi2[0])


def place(pair: GearPair, phi1: float, torque: float, materials: tuple[Material, Material]) -> PlacedPair:
    """Return the position of the members at phi1 under a torque (N mm) on the pinion.

    phi1 is in rad, counted as the source counts it. The leading teeth determine the rotation of the gear. If these are
    neighbours of the pair at phi1, the pinion is rotated by whole pitches, so that they are the teeth on +x. Raises
    NoSolutionError if no teeth touch there.
    """
    # the model has all teeth at their nominal places
    pinion, gear = (replace(member, index=NO_INDEX_ANGLES) for member in pair.both)
    pair = replace(pair, pinion=pinion, gear=gear)
    leading = leading_pairs(pair, np.array([phi1]))
    if np.isnan(leading.phi2[0]):
        raise NoSolutionError(reason=f"no teeth touch at phi1 = {np.degrees(phi1):g} deg; tca shows where they do")
    number = int(leading.number[0])
    pair = as_pair_0(pair, number)
    path = contact_path(solver_pair(pair), leading.rotation - number * pair.pitch)
    return _under(pair, path, torque, materials)


def neighbours(
    at: PlacedPair, torque: float, materials: tuple[Material, Material]
) -> dict[tuple[int, int], PlacedPair]:
    """Return the tooth pairs beside the placed pair that have contact, each as if it had the whole torque.

    Keys are the places of the teeth (pinion, gear), counted from the teeth on +x.
    """
    pair, beside = at.pair, {}
    signs = (pair.pinion.mount.sign, pair.gear.mount.sign * int(np.sign(pair.ratio)))
    for number in (-1, 1):
        own = as_pair_0(pair, number)
        path = contact_path(solver_pair(own), at.path.rotation - pair.pitch * number)
        if path.touching[0]:
            pinion, gear = (-int(sign) * number for sign in signs)
            beside[pinion, gear] = _under(own, path, torque, materials)
    return beside


def _under(pair: GearPair, leading: ContactPath, torque: float, materials: tuple[Material, Material]) -> PlacedPair:
    """Return a tooth pair at the one position of its path, under the whole torque (N mm)."""
    mount = pair.pinion.mount
    hertz = hertz_path(pair, leading, 1e-3 * torque, materials)
    # the pinion pushes along its outward normal
    per_arm = float(normal_force(1.0, leading.point, leading.normal, mount.origin, mount.axis)[0])
    force, semi_major = abs(torque * per_arm), float(hertz.semi_major[0])
    approach = float(hertz.approach[0])
    if np.isnan(approach):
        # the approach of a line depends on the bodies' depth, that of an edge on its sharpness: use its order of
        # magnitude
        length = 2.0 * semi_major if semi_major > 0.0 else 1.0
        approach = force / (contact_modulus(*materials) * length)
    return PlacedPair(
        pair,
        leading,
        force=force,
        pressure=float(hertz.peak_pressure[0]),
        semi_major=semi_major,
        semi_minor=float(hertz.semi_minor[0]),
        approach=approach,
        arm=1.0 / per_arm,
        frame=mount.base.inverse,
    )


def focus_on(name: str, at: PlacedPair, cells: int = 1, *, turned: bool = False) -> Focus:
    """Return the loaded ellipse (or line, or point on an edge) in the coordinates of a member's working flank.

    With `turned` it is the ellipse's place on the pinion's flank after the load has rotated the pinion.
    """
    key = name, turned
    if key not in at.focuses:
        at.focuses[key] = _find_focus(name, at, turned)
    return replace(at.focuses[key], cells=cells)


def _find_focus(name: str, at: PlacedPair, turned: bool) -> Focus:
    """Return the focus of `focus_on` with one cell."""
    pair, member_index = at.pair, at.pair.index(name)
    member, side = pair.both[member_index], pair.flanks[member_index]
    tooth, fixed_to_own = member.tooth, member.mount.at(at.turns[member_index]).inverse
    params = (at.path.params1, at.path.params2)[member_index][0]
    centre = arc_centre(tooth, side, params)
    s, t = flank_place(tooth, side, params)
    if np.isnan(at.pressure):
        return Focus(s, t, 0.0, 0.0, 0.0, 0.0, 1)
    # differences stay inside the flank, whose grid ends at 0 and 1
    s_mid, t_mid = (float(np.clip(x, 2.0 * SLOPE_STEP, 1.0 - 2.0 * SLOPE_STEP)) for x in (s, t))
    nodes = SLOPE_STEP * np.array([-1.0, 1.0])
    points = layers(tooth, t_mid + nodes, centre).flank(side, s_mid + nodes).points
    # tangents of the flank along s and t, and the ellipse's axes in these coordinates
    along_s = (points[1, 0] + points[1, 1] - points[0, 0] - points[0, 1]) / (4.0 * SLOPE_STEP)
    along_t = (points[0, 1] + points[1, 1] - points[0, 0] - points[1, 0]) / (4.0 * SLOPE_STEP)
    axes = fixed_to_own.vector(np.stack((at.semi_major * major_axis(at.path), at.semi_minor * minor_axis(at.path))))
    in_plane = np.linalg.lstsq(np.stack((along_s, along_t), axis=-1), axes.T, rcond=None)[0]
    inverse = in_plane @ in_plane.T
    ellipse_form = np.linalg.inv(inverse)
    middle = layers(tooth, [t_mid], centre)
    right_point, left_point = (middle.flank(side, np.array([s_mid])).points[0, 0] for side in Side)
    slope, normal = float(-ellipse_form[0, 1] / ellipse_form[0, 0]), fixed_to_own.vector(at.path.normal[0])
    # a point that the load moves along the flank was elsewhere on the flank before
    if turned:
        turn = np.array([0.0, 0.0, at.turn])
        slide = fixed_to_own.vector(at.frame.inverse.vector(cross(turn, at.frame.point(at.path.point[0]))))
        back_s, back_t = np.linalg.lstsq(np.stack((along_s, along_t), axis=-1), -slide, rcond=None)[0]
        s, t = s + float(back_s), t + float(back_t)
    return Focus(
        s,
        t,
        slope=slope,
        half_s=1.0 / float(np.sqrt(ellipse_form[0, 0])),
        half_t=float(np.sqrt(inverse[1, 1])),
        half_depth=2.0 * at.semi_minor / abs(float((right_point - left_point) @ normal)),
        cells=1,
        bow=_bow(tooth, side, (s_mid, t_mid), slope, normal, centre),
    )


def _bow(tooth: Tooth, side: Side, place: tuple[float, float], slope: float, normal: Array, centre: float) -> float:
    """Return the second derivative (mm) in t of the height over the tangent plane at a place (s, t), along ds/dt =
    slope."""
    step = min(BOW_STEP, BOW_STEP / max(abs(slope), 1.0))
    s, t = (float(np.clip(x, 2.0 * BOW_STEP, 1.0 - 2.0 * BOW_STEP)) for x in place)
    low, middle, high = (
        layers(tooth, [t + k * step], centre).flank(side, np.array([s + k * step * slope])).points[0, 0]
        for k in (-1.0, 0.0, 1.0)
    )
    return abs(float((low - 2.0 * middle + high) @ normal)) / step**2


def stations_under_load(grid: HexGrid, at: PlacedPair) -> Array:
    """Return stations t (K,) of a thread's flank that match stations of the gear's `grid` under load.

    The stations lie over each other near the ellipse after the load has rotated the pinion. Conforming flanks are
    polygons along the ellipse, whose nodes must match. A worm slides six times as far along its wheel as both approach
    each other. With nodes of one flank over the middles of the other's edges, half of the ellipse did not touch in
    CalculiX.
    """
    pinion, gear = at.pair.both
    focus = focus_on(gear.name, at)
    t = grid.t[np.abs(grid.t - focus.t) < ELLIPSE_REACH * focus.half_t]
    s = np.clip(focus.s + focus.slope * (t - focus.t), 0.0, 1.0)
    points = np.diagonal(layers(gear.tooth, t, grid.centre).flank(at.pair.flanks[1], s).points, axis1=0, axis2=1).T
    in_model = Rigid.about_z(-at.turn).point(at.frame.point(gear.mount.at(at.turns[1]).point(points)))
    thread_points = pinion.mount.at(at.turns[0]).inverse.point(at.frame.inverse.point(in_model))
    screw = pinion.tooth.screw
    assert screw is not None
    angle = running_angle(pinion.tooth, thread_points) - arc_centre(pinion.tooth, at.pair.flanks[0], at.path.params1[0])
    stations = 0.5 + np.sign(screw) * angle / (2.0 * HALF_ARC)
    return np.sort(stations[(stations > 0.0) & (stations < 1.0)])


def arc_centre(tooth: Tooth, side: Side, params: Array) -> float:
    """Return the running polar angle (rad) of a flank's point with surface parameters (2,): the middle of the arc of a
    thread; 0 for other teeth."""
    return 0.0 if tooth.screw is None else float(running_angle(tooth, tooth.side(side).flank.jet(*params).r))


def flank_place(tooth: Tooth, side: Side, params: Array) -> tuple[float, float]:
    """Return coordinates (s, t) on the trimmed flank, s from form point to tip, of a point with surface parameters
    (2,). A thread's point is in the middle of the arc."""
    flank = tooth.side(side).flank
    toe, heel = tooth.blank.extent
    t = float((tooth.blank.axial.value(flank.jet(*params).r) - toe) / (heel - toe)) if tooth.screw is None else 0.5
    ends = tooth.flank_grid(side, np.array([0.0, 1.0]), np.array([np.clip(t, 0.0, 1.0)])).p
    assert ends is not None
    return float((params[0] - ends[0, 0]) / (ends[1, 0] - ends[0, 0])), t


def major_axis(path: ContactPath) -> Array:
    """Return the unit vector along the major axis, or from the first to the last point of a line of contact; fixed
    frame."""
    line = path.lines[0]
    axis: Array = path.major[0] if line is None else (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])
    return axis


def minor_axis(path: ContactPath) -> Array:
    return path.minor[0] if path.lines[0] is None else np.cross(path.normal[0], major_axis(path))
