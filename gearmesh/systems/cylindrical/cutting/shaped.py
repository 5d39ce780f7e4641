"""Members that a shaper cutter generates: internal gears, and external gears that a hob cannot reach.

In the transverse section the cutter's involute generates the flank, its tip rounding the fillet and its top the root. A
helical member is this section, twisted (see `kernel.surface.twisted`). The cutter is at the distance at which it cuts teeth of
the required thickness.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.chain import Chain, Step
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.twisted import Twisted
from gearmesh.records import dataclass
from gearmesh.systems.common.bodies.body import bore_radius, disc_body
from gearmesh.systems.common.bodies.features import UnderTeeth, body_features, ring_features
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.common.racks.rack_member import prove
from gearmesh.systems.common.racks.rack_tooth import TipRounding, tip_rounding
from gearmesh.systems.common.racks.ring_member import prove_internal, ring_blank
from gearmesh.systems.common.racks.tool_roundings import with_roundings
from gearmesh.systems.common.tooth_edges import tip_edge
from gearmesh.systems.cylindrical.cutting.cutter import cutter_of, cutting_flank, sharp_shaper
from gearmesh.systems.cylindrical.cutting.cutter_choice import CutterChoice
from gearmesh.systems.cylindrical.cutting.formed import Forming
from gearmesh.systems.cylindrical.cutting.last_cut import LastCut
from gearmesh.systems.cylindrical.design import DEFAULT_RIM_MODULES
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.description import ToolDescription
from gearmesh.tools.profile import Profile

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalMember
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions


@dataclass(frozen=True)
class Shaping(LastCut):
    """A cutter over one side of a member.

    With the tip radius (mm) of the member, the teeth of the cutter, and the whole teeth of the member.
    """

    tip: float
    cutter: Toothing
    teeth: Toothing

    @property
    def choice(self) -> CutterChoice:
        """Choice among cutters with other tooth numbers."""
        return CutterChoice(self.teeth, self.root, self.cutter)

    @property
    def motion(self) -> Chain:
        """Motion from the cutter's frame (see `tools.shaper`) to the frame of the member's transverse section."""
        sense = self.own.sense
        return Chain(
            (
                Step(rate=sense * self.shaper.teeth / self.own.teeth),
                Step(rate=1.0, angle0=0.0 if sense > 0 else np.pi, offset=(self.distance, 0.0, 0.0)),
                Step(offset=(-self.shaper.pitch_radius, 0.0, 0.0)),
            ),
            harmonic=True,
        )

    def section(self, profile: Profile, which: Side, twist: float = 0.0) -> Envelope:
        """Return the surface that a profile of the cutter generates on one side of the tooth.

        `twist`: twist (rad/mm) of the tool for helical teeth; 0 gives the transverse section of spur teeth.
        """
        # turned by 180 deg, the cutter's right side generates the left flank of an internal tooth
        return Envelope(self.tool(profile, self.own.sense * which.sign, twist), self.motion, branch=1)

    @property
    def description(self) -> ToolDescription:
        return self.shaper.description

    def refuse_tip(self, name: str, spec: CylindricalMember, tip_key: str) -> None:
        """Refuse a tip of an internal gear beyond the involute that the cutter generates."""
        own, teeth = self.own, self.shaper.teeth
        if not own.internal or self.tip >= (least := math.hypot(own.base_radius, self.generator)):
            return
        why = f"the cutter of {teeth} teeth generates no involute up to the tip"
        if spec.shaper is None:
            none = f"{why}, and no cutter with more teeth does"
            if spec.tip_diameter is not None:
                most = Allowed.at_least(2.0 * least, "mm")
                raise DesignError(f"{name}.{tip_key}", spec.tip_diameter, unit="mm", reason=none, allowed=most)
            none += (
                f"; it needs a tip diameter of {at_least(2.0 * least)} mm or more, instead of {2.0 * self.tip:.7g} mm"
            )
            raise VagueError(f"{name}.{tip_key}", spec.addendum, reason=none, remedies={f"{name}.{tip_key}": -1})
        raise DesignError(
            f"{name}.shaper.teeth",
            teeth,
            reason=f"{why}; {self.choice.possible(name, self.tip)}, or with {teeth} teeth a tip diameter of "
            f"at least {at_least(2.0 * least)} mm, instead of {2.0 * self.tip:.7g} mm",
        )


def cuts_of(gear: GearProportions) -> dict[Side, Shaping | Forming]:
    """Return the cutter over both sides of a shaped gear, or the form tool in a formed gear, at the last cut.

    Raises DesignError if the tool cannot cut these teeth.
    """
    spec, teeth, sharp = gear.spec, gear.own, sharp_shaper(gear)
    if spec.formed:
        reason, note = "the spaces are too narrow for such root fillets", ", with which a space has one round root"
        tool = with_roundings(gear.name, spec, teeth.module, sharp, reason, note)
        return {side: Forming(cutting_flank(gear, tool, side), teeth.side(side), gear.root, gear.tip) for side in Side}
    tool = with_roundings(gear.name, spec, teeth.module, sharp, "the shaper's tooth is too narrow for the fillet")
    cutter = cutter_of(gear)
    return {
        side: Shaping(cutting_flank(gear, tool, side), teeth.side(side), gear.root, gear.tip, cutter, teeth)
        for side in Side
    }


def shaped_member(
    name: str,
    spec: CylindricalMember,
    cuts: Mapping[Side, Shaping | Forming],
    drive: Side,
    tip_key: str,
    theta: str,
    along: str,
) -> Member:
    """Return a member of a part `spec` of a design (in mm), proved to have closed, unpointed teeth from toe to heel.

    - cuts: see `cuts_of`.
    - drive: flanks of the drive side.
    - tip_key: the key that gives the tip, named in refusals.
    - theta, along: names of the member's source parameters.

    Raises DesignError naming key, value and limit: a tip that the cutter's involute does not generate, a bore not below
    the root, or a pointed tooth.
    """
    cut = cuts[Side.RIGHT]
    own = cut.own
    for side, of_side in cuts.items():
        of_side.refuse_tip(name, spec, tip_key)
        _check_flank(name, tip_rounding(spec, coast=side is not drive), of_side)
    tooth = Tooth(
        spec.teeth,
        _side(cut, Side.RIGHT),
        _side(cuts[Side.LEFT], Side.LEFT),
        _blank(name, spec, cut),
        tip_edge=tip_edge(spec, coast=drive.other),
    )
    # an external tooth is proved as the tooth of a rack cutter is
    if own.internal:
        prove_internal(name, tooth, f"another {name}.shaper or {name}.profile_shift")
    else:
        prove(name, tooth, spec, tip_key)

    parameters = NamedParameters(
        (
            SourceParameter(theta, "deg", "roll angle of the involute of the cutter, from its base circle"),
            SourceParameter(along, "mm", "distance along the axis, from mid face"),
        ),
        lambda p, v: (np.degrees(p), v),
    )
    under = UnderTeeth(name, tooth, tooth.blank.body, cut.root, cut.root, own.module)
    features = ring_features(spec, under) if own.internal else body_features(spec, under)
    return Member(name, tooth, parameters, features)


def _check_flank(name: str, rounding: TipRounding, cut: Shaping | Forming) -> None:
    """Refuse a rounding that leaves no flank below the tip."""
    own, tip = cut.own, cut.own.roll_length(cut.tip)
    if own.sense * (tip - cut.form_roll_length) > 0.0:
        return
    sharp = replace(cut, shaper=replace(cut.shaper, tip_radius=0.0))
    raise DesignError(
        f"{name}.{rounding.key}",
        rounding.modules,
        reason="the root fillets leave no flank below the tips",
        allowed=Allowed.less_than(sharp.largest_rounding(tip, cut.shaper.tip_radius) / own.module),
    )


def _side(cut: Shaping | Forming, which: Side) -> ToothSide:
    """Return one side of the tooth: flank and fillet, twisted on helical teeth."""
    shaper, twist = cut.shaper, cut.own.twist
    # a helical cutter rotates with its stroke, so that its surfaces are those of a spur cutter, twisted
    profiles = shaper.involute, shaper.rounding
    flank, fillet = (cut.section(profile, which) for profile in profiles)
    tool_twist = 0.0 if twist == 0.0 else cut.tool_twist
    by_flank, by_fillet = (cut.section(profile, which, tool_twist) for profile in profiles)
    return ToothSide(
        flank=flank if twist == 0.0 else Twisted(flank, twist),
        fillet=fillet if twist == 0.0 else Twisted(fillet, twist),
        form_point=shaper.form_point,
        root=shaper.root,
        tip=cut.theta(cut.tip),
        tool=cut.description,
        generation=(by_flank, by_fillet),
    )


def _blank(name: str, spec: CylindricalMember, cut: Shaping | Forming) -> Blank:
    """Return the blank: a disc with a bore, or the rim of an internal gear."""
    half = 0.5 * spec.face_width
    if not cut.own.internal:
        bore = bore_radius(name, spec.stated_bore, cut.root, "the root diameter", key=spec.bore_key)
        body = disc_body(name, spec, bore, cut.root, cut.tip - cut.root)
        return Blank(PlaneLevel(0.0), (-half, half), ConeLevel.of(cut.tip), ConeLevel.of(cut.root), body)
    rim = DEFAULT_RIM_MODULES * cut.own.module if spec.rim is None else spec.rim
    return ring_blank(half, cut.tip, cut.root, rim)
