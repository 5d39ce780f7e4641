"""Construction of face gear drives [LF04 18]: the pinion by a rack, the face gear by an involute shaper.

The fixed frame is the shaper's: the origin is the apex, where the axes intersect. z is along the axes of shaper and
pinion away from the apex, x towards the face gear. The pinion's axis is parallel to the shaper's, (Ns - N1) m / 2
closer to the gear, so that the pitch cylinders touch [LF04 18.4.2]. The pitch line is x = r_ps. On it is the pitch
point P, where the instantaneous axes intersect. phi1 turns the pinion clockwise about +z. At phi1 = 0 the working
flanks touch in P, and phi2 = 0.

With an `offset` E the axes cross: the gear's axis is at y = -E, and its apex is the foot of the common perpendicular.
Shaper and pinion remain in internal mesh, so that all three surfaces are in mesh at once. The path of contact still
passes through the pitch line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.chain import Chain, Step
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.common.axes import gear_base, shifts
from gearmesh.systems.common.backlash import thin
from gearmesh.systems.common.bodies.body import bore_radius
from gearmesh.systems.common.bodies.features import UnderTeeth, body_features
from gearmesh.systems.common.bodies.tip_surface import with_tip_surface
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.micro_geometry import with_modifications
from gearmesh.systems.common.racks.rack_member import Roll, member
from gearmesh.systems.common.racks.rack_tooth import Heights, round_tips
from gearmesh.systems.common.tooth_edges import with_end_chamfers, with_tip_edge
from gearmesh.systems.face_gear.design import CLEARANCE_MODULES
from gearmesh.systems.face_gear.grinding import Grinding
from gearmesh.systems.face_gear.limits import ShapedGear
from gearmesh.systems.face_gear.pinion_root import clear_root, unlike_standard
from gearmesh.systems.system import Displacements
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import Bottom, ToothSide
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import RackLine, RackSurface
from gearmesh.tools.shaper import Shaper
from gearmesh.tools.shaper_worm import ShaperWorm

if TYPE_CHECKING:
    from gearmesh.systems.face_gear.design import FaceGearDesign

#: distance of default radii from their limits, over the width between the limits
RADIUS_MARGIN_SHARE = 0.02
#: largest offset times cosine of the shaft angle (modules) at which the root is a cone
MAX_SKEW_MODULES = 1e-9
#: default rounding of the shaper's tip, in modules
TIP_RADIUS_MODULES = 0.2
#: largest default rounding of the shaper's tip, over the largest that fits
MAX_TIP_RADIUS_SHARE = 0.8

#: meaning of the parameter along the teeth of the shaper and of the pinion
FROM_APEX = "distance from the apex along the axis of the shaper"


def build(design: FaceGearDesign) -> GearTrain:
    """Return the pair of a face gear design (in mm).

    Raises DesignError naming key, value and limit: radii beyond undercut or pointing, shaper or teeth that cannot
    exist.
    """
    shaped = shaped_gear(design)
    face_middle = middle(design, shaped)
    gear = _gear(design, cut_gear(design, shaped), face_middle)
    flank = Side(design.contact.flank)
    pinion_mount, gear_mount = _mounts(design, shaped, face_middle)
    pair = GearPair(
        pinion=replace(_pinion(design, face_middle), mount=pinion_mount),
        gear=replace(gear, mount=gear_mount),
        flanks=(flank, flank),
        drive=flank.sign,
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    return GearTrain(design.kind, (pair,), _warnings(design, shaped))


def shaped_gear(design: FaceGearDesign) -> ShapedGear:
    """Return shaper and face gear in the design's unit of length. Raises DesignError for a shaper that cannot exist."""
    m, shift, radius = design.given_module, design.pinion.profile_shift, design.shaper.tip_radius
    sharp = Shaper(
        teeth=design.shaper_teeth,
        module=m,
        pressure_angle=float(np.radians(design.pressure_angle)),
        addendum=(design.shaper.addendum + shift) * m,
        profile_shift=shift,
    )
    rounding = (
        min(TIP_RADIUS_MODULES * m, MAX_TIP_RADIUS_SHARE * sharp.largest_tip_radius) if np.isnan(radius) else radius * m
    )
    angle = float(np.radians(design.shaft_angle))
    return _complete_flank(
        "offset", ShapedGear(replace(sharp, tip_radius=rounding), design.gear.teeth, angle, design.offset)
    )


