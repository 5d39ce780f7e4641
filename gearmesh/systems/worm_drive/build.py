"""Worm drives: a worm between planes, a wheel as its hob generates it, and how they are mounted.

Fixed frame: the worm's axis is z, the common perpendicular x, the wheel's axis at x = a. phi1 turns the worm clockwise about +z; at
phi1 = 0 the working flank of a thread passes the pitch point, where the reference cylinder meets x, and so does the wheel's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.meridian import Meridian
from gearmesh.kernel.surface.sheared import Withdrawn
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.common.axes import shifts
from gearmesh.systems.common.bodies.body import bore_radius, disc_body
from gearmesh.systems.common.bodies.features import UnderTeeth, body_features
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.standards.iso10828 import ThreadForm
from gearmesh.systems.common.tooth_edges import with_end_chamfers, with_tip_edge
from gearmesh.systems.system import Displacements
from gearmesh.systems.worm_drive.cutting.hob_thread import hob_thread_of
from gearmesh.systems.worm_drive.design import ADDENDUM, DEDENDUM, WormDriveDesign
from gearmesh.systems.worm_drive.helical_wheel import helical_wheel
from gearmesh.systems.worm_drive.thread import LAND, DiskGrinding, Rounding, RunOut, WormThread
from gearmesh.systems.worm_drive.wheel import Throat, WormHob, crossed_axes, prove_wheel
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.description import Dimension, ToolDescription

if TYPE_CHECKING:
    from gearmesh.design.core import MemberBody
    from gearmesh.systems.common.pinned import Values

#: what the tools that make flanks of each form are called
TOOLS = {
    ThreadForm.ZA: "turning tool",
    ThreadForm.ZN: "turning tool",
    ThreadForm.ZI: "plane-sided grinding disk",
    ThreadForm.ZK: "grinding disk",
    ThreadForm.ZC: "grinding disk",
}

#: what helps against a worm and against a wheel that cannot be trimmed: the key that is named, what is allowed, and the keys of
#: which more (1) or less (-1) may mend it
WORM_REMEDIES = dict.fromkeys(
    ("flank", "undercut", "root"),
    ("dedendum", "less", {"worm.dedendum": -1, "worm.root_rounding": -1, "worm.thickness": 0}),
)
WHEEL_REMEDIES = {
    "flank": ("face_width", "less", {"wheel.face_width": -1, "wheel.profile_shift": 0, "center_distance": 0}),
    "undercut": (
        "profile_shift",
        "more, or a narrower face",
        {"wheel.profile_shift": 1, "center_distance": 1, "wheel.face_width": -1},
    ),
    "tip": (
        "addendum",
        "less",
        {"wheel.addendum": -1, "wheel.face_width": -1, "hob.reference_diameter": -1, "worm.threads": -1},
    ),
}

#: against flanks that do not reach the tip where the addendum is a default, of which no lower one was enough
NARROWER = (
    "face_width",
    "less, or fewer threads of the worm",
    {"wheel.face_width": -1, "hob.reference_diameter": -1, "worm.threads": -1},
)
#: parts of the usual addendum of a wheel that are tried, and why a lower one is taken
ADDENDUM_SHARES = np.linspace(1.0, 0.5, 11)
LOWER = "teeth would be pointed, flanks would not reach the tip, or the worm's root would be too near"
#: why a lower dedendum of the worm is taken
SHALLOWER = "the flanks of these steep threads end above the rounding of the root"
#: height of the flanks that run-outs leave, in axial modules, or as a multiple of a broken tip edge, and the steepest angle (rad)
#: at which their root rises
LEFT, EDGE, STEEPEST = 0.05, 1.5, math.radians(70.0)
#: part of a diameter within which hob and worm are of one size
EQUAL = 1e-9


def build(design: WormDriveDesign) -> GearTrain:
    """The pair of a worm drive design (in mm). Raises DesignError naming key, value and limit."""
    refuse_tools(design)
    worm = worm_member(design)
    if design.wheel.form == "helical":
        _refuse_unused(design)
        wheel = helical_wheel(design)
    else:
        wheel = _wheel(design)
    first, second = _mounts(design)
    flank = Side(design.contact.flank)
    # a left-hand drive is the mirror image in the plane across the worm: the wheel's sides change places
    beside = flank if design.worm.right_hand else flank.other
    pair = GearPair(
        pinion=replace(worm, mount=first),
        gear=replace(wheel, mount=second),
        flanks=(flank, beside),
        drive=flank.sign,
        ratio=design.worm.threads / design.wheel.teeth,
        delta=design.contact.delta,
    )
    standards = {
        "worm.dedendum": (DEDENDUM, SHALLOWER),
        "wheel.face_width": _usual_width(design),
        "wheel.addendum": (ADDENDUM, LOWER),
    }
    return GearTrain(design.kind, (pair,), unusual_defaults(design, standards))


def _usual_width(design: WormDriveDesign) -> tuple[float, str]:
    """The face width of DIN 3975 and why the default may be another one."""
    return (
        design.usual_face_width,
        "the flanks of these steep threads end sooner, or teeth are pointed, towards an end of the face",
    )


def usual_addendum(design: WormDriveDesign) -> float:
    """The coefficient of the wheel's addendum that a design leaves open, as far as the teeth have room: with the usual clearance
    of a worm's root that is shallower than usual by itself."""
    if design.sets("worm.dedendum"):
        return ADDENDUM
    return round(ADDENDUM - (DEDENDUM - design.worm.dedendum), 6)


