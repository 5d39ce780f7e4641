"""Members that a shaper cutter generates: internal gears, and external ones that a hob cannot reach.

In the transverse section the cutter's involute generates the flank, its tip rounding the fillet and its top the root; a helical
member is that section, twisted (see `kernel.twisted`). The cutter is at the distance at which it leaves teeth of the thickness
that is asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.chain import Chain, Step
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.kernel.surface.surface import Surface
from gearmesh.kernel.surface.twisted import Twisted
from gearmesh.systems.common.bodies.body import body_features, bore_radius, disc_body, holes_in
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.common.racks.rack_member import prove, tip_edge
from gearmesh.systems.cylindrical.cutting.cutter import cutter_of, sharp_shaper
from gearmesh.systems.cylindrical.cutting.cutter_choice import CutterChoice
from gearmesh.systems.cylindrical.design import RIM
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import RackSurface
from gearmesh.tools.shaper import Shaper

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember
    from gearmesh.systems.cylindrical.geometry.proportions import PairProportions


@dataclass(frozen=True)
class Shaping:
    """A cutter over a member: the tool in the transverse section, the teeth that it is to leave, radii of tip and root (mm)."""

    shaper: Shaper
    own: Toothing
    tip: float
    root: float
    cutter: Toothing

    @property
    def choice(self) -> CutterChoice:
        """The cutter among those of other tooth numbers."""
        return CutterChoice(self.own, self.root, self.cutter)

    @property
    def distance(self) -> float:
        """Between the axes of cutter and member, mm."""
        return self.root + self.own.sense * self.shaper.top_radius

    @property
    def generator(self) -> float:
        """Length of the line of action between the base circles, mm."""
        between = self.own.base_radius + self.own.sense * self.shaper.base_radius
        return math.sqrt(self.distance**2 - between**2)

    def theta(self, radius: float) -> float:
        """Parameter theta_s (rad) of the cutter's involute that generates a radius (mm) of the member."""
        length = self.own.roll_length(radius) - self.generator
        return -self.own.sense * length / self.shaper.base_radius

    @property
    def motion(self) -> Chain:
        """The cutter's frame (see `tools.shaper`) to that of the member's transverse section."""
        sense = self.own.sense
        return Chain(
            (
                Step(rate=sense * self.shaper.teeth / self.own.teeth),
                Step(rate=1.0, angle0=0.0 if sense > 0 else np.pi, offset=(self.distance, 0.0, 0.0)),
                Step(offset=(-self.shaper.pitch_radius, 0.0, 0.0)),
            ),
            harmonic=True,
        )

    def generate(self, profile: Profile, which: Side) -> Surface:
        """What a profile of the cutter generates on one side of the tooth; its second parameter is z, mm."""
        section = self.section(profile, which)
        return section if self.own.twist == 0.0 else Twisted(section, self.own.twist)

    def section(self, profile: Profile, which: Side) -> Envelope:
        """What it generates in the transverse section, as that of spur teeth."""
        # turned by 180 deg the cutter's right side is the left one of an internal tooth
        return Envelope(RackSurface(profile, 0.0, 0.0, self.own.sense * which.sign), self.motion, branch=1)


def shaping(design: CylindricalDesign, name: str, geometry: PairProportions) -> Shaping:
    """The cutter over a shaped member, as the member is built. Raises DesignError for one that cannot cut these teeth."""
    spec, own = getattr(design, name), getattr(geometry.mesh, name)
    index = 0 if name == "pinion" else 1
    shaper = replace(sharp_shaper(design, name, geometry.nominal), tip_radius=spec.tool_tip_radius * own.module)
    return Shaping(shaper, own, geometry.tips[index], geometry.roots[index], cutter_of(design, spec))