def _complete_flank(key: str, shaped: ShapedGear) -> ShapedGear:
    """Return a shaped gear. Raises DesignError, naming `key`, for an offset at which it has no complete flanks."""
    if not shaped.offset**2 < (farthest := shaped.largest_offset) ** 2:
        raise DesignError(
            key,
            shaped.offset,
            unit="mm",
            reason="the shaper generates no complete flank there",
            allowed=Allowed.less_than(farthest, "mm", note=" either way"),
        )
    return shaped


def cut_gear(design: FaceGearDesign, shaped: ShapedGear) -> ShapedGear:
    """Gear that the shaper of a complete design generates with the machine's settings, without axial displacement.

    Raises DesignError for settings that make no flank.
    """
    machine, nominal = design.gear.machine, shaped.shaper
    shaper = replace(nominal, pressure_angle=float(np.radians(machine.pressure_angle)), thicker=machine.thickness)
    cut = replace(shaped, shaper=shaper, shaft_angle=float(np.radians(machine.shaft_angle)), offset=machine.offset)
    return _complete_flank("gear.machine.offset", cut)


def derived_values(design: FaceGearDesign) -> dict[str, float]:
    """Return values of keys that the file leaves out and that need the geometry, by dotted key, in the design's units.

    Raises DesignError for a shaper that cannot exist, and if no radius has teeth.
    """
    spec, m, shaped = design.gear, design.given_module, shaped_gear(design)
    inner, outer = spec.inner_radius, spec.outer_radius
    if np.isnan([inner, outer]).any():
        low, high = inner_limit(design, shaped), shaped.pointing_radius(spec.addendum * m, spec.top_land * m)
        inner = low + RADIUS_MARGIN_SHARE * (high - low) if np.isnan(inner) else inner
        outer = high - RADIUS_MARGIN_SHARE * (high - low) if np.isnan(outer) else outer
    root = clear_root(design, shaped, (float(inner), float(outer)))
    return {
        "pinion.dedendum": root.dedendum,
        "pinion.tool_tip_radius": root.tool_tip_radius,
        "shaper.tip_radius": shaped.shaper.tip_radius / m,
        "gear.inner_radius": inner,
        "gear.outer_radius": outer,
        # radii in the wrong order are refused later
        "pinion.face_width": abs(float(np.subtract(*covered_range(shaped, (float(inner), float(outer)))))) + m,
    }


def inner_limit(design: FaceGearDesign, shaped: ShapedGear) -> float:
    """Radius (in the design's units) from which teeth are whole: not undercut, and within the shaper's involute."""
    return max(shaped.undercut_radius(), shaped.involute_radius(design.gear.addendum * design.given_module))


def middle(design: FaceGearDesign, shaped: ShapedGear) -> float:
    """Return the distance (mm) of the middle of the face from the apex, along the pinion's axis."""
    return 0.5 * float(sum(covered_range(shaped, (design.gear.inner_radius, design.gear.outer_radius))))


def covered_range(shaped: ShapedGear, radii: tuple[float, float]) -> tuple[float, float]:
    """Return the range of z (mm) in the shaper's frame in which the pitch line is between two radii (mm).

    On crossed axes the range includes lines a module beside the pitch line.
    """
    aside = shaped.shaper.module * shaped.offset / np.array(radii)
    inner, outer = shaped.place_of(np.array(radii)) + np.abs(aside) * [-1.0, 1.0]
    return float(inner), float(outer)


def shaping(shaped: ShapedGear, place: float, depth: float = 0.0) -> Chain:
    """Return the motion of the shaper over the face gear by psi_s (rad) [LF04 18.5.5-6].

    The tool's origin is on the pitch line at z = `place` mm. Its frame is that of `tools.shaper`, turned by 180 deg
    about the shaper's axis. `depth`: displacement of the shaper along the gear's axis, mm.
    """
    to_tool = (-shaped.shaper.pitch_radius, 0.0, place)
    return Chain(
        (
            Step(rate=shaped.ratio, angle0=-shaped.lean(place), offset=(0.0, 0.0, depth)),
            Step(rate=1.0, angle0=np.pi, base=gear_base(shaped.shaft_angle, -shaped.offset).inverse),
            Step(offset=to_tool),
        ),
        harmonic=True,
    )


