"""A rack as a member, and where it stands to its pinion [ISO 21771, ISO 53].

A rack is what rolls on its pinion as the basic rack does: flanks are planes, root fillets cylinders along the tooth traces, lands
planes. Its own frame: x out of the bar, x = 0 the reference plane, on which tooth and space are equally wide but for allowances; y
along the bar; z across it, the middle of the face at z = 0, where one tooth is centred on y = 0. Lengths in mm, angles in rad.

Fixed frame: the pinion's, as in `build`; the rack's reference plane is at x = `distance`, its teeth point to the pinion's axis. The
rack's coordinate phi2 (rad) is its displacement over the radius of the pinion's reference cylinder, which rolls on it without slip
whatever profile shift and distance; the displacement grows towards -y of the fixed frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.course import Sliding
from gearmesh.kernel.flat import FlatLevel
from gearmesh.kernel.levels import PlaneLevel
from gearmesh.kernel.rigid import Rigid
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.common.rack_member import ROOT
from gearmesh.systems.common.rack_tooth import Heights, RackTooth, rounded
from gearmesh.systems.cylindrical.geometry import Toothing
from gearmesh.teeth.blank import Blank
from gearmesh.teeth.body import Body
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.teeth.train import GearPair, Member
from gearmesh.tools.rack import Line, RackSurface


@dataclass(frozen=True)
class RackProportions:
    """Teeth of a rack: their number; face width and height of the bar under the reference plane, mm; addendum, dedendum and radius
    of the root fillets in normal modules; allowance of the normal tooth thickness, mm."""

    teeth: int
    face_width: float
    height: float
    addendum: float = 1.0
    dedendum: float = 1.25
    tool_tip_radius: float = 0.38
    allowance: float = 0.0


@dataclass(frozen=True)
class RackMesh:
    """A pinion and a rack in closed form; `tip`: the pinion's tip radius, `distance`: from its axis to the reference plane."""

    pinion: Toothing
    rack: RackProportions
    tip: float
    distance: float

    @property
    def circumferential_backlash(self) -> float:
        """Transverse play (mm) along the rack: what pinion and rack leave of the pitch on the reference cylinder."""
        own = self.pinion
        above = self.distance - own.radius
        rack = (0.5 * math.pi * own.module + self.rack.allowance) / math.cos(own.beta) - 2.0 * above * math.tan(
            own.alpha_t
        )
        return math.pi * own.transverse_module - own.thickness / math.cos(own.beta) - rack

    @property
    def transverse_contact_ratio(self) -> float:
        """Path of contact from the rack's tip plane to the pinion's tip, over the base pitch.

        Of pinions whose involute goes on to where the rack's tips meet it.
        """
        own = self.pinion
        below = self.rack.addendum * own.module - (self.distance - own.radius)
        recess = own.roll_length(self.tip) - own.base_radius * math.tan(own.alpha_t)
        return (recess + below / math.sin(own.alpha_t)) / own.base_pitch

    @property
    def overlap_ratio(self) -> float:
        return self.rack.face_width * math.sin(abs(self.pinion.beta)) / (math.pi * self.pinion.module)

    @property
    def root_clearance(self) -> float:
        """Of the pinion's tips over the rack's root, mm."""
        return self.distance + self.rack.dedendum * self.pinion.module - self.tip


def rack_member(name: str, spec: RackProportions, pinion: Toothing) -> Member:
    """A rack (in mm) that meshes with a pinion, without its mounting; its helix has the other hand.

    Raises DesignError naming key, value and limit: no room for the fillet, no tooth, no bar.
    """
    m, helix = pinion.module, -pinion.beta
    heights = Heights(spec.addendum * m, -spec.dedendum * m)
    line = Line(pinion.alpha, m, 0.25 * math.pi * m + 0.5 * spec.allowance)
    right, left = (
        _side(rack, helix, side)
        for rack, side in zip(rounded(name, spec, m, (line, line), heights), (1, -1), strict=True)
    )
    if not spec.height > spec.dedendum * m:
        raise DesignError(
            f"{name}.height = {spec.height:g} mm: the root lies below the back of the bar; allowed is more than the dedendum, "
            f"{at_least(spec.dedendum * m)} mm"
        )
    course, half = Sliding(pinion.radius, 2.0 * math.pi / pinion.teeth), 0.5 * spec.face_width
    tooth = Tooth(
        teeth=spec.teeth,
        right=right,
        left=left,
        blank=Blank(
            PlaneLevel(0.0),
            (-half, half),
            FlatLevel(heights.tip, course),
            FlatLevel(heights.root, course),
            Body.tube(-spec.height, -half, half, Region.BACK),
        ),
        course=course,
    )
    tooth.prove()

    def source_parameters(p: Array, v: Array) -> dict[str, Array]:
        return {"l_R": p, "u_R": v}

    return Member(name, tooth, source_parameters)


def _side(rack: RackTooth, helix: float, side: int) -> ToothSide:
    """A side of the rack: the profile itself, swept along the tooth trace."""
    flank, fillet = (RackSurface(profile, helix, 0.0, side) for profile in (rack.flank, rack.rounding))
    return ToothSide(flank, fillet, rack.joint, root=ROOT, tip=rack.tip)


def rack_mount(pinion: Toothing, distance: float, flank: Side) -> Mount:
    """Where a rack stands: at phi2 = 0 with a space before the pinion's tooth that is on +x at phi1 = 0, whose `flank` drives."""
    course = Sliding(pinion.radius, 2.0 * math.pi / pinion.teeth)
    about = Rigid(np.diag([-1.0, -1.0, 1.0]), np.array([distance, 0.0, 0.0]))
    return Mount(about, zero=-0.5 * flank.sign * course.step, course=course)


def rack_pair(pinion: Member, rack: Member, flank: Side, delta: float) -> GearPair:
    """Both mounted members, the pinion driving with a flank."""
    return GearPair(pinion, rack, (flank, flank), drive=flank.sign, ratio=1.0, delta=delta)