def refuse_tools(design: WormDriveDesign) -> None:
    """Refuse a hob smaller than the worm, a disk that does not reach over the thread, and a throat inside the worm's root."""
    spec, m, d1 = design.worm, design.axial_module, design.reference_diameter
    if design.hob.reference_diameter < d1 * (1.0 - EQUAL):
        raise DesignError(
            "hob.reference_diameter",
            design.hob.reference_diameter,
            unit="mm",
            reason="smaller than the worm's, whose threads would cut into the wheel at both end faces",
            allowed=f"at least {at_least(d1)} mm",
        )
    _refuse_hob_threads(design)
    _refuse_backlash(design)
    depth = (spec.addendum + spec.dedendum) * m
    if spec.form in (ThreadForm.ZK, ThreadForm.ZC) and spec.disk_diameter <= 2.0 * depth:
        raise DesignError(
            "worm.disk_diameter",
            spec.disk_diameter,
            unit="mm",
            reason="the disk does not reach from the thread's tip to its root",
            allowed=f"more than {at_least(2.0 * depth)} mm",
        )
    wheel = design.wheel
    if wheel.tip_form != "chamfered" and wheel.throat_angle != type(wheel).model_fields["throat_angle"].default:
        reason = f"nothing is done with it where wheel.tip_form is {wheel.tip_form}"
        raise DesignError("wheel.throat_angle", wheel.throat_angle, unit="deg", reason=reason, allowed="with chamfered")
    usual = design.center_distance - 0.5 * design.wheel_tip_diameter
    if wheel.tip_form == "cylindrical" and not math.isclose(wheel.throat_radius, usual, rel_tol=EQUAL):
        reason = "nothing is done with it where wheel.tip_form is cylindrical"
        raise DesignError("wheel.throat_radius", wheel.throat_radius, unit="mm", reason=reason, allowed="with a throat")
    root = 0.5 * d1 - spec.dedendum * m
    if design.wheel.throated and design.wheel.throat_radius <= root:
        raise DesignError(
            "wheel.throat_radius",
            design.wheel.throat_radius,
            unit="mm",
            reason="the throat is inside the worm's root",
            allowed=f"more than {at_least(root)} mm",
        )


def _refuse_hob_threads(design: WormDriveDesign) -> None:
    """Refuse a hob of more threads than its cylinder has room for, or without flanks where they are to be as the worm's are."""
    worm, hob, height = nominal_thread(design), design.hob, design.hob.pitch_height * design.axial_module
    radius, threads = 0.5 * hob.reference_diameter, hob.threads or worm.threads
    module = worm.module * math.cos(worm.lead_angle_at(worm.radius + height))
    most = math.ceil(2.0 * (radius + height) / module) - 1
    if threads > most:
        raise VagueError(
            "hob.threads",
            threads,
            reason=f"a hob of the reference diameter {hob.reference_diameter:.6g} mm has no lead angle with more than {most}",
        )
    made = hob_thread(design)
    if not math.isfinite(made.half_thickness(radius) + made.half_thickness(radius + height)):
        why = "worm or hob have no flanks at this height"
        raise DesignError("hob.pitch_height", hob.pitch_height, reason=why, allowed="nearer to 0")


