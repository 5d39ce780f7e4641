"""The line of action of a cylindrical mesh: start and end of contact, and points between [ISO 21771].

Points on the line are given by the pinion's roll length, counted from where the line touches its base circle:

    A  the pinion's root side, where contact with the gear's tip begins
    B  from here to D one tooth pair is in contact alone
    C  the pitch point
    D  end of single contact
    E  the pinion's tip
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.racks.rack_tooth import tip_rounding
from gearmesh.systems.cylindrical.cutting.shaped import cuts_of
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, distance_of
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions

#: smaller lengths are rounding
ROUNDING_MODULES = 1e-9
#: roll lengths of a member's usable flank, at its root and at its tip
Flank = tuple[float, float]


def form_roll_length(gear: GearProportions, side: Side | None = None) -> float:
    """Return the roll length at which the tool's straight flank or involute ends on a side of the member.

    The roll length is negative if the tool undercuts the flank. `side`: right or left flanks; None for the drive side.
    """
    side = side or gear.own.drive
    if not gear.spec.hobbed:
        return cuts_of(gear)[side].form_roll_length
    own, rounding = gear.own.side(side), tip_rounding(gear.spec, coast=side is not gear.own.drive)
    return float(own.rack_form_roll_length(own.radius - gear.root, rounding.modules * own.module))


def undercut_reserve(gear: GearProportions, side: Side) -> float:
    """Return the roll length by which the right or left flanks stay clear of undercut, negative where they are undercut.

    - External member: from the base circle to the point that the end of the tool's flank generates.
    - Internal member: from the last point that the cutter's involute generates to the tip.
    - Formed member: from the base circle.
    """
    if not gear.own.internal:
        return form_roll_length(gear, side)
    made = cuts_of(gear)[side]
    return float(made.own.roll_length(made.tip) - made.generator)


@dataclass(frozen=True)
class SetBackFillet:
    """Reason why a member's fillet lies behind the involute of its flank.

    Tips that reach below the flank lose contact there.

    cause: the word that a warning begins with, and what ends the flank. remedy: what avoids it; the member's name comes
    before.
    """

    cause: str
    remedy: str


def set_back_fillet(gear: GearProportions, side: Side) -> SetBackFillet | None:
    """Return the undercut by the hob on a side, or the relief by its protuberance; None for internal or shaped members."""
    lost = -undercut_reserve(gear, side)
    if not gear.spec.hobbed or gear.own.internal:
        return None
    if lost > ROUNDING_MODULES * gear.own.module:
        shift = gear.own.shift + lost * math.sin(gear.own.side(side).alpha_t) / gear.own.module
        return SetBackFillet("undercut: the flank", f"profile_shift of at least {at_least(shift)} avoids undercut")
    hob = gear.spec.hob
    if hob is not None and hob.relief > ROUNDING_MODULES * gear.own.module:
        return SetBackFillet(
            "relief: the flank above what the protuberance cuts", "hob.protuberance must be smaller to avoid it"
        )
    return None


@dataclass(frozen=True)
class LineOfAction:
    """Line of action of a mesh and the usable flanks of pinion and gear, as roll lengths at root and tip.

    The mesh is that of one side of asymmetric teeth. Members are given by number: 0 the pinion, 1 the gear.
    """

    mesh: InvolutePair
    flanks: tuple[Flank, Flank]
    #: words for the side of asymmetric teeth, after the name of a member; empty for symmetric teeth
    where: str = ""

    @property
    def _sense(self) -> int:
        """+1 if the pinion's roll length grows from root to tip, else -1."""
        return self.mesh.pinion.sense

    def pinion_length(self, length: float) -> float:
        """Return the pinion's roll length at the gear's roll length `length`."""
        return self.mesh.mating_roll_length(length, self.mesh.gear)

    @property
    def points(self) -> dict[str, float]:
        """Roll lengths of the pinion at A, B, C, D, E."""
        (root, tip), mating, sense = self.flanks[0], self.flanks[1], self._sense
        a = sense * max(sense * root, sense * self.pinion_length(mating[1]))
        e = sense * min(sense * tip, sense * self.pinion_length(mating[0]))
        pitch = sense * self.mesh.pinion.base_pitch
        c = self.mesh.pinion.base_radius * math.tan(self.mesh.working_angle)
        return {"A": a, "B": e - pitch, "C": c, "D": a + pitch, "E": e}

    @property
    def contact_ratio(self) -> float:
        """Transverse contact ratio eps_alpha; negative if the flanks miss each other."""
        points = self.points
        return self._sense * (points["E"] - points["A"]) / self.mesh.pinion.base_pitch

    @property
    def members(self) -> tuple[Toothing, Toothing]:
        """Teeth of pinion and gear."""
        return self.mesh.pinion, self.mesh.gear

    def active(self, number: int) -> Flank:
        """Return the roll lengths of a member at which its active flank begins and ends, at root and tip."""
        points = self.points
        a, e = points["A"], points["E"]
        if number == 0:
            return a, e
        return self.mesh.mating_roll_length(e, self.mesh.pinion), self.mesh.mating_roll_length(a, self.mesh.pinion)

    def interference_reserve(self, number: int) -> float:
        """Return the roll length from the start of a member's usable flank to the mating gear's tip.

        The reserve is negative if the tip reaches into the fillet.
        """
        own, mating = self.flanks[number], self.flanks[1 - number]
        other = self.members[1 - number]
        return self.members[number].sense * (self.mesh.mating_roll_length(mating[1], other) - own[0])

    def clearing_tip(self, number: int, name: str) -> str:
        """Return, as text, the tip of the mating gear, called `name`, that clears a member's fillet."""
        own, mating = self.flanks[number], self.members[1 - number]
        diameter = 2.0 * math.hypot(mating.base_radius, self.mesh.mating_roll_length(own[0], self.members[number]))
        bound = f"at least {at_least(diameter)}" if mating.internal else f"at most {at_most(diameter)}"
        return f"{name}.tip_diameter {bound} mm"

    def fillet_interference(self, names: tuple[str, str], set_back: Sequence[SetBackFillet | None]) -> tuple[str, ...]:
        """Return a warning for each member below whose flank the mating tip reaches.

        `names`: names of pinion and gear. If a fillet is set back, contact is lost there and nothing interferes.
        """
        warnings = []
        both = ((0, *names), (1, *names[::-1]))
        for (member, name, other), behind in zip(both, set_back, strict=True):
            reserve = self.interference_reserve(member)
            if self._clears(member):
                continue
            if behind is not None:
                warnings.append(
                    f"{name}{self.where}: {behind.cause} begins {-reserve:.4g} mm of roll length beyond where the "
                    f"{other}'s tip would meet it, and contact is lost there; {name}.{behind.remedy}"
                )
            else:
                warnings.append(
                    f"{name}{self.where}: interference: the {other}'s tip reaches {-reserve:.4g} mm of roll length into the "
                    f"fillet; it clears the fillet with {self.clearing_tip(member, other)}"
                )
        return tuple(warnings)

    def _clears(self, number: int) -> bool:
        """True if the mating gear's tip stays on a member's usable flank, up to rounding."""
        return self.interference_reserve(number) >= -ROUNDING_MODULES * self.members[number].module

    def fillet_reserves(self, set_back: Sequence[SetBackFillet | None]) -> list[float | None]:
        """Return the interference reserves of pinion and gear; rounding counts as 0.

        None for a member whose fillet is set back and reached by the mating tip.
        """
        left: list[float | None] = []
        for number, behind in zip((0, 1), set_back, strict=True):
            reserve = self.interference_reserve(number)
            lost = behind is not None and not self._clears(number)
            left.append(None if lost else max(reserve, 0.0) if self._clears(number) else reserve)
        return left


def tight_distance(mesh: InvolutePair) -> float:
    """Return the centre distance at which teeth with their allowances have no backlash; NaN if there is none."""
    even = (
        replace(
            toothing,
            shift=toothing.generating_shift,
            allowance=0.0,
        )
        for toothing in (mesh.pinion, mesh.gear)
    )
    return distance_of(*even)