def generate(shaped: ShapedGear, place: float, profile: Profile, side: int, depth: float = 0.0) -> Envelope:
    """Return the surface that a profile of the shaper generates; `side`: +1 right, -1 left side of the gear's tooth."""
    # branch 1: of both tangents from the instantaneous axis to the base circle, the tangent on the side of the flank
    return Envelope(RackSurface(profile, 0.0, 0.0, side), shaping(shaped, place, depth), branch=1)


# ---------------------------------------------------------------- face gear


def _gear(design: FaceGearDesign, shaped: ShapedGear, place: float) -> Member:
    """Return the face gear; `place`: z of the middle of its face, mm."""
    _check_face(design, shaped)
    blank = _blank(design, shaped)
    sides = [_side(design, shaped, place, side) for side in (1, -1)]
    tooth = Tooth(
        shaped.teeth, sides[0], sides[1], blank, bottom=_bottom(shaped, place, design.gear.machine.axial_position)
    )
    if design.gear.machine.tool == "worm":
        tooth = grinding_of(design, shaped, place).grind(tooth)
    try:
        tooth.prove()
    except TrimError as failure:
        raise VagueError(
            "gear",
            reason=f"{failure} at the radius {tooth.stations(failure.station):.6g} mm",
            allowed="a smaller addendum or a narrower face",
        ) from failure
    tooth = with_tip_edge("gear", tooth, design.gear)

    parameters = NamedParameters(
        (
            SourceParameter("theta_s", "deg", "roll angle of the involute of the shaper, from its base circle"),
            SourceParameter("u_s", "mm", FROM_APEX),
        ),
        lambda p, v: (np.degrees(p), v + place),
    )
    inner, outer = blank.extent
    under = UnderTeeth("gear", tooth, blank.body, inner, outer, design.given_module)
    return with_end_chamfers(Member("gear", tooth, parameters, body_features(design.gear, under)), design.gear)


def grinding_of(design: FaceGearDesign, shaped: ShapedGear, place: float) -> Grinding:
    """Return the grinding of a complete design by a worm in the shaper's place, at the machine's settings.

    `place`: z of the middle of the face, mm. Raises DesignError for a worm that cannot exist.
    """
    machine, spec = design.gear.machine, design.worm
    worm = ShaperWorm(shaped.shaper, spec.pitch_radius, spec.threads, 1 if spec.right_hand else -1)
    swivelled = float(np.radians(machine.worm_angle)) - worm.crossing_angle
    return Grinding(shaped, worm, place, machine.axial_position, swivelled)


def _side(design: FaceGearDesign, shaped: ShapedGear, place: float, side: int) -> ToothSide:
    """Return one side of the shaped tooth: +1 right, -1 left."""
    shaper = shaped.shaper
    side_gear = shaped if side > 0 else shaped.mirror_image
    tip = side_gear.theta_at_height(_tip_height(design, shaped), np.array(place))
    depth = design.gear.machine.axial_position
    flank, fillet = (generate(shaped, place, profile, side, depth) for profile in (shaper.involute, shaper.rounding))
    return ToothSide(
        flank=flank,
        fillet=fillet,
        form_point=shaper.form_point,
        root=shaper.root,
        tip=float(tip),
        tool=shaper.description,
        generation=(flank, fillet),
    )


def _tip_height(design: FaceGearDesign, shaped: ShapedGear) -> float:
    """Return the height (mm) of the gear's tips over the pitch cone of the gear that the tool generates."""
    return design.gear.addendum * design.given_module + _deeper(design, shaped)


def _deeper(design: FaceGearDesign, shaped: ShapedGear) -> float:
    """Return the additional depth of cut (mm), across the shaper's axis, by its displacement along the gear's axis."""
    return design.gear.machine.axial_position * float(np.sin(shaped.shaft_angle))