def _refuse_backlash(design: WormDriveDesign) -> None:
    """Refuse a backlash for which nothing of the worm's threads would be left, or of the wheel's teeth."""
    worm, hob = nominal_thread(design), hob_thread(design)
    parts = (
        ("thread of the worm", design.backlash_share, worm, worm.thickness),
        ("tooth of the wheel", 1.0 - design.backlash_share, hob, hob.axial_pitch - hob.thickness),
    )
    for what, share, thread, thickness in parts:
        if share * design.backlash >= thickness * math.cos(thread.lead_angle) * math.cos(thread.normal_angle):
            raise VagueError("backlash", design.backlash, unit="mm", reason=f"leaves no {what}")


def _refuse_unused(design: WormDriveDesign) -> None:
    """Refuse what a helical wheel does not have."""
    hob = ("reference_diameter", "threads", "pitch_height", "center_distance", "swivel_angle", "feed")
    for name, keys in (("wheel", ("tip_form", "throat_radius")), ("hob", hob)):
        table = getattr(design, name)
        for key in keys:
            value = getattr(table, key)
            # as a design has them in which all is stated
            usual = {
                "tip_form": "cylindrical",
                "feed": "tangential",
                "center_distance": design.center_distance,
                "swivel_angle": 0.0,
                "pitch_height": 0.0,
            }
            stated = (None, usual.get(key, design.reference_diameter))
            if key == "throat_radius" and design.wheel.tip_form == "cylindrical":
                stated = (None, value)
            if key in table.model_fields_set and value not in stated:
                raise DesignError(f"{name}.{key}", value, reason="cannot be given together with wheel.form = helical")


def worm_thread(design: WormDriveDesign, side: int = 0) -> WormThread:
    """The worm's thread, thinner by its part of the backlash; of its right (+1) or left (-1) side as of `nominal_thread`."""
    nominal = nominal_thread(design, side)
    normal = 0.5 * design.backlash_share * design.backlash
    return replace(nominal, thinner=normal / (math.cos(nominal.lead_angle) * math.cos(nominal.normal_angle)))


def nominal_thread(design: WormDriveDesign, side: int = 0) -> WormThread:
    """The worm's thread without backlash; of its right (+1) or left (-1) side, which have leads of their own where the worm has two
    (0: that of their mean)."""
    spec, m = design.worm, design.axial_module
    form = ThreadForm(spec.form)
    return WormThread(
        form=form,
        threads=spec.threads,
        hand=1 if spec.right_hand else -1,
        module=m * (1.0 + side * spec.dual_lead),
        radius=0.5 * design.reference_diameter,
        angle=math.radians(design.pressure_angle),
        thickness=spec.thickness * m,
        grinding=DiskGrinding(0.5 * spec.disk_diameter, spec.profile_radius, spec.dedendum * m)
        if form in (ThreadForm.ZK, ThreadForm.ZC)
        else None,
        across_thread=spec.section == "thread",
    )


def wheel_hob(design: WormDriveDesign, side: int = 0) -> WormHob:
    """The hob: of the worm's normal module, normal profile and normal thickness on its own reference cylinder; the thread that of
    the right (+1) or left (-1) side of the worm's (0: of their mean), set up alike for both."""
    mean, spec, m = nominal_thread(design), design.hob, design.axial_module
    return WormHob(
        thread=replace(hob := hob_thread(design, side), thinner=-wheel_thinner(design, hob)),
        tip_radius=0.5 * spec.reference_diameter + spec.addendum * m,
        rounding_radius=spec.tip_radius * m,
        distance=spec.center_distance,
        tilt=mean.hand * math.radians(design.shaft_angle - 90.0 + spec.swivel_angle),
        teeth=design.wheel.teeth,
    )


def hob_apart(design: WormDriveDesign) -> tuple[float, float]:
    """By how much the hob is set up otherwise than usual: centre distance, mm, and swivel angle, deg."""
    distance, swivel = design.usual_cutting(design.center_distance, design.hob.pitch_height)
    return design.hob.center_distance - distance, design.hob.swivel_angle - swivel


