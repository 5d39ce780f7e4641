"""Construction of straight bevel pairs: blank, sides of the crown gear, members and their mounting.

The fixed frame is the pinion's frame at its nominal position: the apex is the origin, z is along the axis to the heel.
phi1 = phi2 = 0 is the position in which the working flanks cross the pitch line on the x axes of both frames.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.bevel.blank import BevelBlank, basic_data
from gearmesh.systems.common.bevel.displacements import displaced_bases
from gearmesh.systems.common.bevel.member import CutMember, Remedies, bevel_member
from gearmesh.systems.common.bevel.pair_blank import pair_blank, proportions
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.straight_bevel.generated import CrownCut, DiscCut, disc_place, land_angle
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.tools.crown_rack import CrownCurve, CrownSpace, OctoidCurve, SphericalInvoluteCurve
from gearmesh.tools.disc_cutter import DiscBlade

if TYPE_CHECKING:
    from gearmesh.systems.straight_bevel.design import StraightBevelDesign

#: names of the members in order
MEMBER_NAMES = ("pinion", "gear")
#: remedies for teeth that cannot be trimmed
TOOTH_REMEDIES = Remedies(
    {
        "pointed": "a smaller depth_factor, an addendum_factor nearer to 0.5 or a narrower face",
        "undercut": "more teeth, a smaller depth_factor, a larger pressure angle or another addendum_factor",
        "flank": "a larger depth_factor, a narrower face or a smaller {name}.edge_radius",
        "root": "a smaller {name}.edge_radius or a narrower face",
        "tip": "a narrower face or a smaller depth_factor",
        "crossing": "a smaller {name}.edge_radius",
    },
    {
        "pointed": {"depth_factor": -1, "addendum_factor": 0, "face_width": -1},
        "undercut": {"pressure_angle": 1, "pinion.teeth": 1, "gear.teeth": 1, "depth_factor": -1},
        "tip": {"face_width": -1, "depth_factor": -1},
    },
)
#: names of the tools by the form of the flanks
TOOL_NAMES = {"octoid": "planing tool", "spherical_involute": "spherical involute crown gear"}


def _in_mm(p: Array, v: Array) -> tuple[Array, Array]:
    return p, v


def _in_degrees(p: Array, theta: Array) -> tuple[Array, Array]:
    return p, np.degrees(theta)


#: parameters of the flanks
FLANK_PARAMETERS = NamedParameters(
    (
        SourceParameter(
            "p", "mm", "distance up the crown gear's profile from its tip rounding, at the mean cone distance"
        ),
        SourceParameter("v", "mm", "cone distance on the crown gear beyond the mean cone distance"),
    ),
    _in_mm,
)
#: parameters of flanks that discs cut
DISC_PARAMETERS = NamedParameters(
    (
        SourceParameter("p", "mm", "distance along the cutting edge of the disc, from its land"),
        SourceParameter("theta", "deg", "angle about the axis of the disc, 0 at the mean cone distance"),
    ),
    _in_degrees,
)
#: radius of a disc by default, in face widths
DISC_RADIUS_FACES = 6.0
#: least radius of a disc, in face widths
MIN_DISC_RADIUS_FACES = 0.75


def build(design: StraightBevelDesign) -> GearTrain:
    """Return the pair of a design (in mm). Raises DesignError for blanks and teeth that cannot exist."""
    blank = straight_blank(design)
    # the gear first: a fault of the gear shows on the pinion as well
    gear, pinion = (straight_member(design, blank, number) for number in (1, 0))
    side = Side(design.contact.flank)
    frames = gear_base(blank.shaft_angle)
    errors = {key: np.array([getattr(design.assembly, key)]) for key in ("dA", "dG", "dV", "d_delta")}
    pinion_base, gear_frame = (
        Rigid(base.rotation[0], base.translation[0])
        for base in displaced_bases((Mount(Rigid.identity()), Mount(frames)), errors)
    )
    halves = half_angles(blank)
    pair = GearPair(
        pinion=replace(pinion.member, mount=Mount(pinion_base, sign=-1.0, zero=side.sign * halves[0])),
        gear=replace(gear.member, mount=Mount(gear_frame, sign=1.0, zero=-side.sign * halves[1])),
        flanks=(side, side),
        drive=side.sign,
        ratio=design.pinion.teeth / design.gear.teeth,
        delta=design.contact.delta,
    )
    remedies = TOOTH_REMEDIES.texts["undercut"]
    return GearTrain(
        design.kind,
        (pair,),
        (*blank.warnings, *gear.undercut_warnings(remedies), *pinion.undercut_warnings(remedies)),
    )


def straight_blank(design: StraightBevelDesign) -> BevelBlank:
    """Return the blank of a design in mm. Raises DesignError for a blank that cannot exist."""
    data = basic_data(design, 0.0, design.pressure_angle)
    return pair_blank(design, data, proportions(design), np.inf, design.backlash)


def half_angles(blank: BevelBlank) -> tuple[float, float]:
    """Return half the angles (rad) of a tooth of pinion and gear on the pitch circle."""
    pinion, gear = (float(0.5 * own.thickness / own.mean_radius) for own in blank.members)
    return pinion, gear


def straight_member(design: StraightBevelDesign, blank: BevelBlank, number: int) -> CutMember:
    """Return the pinion (0) or the gear (1) of a design in mm. Raises DesignError for teeth that cannot exist."""
    name, own = MEMBER_NAMES[number], blank.members[number]
    spec = design.pinion if number == 0 else design.gear
    sides = {side: cut_side(design, blank, number, side) for side in Side}
    parameters = FLANK_PARAMETERS if spec.disc is None else DISC_PARAMETERS
    half = half_angles(blank)[number]
    places = {side: -side.sign * half for side in Side}
    return bevel_member(name, spec, blank, own, sides, places, parameters, TOOTH_REMEDIES)


def cut_side(design: StraightBevelDesign, blank: BevelBlank, number: int, side: Side) -> CrownCut | DiscCut:
    """Return a side of the pinion (0) or the gear (1) of a design in mm, as the crown gear or a disc cuts it.

    Raises DesignError for a disc that is too small for the face.
    """
    own, spec = blank.members[number], design.pinion if number == 0 else design.gear
    mean, depths = (
        own.mean_cone_distance,
        own.depth_of(own.root, np.array([own.mean_cone_distance, own.outer_cone_distance])),
    )
    # space of the crown gear: its depth is the dedendum in the mean section and grows to the heel as the root cone asks
    space = CrownSpace(
        crown_curve(design.form, blank.pressure_angle),
        blank.pressure_angle,
        mean,
        depth=float(depths[0]),
        slope=float((depths[1] - depths[0]) / (own.outer_cone_distance - mean)),
        edge_radius=blank.edge_radius if spec.edge_radius is None else spec.edge_radius,
        side=1 if side is Side.RIGHT else -1,
    )
    depth, free = own.mean_addendum + space.depth, spec.edge_radius is None
    if spec.disc is None:
        return CrownCut(space, own.pitch_angle, own.root, depth, TOOL_NAMES[design.form], free)
    radius = disc_radius(design, blank, number)
    # a disc leaves a round root: its rim reaches the root line at both ends of the face, or beyond
    blade = DiscBlade(radius, float(np.radians(spec.disc.dish_angle)), land_angle(space), space.edge_radius)
    place, land_depth = disc_place(space, blade, (mean - own.inner_cone_distance, own.outer_cone_distance - mean))
    return DiscCut(blade, place, space.side, own.pitch_angle, own.root, land_depth, depth, free)


def disc_radius(design: StraightBevelDesign, blank: BevelBlank, number: int) -> float:
    """Return the radius (mm) of the discs of a member with the table disc.

    Raises DesignError for a disc that is too small for the face.
    """
    disc, name = (design.pinion if number == 0 else design.gear).disc, MEMBER_NAMES[number]
    width, depth = blank.gear.face_width, blank.mean_depth
    if disc is None or disc.radius is None:
        return DISC_RADIUS_FACES * width
    # the rim is deeper in the middle of the face, by at most the depth of the teeth
    least = 0.5 * (0.25 * width**2 / depth + depth)
    if not disc.radius >= max(least, MIN_DISC_RADIUS_FACES * width):
        raise DesignError(
            f"{name}.disc.radius",
            disc.radius,
            unit="mm",
            reason="the disc is too small for the face",
            allowed=f"{at_least(max(least, MIN_DISC_RADIUS_FACES * width))} mm or more",
        )
    return disc.radius


def crown_curve(form: str, pressure_angle: float) -> CrownCurve:
    """Return the curve of the crown gear's flank by the form of a design and the pressure angle (rad)."""
    return OctoidCurve(pressure_angle) if form == "octoid" else SphericalInvoluteCurve(pressure_angle)