def _bottom(shaped: ShapedGear, place: float, depth: float) -> Bottom | None:
    """Return the root that the shaper's top cylinder generates, or None where it sweeps a cone.

    It sweeps no cone on crossed axes that are not at 90 deg.
    """
    if abs(shaped.offset * np.cos(shaped.shaft_angle)) < MAX_SKEW_MODULES * shaped.shaper.module:
        return None
    shaper = shaped.shaper
    # the root is between this flank's fillet and the fillet of the neighbouring tooth
    before = np.pi + 2.0 * np.pi / shaper.teeth - shaper.root
    return Bottom(generate(shaped, place, shaper.top, 1, depth), (before, shaper.root))


def _check_face(design: FaceGearDesign, shaped: ShapedGear) -> None:
    """Raise DesignError for radii beyond undercut and pointing, and for tips that the shaper's involute does not reach."""
    spec, m, height = design.gear, design.given_module, _tip_height(design, shaped)
    inner, outer = shaped.undercut_radius(), shaped.pointing_radius(height, spec.top_land * m)
    if spec.inner_radius < inner:
        raise DesignError(
            "gear.inner_radius",
            spec.inner_radius,
            unit="mm",
            reason="undercut by the shaper",
            allowed=Allowed.at_least(inner, "mm"),
        )
    if spec.outer_radius > outer:
        why = f"the top land is narrower than {spec.top_land * m:.4g} mm" if spec.top_land else "the teeth are pointed"
        raise DesignError(
            "gear.outer_radius", spec.outer_radius, unit="mm", reason=why, allowed=Allowed.at_most(outer, "mm")
        )
    for path in (side.path_radius for side in shaped.sides):
        if not spec.inner_radius < path < spec.outer_radius:
            raise DesignError(
                "gear.inner_radius",
                spec.inner_radius,
                unit="mm",
                reason=f"the path of contact, at the radius {path:.7g} mm, is not between it and gear.outer_radius, "
                f"{spec.outer_radius:.7g} mm",
                allowed="radii on either side of the path",
            )
    # the involute begins lowest where the pressure angle is least: on the pitch line at the inner cylinder
    highest = (shaped.highest(spec.inner_radius) - _deeper(design, shaped)) / m
    if spec.addendum > highest:
        raise DesignError(
            "gear.addendum",
            spec.addendum,
            reason="higher than the shaper's involute reaches at the inner radius",
            allowed=Allowed.at_most(highest),
        )


def _blank(design: FaceGearDesign, shaped: ShapedGear) -> Blank:
    """Return the blank: cylinders at toe and heel, cones at tip and root.

    The cones are swept by lines parallel to the axes of pinion and shaper.
    """
    spec, nominal = design.gear, shaped_gear(design)
    # the normal of each cone points towards the shaper's axis; offsets are distances from the apex along the normal
    towards = nominal.shaft_angle + 0.5 * np.pi
    tip = ConeLevel(towards, nominal.cone_offset(spec.addendum * design.given_module))
    cut = ConeLevel(shaped.shaft_angle + 0.5 * np.pi)
    deep = cut.normal[1] * spec.machine.axial_position
    root = ConeLevel(cut.angle, shaped.cone_offset(-shaped.shaper.addendum) + deep)
    inner, outer = spec.inner_radius, spec.outer_radius
    across, up = root.normal
    root_z = [(root.offset - across * rho) / up for rho in (inner, outer)]
    back = max(root_z) + spec.rim
    if spec.web >= back - root_z[0]:
        raise DesignError(
            "gear.web",
            spec.web,
            unit="mm",
            reason="reaches the root at the inner cylinder",
            allowed=Allowed.less_than(back - root_z[0], "mm"),
        )
    bore = bore_radius("gear", spec.stated_bore, inner, "the inner diameter", key=spec.bore_key)
    front = back - spec.web
    body = Body.disk(bore, (inner, front), (outer, back))
    return Blank(ConeLevel(0.5 * np.pi), (inner, outer), tip, root, body)


# ---------------------------------------------------------------- pinion