def wheel_thinner(design: WormDriveDesign, thread: WormThread) -> float:
    """By how much (mm, along its axis) a flank of the hob's thread is set forward, for the wheel's part of the backlash."""
    normal = 0.5 * (1.0 - design.backlash_share) * design.backlash
    return normal / (math.cos(thread.lead_angle) * math.cos(thread.normal_angle))


def hob_thread(design: WormDriveDesign, side: int = 0) -> WormThread:
    """The hob's thread; of its right (+1) or left (-1) side, or (0) of their mean."""
    worm, spec = nominal_thread(design, side), design.hob
    height = spec.pitch_height * design.axial_module
    return hob_thread_of(worm, spec.threads or worm.threads, 0.5 * spec.reference_diameter, height)


# ---------------------------------------------------------------- worm


def worm_member(design: WormDriveDesign) -> Member:
    """The worm of a design in mm, whose wheel may be open. Raises DesignError."""
    spec, m, radius = design.worm, design.axial_module, 0.5 * design.reference_diameter
    tip, root = radius + spec.addendum * m, radius - spec.dedendum * m
    hole = bore_radius("worm", spec.stated_bore, root, "the root diameter")
    roundings = {side: root_rounding(design, side) for side in (1, -1)}
    run_out = _run_out(design, [worm_thread(design, side).form_radius(own) for side, own in roundings.items()])
    half = 0.5 * spec.length + spec.run_out
    level = ConeLevel.of(root) if run_out is None else Meridian(run_out)
    blank = Blank(PlaneLevel(0.0), (-half, half), ConeLevel.of(tip), level, Body.tube(hole, -half, half))

    def side(side: int) -> ToothSide:
        thread, rounding = worm_thread(design, side), roundings[side]
        flank, fillet = thread.flank(side), thread.rounding_surface(rounding, side)
        return ToothSide(
            flank if run_out is None else Withdrawn(flank, run_out.rise),
            fillet if run_out is None else Withdrawn(fillet, run_out.rise),
            form_point=rounding.form_point,
            root=LAND,
            tip=thread.at_radius(tip),
            face_bends=() if run_out is None else (-run_out.half, run_out.half),
            tool=ToolDescription(TOOLS[thread.form], dimensions=_tool_dimensions(thread)),
        )

    tooth = _prove("worm", Tooth(spec.threads, side(1), side(-1), blank), spec)
    tooth = with_tip_edge("worm", tooth, spec)
    under = UnderTeeth("worm", tooth, blank.body, root, root, m)
    return with_end_chamfers(Member("worm", tooth, _thread_parameters, body_features(spec, under)), spec)


def root_rounding(design: WormDriveDesign, side: int) -> Rounding:
    """The rounding of the root beside the right (+1) or left (-1) flank of a thread."""
    spec, m = design.worm, design.axial_module
    root = 0.5 * design.reference_diameter - spec.dedendum * m
    try:
        return worm_thread(design, side).root_rounding(root, spec.root_rounding * m)
    except DesignError as failure:
        why = "the flank does not reach the rounding of the root"
        raise VagueError("worm.root_rounding", spec.root_rounding, reason=why) from failure


def _run_out(design: WormDriveDesign, form_radii: list[float]) -> RunOut | None:
    """The run-outs of the threads, None where they are cut square: until what is left of the flanks is no higher than `LEFT`, or a
    broken tip edge. Raises DesignError for one that is too short."""
    spec, m, radius = design.worm, design.axial_module, 0.5 * design.reference_diameter
    if not spec.run_out:
        return None
    flank = radius + spec.addendum * m - max(form_radii)
    rise = flank - max(LEFT * m, EDGE * max(spec.tip_chamfer or 0.0, spec.tip_rounding or 0.0))
    least = 3.0 * rise / math.tan(STEEPEST)
    if not 0.0 < least <= spec.run_out:
        raise DesignError(
            "worm.run_out",
            spec.run_out,
            unit="mm",
            reason=f"the root would rise by more than {math.degrees(STEEPEST):g} deg",
            allowed=f"0 or at least {at_least(least)} mm" if least > 0.0 else "0",
        )
    return RunOut(radius - spec.dedendum * m, 0.5 * spec.length, spec.run_out, rise)