def shaped_member(name: str, spec: CylindricalMember, shaping: Shaping, tip_key: str, theta: str, along: str) -> Member:
    """A member from its part `spec` of a design (in mm), proved to have closed, unpointed teeth from toe to heel.

    `theta`, `along`: names of its source parameters. Raises DesignError naming key, value and limit: a tip that the cutter's
    involute does not generate, a bore not below the root, a pointed tooth.
    """
    own = shaping.own
    _check_tip(name, spec, shaping, tip_key)
    tooth = Tooth(
        spec.teeth,
        _side(shaping, Side.RIGHT),
        _side(shaping, Side.LEFT),
        _blank(name, spec, shaping),
        tip_edge=tip_edge(spec),
    )
    if own.internal:
        try:
            tooth.prove()
        except TrimError as failure:
            raise VagueError(
                name,
                reason=failure.reason,
                allowed=f"a smaller addendum or tip edge, or another {name}.shaper or {name}.profile_shift",
                topic=f"{name}: {failure.what}",
            ) from failure
    else:
        prove(name, tooth, spec, tip_key)

    def source_parameters(p: Array, v: Array) -> dict[str, Array]:
        return {theta: np.degrees(p), along: v}

    body = tooth.blank.body
    if own.internal:
        holes = None if spec.holes is None else holes_in(name, spec.holes, shaping.root, body.profile[0][0])
        return Member(name, tooth, source_parameters, holes=holes)
    features = body_features(name, spec, body.bore_radius, shaping.root, shaping.root, body.web)
    return Member(name, tooth, source_parameters, *features)


def _check_tip(name: str, spec: CylindricalMember, shaping: Shaping, tip_key: str) -> None:
    """Refuse a tip of an internal gear beyond what the cutter's involute generates."""
    own, teeth = shaping.own, shaping.shaper.teeth
    if not own.internal or shaping.tip >= (least := math.hypot(own.base_radius, shaping.generator)):
        return
    why = f"the cutter of {teeth} teeth generates no involute up to the tip"
    if spec.shaper is None:
        value = spec.tip_diameter if spec.tip_diameter is not None else spec.addendum
        raise DesignError(
            f"{name}.{tip_key}",
            value,
            reason=f"{why}, and no cutter with more teeth does",
            allowed=f"a tip diameter of at least {at_least(2.0 * least)} mm, instead of {2.0 * shaping.tip:.7g} mm",
        )
    raise DesignError(
        f"{name}.shaper.teeth",
        teeth,
        reason=f"{why}; {shaping.choice.possible(name, shaping.tip)}, or with {teeth} teeth a tip diameter of "
        f"at least {at_least(2.0 * least)} mm, instead of {2.0 * shaping.tip:.7g} mm",
    )


def _side(shaping: Shaping, which: Side) -> ToothSide:
    shaper = shaping.shaper
    profiles = shaper.involute, shaper.rounding
    # a helical shaper turns as it strokes: what it leaves is that of a spur one, twisted
    flank, fillet = (shaping.generate(profile, which) for profile in profiles)
    spur = shaping.section(profiles[0], which), shaping.section(profiles[1], which)
    return ToothSide(
        flank=flank,
        fillet=fillet,
        form_point=shaper.form_point,
        root=shaper.root,
        tip=shaping.theta(shaping.tip),
        tool=shaper.description,
        generation=spur if shaping.own.twist == 0.0 else None,
    )


def _blank(name: str, spec: CylindricalMember, shaping: Shaping) -> Blank:
    half = 0.5 * spec.face_width
    if not shaping.own.internal:
        bore = bore_radius(name, spec.bore, shaping.root, "the root diameter")
        body = disc_body(name, spec, bore, shaping.root, shaping.tip - shaping.root)
        return Blank(PlaneLevel(0.0), (-half, half), ConeLevel.of(shaping.tip), ConeLevel.of(shaping.root), body)
    rim = RIM * shaping.own.module if spec.rim is None else spec.rim
    # towards -z the directions along the chain and to the heel turn out of the material, as on an external gear towards +z
    return Blank(
        axial=PlaneLevel(0.0, -1.0),
        extent=(-half, half),
        tip=ConeLevel(-0.5 * np.pi, -shaping.tip),
        root=ConeLevel(-0.5 * np.pi, -shaping.root),
        body=Body.tube(shaping.root + rim, half, -half, Region.RIM),
    )