def _pinion(design: FaceGearDesign, place: float) -> Member:
    """Return the spur pinion with the shaper's base pitch; each flank is set back by half of the normal backlash."""
    spec, m, alpha = design.pinion, design.given_module, float(np.radians(design.pressure_angle))
    shift = spec.profile_shift * m
    half_thickness = thin(0.25 * np.pi * m, design.backlash, 0.5, alpha)
    flank = RackLine(alpha, m, half_thickness, shift)
    heights = Heights(shift + spec.addendum * m, shift - spec.dedendum * m)
    roll = Roll(0.5 * spec.teeth * m, 0.0, 0.0)
    base_radius = roll.radius * np.cos(alpha)

    def values(p: Array, v: Array) -> tuple[Array, Array]:
        height = flank.section(p)[0][..., 0]
        theta = np.tan(alpha) + height / (base_radius * np.sin(alpha))
        return np.degrees(theta), v + place

    declared = (
        SourceParameter("theta_1", "deg", "roll angle of the involute of the pinion, from its base circle"),
        SourceParameter("u_1", "mm", FROM_APEX),
    )

    racks = round_tips("pinion", spec, m, (flank, flank), heights)
    spur = member("pinion", spec, racks, roll, NamedParameters(declared, values), "addendum")
    return with_end_chamfers(with_modifications(with_tip_surface(spur, spec), spec, reference_radius=roll.radius), spec)


# ---------------------------------------------------------------- assembly


def _mounts(design: FaceGearDesign, shaped: ShapedGear, place: float) -> tuple[Mount, Mount]:
    """Return the mounts with assembly errors.

    dE moves the pinion along y, dq the gear along its axis, d_gamma turns the gear about y.
    """
    errors, spec, m = design.assembly, design.pinion, design.given_module
    alpha = np.radians(design.pressure_angle)
    axis_distance = 0.5 * (shaped.shaper.teeth - spec.teeth) * m
    pinion = Rigid(np.eye(3), np.array([axis_distance, errors.dE, place]))
    along = Rigid(np.eye(3), np.array([0.0, 0.0, errors.dq]))
    gear = gear_base(shaped.shaft_angle + float(np.radians(errors.d_gamma)), -shaped.offset) @ along
    # half a tooth angle on the pitch cylinder, less half of the backlash
    half_tooth = (0.5 * np.pi + 2.0 * spec.profile_shift * np.tan(alpha)) / spec.teeth
    half_tooth -= design.backlash / (spec.teeth * m * np.cos(alpha))
    half_tooth_gear = (0.5 * np.pi - 2.0 * spec.profile_shift * np.tan(alpha)) / shaped.teeth
    side = Side(design.contact.flank).sign
    return Mount(pinion, sign=-1.0, zero=side * half_tooth), Mount(
        gear, sign=1.0, zero=-shaped.lean(place) - side * half_tooth_gear
    )


def _displaced_bases(design: FaceGearDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Return the bases of pinion and gear with assembly errors (M,), mm and deg."""
    pinion, gear = (mount.base for mount in train.pairs[0].mounts)
    # the shaft angle opens about the common perpendicular, which is y
    opened = Rigid(rotation_about("y", np.radians(errors["d_gamma"])), np.zeros(3))
    along = Rigid(np.eye(3), shifts(0.0, 0.0, errors["dq"]))
    moved = pinion.translation + shifts(0.0, errors["dE"], 0.0)
    return Rigid(np.broadcast_to(pinion.rotation, (len(moved), 3, 3)), moved), opened @ gear @ along


#: keys of the assembly errors, and the bases that they displace
ASSEMBLY_DISPLACEMENTS: Displacements[FaceGearDesign] = Displacements(("dE", "dq", "d_gamma"), _displaced_bases)


def _warnings(design: FaceGearDesign, shaped: ShapedGear) -> tuple[str, ...]:
    """Return the warnings on unusual defaults, line contact and a narrow pinion."""
    spec, longer = (
        design.pinion,
        {"shaper.addendum": (design.pinion.addendum + CLEARANCE_MODULES, "its teeth would be pointed")},
    )
    warnings = [*unlike_standard(design), *unusual_defaults(design, longer)]
    if shaped.shaper.teeth == spec.teeth:
        warnings.append("shaper.teeth = pinion.teeth: line contact; any assembly error turns it into edge contact")
    toe, heel = covered_range(shaped, (design.gear.inner_radius, design.gear.outer_radius))
    if spec.face_width < heel - toe:
        warnings.append(
            f"pinion.face_width = {spec.face_width:g} mm: narrower than the face width of the gear, {heel - toe:.6g} mm"
        )
    return tuple(warnings)
