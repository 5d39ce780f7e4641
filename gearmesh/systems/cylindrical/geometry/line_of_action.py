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
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.cylindrical.cutting.shaped import cut_of
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, distance_of

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions

#: smaller lengths are rounding
ROUNDING_MODULES = 1e-9
#: roll lengths of a member's usable flank, at its root and at its tip
Flank = tuple[float, float]


def form_roll_length(gear: GearProportions) -> float:
    """Return the roll length at which the tool's straight flank or involute ends on the member.

    The roll length is negative if the tool undercuts the flank.
    """
    if not gear.spec.hobbed:
        return cut_of(gear).form_roll_length
    own = gear.own
    return float(own.rack_form_roll_length(own.radius - gear.root, gear.spec.tool_tip_radius * own.module))


def undercut_reserve(gear: GearProportions) -> float:
    """Return the roll length by which the flank stays clear of undercut, negative where it is undercut.

    - External member: from the base circle to the point that the end of the tool's flank generates.
    - Internal member: from the last point that the cutter's involute generates to the tip.
    - Formed member: from the base circle.
    """
    if not gear.own.internal:
        return form_roll_length(gear)
    made = cut_of(gear)
    return float(gear.own.roll_length(made.tip) - made.generator)


@dataclass(frozen=True)
class SetBackFillet:
    """Reason why a member's fillet lies behind the involute of its flank.

    Tips that reach below the flank lose contact there.

    cause: the word that a warning begins with, and what ends the flank. remedy: what avoids it; the member's name comes
    before.
    """

    cause: str
    remedy: str


def set_back_fillet(gear: GearProportions) -> SetBackFillet | None:
    """Return the undercut by the hob, or the relief by its protuberance; None for internal or shaped members."""
    lost = -undercut_reserve(gear)
    if not gear.spec.hobbed or gear.own.internal:
        return None
    if lost > ROUNDING_MODULES * gear.own.module:
        shift = gear.own.shift + lost * math.sin(gear.own.alpha_t) / gear.own.module
        return SetBackFillet("undercut: the flank", f"profile_shift of at least {at_least(shift)} avoids undercut")
    hob = gear.spec.hob
    if hob is not None and hob.relief > ROUNDING_MODULES * gear.own.module:
        return SetBackFillet(
            "relief: the flank above what the protuberance cuts", "hob.protuberance must be smaller to avoid it"
        )
    return None


@dataclass(frozen=True)
class LineOfAction:
    """Line of action of a mesh and the usable flanks of pinion and gear, as roll lengths at root and tip."""

    mesh: InvolutePair
    flanks: tuple[Flank, Flank]

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

    def active(self, member: Toothing) -> Flank:
        """Return the roll lengths of a member at which its active flank begins and ends, at root and tip."""
        points = self.points
        a, e = points["A"], points["E"]
        if member is self.mesh.pinion:
            return a, e
        return self.mesh.mating_roll_length(e, self.mesh.pinion), self.mesh.mating_roll_length(a, self.mesh.pinion)

    def interference_reserve(self, member: Toothing) -> float:
        """Return the roll length from the start of a member's usable flank to the mating gear's tip.

        The reserve is negative if the tip reaches into the fillet.
        """
        own, mating = self.flanks if member is self.mesh.pinion else self.flanks[::-1]
        other = self.mesh.gear if member is self.mesh.pinion else self.mesh.pinion
        return member.sense * (self.mesh.mating_roll_length(mating[1], other) - own[0])

    def clearing_tip(self, member: Toothing, name: str) -> str:
        """Return, as text, the tip of the mating gear, called `name`, that clears a member's fillet."""
        own, mating = (
            (self.flanks[0], self.mesh.gear) if member is self.mesh.pinion else (self.flanks[1], self.mesh.pinion)
        )
        diameter = 2.0 * math.hypot(mating.base_radius, self.mesh.mating_roll_length(own[0], member))
        bound = f"at least {at_least(diameter)}" if mating.internal else f"at most {at_most(diameter)}"
        return f"{name}.tip_diameter {bound} mm"

    def fillet_interference(self, names: tuple[str, str], set_back: Sequence[SetBackFillet | None]) -> tuple[str, ...]:
        """Return a warning for each member below whose flank the mating tip reaches.

        `names`: names of pinion and gear. If a fillet is set back, contact is lost there and nothing interferes.
        """
        warnings = []
        both = ((self.mesh.pinion, *names), (self.mesh.gear, *names[::-1]))
        for (member, name, other), behind in zip(both, set_back, strict=True):
            reserve = self.interference_reserve(member)
            if self._clears(member):
                continue
            if behind is not None:
                warnings.append(
                    f"{name}: {behind.cause} begins {-reserve:.4g} mm of roll length beyond where the {other}'s tip would "
                    f"meet it, and contact is lost there; {name}.{behind.remedy}"
                )
            else:
                warnings.append(
                    f"{name}: interference: the {other}'s tip reaches {-reserve:.4g} mm of roll length into the fillet; it "
                    f"clears the fillet with {self.clearing_tip(member, other)}"
                )
        return tuple(warnings)

    def _clears(self, member: Toothing) -> bool:
        """True if the mating gear's tip stays on a member's usable flank, up to rounding."""
        return self.interference_reserve(member) >= -ROUNDING_MODULES * member.module

    def fillet_reserves(self, set_back: Sequence[SetBackFillet | None]) -> list[float | None]:
        """Return the interference reserves of pinion and gear; rounding counts as 0.

        None for a member whose fillet is set back and reached by the mating tip.
        """
        left: list[float | None] = []
        for member, behind in zip((self.mesh.pinion, self.mesh.gear), set_back, strict=True):
            reserve = self.interference_reserve(member)
            lost = behind is not None and not self._clears(member)
            left.append(None if lost else max(reserve, 0.0) if self._clears(member) else reserve)
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