def _tool_dimensions(thread: WormThread) -> tuple[Dimension, ...]:
    made = [Dimension("pressure angle", math.degrees(thread.angle), "deg", "alpha_0")]
    if thread.grinding is not None:
        made.append(Dimension("rim diameter", 2.0 * thread.grinding.disk_radius, "mm", "d_0"))
        if thread.form is ThreadForm.ZC:
            made.append(Dimension("profile radius", thread.grinding.profile_radius, "mm", "rho"))
    return tuple(made)


def _thread_parameters(p: Array, v: Array) -> dict[str, Array]:
    return {"p_1": p, "theta_1": np.degrees(v)}


def _prove(
    name: str,
    tooth: Tooth,
    spec: MemberBody,
    prove: Callable[[Tooth], None] = Tooth.prove,
    *,
    lowered: float = 0.0,
) -> Tooth:
    """The tooth, if it can be trimmed; `lowered`: addenda from this one down have been tried, in vain."""
    try:
        prove(tooth)
    except TrimError as failure:
        remedies_of = WORM_REMEDIES if name == "worm" else WHEEL_REMEDIES
        key, allowed, remedies = remedies_of.get(failure.what, ("addendum", "less", {}))
        why = f"{failure} at z = {tooth.stations(failure.station):.4g} mm"
        if lowered and failure.what == "tip":
            key, allowed, remedies = NARROWER
            why += f", whatever {name}.addendum from {lowered * ADDENDUM_SHARES[-1]:g} to {lowered:g} it has"
        raise VagueError(
            f"{name}.{key}",
            getattr(spec, key),
            unit="mm" if key == "face_width" else "",
            reason=why,
            allowed=allowed,
            topic=f"{name}: {failure.what}",
            remedies=remedies,
        ) from failure
    return tooth


# ---------------------------------------------------------------- wheel


def _wheel(design: WormDriveDesign) -> Member:
    spec, hob = design.wheel, wheel_hob(design)
    lowered = 0.0 if design.sets("wheel.addendum") else usual_addendum(design)
    tooth = _prove("wheel", wheel_tooth(design), spec, lambda _: prove_wheel_of(design), lowered=lowered)
    blank, smallest = tooth.blank, hob.distance - hob.tip_radius
    tooth = with_tip_edge("wheel", tooth, spec)
    root = float(blank.root.at(0.5 * spec.face_width))
    under = UnderTeeth("wheel", tooth, blank.body, smallest, root, design.axial_module)
    return with_end_chamfers(Member("wheel", tooth, _wheel_parameters, body_features(spec, under)), spec)


@lru_cache(maxsize=2)
def wheel_tooth(design: WormDriveDesign) -> Tooth:
    """A tooth of the wheel of a complete design in mm, as its hob generates it, with sharp edges and not yet trimmed: one and the
    same for what looks for the face width and what builds the wheel. Raises DesignError."""
    spec, hob = design.wheel, wheel_hob(design)
    half = 0.5 * spec.face_width
    angle = math.radians(spec.throat_angle) if spec.tip_form == "chamfered" else None
    radius = spec.throat_radius if spec.throated else 0.0
    throat = Throat(radius, design.center_distance, 0.5 * spec.outside_diameter, angle)
    tip, root = throat.level(half), hob.root(half)
    smallest = hob.distance - hob.tip_radius
    if smallest <= 0.0 or smallest >= throat.middle:
        key = "center_distance" if abs(hob_apart(design)[0]) > EQUAL else "addendum"
        raise VagueError(
            f"hob.{key}",
            getattr(design.hob, key),
            unit="" if key == "addendum" else "mm",
            reason="the hob cuts beyond the wheel's axis" if smallest <= 0.0 else "the wheel's root lies above its tip",
            allowed=f"more than {at_least(hob.tip_radius)} mm and less than {at_most(hob.tip_radius + throat.middle)} mm"
            if key == "center_distance"
            else "",
        )
    if hob.distance <= throat.outside:
        apart = abs(hob_apart(design)[0]) > EQUAL
        raise VagueError(
            "hob.center_distance" if apart else "wheel.outside_diameter",
            hob.distance if apart else spec.outside_diameter,
            unit="mm",
            reason="the outside cylinder reaches the hob's axis",
            allowed=f"more than {at_least(throat.outside)} mm"
            if apart
            else f"less than {at_most(2.0 * hob.distance)} mm",
        )
    bore = bore_radius("wheel", spec.stated_bore, smallest, "the root diameter in the middle plane")
    body = disc_body("wheel", spec, bore, smallest, throat.middle - smallest)
    blank = Blank(PlaneLevel(0.0), (-half, half), tip, root, body)
    # over the hob's own axis
    tip_height, height = hob.distance - throat.middle, hob.distance - throat.outside
    right, left = (
        # the side of the hob that generates it
        wheel_hob(design, side * hob.thread.hand).tooth_side(side, tip_height, min(tip_height, height))
        for side in (1, -1)
    )
    return Tooth(spec.teeth, right, left, blank)


@lru_cache(maxsize=2)
def prove_wheel_of(design: WormDriveDesign) -> None:
    """Trim the wheel's tooth of a complete design in mm, once for what looks for the face width and what builds the wheel. Raises
    TrimError, DesignError."""
    prove_wheel(wheel_tooth(design))


def _wheel_parameters(p: Array, v: Array) -> dict[str, Array]:
    return {"p_0": p, "v_0": v}


# ---------------------------------------------------------------- assembly


def _gear_base(design: WormDriveDesign, opened: float = 0.0) -> Rigid:
    """The wheel's frame over the worm's, its x axis towards the worm; the shaft angle is `opened` (deg) further."""
    tilt = (1 if design.worm.right_hand else -1) * math.radians(design.shaft_angle + opened - 90.0)
    return Rigid(crossed_axes(tilt), np.array([design.center_distance, 0.0, 0.0]))


def _mounts(design: WormDriveDesign) -> tuple[Mount, Mount]:
    """Mounts with the errors."""
    errors, side = design.assembly, Side(design.contact.flank).sign
    thread = worm_thread(design, side)
    worm = Rigid(np.eye(3), np.array([0.0, 0.0, errors.dz1]))
    wheel = _gear_base(design, errors.d_sigma)
    wheel = Rigid(wheel.rotation, wheel.translation + np.array([errors.da, 0.0, 0.0]))
    along = Rigid(np.eye(3), np.array([0.0, 0.0, errors.dz2]))
    # the flank's polar angle in the middle plane, and that of the space beside the wheel's tooth
    half = thread.half_thickness(thread.radius) / thread.screw
    thinner = wheel_thinner(design, thread) / (0.5 * thread.module * design.wheel.teeth)
    wheel_half = (math.pi - thread.thickness / thread.module) / design.wheel.teeth - thinner
    return (
        Mount(worm, sign=-1.0, zero=side * half),
        Mount(wheel @ along, sign=float(thread.hand), zero=-side * wheel_half),
    )


def displaced_bases(design: WormDriveDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    first, second = (mount.base for mount in train.pairs[0].mounts)
    hand = 1.0 if design.worm.right_hand else -1.0
    worm = first.translation + shifts(0.0, 0.0, errors["dz1"])
    opened = rotation_about("x", hand * np.radians(errors["d_sigma"]))
    along = Rigid(np.eye(3), shifts(0.0, 0.0, errors["dz2"]))
    turned = Rigid(opened @ second.rotation, second.translation + shifts(errors["da"], 0.0, 0.0))
    return Rigid(np.broadcast_to(first.rotation, (len(worm), 3, 3)), worm), turned @ along


DISPLACEMENTS: Displacements[WormDriveDesign] = Displacements(("da", "dz1", "dz2", "d_sigma"), displaced_bases)


def pinned_values(design: WormDriveDesign, train: GearTrain) -> Values:
    """The worm's diameter and the hob's threads of a complete design in mm, which may be left out or given otherwise."""
    values: Values = {"worm.reference_diameter": design.reference_diameter}
    values |= dict.fromkeys(("worm.quotient", "worm.lead_angle"))
    if design.wheel.form == "helical":
        unused = ("wheel.throat_radius", "hob.reference_diameter", "hob.threads", "hob.pitch_height")
        return {**values, "wheel.tip_form": "cylindrical", **dict.fromkeys(unused)}
    return {**values, "hob.threads": design.worm.threads if design.hob.threads is None else design.hob.threads}
